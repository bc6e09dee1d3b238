"""The runs: load cases and operating point of the article with elastic, condensed and rigid bodies, made from one scene."""

from __future__ import annotations

import gc
import math
import resource
import sys
import time
from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.core.jit import working_process_time
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.result import without_nan
from raceway.pipeline.run import run
from raceway.planning.plan import make_plan
from raceway.points.axes import tables_at
from raceway.points.engine import Item, local, reference_cases, reset_peak, work_through
from raceway.points.store import RowStore, row_key
from raceway.scene.changes import with_value
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.design import CLAIMED, FRICTION

if TYPE_CHECKING:
    from raceway.pipeline.result import Result


SCENE = Path(__file__).resolve().parents[2] / "data" / "article_elastic.toml"
#: Condensed bodies come first: the others are held against them, and they show in seconds whether the scene is what was meant.
BODIES = ("condensed", "rigid", "elastic")
#: One operating point: turns and steps of a turn.
TURNS, STEPS = 2, 40
#: Stiffness of a contact that sticks [N/m], for all bodies alike: it gives way by 0.8 um before it slides, a tenth of the orbit.  The
#: default of surface points, as stiff as their penalty, has Newton's method change to and fro between points that stick and slide.
STICK = 1e7
#: Residual of a step over the largest force: one solution with factors of elastic bodies reaches it, a second one costs as much.
TOLERANCE = 1e-5
_CASES = "seed-static-pressures"
#: Tables that scenes at rest do not have.
_OF_MOTION = ("excitation", "integrator", "identifier")


@attrs.frozen
class Run:
    """One run of the study.

    Attributes
    ----------
    bodies : of ``BODIES``;  axial, radial : load [N]
    excitation : (direction, amplitude law) of a motion; None at rest
    """

    bodies: str
    axial: float
    radial: float = 0.0
    excitation: tuple[str, str] | None = None

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
        return f"{self.phase} {self.case} with {self.bodies} bodies"


@attrs.frozen
class Design:
    """All runs of one scene.

    Attributes
    ----------
    tables : of the scene;  friction : Coulomb coefficient of the motions;  turns : of a motion, of ``STEPS`` steps each
    """

    tables: ReadTables
    friction: float
    turns: int

    @property
    def load_cases(self) -> list[tuple[float, float]]:
        """Axial and radial loads at rest [N]: those of the static verification."""
        return [(float(axial), float(radial)) for axial, radial in reference_cases()[_CASES].inputs["loads_n"]]

    @property
    def speed_rpm(self) -> float:
        return float(self.tables["excitation"]["speed_rpm"])

    def runs(self) -> list[Run]:
        """Rest first, motions last: they are the dearest."""
        rest = [Run(bodies, *loads) for loads in self.load_cases for bodies in BODIES]
        axial = float(self.tables["load"]["axial"])
        return rest + [Run(bodies, axial, excitation=pair) for pair in CLAIMED for bodies in BODIES]

    def point(self, run: Run, registry: Registry) -> Tables:
        """The scene's tables of one run."""
        chosen: Tables = {
            "bodies.kind": run.bodies,
            "load.axial": run.axial,
            "load.radial": [run.radial, 0.0],
            "supports.tilt": "locked",
            # Of elastic bodies kyy at rest is without sticking: friction would make that of the others another quantity.
            "contact.friction": 0.0 if run.excitation is None else self.friction,
        }
        if run.excitation is not None:
            chosen |= {
                "kinematics.ball_inertia": True,
                "excitation.kind": run.excitation[0],
                "excitation.amplitude": run.excitation[1],
                "integrator.kind": "newmark",
                "integrator.tolerance": TOLERANCE,
                "integrator.turns": self.turns,
                "integrator.steps_per_turn": STEPS,
            }
        if run.excitation is not None and self.friction > 0.0:
            chosen["contact.stick_stiffness"] = STICK
        given = dict(self.tables)
        if run.bodies == "rigid":  # one force a contact, by Hertz's law; no mesh
            given.pop("mesh")
            chosen |= {"contact.kind": "hertz", "contact.discretisation": "resultant"}
        tables = tables_at(given, chosen, registry)
        return tables if run.excitation is not None else {k: v for k, v in tables.items() if k not in _OF_MOTION}

    def scene(self, run: Run, registry: Registry) -> Scene:
        return scene_from_dict(self.point(run, registry), registry)


