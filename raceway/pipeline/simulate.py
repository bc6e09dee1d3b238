"""From a model and its equilibrium to motion: integrated from its start, or the steady motion, solved for."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable
from math import ceil, pi
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, model_of
from raceway.core.record import Motion, Record, Schedule, Stay, drift, friction_lost, largest_share
from raceway.core.ring.kernels.layout import GYROSCOPIC
from raceway.core.ring.orbit import Orbit, steady_orbit
from raceway.core.ring.system import compiled
from raceway.core.signals import stiffness, synchronous_phasor
from raceway.core.time.schemes import integrate
from raceway.errors import ConvergenceError, SceneError, StabilityError
from raceway.framework.duties import at_whirl, ramp_turns, steady_form
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.planning.plan import plan_of
from raceway.planning.resolve import SAFETY, STEPS_PER_TURN, recorded_per_turn, stable_steps_per_turn
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.core.periodic.search import Neighbour, Recorded

#: Called as ``on_progress(what, done, total)``; ``total`` is 0 where it is not known.  What it raises ends the work.
OnProgress = Callable[[str, int, int], None]
#: Called in the search for orbits; what it raises ends the search.
Watch = Callable[[], None]
#: Slips that a start leaves in contacts which stick stay there.
_STICKS = (
    "friction: sticking depends on the start of the motion, so that several steady motions exist: "
    "integrator.start = 'orbit', 'ramp' and 'static' lead to different ones"
)
#: Samples of a steady turn, and the error of its displacement over its amplitude.
_SAMPLES, _TOLERANCE = 360, 1e-8
#: Speeds in a row without a steady motion after which none is searched for.
_GIVEN_UP = 3
#: Two turns that differ by less than this share of their distance from the steady motion repeat each other.
_REPEATS = 0.01


@attrs.frozen(eq=False)
class Start:
    """How a motion begins."""

    kind: str  # "orbit", "ramp" or "static"
    orbit: Orbit | None = None  # that it begins on
    #: ``motion.orbits`` of result.json: the steady motions that were found in the search for it
    orbits: tuple[Tables, ...] = ()
    repeats: bool = True  # False where turns need not repeat: no orbit was found, or only one that is unstable
    warnings: tuple[str, ...] = ()  # what a user should know


@attrs.frozen(eq=False)
class Simulation:
    """A recorded motion."""

    #: model, equilibrium : that it is a motion of, and about
    model: Model
    equilibrium: Equilibrium
    record: Record  # the turns that identification uses
    whole: Record  # all of them
    critical_time_step: float | None  # stable limit of explicit steps at the stiffest state known before the run [s]
    start: Start  # how it began
    warnings: tuple[str, ...]  # what a user should know
    near: Simulation | None = None  # the similar scene's that it was given

    @property
    def steps_per_turn(self) -> int:
        return self.whole.schedule.steps_per_turn

    @property
    def orbits(self) -> list[Tables]:
        """``motion.orbits`` of result.json: the steady motions that were found; empty where none were looked for."""
        return list(self.whole.counts.get("orbits", self.start.orbits))


def simulate(
    model: Model,
    equilibrium: Equilibrium,
    on_progress: OnProgress | None = None,
    steps_per_turn: int | None = None,
    start: Start | None = None,
    near: Simulation | None = None,
    stay: Stay = False,
) -> Simulation:
    """Integrate the plan's turns; ``ConvergenceError`` where that fails, ``StabilityError`` above the stable limit of explicit steps.

    steps_per_turn : instead of the scene's
    start : None: that of the scene
    near : of a similar scene, for the search for an orbit, and for integrators of the same kind, that can start from it
    stay : see ``Stay``
    """
    method, turns = model.problem.integrator.method, model.plan.turns
    period = model.excitation.period_s or 1.0 / model.excitation.frequency_hz
    watch = None if on_progress is None else (lambda: on_progress("the search for orbits", 0, 0))
    solution, orbit_near = None if near is None else near.whole.solution, None
    if solution is not None:
        from raceway.core.periodic.search import Neighbour

        orbit_near = solution if isinstance(solution, Neighbour) else None
    start = start or start_of_motion(model, equilibrium, watch, orbit_near, stay)
    # Stable limit of explicit steps: the shortest of the states known before the run.
    orbit, K, C = start.orbit, equilibrium.stiffness_rows_held[None], equilibrium.damping_rows_held[None]
    if orbit is not None:
        K, C = np.concatenate([K, orbit.stiffness]), np.concatenate([C, orbit.damping])
    critical = model.system.damped_time_step(K, C) if method.inertial else None
    steps = steps_per_turn or model.problem.integrator.steps_per_turn
    if not isinstance(steps, int):
        steps = STEPS_PER_TURN if method.implicit or critical is None else stable_steps_per_turn(period, critical)
    steps_per_turn = steps
    step_warnings = _step_warnings(model, equilibrium, period, steps_per_turn, critical)
    ramp_length = ramp_turns(model.problem.excitation) or 2.0 * model.plan.turns / 3.0
    ramp = min(ramp_length, float(turns)) if start.kind == "ramp" else 0.0
    stride = recording_stride(steps_per_turn, turns, method.inertial)
    schedule = Schedule(period / steps_per_turn, steps_per_turn, turns, stride, ramp * period)
    motion = _motion(model, equilibrium, start, schedule.dt)
    same = near is not None and near.model.problem.integrator.kind == model.problem.integrator.kind
    motion = attrs.evolve(motion, near=solution if same else None, stay=stay)
    label = f"{model.problem.integrator.kind}, {schedule.steps} steps"
    progress = None if on_progress is None else (lambda step, total: on_progress(label, step, total))
    record = integrate(method, model.system, motion, schedule, progress)
    window = turns - ceil(ramp)
    if start.kind == "static" and method.inertial and not method.steady:
        window = max(model.plan.turns // 3, 1)
    warnings = (*start.warnings, *step_warnings, *record.counts.get("warnings", ()))
    near = near and attrs.evolve(near, near=None)
    return Simulation(model, equilibrium, record.last(max(window, 1)), record, critical, start, warnings, near)


def simulate_speeds(model: Model, on_progress: OnProgress | None = None) -> list[Simulation]:
    """A motion for each of the identifier's ``speeds_rpm`` of the whirl; spin and force stay the same."""
    motions, force = [], model.problem.excitation
    kinematics = attrs.evolve(model.problem.kinematics, spin_speed_rpm=model.problem.spin_speed * 30.0 / np.pi)
    for speed in model.problem.identifier.method.speeds_rpm:
        excitation = at_whirl(force, float(speed))
        problem = attrs.evolve(model.problem, excitation=excitation, kinematics=kinematics)
        at_speed = model_of(problem, plan_of(problem))
        motions.append(simulate(at_speed, solve_equilibrium(at_speed), on_progress))
    return motions


