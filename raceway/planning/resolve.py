"""What a scene implies, each answer once: after ``resolve`` nobody asks the scene again."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from math import ceil, pi
from typing import Any, Generic, TypeVar, overload

import attrs

from raceway.core.columns import cos, log, sin, some, sqrt, with_values
from raceway.core.contact.geometry import axial_balance
from raceway.errors import SceneError
from raceway.framework.contracts import Traits
from raceway.framework.duties import BodyKind, changes_speed, duration_s, has_phase, ramp_turns, speed_rpm, steady_form
from raceway.framework.loading.registry import default_registry
from raceway.framework.rules import Rule, speaking
from raceway.scene.bearing import Bearing
from raceway.scene.growth import RunningBearing, ring_inertia
from raceway.scene.lubricant import lubricated
from raceway.scene.ratings import LoadRatings, load_ratings, ratings_of_numbers
from raceway.scene.scene import Scene
from raceway.scene.tables import TIME_CONSTANTS, AutoIntegrator, SceneTables
from raceway.storage.tables import Tables

#: Steps a turn where the scene says "auto", and samples per turn that are kept of short runs.
STEPS_PER_TURN = 360
#: Part of the stable limit, taken at the stiffest tangent of the orbit, that "auto" steps take. Balls that leave and meet the
#: races each turn pump motions up a little below the limit of the frozen tangent: one orbit at 0.885 of it grew in 49 turns.
SAFETY = 0.8
#: Samples of a long run's record.
_SAMPLES = 72_000
#: What a record takes at the peak over its own arrays: 3.7 times measured with 12 balls and 400 turns.  Records above the limit are refused [bytes].
_COPIES = 4
_MEMORY_LIMIT = 4 * 2**30

#: Why what needs balls of one kind is refused.
ROWS = "the rows of this set are different bearings"

T = TypeVar("T")


class Derived(Generic[T]):
    """A quantity that follows from a scene: ``compute`` gives its value and what decides it, once a problem."""

    def __init__(self, compute: Callable[[Any], tuple[T, str]]) -> None:
        self._compute, self._name, self.__doc__ = compute, compute.__name__, compute.__doc__

    def reasoned(self, problem: Problem) -> tuple[T, str]:
        """Its value, and what decides it."""
        answers = problem._derived
        if self._name not in answers:
            answers[self._name] = self._compute(problem)
        answer: tuple[T, str] = answers[self._name]
        return answer

    @overload
    def __get__(self, problem: None, owner: type) -> Derived[T]: ...
    @overload
    def __get__(self, problem: Problem, owner: type) -> T: ...
    def __get__(self, problem: Problem | None, owner: type) -> Derived[T] | T:
        return self if problem is None else self.reasoned(problem)[0]


@attrs.frozen
class _Inertia:
    """Mass [kg], transverse and polar inertia [kg m2] of the inner rings and of the rotor's share."""

    mass: float
    transverse: float
    polar: float


