"""Causes of the trend: direction, amplitude law, ball inertia, bodies and tilt stiffness, one swapped at a time."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.framework.registry import Registry
from raceway.scene.changes import with_value
from raceway.storage.tables import Tables
from raceway.studies.article.curves import Curves
from raceway.studies.article.design import AMPLITUDES, DIRECTIONS, TILTS, Design, Setting
from raceway.studies.article.runs import Row, Task, curve

#: Swaps of one choice against the article's bidirectional model with ball inertia; the first changes nothing.
SWAPS: dict[str, Tables] = {
    "rotating force m e w², ball inertia": {},
    "direction swapped: unidirectional force m e w²": {"direction": DIRECTIONS[0]},
    "amplitude law swapped: rotating force, constant": {"amplitude": AMPLITUDES[0]},
    "both swapped: unidirectional force, constant": {"direction": DIRECTIONS[0], "amplitude": AMPLITUDES[0]},
    "weightless balls": {"inertia": False},
    "condensed bodies": {"bodies": "condensed"},
    "friction, balls that stand": {"friction": "standing"},
    "friction, balls that orbit": {"friction": "orbiting"},
}
#: Tilt stiffness of the shaft [N m/rad], from next to free to next to locked.
STIFFNESSES = tuple(float(f"{10.0 ** (2.0 + 0.25 * k):.4g}") for k in range(17))


def swapped(tilt: str, change: Tables, bodies: tuple[str, ...]) -> Setting:
    """The article's setting with one choice changed."""
    kind = "rigid" if "rigid" in bodies else bodies[0]
    base = Setting(DIRECTIONS[1], AMPLITUDES[1], tilt, True, kind)
    return attrs.evolve(base, **change)


def one_at_a_time(curves: Curves, load: float, measure: str = "K") -> list[tuple[str, dict[str, float | str]]]:
    """Of each swap k*(1) - 1 at each tilt boundary, or why there is no number: "unstable", "failed", "refused"."""
    out = []
    for name, change in SWAPS.items():
        if change.get("bodies", curves.design.bodies[0]) not in curves.design.bodies:
            continue
        row: dict[str, float | str] = {}
        if (swapped(TILTS[0], change, curves.design.bodies), load) not in curves.rows:
            continue  # with friction every other axial load is run
        for tilt in TILTS:
            row[tilt] = _change(curves, swapped(tilt, change, curves.design.bodies), load, measure)
        out.append((name, row))
    return out


def _change(curves: Curves, setting: Setting, load: float, measure: str = "K") -> float | str:
    """k*(1) - 1, or why there is no number."""
    found = curves.normalised(setting, load, measure)[-1] - 1.0
    fates = [curves.rows[setting, load][end]["status"] for end in (0, -1)]
    return float(found) if np.isfinite(found) else str(next(fate for fate in fates if fate != "completed"))


def friction_trends(curves: Curves) -> list[Tables]:
    """k*(1) - 1 under the rotating force m e w^2 for each kind of friction: ``tilt``, ``axial_n``, ``none`` and so on."""
    made, out = curves.design, []
    for tilt in TILTS if len(made.frictions) > 1 else ():
        settings = {one: attrs.evolve(swapped(tilt, {}, ("rigid",)), friction=one) for one in made.frictions}
        for load in made.loads_of(settings[made.frictions[-1]]):
            changes = {one: _change(curves, setting, load) for one, setting in settings.items()}
            out.append({"tilt": tilt, "axial_n": load, **changes})
    return out


def scan_loads(design: Design) -> list[float]:
    """The lightest, the middle and the heaviest axial load."""
    return [design.loads[0], design.loads[len(design.loads) // 2], design.loads[-1]]


def scan_tasks(design: Design, registry: Registry) -> list[Task]:
    """K at the lowest and highest speed over the shaft's tilt stiffness, one task an axial load."""
    setting = swapped("shaft", {}, design.bodies)
    tasks = []
    for load in scan_loads(design):
        points = []
        for stiffness in STIFFNESSES:
            for speed in (design.speeds[0], design.speeds[-1]):
                tables = design.point(setting, load, speed, registry)
                points.append(with_value(tables, "supports.tilt", stiffness))
        tasks.append(Task(f"tilt stiffness at {load:g} N", curve, points))
    return tasks


def hardening(rows: list[Row]) -> np.ndarray:
    """k*(1) over the stiffnesses (n,); nan where a run failed."""
    k = np.array([row["k"] if row["status"] == "completed" else np.nan for row in rows]).reshape(-1, 2)
    return np.asarray(k[:, 1] / k[:, 0])


def turning_point(ratio: np.ndarray) -> float | None:
    """Tilt stiffness above which k falls with speed instead of rising [N m/rad]; None where it does not turn.

    Notes
    -----
    Straight lines over the logarithm of the stiffness; the first crossing.
    """
    x = np.log(np.array(STIFFNESSES))
    for k in range(len(ratio) - 1):
        first, second = ratio[k] - 1.0, ratio[k + 1] - 1.0
        if first > 0.0 >= second:
            return float(np.exp(x[k] + (x[k + 1] - x[k]) * first / (first - second)))
    return None
