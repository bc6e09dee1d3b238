"""The article's own model: elastic rings and balls at one operating point and in four load cases, beside condensed and rigid bodies.

Runs go one at a time in this process: elastic bodies take gigabytes; each row is stored as soon as its run ends.
"""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import attrs
from raceway_checks.clocks import Clocks
from raceway_checks.verify.reference import reference_cases

from raceway import Answer, ConvergenceError, RacewayError, Scene, SceneError, make_plan, scene_from_dict
from raceway.extend import (
    C, Fact, Item, K, OnProgress, Part, ReadTables, Registry, Tables, Words, Workload, Z, local, row_key, rows_table, run,
    stored_rows, tables_at, with_value, without_nan, work_through, write_whole, written,
)  # fmt: skip
from raceway_article.design import CLAIMED, EXPLICIT, RACES, excitation_of, friction_of
from raceway_article.remaining_time import RemainingTime
from raceway_article.rows import failure

if TYPE_CHECKING:
    from raceway import Result

SCENE = Path(__file__).resolve().parent / "data" / "article_elastic.toml"
#: Condensed bodies come first: the others are compared with them, and they show in seconds whether the scene is what was meant.
BODIES = ("condensed", "rigid", "elastic")
_REFERENCE = BODIES[0]
#: One operating point: turns and steps of a turn.
TURNS, STEPS = 2, 40
#: Stiffness of a contact of elastic or rigid bodies that sticks [N/m]: it gives way by 0.8 um before it slides, a tenth of the orbit.  The
#: default of surface points, as stiff as their penalty, has Newton's method change to and fro between points that stick and slide.
#: C depends on it (rigid, 6 turns, N s/m): 65 with 1e7, 2400 with 3e7, 4860 with Mindlin's; of condensed bodies, which do not take it, 4600.
_STICK = 1e7
#: Residual of a step over the largest force: one solution with factors of elastic bodies reaches it, a second one costs as much.
_TOLERANCE = 1e-5
_CASES = "seed-static-pressures"
#: Tables that scenes at rest do not have.
_OF_MOTION = ("excitation", "integrator", "identifier")
#: Balls above this part of the largest load count as loaded.
_LOADED = 0.05
#: A displacement below this part of the axial one has no relative difference.
_NEGLIGIBLE = 1e-3
#: What a row has of the tables of result.json.
_BALL = (
    "azimuth_deg", "load_inner_n", "load_outer_n", "peak_pressure_inner_pa", "peak_pressure_outer_pa",
    "peak_pressure_nodal_inner_pa", "peak_pressure_nodal_outer_pa",
)  # fmt: skip
_IDENTIFIED = (
    "speed_rpm", "force_amplitude_n", K.name, C.name, "phase_lag_deg", "dynamic_stiffness",
    "residual", "spread",
)  # fmt: skip
_STABILITY = (
    "energy_drift", "friction_energy_j", "hourglass_energy_ratio", "critical_time_step_s", "max_penetration_m", "status",
)  # fmt: skip
_ERROR = ("total", "time_step", "transient", "mesh", "contact")

#: What is not the same with the three kinds of bodies, whatever the scene.
_DIFFERENCES = (
    "Elastic bodies: every node of rings and balls moves, with its own inertia; hexahedra by `bodies.formulation`. Each ball is held "
    "at its azimuth by an ideal cage.",
    "Condensed bodies: full integration of the hexahedra, whatever `bodies.formulation` says, on meshes of their own with the same "
    "number of points along a semi-axis; rings are rigid in inertia, balls have their mass in their meridian planes. The static kyy is "
    "a mean over the places of the points, that of elastic bodies belongs to the one place that they have.",
    "Rigid bodies: one force a contact by Hertz's law, no mesh and no points; friction sticks with Mindlin's first stiffness.",
    "Friction: in the motions only. At rest no point carries traction, so that loads, displacements and pressures are the same with it; "
    "but kyy of condensed and rigid bodies would be that of contacts which stick, of elastic ones not. Elastic bodies have "
    "friction in all directions of the contact's plane, condensed and rigid ones along the groove, in which balls do not roll. No "
    "ball rolls or orbits in any of them: what sticks stays for as long as the motion repeats itself. C is what sliding takes: contacts of "
    "elastic and rigid bodies stick with a stiffness of 1e7 N/m here, a tenth of Mindlin's, so that they hardly slide; those of condensed "
    "bodies, with the compliance of rings and balls, slide in every turn, as rigid ones do without `contact.stick_stiffness`: ten times the C.",
    "The balance of energy is summed over all steps for elastic bodies; for rigid ones it is integrated from the samples, whose "
    "distance it then shows as well; for condensed bodies with contacts at surface points there is none.",
    "Explicit steps, of elastic bodies where the scene has `integrator.kind = 'central_difference'`: without iterations, below the "
    "stable step of elements and contacts, as many a turn as that needs; `integrator.least_step` adds mass, whose share of Z is stated.",
)


