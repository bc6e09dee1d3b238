"""The kind of bodies whose finite elements are reduced to what their contacts feel: resultants, or pressures at surface points."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.bodies.condensed.plan import BETWEEN_BALLS, seat_faults, section_cost, section_faults
from raceway.bodies.mesh_plan import unrefined
from raceway.bodies.patches.plan import MOTION, patch_cost, patch_faults
from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits
from raceway.planning.closed_form import highest_frequency
from raceway.planning.decisions import Balls, Motion, uses_record
from raceway.planning.parts import Decisions
from raceway.planning.wall_time import START_S, Times, compiled_motion, runs
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.model import Bearing
    from raceway.planning.plan import Plan

_TIMES = Times({"weightless": 10.0e-6, "inertial": 11.0e-6, "tangential": 22.0e-6}, sample=14.0e-6, search=2.5)
#: What the matrices between balls add to a step [s].
_BETWEEN_S = 40.0e-6
#: Steps of a run and its second one with half as many.
_WITH_HALF = 1.5


@attrs.frozen
class Condensed:
    """Elastic rings and balls, reduced to the compliances that their contacts feel."""

    name: ClassVar[str] = "condensed"

    @classmethod
    def example_scene(cls) -> Tables:
        """A B7206C on sections so coarse that they take a moment."""
        return {
            "bearing": {"preset": "B7206C"},
            "mesh": {"kind": "structured", "element_size": 2.5e-3, "nodes_per_semi_axis": 1},
            "load": {"axial": 1000.0, "radial": [200.0, 0.0]},
            "kinematics": {"ball_inertia": False},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4},
            "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
        }

    def faults(self, scene: Scene) -> list[Mistake]:
        """What condensed rings need: dimensions of bodies of revolution, the elements of the structured mesher, seats that hold."""
        faults = []
        if scene.mesh is not None and scene.mesh.name != "structured":
            why = "condensed bodies are bodies of revolution, swept from their sections: use mesh.kind = 'structured'"
            faults.append(Mistake("mesh.kind", scene.mesh.name, why))
        for key in ("bore", "outer_diameter", "width"):
            if attrs.asdict(scene.bearing, recurse=False)[key] is None:
                why = "is needed by elastic rings: give it, or take bodies.kind = 'rigid'"
                faults.append(Mistake(f"bearing.{key}", None, why))
        if not scene.bearing.equal_rows:
            why = "condensed bodies have one section for the rings of all rows: leave out what differs, or take bodies.kind = 'rigid'"
            faults.append(Mistake("bearing.row", None, why))
        grown = {f"mounting.{key}": value for key, value in scene.mounting.changes.items()}
        if scene.kinematics.ball_growth:
            grown["kinematics.ball_growth"] = 1.0
        for key, value in grown.items() if _nodal(scene) else ():
            why = "changes the shapes that surface points lie on: take contact.discretisation = 'resultant', or kinematics.radial_expansion"
            faults.append(Mistake(key, value, why))
        unmeshed = unrefined(scene, "sections of condensed bodies")
        faults += unmeshed
        faults += seat_faults(scene)
        if unmeshed or scene.contact.discretisation not in scene.contact.law.discretisations:
            return faults
        return faults + ((patch_faults(scene) if _nodal(scene) else []) or section_faults(scene))

    def traits(self, scene: Scene) -> Traits:
        """Compiled, but for surface points; Hertz's law is calibrated on those."""
        if _nodal(scene):
            return Traits(compiled=False, resultants=False)
        return Traits(calibrated=scene.contact.kind == "hertz", renews=True, damps=True)

    def stable_step(self, scene: Scene) -> float:
        """Of the ring on its contacts [s]."""
        return 2.0 / highest_frequency(scene)

    def decide(self, scene: Scene, parts: Decisions) -> None:
        """What of the bodies' compliance is needed."""
        why = "bodies.kind is condensed: finite elements of rings and balls, reduced to structural compliances"
        parts.keep("elastic rings and balls", why)
        if _nodal(scene):
            cost = patch_cost(scene)
            why = f"contact.discretisation is nodal: some {cost.points} points carry a contact, {cost.bytes / 2**20:.0f} MiB"
            parts.keep("pressures at surface points", why)
            moves = uses_record(scene) and scene.integrator.method.inertial and scene.kinematics.ball_inertia
            part, why = "inertia of the balls in their meridian planes", "two coordinates a ball, in steps of time"
            parts.decide(moves, part, why, "their slowest mode lies at some kHz: they follow at once")
        else:
            why_not = (
                "rings on rigid seats, thin against the distance of the balls: less than 1e-3 of a contact's compliance"
            )
            parts.decide(_balls_meet(scene), BETWEEN_BALLS, "soft seats or thick rings", why_not)
            if scene.excitation is not None:
                why = "rings and balls follow at once; what that costs is told by `model.inertia` of the result"
                parts.leave_out("inertia of the bodies' deformation", why)
        parts.leave_out("a compliance for each ball and contact", "balls are equal and rings are bodies of revolution")
        why = "rings and balls are symmetric about each plane through their axis: a harmonic is one real system"
        parts.leave_out("other mirror half", why)
        parts.leave_out("stress recovery", "no stress inside the bodies is asked for")

    def unused(self, scene: Scene) -> list[tuple[str, str]]:
        """Points stick by themselves."""
        why = "points stick by the compliance of rings and balls themselves"
        return [("contact.stick_stiffness", why)] if _nodal(scene) else []

    def cost(self, scene: Scene, balls: Balls, motion: Motion, parts: Decisions) -> Cost:
        """Sections or patches first, then the motion."""
        if not _nodal(scene):
            more = _BETWEEN_S * (scene.bearing.ball_count / 12.0) ** 2 if parts.keeps(BETWEEN_BALLS) else 0.0
            once = section_cost(scene).seconds
            return Cost(START_S + once + compiled_motion(scene, balls, motion, _TIMES, more), once)
        patches = patch_cost(scene)
        guess = MOTION if scene.excitation is not None and scene.integrator.method.inertial else 0.0
        seconds = patches.setup_s + 3.0 * patches.equilibrium_s + guess * patches.step_s
        steps = motion.turns * motion.steps_per_turn if motion.recorded else 0
        return Cost(START_S + seconds + _WITH_HALF * runs(scene, motion) * steps * patches.step_s)

    def same_bodies(self, scene: Scene, other: Scene) -> bool:
        """Whether sections, contacts and materials, which compliances are computed from, are the same."""
        from raceway.bodies.basis import make_basis
        from raceway.bodies.condensed.compliances import sections

        if (scene.bearing, scene.supports, scene.mesh) == (other.bearing, other.supports, other.mesh):
            return True  # all that sections are made of
        one, two = (sections(each, make_basis(each)) for each in (scene, other))
        return one == two

    def build(self, scene: Scene, plan: Plan) -> Bearing:
        """See ``raceway.bodies.condensed.build`` and ``raceway.bodies.patches.build``."""
        if _nodal(scene):
            from raceway.bodies.patches.build import build as nodal

            return nodal(scene, plan)
        from raceway.bodies.condensed.build import build

        return build(scene, plan)


def _nodal(scene: Scene) -> bool:
    return scene.contact.discretisation == "nodal"


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
