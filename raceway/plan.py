"""What a scene needs, what is left out and why, and what it will cost.  Nothing is built, meshed or compiled here.

The model builder obeys the plan; it decides nothing of this by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from math import pi
from typing import Any

import attrs

from raceway.elastic_plan import elastic_cost, elastic_faults, memory_faults, steps_per_turn, words
from raceway.errors import Mistake, SceneError
from raceway.estimate import highest_frequency
from raceway.mesh_plan import mesh_faults, predicted_mesh
from raceway.module_plan import Module, as_dicts, optional_modules
from raceway.patch_plan import patch_cost, patch_faults
from raceway.ring import ring_inertia
from raceway.scene import Scene
from raceway.section_plan import seat_faults, section_cost, section_faults

#: Seconds, measured on one core of a small server: a whole step for 12 balls, start-up with warm caches, compiling.
_STEP_S = {"weightless": 1.3e-6, "inertial": 3.0e-6, "tangential": 12.0e-6}
#: The same for condensed bodies, and what the matrices between balls add.
_CONDENSED_STEP_S = {"weightless": 10.5e-6, "inertial": 13.5e-6, "tangential": 22.0e-6}
_BETWEEN_S = 23.0e-6
_START_S = 0.6
#: Kinds of bodies that this version can compute.
BODIES = ("rigid", "condensed", "elastic")
#: Name of what repeats itself, for ``make_plan``'s ``force``.
OTHER_TURNS = "other turns"
#: Steps a turn where the scene says "auto", and samples a turn that are kept of short runs.
STEPS_PER_TURN = 360
#: Records above this are refused [bytes].
_MEMORY_LIMIT = 4 * 2**30


@attrs.frozen
class Part:
    """One part of the model or of the program, kept or left out, and why."""

    part: str
    why: str


@attrs.frozen
class Plan:
    """Decisions and predictions for one scene.

    Attributes
    ----------
    balls : "weightless" (races in series), "inertial" (two unknowns each) or "tangential" (friction, gyroscopic moments)
    centrifugal, gyroscopic : whether the balls have these loads
    coupled : whether condensed rings let balls act on each other
    free : (5,) of x, y, z, tilt_y, tilt_z: 1 for unknowns
    turns : turns that are integrated
    dofs : unknowns of the ring and of the balls
    time_step_s, predicted_wall_s : None in a static scene; predictions
    mesh : predicted ``bodies[{name, cells, bytes}]``, ``cells``, ``bytes``; None where nothing is meshed or can be told
    modules : optional modules, and whether a run imports them
    """

    kept: tuple[Part, ...]
    left_out: tuple[Part, ...]
    balls: str
    centrifugal: bool
    gyroscopic: bool
    coupled: bool
    free: tuple[int, ...]
    turns: int
    dofs: int
    time_step_s: float | None
    predicted_steps: int
    predicted_wall_s: float
    mesh: dict[str, Any] | None = None
    modules: tuple[Module, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        return {
            "kept": [attrs.asdict(p) for p in self.kept],
            "left_out": [attrs.asdict(p) for p in self.left_out],
            "dofs": self.dofs,
            "time_step_s": self.time_step_s,
            "predicted_steps": self.predicted_steps,
            "predicted_wall_s": self.predicted_wall_s,
            "mesh": self.mesh,
            "modules": as_dicts(self.modules),
        }


def make_plan(scene: Scene, force: Collection[str] = ()) -> Plan:
    """Decide what a scene needs.

    Parameters
    ----------
    force : parts that are kept although the scene does not need them: to measure what leaving them out saves

    Raises
    ------
    SceneError
        For combinations that cannot run, each with the reason and the remedy.
    """
    refuse_what_cannot_run(scene)
    kept: list[Part] = []
    left_out: list[Part] = []

    def decide(needed: bool, part: str, why: str, why_not: str) -> bool:
        stays = needed or part in force
        (kept if stays else left_out).append(Part(part, why if needed else "forced" if stays else why_not))
        return stays

    dynamic = scene.excitation is not None
    tilts = decide(scene.supports.tilt != "locked", "tilts", "supports.tilt lets the ring tilt", "supports.tilt is locked")
    free = (0 if scene.supports.axial == "displacement" else 1, 1, 1, int(tilts), int(tilts))
    inertia = scene.kinematics.ball_inertia and scene.spin_speed > 0.0
    why_not = "kinematics.ball_inertia is false" if scene.spin_speed > 0.0 else "nothing turns: no spin speed"
    inertia = decide(
        inertia, "centrifugal force of the balls", "kinematics.ball_inertia at cage speed; two unknowns a ball", why_not
    )
    if inertia and getattr(scene.excitation, "first_speed_rpm", None) is not None:
        rpm = scene.spin_speed * 30.0 / pi
        why_not = f"balls, ring and rotor keep what belongs to {rpm:.6g} r/min (kinematics.spin_speed_rpm) at every speed"
        left_out.append(Part("change of centrifugal forces with the speed", why_not))
    rates = dynamic and (scene.integrator.method.inertial or "record" not in scene.identifier.method.needs)
    why_not = (
        "contact.damping is 0" if scene.contact.damping == 0.0 else "nothing moves, or no rates: a series of equilibria"
    )
    decide(scene.contact.damping > 0.0 and rates, "contact damping", "contact.damping is set", why_not)
    friction = decide(scene.contact.friction > 0.0, "friction", "contact.friction is set", "contact.friction is 0")
    wanted = scene.kinematics.gyroscopic != "none"
    why_not = "nothing turns: no spin speed" if wanted else "kinematics.gyroscopic is none"
    moments = decide(
        wanted and scene.spin_speed > 0.0,
        "gyroscopic moments of the balls",
        "kinematics.gyroscopic names a hypothesis",
        why_not,
    )
    orbiting = scene.kinematics.orbiting
    decide(orbiting, "orbiting balls", "kinematics.orbiting at cage speed", "kinematics.orbiting is false")
    pair = f"bearing.arrangement is {scene.bearing.arrangement}"
    decide(len(scene.bearing.rows) > 1, "second row of balls", pair, pair)
    condensed, elastic = scene.bodies.kind == "condensed", scene.bodies.kind == "elastic"
    why = f"bodies.kind is {scene.bodies.kind}: finite elements of rings and balls"
    why += ", reduced to structural compliances" if condensed else ""
    cost = elastic_cost(scene) if elastic else None
    why += f", every node: {words(cost)}" if cost is not None else ""
    decide(scene.bodies.kind != "rigid", "elastic rings and balls", why, "bodies.kind is rigid: only contacts deform")
    nodal = condensed and scene.contact.discretisation == "nodal"
    coupled = condensed and _balls_meet(scene) and not nodal
    if nodal:
        patches = patch_cost(scene)
        why = (
            f"contact.discretisation is nodal: some {patches.points} points carry a contact, {patches.bytes / 2**20:.0f} MiB"
        )
        kept.append(Part("pressures at surface points", why))
        recorded = dynamic and "record" in scene.identifier.method.needs
        moves = recorded and scene.integrator.method.inertial and scene.kinematics.ball_inertia
        decide(
            moves, "inertia of the balls in their meridian planes", "two coordinates a ball, in steps of time",
            "their slowest mode lies at some kHz: they follow at once",
        )  # fmt: skip
    elif condensed:
        why_not = "rings on rigid seats, thin against the distance of the balls: less than 1e-3 of a contact's compliance"
        coupled = decide(coupled, "effect of balls on each other through the rings", "soft seats or thick rings", why_not)
        if dynamic:
            why = "rings and balls follow at once; what that costs is told by `model.inertia` of the result"
            left_out.append(Part("inertia of the bodies' deformation", why))
    if elastic:
        kept.append(Part("pressures at surface points", "elastic bodies touch at the points of the balls' surfaces"))
        kept.append(Part("ideal cage", "holds each ball at its azimuth and keeps it from turning"))
        why_not = "balls do not orbit: the cage holds them, their centrifugal force is kept where the plan says so"
        left_out.append(Part("travel of the balls", why_not))
    rotor_moments = scene.rotor.polar_inertia > 0.0 and tilts and dynamic
    decide(
        rotor_moments,
        "gyroscopic moments of the rotor",
        "rotor.polar_inertia on free tilts",
        "no polar inertia on free tilts",
    )
    uses_record = dynamic and "record" in scene.identifier.method.needs
    unused = "the scene is static" if not dynamic else f"identifier '{scene.identifier.kind}' needs the equilibrium only"
    decide(uses_record, f"time integration ({scene.integrator.kind})", "the identifier needs recorded motion", unused)
    turns = _turns(scene) if uses_record else 0
    repeats = scene.contact.law.state_size == 0 and not friction and not orbiting
    # Only what turns alike every turn needs one turn; a window over several turns needs them.
    repeats = (
        repeats and uses_record and scene.excitation.period_s is not None and "phase" not in scene.identifier.method.needs
    )
    steady = getattr(scene.integrator.method, "steady", False)
    once = uses_record and (steady or not scene.integrator.method.inertial) and repeats and turns > 1
    if once and OTHER_TURNS not in force:
        what = "the steady motion" if steady else "a series of equilibria without memory"
        left_out.append(Part(f"{turns - 1} of {turns} turns", f"{what} repeats itself every turn"))
        turns = 1
    steps_per_turn = _predicted_steps_per_turn(scene) if uses_record else 0
    steps = steps_per_turn * turns
    _note_output(scene, left_out, turns, steps_per_turn, condensed and not nodal)
    balls = "tangential" if friction or moments else "inertial" if inertia else "weightless"
    count = scene.bearing.ball_count * len(scene.bearing.rows)
    if uses_record:
        _refuse_memory(scene, turns, steps_per_turn, count)
    each = _STEP_S[balls]
    if condensed:
        each = _CONDENSED_STEP_S[balls] + (_BETWEEN_S * (scene.bearing.ball_count / 12.0) ** 2 if coupled else 0.0)
    if nodal:
        each = 12.0 / count * patches.step_s
    each *= count / 12.0 * (0.5 if not scene.integrator.method.implicit else 1.0)
    before = _bodies_seconds(scene)
    if cost is not None:
        # Two thirds: the factor 1.5 below is for what compiled loops share out differently.
        each, before = cost.step_s / 1.5, cost.equilibrium_s + (cost.start_s if uses_record else 0.0)
    ring = sum(free) + count * (1 if balls == "weightless" else 2)
    period = (scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz) if dynamic else 0.0
    return Plan(
        kept=tuple(kept),
        left_out=tuple(left_out),
        balls=balls,
        centrifugal=inertia,
        gyroscopic=moments,
        coupled=coupled,
        free=free,
        turns=turns,
        dofs=ring if cost is None else cost.unknowns,
        time_step_s=period / steps_per_turn if uses_record else None,
        predicted_steps=steps,
        predicted_wall_s=_START_S + before + 1.5 * steps * each,
        mesh=predicted_mesh(scene),
        modules=optional_modules(scene, balls, inertia, uses_record),
    )


def _note_output(scene: Scene, left_out: list[Part], turns: int, steps_per_turn: int, condensed: bool) -> None:
    """What of the answer is not made, and which bodies stand for their likes."""
    samples = recorded_per_turn(steps_per_turn, turns) if steps_per_turn else 0
    if samples < steps_per_turn:
        why = f"{samples} of {steps_per_turn} steps a turn are recorded: lines up to some tens of 1x need no more"
        left_out.append(Part("history of every step", why))
    if condensed:
        left_out.append(Part("a compliance for each ball and contact", "balls are equal and rings are bodies of revolution"))
        why = "rings and balls are symmetric about each plane through their axis: a harmonic is one real system"
        left_out.append(Part("mirror half", why))
    if scene.bodies.kind != "rigid":
        left_out.append(Part("stress recovery", "no stress inside the bodies is asked for"))
    left_out.append(Part("pictures", "drawn by --pictures only"))


def _bodies_seconds(scene: Scene) -> float:
    """Time [s] that deforming bodies take before the first step, nothing kept from before."""
    if scene.bodies.kind != "condensed":
        return 0.0
    if scene.contact.discretisation != "nodal":
        return section_cost(scene).seconds
    patches = patch_cost(scene)
    orbit = 150.0 * patches.step_s if scene.excitation is not None else 0.0
    return patches.setup_s + 3.0 * patches.equilibrium_s + orbit


def refuse_what_cannot_run(scene: Scene) -> None:
    """Raise ``SceneError`` with everything that this version, or this combination, cannot do."""
    faults: list[Mistake] = []

    def refuse(bad: bool, path: str, value: Any, why: str) -> None:
        if bad:
            faults.append(Mistake(path, value, why))

    kinematics, contact, method = scene.kinematics, scene.contact, scene.integrator.method
    listed = " or ".join(f"'{kind}'" for kind in BODIES)
    refuse(scene.bodies.kind not in BODIES, "bodies.kind", scene.bodies.kind, f"is not available yet: use {listed}")
    if scene.bodies.kind == "elastic":
        faults += elastic_faults(scene)
    faults += mesh_faults(scene) or (memory_faults(scene) if scene.bodies.kind == "elastic" and not faults else [])
    rigid, condensed = scene.bodies.kind == "rigid", scene.bodies.kind == "condensed"
    if condensed:
        _refuse_condensed(scene, refuse)
        faults += seat_faults(scene)
    law = contact.law
    if contact.discretisation not in law.discretisations:
        choice = " or ".join(f"'{d}'" for d in sorted(law.discretisations))
        faults.append(Mistake("contact.discretisation", contact.discretisation, f"law '{contact.kind}' supports {choice}"))
    elif contact.discretisation == "nodal" and condensed:
        faults += patch_faults(scene) or section_faults(scene)
    elif condensed:
        faults += section_faults(scene)
    elif contact.discretisation == "nodal" and rigid:
        why = "rigid bodies have no surface points: use 'resultant'"
        faults.append(Mistake("contact.discretisation", "nodal", why))
    need_bore = "needs the bearing's `bore`"
    refuse(kinematics.ring_growth and scene.bearing.bore is None, "kinematics.ring_growth", True, need_bore)
    alone = kinematics.gyroscopic != "none" and not kinematics.ball_inertia
    why = "comes with the balls' centrifugal force, which alone presses an idle ball to its race: set ball_inertia = true"
    refuse(alone, "kinematics.gyroscopic", kinematics.gyroscopic, why)
    refuse(kinematics.orbiting and scene.spin_speed == 0.0, "kinematics.orbiting", True, "needs a spin speed: nothing turns")
    for seat in ("outer_seat", "inner_seat"):
        value = getattr(scene.supports, seat)
        stiff = rigid and value != "rigid"
        refuse(stiff, f"supports.{seat}", value, "rigid rings have rigid seats: leave it out, or bodies.kind = 'condensed'")
    if scene.excitation is not None and scene.excitation.amplitude_n == 0.0:
        faults.append(Mistake("excitation", None, "its force is zero: leave the table out for a static scene"))
    if scene.excitation is not None:
        _refuse_identifier(scene, refuse)
        if getattr(method, "steady", False) and "record" in scene.identifier.method.needs:
            _refuse_steady(scene, refuse)
    if scene.excitation is not None and "record" in scene.identifier.method.needs and method.inertial:
        mass, tilt = ring_inertia(scene)
        if scene.rotor.mass + mass <= 0.0:
            why = "nothing has mass: set it, or give bearing.bore and bearing.width so that the inner ring has its own"
            faults.append(Mistake("rotor.mass", scene.rotor.mass, why))
        if scene.supports.tilt != "locked" and scene.rotor.transverse_inertia + tilt <= 0.0:
            why = "free tilts need an inertia: set it, or give bearing.bore and bearing.width"
            faults.append(Mistake("rotor.transverse_inertia", scene.rotor.transverse_inertia, why))
    if faults:
        raise SceneError(faults)


def _refuse_condensed(scene: Scene, refuse: Callable[[bool, str, Any, str], None]) -> None:
    """What condensed rings need: dimensions of bodies of revolution, and the elements of the structured mesher."""
    if scene.mesh is not None:
        why = "condensed bodies are bodies of revolution, swept from their sections: use mesh.kind = 'structured'"
        refuse(scene.mesh.name != "structured", "mesh.kind", scene.mesh.name, why)
    for key in ("bore", "outer_diameter", "width"):
        value = getattr(scene.bearing, key)
        refuse(value is None, f"bearing.{key}", value, "is needed by elastic rings: give it, or take bodies.kind = 'rigid'")


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


def _refuse_identifier(scene: Scene, refuse: Callable[[bool, str, Any, str], None]) -> None:
    """What the identifier needs of the excitation."""
    needs, kind = scene.identifier.method.needs, scene.identifier.kind
    name, excitation = scene.excitation.name, scene.excitation
    changing = excitation.period_s is None and getattr(excitation, "first_speed_rpm", None) is not None
    why = f"needs one frequency, but excitation '{name}' changes its speed: use 'order_tracking'"
    refuse("period" in needs and changing, "identifier.kind", kind, why)
    why = f"needs the phase of the excitation, which '{name}' does not tell: use 'sine_fit'"
    refuse("phase" in needs and not hasattr(excitation, "phase"), "identifier.kind", kind, why)
    why = f"runs several speeds, but excitation '{name}' has no key `speed_rpm` or changes its speed"
    several = "speeds" in needs
    unable = changing or not hasattr(excitation, "speed_rpm")
    refuse(several and unable, "identifier.kind", kind, why)
    if several and not unable:
        for rpm in scene.identifier.method.speeds_rpm:
            why = f"runs several speeds, but excitation '{name}' does not repeat every turn at {rpm:g} r/min"
            bad = attrs.evolve(excitation, speed_rpm=float(rpm)).period_s is None
            refuse(bad, "identifier.kind", kind, why)
            if bad:
                break


def _refuse_steady(scene: Scene, refuse: Callable[[bool, str, Any, str], None]) -> None:
    """What has no motion that repeats itself every turn and depends on the force alone."""
    kind, excitation = scene.integrator.kind, scene.excitation
    other = "use 'newmark'"
    why = f"needs a force that repeats every turn, which excitation '{excitation.name}' does not: {other}"
    refuse(excitation.period_s is None, "integrator.kind", kind, why)
    why = f"contact.friction: where a contact sticks depends on how the motion began, there is no single one: {other}"
    refuse(scene.contact.friction > 0.0, "integrator.kind", kind, why)
    why = f"contact law '{scene.contact.kind}' has a memory: its motion cannot be solved for by itself: {other}"
    refuse(scene.contact.law.state_size > 0, "integrator.kind", kind, why)
    large = scene.bodies.kind == "elastic" or scene.contact.discretisation == "nodal"
    what = "bodies.kind is elastic" if scene.bodies.kind == "elastic" else "contact.discretisation is nodal"
    why = f"{what}: it linearises thousands of states and needs forces that are compiled, those of resultants: {other}"
    refuse(large, "integrator.kind", kind, why)
    alone = (
        excitation.sense != 0
        and not any(scene.load.radial)
        and not (any(scene.load.moment) and scene.supports.tilt != "locked")
    )
    why = (
        "kinematics.orbiting: balls pass at another frequency than the force, no motion repeats itself every turn unless the "
        f"force turns and no radial load acts: {other}"
    )
    refuse(scene.kinematics.orbiting and not alone, "integrator.kind", kind, why)


def _turns(scene: Scene) -> int:
    """Turns that are integrated: the scene's, or as many as the excitation lasts."""
    duration = getattr(scene.excitation, "duration_s", None)
    if duration is None:
        return scene.integrator.turns
    return max(int(duration * scene.excitation.frequency_hz + 0.5), 1)


