"""The test rig: what its signals tell of the bearing, by the article's procedure and by inverting the beam."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from math import pi, sqrt
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from benchmarks.evidence import Row, below
from benchmarks.evidence._intervals import width
from raceway.errors import ConvergenceError
from raceway.framework.registry import default_registry
from raceway.scene.file import load_scene
from raceway.scene.reading import rig_of
from raceway.scene.rig import Rig, Signals
from raceway.scene.scene import Scene
from raceway.studies.measured.from_files import from_files
from raceway.studies.measured.identify import Found, identify
from raceway.studies.measured.recording import Recording, write_recording
from raceway.studies.measured.run_out import slow_roll
from raceway.studies.rig.error_split import silent
from raceway.studies.rig.page import write_page
from raceway.studies.rig.sensors import record, response, slow_roll_record, white_noise
from raceway.studies.rig.study import RigStudy, study
from raceway.studies.shaft.balance import State, balance
from raceway.studies.shaft.beam import beam
from raceway.studies.shaft.bearing import Bearing, bearing
from raceway.studies.shaft.rotor import rotor, shaft

TITLE = "The test rig: signals, the article's procedure, and the inverted beam"
COMMAND = "python -m benchmarks.evidence rig"
_STUDY = "raceway study rig examples/test_rig.toml"
_SCENE = Path(__file__).parents[2] / "examples" / "test_rig.toml"
_SEEDS = 10

#: Bearings that the signals are made with, while the scene's own one inverts them.
_OTHERS: dict[str, dict[str, Any]] = {
    "contact angle 17 deg": {"bearing.contact_angle_deg": 17.0},
    "contact angle 19 deg": {"bearing.contact_angle_deg": 19.0},
    "conformity 0.53": {"bearing.conformity_inner": 0.53, "bearing.conformity_outer": 0.53},
    "elastic rings and balls (condensed bodies)": {"bodies.kind": "condensed"},
    "axial load 5 % higher": {},
}


def rows() -> list[Row]:
    scene = load_scene(_SCENE)
    rig = rig_of(scene)
    begun = time.process_time()
    found = study(scene, rig, default_registry())
    spent = time.process_time() - begun
    points = [(point.axial, point.state, held) for point, held in zip(found.points, _held(scene, found), strict=True)]
    return [
        *_beam(),
        *_identified(rig, found, points),
        *_printed(rig, scene, found),
        *_split(found),
        *_files(scene, rig, found, points),
        *_speed(rig, points),
        *_unlike(scene, rig),
        _weight(rig, points),
        *_mirrored(rig, points),
        *_damping(scene, rig),
        *_cost(found, spent),
    ]


def _held(scene: Scene, found: RigStudy) -> list[Bearing]:
    known = {axial: bearing(scene, axial, default_registry()) for axial in found.rig.axial_loads}
    return [known[point.axial] for point in found.points]


Points = list[tuple[float, State, Bearing]]


def _name(axial: float, state: State) -> str:
    return f"{state.speed * 30.0 / pi:.0f} r/min, {axial:.0f} N"


def _off(found: Found, state: State) -> float:
    return abs(found.state.stiffness / state.stiffness - 1.0)


def _beam() -> list[Row]:
    young, diameter, span, a, mass = 212e9, 0.03, 0.175, 0.025, 4.0
    inertia = pi / 64.0 * diameter**4
    line = beam(np.array([0.0, a, 0.5 * span, span]), diameter, young, 0.29, 1e-6, shear=False)
    line = line.with_spring(0.0, 1e16).with_spring(span, 1e16)
    load = np.zeros(len(line.stiffness))
    load[2 * line.node(0.5 * span)] = 1.0
    found = np.linalg.solve(line.stiffness, load)[2 * line.node(a)]
    exact = a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * young * inertia)
    speed = line.with_disc(0.5 * span, mass, 0.0, 0.0).critical_speeds()[0]
    printed = a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * young * inertia)
    rig = Rig()
    coarse, fine = (rotor(rig, 1500.0, shaft(rig, finer=n)) for n in (1, 2))
    return [
        below("simply supported shaft, deflection 25 mm from the support against P a (3 L^2 - 4 a^2) / (48 E I), relative",
              abs(found / exact - 1.0), 1e-6, COMMAND),
        below("critical speed of a disc on a massless shaft against sqrt(48 E I / (L^3 m)), relative",
              abs(speed / sqrt(48.0 * young * inertia / span**3 / mass) - 1.0), 1e-6, COMMAND),
        below("the rig's answers with elements half as long, relative change", float(np.abs(fine.ring / coarse.ring - 1.0).max()),
              1e-6, COMMAND),
        Row("static deflection at the sensor by the printed formula over the simply supported beam's", printed / exact, "reported",
            True, COMMAND, "equal for an L of twice the span"),
    ]  # fmt: skip


def _disturbed(rig: Rig, held: Bearing, state: State, signals: Signals, seed: int) -> Found:
    """Signals with all that disturbs them, less what a slow roll shows."""
    answer = response(rig, held, state, signals)
    roll = slow_roll(slow_roll_record(rig, held, signals, seed + 1000, white_noise(answer, signals)))
    return identify(record(rig, answer, signals, seed), rig, held, slow=roll)


def _identified(rig: Rig, found: RigStudy, points: Points) -> Iterator[Row]:
    outside = attrs.evolve(rig, sensor_side="outside")
    for words, own in (("", rig), ("sensor 25 mm outside, ", outside)):
        ratios, causes = [], []
        for axial, state, held in points:
            if own is not rig:
                state = balance(rotor(own, state.speed), held)
            quiet = silent(own.signals)
            clean = _off(identify(record(own, response(own, held, state, quiet), quiet, 1), own, held), state)
            noisy = [_disturbed(own, held, state, own.signals, seed) for seed in range(_SEEDS)]
            errors = [_off(one, state) for one in noisy]
            ratios += [error * state.stiffness / one.uncertainty[0] for error, one in zip(errors, noisy, strict=True)]
            causes += [max(one.parts, key=lambda name, of=one: of.parts[name][0]) for one in noisy]
            bow = abs(state.sensor - state.deflection)
            note = f"K = {1e-6 * state.stiffness:.2f} N/um ({1e-6 * state.locked[0]:.1f} with the tilt locked), bearing "
            note += f"{1e6 * abs(state.deflection):.2f} um, bow at the sensor {1e6 * bow:.2f} um, force "
            note += f"{2.0 * abs(state.force) / (rig.unbalance * state.speed**2):.3f} of m e w^2 / 2"
            yield below(f"(b) {words}{_name(axial, state)}: error of K without noise", clean, 0.01, _STUDY, note)
            text = f"(b) {words}{_name(axial, state)}: largest error of K with 40 dB of noise, 5 um of run-out less a slow roll, 5 um "
            yield below(f"{text}of drift, {_SEEDS} seeds", max(errors), 0.03, COMMAND)
        share = float(np.mean(np.array(ratios) <= 1.0))
        text = f"(b) {words}share of true K within the stated 95 %, {len(ratios)} records"
        yield Row(text, share, "0.9 to 1", share >= 0.9, COMMAND)
        most = max(set(causes), key=causes.count)
        note = f"the widest part of {causes.count(most)} of them: {most}"
        yield width(f"(b) {words}K of {len(ratios)} records", ratios, COMMAND, note)


def _printed(rig: Rig, scene: Scene, found: RigStudy) -> Iterator[Row]:
    beyond = attrs.evolve(rig, sensor_side="outside")
    for words, one in (("", found), ("sensor outside, ", study(scene, beyond, default_registry()))):
        for point in one.points:
            clean = {cause.what: 1.0 + cause.error for cause in point.causes if cause.kind == "correction"}
            seen = {reading.correction: reading.stiffness / point.state.stiffness for reading in point.readings}
            text = f"(a) {words}{_name(point.axial, point.state)}: K by the article's procedure over the true K, as printed"
            others = "; ".join(f"{what} {value:.3f}" for what, value in clean.items() if what != "as printed")
            note = f"{others}; as printed with noise and 5 um of run-out left in {seen['as printed']:.3f}"
            yield Row(text, clean["as printed"], "reported", True, _STUDY, note)


def _split(found: RigStudy) -> Iterator[Row]:
    causes = dict.fromkeys((cause.kind, cause.what) for point in found.points for cause in point.causes)
    for kind, what in causes:
        errors = [c.error for point in found.points for c in point.causes if (c.kind, c.what) == (kind, what)]
        note = f"from {100 * min(errors):.3g} % to {100 * max(errors):.3g} % over speeds and loads"
        yield Row(f"error of K, {kind}: {what}", max(abs(error) for error in errors), "reported", True, _STUDY, note)


def _files(scene: Scene, rig: Rig, found: RigStudy, points: Points) -> Iterator[Row]:
    apart, wide = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found.write_signals(folder)
        for point in found.points:
            loaded = attrs.evolve(scene, load=attrs.evolve(scene.load, axial=point.axial))
            signals, slow = (folder / f"{kind}-{point.name}.csv" for kind in ("signals", "slow-roll"))
            back = from_files(signals, loaded, rig, default_registry(), slow)
            apart.append(abs(back.state.stiffness / point.found.state.stiffness - 1.0))
            wide.append(abs(back.uncertainty[0] / point.found.uncertainty[0] - 1.0))
        uneven = []
        random = np.random.default_rng(11)
        drifting = attrs.evolve(silent(rig.signals), speed_drift=0.01, sampling_hz=8e4)
        for axial, state, held in points:
            whole = record(rig, response(rig, held, state, drifting), drifting, 1)
            groups = len(whole.time) // 8
            kept = whole.part(8 * np.arange(groups) + random.integers(0, 8, groups))
            path = write_recording(attrs.evolve(kept, speed=None), folder / "uneven.csv")
            loaded = attrs.evolve(scene, load=attrs.evolve(scene.load, axial=axial))
            uneven.append(_off(from_files(path, loaded, rig, default_registry()), state))
    command = (
        "raceway identify signals-13000rpm-400N.csv --scene examples/test_rig.toml --slow-roll slow-roll-13000rpm-400N.csv"
    )
    yield below(
        "identify on the rig's own CSV against the study, K, largest relative difference of 6", max(apart), 1e-5, command
    )
    yield below("the same, uncertainty of K", max(wide), 1e-2, command)
    text = "identify on a CSV with intervals from 1/8 to 15/8 of the usual one and 1 % speed drift: largest error of K of 6"
    yield below(text, max(uneven), 0.01, COMMAND)


def _speed(rig: Rig, points: Points) -> Iterator[Row]:
    for words, change, bound in (
        ("speed drifts by 5 %", {"speed_drift": 0.05}, 0.01),
        ("speed drifts by 9 %", {"speed_drift": 0.09}, 0.02),
        ("20 turns or less", {"duration": 0.08}, 0.01),
        ("4 turns or less", {"duration": 0.02}, 0.03),
    ):
        quiet = attrs.evolve(silent(rig.signals), **change)
        errors = [
            _off(identify(record(rig, response(rig, held, s, quiet), quiet, 1), rig, held), s) for _, s, held in points
        ]
        yield below(f"clean signals, {words}: largest error of K of 6", max(errors), bound, COMMAND)
    quiet, errors = silent(rig.signals), []
    for _, state, held in points:
        without = attrs.evolve(record(rig, response(rig, held, state, quiet), quiet, 1), key=None)
        errors.append(_off(identify(_speed_off(without), rig, held), state))
    text = "clean signals, a speed column that is 0.1 % off instead of a mark: largest error of K of 6"
    yield below(text, max(errors), 0.01, COMMAND, "the phase is taken as zero; C is not identified")


def _speed_off(recording: Recording) -> Recording:
    assert recording.speed is not None
    return attrs.evolve(recording, speed=1.001 * recording.speed)


def _unlike(scene: Scene, rig: Rig) -> Iterator[Row]:
    registry = default_registry()
    for words, changes in _OTHERS.items():
        other = load_scene(_SCENE, [f"{key}={value!r}".replace("'", '"') for key, value in changes.items()])
        errors, shifts = [], []
        for axial in rig.axial_loads:
            held = bearing(scene, axial, registry)
            true_one = bearing(other, 1.05 * axial if not changes else axial, registry)
            for speed in rig.speeds_rpm:
                line = rotor(rig, speed * pi / 30.0)
                state, quiet = balance(line, true_one), silent(rig.signals)
                found = identify(record(rig, response(rig, true_one, state, quiet), quiet, 1), rig, held)
                errors.append(_off(found, state))
                shifts.append(balance(line, held).stiffness / state.stiffness - 1.0)
        note = f"the scene's own K is off by {100 * min(shifts):.2g} to {100 * max(shifts):.2g} %"
        text = f"clean signals of another bearing than the scene's, {words}: largest error of K of 6"
        yield Row(text, max(errors), "reported", True, COMMAND, note)


def _mirrored(rig: Rig, points: Points) -> Iterator[Row]:
    """What the rig's tilt does to F / x when the bearings are mounted the other way round."""
    turned = attrs.evolve(rig, arrangement="DF")
    for axial, state, held in points:
        text = f"bearings mounted DF, {_name(axial, state)}: K with the rig's tilt over that of bearings mounted DB"
        try:
            other = balance(rotor(turned, state.speed), held)
        except ConvergenceError as why:
            yield Row(text, "no motion", "reported", True, COMMAND, str(why))
            continue
        note = f"K = {1e-6 * other.stiffness:.4g} and {1e-6 * state.stiffness:.4g} N/um; the bearing moves by "
        note += f"{1e6 * abs(other.deflection):.3g} and {1e6 * abs(state.deflection):.3g} um; with the tilt locked "
        note += f"{1e-6 * other.locked[0]:.1f} and {1e-6 * state.locked[0]:.1f} N/um"
        yield Row(text, other.stiffness / state.stiffness, "reported", True, COMMAND, note)