@attrs.frozen
class ElasticRun:
    """One run of the study.

    bodies : of ``BODIES``;  axial, radial : load [N]
    excitation : (direction, amplitude law) of a motion; None at rest
    explicit : a motion by the scene's explicit steps
    """

    bodies: str
    axial: float
    radial: float = 0.0
    excitation: tuple[str, str] | None = None
    explicit: bool = False

    @property
    def phase(self) -> str:
        return "static" if self.excitation is None else "motion"

    @property
    def case(self) -> str:
        """Load case or excitation, in words; the same for the three kinds of bodies."""
        if self.excitation is not None:
            return f"{self.excitation[0]} {self.excitation[1]} force"
        return f"{self.axial:g} N axial" + (f" + {self.radial:g} N radial" if self.radial else "")

    @property
    def name(self) -> str:
        return f"{self.phase} {self.case} with {self.bodies} bodies" + (", explicit" if self.explicit else "")

    @property
    def integrator(self) -> str | None:
        return None if self.excitation is None else EXPLICIT if self.explicit else "newmark"


@attrs.frozen
class ElasticDesign:
    """All runs of one scene.

    tables : of the scene;  friction : Coulomb coefficient of the motions;  turns : of a motion, of ``STEPS`` steps each
    """

    tables: ReadTables
    friction: float
    turns: int

    @property
    def speed_rpm(self) -> float:
        return float(self.tables["excitation"]["speed_rpm"])

    @property
    def load_cases(self) -> list[tuple[float, float]]:
        """Axial and radial loads at rest, of the static verification [N]."""
        return [(float(axial), float(radial)) for axial, radial in reference_cases()[_CASES].inputs["loads_n"]]

    def runs(self) -> list[ElasticRun]:
        """Those at rest first, motions last: they cost most."""
        static = [ElasticRun(bodies, axial, radial) for axial, radial in self.load_cases for bodies in BODIES]
        axial, ways = float(self.tables["load"]["axial"]), [(bodies, False) for bodies in BODIES]
        if self.tables.get("integrator", {}).get("kind") == EXPLICIT:
            ways.append(("elastic", True))
        return static + [ElasticRun(bodies, axial, 0.0, pair, explicit) for pair in CLAIMED for bodies, explicit in ways]

    def point(self, run: ElasticRun, registry: Registry) -> Tables:
        """The scene's tables of one run."""
        values: Tables = {
            "bodies.kind": run.bodies,
            "load.axial": run.axial,
            "load.radial": [run.radial, 0.0],
            "supports.tilt": "locked",
            # Of elastic bodies kyy at rest is without sticking: friction would make that of the others another quantity.
            "contact.friction": 0.0 if run.excitation is None else self.friction,
        }
        if run.excitation is not None:
            values |= {
                "kinematics.ball_inertia": True,
                "excitation.kind": run.excitation[0],
                "excitation.amplitude": run.excitation[1],
                "integrator.kind": run.integrator,
                "integrator.turns": self.turns,
            }
            if not run.explicit:
                values |= {"integrator.tolerance": _TOLERANCE, "integrator.steps_per_turn": STEPS}
        if run.excitation is not None and self.friction > 0.0:
            values["contact.stick_stiffness"] = _STICK
        scene = dict(self.tables)
        if run.bodies == "rigid":  # one force a contact, by Hertz's law; no mesh
            scene.pop("mesh")
            values |= {"contact.kind": "hertz", "contact.discretisation": "resultant"}
        tables = tables_at(scene, values, registry)
        return tables if run.excitation is not None else {k: v for k, v in tables.items() if k not in _OF_MOTION}

    def scene(self, run: ElasticRun, registry: Registry) -> Scene:
        return scene_from_dict(self.point(run, registry), registry)


