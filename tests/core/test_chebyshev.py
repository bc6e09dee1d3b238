"""Interpolation between Chebyshev nodes: exact where it is used, and used where it saves something."""

import numpy as np
import pytest

from raceway.core.columns import interpolated


class Counted:
    """A function that knows at how many points it was asked."""

    def __init__(self, function):
        self.function, self.points = function, 0

    def __call__(self, points):
        self.points += points.shape[1]
        return self.function(points)


def smooth(points):
    x, y, z = points
    return np.exp(0.3 * x) / (2.0 + y + 0.1 * z)


@pytest.fixture
def points():
    points = np.random.default_rng(3).uniform(0.0, 1.0, (3, 2000))
    points[2] = 0.5
    return points


def test_a_smooth_function_of_many_points_is_asked_at_few(points):
    """A constant is no variable: 9, 25, 81 nodes, each time compared at 8 points."""
    function = Counted(smooth)
    values = interpolated(function, points, 1e-8)
    np.testing.assert_allclose(values, smooth(points), rtol=1e-8)
    assert function.points <= 9 + 25 + 81 + 3 * 8


def test_a_function_with_a_kink_is_asked_at_every_point(points):
    def kinked(points):
        return 1.0 + np.abs(points[0] - 0.4)

    np.testing.assert_array_equal(interpolated(kinked, points, 1e-8), kinked(points))


@pytest.mark.parametrize("count", [1, 2, 17])
def test_few_points_are_asked_themselves(points, count):
    few = points[:, :count]
    np.testing.assert_array_equal(interpolated(smooth, few, 1e-8), smooth(few))


def test_points_that_repeat_are_asked_once(points):
    function, few = Counted(smooth), points[:, :5]
    np.testing.assert_array_equal(interpolated(function, np.tile(few, 40), 1e-8), np.tile(smooth(few), 40))
    assert function.points == 5
