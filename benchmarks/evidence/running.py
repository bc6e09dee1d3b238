"""What the running speed changes: preload of pairs, held displacements, run-ups, fits over whirl speeds."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from raceway.pipeline.run import run
from raceway.scene.file import load_scene
from raceway.scene.reading import scene_from_dict
from validation.reference.mounted import FORCE, approach, axial, row, secant

TITLE = "What the running speed changes: preload, held displacements, run-ups, fits over whirl speeds"
MOUNTED = "python -m pytest tests/depth/test_mounting.py"
RUN_UP = "python -m pytest tests/depth/test_speeds.py"
#: K over a run-up against steady runs; damping that a run-up without any may tell [N s/m].
_STEADY, _NOTHING = 5e-3, 1.0
#: Fitted K against a steady run, over |Z|: what the amplitude changes is left.
_FIT = 0.02
#: A true error over the stated one, with the steps in time of what it is held against; kg of a mass that is known.
_COVERED, _NO_MASS = 1.01, 1e-9
#: Of one window's record alone the error is told to a factor: a motion that lags behind its force is not linear in the lag.
_FEW = 5.0
#: Of a stiffness or a force, against a solution by independent code.
_LIMIT = 1e-3


def rows() -> list[Row]:
    return [*_pairs(), *_grown(), *_held(), *_run_ups(), *_example(), *_fits(), *_tilting_fits(), *_crossings()]


def _scene(**tables: Any) -> Any:
    return scene_from_dict({"title": "running", "bearing": {"preset": "B7206C"}, **tables})


def _pair(**tables: Any) -> Any:
    bearing = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
    return run(_scene(bearing=bearing, **tables))


def _off(value: float, expected: float) -> float:
    return abs(value / expected - 1.0)


def _pairs() -> list[Row]:
    """Rotating 200 N, tilt locked."""
    out, x = [], approach(row(), 300.0)
    for rpm in (6000.0, 12000.0, 15000.0, 20000.0, 30000.0):
        excitation = {"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": FORCE}
        result = _pair(excitation=excitation)
        found, running = result.identification, row(rpm)
        expected = secant(running, None, 2, found.mass_used, found.speed, x)
        preload = result.to_dict()["equilibrium"]["preload"]["running_n"]
        note = f"{1e-6 * found.equivalent_stiffness:.2f} against {1e-6 * expected:.2f} N/um; preload {preload:.1f} N"
        name = f"DB pair, 300 N mounted, {rpm:g} r/min: error of K"
        out.append(below(name, _off(found.equivalent_stiffness, expected), _LIMIT, MOUNTED, note))
        name = f"DB pair, 300 N mounted, {rpm:g} r/min: error of the running preload"
        out.append(below(name, _off(preload, axial(running, x)), _LIMIT, MOUNTED, f"against {axial(running, x):.1f} N"))
    return out


def _grown() -> list[Row]:
    out, x = [], approach(row(), 300.0)
    for growth in (-2e-6, 2e-6, 5e-6):
        k = np.diag(_pair(kinematics={"radial_expansion": growth}).equilibrium.stiffness)
        expected = 2.0 * np.diag(row(growth=growth)(np.array([x, 0.0, 0.0, 0.0, 0.0]))[1])
        for index, word in enumerate(("kxx", "kyy")):
            note = f"{1e-6 * k[index]:.2f} against {1e-6 * expected[index]:.2f} N/um"
            name = f"DB pair, 300 N mounted, inner raceway {1e6 * growth:+g} um: error of {word}"
            out.append(below(name, _off(k[index], expected[index]), _LIMIT, MOUNTED, note))
    return out


def _held() -> list[Row]:
    out, x = [], approach(row(), 400.0)
    for rpm in (15000.0, 30000.0):
        kinematics = {"spin_speed_rpm": rpm}
        found = run(_scene(load={"axial": 400.0}, supports={"axial": "displacement"}, kinematics=kinematics))
        expected = row(rpm)(np.array([x, 0.0, 0.0, 0.0, 0.0]))[1][1, 1]
        moved, k = found.equilibrium.displacement[0], found.equilibrium.stiffness[1, 1]
        name = f"displacement of 400 N held, {rpm:g} r/min: error of"
        note = f"{1e6 * moved:.3f} against {1e6 * x:.3f} um"
        out.append(below(f"{name} x", _off(moved, x), _LIMIT, MOUNTED, note))
        note = f"{1e-6 * k:.2f} against {1e-6 * expected:.2f} N/um"
        out.append(below(f"{name} kyy", _off(k, expected), _LIMIT, MOUNTED, note))
    return out


def _run_ups() -> list[Row]:
    """B7206C, 400 N, 2 kg, 1e-4 kg m, tilt locked, half a second."""
    out, common = [], {"load": {"axial": 400.0}, "rotor": {"mass": 2.0}}
    for first, last in ((6000.0, 15000.0), (15000.0, 6000.0)):
        excitation = {"kind": "run_up", "first_speed_rpm": first, "speed_rpm": last, "duration_s": 0.5, "unbalance": 1e-4}
        identifier, steps = {"kind": "order_tracking", "window_turns": 4.0}, {"steps_per_turn": 120}
        result = run(_scene(**common, excitation=excitation, identifier=identifier, integrator=steps))
        found, mass = result.identification.series, result.model.mass_used
        for rpm in (6150.0, 9000.0, 12000.0, 14900.0):
            w, z = min(found, key=lambda one: abs(one[0] - rpm * np.pi / 30.0))
            here = w * 30.0 / np.pi
            steady = {"kind": "bidirectional", "speed_rpm": here, "unbalance": 1e-4}
            expected = run(_scene(**common, excitation=steady)).identification.equivalent_stiffness
            k = z.real + mass * w**2
            note = f"{1e-6 * k:.2f} against {1e-6 * expected:.2f} N/um; C {z.imag / w:.2g} N s/m"
            name = f"{first:g} to {last:g} r/min: error of K at {here:.0f} r/min against a steady run"
            out.append(below(name, _off(k, expected), _STEADY, RUN_UP, note))
    return out


def _example() -> list[Row]:
    found = run(load_scene("examples/run_up.toml")).identification
    worst = max(abs(z.imag / w) for w, z in found.series)
    note = "largest of the series; m (w' + 2 w A' / A) / w is 12 to 31 N s/m"
    return [below("examples/run_up.toml, no damping: C, N s/m", worst, _NOTHING, "raceway run examples/run_up.toml", note)]


def _fits() -> list[Row]:
    """400 N, 2 kg, tilt locked; turning force at whirl speeds of 11 000 to 15 000 r/min at the spin speed of 15 000."""
    out, identifier = [], {"kind": "impedance_fit", "speeds_rpm": [11000.0, 13000.0, 15000.0]}
    for unbalance in (1e-4, 3.2e-4):
        excitation = {"kind": "bidirectional", "speed_rpm": 15000.0, "unbalance": unbalance}
        common = {"load": {"axial": 400.0}, "rotor": {"mass": 2.0}, "excitation": excitation}
        fitted, steady = run(_scene(**common, identifier=identifier)), run(_scene(**common)).identification
        found, size = fitted.identification, abs(steady.dynamic_stiffness)
        off = abs(found.equivalent_stiffness - steady.equivalent_stiffness) / size
        name = f"impedance_fit, {unbalance:g} kg m: error of"
        note = f"{1e-6 * found.equivalent_stiffness:.2f} against {1e-6 * steady.equivalent_stiffness:.2f} N/um"
        note += f"; m {found.mass_used:.4g} kg"
        out.append(below(f"{name} K over |Z|", off, _FIT, RUN_UP, note))
        told = fitted.error["identification"]
        note = f"error.identification {told:.2g}, true {off:.2g}"
        out.append(below(f"{name} K over the stated one", off / told, 2.0, RUN_UP, note))
    return out


def _tilting_fits() -> list[Row]:
    """400 N, 2 kg, free tilts with a disc, 13 000 r/min: the distance of the fit from the steady motion over its stated error."""
    out, rotor = [], {"mass": 2.0, "polar_inertia": 5e-3, "transverse_inertia": 3e-3}
    excitation = {"kind": "bidirectional", "speed_rpm": 13000.0, "unbalance": 1e-4}
    common = {"load": {"axial": 400.0}, "rotor": rotor, "supports": {"tilt": "free"}, "excitation": excitation}
    steady = run(_scene(**common, integrator={"kind": "periodic"})).identification
    for speeds in ([11e3, 12e3, 13e3, 14e3, 15e3], [12e3, 14e3], [1e3, 2e3, 3e3], [16e3, 20e3]):
        fitted = run(_scene(**common, identifier={"kind": "impedance_fit", "speeds_rpm": speeds}))
        found, told = fitted.identification, fitted.error["total"]
        off = abs(found.dynamic_stiffness - steady.dynamic_stiffness) / abs(found.dynamic_stiffness)
        name = f"impedance_fit, free tilts, {speeds[0]:g} to {speeds[-1]:g} r/min"
        note = f"true {off:.2g}, stated {told:.2g}; K {1e-6 * found.equivalent_stiffness:.2f}, steady "
        note += f"{1e-6 * steady.equivalent_stiffness:.2f} N/um; m {found.mass_used:.4g} kg"
        out.append(below(f"{name}: true error of Z over the stated one", off / told, _COVERED, RUN_UP, note))
        off_mass = abs(found.mass_used - steady.mass_used)
        out.append(below(f"{name}: m less ring and rotor, kg", off_mass, _NO_MASS, RUN_UP, ""))
    return out


def _crossings() -> list[Row]:
    """Run-ups through a resonance and far below it: the distance of windows from steady runs over the error that they state."""
    crossing = {"load": {"axial": 1000.0}, "rotor": {"mass": 100.0, "damping": 5000.0}}
    light = {"load": {"axial": 1000.0}, "rotor": {"mass": 2.0}}
    cases = (
        ("100 kg, 5000 N s/m, 2 s", crossing, 6e3, 20e3, 2.0, 1e-5),
        ("100 kg, 5000 N s/m, 0.5 s", crossing, 6e3, 20e3, 0.5, 1e-5),
        ("2 kg, no damping, 0.5 s", light, 1e3, 30e3, 0.5, 1e-4),
    )
    out = []
    for words, common, first, last, duration, unbalance in cases:
        excitation = {
            "kind": "run_up",
            "first_speed_rpm": first,
            "speed_rpm": last,
            "duration_s": duration,
            "unbalance": unbalance,
        }
        identifier, steps = {"kind": "order_tracking"}, {"steps_per_turn": 120}
        result = run(_scene(**common, excitation=excitation, identifier=identifier, integrator=steps))
        found = result.identification
        told, worst = np.array(found.series_error), (0.0, 0.0, 0.0)
        for k in sorted({*range(0, len(told), 7), int(told.argmax())}):
            w, z = found.series[k]
            one = {"kind": "bidirectional", "speed_rpm": w * 30.0 / np.pi, "unbalance": unbalance}
            steady = run(_scene(**common, excitation=one, integrator={"kind": "periodic"})).identification.dynamic_stiffness
            off = abs(z - steady) / min(abs(z), abs(steady))
            worst = max(worst, (off / told[k], off, w * 30.0 / np.pi))
        name = f"order_tracking, {words}, {first:g} to {last:g} r/min"
        note = f"true {worst[1]:.2g} at {worst[2]:.0f} r/min; largest stated {told.max():.2g}, of {len(told)} windows"
        out.append(below(f"{name}: true error of Z over the stated one", worst[0], _COVERED, RUN_UP, note))
        method, record = result.model.scene.identifier.method, result.simulation.record
        own = np.array(method.identify([record], result.equilibrium, result.model).series_error) + result.error["time_step"]
        least = int(np.argmax(told / own))
        note = f"{told[least]:.2g} against {own[least]:.2g} at {found.series[least][0] * 30.0 / np.pi:.0f} r/min"
        out.append(below(f"{name}: true error over that of the record alone", told[least] / own[least], _FEW, RUN_UP, note))
    return out
