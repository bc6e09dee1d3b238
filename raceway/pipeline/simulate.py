"""From a model and its equilibrium to recorded motion: how it begins, with which steps, and the integration."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.core.record import Motion, Record, Schedule
from raceway.core.ring.orbit import Orbit, steady_orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import compiled
from raceway.core.time.schemes import integrate
from raceway.errors import ConvergenceError, StabilityError
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.planning.recording import SAFETY, STEPS_PER_TURN, recorded_per_turn, stable_steps_per_turn
from raceway.planning.steady_orbits import searches_orbits
from raceway.storage.tables import Tables

Watch = Callable[[], None]
#: Slips that a start leaves in contacts which stick stay there.
_STICKS = (
    "friction: where contacts stick depends on how the motion began, so that several steady motions exist: "
    "integrator.start = 'orbit', 'ramp' and 'static' lead to different ones"
)


@attrs.frozen(eq=False)
class Start:
    """How a motion begins.

    Attributes
    ----------
    kind : "orbit", "ramp" or "static"
    orbit : that it begins on
    orbits : ``motion.orbits`` of result.json: the steady motions that were found in the search for it
    settled : False where turns need not repeat: no orbit was found, or only one that is unstable
    warnings : what a user should know
    """

    kind: str
    orbit: Orbit | None = None
    orbits: tuple[dict[str, Any], ...] = ()
    settled: bool = True
    warnings: tuple[str, ...] = ()


def chosen_start(model: Model, equilibrium: Equilibrium, watch: Watch | None = None) -> Start:
    """The scene's start; an orbit that cannot be found becomes a ramp, with a warning.

    Parameters
    ----------
    watch : called in the search for orbits, which what it raises ends
    """
    scene, method = model.scene, model.scene.integrator.method
    if method.steady:
        return Start("static")
    kind = "ramp" if getattr(scene.excitation, "ramp_turns", 0.0) > 0.0 else scene.integrator.start
    if scene.contact.friction > 0.0:
        begun = _begun(model, equilibrium, kind, watch)
        return attrs.evolve(begun, warnings=(*begun.warnings, _STICKS))
    return _begun(model, equilibrium, kind, watch)


def _begun(model: Model, equilibrium: Equilibrium, kind: str, watch: Watch | None) -> Start:
    if kind != "orbit" or not model.scene.integrator.method.inertial:
        return Start(kind)
    excitation, system = model.excitation, model.bearing.orbiting(model.system.at_speed(0.0))
    if excitation.period_s is None:
        # What changes its speed starts on the orbit of its first moment.
        steady = getattr(excitation, "steady", None)
        if steady is None:
            why = "the excitation does not repeat every turn: started with a ramp instead of on the orbit"
            return Start("ramp", settled=False, warnings=(why,))
        excitation = steady()
        system = attrs.evolve(system, force=excitation.kernel(), force_params=excitation.parameters())
    return _on_orbit(model, equilibrium, system, excitation.period_s, watch)


def _on_orbit(model: Model, equilibrium: Equilibrium, system: Ring, period: float, watch: Watch | None) -> Start:
    """On the motion that the search for periodic motions takes, or on the collocated one where it does not search."""
    q = equilibrium.displacement
    try:
        ring = compiled(system)
        if searches_orbits(model.scene) and ring is not None:
            from raceway.core.periodic.steady import beginning

            found = beginning(ring, period, q, watch)
            if found is not None and not found.told:
                return Start("orbit", found.orbit)
            if found is not None:
                return _told(model, found.orbit, found.told, found.warnings)
        return Start("orbit", steady_orbit(system, period, q))
    except ConvergenceError as why:
        return Start("ramp", settled=False, warnings=(f"{why}: started with a ramp instead",))


def _told(model: Model, orbit: Orbit, orbits: list[dict[str, Any]], warnings: tuple[str, ...]) -> Start:
    """Of a scene whose motion is not that of its start, the orbits are told in warnings only."""
    scene = model.scene
    other = {
        "without friction": scene.contact.friction > 0.0,
        "with balls that do not orbit": scene.kinematics.orbiting,
        "at its first speed": model.excitation.period_s is None,
    }
    words = ", ".join(word for word, here in other.items() if here)
    if words:
        return Start("orbit", orbit, (), orbits[0]["stable"], tuple(f"{words}: {text}" for text in warnings))
    return Start("orbit", orbit, tuple(orbits), orbits[0]["stable"], warnings)


#: Called as ``on_progress(what, done, total)``; ``total`` is 0 where it is not known.  What it raises ends the work.
OnProgress = Callable[[str, int, int], None]


@attrs.frozen(eq=False)
class Simulation:
    """A recorded motion.

    Attributes
    ----------
    record : the turns that identification uses;  whole : all of them
    critical_time_step : stable limit of explicit steps at the stiffest state known before the run [s]
    start : how it began
    warnings : what a user should know
    """

    record: Record
    whole: Record
    critical_time_step: float | None
    start: Start
    warnings: tuple[str, ...]

    @property
    def orbits(self) -> list[Tables]:
        """``motion.orbits`` of result.json: the steady motions that were found; empty where none were looked for."""
        return list(self.whole.counts.get("orbits", self.start.orbits))


def simulate(
    model: Model,
    equilibrium: Equilibrium,
    on_progress: OnProgress | None = None,
    steps_per_turn: int | None = None,
    begun: Simulation | None = None,
    near: Simulation | None = None,
    stay: bool = False,
) -> Simulation:
    """Integrate the plan's turns.

    Parameters
    ----------
    steps_per_turn : instead of the scene's
    begun : of the same scene with other steps, whose start is taken
    near : of a similar scene by the same integrator, for integrators that can start from it
    stay : on the motion of ``near`` where several may exist

    Raises
    ------
    ConvergenceError, StabilityError
        A failed integration, or an explicit step above its stable limit.
    """
    system, method, scene = model.system, model.scene.integrator.method, model.scene
    period = model.excitation.period_s or 1.0 / model.excitation.frequency_hz
    watch = None if on_progress is None else (lambda: on_progress("the search for orbits", 0, 0))
    begin = chosen_start(model, equilibrium, watch) if begun is None else begun.start
    start, orbit, warnings = begin.kind, begin.orbit, begin.warnings
    critical = _critical_step(model, equilibrium, orbit) if method.inertial else None
    steps_per_turn = steps_per_turn or _steps_per_turn(model, period, critical)
    dt = period / steps_per_turn
    warnings += _step_warnings(model, equilibrium, period, steps_per_turn, critical)
    ramp_turns = _ramp_turns(model) if start == "ramp" else 0.0
    ramp_turns = min(ramp_turns, float(model.plan.turns))
    schedule = Schedule(
        dt,
        steps_per_turn,
        model.plan.turns,
        _stride(steps_per_turn, model.plan.turns, method.inertial),
        ramp_turns * period,
    )
    motion = _motion(model, equilibrium, start, orbit, dt)
    if near is not None:
        motion = attrs.evolve(motion, near=near.whole.solution, stay=stay)
    label = f"{scene.integrator.kind}, {schedule.steps} steps"
    progress = None if on_progress is None else (lambda done, total: on_progress(label, done, total))
    whole = integrate(method, system, motion, schedule, progress)
    used = model.plan.turns - ceil(ramp_turns)
    if start == "static" and method.inertial and not method.steady:
        used = max(model.plan.turns // 3, 1)
    warnings += tuple(whole.counts.get("warnings", ()))
    return Simulation(whole.last(max(used, 1)), whole, critical, begin, warnings)


def _step_warnings(
    model: Model, equilibrium: Equilibrium, period: float, steps_per_turn: int, critical: float | None
) -> tuple[str, ...]:
    """Refuse explicit steps above the stable limit; warn of those near to it."""
    scene, dt = model.scene, period / steps_per_turn
    if scene.integrator.method.implicit or critical is None:
        return ()
    if dt >= critical:
        least = int(period / (SAFETY * critical)) + 1
        raise StabilityError(
            f"`integrator.steps_per_turn` = {steps_per_turn} makes a step of {dt:.3g} s, above the stable limit of "
            f"'{scene.integrator.kind}', {critical:.3g} s. Take at least {least}, or 'auto'.",
            {"q": equilibrium.displacement, "ball": equilibrium.ball},
        )
    if dt > SAFETY * critical * (1.0 + 1e-9):
        return (
            f"the step is {dt / critical:.2f} of the stable limit, which belongs to one state: balls that lose and regain contact "
            f"each turn can make the motion grow above {SAFETY} of it. Take {ceil(period / (SAFETY * critical))} steps per turn",
        )
    return ()


def _motion(model: Model, equilibrium: Equilibrium, start: str, orbit: Orbit | None, dt: float) -> Motion:
    q, ball, system = equilibrium.displacement, equilibrium.ball, model.system.at_speed(0.0)
    if model.scene.integrator.method.steady:
        # Searched for from the equilibrium: what would happen there under the force at once is of no use.
        return Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy())
    if model.system.spin is not None and orbit is None:
        q, ball, _ = system.settle(q)
    if not model.scene.integrator.method.inertial:
        return model.bearing.at_equilibrium(system, q, ball, start == "ramp")
    if orbit is not None:
        return model.bearing.on_orbit(system, orbit, dt)
    return model.bearing.at_rest(system, q, ball, start == "ramp")


def _ramp_turns(model: Model) -> float:
    given = float(getattr(model.scene.excitation, "ramp_turns", 0.0))
    return given if given > 0.0 else 2.0 * model.plan.turns / 3.0


def _critical_step(model: Model, equilibrium: Equilibrium, orbit: Orbit | None) -> float:
    """Stable limit of explicit steps: the shortest of the states known before the run."""
    slopes = [(equilibrium.stiffness_rows_held, equilibrium.damping_rows_held)]
    slopes += [] if orbit is None else zip(orbit.stiffness, orbit.damping, strict=True)
    return min(model.system.damped_time_step(stiffness, damping) for stiffness, damping in slopes)


def _steps_per_turn(model: Model, period: float, critical: float | None) -> int:
    given = model.scene.integrator.steps_per_turn
    if isinstance(given, int):
        return given
    if model.scene.integrator.method.implicit or critical is None:
        return STEPS_PER_TURN
    return stable_steps_per_turn(period, critical)


def _stride(steps_per_turn: int, turns: int, inertial: bool = True) -> int:
    """Every how many steps are recorded: a divisor that leaves the plan's samples a turn, or all when there is none."""
    return steps_per_turn // recorded_per_turn(steps_per_turn, turns, inertial)


def simulate_speeds(model: Model, on_progress: OnProgress | None = None) -> list[tuple[Model, Simulation]]:
    """Model and simulation for each of the identifier's ``speeds_rpm`` of the whirl; spin and force stay the same."""
    found = []
    kinematics = attrs.evolve(model.scene.kinematics, spin_speed_rpm=model.scene.spin_speed * 30.0 / np.pi)
    for rpm in model.scene.identifier.method.speeds_rpm:
        given = model.scene.excitation
        excitation = given.at_whirl(float(rpm)) if hasattr(given, "at_whirl") else attrs.evolve(given, speed_rpm=float(rpm))
        scene = attrs.evolve(model.scene, excitation=excitation, kinematics=kinematics)
        one = build_model(scene, make_plan(scene))
        found.append((one, simulate(one, settle(one), on_progress)))
    return found
