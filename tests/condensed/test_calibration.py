"""Calibration of contact resultants at surface points: limits, whole bearings of thin walls, and what is told of it."""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from raceway.core.condensed.calibration import LOADS, POINTS, _limit
from tests.condensed.test_bearing import settled

#: Walls of 1.24 mm.
THIN = {"preset": "B7206C", "bore": 34e-3, "outer_diameter": 58e-3}


def test_limit_takes_away_an_error_of_order_two_and_gives_the_tangent():
    """Of c = c0 + t log(Q / Q0) with errors 1 / n^2: secants become exact, the tangent d(c Q) / dQ is c0 + t."""
    nodes = np.array(POINTS)[:, None]
    values = -1e-9 + 2e-11 * np.log(LOADS) + 3e-9 / nodes**2
    found = _limit(np.array([values, values + 1e-10]), 0.26, 200.0)
    assert found.compliance == pytest.approx([-0.98e-9, -0.88e-9], rel=1e-12)
    assert found.trend == pytest.approx(2e-11, rel=1e-9)
    assert found.left == pytest.approx(3e-9 / POINTS[1] ** 2, rel=1e-9)
    # At the typical load the tangent is right and the secant off by the trend.
    assert found.error(np.array([200.0])) == pytest.approx(found.left + found.trend)


@pytest.mark.parametrize("tilt", ["locked", "free"])
def test_thin_walls_are_within_what_is_stated_of_pressures_at_surface_points(tilt):
    """Four points along a semi-axis are 0.6 % softer than their limit; matched at depth alone kyy was 3.5 % too high."""
    model, ours = settled(bearing=THIN, supports={"tilt": tilt})
    _, theirs = settled(
        bearing=THIN, supports={"tilt": tilt}, contact={"kind": "unilateral", "discretisation": "nodal"},
        mesh={"kind": "structured", "nodes_per_semi_axis": 4},
    )  # fmt: skip
    stated, how = model.bearing.contact_error(model, ours)
    assert "surface points" in how and 0.005 < stated < 0.02
    for index in range(3):
        assert ours.stiffness[index, index] == pytest.approx(theirs.stiffness[index, index], rel=stated + 0.006)
    matched = attrs.evolve(model.bearing.compliances, calibrations=(None, None))
    assert matched.at(0.3)[0] < 1.08 * model.bearing.compliances.at(0.3)[0]


def test_the_calibration_holds_for_both_signs_of_the_angle():
    """Both lands of this preset are alike."""
    bodies = settled()[0].bearing.compliances
    assert bodies.own(0, np.array([-0.3])) - bodies.own(0, np.array([0.3])) == pytest.approx(0.0, abs=0.01e-9)
