"""Plan of a scene: parts kept and left out with reasons, predicted size and cost.  Nothing is built here.

The model builder obeys the plan; it decides nothing of this by itself.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Annotated, Any

import attrs

from raceway.errors import Mistake, SceneError, short
from raceway.framework.contracts import said
from raceway.framework.doors import PATHS, TEXTS, door
from raceway.framework.shown import Fact, Shown, duration
from raceway.planning.parts import (
    START_S,
    Decisions,
    Part,
    decide_balls,
    decide_motion,
    decide_output,
    decide_tilts,
    slowness,
)
from raceway.planning.resolve import Problem, refuse_memory, resolve
from raceway.planning.rules import foreseen, refuse_what_cannot_run, scene_warnings
from raceway.scene.scene import SCENE, Scene, as_scene
from raceway.storage.tables import Tables


@attrs.frozen(repr=False)
class ScenePlan(Shown):
    """Decisions and predictions for one scene.

    Attributes
    ----------
    problem : that it was made of
    kept, left_out : each with ``part`` and ``why``
    balls : "weightless" (on the line of the groove centres), "inertial" (two unknowns each) or "tangential" (friction, gyroscopic moments)
    centrifugal, gyroscopic : whether the balls have these loads
    free : (5,) of x, y, z, tilt_y, tilt_z: 1 for unknowns
    turns : turns that are integrated
    dofs : unknowns of the ring and of the balls
    time_step_s : None in a static scene;  predicted_wall_s : of a whole run on this machine
    predicted_work_s : the same on the machine whose times the plan knows: no machine's speed changes it
    predicted_bytes : resident memory at the peak; 0 where it is small, or not known
    at_least : whether that may be any number of times more: a mesh whose size is not known before it is read
    predicted_once_s : seconds of that which a second run in the same process, on the same bodies, does not take again
    mesh : predicted ``bodies[{name, cells, bytes}]``, ``cells``, ``bytes``; None where nothing is meshed or predicted

    Examples
    --------
    >>> import raceway as rw
    >>> plan = rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
    >>> plan.predicted_steps, plan.time_step_s
    (0, None)
    """

    problem: Problem = attrs.field(eq=False)
    kept: tuple[Part, ...]
    left_out: tuple[Part, ...]
    balls: str
    centrifugal: bool
    gyroscopic: bool
    free: tuple[int, ...]
    turns: int
    dofs: int
    time_step_s: float | None
    predicted_steps: int
    predicted_wall_s: float
    predicted_work_s: float
    predicted_once_s: float = 0.0
    predicted_bytes: int = 0
    mesh: Tables | None = None
    at_least: bool = False

    @door
    def keeps(self, name: str) -> bool:
        """Whether a part is included, by its name."""
        return any(part.part == name for part in self.kept)

    def to_dict(self) -> Tables:
        """Content of the table ``plan`` of result.json."""
        problem = self.problem
        integrator = {"kind": problem.integrator.kind, "why": problem.integrator_why or None}
        return {
            "kept": [attrs.asdict(p) for p in self.kept],
            "left_out": [attrs.asdict(p) for p in self.left_out],
            "integrator": integrator if problem.recorded else None,
            "derived": self.problem.derived(),
            **{name: getattr(self, name) for name in ("dofs", "time_step_s", "predicted_steps", "predicted_wall_s")},
            "predicted_at_least": self.at_least,
            "predicted_bytes": self.predicted_bytes or None,
            "mesh": self.mesh,
        }

    def _facts(self) -> tuple[str, list[Fact]]:
        step = "static" if self.time_step_s is None else f"{self.predicted_steps} steps of {self.time_step_s:.3g} s"
        time = "time not known before the mesh is read" if self.at_least else duration(self.predicted_wall_s)
        kept = ", ".join(part.part for part in self.kept)
        head: list[Fact] = [("predicted", "", f"{time}; {step}; {self.dofs} unknowns"), ("kept", "", kept)]
        return self.problem.scene.title, [*head, *(("left out", "", f"{part.part}: {part.why}") for part in self.left_out)]


@door
def make_plan(scene: Annotated[Scene, SCENE], force: Annotated[Collection[str], TEXTS] = ()) -> ScenePlan:
    """Decide what a scene needs.

    Parameters
    ----------
    force : parts that are included although the scene does not need them: to measure what leaving them out saves

    Raises
    ------
    SceneError
        For combinations that cannot run, each with the reason and the remedy.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.make_plan(rw.Scene.from_toml("examples/b7206.toml")).time_step_s  # [s]
    1.388888888888889e-05
    """
    return plan_of(resolve(scene), force)


def plan_of(problem: Problem, force: Collection[str] = ()) -> ScenePlan:
    """The same as ``make_plan``, of a problem."""
    refuse_what_cannot_run(problem)
    parts = Decisions(force)
    tilts = decide_tilts(problem, parts)
    balls = decide_balls(problem, parts)
    problem.body_kind.decide(parts)
    motion = decide_motion(problem, parts, tilts, balls.friction)
    decide_output(problem, parts, motion)
    count = problem.bearing.balls_in_all
    if motion.recorded:
        refuse_memory(problem, motion.turns, motion.steps_per_turn, count)
    cost = problem.body_kind.cost(balls, motion, parts)
    machine = slowness() if cost.scales else 1.0
    free = (0 if problem.supports.axial == "displacement" else 1, 1, 1, int(tilts), int(tilts))
    unknowns = sum(free) + count * (1 if balls.kind == "weightless" else 2)
    return ScenePlan(
        problem=problem,
        kept=tuple(parts.kept),
        left_out=tuple(parts.left_out),
        balls=balls.kind,
        centrifugal=balls.centrifugal,
        gyroscopic=balls.gyroscopic,
        free=free,
        turns=motion.turns,
        dofs=cost.unknowns or unknowns,
        time_step_s=problem.period / motion.steps_per_turn if motion.recorded else None,
        predicted_steps=motion.turns * motion.steps_per_turn,
        predicted_wall_s=cost.seconds * machine,
        predicted_work_s=cost.seconds,
        predicted_once_s=(START_S + cost.once) * machine,
        predicted_bytes=cost.bytes,
        mesh=cost.mesh,
        at_least=cost.at_least,
    )


@door
def plan(scene: Any, *, plugins: Annotated[Iterable[str | Path], PATHS] = ()) -> ScenePlan:
    """Decide what a scene needs, and predict size, time step and cost; nothing is built.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    ScenePlan : ``kept``, ``left_out``, ``dofs``, ``time_step_s`` [s], ``predicted_wall_s`` [s] ...

    Raises
    ------
    SceneError
        With every mistake that ``raceway.check`` finds.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.plan({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}).dofs
    15
    """
    problem = resolve(as_scene(scene, plugins=plugins))
    if mistakes := foreseen(problem):
        raise SceneError(mistakes)
    return plan_of(problem)


@attrs.frozen(repr=False)
class Check(Shown):
    """What is wrong with a scene; true where nothing is.

    Attributes
    ----------
    mistakes : tuple of Mistake, each with ``path``, ``value`` and ``message``; they keep the scene from running
    warnings : tuple of str, values that are possible and unlikely, keys without effect

    Examples
    --------
    >>> import raceway as rw
    >>> rw.check({"bearing": {"preset": "B7206C"}})
    1 mistake
      load.axial  0.0  no load acts: the stiffness is undefined
    """

    mistakes: tuple[Mistake, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the scene can run."""
        return not self.mistakes

    def __bool__(self) -> bool:
        return self.ok

    def _facts(self) -> tuple[str, list[Fact]]:
        count = len(self.mistakes)
        title = "no mistakes" if self.ok else f"{count} mistake{'' if count == 1 else 's'}"
        rows = [(m.path, "" if m.value is None else repr(m.value), m.message) for m in self.mistakes]
        return title, [*rows, *(("warning", "", text) for text in self.warnings)]

    def to_dict(self) -> Tables:
        """Mistakes and warnings as plain tables."""
        mistakes = [attrs.asdict(each) | {"value": _plain(each.value)} for each in self.mistakes]
        return {"errors": mistakes, "warnings": list(self.warnings)}


