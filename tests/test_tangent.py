"""The consistent tangent: positive definite where the ring is held, of dampers, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.ring.kernels.layout import DAMPING
from raceway.testing import settle, settled
from validation.tangent import cases

CASES = cases()


def test_positive_definite_where_held():
    model, now = settled(CASES["radial load, tilt free, 15 000 r/min"])
    weight = np.array([1.0, 1.0, 1.0, 1.0 / model.system.arm, 1.0 / model.system.arm])
    assert np.linalg.eigvalsh(weight[:, None] * 0.5 * (now.stiffness + now.stiffness.T) * weight)[0] > 0.0


@pytest.mark.parametrize("inertia", [False, True])
def test_damping_tangent_is_the_derivative_by_velocity(inertia):
    """With the balls' rates held, C is the derivative of the force by the ring's velocity."""
    model, now = settled(
        {
            **CASES["radial load, tilt free, 15 000 r/min"],
            "kinematics": {"ball_inertia": inertia, "spin_speed_rpm": 15e3},
            "contact": {"damping": 200.0},
        }
    )
    assert model.system.scalars[DAMPING] == 200.0
    found = model.system.evaluate(now.displacement, ball=now.ball).damping
    columns = []
    for i in range(5):
        v = np.zeros(5)
        v[i] = 1e-6 / (model.system.arm if i > 2 else 1.0)
        ahead, behind = (model.system.evaluate(now.displacement, sign * v, ball=now.ball).force for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * v[i]))
    # 1e-6: differences of forces of 1e-4 N in 100 N.
    assert np.abs(np.column_stack(columns) - found).max() <= 1e-6 * np.abs(found).max()


def test_two_balls_in_line_with_the_load_share_it(built):
    """Tangent of the axial direction equals the closed form of equally loaded balls in series."""
    model = built(load={"axial": 1000.0})

    now = settle(model)
    z, load, angle = 12, now.contact_force[0], now.angle_inner[0]
    soft = [2.0 / 3.0 / (ellipse.factor ** (2.0 / 3.0) * load ** (1.0 / 3.0)) for ellipse in (model.inner, model.outer)]
    length = np.hypot(model.geometry.rest[0] + now.displacement[0], model.geometry.rest[1])
    closed = z * (np.sin(angle) ** 2 / sum(soft) + load / length * np.cos(angle) ** 2)
    assert now.stiffness[0, 0] == pytest.approx(closed, rel=1e-9)
