"""``raceway study article``: curves over speed, each in a process of its own, and what the trend of K with speed depends on.

Trends are compared with those of an independent rigid-ring solver: quasi-static secant stiffness F0 / y under the rig's force as a
radial load towards ball 0, balls fixed, no inertia of the ring; the article's bearing with rigid bodies, whatever scene the study
is run for.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any, ClassVar

import attrs
import numpy as np
from raceway_checks.verify import study as verification
from raceway_checks.verify.reference import Verified, reference_cases

from raceway import Answer, ConvergenceError, Function, RacewayError, Result, function, scene_from_dict
from raceway.extend import (
    ERROR, FAILED, FORCE_AMPLITUDE, OF_ORBITS, Attractor, Fact, Item, K, OnProgress, Part, ReadTables, Registry, Status,
    Tables, Words, Workload, Z, attractor_beside_run, attractor_from_rest, lasting, local, processor_time, program_key, run,
    run_times, stored_rows, tables_key, with_value, without_mesh, without_nan, work_through, written,
)  # fmt: skip
from raceway_article.claims import verdicts
from raceway_article.design import (
    AMPLITUDES, ANSWERED, DIRECTIONS, ROTATING, SOLVER_SPEEDS, STIFFNESSES, TILTS, Curve, Curves, Design, Setting,
    article_tables, hardening,
)  # fmt: skip
from raceway_article.rules import KINDS, Verdict

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


#: (tilt, axial load [N], ball inertia): k at 10 980 r/min [N/um], k / that at the other speeds; docs/physics.md names the solver.
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
class _Trend:
    """One row: expected and computed k at the first speed [N/um] and the ratios at the others; None where a run failed."""

    tilt: str
    load: float
    inertia: bool
    expected: tuple[float, ...]
    computed: tuple[float, ...] | None
    why: str = ""

    @property
    def off(self) -> float | None:
        """Largest difference in units of the last printed digit: k has four of them, ratios have three decimals."""
        if self.computed is None:
            return None
        first = float(10.0 ** (math.floor(math.log10(abs(self.expected[0]))) - 3))
        units = (first, *(1e-3 for _ in self.expected[1:]))
        return max(abs(k - reference) / unit for k, reference, unit in zip(self.computed, self.expected, units, strict=True))

    @property
    def holds(self) -> bool:
        """Rounds to the printed digits: within half a unit of the last one."""
        return self.off is not None and self.off <= 0.5

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "off_in_last_digits": self.off, "holds": self.holds}

    def row(self) -> Tables:
        """As a row of a flat table."""
        table = self.to_dict()
        numbers = {
            f"{name}_{k}": value for name in ("expected", "computed") for k, value in enumerate(table.pop(name) or ())
        }
        return {name: table.pop(name) for name in ("tilt", "load", "inertia", "why")} | numbers | table


def secants(case: tuple[str, float, bool], registry: Registry) -> list[Tables]:
    """Secant stiffness [N/m] at the five speeds of a case: tilt, axial load, ball inertia."""
    tilt, load, inertia = case
    article, speeds = article_tables(), np.array(SOLVER_SPEEDS)
    force = article["excitation"]["load_share"] * article["excitation"]["unbalance"] * (speeds * math.pi / 30.0) ** 2
    tables = {
        "title": "quasi-static secant",
        "bearing": article["bearing"],
        "supports": {"tilt": tilt},
        "load": {"axial": load, "radial": [0.0, 0.0]},
        "kinematics": {**article["kinematics"], "ball_inertia": inertia, "spin_speed_rpm": speeds[0]},
    }
    keys = ("load.radial[0]", "kinematics.spin_speed_rpm")
    answer = function(scene_from_dict(tables, registry), keys, ["displacement"], threads=1)(force, speeds)
    stiffness = (force / answer["displacement"][:, 1]).tolist()
    rows = zip(stiffness, answer["reason"], strict=True)
    return [without_nan({"k": k, "reason": " ".join(str(reason).split())}) for k, reason in rows]


def trend(case: tuple[str, float, bool], rows: Sequence[Tables]) -> _Trend:
    """The printed numbers of a case beside the rows of ``secants``."""
    first, ratios = TRENDS[case]
    missing = [row["reason"] for row in rows if row["k"] is None]
    k = [row["k"] for row in rows]
    computed = None if missing else (k[0] / 1e6, *(value / k[0] for value in k[1:]))
    return _Trend(*case, (first, *ratios), computed, missing[0] if missing else "")


#: Speeds [r/min] and axial loads [N] of the rig, section 3.3 of the article.
RIG_SPEEDS, RIG_LOADS = (11000.0, 13000.0, 15000.0), (400.0, 2000.0)
#: Turns of the motion that is integrated where no ring stays on a steady one; half of them are judged.
TURNS = 800
_STATIC = "seed-static-pressures"
#: What a row has of the compiled loop, and what decides whether that is the motion of a run: one whose stiffness changes by less than
#: this part of its mean has no other motion beside it (of 1296 points in the study, two have one from a change of 0.11 on).
_LOOPED = {"k": K.name, "abs_z": Z.name, "force_n": FORCE_AMPLITUDE.name, "error": ERROR.name}
_LINEAR = 0.1


def failure(why: RacewayError) -> Tables:
    """Status of a run that ended with an error, and the reason in one line."""
    return {"status": why.status, "reason": " ".join(str(why).split())}


def rows_of_curve(points: Sequence[Tables], registry: Registry) -> list[Tables]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    As in a run-up each motion is continued from that at the speed before, stable or not, and over several tilt stiffnesses from that at
    the one before; where that does not lead on, it is searched for.
    Where it is unstable, or none is found, ``instead`` states what a ring does, by time integration: from beside that motion, or from rest.
    With friction the orbit of another start is the motion without it at the same point, where that was run.

    points : tables of scenes that differ in axial load, speed and tilt stiffness; those with friction last
    """
    steady = [tables for tables in points if tables["integrator"]["kind"] == "periodic"]
    rows: list[Tables | None] = [*(_looped(steady, registry) if steady else []), *[None] * (len(points) - len(steady))]

    supports, without_friction = [tables["supports"] for tables in points], dict[tuple[float, float, int], Result | None]()

    def place(k: int) -> tuple[float, float, int, bool]:
        load, speed = points[k]["load"]["axial"], points[k]["excitation"]["speed_rpm"]
        return load, speed, supports.index(supports[k]), k >= len(steady)

    looped, near, before = {k for k, row in enumerate(rows) if row}, None, 0
    same = 1 if all(one == supports[0] for one in supports) else 2  # over stiffness: at the same speed
    for k in sorted(range(len(points)), key=place):
        at, follows = place(k)[:3], place(before)[:same] == place(k)[:same]
        near = near if follows else None
        if k in looped:
            before, near = k, None
        elif k >= len(steady):
            rows[k], _ = _point_row(points[k], registry, without_friction.get(at))
        else:
            if follows and before in looped:
                near = _neighbour(points[before], registry)
            row, result = _point_row(points[k], registry, near)
            rows[k], before, without_friction[at] = row, k, result
            near = result if row["status"] == Status.COMPLETED or row.get("found") == "directly" else near
    return [row for row in rows if row]


