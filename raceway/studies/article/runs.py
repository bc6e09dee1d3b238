"""Pieces of work, each in a process of its own: curves over speed, the scan of the shaft's tilt stiffness, quasi-static trends.

The trends are those of an independent rigid-ring solver: secant stiffness F0 / y under the rig's force as a radial load towards
ball 0, balls fixed, no inertia of the ring: the article's bearing with rigid bodies, whatever scene the study is given.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from raceway.errors import ConvergenceError, RacewayError, Status
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.points.attractor import FAILED, Instead, from_rest, instead_of
from raceway.points.engine import Item, local, work_through
from raceway.points.store import RowStore, program_key
from raceway.scene.changes import with_value
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.article.design import AMPLITUDES, DIRECTIONS, TILTS, Curves, Design, Setting, article_tables

Row = Tables
#: Turns of the motion that is integrated where no ring stays on a steady one; half of them are judged.
TURNS = 800


@attrs.frozen
class Task:
    """A piece of work: its name, and the function in this package that computes its rows from ``given``.

    Attributes
    ----------
    function : called as ``function(given, registry)``; it can be sent to another process
    given : plain values, which with the program's sources decide the rows
    """

    name: str
    function: Callable[[Any, Registry], list[Row]]
    given: Any

    def key(self, program: str) -> str:
        text = json.dumps([self.function.__qualname__, self.given, program], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:24]


def curve(points: Sequence[Tables], registry: Registry) -> list[Row]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    Where the steady motion is unstable, or none is found, ``instead`` tells what a ring does, by time integration: from beside
    that motion, or from rest.

    Parameters
    ----------
    points : tables of scenes
    """
    return [_row(tables, registry) for tables in points]


def _row(tables: Tables, registry: Registry) -> Row:
    row: Row = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
    try:
        scene = scene_from_dict(tables, registry)
        try:
            result = run(scene, registry)
        except ConvergenceError as why:
            if not scene.integrator.method.steady:
                raise
            motion = from_rest(scene, row["speed_rpm"], TURNS)
            if motion.kind == FAILED:
                raise
            reason = f"{' '.join(str(why).split()).partition(': ')[0]}; instead, from rest: {motion.words}"
            return {**row, "status": Status.UNSTEADY, "reason": reason, "instead": _plain(motion)}
    except RacewayError as why:
        return {**row, "status": why.status, "reason": " ".join(str(why).split())}
    found, error = result.identification, result.error
    assert found is not None
    fate = result.stability["floquet"]
    unstable = fate is not None and fate["verdict"] == "unstable"
    if unstable:
        motion = instead_of(result, row["speed_rpm"], TURNS)
        row["instead"] = _plain(motion)
        grows = f"the steady motion is unstable, disturbances grow {fate['largest']:.4g} times a turn"
    return {
        **row,
        "status": Status.UNSTABLE if unstable else Status.COMPLETED,
        "reason": f"{grows}; instead: {motion.words}" if unstable else "",
        "found": None if fate is None else fate["found"],
        "k": found.equivalent_stiffness,
        "abs_z": abs(found.dynamic_stiffness),
        "force_n": found.force_amplitude,
        "error": None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0),
        "mesh_error": error["mesh"],
    }


def _plain(motion: Instead) -> Row:
    """Without the section, which a page of hundreds of points has no use for."""
    return {name: value for name, value in motion.to_dict().items() if name != "section"}


