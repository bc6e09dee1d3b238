"""Stiffness of a sticking contact: Cerruti's integral over the ellipse by quadrature, the circle, and the bearing's default."""

import numpy as np
import pytest
from scipy.integrate import quad

from raceway.bodies.basis import make_basis
from raceway.core.contact.hertz import contact_modulus, ellipse
from raceway.core.ring.kernels.layout import STICK

YOUNG, NU = 212e9, 0.29
MODULUS = contact_modulus(YOUNG, NU, YOUNG, NU)


def displacement(a, b, along):
    """Of the centre [m] under the no-slip traction of 1 N: u = 1 / (2 pi G) int q ((1 - nu) / s + nu cos^2 / s) dA.

    Along a ray of length R(theta) the traction q0 / sqrt(1 - s^2 / R^2) integrates to q0 pi R / 2, with q0 = 1 / (2 pi a b).
    """

    def ray(theta):
        length = 1.0 / np.hypot(np.cos(theta) / a, np.sin(theta) / b)
        direction = np.cos(theta) if along == "major" else np.sin(theta)
        return 0.5 * np.pi * length * (1.0 - NU + NU * direction**2)

    shear = YOUNG / (2.0 * (1.0 + NU))
    return 4.0 * quad(ray, 0.0, 0.5 * np.pi, epsrel=1e-11)[0] / (2.0 * np.pi * a * b) / (2.0 * np.pi * shear)


@pytest.mark.parametrize("difference", [0.0, 0.5, 0.93, 0.99])
@pytest.mark.parametrize("which", ["major", "minor"])
def test_ratio_against_quadrature(difference, which):
    found = ellipse(300.0, difference, MODULUS)
    load = 250.0
    a, b = found.semi_axes(load)
    normal = 1.5 * load / float(found.approach(load))
    # Two bodies alike, one behind the other.
    tangential = 1.0 / (2.0 * displacement(float(a), float(b), which))
    assert found.stick_ratio(NU)[which == "minor"] == pytest.approx(tangential / normal, rel=1e-9)


def test_a_circle_has_mindlins_ratio_and_a_long_ellipse_keeps_its_limits():
    assert ellipse(300.0, 0.0, MODULUS).stick_ratio(NU) == pytest.approx([2.0 * (1.0 - NU) / (2.0 - NU)] * 2, rel=1e-12)
    major, minor = ellipse(300.0, 1.0 - 1e-9, MODULUS).stick_ratio(NU)
    assert 1.0 - NU < major < 0.75 and 0.95 < minor < 1.0


def test_the_default_is_that_of_the_groove_direction(built):
    model = built(contact={"friction": 0.03})
    basis = make_basis(model.scene)
    load = basis.ball_load
    stiffness = [1.5 * load / float(e.approach(load)) for e in (model.inner, model.outer)]
    ratio = model.system.scalars[STICK] / np.mean(stiffness)
    # Both races' ellipses are 6 to 8 times as long as wide: 0.77, where a circle has 0.83.
    assert 0.765 < ratio < 0.78