def start_of_motion(
    model: Model, equilibrium: Equilibrium, watch: Watch | None = None, near: Neighbour | None = None, stay: Stay = False
) -> Start:
    """The scene's start; an orbit that cannot be found becomes a ramp, with a warning.  ``near``, ``stay``: for the search for it."""
    problem, method = model.problem, model.problem.integrator.method
    if method.steady:
        return Start("static")
    kind = "ramp" if model.problem.ramped else problem.integrator.start
    start = _orbit_start(model, equilibrium, watch, near, stay) if kind == "orbit" and method.inertial else Start(kind)
    return attrs.evolve(start, warnings=(*start.warnings, _STICKS)) if problem.contact.friction > 0.0 else start


def _orbit_start(model: Model, equilibrium: Equilibrium, watch: Watch | None, near: Neighbour | None, stay: Stay) -> Start:
    """On the motion that the search for periodic motions takes, or on the collocated one where it does not search."""
    excitation, system = model.excitation, model.bearing.periodic_system(model.system.at_speed(0.0))
    if excitation.period_s is None:
        # What changes its speed starts on the orbit of its first moment.
        steady = steady_form(excitation)
        if steady is None:
            why = "the excitation does not repeat every turn: started with a ramp instead of on the orbit"
            return Start("ramp", repeats=False, warnings=(why,))
        excitation = steady
        system = attrs.evolve(system, force=excitation.kernel(), force_params=excitation.parameters())
    try:
        ring, found = compiled(system), None
        if ring is not None and model.problem.searches_orbits:
            from raceway.core.periodic.steady import starting_orbit

            found = starting_orbit(ring, excitation.period_s, equilibrium.displacement, watch, near, stay)
        if found is None:
            return Start("orbit", steady_orbit(system, excitation.period_s, equilibrium.displacement))
        orbit, orbits, warnings = found
        if not orbits:
            return Start("orbit", orbit)
        # Orbits of another motion than that of the scene are stated in warnings only.
        differences = {
            "without friction": model.problem.contact.friction > 0.0,
            "with balls that do not orbit": model.problem.kinematics.orbiting,
            "at its first speed": model.excitation.period_s is None,
        }
        if prefix := ", ".join(words for words, differs in differences.items() if differs):
            return Start("orbit", orbit, (), orbits[0]["stable"], tuple(f"{prefix}: {text}" for text in warnings))
        return Start("orbit", orbit, tuple(orbits), orbits[0]["stable"], warnings)
    except ConvergenceError as why:
        return Start("ramp", repeats=False, warnings=(f"{why}: started with a ramp instead",))