def _neighbour(tables: Tables, registry: Registry) -> Result | None:
    """The motion of a point that the compiled loop found, to continue; None where a run finds none."""
    try:
        return run(scene_from_dict(tables, registry), registry, stay=True)
    except RacewayError:
        return None


def _looped(points: Sequence[Tables], registry: Registry) -> Sequence[Tables | None]:
    """Rows of steady orbits that a compiled loop finds, that are not unstable, and beside which there is no other one; None elsewhere."""
    f, numbers = _loop_of(points, registry)
    if f is None:
        return [None] * len(points)
    answer = f.looped(numbers)
    multiplier, change = (answer[name] for name in OF_ORBITS)
    return [
        {
            "speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"], "status": Status.COMPLETED,
            "reason": "", "found": "directly", "mesh_error": None, **{key: float(answer[name][point]) for key, name in _LOOPED.items()},
        }
        if lasting(multiplier[point]) and change[point] <= _LINEAR
        else None
        for point, tables in enumerate(points)
    ]  # fmt: skip


def _loop_of(points: Sequence[Tables], registry: Registry) -> tuple[Function | None, dict[str, np.ndarray]]:
    """The compiled loop of a curve, None where it has none or states no error of a mesh, and what varies along the curve."""
    paths = {"load.axial": "axial", "excitation.speed_rpm": "speed_rpm", "supports.tilt": "tilt"}
    columns = {key: [tables[key.partition(".")[0]][name] for tables in points] for key, name in paths.items()}
    numbers = {key: np.array(column, dtype=float) for key, column in columns.items() if not isinstance(column[0], str)}
    try:
        f = function(scene_from_dict(points[0], registry), numbers, [*_LOOPED.values(), *OF_ORBITS], threads=1)
    except RacewayError:  # its row says why
        return None, numbers
    return (None if f.why_slow or not f.contacts_alone else f), numbers