@attrs.frozen
class Problem(SceneTables):
    """What is computed: the tables of a scene, and what follows from them.

    scene : what the user said, for messages and results
    points : (n,) where numbers are columns of n operating points, () of one
    kinematics : with a hypothesis for each 'auto'
    integrator_why : why planning chose the integrator; empty where the scene says one
    hypotheses_why : why ``gyroscopic`` and ``ring_growth`` have their values

    What follows is computed when it is asked for first: rules ask only for what a scene that may be refused has.
    """

    scene: Scene
    points: tuple[int, ...] = ()
    integrator_why: str = ""
    hypotheses_why: Tables = attrs.field(factory=dict, eq=False)
    _derived: dict[str, tuple[Any, str]] = attrs.field(factory=dict, init=False, eq=False, repr=False)

    def why(self, quantity: str) -> str:
        """What decides a derived quantity: a key of the scene, a default, a plug-in."""
        rule: Derived[object] = getattr(Problem, quantity)
        return rule.reasoned(self)[1]

    def derived(self) -> Tables:
        """``value`` and ``why`` of each derived quantity."""
        reasons = {name: item.reasoned(self) for name, item in vars(Problem).items() if isinstance(item, Derived)}
        return {
            name: {"value": attrs.asdict(value) if attrs.has(type(value)) else value, "why": why}
            for name, (value, why) in reasons.items()
        }

    def said(self, key: str, value: str = "") -> str:
        """A key as a reason, with a value, and whether that is a default."""
        return f"{key}{value and f' is {value}'}{'' if self.says(key) else ', by default'}"

    def says(self, key: str) -> bool:
        """Whether a key such as "kinematics.gyroscopic" was said, by the user or a preset; else its value is a default."""
        part: object = self.scene.source
        for name in key.split("."):
            if not isinstance(part, dict) or name not in part:
                return False
            part = part[name]
        return True

    def integrated(self, why: str, steady: bool = False) -> Problem:
        """The same problem integrated over time, or by its steady orbit, and why planning chose that."""
        kind = AutoIntegrator.STEADY if steady else AutoIntegrator.TRANSIENT
        integrator = attrs.evolve(self.integrator, kind=kind, method=default_registry().find("integrator", kind).plugin())
        return attrs.evolve(self, integrator=integrator, integrator_why=why)

    @cached_property
    def unsteady(self) -> str:
        """Why there is no steady orbit that can be solved for by itself; empty where there is."""
        return next((words for _, words in speaking(_UNSTEADY, self)), "")

    @property
    def force_alone_directs(self) -> bool:
        """Whether nothing but the force distinguishes directions."""
        return self.excitation.sense != 0 and not any(self.load.radial) and not (any(self.load.moment) and self.tilts)

    @cached_property
    def body_kind(self) -> BodyKind:
        """The kind of bodies, which answers for this problem."""
        return BodyKind(self)

    @property
    def traits(self) -> Traits:
        """Of the bodies."""
        return self.body_kind.traits

    @cached_property
    def ratings(self) -> tuple[LoadRatings, ...]:
        """Load ratings of each row."""
        return tuple(map(load_ratings if self.points else ratings_of_numbers, self.bearing.of_rows))

    @Derived
    def spin_speed(self) -> tuple[float, str]:
        """Speed of the inner ring [rad/s]."""
        rpm = self.kinematics.spin_speed_rpm
        if rpm is not None:
            return rpm * pi / 30.0, "kinematics.spin_speed_rpm"
        rpm = speed_rpm(self.excitation)
        if rpm is not None:
            return rpm * pi / 30.0, f"the speed of excitation '{self.excitation.name}'"
        return 0.0, "no speed is given"

    @Derived
    def gyroscopic(self) -> tuple[str, str]:
        """Who carries the balls' gyroscopic moments."""
        return self.kinematics.gyroscopic, self.hypotheses_why["gyroscopic"]

    @Derived
    def ring_growth(self) -> tuple[bool | str, str]:
        """How the inner ring grows with the speed."""
        return self.kinematics.ring_growth, self.hypotheses_why["ring_growth"]

    @Derived
    def time_constant(self) -> tuple[float, str]:
        """Of the contacts' dashpots c = tau k [s]; 0 where there are none of this kind, of a band the low end."""
        contact = self.contact
        if contact.in_a_band:
            return TIME_CONSTANTS[0], "the low end of contact.damping = 'band'"
        if contact.loss_factor is not None and self.excitation is not None:
            factor = contact.loss_factor / (2.0 * pi * float(self.excitation.frequency_hz))
            return factor, "contact.loss_factor at the frequency of the excitation"
        constant = 0.0 if contact.time_constant is None else contact.time_constant
        return constant, self.said("contact.time_constant")

    @Derived
    def tilts(self) -> tuple[bool, str]:
        """Whether the ring tilts."""
        if self.supports.tilt == "locked":
            return False, self.said("supports.tilt", "locked")
        return True, "supports.tilt lets the ring tilt"

    @Derived
    def spin_changes(self) -> tuple[bool, str]:
        """Whether the spin speed is that of an excitation that changes its speed, and changes with it."""
        excitation = self.excitation
        if excitation is None or excitation.period_s is not None or not has_phase(excitation) or not self.spin_speed > 0.0:
            return False, "no excitation changes the speed"
        if self.kinematics.spin_speed_rpm is not None:
            rpm = self.kinematics.spin_speed_rpm
            return False, f"balls, ring and rotor stay at kinematics.spin_speed_rpm = {rpm:.6g} at every speed"
        return True, f"balls, ring and rotor follow the speed of excitation '{excitation.name}'"

    @Derived
    def inertia(self) -> tuple[_Inertia, str]:
        """Of the inner rings and the rotor's share."""
        mass, transverse, polar = ring_inertia(self.bearing)
        rotor = self.rotor
        why = "[rotor], and the inner rings where bearing.bore and bearing.width are given"
        return _Inertia(rotor.mass + mass, rotor.transverse_inertia + transverse, rotor.polar_inertia + polar), why

    @cached_property
    def running(self) -> RunningBearing:
        """The bearing on its seats, warm, at its speed."""
        return RunningBearing(self.bearing, self.mounting, self.kinematics, self.spin_speed)

    @cached_property
    def axial_approach(self) -> tuple[float, float]:
        """(x [m], load of a ball [N]) of the first row under the axial load alone."""
        b = self.bearing
        distance = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter
        direction = sin(b.contact_angle), cos(b.contact_angle)
        return axial_balance(series_factor(b), distance, *direction, b.ball_count, abs(self.load.axial))

    @cached_property
    def highest_frequency(self) -> float:
        """Largest natural frequency of the ring on its contacts [rad/s], roughly."""
        b, (_, load) = self.bearing, self.axial_approach
        if self.excitation is not None:
            load += self.excitation.amplitude_n * (5.0 / b.ball_count)  # of any size that is a number
        normal = 1.5 * load / (load / series_factor(b)) ** (2.0 / 3.0) if load > 0.0 else 1.0
        alpha, inertia, tilt = b.contact_angle, self.inertia, self.supports.tilt
        best = b.ball_count * normal * max(sin(alpha) ** 2, 0.5 * cos(alpha) ** 2) / inertia.mass
        if tilt != "locked" and inertia.transverse > 0.0:
            shaft = tilt if isinstance(tilt, float) else 0.0
            tilting = 0.5 * b.ball_count * normal * (sin(alpha) * b.pitch_diameter / 2.0) ** 2 + shaft
            best = max(best, tilting / inertia.transverse)
        return sqrt(best) + 1e-6 * pi

    @Derived
    def recorded(self) -> tuple[bool, str]:
        """Whether anything is integrated: there is a force, and the identifier needs a record of the motion."""
        if self.excitation is None:
            return False, "the scene is static"
        if "record" not in self.identifier.method.needs:
            return False, f"identifier '{self.identifier.kind}' needs the equilibrium only"
        return True, self.integrator_why or "the identifier needs recorded motion"

    @Derived
    def several_speeds(self) -> tuple[bool, str]:
        """Whether the identifier compares motions at several whirl speeds."""
        if self.excitation is None:
            return False, "the scene is static"
        several = "speeds" in self.identifier.method.needs
        return several, f"identifier '{self.identifier.kind}' needs {'several speeds' if several else 'one speed'}"

    @property
    def period(self) -> float:
        """Of the force [s]; of one that does not repeat, of its frequency."""
        return float(self.excitation.period_s or 1.0 / self.excitation.frequency_hz)

    @property
    def ramped(self) -> bool:
        """Whether the force grows from zero."""
        return ramp_turns(self.excitation) > 0.0

    @property
    def sweeps(self) -> bool:
        """Whether the force runs through speeds."""
        return changes_speed(self.excitation)

    @Derived
    def turns(self) -> tuple[int, str]:
        """Turns that are integrated: the scene's, or as many as the excitation lasts."""
        duration = duration_s(self.excitation)
        if duration is None:
            return self.integrator.turns, self.said("integrator.turns")
        turns = max(int(duration * self.excitation.frequency_hz + 0.5), 1)
        return turns, f"excitation '{self.excitation.name}' lasts so long"

    @Derived
    def steps_per_turn(self) -> tuple[int, str]:
        """The scene's number; for 'auto' 360, or the multiple of it that a rough stiffness asks of an explicit method."""
        steps, key = self.integrator.steps_per_turn, self.said("integrator.steps_per_turn")
        if isinstance(steps, int):
            return steps, key
        explicit = self.excitation is not None and not self.integrator.method.implicit
        stable = self.stable_step if explicit else None
        if stable is None:
            return STEPS_PER_TURN, f"'auto' ({key})"
        steps = stable_steps_per_turn(self.period, damped_step_limit(stable, self.time_constant))
        return steps, f"'auto' ({key}): the stable step of '{self.integrator.kind}'"

    @cached_property
    def stable_step(self) -> float | None:
        """Rough stable limit of explicit steps [s], by the bodies; None where nothing is known."""
        return self.body_kind.stable_step()

    @Derived
    def has_orbits(self) -> tuple[bool, str]:
        """Whether steady orbits of a transient, or of it without friction, can be searched for."""
        method, excitation = self.integrator.method, self.excitation
        if excitation is None:
            return False, "the scene is static"
        if method.steady or not method.inertial:
            return False, f"integrator '{self.integrator.kind}' integrates no transient"
        if excitation.period_s is None and steady_form(excitation) is None:
            return False, f"excitation '{excitation.name}' does not repeat"
        if not self.traits.compiled:
            return False, f"forces of bodies '{self.bodies.name}' are not compiled"
        if self.contact.law.state_size > 0:
            return False, f"contact law '{self.contact.kind}' has a memory"
        return True, "the force repeats, and the contacts' forces are compiled"

    @Derived
    def searches_orbits(self) -> tuple[bool, str]:
        """Whether a transient begins on a steady orbit that can be searched for: forces are compiled and have no memory."""
        if self.integrator.start != "orbit":
            return False, f"integrator.start is {self.integrator.start}"
        if self.ramped:
            return False, "the force grows from zero"
        return self.has_orbits, self.why("has_orbits")

    @Derived
    def depends_on_start(self) -> tuple[bool, str]:
        """Whether the answer depends on the start of the motion, and a second run measures how far.

        With friction contacts stick where the slip before has left them, also in a series of equilibria.  Of elastic bodies and of
        fits over several speeds no transient is estimated: a second run of them would add nothing.
        """
        if self.contact.friction == 0.0:
            return False, "contact.friction is 0"
        if not self.recorded or self.several_speeds or self.traits.every_node:
            return False, "the transient of this scene is not estimated"
        return True, "friction: the answer depends on the start of the motion, the error is by how much"

    @Derived
    def compared_with_steady(self) -> tuple[bool, str]:
        """Whether the error of a transient is its distance from the steady motion.

        A motion that starts on its orbit is near it already.  Bodies that are stepped from Python, friction and laws with memory
        have no steady motion that can be solved for by itself.
        """
        if self.contact.friction > 0.0:
            return False, "contact.friction: there is no single steady motion"
        if not self.has_orbits:
            return False, self.why("has_orbits")
        if self.excitation.period_s is None or self.ramped or self.several_speeds or self.integrator.start != "orbit":
            return True, "the motion does not start on its steady orbit"
        return False, "the motion starts on its steady orbit"


