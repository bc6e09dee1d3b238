"""Structural compliances of rings and balls against closed forms, symmetry and the published split of one contact."""

import attrs
import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.core.contact.hertz import ball_compliance
from raceway.core.fem.structural import (
    between_grooves,
    first_frequency,
    half_space,
    line_load_weights,
    reach,
    ring_compliance,
)
from raceway.extend import ring_shape
from raceway.testing import b7206c

YOUNG, POISSON = 212e9, 0.29
HALF = 0.82e-3  # semi-major axis of a contact of B7206C at some 300 N [m]


@pytest.fixture(scope="module")
def bearing():
    return scene_from_dict(b7206c()).bearing


@pytest.fixture(scope="module")
def rings(bearing):
    """Inner and outer ring, the sizes of a scene without [mesh]."""
    shapes = [ring_shape(bearing, inner) for inner in (True, False)]
    return [ring_compliance(s, bearing.ball_diameter, 12, HALF, YOUNG, POISSON) for s in shapes]


def test_nodal_weights_carry_force_and_place_of_the_line():
    places = np.sort(np.random.default_rng(1).uniform(-1.0, 1.0, 40))
    weights = line_load_weights(places, 0.1, 0.3)
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)
    # Linear functions are kept by linear shape functions, whatever the nodes.
    assert weights @ places == pytest.approx(0.1, abs=1e-14)


def test_half_space_far_below_a_line_is_that_of_a_point():
    """u = (1 + nu) (3 - 2 nu) / (2 pi E z); a line of half length a deviates by (a / z)^2 of the order of one."""
    z = np.array([10e-3])
    point = (1.0 + POISSON) * (3.0 - 2.0 * POISSON) / (2.0 * np.pi * YOUNG * z)
    assert half_space(z, 0.05e-3, YOUNG, POISSON) == pytest.approx(point, rel=1e-4)


def test_rings_agree_with_the_published_split(rings):
    """-0.60 and -0.62 nm/N at 18.65 deg by another program; 0.03 is what the mesh of a scene leaves."""
    for ring, expected in zip(rings, (-0.60e-9, -0.62e-9), strict=True):
        assert np.interp(np.radians(18.65), ring.angles, ring.direct) == pytest.approx(expected, abs=0.03e-9)


def test_the_groove_is_symmetric(rings):
    """Both lands of this preset are alike: compliance at -angle equals that at +angle, to rounding of a mapped mesh."""
    for ring in rings:
        assert ring.direct == pytest.approx(ring.direct[::-1], rel=0.05)


def test_clamped_rings_do_not_join_their_balls_but_soft_seats_do(bearing, rings):
    """2e-12 m/N on rigid seats; on 500 N/mm3 self 5.0, next ball 0.77 nm/N (published), with the mesh's few per cent."""
    assert max(np.abs(ring.across[:, :, 1:]).max() for ring in rings) < 0.01e-9
    soft = ring_compliance(ring_shape(bearing, False), bearing.ball_diameter, 12, HALF, YOUNG, POISSON, 5e11)
    at = int(np.argmin(np.abs(soft.angles - np.radians(18.0))))
    assert soft.direct[at] == pytest.approx(5.02e-9, rel=0.03)
    assert soft.across[at, at, 1] == pytest.approx(0.77e-9, rel=0.08)
    assert soft.across[:, :, 1] == pytest.approx(soft.across[:, :, -1], abs=1e-13)
    # Betti: load and displacement may change places; 1 % of the mean over depths below one and the line load at the other.
    assert soft.across[:, :, 1] == pytest.approx(soft.across[:, :, 1].T, abs=0.01 * soft.direct[at])


def test_what_a_contact_feels_of_another_ball_is_a_motion_of_its_groove_centre(bearing):
    """n.M n' of three numbers for all pairs of contact angles within the width of the fit: to 0.03 nm/N, 0.3 % of what a contact gives."""
    soft = ring_compliance(ring_shape(bearing, True), bearing.ball_diameter, 12, HALF, YOUNG, POISSON, 5e11)
    near = np.flatnonzero(np.abs(soft.angles - 0.3) < 0.2)
    found = between_grooves(soft, np.full(12, 0.3))
    n = np.column_stack([np.sin(soft.angles), np.cos(soft.angles)])[near]
    for k in (1, 2, 6):
        matrix = found[k][[0, 1, 1, 2]].reshape(2, 2)
        assert np.abs(n @ matrix @ n.T - soft.across[np.ix_(near, near, [k])][..., 0]).max() < 0.03e-9


def test_compliance_falls_with_young_and_size(bearing):
    """Twice as stiff: half; a bearing twice as large, elements too: half, as 1 / (E L) asks."""
    shape = ring_shape(bearing, True)
    sizes = {"bulk": 2e-3, "surface": 0.8e-3, "around": 1.6e-3}
    one, stiff = (
        ring_compliance(shape, bearing.ball_diameter, 12, HALF, young, POISSON, **sizes) for young in (YOUNG, 2.0 * YOUNG)
    )
    assert stiff.direct == pytest.approx(0.5 * one.direct, rel=1e-9)
    lengths = ("bore", "outer_diameter", "width", "ball_diameter", "pitch_diameter", "shoulder_height")
    large = attrs.evolve(bearing, **{k: 2.0 * getattr(bearing, k) for k in lengths if getattr(bearing, k) is not None})
    sizes = {name: 2.0 * size for name, size in sizes.items()}
    twice = ring_compliance(ring_shape(large, True), large.ball_diameter, 12, 2.0 * HALF, YOUNG, POISSON, **sizes)
    assert reach(ring_shape(large, True), large.ball_diameter) == pytest.approx(2.0 * reach(shape, bearing.ball_diameter))
    assert twice.direct == pytest.approx(0.5 * one.direct, rel=1e-6)


def test_ball_agrees_with_finite_elements():
    """-0.304 and 0.167 nm/N by finite elements of another program, at loads of 300 to 1000 N: 0.03 apart."""
    own, opposite = ball_compliance(4.7625e-3, YOUNG, POISSON, HALF, 0.113e-3)
    assert own == pytest.approx(-0.304e-9, abs=0.03e-9)
    assert opposite == pytest.approx(0.167e-9, abs=0.005e-9)
    # It scales with Young's modulus and radius.
    one = np.array(ball_compliance(4e-3, YOUNG, POISSON, 0.6e-3, 0.1e-3))
    assert np.array(ball_compliance(8e-3, 0.5 * YOUNG, POISSON, 1.2e-3, 0.2e-3)) == pytest.approx(one, rel=1e-12)


def test_first_frequencies_of_rings(bearing):
    """10.5 kHz free, 133 kHz with its bore tied (published, other lands): 10 % for the lands of this preset."""
    shape = ring_shape(bearing, True)
    steel = (YOUNG, POISSON, 7810.0)
    assert first_frequency(shape, bearing.ball_diameter, *steel, "free") == pytest.approx(10.5e3, rel=0.1)
    assert first_frequency(shape, bearing.ball_diameter, *steel, "clamped") == pytest.approx(133e3, rel=0.1)
