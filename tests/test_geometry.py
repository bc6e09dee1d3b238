"""Lengths and curvatures of a bearing against physics.md section 2, written out once more."""

from __future__ import annotations

from math import acos, cos, pi, radians, sin

import numpy as np
import pytest

from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import contact_modulus
from validation.reference.ring import Ring

MODULUS = contact_modulus(212e9, 0.29, 212e9, 0.29)
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
