"""Gyroscopic moments of ring and rotor: the identified stiffness against a linear model written from the angular momentum."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.scene.inner_ring import ring_inertia
from raceway.testing import b7206c, run

#: Half the rig's disc [kg m2]: polar inertia about twice the transverse one.
POLAR, TRANSVERSE = 8.05e-3, 4.1e-3
SPEED_RPM = 12000.0


def linear(stiffness: np.ndarray, model, polar: float, whirl: float) -> complex:
    """Z [N/m] of a force that turns with ``whirl`` times the speed, on the tangent of the equilibrium.

    Notes
    -----
    The axis of a ring tilted by (theta_y, theta_z) points along (1, theta_z, -theta_y).  Its angular momentum is
    I_p W (1, theta_z, -theta_y) + I_t (0, theta_y', theta_z'), whose rate is the moment on the ring: +I_p W theta_z' about y
    and -I_p W theta_y' about z.
    """
    w = SPEED_RPM * np.pi / 30.0
    moments = np.zeros((5, 5))
    moments[3, 4], moments[4, 3] = polar * w, -polar * w
    dynamic = stiffness - w**2 * model.system.mass + 1j * w * moments
    force = np.array([0.0, 1.0, -1j * whirl, 0.0, 0.0])
    return 1.0 / np.linalg.solve(dynamic, force)[1]


@pytest.mark.parametrize("polar", [0.0, POLAR])
@pytest.mark.parametrize("whirl", ["forward", "backward"])
def test_what_spins_stiffens_forward_whirl_and_softens_backward_whirl(whirl, polar):
    """The inner ring alone, 1.9e-5 kg m2, and with a disc."""
    tables = b7206c(
        load={"axial": 400.0},
        supports={"tilt": "free"},
        rotor={"polar_inertia": polar, "transverse_inertia": TRANSVERSE if polar else 0.0},
        excitation={"kind": "bidirectional", "speed_rpm": SPEED_RPM, "amplitude": "constant", "force": 0.1, "whirl": whirl},
        contact={"damping": 0.0},
        integrator={"kind": "periodic"},
    )
    result = run(scene_from_dict(tables))
    # A hollow cylinder of the bore and a land at 0.2 D, without its groove: 0.5 m (r_i^2 + r_a^2), 10 % more than the ring.
    bore, land = 15e-3, 0.5 * (46e-3 - 9.525e-3) + 0.2 * 9.525e-3
    cylinder = 0.5 * 7810.0 * np.pi * 16e-3 * (land**4 - bore**4)
    ring = ring_inertia(result.model.scene)[2]
    assert 0.8 * cylinder < ring < cylinder
    expected = linear(result.equilibrium.stiffness, result.model, polar + ring, 1.0 if whirl == "forward" else -1.0)
    # 0.1 N of 400 N: what is not linear in the force is of second order, 1e-6, and amplified by the moments' cancelling.
    assert result.identification.dynamic_stiffness == pytest.approx(expected, rel=1e-4)
