"""The kind of bodies of which only the contacts deform."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits
from raceway.planning.parts import START_S, Balls, Decisions, PlannedMotion, Times, compiled_motion
from raceway.planning.resolve import Problem

if TYPE_CHECKING:
    from raceway.bodies.columns import ColumnBearing
    from raceway.bodies.model import BuiltBearing
    from raceway.planning.plan import ScenePlan

_TIMES = Times({"weightless": 2.3e-6, "inertial": 3.3e-6, "tangential": 16.0e-6}, sample=8.0e-6, search=1.0)
_NO_MESH = "bodies.kind is rigid: no body is meshed"


@attrs.frozen
class Rigid:
    """Rigid rings and balls: only the contacts deform."""

    name: ClassVar[str] = "rigid"

    def faults(self, problem: Problem) -> list[Mistake]:
        """Seats and meshes, which rigid bodies have none of; surface points."""
        faults = []
        if problem.mesh is not None:
            why = "rigid bodies have no mesh: delete the table, or set bodies.kind to deformable bodies"
            faults.append(Mistake("mesh", None, why))
        if problem.contact.discretisation == "nodal" and "nodal" in problem.contact.law.discretisations:
            why = "rigid bodies have no surface points: use 'resultant'"
            faults.append(Mistake("contact.discretisation", "nodal", why))
        for key, seat in (("outer_seat", problem.supports.outer_seat), ("inner_seat", problem.supports.inner_seat)):
            if seat != "rigid":
                why = "rigid rings have rigid seats: delete it, or use bodies.kind = 'condensed'"
                faults.append(Mistake(f"supports.{key}", seat, why))
        return faults

    def traits(self, problem: Problem) -> Traits:
        """Contact resultants with compiled forces."""
        return Traits(renews=True, damps=True, contacts_alone=True)

    def stable_step(self, problem: Problem) -> float:
        """Of the ring on its contacts [s]."""
        return 2.0 / problem.highest_frequency

    def decide(self, problem: Problem, parts: Decisions) -> None:
        """No part of a body that deforms."""
        parts.leave_out("elastic rings and balls", "bodies.kind is rigid: only contacts deform")
        for part in ("a compliance per ball and contact", "other mirror half", "stress recovery"):
            parts.leave_out(part, _NO_MESH)

    def cost(self, problem: Problem, balls: Balls, motion: PlannedMotion, parts: Decisions) -> Cost:
        """The motion's: an equilibrium takes microseconds."""
        return Cost(START_S + compiled_motion(problem, balls, motion, _TIMES))

    def build(self, problem: Problem, plan: ScenePlan) -> BuiltBearing:
        """See ``raceway.bodies.rigid_bearing``."""
        from raceway.bodies.rigid_bearing import build

        return build(problem, plan)

    def columns(self, problem: Problem, plan: ScenePlan) -> ColumnBearing:
        """See ``raceway.bodies.columns``."""
        from raceway.bodies.columns import ball_columns

        return ball_columns(problem, plan)
