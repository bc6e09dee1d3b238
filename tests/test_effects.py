"""The factorial analysis against functions whose effects are known."""

import math
from itertools import product

import numpy as np
import pytest

from raceway.extend import trend
from raceway.points.effects import Factorial, complete_factorial, factorial_effects

ROUNDING = 1e-13  # a few additions of numbers of order 1


def test_known_effects_are_found():
    a, b, ab, abc = 0.7, -0.2, 0.05, 0.013
    y = np.zeros((2, 2, 2))
    for i, j, k in product((0, 1), repeat=3):
        s, t, u = 2 * i - 1, 2 * j - 1, 2 * k - 1
        y[i, j, k] = 3.0 + 0.5 * (a * s + b * t + ab * s * t + abc * s * t * u)
    found = factorial_effects(y)
    expected = {(0, 0, 0): 3.0, (1, 0, 0): a, (0, 1, 0): b, (1, 1, 0): ab, (1, 1, 1): abc}
    for place in product((0, 1), repeat=3):
        assert found[place] == pytest.approx(expected.get(place, 0.0), abs=ROUNDING)


@pytest.mark.parametrize("k", [1, 2, 5, 8])
def test_effects_reproduce_every_corner(k):
    y = np.random.default_rng(k).normal(size=(2,) * k)
    corners = 0.5 * factorial_effects(y)
    corners[(0,) * k] *= 2.0
    for place in range(k):
        mean, half = np.take(corners, 0, axis=place), np.take(corners, 1, axis=place)
        corners = np.stack([mean - half, mean + half], axis=place)
    assert np.abs(corners - y).max() < ROUNDING * 2**k


def test_main_effect_is_the_difference_of_means_and_interaction_half_the_difference_of_effects():
    y = np.array([[1.0, 4.0], [2.0, 11.0]])
    found = factorial_effects(y)
    assert found[1, 0] == pytest.approx((2 + 11) / 2 - (1 + 4) / 2)
    assert found[1, 1] == pytest.approx(0.5 * ((11 - 4) - (2 - 1)))


def test_causes_that_multiply_do_not_interact():
    corners = 1e8 * np.multiply.outer([1.0, 0.8], [1.0, 1.5])
    effects = {e.term: e for e in Factorial(("a", "b"), corners).effects}
    assert effects["a",].percent == pytest.approx(-20.0)
    assert effects["b",].percent == pytest.approx(50.0)
    assert effects["a",].difference == pytest.approx(1e8 * (0.8 * 1.25 - 1.25))
    assert effects["a", "b"].log_change == pytest.approx(0.0, abs=ROUNDING)
    assert sum(e.share for e in effects.values()) == pytest.approx(1.0)


def test_effects_are_sorted_and_the_change_at_a_level_adds_the_interaction():
    factorial = Factorial(("a", "b"), np.exp(np.array([[1.0, 4.0], [2.0, 11.0]])))
    sizes = [abs(e.log_change) for e in factorial.effects]
    assert sizes == sorted(sizes, reverse=True)
    by_term = {e.term: e.log_change for e in factorial.effects}
    assert factorial.log_change("a", {"b": 1}) == pytest.approx(by_term["a",] + by_term["a", "b"])
    assert factorial.log_change("a", {"b": 0}) == pytest.approx(by_term["a",] - by_term["a", "b"])
    assert factorial.log_change("a") == pytest.approx(by_term["a",])


def test_equal_corners_have_no_effect_and_no_share():
    for effect in Factorial(("a", "b"), np.full((2, 2), 7.0)).effects:
        assert effect.log_change == 0.0 and effect.share == 0.0 and math.isfinite(effect.percent)


def test_no_true_effect_lies_beyond_the_bound_of_the_errors():
    random = np.random.default_rng(3)
    true, errors = np.exp(random.normal(size=(2, 2, 2))), 0.3 * random.random((2, 2, 2))
    exact = {e.term: e.log_change for e in Factorial(("a", "b", "c"), true).effects}
    reached = 0.0
    for signs in product((-1.0, 1.0), repeat=8):
        seen = Factorial(("a", "b", "c"), true / (1.0 + np.reshape(signs, (2, 2, 2)) * errors), errors)
        assert abs(seen.log_change("b") - exact["b",]) <= seen.log_error("b") == pytest.approx(seen.error)
        reached = max(reached, *(abs(e.log_change - exact[e.term]) / seen.error for e in seen.effects))
    assert 0.8 < reached <= 1.0  # ln(1 + r) and -ln(1 - r) differ by r, 0.3 at most


def test_an_effect_is_judged_against_the_errors():
    corners = np.array([[1.0, 0.1], [1.001, 0.101]])
    factorial = Factorial(("a", "b"), corners, np.array([[0.0, 0.02], [0.0, 0.0]]))
    assert factorial.error == pytest.approx(-0.5 * math.log(0.98))
    resolved = {e.term: e.resolved for e in factorial.effects}
    assert resolved == {("b",): True, ("a",): False, ("a", "b"): False}
    # The change along a is known where b is at its first value, whatever the other end's error.
    assert factorial.resolved_change("a", {"b": 0}) == pytest.approx(math.log(1.001))
    assert factorial.resolved_change("a", {"b": 1}) == factorial.resolved_change("a") == 0.0


def test_the_largest_part_without_holes_holds_the_last_axes():
    usable = np.ones((2, 2, 2), dtype=bool)
    assert complete_factorial(usable) == (None, None, None)
    usable[0, 1, 0] = False
    assert complete_factorial(usable) == (None, None, 1)
    usable[1, 1, 1] = False
    assert complete_factorial(usable) == (None, 0, None)
    usable[1, 0, 1] = usable[0, 0, 0] = False
    part = complete_factorial(usable)
    assert sum(end is not None for end in part) == 2
    assert usable[tuple(slice(None) if end is None else end for end in part)].all()
    assert complete_factorial(np.zeros((2, 2), dtype=bool)) is None


@pytest.mark.parametrize(
    ("values", "errors", "expected"),
    [
        ([1, 2, 3], [0, 0, 0], "rises"),
        ([3, 2, 1], [0, 0, 0], "falls"),
        ([1, 3, 2], [0, 0, 0], "not monotonic"),
        ([1, 1.001, 1], [1e-3, 1e-3, 1e-3], "level"),
        ([1, 1.0015], [1e-3, 1e-3], "level"),  # within both errors together
        ([1, 1.001, 2], [1e-3, 1e-3, 1e-3], "rises"),
        ([1, 1.001, 1.002, 1.003], [1e-3, 1e-3, 1e-3, 1e-3], "rises"),  # no step does, the whole does
        ([1, 0.99, 1.02], [1e-3, 0.2, 1e-3], "rises"),  # over one that is hardly known
    ],
)
def test_trend(values, errors, expected):
    assert trend(values, errors) == expected