def design(tables: ReadTables, friction: float | None = None, turns: int = TURNS) -> ElasticDesign:
    """The runs for a scene.

    friction : see ``raceway_article.design.friction_of``

    SceneError: A scene without unbalance, axial load, mesh or contacts at surface points; a friction below 0.
    """
    excitation = excitation_of(tables)
    if not isinstance(tables.get("mesh"), Mapping):
        why = "is needed: every node of elastic bodies is an unknown; examples/b7206_article_mesh.toml has the article's"
        raise SceneError.at("mesh", None, why)
    discretisation = tables.get("contact", {}).get("discretisation")
    if discretisation != "nodal":
        why = "must be 'nodal' here: peak pressures are those at surface points"
        raise SceneError.at("contact.discretisation", discretisation, why)
    friction = friction_of(tables, friction)
    axial = tables.get("load", {}).get("axial", 0.0)
    if not axial > 0.0:
        raise SceneError.at("load.axial", axial, "must be above 0: it is the load of the motions, in N")
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        why = "is needed, or `excitation.force`: one force has a constant amplitude, that at this speed"
        raise SceneError.at("excitation.reference_speed_rpm", None, why)
    return ElasticDesign(with_value(tables, "bodies.kind", "elastic"), friction, turns)


def _row_of(scene: Scene, registry: Registry, tell: OnProgress | None = None, folder: Path | None = None) -> Tables:
    """Run a scene.

    tell : called as ``tell(what, done, total)`` between steps; an exception that is no fault of the run passes through
    folder : where the section through the most loaded contact is drawn; None: nowhere
    Returns row : ``status`` "completed", "failed" (numbers) or "refused" (the scene, or this machine), ``reason``, ``cost``; of a completed
        run ``balls``, ``displacement``, ``kyy_n_per_m``, ``subsurface``, ``mesh``, ``identification``, ``stability``, ``error``,
        ``warnings`` as in result.json, and ``pictures``, names of files in ``folder``
    """
    clocks, row = Clocks(), {"status": "completed", "reason": ""}
    try:
        result = run(scene, registry, tell)
        numbers, cost = _result_numbers(result.to_dict()), _cost(clocks, result)
        if folder is not None:
            from raceway_view.stress import contact_stress_files

            numbers["pictures"] = []
            try:
                files = contact_stress_files(result)
                numbers["pictures"] += [write_whole(content, folder / name).name for name, content in files.items()]
            except RacewayError as why:
                numbers["no_picture"] = failure(why)["reason"]
        del result
    except RacewayError as why:
        row = failure(why)
    except MemoryError:
        reason = "the memory of this machine does not suffice: use larger elements, mesh.element_size"
        row = {"status": "refused", "reason": reason}
    except Exception as why:  # a fault of the program costs its run, not the study
        row = {"status": "failed", "reason": f"unexpected {type(why).__name__}: {why or 'no message'}"}
    if row["status"] != "completed":
        numbers, cost = {}, _cost(clocks, None)
    gc.collect()  # bodies of gigabytes hold each other
    return {**row, **numbers, "cost": cost}


def _cost(clocks: Clocks, result: Result | None) -> Tables:
    """What a run took until now; compiling is apart from its processor time.  None: it came to no end."""
    (cpu, wall, peak), cost = clocks.read(), dict[str, float]() if result is None else result.cost
    mesh = None if result is None else (result.bodies or {}).get("mesh")
    return {
        "cpu_s": cpu,
        "wall_s": wall,
        "compile_s": cost.get("compile_s", 0.0),
        **peak,
        "elements": (mesh or {}).get("cells"),
        "steps": cost.get("steps"),
        "newton_iterations": cost.get("newton_iterations"),
        "predicted_s": None if result is None else result.model.plan.predicted_wall_s,
    }


