"""K identified from 12 turns of a transient, against the periodic motion found by independent code.

The reference integrates the same equations with scipy's DOP853 and closes the orbit by Newton on the monodromy matrix
(``checks.validation.reference.shooting``); nothing of the program's kernels is in it.
"""

from itertools import product

import attrs
import numpy as np

from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import dynamic_stiffness, periodic
from checks.validation.reference.shooting import rotating as rotating_force
from checks.validation.reference.statics import equilibrium
from checks.validation.scenes import rig_force, rotating
from raceway import scene_from_dict
from raceway.testing import ring_inertia, run

INTEGRATORS = ("newmark", "generalized_alpha", "central_difference")
#: Tilt, axial load [N], speed [r/min], centrifugal force.
CASES = tuple(product(("locked", "free"), (400.0, 1000.0), (10980.0, 15000.0), (False, True)))
#: Largest relative error of K.  At 360 steps a turn, h apart, Newmark's method sees w^2 (1 + (w h)^2 / 6) for w^2, and central
#: differences half as much: that is the error of the inertia m w^2, which is less than K in all cases.
LIMIT = (2.0 * np.pi / 360.0) ** 2 / 6.0


def reference(axial: float, tilt: str, speed_rpm: float, inertia: bool) -> tuple[float, float]:
    """K [N/m] and the largest Floquet multiplier of the periodic motion; B7206C typed in here once more."""
    w, force = speed_rpm * np.pi / 30.0, rig_force(speed_rpm)
    translation, tilting, polar = ring_inertia(scene_from_dict(rotating(axial, tilt, speed_rpm, inertia, "newmark")).bearing)
    translation += 2.0
    mass = np.diag([translation] * 3 + [tilting] * 2)
    ring = Ring(
        ball_diameter=9.525e-3, pitch_diameter=46e-3, ball_count=12, contact_angle=np.radians(15.0),
        conformity_inner=0.522, conformity_outer=0.522, spin_speed=w if inertia else 0.0, damping=0.001, spin=polar * w,
    )  # fmt: skip
    free = np.array([1.0, 1.0, 1.0, *([float(tilt == "free")] * 2)])
    load, push, q = np.array([axial, 0.0, 0.0, 0.0, 0.0]), force, np.array([3e-5, 0.0, 0.0, 0.0, 0.0])
    for _ in range(3):
        q = equilibrium(ring, load + np.array([0.0, push, 0.0, 0.0, 0.0]), free, np.array([3e-5, 0.0, 0.0, 0.0, 0.0]))
        push = force + translation * w**2 * q[1]
    turning = np.array([0.0, -w * q[2], w * q[1], -w * q[4], w * q[3]])
    outer = rotating_force(force, w)
    times, motion, multipliers = periodic(ring, mass, load, outer, free, 2.0 * np.pi / w, q, turning)
    z = dynamic_stiffness(times, motion, outer, w)
    return z.real + translation * w**2, float(np.abs(multipliers).max())


@attrs.frozen
class Compared:
    """K of one integrator, its stated error, and K of the periodic motion by independent code, all [N/m]."""

    case: tuple[str, float, float, bool]
    integrator: str
    k: float
    stated_error: float
    wanted: float

    @property
    def error(self) -> float:
        """Relative."""
        return abs(self.k - self.wanted) / self.wanted


def compared(cases: tuple[tuple[str, float, float, bool], ...]) -> list[Compared]:
    """Each case by each integrator."""
    out = []
    for case in cases:
        tilt, axial, speed, inertia = case
        wanted, _ = reference(axial, tilt, speed, inertia)
        for integrator in INTEGRATORS:
            found = run(scene_from_dict(rotating(axial, tilt, speed, inertia, integrator))).to_dict()["identification"]
            k, stated = found["equivalent_stiffness"], found["equivalent_stiffness_error"]
            out.append(Compared(case, integrator, k, stated, wanted))
    return out
