"""Parts that a scene needs, and why: coordinates, balls, bodies, motion, output."""

from __future__ import annotations

from collections.abc import Collection
from math import ceil, pi, sqrt

import attrs

from raceway.errors import SceneError
from raceway.framework.duties import changes_speed, duration_s, ramp_turns, steady_form
from raceway.scene.growth import ring_inertia
from raceway.scene.scene import Scene


def searches_orbits(scene: Scene) -> bool:
    """Whether a transient begins on a steady orbit that can be searched for: forces are compiled and have no memory."""
    return scene.integrator.start == "orbit" and not ramp_turns(scene.excitation) and has_orbits(scene)


def has_orbits(scene: Scene) -> bool:
    """Whether steady orbits of a transient, or of it without friction, can be searched for."""
    method, excitation, contact = scene.integrator.method, scene.excitation, scene.contact
    if excitation is None or method.steady or not method.inertial:
        return False
    repeats = excitation.period_s is not None or steady_form(excitation) is not None
    return repeats and scene.body_kind.traits.compiled and contact.law.state_size == 0


def remembers_its_start(scene: Scene) -> bool:
    """Whether the answer depends on how the motion began, and a second run tells how far.

    Notes
    -----
    With friction contacts stick where the slip before has left them, also in a series of equilibria.  Of elastic bodies and of
    fits over several speeds no transient is estimated: a second run of them would tell nothing more.
    """
    if scene.excitation is None or scene.contact.friction == 0.0 or scene.body_kind.traits.every_node:
        return False
    needs = scene.identifier.method.needs
    return "record" in needs and "speeds" not in needs


def compares_with_steady_motion(scene: Scene) -> bool:
    """Whether the error of a transient is its distance from the steady motion.

    Notes
    -----
    A motion that starts on its orbit is near it already.  Bodies that are stepped from Python, friction and laws with memory
    have no steady motion that can be solved for by itself.
    """
    method, excitation = scene.integrator.method, scene.excitation
    if excitation is None or not method.inertial or method.steady:
        return False
    if not scene.body_kind.traits.compiled or scene.contact.friction > 0.0 or scene.contact.law.state_size > 0:
        return False
    if excitation.period_s is None:
        return steady_form(excitation) is not None
    return ramp_turns(excitation) > 0.0 or scene.integrator.start != "orbit" or "speeds" in scene.identifier.method.needs


#: Steps a turn where the scene says "auto", and samples a turn that are kept of short runs.
STEPS_PER_TURN = 360
#: Part of the stable limit, taken at the stiffest tangent of the orbit, that "auto" steps take. Balls that leave and meet the
#: races each turn pump motions up a little below the limit of the frozen tangent: one orbit at 0.885 of it grew in 49 turns.
SAFETY = 0.8
#: Samples of a long run's record.
_SAMPLES = 72_000
#: What a record takes at the peak over its own arrays: 3.7 times measured with 12 balls and 400 turns.  Records above the limit are refused [bytes].
_COPIES = 4
_MEMORY_LIMIT = 4 * 2**30


def turns_of(scene: Scene) -> int:
    """Turns that are integrated: the scene's, or as many as the excitation lasts."""
    duration = duration_s(scene.excitation)
    if duration is None:
        return scene.integrator.turns
    return max(int(duration * scene.excitation.frequency_hz + 0.5), 1)


def predicted_steps_per_turn(scene: Scene) -> int:
    """The scene's number; for 'auto' 360, or the multiple of it that a rough stiffness asks of an explicit method."""
    given = scene.integrator.steps_per_turn
    if isinstance(given, int):
        return given
    if scene.integrator.method.implicit:
        return STEPS_PER_TURN
    period = scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz
    stable = scene.body_kind.stable_step()
    return STEPS_PER_TURN if stable is None else stable_steps_per_turn(period, damped_limit(stable, scene.time_constant))


def damped_limit(limit: float, time_constant: float) -> float:
    """Rough stable limit of explicit steps [s] with dashpots c = tau k at the contacts, from that without them.

    Notes
    -----
    ``Ring.damped_time_step`` for one mode: with w = 2 / limit and the damping ratio z = tau w / 2 = tau / limit it is
    limit (sqrt(1 + 4 z^2) - 2 z).
    """
    doubled = 2.0 * time_constant / limit
    return limit * (sqrt(1.0 + doubled**2) - doubled)