def _result_numbers(result: ReadTables) -> Tables:
    static, identification, model = result["equilibrium"], result["identification"], result["model"] or {}
    return {
        "balls": [{key: ball[key] for key in _BALL if key in ball} for ball in static["balls"]],
        "displacement": static["displacement"],
        "kyy_n_per_m": static["stiffness"][1][1],
        "subsurface": model.get("subsurface") or [],
        "mesh": model.get("mesh"),
        "mass_scaling": model.get("mass_scaling"),
        "identification": None if identification is None else {key: identification[key] for key in _IDENTIFIED},
        "stability": {key: result["stability"][key] for key in _STABILITY},
        "error": {key: result["error"][key] for key in _ERROR},
        "warnings": result["warnings"],
    }


def _pressures(balls: list[ReadTables], race: str) -> Tables | None:
    """Nodal peak pressures of a race over Hertz's at the same ball load, less 1; None of rigid bodies, which have no points.

    ``ball``, ``load_n`` and ``peak_pressure_pa`` are of the most loaded ball, with ``most_loaded``, its deviation; ``largest`` is the
    deviation of largest size over all loaded balls.
    """
    nodal, hertz, load = f"peak_pressure_nodal_{race}_pa", f"peak_pressure_{race}_pa", f"load_{race}_n"
    most = max(balls, key=lambda ball: ball[load])
    loaded_balls = [ball for ball in balls if ball[load] > _LOADED * most[load] and ball.get(nodal) is not None]
    if not loaded_balls:
        return None
    deviations = [ball[nodal] / ball[hertz] - 1.0 for ball in loaded_balls]
    return {
        "ball": balls.index(most),
        "load_n": most[load],
        "peak_pressure_pa": most[nodal],
        "hertz_peak_pressure_pa": most[hertz],
        "most_loaded": deviations[loaded_balls.index(most)],
        "largest": max(deviations, key=abs),
        "loaded_balls": len(loaded_balls),
    }


