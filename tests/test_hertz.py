"""Elliptic Hertz against quadrature, limits and the contact's own equations."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import RacewayError
from raceway.core.contact.hertz import contact_modulus, ellipse, ellipticity
from validation.reference.hertz import contact

MODULUS = contact_modulus(212e9, 0.29, 212e9, 0.29)


@pytest.mark.parametrize("difference", [0.0, 1e-6, 0.05, 0.3, 0.8, 0.93, 0.98, 0.995])
@pytest.mark.parametrize("load", [0.1, 300.0, 2e4])
def test_equals_quadrature(difference, load):
    found = ellipse(450.0, difference, MODULUS)
    wanted = contact(*found.curvatures, MODULUS, load)
    a, b = found.semi_axes(load)
    # 1e-6 near the circle: there the reference's own difference of two integrals cancels.
    relative = 1e-6 if difference == 1e-6 else 1e-8
    assert [a, b] == pytest.approx([wanted["a"], wanted["b"]], rel=relative)
    assert found.approach(load) == pytest.approx(wanted["approach"], rel=relative)
    assert found.peak_pressure(load) == pytest.approx(wanted["p0"], rel=relative)


def test_circle_is_the_closed_form():
    radius, load = 5e-3, 100.0
    found = ellipse(2.0 / radius, 0.0, MODULUS)
    a = (3.0 * load * radius / (4.0 * MODULUS)) ** (1.0 / 3.0)
    assert found.semi_axes(load)[0] == pytest.approx(a, rel=1e-12)
    assert found.approach(load) == pytest.approx(a * a / radius, rel=1e-12)
    assert found.factor == pytest.approx(4.0 / 3.0 * MODULUS * radius**0.5, rel=1e-12)


def test_load_and_approach_are_inverse():
    found = ellipse(400.0, 0.94, MODULUS)
    load = np.geomspace(1e-3, 1e5, 9)
    assert found.factor * found.approach(load) ** 1.5 == pytest.approx(load, rel=1e-13)


def test_ellipticity_is_smooth_near_the_circle():
    """chi - 1 is 4 F / 3 + ... for small curvature differences (series of K/E); no jump where the formula changes."""
    small = np.geomspace(1e-9, 1e-3, 60)
    chi = np.array([ellipticity(float(f)) for f in small])
    slope = (chi - 1.0) / small
    assert slope == pytest.approx(4.0 / 3.0, rel=2e-3)  # the next term is of the size of F


def test_no_load_no_pressure():
    assert ellipse(400.0, 0.9, MODULUS).peak_pressure(np.array([0.0, 1.0]))[0] == 0.0


@pytest.mark.parametrize("difference", [1.0, 1.5, -0.1, float("nan")])
def test_line_contacts_are_refused(difference):
    with pytest.raises(RacewayError, match="curvature difference"):
        ellipticity(difference)