def _weight(rig: Rig, points: Points) -> Row:
    changes = []
    for _, state, held in points:
        load = attrs.evolve(held.scene.load, radial=(0.0, -0.5 * 9.81 * rig.mass))
        heavy = attrs.evolve(held, scene=attrs.evolve(held.scene, load=load))
        changes.append(balance(rotor(rig, state.speed), heavy).stiffness / state.stiffness - 1.0)
    note = f"{100 * min(changes):.2g} to {100 * max(changes):.2g} %; forward line only"
    return Row("weight of the rotor, which the rig leaves out: largest change of K of 6", max(changes, key=abs), "reported",
               True, COMMAND, note)  # fmt: skip


def _damping(scene: Scene, rig: Rig) -> Iterator[Row]:
    damped = attrs.evolve(scene, rotor=attrs.evolve(scene.rotor, damping=3000.0))
    for axial in rig.axial_loads:
        held = bearing(damped, axial, default_registry())
        state, quiet = balance(rotor(rig, 13000.0 * pi / 30.0), held), silent(rig.signals)
        found = identify(record(rig, response(rig, held, state, quiet), quiet, 1), rig, held)
        text = f"bearing with 3000 N s/m, 13000 r/min, {axial:.0f} N"
        note = f"C = {found.state.damping:.0f} of {state.damping:.0f} +- {found.uncertainty[1]:.0f} N s/m; with the tilt locked "
        note += f"{found.state.locked[1]:.0f} of {state.locked[1]:.0f} +- {found.uncertainty[3]:.0f}"
        yield below(f"{text}: error of C without noise", abs(found.state.damping / state.damping - 1.0), 0.01, COMMAND, note)
        noisy = [_disturbed(rig, held, state, rig.signals, seed) for seed in range(_SEEDS)]
        ratios = [(one.state.damping - state.damping) / one.uncertainty[1] for one in noisy]
        yield width(f"{text}: C of {_SEEDS} records with noise, run-out and drift", ratios, COMMAND)


def _cost(found: RigStudy, spent: float) -> Iterator[Row]:
    yield below("processor time of the study, 6 points, s", spent, 60.0, _STUDY, "compiled kernels were kept")
    with tempfile.TemporaryDirectory() as name:
        page = write_page(found, Path(name))[0]
        text = page.read_text(encoding="utf-8")
        yield below("size of rig.html, MB", page.stat().st_size / 1e6, 5.0, _STUDY)
    links = text.count('src="http') + text.count('href="http') + text.count("url(http") + text.count("<script")
    yield below("links to a network and scripts in rig.html", links, 0, _STUDY)
