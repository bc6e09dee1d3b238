"""The kind of bodies of which every node moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.bodies.condensed.plan import section_cost
from raceway.bodies.elastic.plan import elastic_cost, elastic_faults, equal_sectors, memory_faults, words
from raceway.bodies.mesh_plan import mesh_faults, predicted_mesh, unrefined
from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits
from raceway.framework.options import one_of, option, positive
from raceway.planning.decisions import Balls, Motion
from raceway.planning.parts import Decisions
from raceway.planning.wall_time import START_S
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.model import Bearing
    from raceway.planning.plan import Plan


@attrs.frozen
class Elastic:
    """Finite elements of rings and balls, all nodes unknowns: the bodies' own inertia and any mesh."""

    name: ClassVar[str] = "elastic"

    formulation: str = option(
        "incompatible",
        help="hexahedra: 'one_point' with hourglass control, 'full' (2 x 2 x 2), with 'incompatible' modes",
        rule=one_of("one_point", "full", "incompatible"),
    )
    hourglass: float = option(
        0.05,
        help="stiffness of the hourglass modes of 'one_point', over lambda + 2 mu; impacts want 0.005 and elements "
        "of at most 0.6 of the contact's radius",
        rule=positive(),
    )

    @classmethod
    def example_scene(cls) -> Tables:
        """Three balls on some hundred elements each, with a force that is small against the loads: seconds."""
        return {
            "bearing": {"preset": "B7206C", "ball_count": 3},
            "mesh": {"kind": "structured", "element_size": 3.2e-3, "azimuth_cells": 12, "nodes_per_semi_axis": 0},
            "load": {"axial": 240.0, "radial": [20.0, 0.0]},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3e-5},
            "integrator": {"kind": "newmark", "turns": 1, "steps_per_turn": 32, "tolerance": 1e-5},
        }

    def unused_options(self) -> dict[str, str]:
        """Options that change nothing, with the reason."""
        why = f"bodies.formulation is '{self.formulation}': only 'one_point' has hourglass modes"
        return {"hourglass": why} if self.formulation != "one_point" and self.hourglass != 0.05 else {}

    def faults(self, scene: Scene) -> list[Mistake]:
        """What bodies with every node cannot do; meshes without cells, or too large."""
        faults = elastic_faults(scene)
        points = [] if scene.contact.discretisation == "resultant" else unrefined(scene, "pressures at surface points")
        unmeshed = points or mesh_faults(scene)
        return faults + (unmeshed or ([] if faults else memory_faults(scene)))

    def traits(self, scene: Scene) -> Traits:
        """Stepped from Python; a run is too dear to be made twice."""
        resultants = scene.contact.discretisation == "resultant"
        calibrated = resultants and scene.contact.kind == "hertz"
        return Traits(compiled=False, resultants=resultants, calibrated=calibrated, every_node=True)

    def stable_step(self, scene: Scene) -> float | None:
        """Of elements and contacts [s]; None where the mesher cannot tell."""
        cost = elastic_cost(scene)
        return None if cost is None or cost.stable_step_s == 0.0 else cost.stable_step_s

    def decide(self, scene: Scene, parts: Decisions) -> None:
        """What of the bodies is not left out: all of them."""
        cost = elastic_cost(scene)
        size = "" if cost is None else f": {words(cost)}"
        parts.keep(
            "elastic rings and balls", f"bodies.kind is elastic: finite elements of rings and balls, every node{size}"
        )
        nodal = scene.contact.discretisation == "nodal"
        why = "elastic bodies touch at the points of the balls' surfaces"
        why_not = (
            "contact.discretisation is resultant: one force a contact, whose law replaces what the mesh below it gives way"
        )
        parts.decide(nodal, "pressures at surface points", why, why_not)
        parts.keep("ideal cage", "holds each ball at its azimuth and keeps it from turning")
        why_not = "balls do not orbit: the cage holds them, their centrifugal force is kept where the plan says so"
        parts.leave_out("travel of the balls", why_not)
        parts.keep("a compliance for each ball and contact", "every node of every ball and ring is an unknown")
        why = "every node of both halves: the forces may have any direction; a half model is no part of this program"
        parts.keep("other mirror half", why)
        count = scene.bearing.ball_count
        why = f"the {count} balls are one ball turned, and each ring {count} equal sectors: one of each is factored"
        if nodal and equal_sectors(scene):
            parts.leave_out("factors of equal balls and sectors", why)
        elif nodal:
            why = f"mesh.kind is {scene.mesh.name}: " if scene.mesh is not None else ""
            why += (
                "a ring is factored as a whole unless its sectors turn out to be equal, and each ball that is no turned copy"
            )
            parts.keep("factors of equal balls and sectors", why)
        why = "along the normals of the most loaded contacts, once, at rest; `raceway view` recovers the stresses of all elements"
        why_not = "contact resultants on coarse meshes have no stresses of contacts below them"
        parts.decide(nodal, "stress recovery", why, why_not)

    def unused(self, scene: Scene) -> list[tuple[str, str]]:
        """Nothing beyond what holds for all bodies."""
        return []

    def cost(self, scene: Scene, balls: Balls, motion: Motion, parts: Decisions) -> Cost:
        """Meshing, factors and solves; contact resultants are calibrated as the bearing's own condensed rings."""
        cost = elastic_cost(scene)
        if cost is None:
            return Cost(START_S, scales=False, at_least=True)
        seconds = START_S + cost.equilibrium_s
        if scene.contact.discretisation == "resultant":
            seconds += section_cost(attrs.evolve(scene, mesh=None)).seconds
        if motion.recorded:
            seconds += cost.start_s + motion.turns * motion.steps_per_turn * cost.step_s
        return Cost(seconds, unknowns=cost.unknowns, mesh=predicted_mesh(scene), scales=False, bytes=cost.bytes)

    def build(self, scene: Scene, plan: Plan) -> Bearing:
        """See ``raceway.bodies.elastic.build``."""
        from raceway.bodies.elastic.build import build

        return build(scene, plan)
