"""Parts that a scene needs, and why: coordinates, balls, bodies, motion, output."""

from __future__ import annotations

from math import pi

import attrs

from raceway.planning.elastic import ElasticCost, words
from raceway.planning.parts import Decisions
from raceway.planning.patches import PatchCost
from raceway.planning.recording import predicted_steps_per_turn, recorded_per_turn, turns_of
from raceway.planning.steady_orbits import remembers_its_start
from raceway.scene.inner_ring import ring_inertia
from raceway.scene.tables import Scene

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


def decide_tilts(scene: Scene, parts: Decisions) -> bool:
    """Whether the ring tilts."""
    return parts.decide(
        scene.supports.tilt != "locked", "tilts", "supports.tilt lets the ring tilt", "supports.tilt is locked"
    )


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
    why_not = (
        "contact.damping is 0" if scene.contact.damping == 0.0 else "nothing moves, or no rates: a series of equilibria"
    )
    parts.decide(scene.contact.damping > 0.0 and rates, "contact damping", "contact.damping is set", why_not)
    friction = parts.decide(scene.contact.friction > 0.0, "friction", "contact.friction is set", "contact.friction is 0")
    wanted = scene.kinematics.gyroscopic != "none"
    why_not = "nothing turns: no spin speed" if wanted else "kinematics.gyroscopic is none"
    moments = parts.decide(
        wanted and scene.spin_speed > 0.0,
        "gyroscopic moments of the balls",
        "kinematics.gyroscopic names a hypothesis",
        why_not,
    )
    orbiting = scene.kinematics.orbiting
    parts.decide(orbiting, "orbiting balls", "kinematics.orbiting at cage speed", "kinematics.orbiting is false")
    pair = f"bearing.arrangement is {scene.bearing.arrangement}"
    parts.decide(len(scene.bearing.rows) > 1, "second row of balls", pair, pair)
    kind = "tangential" if friction or moments else "inertial" if inertia else "weightless"
    return Balls(kind, inertia, moments, friction)


def decide_bodies(scene: Scene, parts: Decisions, elastic: ElasticCost | None, patches: PatchCost | None) -> bool:
    """What deforms; whether condensed rings let balls act on each other.

    Parameters
    ----------
    elastic : predicted cost of elastic bodies;  patches : of pressures at points of condensed ones; None of other bodies
    """
    kind = scene.bodies.kind
    why = f"bodies.kind is {kind}: finite elements of rings and balls"
    why += ", reduced to structural compliances" if kind == "condensed" else ""
    why += f", every node: {words(elastic)}" if elastic is not None else ""
    parts.decide(kind != "rigid", "elastic rings and balls", why, "bodies.kind is rigid: only contacts deform")
    if patches is not None:
        why = (
            f"contact.discretisation is nodal: some {patches.points} points carry a contact, {patches.bytes / 2**20:.0f} MiB"
        )
        parts.keep("pressures at surface points", why)
        moves = uses_record(scene) and scene.integrator.method.inertial and scene.kinematics.ball_inertia
        part, why = "inertia of the balls in their meridian planes", "two coordinates a ball, in steps of time"
        parts.decide(moves, part, why, "their slowest mode lies at some kHz: they follow at once")
    elif kind == "condensed":
        why_not = "rings on rigid seats, thin against the distance of the balls: less than 1e-3 of a contact's compliance"
        part = "effect of balls on each other through the rings"
        coupled = parts.decide(_balls_meet(scene), part, "soft seats or thick rings", why_not)
        if scene.excitation is not None:
            why = "rings and balls follow at once; what that costs is told by `model.inertia` of the result"
            parts.leave_out("inertia of the bodies' deformation", why)
        return coupled
    elif kind == "elastic":
        nodal, whole = scene.contact.discretisation == "nodal", "contact.discretisation is resultant"
        why_not = f"{whole}: one force a contact, whose law replaces what the mesh below it gives way"
        parts.decide(
            nodal, "pressures at surface points", "elastic bodies touch at the points of the balls' surfaces", why_not
        )
        parts.keep("ideal cage", "holds each ball at its azimuth and keeps it from turning")
        why_not = "balls do not orbit: the cage holds them, their centrifugal force is kept where the plan says so"
        parts.leave_out("travel of the balls", why_not)
    return False


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
    steady = getattr(integrator.method, "steady", False)
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
    """Which bodies stand for their likes, and what of the answer is not made."""
    decide_likes(scene, parts)
    every = motion.steps_per_turn
    samples = recorded_per_turn(every, motion.turns, scene.integrator.method.inertial) if motion.recorded else 0
    why_not = f"{samples} of {every} steps a turn are recorded: lines up to some tens of 1x need no more"
    part, why = "history of every step", f"the {every} steps of a turn are the samples of the answer"
    parts.decide(0 < every <= samples, part, why, why_not if every else "nothing moves")
    parts.leave_out("pictures", "drawn by --pictures only")


def decide_likes(scene: Scene, parts: Decisions) -> None:
    """What deforming bodies are computed for: equal ones once or each, a half or the whole, stresses inside or none."""
    kind = scene.bodies.kind
    flat = "bodies.kind is rigid: no body is meshed"
    why_not = flat if kind == "rigid" else "balls are equal and rings are bodies of revolution"
    why = "every node of every ball and ring is an unknown"
    parts.decide(kind == "elastic", "a compliance for each ball and contact", why, why_not)
    why_not = "rings and balls are symmetric about each plane through their axis: a harmonic is one real system"
    why = "every node of both halves: the forces may have any direction; a half model is no part of this program"
    parts.decide(kind == "elastic", "other mirror half", why, flat if kind == "rigid" else why_not)
    parts.leave_out("stress recovery", flat if kind == "rigid" else "no stress inside the bodies is asked for")


def _balls_meet(scene: Scene) -> bool:
    """Whether one ball's load reaches the next one through a ring.

    Notes
    -----
    On a rigid seat at depth t below the groove the field of a load falls off within t: 2e-4 of a contact's compliance is left
    at 3.7 t (B7206C).
    """
    b = scene.bearing
    if scene.supports.inner_seat != "rigid" or scene.supports.outer_seat != "rigid":
        return True
    walls = [0.5 * (b.pitch_diameter - b.ball_diameter - (b.bore or 0.0))]
    walls.append(0.5 * ((b.outer_diameter or 0.0) - b.pitch_diameter - b.ball_diameter))
    return bool(pi * (b.pitch_diameter - b.ball_diameter) / b.ball_count < 2.5 * max(walls))