#: Why there is no steady orbit that can be solved for by itself.
_UNSTEADY: tuple[Rule[Problem], ...] = (
    Rule("excitation", lambda p: p.excitation is None, "the scene has no [excitation]"),
    Rule(
        "excitation.kind", lambda p: p.excitation.period_s is None,
        lambda p: f"the force of excitation '{p.excitation.name}' does not repeat every turn",
    ),
    Rule(
        "contact.friction", lambda p: p.contact.friction > 0.0,
        "contact.friction: sticking depends on the start of the motion, no steady orbit is unique",
    ),
    Rule(
        "contact.kind", lambda p: p.contact.law.state_size > 0,
        lambda p: f"contact law '{p.contact.kind}' has a memory: its steady orbit cannot be solved for directly",
    ),
    Rule(
        "kinematics.orbiting", lambda p: p.kinematics.orbiting and not p.force_alone_directs,
        "kinematics.orbiting: the ball-pass frequency differs from that of the force, no motion repeats every turn unless the force turns and no radial load acts",
    ),
)  # fmt: skip

#: Why integrator.kind = "auto" integrates over time nevertheless.
_TRANSIENT: tuple[Rule[Problem], ...] = (
    *(
        Rule(key, partial(Problem.says, key=key), f"`{key}` is set, a key of transients")
        for key in ("integrator.turns", "integrator.steps_per_turn", "integrator.start")
    ),
    Rule("excitation.ramp_turns", lambda p: p.ramped, "the force grows from zero"),
    Rule("bodies.kind", lambda p: not p.traits.compiled, "forces of these bodies and contacts are not compiled"),
)

