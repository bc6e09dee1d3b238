"""Sets of rows: stiffness of rows on a spring against slopes of whole runs, and the preload before mounting, mounted and running."""

from __future__ import annotations

from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below, near
from validation.reference.mounted import approach, axial, row

COMMAND = "python -m benchmarks.meaning sets"
#: N: differences of fourth order, whose own error is below 1e-7 of these stiffnesses.
_STEP = 3.0
#: Interference on the shaft and dimensions of the B7206C [m]: bore, diameter of the inner raceway.
_TIGHT, _BORE, _RACE = 8e-6, 30e-3, 46e-3 - 9.525e-3


def rows() -> list[Row]:
    """All rows."""
    springs = [_slope(word, rpm) for word in ("DB", "DF", "TBT") for rpm in (0.0, 12000.0)]
    return [*springs, *_loaded(), *_damping(), *_second_preload(), *_states(), *_held()]


def _sprung(arrangement: str, rpm: float = 0.0, load: Any = (0.0, 0.0, 0.0), **more: Any) -> Any:
    axial, *radial = (float(force) for force in load)
    bearing = {"preset": "B7206C", "arrangement": arrangement, "preload": 300.0, "preload_kind": "spring", **more}
    tables = {"bearing": bearing, "kinematics": {"spin_speed_rpm": rpm}, "load": {"axial": axial, "radial": radial}}
    return rw.run(tables)


def _receptance(arrangement: str, rpm: float, load: np.ndarray) -> np.ndarray:
    """(3, 3) motions of whole runs by loads along x, y, z [m/N]."""
    weights = {-2: 1.0, -1: -8.0, 1: 8.0, 2: -1.0}
    columns = [
        sum(w * _sprung(arrangement, rpm, load + k * _STEP * axis).displacement[:3] for k, w in weights.items())
        for axis in np.eye(3)
    ]
    return np.column_stack(columns) / (12.0 * _STEP)


def _slope(arrangement: str, rpm: float) -> Row:
    result = _sprung(arrangement, rpm)
    held = result.equilibrium.stiffness_rows_held[0, 0]
    slope = 1.0 / _receptance(arrangement, rpm, np.zeros(3))[0, 0]
    quantity = (
        f"{arrangement} of B7206C, 300 N on a spring, {rpm:g} r/min: kxx against the slope of runs, relative difference"
    )
    note = f"{1e-6 * result.stiffness[0, 0]:.4f} and {1e-6 * slope:.4f} N/um; {1e-6 * held:.2f} with the rows held"
    return below(quantity, abs(result.stiffness[0, 0] / slope - 1.0), 1e-6, COMMAND, note)


def _loaded() -> list[Row]:
    """All entries under a load in all directions."""
    load = np.array([50.0, 200.0, 80.0])
    result = _sprung("TBT", 12000.0, load)
    slopes = np.linalg.inv(_receptance("TBT", 12000.0, load))
    scale = np.sqrt(np.outer(np.diag(slopes), np.diag(slopes)))
    worst = float(np.abs((result.stiffness[:3, :3] - slopes) / scale).max())
    quantity = "TBT on a spring, 50, 200 and 80 N along x, y, z, 12 000 r/min: 9 entries of K against slopes of runs, largest difference"
    kyy = result.equilibrium.stiffness_rows_held[1, 1] / result.stiffness[1, 1] - 1.0
    return [below(quantity, worst, 1e-6, COMMAND, f"with the rows held kyy is {100.0 * kyy:.2f} % larger")]


def _damping() -> list[Row]:
    """cxx of a pair on a spring is that of its first row alone."""
    contact = {"time_constant": 2.5e-6}
    bearing = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "preload_kind": "spring"}
    pair = rw.run({"bearing": bearing, "load": {"axial": 0.0}, "contact": contact})
    single = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}, "contact": contact})
    quantity = "DB on a spring: cxx against that of one row under the spring's force, N s/m"
    return [near(quantity, pair.damping[0, 0], single.damping[0, 0], 1e-6, COMMAND)]


def _second_preload() -> list[Row]:
    found = _sprung("TBT", second_preload=600.0).to_dict()["equilibrium"]["preload"]
    each = ", ".join(f"{force:.6g}" for force in found["rows_n"])
    quantity = "TBT, preload 300 N and second_preload 600 N on a spring: {} N"
    note = f"rows {each} N; before mounting {found['before_mounting_n']:g} and {found['second_before_mounting_n']:g} N"
    return [near(quantity.format(word), found[f"{word}_n"], 600.0, 1e-8, COMMAND, note) for word in ("mounted", "running")]


def _states() -> list[Row]:
    """A pair of 300 N with a fit of 8 um on the shaft, at rest, and at 20 000 r/min with 1 um of growth, against independent rows."""
    tables = {"load": {"axial": 0.0}, "mounting": {"shaft_interference": _TIGHT}}
    turning = {"kinematics": {"spin_speed_rpm": 20000.0, "radial_expansion": 1e-6}}
    bearing = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
    found = rw.run({"bearing": bearing, **tables, **turning}).to_dict()["equilibrium"]["preload"]
    x, fit = approach(row(), 300.0), 0.5 * _TIGHT * _BORE / _RACE
    mounted, running = axial(row(growth=fit), x), axial(row(20000.0, fit + 1e-6), x)
    text = "DB, 8 um of interference, 20 000 r/min: preload {}, N"
    return [
        near(
            text.format("before mounting"), found["before_mounting_n"], 300.0, 1e-12, COMMAND, "as bearing.preload sets it"
        ),
        near(text.format("mounted"), found["mounted_n"], mounted, 1e-6, COMMAND, "at standstill with the fit"),
        near(text.format("running"), found["running_n"], running, 1e-6, COMMAND),
    ]


def _held() -> list[Row]:
    """A displacement that 500 N give before mounting, held, with the fit, at 0 r/min."""
    tables = {"load": {"axial": 500.0}, "supports": {"axial": "displacement"}, "mounting": {"shaft_interference": _TIGHT}}
    found = rw.run({"bearing": {"preset": "B7206C"}, **tables}).to_dict()["equilibrium"]["held_axial"]
    mounted = axial(row(growth=0.5 * _TIGHT * _BORE / _RACE), approach(row(), 500.0))
    text = "B7206C, displacement of 500 N held, 8 um of interference, 0 r/min: axial force {}, N"
    return [
        near(text.format("before mounting"), found["before_mounting_n"], 500.0, 1e-12, COMMAND),
        near(
            text.format("mounted"), found["mounted_n"], mounted, 1e-6, COMMAND, "the displacement stays, its force does not"
        ),
        near(text.format("running"), found["running_n"], mounted, 1e-6, COMMAND, "nothing turns: as mounted"),
    ]