def stable_steps_per_turn(period: float, limit: float) -> int:
    """Steps of 'auto' for an explicit method: the least multiple of 360 within ``SAFETY`` of the stable limit.

    Parameters
    ----------
    period : of a turn [s];  limit : stable step [s]
    """
    return STEPS_PER_TURN * max(1, ceil(period / (SAFETY * limit) / STEPS_PER_TURN))


def recorded_per_turn(steps_per_turn: int, turns: int, inertial: bool = True) -> int:
    """Samples a turn that are really recorded: a divisor of the steps near ``samples_per_turn``, or all steps."""
    wanted = samples_per_turn(turns, inertial)
    fitting = (s for s in range(wanted, min(2 * wanted, steps_per_turn) + 1) if steps_per_turn % s == 0)
    return next(fitting, steps_per_turn)


def samples_per_turn(turns: int, inertial: bool = True) -> int:
    """Samples a turn that are recorded: 360, fewer in runs of more than 200 turns, never below 24.

    Parameters
    ----------
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


def refuse_memory(scene: Scene, turns: int, steps_per_turn: int, count: int) -> None:
    """Records that will not fit are refused before anything is computed."""
    needed = record_bytes(turns, steps_per_turn, count, scene.integrator.method.inertial)
    if needed > _MEMORY_LIMIT:
        raise SceneError.at(
            "integrator.turns",
            scene.integrator.turns,
            f"the record of {turns} turns would take {needed / 2**30:.1f} GiB, above {_MEMORY_LIMIT / 2**30:.0f} GiB: take "
            "fewer turns, or steps_per_turn = 360 or a multiple of it",
        )


@attrs.frozen
class Part:
    """One part, and why it is kept or left out."""

    part: str
    why: str


class Decisions:
    """The parts of one scene, as they are decided.

    Parameters
    ----------
    force : parts that are kept although the scene does not need them
    """

    def __init__(self, force: Collection[str] = ()) -> None:
        self.force = force
        self.kept: list[Part] = []
        self.left_out: list[Part] = []

    def decide(self, needed: bool, part: str, why: str, why_not: str) -> bool:
        """Keep a part or leave it out; whether it is kept."""
        stays = needed or part in self.force
        (self.kept if stays else self.left_out).append(Part(part, why if needed else "forced" if stays else why_not))
        return stays

    def keeps(self, part: str) -> bool:
        """Whether a part was kept, by its name."""
        return any(one.part == part for one in self.kept)

    def keep(self, part: str, why: str) -> None:
        """A part that no scene of this kind can do without."""
        self.kept.append(Part(part, why))

    def leave_out(self, part: str, why: str) -> None:
        """A part that no scene of this kind has."""
        self.left_out.append(Part(part, why))


#: Name of what repeats itself, for ``make_plan``'s ``force``.
OTHER_TURNS = "other turns"


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
class Motion:
    """Motion that is integrated: none, where ``recorded`` is False."""

    recorded: bool
    turns: int
    steps_per_turn: int


def uses_record(scene: Scene) -> bool:
    """Whether anything is integrated."""
    return scene.excitation is not None and "record" in scene.identifier.method.needs


def _off(scene: Scene, key: str, value: str) -> str:
    """A key as the reason of what is left out, and whether nobody asked for that."""
    return f"{key} is {value}{'' if scene.says(key) else ', by default'}"


def decide_tilts(scene: Scene, parts: Decisions) -> bool:
    """Whether the ring tilts."""
    why_not = _off(scene, "supports.tilt", "locked")
    return parts.decide(scene.supports.tilt != "locked", "tilts", "supports.tilt lets the ring tilt", why_not)


def decide_balls(scene: Scene, parts: Decisions) -> Balls:
    """Forces on the balls."""
    inertia = scene.kinematics.ball_inertia and scene.spin_speed > 0.0
    why_not = "kinematics.ball_inertia is false" if scene.spin_speed > 0.0 else "nothing turns: no spin speed"
    inertia = parts.decide(
        inertia, "centrifugal force of the balls", "kinematics.ball_inertia at cage speed; two unknowns a ball", why_not
    )
    if scene.spin_speed > 0.0 and changes_speed(scene.excitation):
        rpm = scene.spin_speed * 30.0 / pi
        why = f"balls, ring and rotor follow the speed of excitation '{scene.excitation.name}'"
        why_not = f"balls, ring and rotor keep what belongs to kinematics.spin_speed_rpm = {rpm:.6g} at every speed"
        parts.decide(scene.spin_changes, "change of centrifugal and gyroscopic terms with the speed", why, why_not)
    rates = scene.excitation is not None and (scene.integrator.method.inertial or not uses_record(scene))
    damped = scene.contact.dashpot > 0.0 or scene.time_constant > 0.0
    why_not = "nothing moves, or no rates: a series of equilibria" if damped else _off(scene, "contact.damping", "0")
    why = "contact.damping is set" if scene.contact.dashpot > 0.0 else f"c = tau k, tau = {scene.time_constant:.3g} s"
    parts.decide(damped and rates, "contact damping", why, why_not)
    rubbing = scene.contact.friction > 0.0
    why_not = _off(scene, "contact.friction", "0")
    if rubbing and not uses_record(scene) and scene.body_kind.traits.every_node:
        rubbing = False
        why_not = "nothing slides at rest: equilibria of elastic bodies are without it, and so is their stiffness"
    friction = parts.decide(rubbing, "friction", "contact.friction is set", why_not)
    wanted = scene.kinematics.gyroscopic != "none"
    still, part = "nothing turns: no spin speed", "gyroscopic moments of the balls"
    why_not = still if wanted else _off(scene, "kinematics.gyroscopic", "none")
    moments = parts.decide(wanted and scene.spin_speed > 0.0, part, "kinematics.gyroscopic names a hypothesis", why_not)
    grows, part, key = scene.kinematics.ring_growth, "centrifugal growth of the inner ring", "kinematics.ring_growth"
    why_not = still if grows else _off(scene, key, "false")
    parts.decide(grows and scene.spin_speed > 0.0, part, f"{key} is true", why_not)
    why_not = _off(scene, "kinematics.orbiting", "false")
    parts.decide(scene.kinematics.orbiting, "orbiting balls", "kinematics.orbiting at cage speed", why_not)
    rows = f"bearing.arrangement is {scene.bearing.arrangement if not scene.bearing.row else scene.bearing.signs}"
    parts.decide(len(scene.bearing.rows) > 1, "further rows of balls", rows, rows)
    kind = "tangential" if friction or moments else "inertial" if inertia else "weightless"
    return Balls(kind, inertia, moments, friction)


def decide_motion(scene: Scene, parts: Decisions, tilts: bool, friction: bool) -> Motion:
    """Coordinates that move, and the turns that are integrated."""
    dynamic, integrator, identifier = scene.excitation is not None, scene.integrator, scene.identifier
    spins = scene.rotor.polar_inertia + ring_inertia(scene)[2] > 0.0 and scene.spin_speed != 0.0
    part, why = "gyroscopic moments of ring and rotor", "both spin, on free tilts"
    parts.decide(spins and tilts and dynamic, part, why, "nothing spins on free tilts")
    unused = "the scene is static" if not dynamic else f"identifier '{identifier.kind}' needs the equilibrium only"
    part, why = f"time integration ({integrator.kind})", "the identifier needs recorded motion"
    recorded = parts.decide(uses_record(scene), part, why, unused)
    if not recorded:
        return Motion(False, 0, 0)
    turns = turns_of(scene)
    # Only what turns alike every turn needs one turn; a window over several turns needs them.
    repeats = scene.contact.law.state_size == 0 and not friction and not scene.kinematics.orbiting
    repeats = repeats and scene.excitation.period_s is not None and "phase" not in identifier.method.needs
    steady = integrator.method.steady
    once = (steady or not integrator.method.inertial) and repeats and turns > 1
    if once and OTHER_TURNS not in parts.force:
        what = "the steady motion" if steady else "a series of equilibria without memory"
        parts.leave_out(f"{turns - 1} of {turns} turns", f"{what} repeats itself every turn")
        turns = 1
    why = "friction: the answer depends on how the motion began, the error is how far"
    why_not = "contact.friction is 0" if not friction else "the transient of this scene is not estimated"
    parts.decide(remembers_its_start(scene), "run from another start", why, why_not)
    return Motion(True, turns, predicted_steps_per_turn(scene))


def decide_output(scene: Scene, parts: Decisions, motion: Motion) -> None:
    """What of the answer is not made."""
    every = motion.steps_per_turn
    samples = recorded_per_turn(every, motion.turns, scene.integrator.method.inertial) if motion.recorded else 0
    why_not = f"{samples} of {every} steps a turn are recorded: lines up to some tens of 1x need no more"
    part, why = "history of every step", f"the {every} steps of a turn are the samples of the answer"
    parts.decide(0 < every <= samples, part, why, why_not if every else "nothing moves")
    parts.leave_out("pictures", "drawn by --pictures only")