def _step_warnings(
    model: Model, equilibrium: Equilibrium, period: float, steps_per_turn: int, critical: float | None
) -> tuple[str, ...]:
    """Refuse explicit steps above the stable limit; warn of those near to it."""
    problem, dt = model.problem, period / steps_per_turn
    if problem.integrator.method.implicit or critical is None:
        return ()
    if dt >= critical:
        least = int(period / (SAFETY * critical)) + 1
        step = f"`integrator.steps_per_turn` = {steps_per_turn} makes a step of {dt:.3g} s"
        limit = f"the stable limit of '{problem.integrator.kind}', {critical:.3g} s. Use at least {least}, or 'auto'."
        raise StabilityError(f"{step}, above {limit}", {"q": equilibrium.displacement, "ball": equilibrium.ball})
    if dt > SAFETY * critical * (1.0 + 1e-9):
        return (
            f"the step is {dt / critical:.2f} of the stable limit, which holds for one state: where balls lose and regain contact "
            f"each turn, the motion may grow above {SAFETY} of it. Use {ceil(period / (SAFETY * critical))} steps per turn",
        )
    return ()


def _motion(model: Model, equilibrium: Equilibrium, start: Start, dt: float) -> Motion:
    q, ball = equilibrium.displacement, equilibrium.ball
    system, method = model.system.at_speed(0.0), model.problem.integrator.method
    if method.steady:
        # Searched for from the equilibrium: what would happen there under the force at once is of no use.
        return Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy())
    if model.system.spin is not None and start.orbit is None:
        q, ball, _ = system.solve_equilibrium(q)
    if not method.inertial:
        return model.bearing.at_equilibrium(system, q, ball, start.kind == "ramp")
    if start.orbit is not None:
        return model.bearing.on_orbit(system, start.orbit, dt)
    return model.bearing.at_rest(system, q, ball, start.kind == "ramp")


def recording_stride(steps_per_turn: int, turns: int, inertial: bool = True) -> int:
    """Every how many steps are recorded: a divisor that leaves the plan's samples per turn, or all when there is none."""
    return steps_per_turn // recorded_per_turn(steps_per_turn, turns, inertial)


@attrs.define
class SteadyMotions:
    """Steady motions of an excitation that changes its speed, speed by speed; each is solved for once."""

    model: Model
    on_progress: OnProgress | None = None  # called in the searches, which what it raises ends
    values: dict[float, complex | None] = attrs.field(factory=dict)  # Z [N/m] by speed [rad/s]
    #: the motion at the last speed; where several exist, the next one continues it, as the motion that is integrated does
    last: Record | None = None
    missed: int = 0  # speeds in a row without a motion; after some, none is searched for

    def value(self, speed: float) -> complex | None:
        """Z [N/m] at one speed [rad/s]; None where there is no motion that can be solved for, or none is found."""
        if speed not in self.values:
            self.values[speed] = self._solved(speed)
        return self.values[speed]

    def _solved(self, speed: float) -> complex | None:
        model = model_at_speed(self.model, speed)
        if model is None or self.missed >= _GIVEN_UP:
            return None
        near = None if self.last is None else self.last.solution
        record = steady_record(model, solve_equilibrium(model), near, self.on_progress)
        self.missed = self.missed + 1 if record is None else 0
        if record is None:
            return None
        self.last = record
        frequency = model.excitation.frequency_hz
        return stiffness(*(synchronous_phasor(record.time, x, frequency) for x in (record.force, record.displacement)))


def model_at_speed(model: Model, speed: float) -> Model | None:
    """The same scene at one speed [rad/s], of an excitation that has a steady form."""
    steady = steady_form(model.excitation)
    if steady is None:
        return None
    excitation = attrs.evolve(steady, speed_rpm=speed * 30.0 / pi)  # type: ignore[misc]
    return model_of(attrs.evolve(model.problem, excitation=excitation), model.plan)


def steady_record(
    model: Model, equilibrium: Equilibrium, near: Neighbour | Recorded | None = None, on_progress: OnProgress | None = None
) -> Record | None:
    """One turn of the steady motion, that near another one where several exist; None where none can be solved for or is found."""
    from raceway.core.periodic.steady import steady

    if model.excitation.period_s is None:
        return None
    q, ball = equilibrium.displacement, equilibrium.ball
    start = Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy(), near=near, stay=True)
    schedule = Schedule(model.excitation.period_s / _SAMPLES, _SAMPLES, 1)
    watch = None if on_progress is None else (lambda step, total: on_progress("the steady motion", step, total))
    try:
        return steady(model.system, start, schedule, _TOLERANCE, on_chunk=watch)
    except (ConvergenceError, SceneError):
        return None


