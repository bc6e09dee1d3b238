"""Lanes: every operation against single numbers, in whole blocks and in rests of one to three."""

import math
from fractions import Fraction

import numpy as np
import pytest
from numba import float64, void

from raceway import jit
from raceway.core.lanes import (
    WIDTH,
    any_of,
    column_of,
    larger,
    live_of,
    multiply_add,
    put,
    root,
    rough_power,
    row_of,
    smaller,
    spread,
    sum_of,
    take,
    where,
)
from raceway.core.ring.kernels.rollers import ninth_root
from raceway.core.ring.kernels.rolling import angle_of

#: Relative errors: angles and roots are rounded otherwise than by the C library.
ROUNDED = {"angle": 4.5e-16, "rough power": 0.06, "ninth root": 4.5e-16}
#: What ``_operations`` writes into its rows, of two rows of numbers x and y.
ROWS = {
    "sum": lambda x, y: x + y, "difference": lambda x, y: x - y, "product": lambda x, y: x * y, "quotient": lambda x, y: x / y,
    "of the number before": lambda x, _: 2.0 - x, "of the number behind": lambda x, _: x / 3.0, "negative": lambda x, _: -x,
    "root": lambda x, _: np.sqrt(np.abs(x)), "larger": np.maximum, "smaller": np.minimum,
    "less": lambda x, y: 1.0 * (x < y), "not more": lambda x, y: 1.0 * (x <= y), "more": lambda x, y: 1.0 * (x > y),
    "not less": lambda x, y: 1.0 * (x >= y), "equal": lambda x, y: 1.0 * (x == y), "both": lambda x, y: 1.0 * ((x > 0.0) & (y > 0.0)),
    "not": lambda x, _: 1.0 * ~(x > 0.0), "added to": lambda x, y: x + y, "number": lambda x, _: np.full_like(x, 7.0),
    "angle": np.vectorize(math.atan2), "either": lambda x, y: 1.0 * ((x > 0.0) | (y > 0.0)),
    "chosen": lambda x, y: np.where(x < y, x, y + 1.0), "rounded once": np.vectorize(lambda x, y: float(Fraction(x) * Fraction(y) - Fraction(x * y))),
    "rough power": lambda x, _: np.abs(x) ** -0.3, "ninth root": lambda x, _: np.abs(x) ** (1.0 / 9.0), "of a vector": lambda x, _: x,
}  # fmt: skip


@jit(void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[::1]))
def _operations(given, columns, out, single):
    n, total = given.shape[1], spread(0.0)
    for k in range(0, n, WIDTH):
        live = live_of(k, n)
        x, y = take(given, 0, k, live), take(given, 1, k, live)
        put(out, 0, k, live, x + y)
        put(out, 1, k, live, x - y)
        put(out, 2, k, live, x * y)
        put(out, 3, k, live, x / y)
        put(out, 4, k, live, 2.0 - x)
        put(out, 5, k, live, x / 3.0)
        put(out, 6, k, live, -x)
        put(out, 7, k, live, root(larger(x, -x)))
        put(out, 8, k, live, larger(x, y))
        put(out, 9, k, live, smaller(x, y))
        put(out, 10, k, live, where(x < y, 1.0, 0.0))
        put(out, 11, k, live, where(x <= y, 1.0, 0.0))
        put(out, 12, k, live, where(x > y, 1.0, 0.0))
        put(out, 13, k, live, where(x >= y, 1.0, 0.0))
        put(out, 14, k, live, where(x == y, 1.0, 0.0))
        put(out, 15, k, live, where((x > 0.0) & (y > 0.0), 1.0, 0.0))
        put(out, 16, k, live, where(~(x > 0.0), 1.0, 0.0))
        added = x
        added += y
        put(out, 17, k, live, added)
        put(out, 18, k, live, 7.0)
        put(out, 19, k, live, angle_of(x, y))
        put(out, 20, k, live, where((x > 0.0) | (y > 0.0), 1.0, 0.0))
        put(out, 21, k, live, where(x < y, x, y + 1.0))
        put(out, 22, k, live, multiply_add(x, y, -(x * y)))
        put(out, 23, k, live, rough_power(larger(x, -x), -0.3))
        put(out, 24, k, live, ninth_root(larger(x, -x)))
        put(out, 25, k, live, take(row_of(given[0]), 0, k, live))
        total += where(live, column_of(columns, k, 1, live), 0.0)
        if any_of(live & (x > 1e3)):
            single[1] += 1.0
    single[0] = sum_of(total)


