"""Fits: the contact angle from a rig's own records, K and C from force and displacement, an angle from K over load."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from raceway.core.jit import working_clock
from raceway.framework.registry import default_registry
from raceway.front.evolve import evolve
from raceway.front.run import run
from raceway.scene.continuous import with_number
from raceway.scene.file import load_scene
from raceway.scene.reading import rig_of
from raceway.scene.rig import Rig
from raceway.scene.scene import Scene
from raceway.studies.fit.front import fit
from raceway.studies.measured.front import identify
from raceway.studies.measured.recording import write_recording
from raceway.studies.rig.sensors import record as record_of_rig
from raceway.studies.rig.sensors import response, slow_roll_record, white_noise
from raceway.studies.shaft.balance import State, balance
from raceway.studies.shaft.bearing import bearing
from raceway.studies.shaft.rotor import rotor
from validation.shaker import record
from validation.tables import b7206c

TITLE = "Fits to measured data"
COMMAND = "python -m benchmarks.evidence fit"
_SCENE = Path(__file__).parents[2] / "examples" / "test_rig.toml"
_ANGLE = "bearing.contact_angle_deg"
#: True angles of the rig's bearings [deg], where its scene says 15; how far a fit may miss angle [deg] and K.
_TRUE, _OFF, _PART = (17.0, 19.0), 0.2, 0.01
#: Records of a shaker, and what they are made with: stiffness [N/m], damping [N s/m], mass [kg], free words.
_SEEDS = 200
_SYSTEMS = {
    "K, C free, no mass": (5e7, 800.0, 0.0, "K,C"),
    "K, C, mass free": (5e7, 800.0, 2.0, "K,C,mass"),
    "K, C free, mass known": (5e7, 800.0, 2.0, "K,C"),
}
#: Tables of kxx over load with this relative scatter.
_TABLES, _SCATTER, _LOADS = 100, 0.005, (400.0, 600.0, 900.0, 1300.0, 1800.0, 2400.0)


def rows() -> list[Row]:
    return [*_rig(), *_records(), *_tables()]


def _rig() -> Iterator[Row]:
    scene = load_scene(_SCENE)
    rig = rig_of(scene)
    for true in _TRUE:
        off, stiffness, within, unlike, covered, seconds = [], [], [], [], [], []
        for loaded, state, signals, slow in _files(with_number(scene, _ANGLE, true), rig):
            given = with_number(loaded, _ANGLE, 15.0)
            begun = working_clock()
            one = fit(signals, given, _ANGLE, slow_roll=slow)
            seconds.append(working_clock() - begun)
            off.append(abs(one[_ANGLE] - true))
            stiffness.append(abs(one["K"] / state.stiffness - 1.0))
            within.append(off[-1] <= one.half_width(_ANGLE))
            assumed = identify(signals, given, slow_roll=slow)
            missed = abs(assumed.equivalent_stiffness - state.stiffness)
            unlike.append(missed / state.stiffness)
            covered.append(missed <= assumed.equivalent_stiffness_error)
        what = f"rig's own CSV, true contact angle {true:g} deg, scene 15 deg, {len(off)} records"
        note = f"true angle within the stated 95 % in {sum(within)} of {len(within)}; {np.mean(seconds):.1f} s of processor a fit on the mean"
        yield below(f"{what}: largest error of the angle, deg", max(off), _OFF, COMMAND, note)
        note = f"raceway identify, which assumes the scene's tilt stiffness, is off by {100 * min(unlike):.2g} to {100 * max(unlike):.2g} %"
        yield below(f"{what}: largest error of K", max(stiffness), _PART, COMMAND, note)
        share = float(np.mean(covered))
        text = f"{what}: share of true K within the 95 % of raceway identify, which a tilt stiffness that is assumed widens"
        yield Row(text, share, "0.9 to 1", share >= 0.9, COMMAND)


def _files(true: Scene, rig: Rig) -> Iterator[tuple[Scene, State, Path, Path]]:
    """As ``raceway study rig`` writes them: scene under its load, what the bearing truly does, signals, slow roll."""
    with tempfile.TemporaryDirectory() as name:
        folder, place = Path(name), 0
        for axial in rig.axial_loads:
            loaded = with_number(true, "load.axial", axial)
            held = bearing(loaded, axial, default_registry())
            for rpm in rig.speeds_rpm:
                state = balance(rotor(rig, rpm * np.pi / 30.0), held)
                answer = response(rig, held, state, rig.signals)
                seed = rig.signals.seed + 2 * place
                roll = slow_roll_record(rig, held, rig.signals, seed + 1, white_noise(answer, rig.signals))
                signals = write_recording(record_of_rig(rig, answer, rig.signals, seed), folder / "signals.csv")
                yield loaded, state, signals, write_recording(roll, folder / "slow-roll.csv")
                place += 1


def _records() -> Iterator[Row]:
    for words, (k, c, m, free) in _SYSTEMS.items():
        names = free.split(",")
        true = {"K": k, "C": c, "mass": m}
        inside = np.zeros(len(names))
        half = []
        for seed in range(_SEEDS):
            found = fit(record(k, c, m, seed), free=free, mass=None if "mass" in names else m)
            inside += [abs(found[name] - true[name]) <= found.half_width(name) for name in names]
            half.append([found.half_width(name) / true[name] for name in names])
        for place, name in enumerate(names):
            share = float(inside[place] / _SEEDS)
            text = f"record of F(t), x(t), 40 dB of noise on both, {words}: share of true {name} within the stated 95 %, {_SEEDS} seeds"
            note = f"half-width {100 * np.median(np.array(half)[:, place]):.2g} % (median); {k:g} N/m, {c:g} N s/m, {m:g} kg"
            yield Row(text, share, "0.90 to 0.98", 0.90 <= share <= 0.98, COMMAND, note)


def _tables() -> Iterator[Row]:
    scene = b7206c(load={"axial": 1000.0})
    made = b7206c(load={"axial": 1000.0})
    made["bearing"]["contact_angle_deg"] = 17.0
    exact = _stiffness(made)
    random = np.random.default_rng(5)
    inside = 0
    for _ in range(_TABLES):
        data = {"load.axial [N]": _LOADS, "kxx [N/m]": exact * (1.0 + _SCATTER * random.standard_normal(len(_LOADS)))}
        found = fit(data, scene, _ANGLE)
        inside += abs(found[_ANGLE] - 17.0) <= found.half_width(_ANGLE)
    share = inside / _TABLES
    text = f"kxx at {len(_LOADS)} loads, scatter {100 * _SCATTER:g} %, not stated: share of the true angle within the stated 95 %, {_TABLES} tables"
    yield Row(
        text,
        share,
        "0.90 to 0.98",
        0.90 <= share <= 0.98,
        COMMAND,
        "weights by one relative error; scatter of 0.5 % of each number",
    )


def _stiffness(tables: dict[str, Any]) -> np.ndarray:
    return np.array([run(evolve(tables, f"load.axial={axial}")).stiffness[0, 0] for axial in _LOADS])
