"""Gyroscopic moments of the rotor: the identified stiffness against a linear model written from the angular momentum."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.run import run
from raceway.scene_file import scene_from_dict
from tests.conftest import b7206c

#: Half the rig's disc [kg m2]: polar inertia about twice the transverse one.
POLAR, TRANSVERSE = 8.05e-3, 4.1e-3
SPEED_RPM = 12000.0


def linear(stiffness: np.ndarray, model, whirl: float) -> complex:
    """Z [N/m] of a force that turns with ``whirl`` times the speed, on the tangent of the equilibrium.

    Notes
    -----
    The axis of a ring tilted by (theta_y, theta_z) points along (1, theta_z, -theta_y).  Its angular momentum is
    I_p W (1, theta_z, -theta_y) + I_t (0, theta_y', theta_z'), whose rate is the moment on the ring: +I_p W theta_z' about y
    and -I_p W theta_y' about z.
    """
    w = SPEED_RPM * np.pi / 30.0
    moments = np.zeros((5, 5))
    moments[3, 4], moments[4, 3] = POLAR * w, -POLAR * w
    dynamic = stiffness - w**2 * model.system.mass + 1j * w * moments
    force = np.array([0.0, 1.0, -1j * whirl, 0.0, 0.0])
    return 1.0 / np.linalg.solve(dynamic, force)[1]


@pytest.mark.parametrize("whirl", ["forward", "backward"])
def test_the_disc_stiffens_forward_whirl_and_softens_backward_whirl(whirl):
    tables = b7206c(
        load={"axial": 400.0},
        supports={"tilt": "free"},
        rotor={"polar_inertia": POLAR, "transverse_inertia": TRANSVERSE},
        excitation={"kind": "bidirectional", "speed_rpm": SPEED_RPM, "amplitude": "constant", "force": 0.1, "whirl": whirl},
        contact={"damping": 0.0},
        integrator={"kind": "periodic"},
    )
    result = run(scene_from_dict(tables))
    expected = linear(result.equilibrium.stiffness, result.model, 1.0 if whirl == "forward" else -1.0)
    # 0.1 N of 400 N: what is not linear in the force is of second order, 1e-6, and amplified by the moments' cancelling.
    assert result.identification.dynamic_stiffness == pytest.approx(expected, rel=1e-4)