def last_turn(record: Record, period: float) -> Recorded | None:
    """The last turn of a record as ``steady`` starts from it; None where the record is no whole turns of equal samples."""
    steps, stride = record.schedule.steps_per_turn, record.schedule.stride
    n = steps // stride
    if n * stride != steps or len(record.time) < n or record.schedule.steps % steps:
        return None
    from raceway.core.periodic.search import Recorded

    # Samples end each turn: the last one of a turn is the first moment of the next.
    q, v = (np.roll(values[-n:], 1, axis=0) for values in (record.displacement, record.velocity))
    lines = np.fft.rfft(v, axis=0) * (2j * pi / period * np.arange(n // 2 + 1))[:, None]
    return Recorded(period, q, v, np.fft.irfft(lines, n, axis=0))


def settles_elsewhere(model: Model, simulation: Simulation, orbit: Record) -> bool:
    """Whether a motion repeats itself turn by turn on another orbit than the steady motion: several exist.

    What is left of a free vibration near this orbit changes from turn to turn by as much as it is far from the orbit, unless
    its frequency is a multiple of the force's to some thousandths.
    """
    record, frequency = simulation.whole, model.excitation.frequency_hz
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    if len(record.time) < 2 * per_turn:
        return False
    last, before = record.displacement[-per_turn:, :3], record.displacement[-2 * per_turn : -per_turn, :3]
    motion, steady = (
        synchronous_phasor(turn.time[-n:], turn.displacement[-n:, :3], frequency)
        for turn, n in ((record, per_turn), (orbit, _SAMPLES))
    )
    change = float(np.sqrt(2.0 * ((last - before) ** 2).sum(axis=1).mean()))
    return change < _REPEATS * float(np.linalg.norm(motion - steady))


def work_of(motions: list[Simulation]) -> dict[str, Any]:
    """Counts of the table ``cost``."""
    counts, unit = [motion.whole.counts for motion in motions], 1 if sys.platform == "darwin" else 1024
    devices = [count["device"] for count in counts if count.get("device", "cpu") != "cpu"]
    return {
        "steps": sum(count["steps"] for count in counts),
        "newton_iterations": sum(count["evaluations"] for count in counts),
        "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit,
        "threads": max((count.get("threads", 1) for count in counts), default=1),
        **({"device": devices[0]} if devices else {}),
    }


def stability_of(motions: list[Simulation]) -> Tables:
    """The table ``stability``: the worst of all motions (several speeds may be run); friction's energy is their sum."""
    drifts = [drift for drift in map(_drift, motions) if drift is not None]
    rubbing = []
    for model, whole in ((m.model, m.whole) for m in motions if m.model.problem.contact.friction > 0.0):
        lost = friction_lost(whole.energies) if whole.energies else model.bearing.friction_lost(model.system, whole)
        rubbing.append(lost)
    energies = [motion.whole.energies for motion in motions if motion.whole.energies]
    limits = [motion.critical_time_step for motion in motions if motion.critical_time_step is not None]
    counts = [motion.whole.counts for motion in motions]
    floquet = [count["floquet"] for count in counts if count.get("floquet") is not None]
    return {
        "floquet": max(floquet, key=lambda table: table["largest"], default=None),
        "friction_energy_j": float(sum(rubbing)) if rubbing else None,
        "critical_time_step_s": min(limits, default=None),
        "energy_drift": max(drifts, default=None),
        "hourglass_energy_ratio": max((largest_share(table, "hourglass", "elastic") for table in energies), default=None),
        "energies_j": {name: float(values[-1]) for name, values in energies[-1].items()} if energies else None,
        "max_penetration_m": max((count["max_penetration_m"] for count in counts), default=None),
        "status": "completed",
    }


def _drift(motion: Simulation) -> float | None:
    """Drift of the energy balance; None where the motion's energy is not defined or is not balanced."""
    model, problem = motion.model, motion.model.problem
    if motion.whole.energies:
        return drift(motion.whole.energies)
    if not model.traits.resultants:
        return None  # the energy that points store does not follow from the gap of the pair
    law = problem.contact.law
    potential = law.state_size == 0 and not law.dissipative and model.system.scalars[GYROSCOPIC] == 0.0
    # What changes the speed of the balls does work, too.
    steady = motion.start.kind != "ramp" and not problem.kinematics.orbiting and model.system.spin is None
    if not (potential and steady and problem.integrator.method.inertial):
        return None
    from raceway.core.ring.energy import energy_balance

    ring = compiled(model.system)
    return None if ring is None else energy_balance(ring, motion.whole).drift