def design(tables: ReadTables, friction: float | None = None, turns: int = TURNS) -> Design:
    """The runs for a scene.

    Parameters
    ----------
    friction : Coulomb coefficient; the scene's own where it has one, else the article's

    Raises
    ------
    SceneError
        A scene without unbalance, axial load, mesh or contacts at surface points; a friction below 0.
    """
    excitation = tables.get("excitation")
    if not isinstance(excitation, Mapping) or excitation.get("unbalance") is None:
        why = "is needed: the study compares the force m e w^2 with one of constant amplitude; give it in kg m"
        raise SceneError.at("excitation.unbalance", None, why)
    if not isinstance(tables.get("mesh"), Mapping):
        why = "is needed: every node of elastic bodies is an unknown; examples/b7206_article_mesh.toml has the article's"
        raise SceneError.at("mesh", None, why)
    contact = tables.get("contact", {})
    if contact.get("discretisation") != "nodal":
        why = "must be 'nodal' here: peak pressures are those at surface points"
        raise SceneError.at("contact.discretisation", contact.get("discretisation"), why)
    if friction is None:
        friction = float(contact.get("friction", 0.0)) or FRICTION
    if not (math.isfinite(friction) and friction >= 0.0):
        raise SceneError.at("--friction", friction, "must be a coefficient of friction of at least 0")
    axial = tables.get("load", {}).get("axial", 0.0)
    if not axial > 0.0:
        raise SceneError.at("load.axial", axial, "must be above 0: it is the load of the motions, in N")
    if "force" not in excitation and "reference_speed_rpm" not in excitation:
        why = "is needed, or `excitation.force`: one force has a constant amplitude, that at this speed"
        raise SceneError.at("excitation.reference_speed_rpm", None, why)
    return Design(with_value(tables, "bodies.kind", "elastic"), friction, turns)


RACES = ("inner", "outer")
#: What the others are held against.
REFERENCE = "condensed"
#: Balls above this part of the largest load count as loaded.
_LOADED = 0.05
#: A displacement below this part of the axial one is none: it has no relative difference.
_NONE = 1e-3


def from_hertz(row: ReadTables) -> Tables:
    """Nodal peak pressures over Hertz's at the same ball load, less 1.

    Returns
    -------
    table : for each race ``ball``, ``load_n`` and ``peak_pressure_pa`` of its most loaded ball with ``most_loaded``, its
        deviation, and ``largest``, the deviation of largest size over all loaded balls; None of rigid bodies, which have no points
    """
    return {race: _pressures(row["balls"], race) for race in RACES}


def _pressures(balls: list[ReadTables], race: str) -> Tables | None:
    nodal, hertz, load = f"peak_pressure_nodal_{race}_pa", f"peak_pressure_{race}_pa", f"load_{race}_n"
    most = max(balls, key=lambda ball: ball[load])
    loaded = [ball for ball in balls if ball[load] > _LOADED * most[load] and ball.get(nodal) is not None]
    if not loaded:
        return None
    off = [ball[nodal] / ball[hertz] - 1.0 for ball in loaded]
    return {
        "ball": balls.index(most),
        "load_n": most[load],
        "peak_pressure_pa": most[nodal],
        "hertz_peak_pressure_pa": most[hertz],
        "most_loaded": off[loaded.index(most)],
        "largest": max(off, key=abs),
        "loaded_balls": len(loaded),
    }