def work(
    tasks: Sequence[Task],
    processes: int,
    store: RowStore,
    registry: Registry,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> tuple[list[list[Row]], int]:
    """Rows of every task, in order, and how many tasks were taken from the store; see ``raceway.points.engine``."""
    program = program_key(registry)
    items = [Item(task.key(program), task.name, task) for task in tasks]
    done, reused = work_through(_rows, items, store, local(registry, processes), registry, plugins, on_progress)
    return [row["rows"] for row in done], reused


def _rows(task: Task, registry: Registry) -> Tables:
    return {"rows": task.function(task.given, registry)}


SPEEDS = (10980.0, 12000.0, 13000.0, 14000.0, 15000.0)
#: (tilt, axial load [N], ball inertia): k at 10 980 r/min [N/um], k / that at the other speeds; docs/physics.md says whose.
TRENDS: dict[tuple[str, float, bool], tuple[float, tuple[float, ...]]] = {
    ("locked", 400.0, False): (180.1, (0.991, 0.979, 0.960, 0.926)),
    ("locked", 400.0, True): (163.0, (0.932, 0.848, 0.756, 0.668)),
    ("locked", 1000.0, False): (237.5, (0.999, 0.997, 0.995, 0.992)),
    ("locked", 1000.0, True): (235.3, (0.994, 0.987, 0.976, 0.962)),
    ("locked", 2000.0, False): (286.4, (1.000, 0.999, 0.999, 0.998)),
    ("locked", 2000.0, True): (285.8, (0.999, 0.997, 0.995, 0.993)),
    ("free", 400.0, False): (24.47, (1.084, 1.172, 1.266, 1.365)),
    ("free", 400.0, True): (24.32, (1.081, 1.167, 1.259, 1.356)),
    ("free", 1000.0, False): (34.34, (1.035, 1.075, 1.120, 1.169)),
    ("free", 1000.0, True): (34.30, (1.034, 1.074, 1.118, 1.167)),
    ("free", 2000.0, False): (48.39, (1.012, 1.026, 1.044, 1.064)),
    ("free", 2000.0, True): (48.37, (1.012, 1.026, 1.043, 1.063)),
}


@attrs.frozen
class Trend:
    """One row: expected and computed k at the first speed [N/um] and the ratios at the others; None where a run failed."""

    tilt: str
    load: float
    inertia: bool
    expected: tuple[float, ...]
    computed: tuple[float, ...] | None
    why: str = ""

    @property
    def off(self) -> float | None:
        """Largest difference in units of the last printed digit."""
        if self.computed is None:
            return None
        units = (last_digit(self.expected[0]), *(1e-3 for _ in self.expected[1:]))
        pairs = zip(self.computed, self.expected, units, strict=True)
        return max(abs(found - wanted) / unit for found, wanted, unit in pairs)

    @property
    def holds(self) -> bool:
        """Rounds to the printed digits: within half a unit of the last one."""
        return self.off is not None and self.off <= 0.5

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "off_in_last_digits": self.off, "holds": self.holds}


def last_digit(value: float) -> float:
    """Unit of the last digit of a number that is printed with four digits."""
    return float(10.0 ** (math.floor(math.log10(abs(value))) - 3))


def secants(given: tuple[str, float, bool], registry: Registry) -> list[Tables]:
    """Secant stiffness [N/m] at the five speeds; a task of ``runs.work``.

    Parameters
    ----------
    given : tilt, axial load, ball inertia
    """
    tilt, load, inertia = given
    article = article_tables()
    excitation = article["excitation"]
    moment = excitation["load_share"] * excitation["unbalance"]
    rows = []
    for speed in SPEEDS:
        force = moment * (speed * math.pi / 30.0) ** 2
        tables = {
            "title": "quasi-static secant",
            "bearing": article["bearing"],
            "supports": {"tilt": tilt},
            "load": {"axial": load, "radial": [force, 0.0]},
            "kinematics": {"ball_inertia": inertia, "spin_speed_rpm": speed},
        }
        try:
            result = run(scene_from_dict(tables, registry), registry)
        except RacewayError as error:
            rows.append({"speed_rpm": speed, "status": "failed", "reason": " ".join(str(error).split())})
            continue
        rows.append({"speed_rpm": speed, "status": "completed", "k": force / float(result.equilibrium.displacement[1])})
    return rows


def trend(given: tuple[str, float, bool], rows: Sequence[Tables]) -> Trend:
    """The row of a table from what ``secants`` found."""
    tilt, load, inertia = given
    first, ratios = TRENDS[tilt, load, inertia]
    bad = [row for row in rows if row["status"] != "completed"]
    if bad:
        return Trend(tilt, load, inertia, (first, *ratios), None, bad[0]["reason"])
    k = [row["k"] for row in rows]
    return Trend(tilt, load, inertia, (first, *ratios), (k[0] / 1e6, *(one / k[0] for one in k[1:])))


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
