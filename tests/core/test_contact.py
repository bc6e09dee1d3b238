"""Geometry of a bearing and its contacts: lengths, elliptic Hertz against quadrature, pressures, stiffness of sticking contacts."""

from math import acos, cos, pi, radians, sin

import attrs
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe, ellipkm1

from checks.validation.reference.hertz import contact
from checks.validation.reference.ring import Ring
from checks.validation.scenes import built_in
from raceway import RacewayError, scene_from_dict
from raceway.core.columns import elliptic_integrals
from raceway.core.contact.hertz import ellipticity
from raceway.extend import BallBearing, ContactPairs, contact_modulus, ellipse
from raceway.testing import run

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


def test_elliptic_integrals_are_those_of_scipy():
    """To rounding of some units in the last place, from circles to contacts of a million widths."""
    m1 = np.geomspace(1e-12, 1.0, 60)
    np.testing.assert_allclose(elliptic_integrals(m1), [ellipkm1(m1), ellipe(1.0 - m1)], rtol=4e-15)
    np.testing.assert_allclose(elliptic_integrals(0.3), [ellipkm1(0.3), ellipe(0.7)], rtol=4e-15)


def test_ellipticity_is_smooth_near_the_circle():
    """chi - 1 is 4 F / 3 + ... for small curvature differences (series of K/E); no jump where the formula changes."""
    small = np.geomspace(1e-9, 1e-3, 60)
    chi = np.array([ellipticity(float(f)) for f in small])
    slope = (chi - 1.0) / small
    assert slope == pytest.approx(4.0 / 3.0, rel=2e-3)  # the next term is of the size of F


@pytest.mark.parametrize("difference", [1.0, 1.5, -0.1, float("nan")])
def test_line_contacts_are_refused(difference):
    with pytest.raises(RacewayError, match="curvature difference"):
        ellipticity(difference)


STIFFNESS = 1e15


def result(load=1000.0, **contact):
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": load}, "contact": contact}
    return run(scene_from_dict(scene))


@pytest.mark.parametrize("race", [0, 1])
def test_a_penalty_tells_its_own_peak_pressure(race):
    """k delta in the middle of the overlap ellipse, which carries Q = p0 pi a b / 2."""
    found = result(kind="penalty", stiffness=STIFFNESS)
    word = ("inner", "outer")[race]
    for k, ball in enumerate(found.to_dict()["equilibrium"]["balls"]):
        approach = -found.equilibrium.gap[12 * race + k]
        assert ball[f"peak_pressure_{word}_pa"] == pytest.approx(STIFFNESS * approach, rel=1e-9)
        a, b, load = ball[f"semi_major_{word}_m"], ball[f"semi_minor_{word}_m"], ball[f"load_{word}_n"]
        assert 0.5 * STIFFNESS * approach * np.pi * a * b == pytest.approx(load, rel=1e-9) and a > b


def test_hertz_keeps_hertz_and_open_contacts_have_none():
    found = result(kind="hertz")
    loads = np.array([0.0, 10.0, 250.0])
    for kind in ("hertz", "penalty"):
        model = result(kind=kind).model
        pressure, a, b = model.bearing.contact_ellipse(model, 0, loads)
        assert pressure[0] == a[0] == b[0] == 0.0 and (np.diff(pressure) > 0.0).all()
    ball = found.to_dict()["equilibrium"]["balls"][0]
    load = ball["load_inner_n"]
    assert ball["peak_pressure_inner_pa"] == pytest.approx(float(found.model.inner.peak_pressure(load)), rel=1e-12)


@pytest.mark.parametrize("area", [None, np.array([1e-9])])
def test_a_penalty_is_calibrated_at_the_load_that_is_given(area):
    pairs, penalty = (
        ContactPairs(*np.array([[30.0], [250.0], [1.2e11], [1e10], [100.0]]), area=area),
        built_in("contact_law", "penalty"),
    )
    heavy = attrs.evolve(pairs, reference_load=np.array([250.0]))
    assert penalty(calibrate_at=250.0).build(pairs) == pytest.approx(penalty().build(heavy), rel=1e-14)
    assert penalty().build(heavy) != pytest.approx(penalty().build(pairs), rel=1e-3)


