"""``raceway study article``: curves over speed, each in a process of its own, and everything that is made from them."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import ConvergenceError, RacewayError, Status
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.result import without_nan
from raceway.pipeline.run import run
from raceway.pipeline.simulate import OnProgress
from raceway.points.attractor import FAILED, Instead, from_rest, instead_of
from raceway.points.engine import Item, local, processor_time, reference_cases, work_through
from raceway.points.store import RowStore, program_key
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article import trends
from raceway.studies.article.claims import verdicts
from raceway.studies.article.design import ANSWERED, TILTS, Curves, Design, Setting
from raceway.studies.article.rules import Verdict
from raceway.studies.article.trends import Trend
from raceway.studies.verify import study as verification

PROCESSES = 2
#: Speeds [r/min] and axial loads [N] of the rig, section 3.3 of the article.
RIG_SPEEDS, RIG_LOADS = (11000.0, 13000.0, 15000.0), (400.0, 2000.0)
#: Turns of the motion that is integrated where no ring stays on a steady one; half of them are judged.
TURNS = 800
_STATIC = "seed-static-pressures"


def failure(why: RacewayError) -> Tables:
    """Status of a run that ended with an error, and the reason in one line."""
    return {"status": why.status, "reason": " ".join(str(why).split())}


def curve(points: Sequence[Tables], registry: Registry) -> list[Tables]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    Where the steady motion is unstable, or none is found, ``instead`` states what a ring does, by time integration: from beside
    that motion, or from rest.

    Parameters
    ----------
    points : tables of scenes
    """
    return [_row(tables, registry) for tables in points]


def _row(tables: Tables, registry: Registry) -> Tables:
    row: Tables = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
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
        return {**row, **failure(why)}
    identified, error, floquet = result.identification, result.error, result.stability["floquet"]
    assert identified is not None
    status, reason = Status.COMPLETED, ""
    if floquet is not None and floquet["verdict"] == "unstable":
        motion = instead_of(result, row["speed_rpm"], TURNS)
        row["instead"] = _plain(motion)
        grows = f"the steady motion is unstable, disturbances grow {floquet['largest']:.4g} times a turn"
        status, reason = Status.UNSTABLE, f"{grows}; instead: {motion.words}"
    return {
        **row,
        "status": status,
        "reason": reason,
        "found": None if floquet is None else floquet["found"],
        "k": identified.equivalent_stiffness,
        "abs_z": abs(identified.dynamic_stiffness),
        "force_n": identified.force_amplitude,
        "error": None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0),
        "mesh_error": error["mesh"],
    }


def _plain(motion: Instead) -> Tables:
    """Without the section, which a page of hundreds of points has no use for."""
    return {name: value for name, value in motion.to_dict().items() if name != "section"}


def static_pressures(case: str, registry: Registry) -> list[Tables]:
    """Rows of the article's static verification, as ``raceway verify`` computes it."""
    return [attrs.asdict(row) for row in verification.compute(reference_cases()[case], registry)]


#: Name of a task, the function that computes its rows here or in another process, and what that takes, plain values.
Task = tuple[str, Callable[[Any, Registry], list[Tables]], Any]


def _tasks(design: Design, registry: Registry) -> list[Task]:
    """All that is run: static pressures, quasi-static trends, the scan of the tilt stiffness, the rig's points, the curves."""

    def points(setting: Setting, loads: Sequence[float], speeds: Sequence[float]) -> list[Tables]:
        return [design.point(setting, load, speed, registry) for load in loads for speed in speeds]

    tasks: list[Task] = [("static verification", static_pressures, _STATIC)]
    tasks += [("quasi-static trends", trends.secants, list(case)) for case in trends.TRENDS]
    for load in trends.scan_loads(design):
        tasks.append((f"tilt stiffness at {load:g} N", curve, trends.scan_points(design, load, registry)))
    tasks += [("the rig's speeds", curve, points(setting, RIG_LOADS, RIG_SPEEDS)) for setting in _rig_settings(design)]
    for setting, load in design.tasks():
        name = "curves over speed" if setting.friction == "none" else "curves over speed, friction"
        tasks.append((name, curve, points(setting, [load], design.speeds_of(setting))))
    return tasks


def _rig_settings(design: Design) -> list[Setting]:
    return [trends.base(tilt, [bodies]) for bodies in design.bodies for tilt in TILTS]


def _rows(task: Task, registry: Registry) -> Tables:
    _, function, inputs = task
    return {"rows": function(inputs, registry)}