def _plain(value: object) -> object:
    """A user's value as it stands, or as text where JSON has none."""
    try:
        json.dumps(value, allow_nan=False)
    except Exception:  # whatever a foreign object makes of being asked
        return short(value)
    return value


@door
def check(scene: Any, *, plugins: Annotated[Iterable[str | Path], PATHS] = ()) -> Check:
    """Look for every mistake of a scene; compute nothing.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Check : also of a scene that cannot be read

    Raises
    ------
    PluginError
        A plug-in file that is missing, fails to import or adds nothing.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.check({"bearing": {"preset": "B7206C"}, "load": {"axail": 400}})
    >>> found.ok, found.mistakes[0].path
    (False, 'load.axail')
    """
    try:
        problem = resolve(as_scene(scene, plugins=plugins))
        plan_of(problem)
    except SceneError as error:
        return Check(tuple(error.mistakes))
    return Check(tuple(foreseen(problem)), scene_warnings(problem))


#: A point of columns with 12 balls and all quantities of a sweep: its equilibrium, also with an oil film, what heat adds; its orbit under
#: a rotating force, and factors on that of damped contacts and of a force along a fixed direction.
_STATIC_S, _FILM_S, _HEAT_S, _TURNING_S, _DAMPED, _FIXED = 17.0e-6, 0.11e-3, 0.2e-3, 0.13e-3, 2.9, 4.5


def column_time(plan: ScenePlan, moving: bool) -> float:
    """Processor time of a point in compiled columns on this machine [s]; ``moving``: with its steady orbit."""
    problem = plan.problem
    seconds = _FILM_S if said(problem.contact.law, "elementwise") else _STATIC_S
    seconds += 0.0 if problem.scene.heat is None else _HEAT_S
    if moving:
        damping_factor = _DAMPED if plan.keeps("contact damping") else 1.0
        in_one_direction = problem.excitation is not None and problem.excitation.sense == 0
        seconds += _TURNING_S * damping_factor * (_FIXED if in_one_direction else 1.0)
    return seconds * problem.bearing.balls_in_all / 12.0 * slowness()
