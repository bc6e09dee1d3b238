"""Parts that a scene needs, each kept or left out with its reason: coordinates, balls, bodies, motion, output."""

from __future__ import annotations

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

    def decide(self, need: bool, part: str, why: str, why_not: str = "") -> bool:
        """Keep a part or leave it out, with ``why`` for both unless ``why_not`` differs; whether it is included."""
        stays = need or part in self.force
        (self.kept if stays else self.left_out).append(Part(part, why if need else "forced" if stays else why_not or why))
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
    return parts.decide(problem.tilts, "tilts", problem.why("tilts"))


def decide_balls(problem: Problem, parts: Decisions) -> Balls:
    """Forces on the balls."""
    inertia = problem.kinematics.ball_inertia and problem.spin_speed > 0.0
    why_not = "kinematics.ball_inertia is false" if problem.spin_speed > 0.0 else "no spin speed"
    inertia = parts.decide(
        inertia, "centrifugal force of the balls", "kinematics.ball_inertia at cage speed; two unknowns a ball", why_not
    )
    if problem.spin_speed > 0.0 and problem.sweeps:
        part = "change of centrifugal and gyroscopic terms with the speed"
        parts.decide(problem.spin_changes, part, problem.why("spin_changes"))
    rates = problem.excitation is not None and (problem.integrator.method.inertial or not problem.recorded)
    with_damping = problem.contact.dashpot > 0.0 or problem.time_constant > 0.0
    why_not = "no motion or no rates: a series of equilibria" if with_damping else problem.said("contact.damping", "0")
    why = "contact.damping is set" if problem.contact.dashpot > 0.0 else f"c = tau k, tau = {problem.time_constant:.3g} s"
    parts.decide(with_damping and rates, "contact damping", why, why_not)
    rubbing = problem.contact.friction > 0.0
    why_not = problem.said("contact.friction", "0")
    if rubbing and not problem.recorded and problem.traits.every_node:
        rubbing = False
        why_not = "equilibria and static stiffness of elastic bodies are frictionless"
    friction = parts.decide(rubbing, "friction", "contact.friction is set", why_not)
    turns, still = problem.spin_speed > 0.0, "no spin speed"
    moments = problem.gyroscopic != "none"
    part, why = "gyroscopic moments of the balls", problem.why("gyroscopic")
    moments = parts.decide(moments and turns, part, why, still if moments else why)
    part, why = "centrifugal growth of the inner ring", problem.why("ring_growth")
    parts.decide(bool(problem.ring_growth) and turns, part, why, still if problem.ring_growth else why)
    why_not = problem.said("kinematics.orbiting", "false")
    parts.decide(problem.kinematics.orbiting, "orbiting balls", "kinematics.orbiting at cage speed", why_not)
    rows = f"bearing.arrangement is {problem.bearing.arrangement if not problem.bearing.row else problem.bearing.signs}"
    parts.decide(len(problem.bearing.rows) > 1, "further rows of balls", rows)
    kind = "tangential" if friction or moments else "inertial" if inertia else "weightless"
    return Balls(kind, inertia, moments, friction)


def decide_motion(problem: Problem, parts: Decisions, tilts: bool, friction: bool) -> PlannedMotion:
    """Coordinates that move, and the turns that are integrated."""
    dynamic, integrator, identifier = problem.excitation is not None, problem.integrator, problem.identifier
    spins = problem.inertia.polar > 0.0 and problem.spin_speed != 0.0
    part, why = "gyroscopic moments of ring and rotor", "spin on free tilts"
    parts.decide(spins and tilts and dynamic, part, why, "no spin on free tilts")
    form = "steady orbit" if integrator.method.steady else "time integration"
    if not parts.decide(problem.recorded, f"{form} ({integrator.kind})", problem.why("recorded")):
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
    parts.decide(problem.depends_on_start, "run from another start", problem.why("depends_on_start"))
    return PlannedMotion(True, turns, problem.steps_per_turn)


def decide_output(problem: Problem, parts: Decisions, motion: PlannedMotion) -> None:
    """What of the answer is not made."""
    every = motion.steps_per_turn
    samples = recorded_per_turn(every, motion.turns, problem.integrator.method.inertial) if motion.recorded else 0
    why_not = f"{samples} of {every} steps per turn are recorded, enough for harmonics up to some tens of 1x"
    part, why = "history of every step", f"the {every} steps of a turn are the samples of the answer"
    parts.decide(0 < every <= samples, part, why, why_not if every else "nothing moves")
    parts.leave_out("pictures", "drawn by --pictures only")