#: Why gyroscopic moments of the balls cannot be computed.
MOMENTS: tuple[Rule[Problem], ...] = (
    Rule(
        "kinematics.gyroscopic", lambda p: p.kinematics.gyroscopic != "none" and not p.kinematics.ball_inertia,
        "needs the balls' centrifugal force, which presses an unloaded ball to its race: set ball_inertia = true",
    ),
    Rule(
        "kinematics.gyroscopic", lambda p: p.kinematics.gyroscopic != "none" and not p.bearing.equal_rows,
        f"{ROWS}: moments are computed for balls of one kind only. Set it 'none'",
    ),
)  # fmt: skip

#: Why the growth of the inner ring cannot be computed.
GROWTH: tuple[Rule[Problem], ...] = (
    Rule("kinematics.ring_growth", lambda p: p.kinematics.ring_growth and p.bearing.bore is None, "needs the bearing's `bore`"),
    Rule(
        "mounting.shaft_material.density",
        lambda p: p.kinematics.ring_growth and p.mounting.shaft_material
        and not p.says("mounting.shaft_material.density"),
        "is required by kinematics.ring_growth: the shaft grows with the speed, too",
    ),
)  # fmt: skip


def _with_hypotheses(problem: Problem) -> Problem:
    """The problem with a hypothesis for each key of [kinematics] that is 'auto', and why: what can be computed acts.

    With friction contacts stick along the grooves, and would carry moments twice.
    """
    fit = "as far as mounting.shaft_interference holds" if some(problem.mounting.shaft_interference) else "as one body"
    choices: dict[str, tuple[Any, str, tuple[Rule[Problem], ...], Any]] = {
        "gyroscopic": ("traction", "both races carry them within friction", MOMENTS, "none"),
        "ring_growth": ("with_shaft", f"ring and shaft grow together, {fit}", GROWTH, False),
    }
    choice, reasons = dict[str, Any](), dict[str, str]()
    for key, (value, why, rules, off) in choices.items():
        choice[key] = now = getattr(problem.kinematics, key)
        if now == "auto":
            choice[key], words = value, ""
            if not some(problem.spin_speed):
                words = "nothing turns"
            elif key == "gyroscopic" and problem.contact.friction > 0.0:
                words = "contact.friction: contacts that stick along the grooves carry them"
            else:
                trial = attrs.evolve(problem, kinematics=with_values(problem.kinematics, **choice))
                faults = trial.body_kind.faults()
                messages = [fault.message for fault in faults if fault.path == f"kinematics.{key}"]
                words = next(iter([*(text for _, text in speaking(rules, trial)), *messages]), "")
            choice[key] = off if words else value
        word = choice[key] if isinstance(choice[key], str) else str(choice[key]).lower()
        reasons[key] = f"kinematics.{key} is {word}" + (f" by 'auto': {words or why}" if now == "auto" else "")
    return attrs.evolve(problem, kinematics=with_values(problem.kinematics, **choice), hypotheses_why=reasons)


