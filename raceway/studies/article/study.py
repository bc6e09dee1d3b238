"""``raceway study article``: everything that is run, judged and written."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.result import without_nan
from raceway.pipeline.simulate import OnProgress
from raceway.points.engine import processor_time, reference_cases
from raceway.points.store import RowStore
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.article import runs
from raceway.studies.article.claims import verdicts
from raceway.studies.article.design import ANSWERED, ROTATING, TILTS, Curves, Design, Setting
from raceway.studies.article.rules import Verdict
from raceway.studies.article.runs import Row, Task, curve, work
from raceway.studies.verify import study as verification

PROCESSES = 2
#: Speeds [r/min] and axial loads [N] of the rig, section 3.3 of the article.
RIG_SPEEDS, RIG_LOADS = (11000.0, 13000.0, 15000.0), (400.0, 2000.0)
_STATIC = "seed-static-pressures"


@attrs.frozen(eq=False, slots=False)
class Article:
    """The study's numbers, with verdicts, page, pictures and tables made from them.

    Attributes
    ----------
    curves : K and |Z| of every setting;  rig : rows at the rig's speeds and loads, with their tilt boundary
    static : rows of the static verification;  trends : quasi-static trends against an independent solver
    scan : axial load -> rows over the shaft's tilt stiffness at the lowest and highest speed
    seconds, cpu_s : wall and processor time, of which ``own_cpu_s`` in this process;  reused : tasks that were taken from the folder, of ``tasks``
    """

    title: str
    curves: Curves
    rig: tuple[Row, ...]
    static: tuple[Row, ...]
    trends: tuple[runs.Trend, ...]
    scan: dict[float, list[Row]]
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
        """Runs that failed or were refused, of curves, rig and scan; points at which it is known what a ring does instead are not among them."""
        every = [*self.curves.faults(), *self.rig, *(row for rows in self.scan.values() for row in rows)]
        return [row for row in every if row["status"] not in ANSWERED]

    @property
    def runs(self) -> int:
        """How many motions were sought: steady orbits, and with friction transients."""
        return sum(map(len, [*self.curves.rows.values(), self.rig, *self.scan.values()]))

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        made = self.curves.design
        rows = [
            {**attrs.asdict(setting), **row, "relative_speed": w}
            for (setting, _), found in self.curves.rows.items()
            for row, w in zip(found, made.relative_speeds_of(setting), strict=True)
        ]
        content: Tables = without_nan(
            {
                "title": self.title,
                "scene": made.tables,
                "speeds_rpm": made.speeds,
                "axial_n": made.loads,
                "shaft_tilt_stiffness": made.shaft,
                "bodies": made.bodies,
                "friction": made.friction if len(made.frictions) > 1 else 0.0,
                "friction_trends": runs.friction_trends(self.curves),
                "verdicts": [one.to_dict() for one in self.verdicts],
                "quasi_static": [one.to_dict() for one in self.trends],
                "static": self.static,
                "rig": self.rig,
                "causes": {f"{load:g}": dict(runs.one_at_a_time(self.curves, load)) for load in made.loads},
                "tilt_stiffness": [
                    {"axial_n": load, "stiffness": runs.STIFFNESSES, "ratio": runs.hardening(rows).tolist(),
                     "turning_point": runs.turning_point(runs.hardening(rows))}
                    for load, rows in self.scan.items()
                ],
                "rows": rows,
                "runs": self.runs,
                "failed": len(self.failed),
                "cost": {"wall_s": self.seconds, "cpu_s": self.cpu_s, "own_cpu_s": self.own_cpu_s, "tasks": self.tasks, "reused": self.reused},
            }
        )  # fmt: skip
        return content


def article(
    made: Design,
    processes: int = PROCESSES,
    store: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> Article:
    """Run the study.

    Parameters
    ----------
    made : by ``raceway.studies.article.design.design``
    processes : how many work at a time; 0 works in this one
    store : file that finished curves are kept in and taken from
    plugins : one-off plug-in files, which each process loads
    on_progress : called as ``on_progress(what, done, total)``; an exception stops the study

    Raises
    ------
    SceneError
        A mistake in the scene; nothing has been run.
    KeyboardInterrupt
        Finished curves are in ``store``.
    """
    begun, cpu, own = time.monotonic(), processor_time(), time.process_time()
    registry = registry or default_registry()
    settings = made.tasks()
    title = _checked(made, registry)
    tasks = _tasks(made, settings, registry)
    kept = RowStore(store)
    found, reused = work(tasks, processes, kept, registry, plugins, on_progress)
    results = iter(found)
    static = next(results)
    trends = [runs.trend(given, next(results)) for given in runs.TRENDS]
    scan = {load: next(results) for load in runs.scan_loads(made)}
    rig = [{"tilt": s.tilt, "bodies": s.bodies, **row} for s in _rig_settings(made) for row in next(results)]
    curves = Curves(made, dict(zip(settings, results, strict=True)))
    taken = time.monotonic() - begun, processor_time() - cpu, time.process_time() - own
    return Article(title, curves, tuple(rig), tuple(static), tuple(trends), scan, *taken, len(tasks), reused, kept.fault)


def _checked(made: Design, registry: Registry) -> str:
    """Refuse mistakes before anything is run; the scene's title."""
    title = ""
    for setting in made.settings():
        title = scene_from_dict(made.point(setting, made.loads[0], made.speeds[0], registry), registry).title
    return title


def _tasks(made: Design, settings: Sequence[tuple[Setting, float]], registry: Registry) -> list[Task]:
    tasks = [Task("static verification", static_pressures, _STATIC)]
    tasks += [Task("quasi-static trends", runs.secants, list(given)) for given in runs.TRENDS]
    tasks += runs.scan_tasks(made, registry)
    for setting in _rig_settings(made):
        points = [made.point(setting, load, speed, registry) for load in RIG_LOADS for speed in RIG_SPEEDS]
        tasks.append(Task("the rig's speeds", curve, points))
    for setting, load in settings:
        points = [made.point(setting, load, speed, registry) for speed in made.speeds_of(setting)]
        what = "curves over speed" if setting.friction == "none" else "curves over speed, friction"
        tasks.append(Task(what, curve, points))
    return tasks


def _rig_settings(made: Design) -> list[Setting]:
    return [Setting(**ROTATING, tilt=tilt, inertia=True, bodies=kind) for kind in made.bodies for tilt in TILTS]


def static_pressures(case: str, registry: Registry) -> list[Row]:
    """The article's static verification, as ``raceway verify`` computes it; a task of ``runs.work``."""
    return [attrs.asdict(row) for row in verification.compute(reference_cases()[case], registry)]
