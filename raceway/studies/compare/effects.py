"""Two-level full factorial analysis: what each axis does, alone and together with others.

Notes
-----
With y = ln(quantity) at the 2^k corners (first or last value of each of k axes), s_i = -1 at the first and +1 at the last
value of axis i, the effect of a set T of axes is

    e_T = 2^(1 - k) * sum over corners of y * product of s_i, i in T.

For one axis this is the mean of y at the last value minus the mean at the first; exp(e) is the factor by which the quantity
changes on average (geometric mean), and effects of independent causes multiply.  For two axes it is half the difference
between the effect of one at the last and at the first value of the other: with e_A and e_AB the factor of A is
exp(e_A + e_AB) at the last value of B and exp(e_A - e_AB) at its first.  The effects are a change of basis, so that
y = mean + 1/2 sum_T e_T product of s_i holds at every corner.  The share of a term is e_T^2 over the sum of all squares.

A quantity with a relative error r lies within y -+ d, d = -ln(1 - r).  No e_T is off by more than 2^(1 - k) times the sum of all d;
an effect above that bound is resolved.

References
----------
Box, Hunter, Hunter, Statistics for Experimenters (2nd ed., 2005), chapter 5 (definitions of effects and interactions).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations, product

import attrs
import numpy as np


def factorial_effects(values: np.ndarray) -> np.ndarray:
    """Effects of a two-level factorial.

    Parameters
    ----------
    values : (2,) * k array, y at the corners; index 0 is the first value of an axis, 1 the last

    Returns
    -------
    effects : (2,) * k array; index 1 in the places of the axes of T holds e_T, [0, ..., 0] the mean
    """
    out = np.asarray(values, dtype=float)
    for place in range(out.ndim):
        first, last = np.take(out, 0, axis=place), np.take(out, 1, axis=place)
        out = np.stack([0.5 * (first + last), 0.5 * (last - first)], axis=place)
    out = 2.0 * out
    out[(0,) * out.ndim] *= 0.5
    return out


@attrs.frozen
class Effect:
    """One term.

    Attributes
    ----------
    term : keys of its axes;  log_change : e_T;  percent : 100 (exp(e_T) - 1)
    difference : mean at the last minus mean at the first value [N/m], main effects only
    share : of the variation of ln(quantity);  resolved : whether it exceeds what the corners' errors can make
    """

    term: tuple[str, ...]
    log_change: float
    percent: float
    difference: float | None
    share: float
    resolved: bool


@attrs.frozen(eq=False, slots=False)
class Factorial:
    """One quantity at all corners.

    Attributes
    ----------
    keys : (k,) axes;  corners : (2,) * k, positive [N/m]
    errors : (2,) * k, the corners' relative errors, below 1; default: none
    """

    keys: tuple[str, ...]
    corners: np.ndarray
    errors: np.ndarray = attrs.field(default=attrs.Factory(lambda self: np.zeros(self.corners.shape), takes_self=True))

    @property
    def error(self) -> float:
        """Largest shift of any effect by the corners' errors."""
        return float(2.0 * self._log_errors.mean())

    @cached_property
    def _log_errors(self) -> np.ndarray:
        return -np.log1p(-self.errors)

    @cached_property
    def effects(self) -> list[Effect]:
        """All terms, the largest first."""
        found = factorial_effects(np.log(self.corners))
        squares = float((found**2).sum() - found[(0,) * found.ndim] ** 2)
        terms = []
        for order in range(1, len(self.keys) + 1):
            for places in combinations(range(len(self.keys)), order):
                e = float(found[tuple(int(k in places) for k in range(len(self.keys)))])
                difference = None
                if order == 1:
                    first, last = (float(np.take(self.corners, end, axis=places[0]).mean()) for end in (0, 1))
                    difference = last - first
                share = e * e / squares if squares > 0.0 else 0.0
                term = tuple(self.keys[k] for k in places)
                terms.append(Effect(term, e, 100.0 * float(np.expm1(e)), difference, share, abs(e) > self.error))
        return sorted(terms, key=lambda effect: -abs(effect.log_change))

    def log_change(self, key: str, given: Mapping[str, int] | None = None) -> float:
        """Mean change of ln(quantity) along one axis, the axes in ``given`` held at an end (0 first, 1 last)."""
        first, last = (self._mean(np.log(self.corners), {**(given or {}), key: end}) for end in (0, 1))
        return last - first

    def log_error(self, key: str, given: Mapping[str, int] | None = None) -> float:
        """Largest shift of that change by the corners' errors."""
        return sum(self._mean(self._log_errors, {**(given or {}), key: end}) for end in (0, 1))

    def resolved_change(self, key: str, given: Mapping[str, int] | None = None) -> float:
        """That change, or 0 where errors can make it."""
        change = self.log_change(key, given)
        return change if abs(change) > self.log_error(key, given) else 0.0

    def _mean(self, values: np.ndarray, given: Mapping[str, int]) -> float:
        index: list[int | slice] = [slice(None)] * len(self.keys)
        for name, level in given.items():
            index[self.keys.index(name)] = level
        return float(values[tuple(index)].mean())


def whole_part(usable: np.ndarray) -> tuple[int | None, ...] | None:
    """The largest factorial without holes: for each axis None (both ends) or the end it must be held at.

    Parameters
    ----------
    usable : (2,) * k of bool

    Notes
    -----
    As few axes as possible are held, and of those the last ones: people name what matters most first.  None when no two
    neighbouring corners are usable.
    """
    k = usable.ndim
    for held in range(k):
        for places in sorted(combinations(range(k), held), reverse=True):
            for ends in product((0, 1), repeat=held):
                chosen: list[int | None] = [None] * k
                for place, end in zip(places, ends, strict=True):
                    chosen[place] = end
                if usable[tuple(slice(None) if end is None else end for end in chosen)].all():
                    return tuple(chosen)
    return None


def trend(values: Sequence[float], errors: Sequence[float]) -> str:
    """ "rises", "falls", "level" or "not monotonic" of a series; differences within both ends' relative errors do not count."""
    y, e = np.asarray(values, dtype=float), np.asarray(errors, dtype=float)
    off = np.abs(y) * e
    change, allowed = y[None, :] - y[:, None], off[None, :] + off[:, None]
    later = np.triu(np.ones(change.shape, dtype=bool), 1)
    up, down = bool((change > allowed)[later].any()), bool((change < -allowed)[later].any())
    return {(False, False): "level", (True, False): "rises", (False, True): "falls", (True, True): "not monotonic"}[up, down]