@attrs.frozen(eq=False, slots=False)
class Article:
    """The study's numbers, with verdicts, page, pictures and tables made from them.

    Attributes
    ----------
    curves : K and |Z| of every setting;  rig : rows at the rig's speeds and loads, with their tilt boundary
    static : rows of the static verification;  trends : quasi-static trends against an independent solver
    scan : axial load -> rows over the shaft's tilt stiffness at the lowest and highest speed
    seconds, cpu_s : wall and processor time, of which ``own_cpu_s`` in this process
    reused : tasks that were taken from the folder, of ``tasks``;  fault : why rows could not be stored; None where they were
    """

    title: str
    curves: Curves
    rig: tuple[Tables, ...]
    static: tuple[Tables, ...]
    trends: tuple[Trend, ...]
    scan: dict[float, list[Tables]]
    seconds: float
    cpu_s: float
    own_cpu_s: float
    tasks: int
    reused: int
    fault: RacewayError | None = None

    @cached_property
    def verdicts(self) -> list[Verdict]:
        return verdicts(self.curves, self.static)

    @property
    def failed(self) -> list[Tables]:
        """Runs that failed or were refused, of curves, rig and scan; not points at which it is known what a ring does instead."""
        rows = [*self.curves.faults(), *self.rig, *(row for rows in self.scan.values() for row in rows)]
        return [row for row in rows if row["status"] not in ANSWERED]

    @property
    def runs(self) -> int:
        """How many motions were sought: steady orbits, and with friction transients."""
        return sum(map(len, [*self.curves.rows.values(), self.rig, *self.scan.values()]))

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        design = self.curves.design
        rows = [
            {**attrs.asdict(setting), **row, "relative_speed": w}
            for (setting, _), curve_rows in self.curves.rows.items()
            for row, w in zip(curve_rows, design.relative(design.speeds_of(setting)), strict=True)
        ]
        ratios = {load: trends.hardening(rows) for load, rows in self.scan.items()}
        content: Tables = without_nan(
            {
                "title": self.title,
                "scene": design.tables,
                "speeds_rpm": design.speeds,
                "axial_n": design.loads,
                "shaft_tilt_stiffness": design.shaft,
                "bodies": design.bodies,
                "friction": design.friction if len(design.frictions) > 1 else 0.0,
                "friction_trends": trends.friction_trends(self.curves),
                "verdicts": [verdict.to_dict() for verdict in self.verdicts],
                "quasi_static": [trend.to_dict() for trend in self.trends],
                "static": self.static,
                "rig": self.rig,
                "causes": {f"{load:g}": dict(trends.one_at_a_time(self.curves, load)) for load in design.loads},
                "tilt_stiffness": [
                    {"axial_n": load, "stiffness": trends.STIFFNESSES, "ratio": ratio.tolist(), "turning_point": trends.turning_point(ratio)}
                    for load, ratio in ratios.items()
                ],
                "rows": rows,
                "runs": self.runs,
                "failed": len(self.failed),
                "cost": {"wall_s": self.seconds, "cpu_s": self.cpu_s, "own_cpu_s": self.own_cpu_s, "tasks": self.tasks, "reused": self.reused},
            }
        )  # fmt: skip
        return content

    def tables(self, content: ReadTables) -> dict[str, list[Tables]]:
        """Name -> rows of each table that is written as CSV.

        Parameters
        ----------
        content : ``to_dict()``
        """
        scan = [
            {"axial_n": line["axial_n"], "tilt_stiffness": stiffness, "k_ratio": ratio}
            for line in content["tilt_stiffness"]
            for stiffness, ratio in zip(line["stiffness"], line["ratio"], strict=True)
        ]
        return {
            "curves": content["rows"],
            "verdicts": [verdict.row() for verdict in self.verdicts],
            "quasi-static": [trend.row() for trend in self.trends],
            "static": list(self.static),
            "rig": list(self.rig),
            "friction": content["friction_trends"],
            "tilt-stiffness": scan,
        }


def article(
    design: Design,
    processes: int = PROCESSES,
    store: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> Article:
    """Run the study.

    Parameters
    ----------
    design : by ``raceway.studies.article.design.design``
    processes : how many work at a time; 0 works in this one
    store : file that finished curves are stored in and taken from
    plugins : one-off plug-in files, which each process loads
    on_progress : called as ``on_progress(what, done, total)``; an exception stops the study

    Raises
    ------
    SceneError
        A mistake in the scene; nothing has been run.
    KeyboardInterrupt
        Finished curves are in ``store``.
    """
    begun, cpu, own_cpu = time.monotonic(), processor_time(), time.process_time()
    registry = registry or default_registry()
    for setting in design.settings():  # mistakes are refused before anything is run
        title = scene_from_dict(design.point(setting, design.loads[0], design.speeds[0], registry), registry).title
    rows, program = RowStore(store), program_key(registry)
    items = []
    for name, function, inputs in (tasks := _tasks(design, registry)):
        text = json.dumps([function.__qualname__, inputs, program], sort_keys=True, default=str)
        items.append(Item(hashlib.sha256(text.encode()).hexdigest()[:24], name, (name, function, inputs)))
    finished, reused = work_through(_rows, items, rows, local(registry, processes), registry, plugins, on_progress)
    results = iter([row["rows"] for row in finished])
    static = next(results)
    compared = [trends.trend(case, next(results)) for case in trends.TRENDS]
    scan = {load: next(results) for load in trends.scan_loads(design)}
    rig = [{"tilt": s.tilt, "bodies": s.bodies, **row} for s in _rig_settings(design) for row in next(results)]
    curves = Curves(design, dict(zip(design.tasks(), results, strict=True)))
    taken = time.monotonic() - begun, processor_time() - cpu, time.process_time() - own_cpu
    return Article(title, curves, tuple(rig), tuple(static), tuple(compared), scan, *taken, len(tasks), reused, rows.fault)
