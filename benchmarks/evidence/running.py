"""What the running speed changes: preload of pairs, held displacements."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from raceway.run import run
from raceway.scene_file import scene_from_dict
from tests.reference.mounted import FORCE, approach, axial, row, secant

TITLE = "What the running speed changes: preload, held displacements"
MOUNTED = "python -m pytest tests/depth/test_mounting.py"
#: Of a stiffness or a force, against a solution by independent code.
_LIMIT = 1e-3


def rows() -> list[Row]:
    return [*_pairs(), *_grown(), *_held()]


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
        preload = result.as_dict()["equilibrium"]["preload"]["running_n"]
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
