"""The kind of bodies of cylindrical roller bearings: what it takes, what it refuses, what a run will cost."""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.core.quantities.ratings import STRIBECK
from raceway.errors import Mistake
from raceway.framework.contracts import Cost, Traits
from raceway.framework.duties import line_contact
from raceway.framework.options import at_least, option, positive
from raceway.planning.parts import START_S, Times, compiled_motion
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.columns import ColumnBearing
    from raceway.bodies.model import BuiltBearing
    from raceway.planning.parts import Balls, Decisions, PlannedMotion
    from raceway.planning.plan import ScenePlan
    from raceway.planning.resolve import Problem
    from raceway.scene.bearing import Bearing
    from raceway.scene.tables import SceneTables

#: Seconds of a step with 12 rollers, of a sample, and of a search over that of rigid balls.
_TIMES = Times({"weightless": 1.0e-4, "inertial": 1.2e-4}, sample=1.2e-4, search=1.0)
#: c of line contacts of steel [m^1.8 / N^0.9] for estimates, that of ``raceway.contact_laws.line``.
_COEFFICIENT = 1.6e-10


@attrs.frozen
class CylindricalRollers:
    """Rigid rings on Z cylindrical rollers in line contact, cut into laminae: radial loads and moments, no axial stiffness.

    ISO/TS 16281:2008, section 5: at least 30 laminae, profile P(x) = 0.00035 D ln[1 / (1 - (2 x / L)^2)] of rollers with L <= 2.5 D.
    """

    name: ClassVar[str] = "cylindrical_rollers"
    rollers: ClassVar[bool] = True

    roller_length: float = option(unit="m", help="effective length L of the line contacts", rule=positive())
    crown: float = option(
        0.00035, help="A / D of the rollers' profile P(x) = A ln[1 / (1 - (2 x / L)^2)]; 0: straight", rule=at_least(0.0)
    )
    laminae: int = option(30, help="slices of each line contact", rule=at_least(1))

    @classmethod
    def examples(cls) -> list[CylindricalRollers]:
        """For the conformance suite."""
        return [cls(roller_length=9e-3)]

    @classmethod
    def example_scene(cls) -> Tables:
        """Sizes of an NU 206, for the conformance suite."""
        return {
            "bearing": {
                "ball_count": 13, "ball_diameter": 9e-3, "pitch_diameter": 46.5e-3, "radial_clearance": 10e-6,
                "bore": 30e-3, "width": 16e-3, "conformity_inner": 0.52, "conformity_outer": 0.52,
            },
            "supports": {"axial": "displacement"},
            "load": {"radial": [4000.0, 300.0]},
            "contact": {"kind": "line"},
            "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 2e-4},
            "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
            "kinematics": {"ball_inertia": False},
        }  # fmt: skip

    def faults(self, problem: Problem) -> list[Mistake]:
        """Loads and motions that rollers do not carry, contacts that are no lines, forces that are not computed."""
        b, supports, contact, moving = problem.bearing, problem.supports, problem.contact, problem.kinematics
        carry = "cylindrical rollers carry no axial load"
        elsewhere = f"{carry}: another bearing locates the ring, supports.axial = 'displacement'"
        alone = "line contacts are resultants: use 'resultant'"
        parallel = "rollers that stay parallel to the axis have no gyroscopic moment: use 'none'"
        grows = "assumes the ring of a ball bearing: set the growth by kinematics.radial_expansion"
        refusals = [
            (supports.axial != "displacement", "supports.axial", supports.axial, elsewhere),
            (problem.load.axial != 0.0, "load.axial", problem.load.axial, f"{carry}: delete it"),
            (not line_contact(contact.law), "contact.kind", contact.kind, "is not a law of line contacts: use 'line'"),
            (contact.discretisation != "resultant", "contact.discretisation", contact.discretisation, alone),
            (contact.friction > 0.0, "contact.friction", contact.friction, "is not computed for rollers: set it to 0"),
            (moving.gyroscopic != "none", "kinematics.gyroscopic", moving.gyroscopic, parallel),
            (bool(moving.ring_growth), "kinematics.ring_growth", True, grows),
            (b.arrangement != "single", "bearing.arrangement", b.arrangement, "rollers are in one row: use 'single'"),
            (bool(b.contact_angle_deg), "bearing.contact_angle_deg", b.contact_angle_deg, "a line contact has none: set bearing.radial_clearance only"),
            (problem.mesh is not None, "mesh", None, "rings and rollers are rigid and have no mesh: delete the table"),
            (supports.outer_seat != "rigid", "supports.outer_seat", supports.outer_seat, "rigid rings have rigid seats: use 'rigid'"),
            (supports.inner_seat != "rigid", "supports.inner_seat", supports.inner_seat, "rigid rings have rigid seats: use 'rigid'"),
        ]  # fmt: skip
        return [Mistake(path, value, why) for bad, path, value, why in refusals if bad]

    def traits(self, problem: Problem) -> Traits:
        """Compiled contact resultants of lines."""
        return Traits(line_contacts=True)

    def stable_step(self, problem: Problem) -> float:
        """Of the ring on half its rollers under Stribeck's load [s]."""
        count, length = problem.bearing.ball_count, self.roller_length
        amplitude = 0.0 if problem.excitation is None else problem.excitation.amplitude_n
        load = float(abs(complex(*problem.load.radial))) + amplitude
        coefficient = getattr(problem.contact.law, "coefficient", 0.0) or _COEFFICIENT
        approach = 2.0 * coefficient * (STRIBECK * load / count) ** 0.9 / length**0.8
        stiffness = 0.5 * count * 10.0 / 9.0 * (STRIBECK * load / count) / approach if load > 0.0 else 1.0
        return 2.0 / sqrt(stiffness / max(problem.rotor.mass + self.ring_mass(problem.bearing), 1e-9))

    def ring_mass(self, b: Bearing) -> float:
        """Of the inner ring, a hollow cylinder [kg]; 0 where bore or width are not known."""
        if b.bore is None or b.width is None:
            return 0.0
        return 0.25 * pi * ((b.pitch_diameter - b.ball_diameter) ** 2 - b.bore**2) * b.width * b.rings.density

    def decide(self, problem: Problem, parts: Decisions) -> None:
        """No part of a body that deforms."""
        parts.leave_out("elastic rings and rollers", "bodies.kind is cylindrical_rollers: only line contacts deform")

    def unused(self, tables: SceneTables) -> list[tuple[str, str]]:
        """Keys of grooves."""
        return [(key, "cylindrical rollers have no grooves") for key in ("bearing.shoulder_height", "bearing.tilt_arm")]

    def cost(self, problem: Problem, balls: Balls, motion: PlannedMotion, parts: Decisions) -> Cost:
        """The motion's."""
        return Cost(START_S + compiled_motion(problem, balls, motion, _TIMES))

    def build(self, problem: Problem, plan: ScenePlan) -> BuiltBearing:
        """See ``raceway.plugins.bodies.roller_bearing``."""
        from raceway.plugins.bodies.roller_bearing import build

        return build(problem, plan, self)

    def columns(self, problem: Problem, plan: ScenePlan) -> ColumnBearing:
        """See ``raceway.plugins.bodies.roller_bearing``."""
        from raceway.plugins.bodies.roller_bearing import roller_columns

        return roller_columns(problem, plan)