def recorded_per_turn(steps_per_turn: int, turns: int) -> int:
    """Samples a turn that are really recorded: a divisor of the steps near ``samples_per_turn``, or all steps."""
    wanted = samples_per_turn(turns)
    fitting = (s for s in range(wanted, min(2 * wanted, steps_per_turn) + 1) if steps_per_turn % s == 0)
    return next(fitting, steps_per_turn)


def samples_per_turn(turns: int) -> int:
    """Samples a turn that are recorded: 360, fewer in runs of more than 200 turns, never below 24."""
    return max(24, min(STEPS_PER_TURN, 72_000 // max(turns, 1)))


def _refuse_memory(scene: Scene, turns: int, steps_per_turn: int, count: int) -> None:
    """Records that will not fit are refused before anything is computed."""
    samples = min(steps_per_turn, samples_per_turn(turns))
    if steps_per_turn % samples:
        samples = steps_per_turn
    needed = 8 * turns * samples * (16 + 8 * count)
    if needed > _MEMORY_LIMIT:
        raise SceneError.at(
            "integrator.turns",
            scene.integrator.turns,
            f"the record of {turns} turns would take {needed / 2**30:.1f} GiB, above {_MEMORY_LIMIT / 2**30:.0f} GiB: take "
            "fewer turns, or steps_per_turn = 360 or a multiple of it",
        )


def _predicted_steps_per_turn(scene: Scene) -> int:
    """The scene's number; for 'auto' 360, or what a rough stiffness asks of an explicit method."""
    given = scene.integrator.steps_per_turn
    if isinstance(given, int):
        return given
    if scene.integrator.method.implicit:
        return STEPS_PER_TURN
    period = scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz
    if scene.bodies.kind == "elastic":
        return max(STEPS_PER_TURN, steps_per_turn(scene, period, 0.8) or 0)
    return max(STEPS_PER_TURN, int(period / (0.8 * 2.0 / highest_frequency(scene))) + 1)
