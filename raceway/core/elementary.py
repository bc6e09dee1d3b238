"""Exponential and logarithm as plain arithmetic: loops that call those of the C library are not vectorised."""

from math import factorial

import numpy as np
from numba import float64

from raceway.core.jit import jit

#: Added to a number, it leaves the nearest whole one, up to 2^51 in size, in the last bits.
_ROUND = 1.5 * 2.0**52
#: Bits of 1, and of sqrt(1/2), where mantissas begin here.
_ONE, _ROOT, _ROUND_BITS = (int(np.float64(number).view(np.int64)) for number in (1.0, np.sqrt(0.5), _ROUND))
#: log 2 in two parts, of which the first has 33 digits, so that its multiples are exact.
_LOG_2, _LOG_2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_EXPONENTIAL = tuple(1.0 / factorial(k) for k in (12, 13, 10, 11, 8, 9, 6, 7, 4, 5, 2, 3, 0, 1))
_LOGARITHM = tuple(2.0 / k for k in (17, 19, 13, 15, 9, 11, 5, 7, 1, 3))


@jit(float64(float64), inline=True)
def exponential(x):
    """e^x to 1e-15; below -708 that of -708, above 709 that of 709."""
    x = min(max(x, -708.0), 709.0)
    shifted = x * 1.4426950408889634 + _ROUND
    twos = shifted - _ROUND
    x = x - twos * _LOG_2 - twos * _LOG_2_REST
    even, odd, square = 0.0, 0.0, x * x
    for k in range(7):
        even, odd = even * square + _EXPONENTIAL[2 * k], odd * square + _EXPONENTIAL[2 * k + 1]
    return (even + odd * x) * np.int64((np.float64(shifted).view(np.int64) << 52) + _ONE).view(np.float64)


@jit(float64(float64), inline=True)
def logarithm(x):
    """log x to 1e-15, of numbers from 2.2e-308 on; of 0 -709."""
    bits = np.float64(x).view(np.int64)
    twos = (bits - _ROOT) >> 52
    mantissa = np.int64(bits - (twos << 52)).view(np.float64)
    ratio = (mantissa - 1.0) / (mantissa + 1.0)
    square = ratio * ratio
    even, odd, fourth = 0.0, 0.0, square * square
    for k in range(5):
        even, odd = even * fourth + _LOGARITHM[2 * k], odd * fourth + _LOGARITHM[2 * k + 1]
    series = even + square * odd
    twos_ = np.int64(twos + _ROUND_BITS).view(np.float64) - _ROUND
    return twos_ * _LOG_2 + (twos_ * _LOG_2_REST + ratio * series)