def _point_row(tables: Tables, registry: Registry, near: Result | None) -> tuple[Tables, Result | None]:
    """The row of a run, continued from ``near``, and its result."""
    row: Tables = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
    try:
        scene = scene_from_dict(tables, registry)
        try:
            result = run(scene, registry, near=near, stay="unstable")
        except ConvergenceError as why:
            if not scene.integrator.method.steady:
                raise
            motion = attractor_from_rest(scene, row["speed_rpm"], TURNS)
            if motion.kind == FAILED:
                raise
            reason = f"{' '.join(str(why).split()).partition(': ')[0]}; instead, from rest: {motion.words}"
            return {**row, "status": Status.UNSTEADY, "reason": reason, "instead": _plain_row(motion)}, None
    except RacewayError as why:
        return {**row, **failure(why)}, None
    identification, error, floquet = result.identification, result.error, result.stability["floquet"]
    assert identification is not None
    status, reason = Status.COMPLETED, ""
    if floquet is not None and floquet["verdict"] == "unstable":
        motion = attractor_beside_run(result, row["speed_rpm"], TURNS)
        row["instead"] = _plain_row(motion)
        grows = f"the steady motion is unstable, disturbances grow {floquet['largest']:.4g} times per turn"
        status, reason = Status.UNSTABLE, f"{grows}; instead: {motion.words}"
    numbers = {"k": K.of(result), "abs_z": abs(identification.dynamic_stiffness), "force_n": identification.force_amplitude}
    errors = {"error": without_mesh(error), "mesh_error": error["mesh"]}
    return {**row, "status": status, "reason": reason, "found": floquet and floquet["found"], **numbers, **errors}, result


def _plain_row(motion: Attractor) -> Tables:
    """Without the section, which a page of hundreds of points has no use for."""
    return {name: value for name, value in motion.to_dict().items() if name != "section"}


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
    trends: tuple[_Trend, ...]
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
        yield [
            {"": one.number, "claim": one.claim, "verdict": KINDS[one.kind][2], "where": one.where} for one in self.verdicts
        ]
        if unsure := [verdict.number for verdict in self.verdicts if verdict.failed]:
            yield Words(f"some runs failed or are unstable: {', '.join(unsure)}; which ones: article.json", "dim")
        equal = sum(trend.holds for trend in self.trends)
        yield Words(
            f"quasi-static trends equal to an independent solver's printed digits: {equal} of {len(self.trends)}", "dim"
        )
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
    tasks += [
        ("the rig's speeds", rows_of_curve, points(setting, RIG_LOADS, RIG_SPEEDS)) for setting in _rig_settings(design)
    ]
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
    loops = [setting for setting, start in starts.items() if _loop_of([start], registry)[0] is not None]
    alone, looped = ([point for point in points if (point[0] in loops) == loop] for loop in (False, True))
    runs_s, refusal = run_times(len(alone), lambda n: design.point(*alone[n], registry), registry)
    again_s, refused = run_times(len(looped), lambda n: design.point(*looped[n], registry), registry)
    size, seconds = (
        sum(len(design.speeds_of(setting)) for group in groups for setting, _ in group),
        runs_s + _AGAIN * again_s,
    )
    remark = (
        f"Points of the loop that are unstable or far from linear are run in addition: counted are {_AGAIN:.0%} of them."
    )
    counts = (
        size,
        seconds / max(processes, 1),
        max(len(looped) - refused, 0),
        max(len(alone) - refusal, 0),
        refusal + refused,
        size - len(points),
    )
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