def below_contact(row: ReadTables) -> list[Tables]:
    """Largest shear stress and its depth in ball and ring below the most loaded contact of each race, over Hertz's, less 1."""
    return [
        {
            **one,
            "shear_deviation": _over(one["largest_shear_pa"], one["hertz_largest_shear_pa"]),
            "depth_deviation": _over(one["depth_m"], one["hertz_depth_m"]),
        }
        for one in row["subsurface"]
    ]


def at_rest(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of two rows at rest: x, y, kyy, and the largest of a ball's load over the largest load.

    y is None where the load is axial.
    """
    here, there = row["displacement"], reference["displacement"]
    sideways = abs(there["y"]) > _NONE * abs(there["x"])
    return {
        "ball_loads": max(_loads(row["balls"], reference["balls"], f"load_{race}_n") for race in RACES),
        "x": _over(here["x"], there["x"]),
        "y": _over(here["y"], there["y"]) if sideways else None,
        "kyy": _over(row["kyy_n_per_m"], reference["kyy_n_per_m"]),
    }


def in_motion(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of K, C and |Z| of two motions; ``wc``: that of w C over the reference's |Z|, where C is next to nothing."""
    here, there = identified(row), identified(reference)
    speed = reference["identification"]["speed_rpm"] * math.pi / 30.0
    off: Tables = {name: _over(here[name], there[name]) for name in here}
    return off | {"wc": speed * (here["c"] - there["c"]) / there["abs_z"]}


def identified(row: ReadTables) -> dict[str, float]:
    """K [N/m], C [N s/m] and |Z| [N/m] of a motion."""
    found = row["identification"]
    return {
        "k": found["equivalent_stiffness"],
        "c": found["equivalent_damping"],
        "abs_z": found["dynamic_stiffness"]["abs"],
    }


def _loads(balls: list[ReadTables], others: list[ReadTables], load: str) -> float:
    return max(abs(a[load] - b[load]) for a, b in zip(balls, others, strict=True)) / max(b[load] for b in others)


def _over(value: float, reference: float) -> float | None:
    return value / reference - 1.0 if reference else None


OnProgress = Callable[[str, int, int], None]


class Told:
    """Tells what one run does, how far it is, and when all of them will end as far as plans and the runs before know.

    A run that takes longer than planned leaves the end unknown.

    Parameters
    ----------
    seconds : predicted time by number of every run that is to be made, in their order [s]
    kinds : what is alike in runs by the same number: none takes longer than the one of its kind before
    on_progress : called as ``on_progress(what, done, total)``, in predicted seconds; an exception stops the study
    """

    def __init__(self, seconds: Mapping[int, float], kinds: Mapping[int, Hashable], on_progress: OnProgress | None) -> None:
        self._seconds, self._kinds, self._tell = dict(seconds), kinds, on_progress
        self._place, self._name, self._begun = -1, "", time.monotonic()
        self._order = {place: k for k, place in enumerate(self._seconds, 1)}

    def begin(self, place: int, name: str, case: str) -> None:
        """A run starts, and the one before has ended; its ``case`` is told once, its short ``name`` with all that it does."""
        if self._place in self._seconds:
            taken = self._seconds[self._place] = time.monotonic() - self._begun
            for later in self._seconds:
                if later > self._place and self._kinds[later] == self._kinds[self._place]:
                    self._seconds[later] = min(self._seconds[later], taken)
        self._place, self._name, self._begun = place, name, time.monotonic()
        self(case, 0, 0)

    def __call__(self, what: str, done: int, total: int) -> None:
        """Told by the run: ``what`` is done, ``done`` of ``total``, 0 where nobody knows how many."""
        if self._tell is None:
            return
        planned, taken = self._seconds[self._place], time.monotonic() - self._begun
        gone = sum(s for place, s in self._seconds.items() if place < self._place) + min(taken, planned)
        whole = sum(self._seconds.values())
        left = "end unknown" if taken > planned else _time_left(whole - gone)
        far = f" {done} of {total}" if total else ""
        # A terminal cuts what is longer than 76 characters: the time first, then what is done.
        run = f"run {self._order[self._place]} of {len(self._order)}"
        self._tell(f"{run}: {left}, {self._name}: {what}{far}", round(gone), round(whole))


def _time_left(left: float) -> str:
    """Seconds that are left, in words."""
    return f"{left:.0f} s left" if left < 90.0 else f"{left / 60.0:.0f} min left"


#: What a row keeps of the tables of result.json.
_BALL = (
    "azimuth_deg", "load_inner_n", "load_outer_n", "peak_pressure_inner_pa", "peak_pressure_outer_pa",
    "peak_pressure_nodal_inner_pa", "peak_pressure_nodal_outer_pa",
)  # fmt: skip
_IDENTIFIED = (
    "speed_rpm", "force_amplitude_n", "equivalent_stiffness", "equivalent_damping", "phase_lag_deg", "dynamic_stiffness",
    "residual", "spread",
)  # fmt: skip
_STABILITY = (
    "energy_drift", "friction_energy_j", "hourglass_energy_ratio", "critical_time_step_s", "max_penetration_m", "status",
)  # fmt: skip


def row_of(scene: Scene, registry: Registry, tell: OnProgress | None = None, folder: Path | None = None) -> Tables:
    """Run a scene.

    Parameters
    ----------
    tell : called as ``tell(what, done, total)`` between steps; an exception that is no fault of the run passes through
    folder : where the section through the most loaded contact is drawn; None: nowhere

    Returns
    -------
    row : ``status`` "completed", "failed" (numbers) or "refused" (the scene, or this machine), ``reason``, ``cost``; of a completed
        run ``balls``, ``displacement``, ``kyy_n_per_m``, ``subsurface``, ``mesh``, ``identification``, ``stability``, ``error``,
        ``warnings`` as in result.json, and ``pictures``, names of files in ``folder``
    """
    begun, status, reason = _Begun(), "completed", ""
    found: Tables = {}
    try:
        result = run(scene, registry, tell)
        found, cost = _numbers(result.to_dict()), begun.cost(result)
        if folder is not None:
            found |= _section(result, folder)
        del result
    except RacewayError as why:
        status, reason = str(why.status), " ".join(str(why).split())
    except MemoryError:
        status, reason = "refused", "the memory of this machine does not suffice: take larger elements, mesh.element_size"
    except Exception as why:  # a fault of the program costs its run, not the study
        status, reason = "failed", f"unexpected {type(why).__name__}: {why or 'no message'}"
    if status != "completed":
        found, cost = {}, begun.cost(None)
    gc.collect()  # bodies of gigabytes hold each other
    return {"status": status, "reason": reason, **found, "cost": cost}


class _Begun:
    """Readings of the clocks as a run starts, and the peak of memory counted anew where the system does so."""

    def __init__(self) -> None:
        self.own = reset_peak()
        self.cpu, self.wall = working_process_time(), time.perf_counter()

    def cost(self, result: Result | None) -> Tables:
        """What the run took until now; compiling is apart from its processor time.  None: it came to no end."""
        cpu, wall = working_process_time() - self.cpu, time.perf_counter() - self.wall
        told: Tables = {} if result is None else result.cost
        compiling, mesh = told.get("compile_s", 0.0), (result.bodies or {}).get("mesh") if result is not None else None
        return {
            "cpu_s": cpu,
            "wall_s": wall,
            "compile_s": compiling,
            "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            * (1 if sys.platform == "darwin" else 1024),
            "peak_memory_of": "run" if self.own else "process so far",
            "elements": (mesh or {}).get("cells"),
            "steps": told.get("steps"),
            "newton_iterations": told.get("newton_iterations"),
            "predicted_s": None if result is None else result.model.plan.predicted_wall_s,
        }


def _numbers(result: ReadTables) -> Tables:
    rest, known, model = result["equilibrium"], result["identification"], result["model"] or {}
    return {
        "balls": [{key: ball[key] for key in _BALL if key in ball} for ball in rest["balls"]],
        "displacement": rest["displacement"],
        "kyy_n_per_m": rest["stiffness"][1][1],
        "subsurface": model.get("subsurface") or [],
        "mesh": model.get("mesh"),
        "identification": None if known is None else {key: known[key] for key in _IDENTIFIED},
        "stability": {key: result["stability"][key] for key in _STABILITY},
        "error": {key: result["error"][key] for key in ("total", "time_step", "transient", "mesh", "contact")},
        "warnings": result["warnings"],
    }


def _section(result: Result, folder: Path) -> Tables:
    """The section below the most loaded contact of each race, where a picture can be made; why not, elsewhere."""
    from raceway.studies.view.stress import write_contact_stress

    try:
        return {"pictures": [file.name for file in write_contact_stress(result, folder)]}
    except RacewayError as why:
        return {"pictures": [], "no_picture": " ".join(str(why).split())}


#: What is not the same with the three kinds of bodies, whatever the scene.
DIFFERENCES = (
    "Elastic bodies: every node of rings and balls moves, with its own inertia; hexahedra by `bodies.formulation`. Each ball is held "
    "at its azimuth by an ideal cage.",
    "Condensed bodies: full integration of the hexahedra, whatever `bodies.formulation` says, on meshes of their own with the same "
    "number of points along a semi-axis; rings are rigid in inertia, balls have their mass in their meridian planes. The static kyy is "
    "a mean over the places of the points, that of elastic bodies belongs to the one place that they have.",
    "Rigid bodies: one force a contact by Hertz's law, no mesh and no points; friction sticks with Mindlin's first stiffness.",
    "Friction: in the motions only. At rest no point carries traction, so that loads, displacements and pressures are the same with it; "
    "but kyy of condensed and rigid bodies would be that of contacts which stick, of elastic ones not. Elastic bodies have "
    "friction in all directions of the contact's plane, condensed and rigid ones along the groove, in which balls do not roll. No "
    "ball rolls or orbits in any of them: what sticks stays for as long as the motion repeats itself.",
    "The balance of energy is summed over all steps for elastic bodies; for rigid ones it is integrated from the samples, whose "
    "distance it then shows as well; for condensed bodies with contacts at surface points there is none.",
)


@attrs.frozen(eq=False, slots=False)
class ElasticArticle:
    """The study's rows, with what they are held against.

    Attributes
    ----------
    rows : of ``design.runs()``, in their order;  seconds, cpu_s : wall and processor time of this command
    reused : rows that were kept from before;  fault : why rows could not be kept; None where they were
    """

    title: str
    design: Design
    rows: list[Tables]
    seconds: float
    cpu_s: float
    reused: int
    fault: RacewayError | None = None

    @cached_property
    def of_run(self) -> dict[Run, Tables]:
        """Completed rows by run."""
        pairs = zip(self.design.runs(), self.rows, strict=True)
        return {run: row for run, row in pairs if row["status"] == "completed"}

    def cases(self, phase: str) -> list[str]:
        """Load cases at rest, or excitations in motion, in their order."""
        return list(dict.fromkeys(run.case for run in self.design.runs() if run.phase == phase))

    def row(self, phase: str, case: str, bodies: str) -> Tables | None:
        """A completed row; None of a run that failed."""
        runs = (run for run in self.of_run if (run.phase, run.case, run.bodies) == (phase, case, bodies))
        return next((self.of_run[run] for run in runs), None)

    @property
    def failed(self) -> int:
        return len(self.rows) - len(self.of_run)

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON; None where a number does not exist."""
        made = self.design
        rows = [self._told(run, row) for run, row in zip(made.runs(), self.rows, strict=True)]
        content: Tables = without_nan(
            {
                "title": self.title,
                "scene": made.tables,
                "friction": made.friction,
                "speed_rpm": made.speed_rpm,
                "turns": made.turns,
                "steps_per_turn": STEPS,
                "reference": REFERENCE,
                "what_differs": list(DIFFERENCES),
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
            }
        )
        return content

    def _told(self, run: Run, row: Tables) -> Tables:
        """A row with its run, and with what it is held against."""
        told: Tables = {
            "phase": run.phase,
            "case": run.case,
            "bodies": run.bodies,
            "axial_n": run.axial,
            "radial_n": run.radial,
            **row,
        }
        if row["status"] != "completed":
            return told
        reference = None if run.bodies == REFERENCE else self.row(run.phase, run.case, REFERENCE)
        if run.excitation is None:
            told |= {"from_hertz": from_hertz(row), "below_contact": below_contact(row)}
            held = at_rest
        else:
            told |= {"identified": identified(row), "energy_balance": row["stability"]["energy_drift"]}
            held = in_motion
        return told | {f"from_{REFERENCE}": None if reference is None else held(row, reference)}


def elastic_article(
    made: Design,
    folder: Path | None = None,
    store: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> ElasticArticle:
    """Run the study.

    Parameters
    ----------
    made : by ``raceway.studies.article.elastic.design``
    folder : where the section through the most loaded contact is drawn; None: it is not
    store : file that finished rows are kept in and taken from; what this machine refused is tried again

    Raises
    ------
    SceneError
        A mistake in the scene; nothing has been run.
    KeyboardInterrupt
        Finished rows are in ``store``.
    """
    begun, cpu = time.monotonic(), time.process_time()
    registry = registry or default_registry()
    runs = made.runs()
    scenes = [made.scene(run, registry) for run in runs]
    kept = RowStore(store)
    kept.rows = {key: row for key, row in kept.rows.items() if row["status"] != "refused"}
    keys = [row_key(scene, registry, "article elastic") for scene in scenes]
    waiting = [place for place, key in enumerate(keys) if kept.get(key) is None]
    seconds = predicted([scenes[place] for place in waiting], registry)
    kinds = {place: (runs[place].bodies, runs[place].phase) for place in waiting}
    told = Told(dict(zip(waiting, seconds, strict=True)), kinds, on_progress)
    drawn = _drawn(runs)

    def compute(place: int, registry: Registry) -> Tables:
        run = runs[place]
        told.begin(place, f"{run.bodies} {'at rest' if run.excitation is None else 'in motion'}", run.case)
        return row_of(scenes[place], registry, told, folder if place == drawn else None)

    items = [Item(key, run.name, place) for place, (key, run) in enumerate(zip(keys, runs, strict=True))]
    rows, reused = work_through(compute, items, kept, local(registry, 0), registry, plugins)
    taken = time.monotonic() - begun, time.process_time() - cpu
    return ElasticArticle(scenes[0].title, made, rows, *taken, reused, kept.fault)


def predicted(scenes: Sequence[Scene], registry: Registry) -> list[float]:
    """Planned time of runs one after the other [s]: what is made once for bodies at rest, or in motion, counts in the first alone."""
    seconds, made = [], set[tuple[str, bool]]()
    for scene in scenes:
        try:
            plan = make_plan(scene)
        except RacewayError:  # its row says why
            seconds.append(0.0)
            continue
        bodies = scene.bodies.name, scene.excitation is not None
        seconds.append(max(plan.predicted_wall_s - (plan.predicted_once_s if bodies in made else 0.0), 0.0))
        made.add(bodies)
    return seconds


def _drawn(runs: Sequence[Run]) -> int:
    """The run at rest with elastic bodies under the heaviest load: its most loaded contact is drawn."""
    at_rest = [place for place, run in enumerate(runs) if run.phase == "static" and run.bodies == "elastic"]
    return max(at_rest, key=lambda place: runs[place].axial)
