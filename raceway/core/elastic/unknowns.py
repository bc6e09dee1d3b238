"""Unknowns and nodal vectors: copies between them by shares of the nodes, and at a few nodes alone."""

from __future__ import annotations

import attrs
import numpy as np
from numba import int64, void

from raceway.core.jit import jit
from raceway.core.signatures import VECTOR

_PLACES = int64[::1]


@jit(void(int64, int64, _PLACES, VECTOR, VECTOR), releases=True)
def spread(first, last, free, values, out):  # type: ignore[no-untyped-def]
    """``out[free[i]] = values[i]`` for i from ``first`` to ``last - 1``."""
    if first >= last:
        return
    shift = free[first] - first
    if free[last - 1] - (last - 1) == shift:  # they are sorted: all lie one behind the other
        for i in range(first, last):
            out[i + shift] = values[i]
        return
    for i in range(first, last):
        out[free[i]] = values[i]


@jit(void(int64, int64, _PLACES, VECTOR, VECTOR), releases=True)
def gather(first, last, free, values, out):  # type: ignore[no-untyped-def]
    """``out[i] = values[free[i]]`` for i from ``first`` to ``last - 1``."""
    if first >= last:
        return
    shift = free[first] - first
    if free[last - 1] - (last - 1) == shift:
        for i in range(first, last):
            out[i] = values[i + shift]
        return
    for i in range(first, last):
        out[i] = values[free[i]]


@attrs.frozen(eq=False)
class Selection:
    """Some entries of nodal vectors, seen from the unknowns y = (frames, free nodes).

    Attributes
    ----------
    entries : (k,) int, of the nodal vectors, sorted
    free, unknown : those that are unknowns: numbers among the k, and in y
    tied, ride : those that follow a frame: numbers among the k, and (t, frame_size) their displacement with it
    """

    entries: np.ndarray
    free: np.ndarray
    unknown: np.ndarray
    tied: np.ndarray
    ride: np.ndarray

    @classmethod
    def of(cls, entries: np.ndarray, free: np.ndarray, tied: np.ndarray, ride: np.ndarray) -> Selection:
        """``free`` (size - frame_size,), ``tied`` (t,): sorted entries; ``ride`` (t, frame_size) of the tied ones."""
        mine, place = _among(entries, free)
        ours, row = _among(entries, tied)
        return cls(entries, mine, place + ride.shape[1], ours, ride[row])

    def nodal(self, y: np.ndarray) -> np.ndarray:
        """(k,) of G y."""
        out = np.zeros(len(self.entries))
        out[self.free] = y[self.unknown]
        if len(self.tied):
            out[self.tied] = self.ride @ y[: self.ride.shape[1]]
        return out

    def add(self, force: np.ndarray, out: np.ndarray) -> None:
        """Add G^T F of forces (k,) at the entries to out (size,)."""
        out[self.unknown] += force[self.free]
        if len(self.tied):
            out[: self.ride.shape[1]] += self.ride.T @ force[self.tied]


def _among(entries: np.ndarray, sorted_ones: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the entries that are among the sorted ones, and where there."""
    at = np.searchsorted(sorted_ones, entries)
    at[at == len(sorted_ones)] = 0
    found = np.flatnonzero(sorted_ones[at] == entries) if len(sorted_ones) else np.zeros(0, dtype=np.int64)
    return found, at[found]
