"""Stresses below Hertz's contacts against quadrature of Boussinesq's point loads and the limits of textbooks."""

import numpy as np
import pytest

from checks.validation.reference.half_space import pressed_stress
from raceway.core.contact.hertz import largest_shear
from raceway.extend import axis_shear, axis_stresses

NU = 0.3


@pytest.mark.parametrize("semi_axes", [(1.0, 1.0), (2.0, 1.0), (10.0, 1.0), (1.0, 3.0)])
@pytest.mark.parametrize("poisson", [0.0, 0.29, 0.5])
def test_equals_quadrature_of_point_loads(semi_axes, poisson):
    depth = np.array([0.3, 0.5, 0.8, 1.5, 4.0])
    where = np.stack([0.0 * depth, 0.0 * depth, depth], axis=1)
    found = axis_stresses(depth, semi_axes, 1.0, poisson)
    wanted = pressed_stress(where, semi_axes, 1.0, poisson)
    # The quadrature's error, largest where the ellipse is long and the point shallow.
    assert found == pytest.approx(wanted[:, :3], abs=1e-8)
    assert wanted[:, 3:] == pytest.approx(0.0, abs=1e-10)  # x, y, z are principal


def test_stresses_at_the_surface_are_those_of_johnson():
    """Contact Mechanics, equation 4.23 c, d at the centre of an ellipse of ratio 2."""
    a, b = 2.0, 1.0
    (x, y, z) = axis_stresses(np.zeros(1), (a, b), 1.0, NU)[0]
    assert z == pytest.approx(-1.0, rel=1e-8)
    assert x == pytest.approx(-2.0 * NU - (1.0 - 2.0 * NU) * b / (a + b), rel=1e-8)
    assert y == pytest.approx(-2.0 * NU - (1.0 - 2.0 * NU) * a / (a + b), rel=1e-8)


def test_a_circle_has_the_textbook_s_stresses():
    """Johnson, equation 3.45: sigma_r / p0 = -(1 + nu) (1 - z/a arctan a/z) + 1 / (2 (1 + z^2/a^2)), sigma_z = -1 / (1 + z^2/a^2)."""
    z = np.linspace(0.05, 5.0, 40)
    radial = -(1.0 + NU) * (1.0 - z * np.arctan(1.0 / z)) + 0.5 / (1.0 + z * z)
    found = axis_stresses(z, (1.0, 1.0), 1.0, NU)
    assert found == pytest.approx(np.stack([radial, radial, -1.0 / (1.0 + z * z)], axis=1), rel=1e-12)


def test_a_line_contact_has_the_textbook_s_stresses():
    """Johnson, equation 4.46: sigma_y / p0 = -((b^2 + 2 z^2) / sqrt(b^2 + z^2) - 2 z) / b, sigma_z / p0 = -b / sqrt(b^2 + z^2)."""
    z = np.linspace(0.05, 3.0, 30)
    root = np.sqrt(1.0 + z * z)
    wanted = np.stack([-((1.0 + 2.0 * z * z) / root - 2.0 * z), -1.0 / root], axis=1)
    # An ellipse of 1e6 widths: what is left is of the order of b / a.
    assert axis_stresses(z, (1e6, 1.0), 1.0, NU)[:, 1:] == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize(
    ("semi_axes", "poisson", "shear", "depth"),
    [
        ((1.0, 1.0), 0.3, 0.310, 0.48),  # Johnson, section 4.2
        ((1e4, 1.0), 0.3, 0.300, 0.786),  # Johnson, section 4.1: whatever nu ...
        ((1e4, 1.0), 0.45, 0.300, 0.786),
        ((1e4, 1.0), 0.0, 0.500, 0.0),  # ... but where nothing presses along the line: half the pressure, at the surface
    ],
)
def test_the_largest_shear_and_its_depth_are_the_textbook_s(semi_axes, poisson, shear, depth):
    found, at = largest_shear(semi_axes, 2e9, poisson)
    # Digits of the sources.
    assert found / 2e9 == pytest.approx(shear, abs=6e-4)
    assert at == pytest.approx(depth, abs=2e-3)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 3.0, 8.0, 30.0])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_nowhere_on_the_axis_is_the_shear_larger(ratio, poisson):
    shear, depth = largest_shear((ratio, 1.0), 1.0, poisson)
    along = np.linspace(0.0, 6.0, 3001)
    values = axis_shear(along, (ratio, 1.0), 1.0, poisson)
    # A grid of 0.002 misses a top of unit curvature by half the square of half its step.
    assert shear == pytest.approx(values.max(), abs=1e-6)
    assert depth == pytest.approx(along[values.argmax()], abs=2e-3)


def test_axes_scale_lengths_and_the_pressure_scales_stresses():
    one, other = largest_shear((3.0, 1.0), 1.0, NU), largest_shear((2e-4, 6e-4), 1.5e9, NU)
    assert other == pytest.approx((1.5e9 * one[0], 2e-4 * one[1]), rel=1e-6)