@pytest.mark.parametrize("n", range(1, 10))
def test_every_lane_is_the_arithmetic_of_its_numbers(n):
    """To the last bit; nothing is written, added or found beyond the row."""
    x, y = np.random.default_rng(n).normal(size=(2, n))
    y[n // 2] = x[n // 2]
    out, columns = np.zeros((len(ROWS) + 1, n)), np.arange(3.0 * n).reshape(n, 3)
    single = np.zeros(2)
    _operations(np.array([x, y, np.full(n, 1e6)]), columns, out, single)
    for row, (name, expected) in zip(out, ROWS.items(), strict=False):
        np.testing.assert_allclose(row, expected(x, y), rtol=ROUNDED.get(name, 0.0), atol=0.0, err_msg=name)
    assert not out[-1].any()
    assert single[0] == columns[:, 1].sum() and single[1] == 0.0


def test_angles_all_around():
    """Sixteenths of a turn, where the function changes its form, and beside them; none has the angle 0."""
    turn = np.repeat(np.arange(-8.0, 9.0) * np.pi / 8.0, 3) + np.tile([-1e-9, 0.0, 1e-9], 17)
    x, y = np.append(3.0 * np.sin(turn), 0.0), np.append(3.0 * np.cos(turn), 0.0)
    out = np.zeros((len(ROWS) + 1, len(x)))
    _operations(np.array([x, y]), np.zeros((len(x), 2)), out, np.zeros(2))
    np.testing.assert_allclose(out[list(ROWS).index("angle")], np.arctan2(x, y), rtol=4.5e-16)


def test_ninth_roots_of_small_and_large_numbers():
    """Half a unit in the last place, 1.1e-16, would be the rounding of the exact root; 0 has the root 0."""
    x = np.concatenate([np.geomspace(1e-280, 1e280, 4001), np.geomspace(1e-6, 1.5e-6, 4001)])
    out = np.zeros((len(ROWS) + 1, len(x) + 1))
    _operations(np.array([[0.0, *x], np.ones(len(x) + 1)]), np.zeros((len(x) + 1, 2)), out, np.zeros(2))
    found = out[list(ROWS).index("ninth root")]
    assert found[0] == 0.0
    exact = x.astype(np.longdouble) ** (np.longdouble(1) / 9)
    assert np.abs(found[1:] / exact - 1.0).max() < 1.9e-16


def test_no_number_is_less_more_or_equal():
    """Beside NaN the second one is larger and smaller, as kernels have it of single numbers."""
    x, y, nan = np.array([np.nan, 1.0, np.nan, np.inf]), np.array([1.0, np.nan, np.nan, np.inf]), np.nan
    out = np.zeros((len(ROWS) + 1, 4))
    _operations(np.array([x, y]), np.zeros((4, 2)), out, np.zeros(2))
    found = dict(zip(ROWS, out, strict=False))
    for name in ("larger", "smaller"):
        np.testing.assert_array_equal(found[name], [1.0, nan, nan, np.inf])
    for name, last in (("less", 0.0), ("more", 0.0), ("not more", 1.0), ("not less", 1.0), ("equal", 1.0)):
        np.testing.assert_array_equal(found[name], [0.0, 0.0, 0.0, last])
    np.testing.assert_array_equal(found["chosen"], [2.0, nan, nan, np.inf])


def test_sums_add_neighbours_first_and_one_lane_is_enough_to_be_found():
    out, single = np.zeros((len(ROWS) + 1, 4)), np.zeros(2)
    columns = np.array([[0.0, value] for value in (1e16, 1.0, -1e16, 1.0)])
    _operations(np.array([[0.0, 0.0, 2e3, 0.0], 4 * [1.0]]), columns, out, single)
    assert single[0] == (1e16 + 1.0) + (-1e16 + 1.0) != columns[:, 1].sum() and single[1] == 1.0