def resolve(scene: Scene) -> Problem:
    """What a scene asks for; pure."""
    tables = {table.name: getattr(scene, table.name) for table in attrs.fields(SceneTables)}
    tables["contact"], tables["lubricant"] = lubricated(scene.contact, scene.lubricant)
    problem = _with_hypotheses(Problem(scene=scene, **tables))
    if scene.integrator.kind != AutoIntegrator.name:
        return problem
    why = problem.unsteady or next((words for _, words in speaking(_TRANSIENT, problem)), "")
    if why:
        return problem.integrated(why)
    return problem.integrated("the force repeats every turn and contacts have no memory", steady=True)


def damped_step_limit(limit: float, time_constant: float) -> float:
    """Stable limit of explicit steps [s] with dashpots c = tau k, from that without: ``Ring.damped_time_step`` of one mode."""
    ratio = 2.0 * time_constant / limit
    return limit * (sqrt(1.0 + ratio**2) - ratio)


def stable_steps_per_turn(period: float, limit: float) -> int:
    """Steps of 'auto' of an explicit method in a turn [s]: the least multiple of 360 within ``SAFETY`` of the stable step [s]."""
    return STEPS_PER_TURN * max(1, ceil(period / (SAFETY * limit) / STEPS_PER_TURN))


def recorded_per_turn(steps_per_turn: int, turns: int, inertial: bool = True) -> int:
    """Samples a turn that are really recorded: a divisor of the steps near ``samples_per_turn``, or all steps."""
    least = samples_per_turn(turns, inertial)
    fitting = (s for s in range(least, min(2 * least, steps_per_turn) + 1) if steps_per_turn % s == 0)
    return next(fitting, steps_per_turn)


