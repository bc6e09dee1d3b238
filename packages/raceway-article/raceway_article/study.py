"""``raceway study article``: curves over speed, each in a process of its own, and what the trend of K with speed depends on."""

import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import attrs
import numpy as np
from raceway_checks.clocks import processor_time
from raceway_checks.verify import study as verification
from raceway_checks.verify.reference import Verified, reference_cases

from raceway import Answer, ConvergenceError, RacewayError, scene_from_dict
from raceway.extend import (
    Fact, Item, OnProgress, Part, ReadTables, Registry, Tables, Words, Workload, local, program_key, run_times, stored_rows,
    tables_key, with_value, without_nan, work_through, written,
)  # fmt: skip
from raceway_article.claims import verdicts
from raceway_article.design import (
    AMPLITUDES, ANSWERED, DIRECTIONS, ROTATING, STIFFNESSES, TILTS, Curve, Curves, Design, Setting, hardening,
)  # fmt: skip
from raceway_article.rows import loop_of, rows_of_curve
from raceway_article.rules import KINDS, Verdict
from raceway_article.trends import TRENDS, Trend, secants, trend

#: Swaps of one choice against the article's bidirectional model with ball inertia; the first changes nothing.
_SWAPS: dict[str, Tables] = {
    "rotating force m e w², ball inertia": {},
    "direction swapped: unidirectional force m e w²": {"direction": DIRECTIONS[0]},
    "amplitude law swapped: rotating force, constant": {"amplitude": AMPLITUDES[0]},
    "both swapped: unidirectional force, constant": {"direction": DIRECTIONS[0], "amplitude": AMPLITUDES[0]},
    "weightless balls": {"inertia": False},
    "condensed bodies": {"bodies": "condensed"},
    "friction, balls that stand": {"friction": "standing"},
    "friction, balls that orbit": {"friction": "orbiting"},
}


def _base(tilt: str, bodies: Sequence[str]) -> Setting:
    """The article's model: rigid bodies where they are run."""
    return Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid" if "rigid" in bodies else bodies[0])


def _one_at_a_time(curves: Curves, load: float) -> list[tuple[str, dict[str, float | str]]]:
    """Of each swap that is run at a load the ``_change`` of K at each tilt boundary."""
    rows = []
    for name, swap in _SWAPS.items():
        settings = {tilt: attrs.evolve(_base(tilt, curves.design.bodies), **swap) for tilt in TILTS}
        if (settings[TILTS[0]], load) in curves.rows:  # with friction every other axial load is run
            rows.append((name, {tilt: _change(curves.curve(setting, load)) for tilt, setting in settings.items()}))
    return rows


def _change(curve: Curve) -> float | str:
    """k*(1) - 1, or why there is no number: "unstable", "failed", "refused"."""
    value = curve.normalised()[-1] - 1.0
    ends = [curve.rows[end]["status"] for end in (0, -1)]
    return float(value) if np.isfinite(value) else str(next(status for status in ends if status != "completed"))


def _friction_trends(curves: Curves) -> list[Tables]:
    """k*(1) - 1 under the rotating force m e w^2 for each kind of friction: ``tilt``, ``axial_n``, ``none`` and so on."""
    design, rows = curves.design, []
    for tilt in TILTS if len(design.frictions) > 1 else ():
        settings = {friction: attrs.evolve(_base(tilt, ("rigid",)), friction=friction) for friction in design.frictions}
        for load in design.loads_of(settings[design.frictions[-1]]):
            changes = {friction: _change(curves.curve(setting, load)) for friction, setting in settings.items()}
            rows.append({"tilt": tilt, "axial_n": load, **changes})
    return rows


