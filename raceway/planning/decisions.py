"""Parts that a scene needs, and why: coordinates, balls, bodies, motion, output."""

from __future__ import annotations

from math import pi

import attrs

from raceway.framework.duties import traits_of
from raceway.planning.parts import Decisions
from raceway.planning.recording import predicted_steps_per_turn, recorded_per_turn, turns_of
from raceway.planning.steady_orbits import remembers_its_start
from raceway.scene.inner_ring import ring_inertia
from raceway.scene.scene import Scene

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
    if scene.spin_speed > 0.0 and getattr(scene.excitation, "first_speed_rpm", None) is not None:
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
    if rubbing and not uses_record(scene) and traits_of(scene).every_node:
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