def samples_per_turn(turns: int, inertial: bool = True) -> int:
    """Samples a turn that are recorded: 360, fewer in runs of more than 200 turns, never below 24.

    inertial : False for a series of equilibria, of which up to 72 000 are recorded in all: no inertia keeps the harmonics
        of the contacts small, and those beyond the samples would show as 1x
    """
    most = _SAMPLES // max(turns, 1)
    return max(24, min(STEPS_PER_TURN, most) if inertial else most)


def record_bytes(turns: int, steps_per_turn: int, count: int, inertial: bool = True) -> int:
    """Bytes that a run of so many balls takes for its record, with what identification and energy balance copy of it."""
    return _COPIES * 8 * turns * recorded_per_turn(steps_per_turn, turns, inertial) * (16 + 8 * count)


def fits(turns: int, steps_per_turn: int, count: int, inertial: bool = True) -> bool:
    """Whether a record is not refused."""
    return record_bytes(turns, steps_per_turn, count, inertial) <= _MEMORY_LIMIT


def refuse_memory(problem: Problem, turns: int, steps_per_turn: int, count: int) -> None:
    """Records that will not fit are refused before anything is computed."""
    need = record_bytes(turns, steps_per_turn, count, problem.integrator.method.inertial)
    if need > _MEMORY_LIMIT:
        remedy = "take fewer turns, or steps_per_turn = 360 or a multiple of it"
        sizes = f"{need / 2**30:.1f} GiB, above {_MEMORY_LIMIT / 2**30:.0f} GiB"
        why = f"the record of {turns} turns would take {sizes}: {remedy}"
        raise SceneError.at("integrator.turns", problem.integrator.turns, why)


def series_factor(b: Bearing) -> float:
    """K [N/m^1.5] of both races of a ball in series.

    References
    ----------
    Hamrock, Brewe: Simplified solution for stresses and deformations, J. Lubr. Tech. 105 (1983): within 5 %.
    """
    e = 1.0 / ((1 - b.rings.poisson**2) / b.rings.young + (1 - b.balls.poisson**2) / b.balls.young)
    d, g = b.ball_diameter, b.ball_diameter * cos(b.contact_angle) / b.pitch_diameter
    softness = 0.0
    for f, rolling in ((b.conformity_inner, 2 * g / (1 - g)), (b.conformity_outer, -2 * g / (1 + g))):
        along, across = (2.0 - 1.0 / f) / d, (2.0 + rolling) / d
        ratio = across / along
        ellipticity = 1.0339 * ratio**0.636
        second, first = 1.0003 + 0.5968 / ratio, 1.5277 + 0.6023 * log(ratio)
        factor = pi * ellipticity * 2.0 * e * sqrt(second / (along + across) / (4.5 * first**3))
        softness += factor ** (-2.0 / 3.0)
    return softness**-1.5