def test_the_error_of_a_law_is_that_of_its_stiffness_too():
    """Q = c delta^2 that equals Hertz's approach at a load has the slope 2 Q / delta there, Hertz's being 1.5 Q / delta."""
    load = result(kind="hertz").to_dict()["equilibrium"]["balls"][0]["load_inner_n"]
    found = result(kind="penalty", calibrate_at=load).error
    # The outer contact carries the same load; its approach is as exact as the calibration.
    assert found["contact"] == pytest.approx(1.0 / 3.0, rel=1e-3)
    assert "stiffness (3.3e-01)" in found["how"]["contact"]
    assert result(kind="hertz").error["contact"] is None


B7206C = BallBearing(9.525e-3, 46e-3, 12, radians(15.0), 0.522, 0.522)


def test_lengths():
    assert B7206C.centre_distance == pytest.approx(0.044 * 9.525e-3)
    assert B7206C.inner_centre_radius == pytest.approx(0.023 + 0.022 * 9.525e-3 * cos(radians(15.0)))
    assert B7206C.rest == pytest.approx((0.044 * 9.525e-3 * sin(radians(15.0)), 0.044 * 9.525e-3 * cos(radians(15.0))))
    assert B7206C.offset_inner + B7206C.offset_outer == pytest.approx(B7206C.centre_distance)


def test_curvatures():
    g, f, d = 9.525 * cos(radians(15.0)) / 46.0, 0.522, 9.525e-3
    inner, outer = B7206C.ellipses(MODULUS)
    assert inner.curvature_sum == pytest.approx((4 - 1 / f + 2 * g / (1 - g)) / d)
    assert outer.curvature_sum == pytest.approx((4 - 1 / f - 2 * g / (1 + g)) / d)
    assert inner.curvature_difference == pytest.approx((1 / f + 2 * g / (1 - g)) / (4 - 1 / f + 2 * g / (1 - g)))
    assert outer.curvature_difference == pytest.approx((1 / f - 2 * g / (1 + g)) / (4 - 1 / f - 2 * g / (1 + g)))


def test_load_factors_equal_the_reference():
    ring = Ring(9.525e-3, 46e-3, 12, radians(15.0), 0.522, 0.522)
    inner, outer = B7206C.ellipses(MODULUS)
    assert [inner.factor, outer.factor] == pytest.approx([ring.ki, ring.ko], rel=1e-8)  # quadrature to 1e-11


def test_clearance_sets_the_contact_angle(built):
    groove = {
        "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": 9, "conformity_inner": 0.52,
        "conformity_outer": 0.53, "radial_clearance": 15e-6,
    }  # fmt: skip
    model = built(bearing={**groove, "preset": "B7206C", "contact_angle_deg": 0.0})
    assert model.geometry.contact_angle == pytest.approx(acos(1.0 - 15e-6 / (2.0 * 0.05 * 9.525e-3)))
    # At rest and pushed radially by half the diametral clearance, the ball on that side touches and no other does.
    touching = model.system.evaluate(np.array([-model.geometry.rest[0], 7.5e-6, 0.0, 0.0, 0.0])).gap
    assert abs(touching[0] + touching[9]) < 1e-12
    assert (touching[1:9] + touching[10:] > 1e-8).all()


def test_cage_and_ball():
    assert B7206C.cage_speed(1000.0) == pytest.approx(500.0 * (1.0 - 9.525 * cos(radians(15.0)) / 46.0))
    assert B7206C.ball_mass(7810.0) == pytest.approx(7810.0 * pi / 6.0 * 9.525e-3**3)


YOUNG, NU = 212e9, 0.29


def displacement(a, b, along):
    """Of the centre [m] under the no-slip traction of 1 N: u = 1 / (2 pi G) int q ((1 - nu) / s + nu cos^2 / s) dA.  Along a
    ray of length R(theta) the traction q0 / sqrt(1 - s^2 / R^2) integrates to q0 pi R / 2, with q0 = 1 / (2 pi a b)."""

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
