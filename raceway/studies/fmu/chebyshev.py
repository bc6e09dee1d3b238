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
#: Shares of the tolerance: of the last terms of an axis that grows no more, and of terms that are dropped.
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
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** (0.5 * (place + 1.0)))
        return np.asarray(self.low + 0.5 * (place + 1.0) * (self.high - self.low))

    def place(self, values: np.ndarray) -> np.ndarray:
        """The places of inputs."""
        if self.logarithmic:
            return np.asarray(2.0 * np.log(values / self.low) / math.log(self.high / self.low) - 1.0)
        return np.asarray(2.0 * (values - self.low) / (self.high - self.low) - 1.0)


@attrs.frozen(eq=False)
class Series:
    """Quantities over a box.

    Attributes
    ----------
    axes : of the inputs
    terms : (m, n_1, ..., n_d) coefficients
    error : (m,) largest difference at control points over the size of the quantity;  difference : (m,) the largest in its unit
    fitted, controlled : numbers of points
    """

    axes: tuple[Interval, ...]
    terms: np.ndarray
    error: np.ndarray
    difference: np.ndarray
    fitted: int
    controlled: int

    def __call__(self, columns: Sequence[np.ndarray]) -> np.ndarray:
        """(m, n) at inputs within the box."""
        return _evaluate(self.axes, self.terms, columns)


def fit(function: Quantities, axes: Sequence[Interval], tolerance: float, most: int) -> Series:
    """Series with as many terms as the tolerance asks for, and logarithms of inputs where these need fewer.

    Parameters
    ----------
    axes : ``logarithmic`` of one says nothing yet
    tolerance : of the error, relative;  most : points of one fit
    """
    counts, axes = [_FIRST] * len(axes), list(axes)
    best = _interpolate(function, axes, counts)
    for k, axis in enumerate(axes):
        if axis.low > 0.0:
            trial = [*axes[:k], attrs.evolve(axis, logarithmic=True), *axes[k + 1 :]]
            found = _interpolate(function, trial, counts)
            if found.tails[k] < best.tails[k]:
                axes, best = trial, found
    stalled = [False] * len(axes)
    while True:
        wanted = [
            0.0 if stop or tail < _ENOUGH * tolerance else tail for tail, stop in zip(best.tails, stalled, strict=True)
        ]
        k = int(np.argmax(wanted))
        more = [math.ceil(_GROWTH * n) if j == k else n for j, n in enumerate(counts)]
        if not wanted[k] or math.prod(more) > most:
            break
        found = _interpolate(function, axes, more)
        stalled[k] = found.tails[k] > 0.5 * best.tails[k]
        if found.tails[k] < best.tails[k]:
            counts, best = more, found
    terms = best.terms
    for k in range(len(axes)):
        left = np.cumsum(_share(terms, k, best.size)[::-1])[::-1]
        terms = terms.take(range(max(2, int(np.sum(left > _DROPPED * tolerance)))), axis=k + 1)
    columns = _control(axes, counts)
    values, size = function(columns)
    difference = np.abs(_evaluate(axes, terms, columns) - values)
    return Series(
        tuple(axes), terms, np.max(difference / size, axis=1), np.max(difference, axis=1), math.prod(counts), len(columns[0])
    )


@attrs.frozen(eq=False)
class _Interpolation:
    terms: np.ndarray
    size: np.ndarray

    @property
    def tails(self) -> list[float]:
        """Of each axis the last two terms, relative."""
        return [float(_share(self.terms, k, self.size)[-2:].sum()) for k in range(self.terms.ndim - 1)]


def _interpolate(function: Quantities, axes: Sequence[Interval], counts: Sequence[int]) -> _Interpolation:
    places = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in counts]
    values, size = function(_grid(axes, places))
    terms = values.reshape(-1, *counts)
    for k, (n, place) in enumerate(zip(counts, places, strict=True), start=1):
        weights = 2.0 / n * chebyshev.chebvander(place, n - 1).T
        weights[0] *= 0.5
        terms = np.moveaxis(np.tensordot(weights, terms, (1, k)), 0, k)
    return _Interpolation(terms, size.min(axis=1))


def _share(terms: np.ndarray, axis: int, size: np.ndarray) -> np.ndarray:
    """(n,) largest sum of the terms of one degree of an axis over the least size of the quantity."""
    others = tuple(k for k in range(1, terms.ndim) if k != axis + 1)
    return np.asarray(np.max(np.abs(terms).sum(axis=others) / size[:, np.newaxis], axis=0))


def _control(axes: Sequence[Interval], counts: Sequence[int]) -> list[np.ndarray]:
    from scipy.stats import qmc

    extremes = _grid(axes, [np.cos(np.pi * np.arange(n + 1) / n) for n in counts])
    inside = qmc.Sobol(len(axes), rng=np.random.default_rng(0)).random_base2(_SOBOL)
    return [np.concatenate([e, a.at(2.0 * u - 1.0)]) for e, a, u in zip(extremes, axes, inside.T, strict=True)]


def _grid(axes: Sequence[Interval], places: Sequence[np.ndarray]) -> list[np.ndarray]:
    lines = [axis.at(place).clip(axis.low, axis.high) for axis, place in zip(axes, places, strict=True)]
    return [column.ravel() for column in np.meshgrid(*lines, indexing="ij")]


def _evaluate(axes: Sequence[Interval], terms: np.ndarray, columns: Sequence[np.ndarray]) -> np.ndarray:
    values = terms[..., np.newaxis]
    for k in range(len(axes) - 1, -1, -1):
        basis = chebyshev.chebvander(axes[k].place(columns[k]), terms.shape[k + 1] - 1)
        values = np.einsum("...kn,nk->...n", np.broadcast_to(values, (*values.shape[:-1], len(basis))), basis)
    return values
