"""Compliance of ball and race together between points of a patch, and its factors for sets of points that differ in a few."""

import numpy as np
from numba import int64, void
from scipy.linalg.lapack import dpotrf, dpotrs

from raceway.core.fem.patches.patch import Patch
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR
from raceway.errors import ConvergenceError

INDEX = int64[::1]


@jit(void(CUBE, CUBE, INDEX, INDEX, MATRIX))
def between(ball, race, to, of, out):
    """out (len(to), len(of)) [m/N]: displacement of points ``to`` by forces on points ``of``.

    ball : (rows, n, n) by distance in rows;  race : (n, m, m) by distance in columns
    to, of : numbers k * n + i
    """
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            out[a, b] = ball[abs(k - q), i, j] + race[abs(i - j), k, q]


@jit(void(CUBE, CUBE, INDEX, INDEX, VECTOR, VECTOR))
def displaced(ball, race, to, of, load, out):
    """out (len(to),) [m]: displacement of points ``to`` by loads [N] on points ``of``."""
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        total = 0.0
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            total += (ball[abs(k - q), i, j] + race[abs(i - j), k, q]) * load[b]
        out[a] = total


#: Share of a set's points that may differ from those of a factor.
_BORDER = 0.08


class ComplianceFactor:
    """Solves C x = r over a set of points, C the compliance of ball and race together.

    patch : where the points are;  extra : compliance of the law at every point, on the diagonal [m/N]

    Sets of neighbouring iterations differ in a few points.  With the factor of a set B, the solution on another set A comes
    by bordering: points that joined are unknowns of their own, points that left get a multiplier that keeps them at zero;
    both together make a small dense system (the Schur complement of the factor).  Beyond ``_BORDER`` of the set it is
    cheaper to factorise anew.
    """

    def __init__(self, patch: Patch, extra: float = 0.0) -> None:
        self._patch = patch
        self._extra = extra
        self._base = np.zeros(0, dtype=np.int64)
        self._lower = np.zeros((0, 0), order="F")
        self._nodes: np.ndarray | None = None
        self.factorisations = 0

    def block(self, to: np.ndarray, of: np.ndarray) -> np.ndarray:
        """(len(to), len(of)) compliance without the law's own [m/N]."""
        out = np.empty((len(to), len(of)))
        between(self._patch.ball.compliance, self._patch.race.compliance, to, of, out)
        return out

    def displacement(self, to: np.ndarray, of: np.ndarray, load: np.ndarray) -> np.ndarray:
        """(len(to),) displacement by loads [m], without the law's own."""
        out = np.empty(len(to))
        displaced(self._patch.ball.compliance, self._patch.race.compliance, to, of, np.ascontiguousarray(load), out)
        return out

    def solve(self, nodes: np.ndarray, right: np.ndarray) -> np.ndarray:
        """x (n,) or (n, k) with C x = right on the points ``nodes`` (n,), ascending."""
        self._prepare(nodes)
        if not len(nodes):
            return np.zeros_like(right)
        columns = right.reshape(len(nodes), -1)
        if self._same:
            return self._plain(columns).reshape(right.shape)
        spread = np.zeros((len(self._base), columns.shape[1]))
        spread[self._kept_base] = columns[self._kept]
        first = self._plain(spread)
        small = np.concatenate([columns[self._joined] - self._cross.T @ first, -first[self._left]])
        border = np.linalg.solve(self._schur, small)
        first -= self._reach @ border
        out = np.empty_like(columns)
        out[self._kept], out[self._joined] = first[self._kept_base], border[: self._cross.shape[1]]
        return out.reshape(right.shape)

    def _plain(self, right: np.ndarray) -> np.ndarray:
        return dpotrs(self._lower, right, lower=1)[0]

    def _prepare(self, nodes: np.ndarray) -> None:
        if self._nodes is not None and np.array_equal(nodes, self._nodes):
            return
        joining = np.isin(nodes, self._base, assume_unique=True, invert=True)
        leaving = np.isin(self._base, nodes, assume_unique=True, invert=True)
        exchanges = int(joining.sum() + leaving.sum())
        self._nodes = nodes.copy()
        if not len(self._base) or exchanges > max(2, _BORDER * len(nodes)):
            matrix = self.block(nodes, nodes)
            matrix[np.diag_indices(len(nodes))] += self._extra
            self._lower, status = dpotrf(matrix, lower=1)
            if status != 0:
                why = "the compliance of a contact is not positive definite: its mesh is too coarse or distorted"
                raise ConvergenceError(why)
            self._base, self._same = nodes.copy(), True
            self.factorisations += 1
            return
        self._same = exchanges == 0
        if self._same:
            return
        self._joined, self._left = np.flatnonzero(joining), np.flatnonzero(leaving)
        self._kept, self._kept_base = np.flatnonzero(~joining), np.flatnonzero(~leaving)
        new = nodes[self._joined]
        self._cross = self.block(self._base, new)
        count = len(self._joined)
        sides = np.zeros((len(self._base), exchanges))
        sides[:, :count] = self._cross
        sides[self._left, count + np.arange(len(self._left))] = 1.0
        self._reach = self._plain(sides)
        schur = -sides.T @ self._reach
        schur[:count, :count] += self.block(new, new) + self._extra * np.eye(count)
        self._schur = schur
