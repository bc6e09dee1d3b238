"""The force of line contacts."""

from raceway.core.jit import jit
from raceway.core.lanes import (
    LANES,
    WIDTH,
    any_of,
    column_of,
    larger,
    live_of,
    multiply_add,
    put,
    rough_power,
    row_of,
    spread,
    take,
)
from raceway.core.signatures import LAW


@jit(LANES(LANES), inline=True)
def ninth_root(x):
    """x^(1/9) of x >= 0, but for its last digit.

    From z near x^(-1/9): by its series z (1 + h / 9 + ...) in h = 1 - x z^9, then by that of the root, x z^8 (1 + 8 h / 9 + ...).
    """
    z = rough_power(larger(x, 1e-290), -1.0 / 9.0)
    z4 = z * z * (z * z)
    h = multiply_add(-x * z, z4 * z4, 1.0)
    series = multiply_add(h, multiply_add(h, spread(665.0 / 19683.0), 95.0 / 2187.0), 5.0 / 81.0)
    z = multiply_add(z * h, multiply_add(h, series, 1.0 / 9.0), z)
    z4 = z * z * (z * z)
    y = x * (z4 * z4)
    h = multiply_add(-y, z, 1.0)
    series = multiply_add(h, multiply_add(h, spread(15470.0 / 19683.0), 1768.0 / 2187.0), 68.0 / 81.0)
    return multiply_add(y * h, multiply_add(h, series, 8.0 / 9.0), y)


@jit(LAW)
def ten_ninths(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Q = k delta^(10/9)."""
    gaps, forces, by_gap, by_rate = row_of(gap), row_of(force), row_of(d_gap), row_of(d_rate)
    for k in range(0, gap.size, WIDTH):
        live = live_of(k, gap.size)
        approach = larger(-take(gaps, 0, k, live), 0.0)
        slope = spread(0.0)
        if any_of(approach > 0.0):
            slope = column_of(params, k, 0, live) * ninth_root(approach)
        put(forces, 0, k, live, slope * approach)
        put(by_gap, 0, k, live, (-10.0 / 9.0) * slope)
        put(by_rate, 0, k, live, 0.0)
