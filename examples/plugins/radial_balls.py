from typing import ClassVar

import attrs
import numpy as np

from raceway import Mistake, at_least, hookimpl, jit, option
from raceway.extend import (
    CONTACT_FORCE,
    FORCE_BY_GAP,
    FORCE_BY_RATE,
    GAP,
    GAP_RATE,
    SHIFT,
    START_S,
    SYSTEM,
    BuiltBearing,
    Cost,
    System,
    Times,
    Traits,
    changing_speed,
    compiled_motion,
    contact_pairs,
    excitation,
    law_params,
    layout,
    linear_parts,
    make_basis,
)

# Rows of `work` behind the law's five: azimuth, approach of both races, its speed, force on the ring, tangents of two rows.
DIRECTION, APPROACH, SPEED, CARRIED, STIFF, VISCOUS = 5, 6, 7, 8, 9, 11


@jit(SYSTEM)
def radial(t, q, v, balls, contacts, constants, response):
    (scalars, table), (f, K, C, work) = constants, response
    z, gap, rate, force = table.shape[0], work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    d_gap, d_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    layout.place(t, q, v, constants, work, (DIRECTION, APPROACH, SPEED))
    for k in range(z):
        half, speed = 0.5 * work[APPROACH, z + k], 0.5 * work[SPEED, z + k]
        balls.position[k, 0], balls.position[k, 1] = 0.0, half
        gap[k], gap[z + k], rate[k], rate[z + k] = -half, -half, -speed, -speed
        work[SHIFT, k] = work[SHIFT, z + k] = 0.0
    contacts.law(gap, rate, contacts.params, contacts.old, contacts.new, contacts.dt, force, d_gap, d_rate)
    for k in range(z):
        work[CARRIED, k], work[CARRIED, z + k] = 0.0, force[k]
        for row in (STIFF, VISCOUS):
            work[row, k], work[row, z + k], work[row + 1, k] = 0.0, 0.0, 0.0
        work[STIFF + 1, z + k], work[VISCOUS + 1, z + k] = -0.5 * d_gap[k], -0.5 * d_rate[k]
    layout.ring_force(table, scalars[layout.TILT_ARM], work, DIRECTION, CARRIED, f)
    if K.size > 0:
        layout.ring_tangent(table, scalars[layout.TILT_ARM], work, DIRECTION, STIFF, K)
        layout.ring_tangent(table, scalars[layout.TILT_ARM], work, DIRECTION, VISCOUS, C)
    return 0


class RadialBearing(BuiltBearing):
    """Balls in one plane, whose contact angle is 0."""

    def has_places(self, balls):
        return False

    def mesh_error(self, model, equilibrium):
        return None, "rigid bodies have no mesh"

    def contact_error(self, model, equilibrium):
        return None, "both contacts are taken for the inner one: what that is off by is not estimated"


@attrs.frozen
class RadialBalls:
    """Rigid rings on weightless balls in one plane, both contacts of a ball alike: radial loads."""

    name: ClassVar[str] = "radial_balls"
    interference: float = option(2e-6, unit="m", help="of a ball between the unloaded races", rule=at_least(0.0))

    @classmethod
    def example_scene(cls):
        return {
            "bearing": {"preset": "B7206C"},
            "supports": {"axial": "displacement"},
            "load": {"radial": [1500.0, 100.0]},
            "kinematics": {"ball_inertia": False},
            "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 1e-4},
            "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
        }

    def faults(self, problem):
        taken = {
            "bearing.arrangement": "single", "supports.axial": "displacement", "supports.tilt": "locked",
            "supports.outer_seat": "rigid", "supports.inner_seat": "rigid", "load.axial": 0.0,
            "contact.discretisation": "resultant", "contact.friction": 0.0, "contact.damping": 0.0,
            "kinematics.ball_inertia": False, "kinematics.gyroscopic": "none", "kinematics.orbiting": False,
        }  # fmt: skip
        given = {path: getattr(getattr(problem, path.split(".")[0]), path.split(".")[1]) for path in taken}
        why = "bodies.kind 'radial_balls' computes {!r} only: use that"
        return [Mistake(path, given[path], why.format(one)) for path, one in taken.items() if given[path] != one]

    def traits(self, problem):
        return Traits(compiled=True)

    def stable_step(self, problem):
        return 2.0 / problem.highest_frequency

    def decide(self, problem, parts):
        parts.leave_out("elastic rings and balls", "bodies.kind is radial_balls: only contacts deform")

    def unused(self, tables):
        return [("load.moment", "the ring does not tilt")]

    def cost(self, problem, balls, motion, parts):
        return Cost(START_S + compiled_motion(problem, balls, motion, Times({"weightless": 2e-6}, sample=8e-6, search=1.0)))

    def build(self, problem, plan):
        basis, z = make_basis(problem), problem.bearing.ball_count
        params = law_params(problem.contact.law, contact_pairs(problem, basis))
        params[z:] = params[:z]
        scalars, table = np.zeros(layout.SCALARS), np.zeros((z, layout.COLUMNS))
        scalars[layout.REST_RADIAL] = self.interference + problem.kinematics.radial_expansion
        scalars[layout.TILT_ARM] = 0.5 * problem.bearing.pitch_diameter
        table[:, layout.COSINE], table[:, layout.SINE], table[:, layout.SIDE] = (
            np.cos(basis.azimuth),
            np.sin(basis.azimuth),
            1.0,
        )
        memory = np.zeros((2 * z, problem.contact.law.state_size))
        kernels = {"kernel": radial, "base_kernel": radial, "law": problem.contact.law.kernel()}
        arrays = {"law_params": params, "law_state": memory, "scalars": scalars, "table": table}
        parts = {**linear_parts(problem, plan), **excitation(problem), "spin": changing_speed(problem)}
        guess = 1e-8 * np.array([0.0, *problem.load.radial, 0.0, 0.0])
        return RadialBearing(basis, System(**kernels, **arrays, **parts), guess)


@hookimpl
def raceway_bodies():
    return [RadialBalls]
