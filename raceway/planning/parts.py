"""Parts that a scene needs, each kept or left out with its reason: coordinates, balls, bodies, motion, output; predicted times.

Times are those of a run of compiled rings, from measured times of their parts.  Constants are seconds of processor time of the
reference machine of ``slowness``, with all that a run does for its error beside its answer: packages/raceway-checks/tests/evidence/test_cost.py holds whole
runs against them.
"""

import time
from collections.abc import Collection, Mapping
from functools import cache

import attrs

from raceway.planning.resolve import Problem, recorded_per_turn

#: The part by which balls feel each other through elastic rings.
BETWEEN_BALLS = "interaction of balls through the rings"


@attrs.frozen
class Part:
    """One part, and why it is included or left out."""

    part: str
    why: str


class Decisions:
    """The parts of one scene, as they are decided.

    force : parts that are included although the scene does not need them
    """

    def __init__(self, force: Collection[str] = ()) -> None:
        self.force = force
        self.kept: list[Part] = []
        self.left_out: list[Part] = []

    def decide(self, part: str, why: str, *obstacles: tuple[bool, str]) -> bool:
        """Keep a part unless an obstacle holds, the first of which is the reason, or ``why`` for both; whether it is included."""
        obstacle = next((words or why for holds, words in obstacles if holds), "")
        stays = not obstacle or part in self.force
        (self.kept if stays else self.left_out).append(Part(part, "forced" if obstacle and stays else obstacle or why))
        return stays

    def keeps(self, name: str) -> bool:
        """Whether a part was included, by its name."""
        return any(part.part == name for part in self.kept)

    def keep(self, part: str, why: str) -> None:
        """A part that no scene of this kind can do without."""
        self.kept.append(Part(part, why))

    def leave_out(self, part: str, why: str) -> None:
        """A part that no scene of this kind has."""
        self.left_out.append(Part(part, why))


#: Name of what repeats itself, for ``make_plan``'s ``force``.
_OTHER_TURNS = "other turns"


@attrs.frozen
class Balls:
    """Requirements of the balls.

    kind : "weightless" (on the line of the groove centres), "inertial" (two unknowns each) or "tangential" (friction, gyroscopic moments)
    centrifugal, gyroscopic, friction : whether they have these loads
    """

    kind: str
    centrifugal: bool
    gyroscopic: bool
    friction: bool


@attrs.frozen
class PlannedMotion:
    """Motion that is integrated: none, where ``recorded`` is False."""

    recorded: bool
    turns: int
    steps_per_turn: int


def decide_tilts(problem: Problem, parts: Decisions) -> bool:
    """Whether the ring tilts."""
    return parts.decide("tilts", problem.why("tilts"), (not problem.tilts, ""))


def decide_balls(problem: Problem, parts: Decisions) -> Balls:
    """Forces on the balls."""
    contact, kinematics = problem.contact, problem.kinematics
    still = (not problem.spin_speed > 0.0, "no spin speed")
    why = "kinematics.ball_inertia at cage speed; two unknowns a ball"
    massless = (not kinematics.ball_inertia, "kinematics.ball_inertia is false")
    inertia = parts.decide("centrifugal force of the balls", why, still, massless)
    if problem.spin_speed > 0.0 and problem.sweeps:
        part = "change of centrifugal and gyroscopic terms with the speed"
        parts.decide(part, problem.why("spin_changes"), (not problem.spin_changes, ""))
    rates = problem.excitation is not None and (problem.integrator.method.inertial or not problem.recorded)
    undamped = not (contact.dashpot > 0.0 or problem.time_constant > 0.0)
    why = "contact.damping is set" if contact.dashpot > 0.0 else f"c = tau k, tau = {problem.time_constant:.3g} s"
    why_not = "no motion or no rates: a series of equilibria"
    parts.decide("contact damping", why, (undamped, problem.said("contact.damping", "0")), (not rates, why_not))
    smooth = (not contact.friction > 0.0, problem.said("contact.friction", "0"))
    why_not = "equilibria and static stiffness of elastic bodies are frictionless"
    at_rest = (not problem.recorded and problem.traits.every_node, why_not)
    friction = parts.decide("friction", "contact.friction is set", smooth, at_rest)
    part, none = "gyroscopic moments of the balls", problem.gyroscopic == "none"
    moments = parts.decide(part, problem.why("gyroscopic"), (none, ""), still)
    parts.decide("centrifugal growth of the inner ring", problem.why("ring_growth"), (not problem.ring_growth, ""), still)
    fixed = (not kinematics.orbiting, problem.said("kinematics.orbiting", "false"))
    parts.decide("orbiting balls", "kinematics.orbiting at cage speed", fixed)
    rows = f"bearing.arrangement is {problem.bearing.arrangement if not problem.bearing.row else problem.bearing.signs}"
    parts.decide("further rows of balls", rows, (len(problem.bearing.rows) == 1, ""))
    kind = "tangential" if friction or moments else "inertial" if inertia else "weightless"
    return Balls(kind, inertia, moments, friction)


