"""Stresses between the centres of elements: polynomials exactly, Hertz's field to what the documents say."""

import numpy as np
import pytest

from checks.validation.reference.half_space import pressed_stress
from raceway.core.contact.hertz import largest_shear
from raceway.core.fem.elastic.stress import StressFit, StressProfile
from raceway.extend import axis_stresses

#: Ellipse of a ball bearing's contact, and steel.
SEMI_AXES, NU = (8.0, 1.0), 0.3


def below_a_surface(along, across, first, growth, layers=12, lanes=4, beside=0.0):
    """Centres and lengths of bricks below z = 0, the axis ``beside`` (in elements) an edge."""
    thick = first * growth ** np.arange(layers)
    ends = np.r_[0.0, np.cumsum(thick)]
    lane = np.arange(-lanes, lanes) + 0.5 + beside
    grid = np.meshgrid(along * lane, across * lane, 0.5 * (ends[1:] + ends[:-1]), indexing="ij")
    sizes = np.meshgrid(np.full(2 * lanes, along), np.full(2 * lanes, across), thick, indexing="ij")
    return (np.stack(one, axis=-1).reshape(-1, 3) for one in (grid, sizes))


@pytest.mark.parametrize("growth", [1.0, 1.3, 1.7])
def test_polynomials_are_met_exactly_inside_and_at_the_surface(growth):
    centres, lengths = below_a_surface(2.0, 0.5, 0.4, growth, beside=0.2)

    def field(x):
        a, b, c = x.T
        return np.stack([1.0 + a - 2.0 * b + c + a * b - b * c + 3.0 * a * a, b * b + c * c - 0.2 * c**3], axis=1)

    depth = np.linspace(0.0, 3.0, 13)
    where = np.stack([0.3 + 0.0 * depth, -0.1 + 0.0 * depth, depth], axis=1)
    fit = StressFit(centres, lengths, field(centres))
    assert fit.at(where) == pytest.approx(field(where), rel=1e-9, abs=1e-9)


def recovered(cells, growth, beside):
    """Relative errors of size and depth from an exact field, and elements down to Hertz's depth."""
    centres, lengths = below_a_surface(SEMI_AXES[0] / cells, 1.0 / cells, 1.0 / cells, growth, beside=beside)
    stress = pressed_stress(centres, SEMI_AXES, 1.0, NU, (32, 128))
    shear, depth = largest_shear(SEMI_AXES, 1.0, NU)
    line = np.zeros((121, 3))
    line[:, 2] = np.linspace(0.0, 3.0 * depth, 121)
    fit = StressFit(centres, lengths, stress)
    profile = StressProfile(line[:, 2], fit.at(line), fit.lengths_at(line))
    found, at = profile.largest()
    return abs(found / shear - 1.0), abs(at / depth - 1.0), profile.cells_to(depth)


@pytest.mark.parametrize("beside", [0.0, 0.3])
def test_hertz_s_field_is_recovered_to_what_the_documents_say(beside):
    """docs/elastic.md: 1 % and 6 % from 2.4 elements down to the largest shear, 0.4 % and 1.5 % from 4; elements grow by 1.3."""
    for cells, fewest, size, place in ((4, 2.4, 0.01, 0.06), (8, 3.9, 0.004, 0.015)):
        shear, depth, down = recovered(cells, 1.3, beside)
        assert down > fewest
        assert shear < size and depth < place


def test_the_error_falls_by_the_order_of_the_fit():
    """Of a quadratic fit third order; between 3 and 6 elements a semi-axis at least second, measured 3 and more."""
    coarse, fine = recovered(3, 1.0, 0.3)[0], recovered(6, 1.0, 0.3)[0]
    assert coarse > 4.0 * fine


def test_a_profile_s_top_is_hertz_s_on_hertz_s_line():
    shear, depth = largest_shear(SEMI_AXES, 1.0, NU)
    z = np.linspace(0.0, 3.0 * depth, 121)
    stress = np.concatenate([axis_stresses(z, SEMI_AXES, 1.0, NU), np.zeros((121, 3))], axis=1)
    found, at = StressProfile(z, stress, np.full((121, 3), 1e-6)).largest()
    assert found == pytest.approx(shear, rel=3e-4) and at == pytest.approx(depth, rel=2e-3)  # of a quartic, see the module


def test_few_centres_give_what_they_have():
    """Fewer than coefficients: the fit of the least norm, no failure."""
    centres = np.random.default_rng(0).random((5, 3))
    found = StressFit(centres, np.ones((5, 3)), np.full((5, 2), 7.0)).at(np.full((1, 3), 0.5))
    assert np.isfinite(found).all()
