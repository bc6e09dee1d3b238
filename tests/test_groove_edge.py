"""The load at which an ellipse reaches the groove's edge: its semi-major axis at that load is the way to the edge."""

import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.testing import load_at_edge, run


@pytest.mark.parametrize("angle", [0.05, 0.2, 0.5])
def test_the_ellipse_at_that_load_ends_at_the_edge(built, angle):
    model = built()
    radius = 0.5 * model.geometry.ball_diameter
    for ellipse in (model.inner, model.outer):
        load = load_at_edge(ellipse, radius, angle)
        assert float(ellipse.semi_axes(load)[0]) == pytest.approx(radius * angle, rel=1e-12)


def test_beyond_the_edge_no_load_is_left(built):
    assert load_at_edge(built().inner, 5e-3, -0.1) == 0.0


def test_the_warning_of_a_race_is_of_its_own_load():
    """Fast balls load the outer race by several times what the inner one carries."""
    bearing = {"preset": "B7206C", "shoulder_height": 1e-4}
    result = run(scene_from_dict({"bearing": bearing, "load": {"axial": 300.0}, "kinematics": {"spin_speed_rpm": 4e4}}))
    (words,) = [text for text in result.warnings if "on the outer race reaches" in text]
    ball, radius = result.to_dict()["equilibrium"]["balls"][0], 0.5 * result.model.geometry.ball_diameter
    end = abs(ball["contact_angle_outer_deg"]) + np.degrees(ball["semi_major_outer_m"] / radius)
    assert f"reaches {end:.1f} deg" in words and ball["load_outer_n"] > 2.0 * ball["load_inner_n"]