def _scan_loads(design: Design) -> list[float]:
    """The lightest, the middle and the heaviest axial load."""
    return [design.loads[0], design.loads[len(design.loads) // 2], design.loads[-1]]


def _turning_point(ratio: np.ndarray) -> float | None:
    """Tilt stiffness above which k falls with speed instead of rising [N m/rad]; None where it does not turn.

    Straight lines over the logarithm of the stiffness; the first crossing.
    """
    x = np.log(np.array(STIFFNESSES))
    for k in range(len(ratio) - 1):
        first, second = ratio[k] - 1.0, ratio[k + 1] - 1.0
        if first > 0.0 >= second:
            return float(np.exp(x[k] + (x[k + 1] - x[k]) * first / (first - second)))
    return None


#: Speeds [r/min] and axial loads [N] of the rig, section 3.3 of the article.
RIG_SPEEDS, RIG_LOADS = (11000.0, 13000.0, 15000.0), (400.0, 2000.0)
_STATIC = "seed-static-pressures"


def _static_pressures(case: str, registry: Registry) -> list[Tables]:
    """Rows of the article's static verification, as ``raceway verify`` computes it."""
    return [attrs.asdict(row) for row in verification.compute(reference_cases()[case], registry)]


#: Name of a task, the function that computes its rows here or in another process, and what that takes, plain values.
_Task = tuple[str, Callable[[Any, Registry], list[Tables]], Any]


def _rig_settings(design: Design) -> list[Setting]:
    return [_base(tilt, [bodies]) for bodies in design.bodies for tilt in TILTS]


def _rows(task: _Task, registry: Registry) -> Tables:
    _, compute, inputs = task
    return {"rows": compute(inputs, registry)}


@attrs.frozen(eq=False, repr=False, slots=False)
class Article(Answer):
    """The study's numbers, with verdicts, page, pictures and tables made from them.

    curves : K and |Z| of every setting;  rig : rows at the rig's speeds and loads, with their tilt boundary
    static : rows of the static verification;  trends : quasi-static trends against an independent solver
    scan : axial load -> rows over the shaft's tilt stiffness at the lowest and highest speed
    seconds, cpu_s : wall and processor time, of which ``own_cpu_s`` in this process
    reused : tasks that were taken from the folder, of ``tasks``;  fault : why rows could not be stored; None where they were
    command : what makes the page again
    """

    stem: ClassVar[str] = "article"

    title: str
    curves: Curves
    rig: tuple[Tables, ...]
    static: tuple[Verified, ...]
    trends: tuple[Trend, ...]
    scan: dict[float, list[Tables]]
    seconds: float
    cpu_s: float
    own_cpu_s: float
    tasks: int
    reused: int
    fault: RacewayError | None = None
    command: str = "raceway study article"

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
        ratios = {load: hardening(rows) for load, rows in self.scan.items()}
        content: Tables = without_nan(
            {
                "title": self.title,
                "scene": design.tables,
                "speeds_rpm": design.speeds,
                "axial_n": design.loads,
                "shaft_tilt_stiffness": design.shaft,
                "bodies": design.bodies,
                "friction": design.friction if len(design.frictions) > 1 else 0.0,
                "friction_trends": _friction_trends(self.curves),
                "verdicts": [verdict.to_dict() for verdict in self.verdicts],
                "quasi_static": [trend.to_dict() for trend in self.trends],
                "static": list(map(attrs.asdict, self.static)),
                "rig": self.rig,
                "causes": {f"{load:g}": dict(_one_at_a_time(self.curves, load)) for load in design.loads},
                "tilt_stiffness": [
                    {"axial_n": load, "stiffness": STIFFNESSES, "ratio": ratio.tolist(), "turning_point": _turning_point(ratio)}
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
        """Name -> rows of each table that is written as CSV, from ``to_dict()``."""
        scan = [
            {"axial_n": line["axial_n"], "tilt_stiffness": stiffness, "k_ratio": ratio}
            for line in content["tilt_stiffness"]
            for stiffness, ratio in zip(line["stiffness"], line["ratio"], strict=True)
        ]
        return {
            "curves": content["rows"],
            "verdicts": [verdict.row() for verdict in self.verdicts],
            "quasi-static": [trend.row() for trend in self.trends],
            "static": content["static"],
            "rig": list(self.rig),
            "friction": content["friction_trends"],
            "tilt-stiffness": scan,
        }

    def save(self, folder: str | Path, pictures: bool | str = False) -> list[Path]:
        """Write JSON and CSV tables, and where ``pictures`` asks for them the figures and the page, which comes first.

        RacewayError: matplotlib is missing, or a folder or disk that cannot be written.
        """
        from raceway_article.figures import drawings
        from raceway_article.page import page, write_tables

        folder, content, drawn = Path(folder), self.to_dict(), drawings(self.curves, self.scan) if pictures else []
        files = write_tables("article", content, self.tables(content), drawn, folder, pictures)
        if not pictures:
            return files
        view = page(content, self.curves.design.scene_load, self.scan, drawn, self.command)
        return [view.write(folder / "article.html"), *files]

    def failure(self) -> RacewayError | None:
        rows = [row for curve_rows in self.curves.rows.values() for row in curve_rows]
        if self.fault is None and all(row["status"] == "failed" for row in rows):
            return ConvergenceError(f"every run failed; the first reason: {rows[0]['reason']}")
        return self.fault

    def _facts(self) -> tuple[str, list[Fact]]:
        return self.title, [(f"claim {verdict.number}", verdict.kind, verdict.region) for verdict in self.verdicts]

    def report(self) -> Iterator[Part]:
        """What stands and what decides it, a line a verdict, the check against an independent solver, failures and cost."""
        from raceway_article.page import lead

        yield Words(self.title, "bold")
        yield from lead(self.to_dict(), self.curves.design.scene_load)
        yield [{"": v.number, "claim": v.claim, "verdict": KINDS[v.kind][2], "where": v.where} for v in self.verdicts]
        if unsure := [verdict.number for verdict in self.verdicts if verdict.failed]:
            yield Words(f"some runs failed or are unstable: {', '.join(unsure)}; which ones: article.json", "dim")
        equal = sum(trend.holds for trend in self.trends)
        yield Words(f"trends equal to an independent solver's printed digits: {equal} of {len(self.trends)}", "dim")
        cost = f"{self.runs} points, {len(self.failed)} failed; {self.seconds:.0f} s, {self.cpu_s:.0f} s of processor time"
        yield Words(cost + (f"; {self.reused} of {self.tasks} pieces taken from earlier" if self.reused else ""), "dim")


def _items(design: Design, registry: Registry) -> list[Item]:
    items, program = list[Item](), program_key(registry)

    # All that is run
    def points(setting: Setting, loads: Sequence[float], speeds: Sequence[float]) -> list[Tables]:
        return [design.point(setting, load, speed, registry) for load in loads for speed in speeds]

    tasks: list[_Task] = [("static verification", _static_pressures, _STATIC)]
    tasks += [("quasi-static trends", secants, list(case)) for case in TRENDS]
    for load in _scan_loads(design):
        ends = points(_base("shaft", design.bodies), [load], [design.speeds[0], design.speeds[-1]])
        scan = [with_value(tables, "supports.tilt", stiffness) for stiffness in STIFFNESSES for tables in ends]
        tasks.append((f"tilt stiffness at {load:g} N", rows_of_curve, scan))
    for setting in _rig_settings(design):
        tasks.append(("the rig's speeds", rows_of_curve, points(setting, RIG_LOADS, RIG_SPEEDS)))
    for group in design.curves():
        inputs = [tables for setting, load in group for tables in points(setting, [load], design.speeds_of(setting))]
        tasks.append(("curves over speed", rows_of_curve, inputs))
    for name, compute, inputs in tasks:
        key = tables_key({"function": compute.__qualname__, "inputs": inputs}, registry, program=program)
        items.append(Item(key, name, (name, compute, inputs)))
    return items


#: Part of the loop's points that are run, too, most because they are far from linear, some to continue their motion: 171 of 1296 of the article's own scene.
_AGAIN = 0.13


def workload(design: Design, processes: int, kept: Path | None, registry: Registry) -> Workload:
    """Points of the curves over speed, which take nearly all of the time."""
    groups = design.curves()
    items = _items(design, registry)[-len(groups) :]
    left = [at for group, item in zip(groups, items, strict=True) if not stored_rows(kept, [item.key]) for at in group]
    points = [(setting, load, speed) for setting, load in left for speed in design.speeds_of(setting)]
    starts = {setting: design.point(setting, load, speed, registry) for setting, load, speed in points}
    loops = [setting for setting, start in starts.items() if loop_of([start], registry)[0] is not None]
    alone, looped = ([point for point in points if (point[0] in loops) == loop] for loop in (False, True))
    runs_s, refusal = run_times(len(alone), lambda n: scene_from_dict(design.point(*alone[n], registry), registry))
    again_s, refused = run_times(len(looped), lambda n: scene_from_dict(design.point(*looped[n], registry), registry))
    size = sum(len(design.speeds_of(setting)) for group in groups for setting, _ in group)
    seconds = (runs_s + _AGAIN * again_s) / max(processes, 1)
    in_loop, in_runs = max(len(looped) - refused, 0), max(len(alone) - refusal, 0)
    counts = size, seconds, in_loop, in_runs, refusal + refused, size - len(points)
    remark = f"Points of the loop that are unstable or far from linear are run, too: counted are {_AGAIN:.0%} of them."
    return Workload(str(design.tables["title"]), *counts, why_runs="no compiled loop has them", remarks=(remark,))


def solve_curves(
    design: Design,
    processes: int,
    kept: Path | None,
    registry: Registry,
    plugins: Sequence[Path],
    on_progress: OnProgress,
    command: str,
) -> Article:
    """Compute everything but the finished curves in the folder ``kept``; with all mistakes of the scenes refused first.

    processes : how many work at a time; 0 works in this one
    plugins : one-off plug-in files, which each process loads
    command : what makes the page again
    """
    start, cpu, own_cpu = time.monotonic(), processor_time(), time.process_time()
    for setting in design.settings():  # mistakes are refused before anything is run
        title = scene_from_dict(design.point(setting, design.loads[0], design.speeds[0], registry), registry).title
    items = _items(design, registry)
    with written(kept) as store:
        answers, reused = work_through(_rows, items, store, local(registry, processes), registry, plugins, on_progress)
    results = iter([row["rows"] for row in answers])
    static = [Verified(**row) for row in next(results)]
    trends = [trend(case, next(results)) for case in TRENDS]
    scan = {load: next(results) for load in _scan_loads(design)}
    rig = [{"tilt": s.tilt, "bodies": s.bodies, **row} for s in _rig_settings(design) for row in next(results)]
    of_groups = zip(design.curves(), map(iter, results), strict=True)
    rows = {at: list(islice(row, len(design.speeds_of(at[0])))) for group, row in of_groups for at in group}
    curves = Curves(design, rows)
    costs = time.monotonic() - start, processor_time() - cpu, time.process_time() - own_cpu
    numbers = title, curves, tuple(rig), tuple(static), tuple(trends), scan
    return Article(*numbers, *costs, len(items), reused, store.fault, command)
