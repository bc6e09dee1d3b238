"""Parts that a scene needs, each kept or left out with its reason: coordinates, balls, bodies, motion, output."""

from collections.abc import Collection

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

    Parameters
    ----------
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

    Attributes
    ----------
    kind : "weightless" (races in series), "inertial" (two unknowns each) or "tangential" (friction, gyroscopic moments)
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
