"""The load at which an ellipse reaches the groove's edge: its semi-major axis at that load is the way to the edge."""

import pytest

from raceway.testing import load_at_edge


@pytest.mark.parametrize("angle", [0.05, 0.2, 0.5])
def test_the_ellipse_at_that_load_ends_at_the_edge(built, angle):
    model = built()
    radius = 0.5 * model.geometry.ball_diameter
    for ellipse in (model.inner, model.outer):
        load = load_at_edge(ellipse, radius, angle)
        assert float(ellipse.semi_axes(load)[0]) == pytest.approx(radius * angle, rel=1e-12)


def test_beyond_the_edge_no_load_is_left(built):
    assert load_at_edge(built().inner, 5e-3, -0.1) == 0.0
