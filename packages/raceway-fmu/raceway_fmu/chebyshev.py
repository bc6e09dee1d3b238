"""Chebyshev series of several quantities over a box of inputs, with their error at points that no fit used.

Notes
-----
f(x_1 ... x_d) = sum of c_ij.. T_i(t_1) T_j(t_2) ..., each t the input, or its logarithm, mapped to -1 ... 1.  Coefficients interpolate at
the roots of T_n of each axis.  Control points are the n + 1 extremes of T_n, ends and corners included, between which the roots
lie and where errors of interpolation are largest, and a Sobol sequence in the box.

References
----------
Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3, 4 and 8.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import attrs
import numpy as np
from numpy.polynomial import chebyshev

#: Terms of an axis at first, by how much they grow, and the power of 2 of further control points.
_FIRST, _GROWTH, _SOBOL = 7, 1.5, 10
#: Shares of the tolerance: of the last two terms of an axis that grows no more, and of terms that are dropped.
_ENOUGH, _DROPPED = 0.2, 0.02

#: Values (m, n) of m quantities from the columns of d inputs (n,), and the sizes (m, n) that their errors are divided by.
Quantities = Callable[[list[np.ndarray]], tuple[np.ndarray, np.ndarray]]


@attrs.frozen
class Interval:
    """The range of an input, and whether its logarithm is what polynomials are of."""

    low: float
    high: float
    logarithmic: bool = False

    def at(self, place: np.ndarray) -> np.ndarray:
        """Inputs at places from -1 to 1."""
        share = 0.5 * (place + 1.0)
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** share).clip(self.low, self.high)
        return np.asarray(self.low + share * (self.high - self.low)).clip(self.low, self.high)


@attrs.frozen(eq=False)
class Series:
    """Quantities over a box.

    Attributes
    ----------
    axes : of the inputs;  terms : (m, n_1, ..., n_d) coefficients;  size : (m,) least size of the quantities at the nodes
    error, relative, difference : (m,) largest difference at control points over the size of the quantity, over its value (or 1e-200
        if that changes its sign), and in its unit
    """

    axes: tuple[Interval, ...]
    terms: np.ndarray
    size: np.ndarray
    error: np.ndarray = attrs.field(factory=lambda: np.zeros(0))
    relative: np.ndarray = attrs.field(factory=lambda: np.zeros(0))
    difference: np.ndarray = attrs.field(factory=lambda: np.zeros(0))

    def share(self, axis: int) -> np.ndarray:
        """(n,) largest sum of the terms of one degree of an axis over the least size of the quantity."""
        others = tuple(k for k in range(1, self.terms.ndim) if k != axis + 1)
        return np.asarray(np.max(np.abs(self.terms).sum(axis=others) / self.size[:, np.newaxis], axis=0))

    @property
    def tails(self) -> np.ndarray:
        """Of each axis the last two terms, relative."""
        return np.array([self.share(k)[-2:].sum() for k in range(len(self.axes))])

    def __call__(self, columns: Sequence[np.ndarray]) -> np.ndarray:
        """(m, n) at inputs within the box."""
        values = np.broadcast_to(self.terms[..., np.newaxis], (*self.terms.shape, len(columns[0])))
        for axis, column, count in reversed(list(zip(self.axes, columns, self.terms.shape[1:], strict=True))):
            first, last, now = (np.log(x) if axis.logarithmic else np.asarray(x) for x in (axis.low, axis.high, column))
            polynomials = chebyshev.chebvander((2.0 * now - first - last) / (last - first), count - 1)
            values = np.einsum("...kn,nk->...n", values, polynomials)
        return np.asarray(values)


def fit(function: Quantities, axes: Sequence[Interval], tolerance: float, most: int) -> Series:
    """Series with as many terms as the tolerance asks for, and logarithms of inputs where these need fewer.

    Parameters
    ----------
    axes : ``logarithmic`` of one says nothing yet
    tolerance : of the error, relative;  most : points of one fit
    """
    counts, without_progress = [_FIRST] * len(axes), np.zeros(len(axes), dtype=bool)
    best = _interpolant(function, axes, counts)
    for k, axis in enumerate(axes):
        if axis.low > 0.0:
            with_logarithm = [*best.axes[:k], attrs.evolve(axis, logarithmic=True), *best.axes[k + 1 :]]
            trial = _interpolant(function, with_logarithm, counts)
            best = trial if trial.tails[k] < best.tails[k] else best
    while True:
        missing = np.where(without_progress | (best.tails < _ENOUGH * tolerance), 0.0, best.tails)
        k = int(np.argmax(missing))
        more = [math.ceil(_GROWTH * n) if j == k else n for j, n in enumerate(counts)]
        if not missing[k] or math.prod(more) > most:
            break
        trial = _interpolant(function, best.axes, more)
        without_progress[k] = trial.tails[k] > 0.5 * best.tails[k]
        if trial.tails[k] < best.tails[k]:
            counts, best = more, trial
    from scipy.stats import qmc

    extremes = _grid(best.axes, [np.cos(np.pi * np.arange(n + 1) / n) for n in counts])
    inside = qmc.Sobol(len(best.axes), rng=np.random.default_rng(0)).random_base2(_SOBOL).T
    columns = [np.concatenate([e, a.at(2.0 * u - 1.0)]) for e, a, u in zip(extremes, best.axes, inside, strict=True)]
    values, size = function(columns)
    for k in range(len(axes)):
        left = np.cumsum(best.share(k)[::-1])[::-1]
        terms = best.terms.take(range(max(2, int(np.sum(left > _DROPPED * tolerance)))), axis=k + 1)
        best = attrs.evolve(best, terms=terms)
    difference = np.abs(best(columns) - values)
    one_sign = np.abs(np.sign(values).sum(axis=1, keepdims=True)) == values.shape[1]
    relative = np.max(difference / np.where(one_sign, np.abs(values), 1e-200), axis=1)
    return attrs.evolve(
        best, error=np.max(difference / size, axis=1), relative=relative, difference=np.max(difference, axis=1)
    )


def _interpolant(function: Quantities, axes: Sequence[Interval], counts: Sequence[int]) -> Series:
    places = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in counts]
    values, size = function(_grid(axes, places))
    terms = values.reshape(-1, *counts)
    for k, (n, place) in enumerate(zip(counts, places, strict=True), start=1):
        weights = 2.0 / n * chebyshev.chebvander(place, n - 1).T
        weights[0] *= 0.5
        terms = np.moveaxis(np.tensordot(weights, terms, (1, k)), 0, k)
    return Series(tuple(axes), terms, size.min(axis=1))


def _grid(axes: Sequence[Interval], places: Sequence[np.ndarray]) -> list[np.ndarray]:
    lines = [axis.at(place) for axis, place in zip(axes, places, strict=True)]
    return [column.ravel() for column in np.meshgrid(*lines, indexing="ij")]