def _at_rest(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of two rows at rest: x, y, kyy, and the largest of a ball's load over the largest load.

    y is None where the load is axial.
    """
    displacement, reference_values = row["displacement"], reference["displacement"]
    sideways = abs(reference_values["y"]) > _NEGLIGIBLE * abs(reference_values["x"])
    return {
        "ball_loads": max(_loads(row["balls"], reference["balls"], f"load_{race}_n") for race in RACES),
        "x": _over(displacement["x"], reference_values["x"]),
        "y": _over(displacement["y"], reference_values["y"]) if sideways else None,
        "kyy": _over(row["kyy_n_per_m"], reference["kyy_n_per_m"]),
    }


def _in_motion(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of K, C and |Z| of two motions, and of the complex Z, its size.

    ``wc`` : difference of w C over the reference's |Z|, where C is next to nothing
    """
    z, reference_values = _stiffness_numbers(row), _stiffness_numbers(reference)
    speed = reference["identification"]["speed_rpm"] * math.pi / 30.0
    differences: Tables = {name: _over(z[name], reference_values[name]) for name in z}
    wc = speed * (z["c"] - reference_values["c"]) / reference_values["abs_z"]
    return differences | {"wc": wc, "z": math.hypot((z["k"] - reference_values["k"]) / reference_values["abs_z"], wc)}


def _stiffness_numbers(row: ReadTables) -> dict[str, float]:
    """K [N/m], C [N s/m] and |Z| [N/m] of a motion."""
    return {"k": K.of(row), "c": C.of(row), "abs_z": Z.of(row)}


def _loads(balls: list[ReadTables], references: list[ReadTables], load: str) -> float:
    pairs = zip(balls, references, strict=True)
    return max(abs(a[load] - b[load]) for a, b in pairs) / max(b[load] for b in references)


def _over(value: float, reference: float) -> float | None:
    return value / reference - 1.0 if reference else None


@attrs.frozen(eq=False, repr=False, slots=False)
class ElasticArticle(Answer):
    """The study's rows, with their differences from Hertz and from condensed bodies.

    rows : of ``design.runs()``, in their order;  seconds, cpu_s : wall and processor time of this command
    reused : rows that were stored before;  fault : why rows could not be stored; None where they were
    command : what makes the page again
    """

    stem: ClassVar[str] = "article-elastic"

    title: str
    design: ElasticDesign
    rows: list[Tables]
    seconds: float
    cpu_s: float
    reused: int
    fault: RacewayError | None = None
    command: str = "raceway study article --bodies elastic"

    @cached_property
    def of_run(self) -> dict[ElasticRun, Tables]:
        """Completed rows by run."""
        pairs = zip(self.design.runs(), self.rows, strict=True)
        return {run: row for run, row in pairs if row["status"] == "completed"}

    def row(self, phase: str, case: str, bodies: str) -> Tables | None:
        """A completed row; None of a run that failed."""
        runs = (run for run in self.of_run if (run.phase, run.case, run.bodies) == (phase, case, bodies))
        return next((self.of_run[run] for run in runs), None)

    @property
    def failed(self) -> int:
        return len(self.rows) - len(self.of_run)

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON; None where a number does not exist."""
        design = self.design
        rows = [self._compared(run, row) for run, row in zip(design.runs(), self.rows, strict=True)]
        content: Tables = without_nan({
            "title": self.title,
            "scene": design.tables,
            "friction": design.friction,
            "speed_rpm": design.speed_rpm,
            "turns": design.turns,
            "steps_per_turn": STEPS,
            "reference": _REFERENCE,
            "what_differs": list(_DIFFERENCES),
            "rows": rows,
            "elements": max((row["cost"]["elements"] or 0 for row in rows), default=0) or None,
            "runs": len(rows),
            "failed": self.failed,
            "cost": {
                "wall_s": self.seconds,
                "cpu_s": self.cpu_s,
                "rows_cpu_s": sum(row["cost"]["cpu_s"] for row in self.rows),
                "reused": self.reused,
            },
        })  # fmt: skip
        return content

    def save(self, folder: str | Path, pictures: bool | str = False) -> list[Path]:
        """Write JSON and CSV, and where ``pictures`` asks for them the figures and the page, which comes first.

        RacewayError: matplotlib is missing, or a folder or disk that cannot be written.
        """
        from raceway_article.elastic_page import columns, drawings, page
        from raceway_article.page import write_tables

        folder, content = Path(folder), self.to_dict()
        pictured = drawings(content) if pictures else []
        files = write_tables(self.stem, content, {self.stem: columns(content["rows"])}, pictured, folder, pictures)
        if not pictures:
            return files
        stresses = [file for row in self.rows for name in row.get("pictures") or [] if (file := folder / name).is_file()]
        section = next((file.read_bytes() for file in stresses if file.suffix == ".png"), None)
        return [page(content, pictured, section, self.command).write(folder / "article-elastic.html"), *files, *stresses]

    def failure(self) -> RacewayError | None:
        if self.fault is None and not self.of_run and all(row["status"] in ("failed", "refused") for row in self.rows):
            return ConvergenceError(f"every run failed; the first reason: {self.rows[0]['reason']}")
        return self.fault

    def _facts(self) -> tuple[str, list[Fact]]:
        from raceway_article.elastic_page import in_short

        return self.title, [("", "", words) for words in in_short(self.to_dict())]

    def report(self) -> Iterator[Part]:
        """What the numbers say, both tables of differences from condensed bodies, failures and cost."""
        from raceway_article.elastic_page import in_short, tables

        content, runs = self.to_dict(), self.design.runs()
        yield Words(self.title, "bold")
        yield from in_short(content)
        for caption, rows in tables(content).items():
            yield rows_table(rows, caption)
        for each, row in zip(runs, self.rows, strict=True):
            if row["reason"]:
                yield Words(f"{each.name}: {row['status']}: {row['reason']}", "magenta")
        if content["elements"]:
            yield Words(f"elements of elastic bodies: {content['elements']}", "magenta")
        cost = f"{len(runs)} runs, {self.failed} failed; {self.seconds:.0f} s, {self.cpu_s:.0f} s of processor time"
        yield Words(cost + (f"; {self.reused} rows taken from earlier" if self.reused else ""), "dim")

    def _compared(self, run: ElasticRun, row: Tables) -> Tables:
        """A row with its run and its differences."""
        table: Tables = {"phase": run.phase, "case": run.case, "bodies": run.bodies, "integrator": run.integrator, "axial_n": run.axial, "radial_n": run.radial, **row}  # fmt: skip
        if row["status"] != "completed":
            return table
        reference = None if run.bodies == _REFERENCE else self.row(run.phase, run.case, _REFERENCE)
        if run.excitation is None:
            # Below the most loaded contacts: over Hertz's, less 1.
            table |= {
                "from_hertz": {race: _pressures(row["balls"], race) for race in RACES},
                "below_contact": [
                    {
                        **side,
                        "shear_deviation": _over(side["largest_shear_pa"], side["hertz_largest_shear_pa"]),
                        "depth_deviation": _over(side["depth_m"], side["hertz_depth_m"]),
                    }
                    for side in row["subsurface"]
                ],
            }
            differences = _at_rest
        else:
            table |= {"identified": _stiffness_numbers(row), "energy_balance": row["stability"]["energy_drift"]}
            differences = _in_motion
        return table | {f"from_{_REFERENCE}": None if reference is None else differences(row, reference)}


def elastic_article(
    design: ElasticDesign,
    folder: Path | None,
    kept: Path | None,
    registry: Registry,
    plugins: Sequence[Path],
    on_progress: OnProgress,
    command: str,
) -> ElasticArticle:
    """Compute every run but those in the folder ``kept``, one after the other; what this machine refused is tried again.

    folder : where the section through the most loaded contact is drawn; None: it is not
    command : what makes the page again
    """
    start, cpu = time.monotonic(), time.process_time()
    runs = design.runs()
    scenes, items = _scenes_and_items(design, registry)
    # The run at rest with elastic bodies under the heaviest load: its most loaded contact is drawn.
    pictured = max(
        (k for k, run in enumerate(runs) if run.excitation is None and run.bodies == "elastic"), key=lambda k: runs[k].axial
    )
    with written(kept) as store:
        store.wait([item.key for item in items if store.get(item.key).content.get("status") == "refused"])
        waiting = [k for k, item in enumerate(items) if store.get(item.key).state == "waiting"]
        seconds = _predictions([scenes[k] for k in waiting])
        kinds = {k: (runs[k].bodies, runs[k].phase) for k in waiting}
        progress = RemainingTime(dict(zip(waiting, seconds, strict=True)), kinds, on_progress)

        def compute(k: int, registry: Registry) -> Tables:
            progress.begin(k, f"{runs[k].bodies} {'at rest' if runs[k].excitation is None else 'in motion'}", runs[k].case)
            return _row_of(scenes[k], registry, progress, folder if k == pictured else None)

        rows, reused = work_through(compute, items, store, local(registry, 0), registry, plugins)
    costs = time.monotonic() - start, time.process_time() - cpu
    return ElasticArticle(scenes[0].title, design, rows, *costs, reused, store.fault, command)


def _scenes_and_items(design: ElasticDesign, registry: Registry) -> tuple[list[Scene], list[Item]]:
    runs = design.runs()
    scenes = [design.scene(run, registry) for run in runs]
    keys = [row_key(scene, registry, "article elastic") for scene in scenes]
    return scenes, [Item(key, run.name, k) for k, (key, run) in enumerate(zip(keys, runs, strict=True))]


def elastic_workload(design: ElasticDesign, store: Path | None, registry: Registry) -> Workload:
    """The runs that are not stored, one after another."""
    scenes, items = _scenes_and_items(design, registry)
    left = [scene for scene, item in zip(scenes, items, strict=True) if not stored_rows(store, [item.key])]
    memory = max((make_plan(scene).predicted_bytes for scene in left), default=0)
    return Workload(
        scenes[0].title, len(items), sum(_predictions(left)), runs=len(left), stored=len(items) - len(left),
        bytes=memory, why_runs="bodies of finite elements, one run at a time",
    )  # fmt: skip


def _predictions(scenes: Sequence[Scene]) -> list[float]:
    """Planned time of runs one after the other [s]: what is made once for bodies at rest, or in motion, counts in the first alone."""
    seconds, models = [], set[tuple[str, bool]]()
    for scene in scenes:
        try:
            plan = make_plan(scene)
        except RacewayError:  # its row says why
            seconds.append(0.0)
            continue
        bodies = scene.bodies.name, scene.excitation is not None
        seconds.append(max(plan.predicted_wall_s - (plan.predicted_once_s if bodies in models else 0.0), 0.0))
        models.add(bodies)
    return seconds