def decide_motion(problem: Problem, parts: Decisions, tilts: bool, friction: bool) -> PlannedMotion:
    """Coordinates that move, and the turns that are integrated."""
    dynamic, integrator, identifier = problem.excitation is not None, problem.integrator, problem.identifier
    free = tilts and dynamic and problem.inertia.polar > 0.0 and problem.spin_speed != 0.0
    parts.decide("gyroscopic moments of ring and rotor", "spin on free tilts", (not free, "no spin on free tilts"))
    form = "steady orbit" if integrator.method.steady else "time integration"
    if not parts.decide(f"{form} ({integrator.kind})", problem.why("recorded"), (not problem.recorded, "")):
        return PlannedMotion(False, 0, 0)
    turns = problem.turns
    # Only what turns alike every turn needs one turn; a window over several turns needs them.
    repeats = problem.contact.law.state_size == 0 and not friction and not problem.kinematics.orbiting
    repeats = repeats and problem.excitation.period_s is not None and "phase" not in identifier.method.needs
    steady = integrator.method.steady
    once = (steady or not integrator.method.inertial) and repeats and turns > 1
    if once and _OTHER_TURNS not in parts.force:
        motion = "the steady motion" if steady else "a series of equilibria without memory"
        parts.leave_out(f"{turns - 1} of {turns} turns", f"{motion} repeats every turn")
        turns = 1
    parts.decide("run from another start", problem.why("depends_on_start"), (not problem.depends_on_start, ""))
    return PlannedMotion(True, turns, problem.steps_per_turn)


def decide_output(problem: Problem, parts: Decisions, motion: PlannedMotion) -> None:
    """What of the answer is not made."""
    every = motion.steps_per_turn
    samples = recorded_per_turn(every, motion.turns, problem.integrator.method.inertial) if motion.recorded else 0
    why_not = f"{samples} of {every} steps per turn are recorded, enough for harmonics up to some tens of 1x"
    why = f"the {every} steps of a turn are the samples of the answer"
    parts.decide("history of every step", why, (every == 0, "nothing moves"), (every > samples, why_not))
    parts.leave_out("pictures", "drawn by --pictures only")


#: How much less a step of an explicit method takes, whose steps iterate less.
_EXPLICIT = 0.5
#: An equilibrium of a series, over a step in time.
_EQUILIBRIUM = 6.0
#: Steps of a run with a third one from another start, over those of two.
_FROM_ANOTHER_START = 4.0 / 3.0
#: A step in which the speed changes: one call from Python each.
_CHANGING_S = 130.0e-6
#: A steady orbit; the search for further ones, and from which amplitude over the axial load on: a force along a fixed
#: direction on free tilts meets internal resonances.  The search takes 0.3 to 9 s: what it will meet is not known before.
_ORBIT_S, _SEARCH_S, _SEARCH_FROM = 0.02, 3.0, 0.4
#: Start-up with warm caches, to the first result.
START_S = 1.2


@attrs.frozen
class Times:
    """Measured times of one kind of compiled rings with 12 balls [s].

    step : of an implicit method, by the kind of the balls;  sample : of the record: lines, energies and extremes
    search : of a steady orbit, over that of rigid rings
    """

    step: Mapping[str, float]
    sample: float
    search: float


def runs(problem: Problem, motion: PlannedMotion) -> float:
    """Motions that are integrated for the answer and its error, over those without memory of the start."""
    return _FROM_ANOTHER_START if motion.recorded and problem.depends_on_start else 1.0


def compiled_motion(problem: Problem, balls: Balls, motion: PlannedMotion, times: Times, more: float = 0.0) -> float:
    """Processor time of the motion of a compiled ring [s]; ``more`` : of a step with 12 balls."""
    if not motion.recorded:
        return 0.0
    method, share = problem.integrator.method, problem.bearing.balls_in_all / 12.0
    each = runs(problem, motion) * share * (times.step[balls.kind] + more)
    each *= (1.0 if method.implicit else _EXPLICIT) * (1.0 if method.inertial else _EQUILIBRIUM)
    if problem.sweeps:
        each += _CHANGING_S
    samples = motion.turns * recorded_per_turn(motion.steps_per_turn, motion.turns, method.inertial)
    steps = 0 if method.steady else motion.turns * motion.steps_per_turn
    # A steady orbit is the answer, or a transient starts on it.
    orbit = 0.0
    if method.inertial:
        with_search = problem.tilts and problem.excitation.sense == 0
        with_search = with_search and problem.excitation.amplitude_n > _SEARCH_FROM * abs(problem.load.axial)
        orbit = _SEARCH_S if with_search else _ORBIT_S
    return times.search * orbit + samples * share * times.sample + steps * each


#: Iterations of the piece of work, and its processor time on the machine that ``wall_time``'s constants belong to [s].
_ITERATIONS, _REFERENCE_S = 4000, 2.0e-4
#: Repeats: the least of many short ones finds the moments in which other programs leave the core alone.
REPEATS = 20


@cache
def slowness() -> float:
    """Processor time of this machine over that of the machine on which the plan's constants were measured; takes 5 ms."""
    return timed()


def timed(repeats: int = REPEATS) -> float:
    """``slowness`` as it is now."""
    seconds = []
    for _ in range(repeats):  # the logistic map in numbers of Python: scalar work like that of the compiled loops
        start, x, total = time.process_time(), 0.5, 0.0
        for _ in range(_ITERATIONS):
            x = 3.7 * x * (1.0 - x)
            total += x
        seconds.append(time.process_time() - start)
    return min(seconds) / _REFERENCE_S
