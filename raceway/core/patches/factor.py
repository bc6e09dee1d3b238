"""A Cholesky factor of a contact's compliance that follows a changing set of points.

Notes
-----
Sets of neighbouring iterations differ in a few points.  With the factor of a set B, the solution on another set A comes
by bordering: points that joined are unknowns of their own, points that left get a multiplier that keeps them at zero;
both together make a small dense system (the Schur complement of the factor).  Beyond ``_BORDER`` of the set it is
cheaper to factorise anew.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from raceway.core.patches.gather import between, displaced
from raceway.core.patches.patch import Patch
from raceway.errors import ConvergenceError

_BORDER = 0.08


class Factor:
    """Solves C x = r over a set of points, C the compliance of ball and race together.

    Parameters
    ----------
    patch : where the points are
    extra : compliance of the law at every point, on the diagonal [m/N]
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
        """Make the factor, or the border, of a set of points."""
        if self._nodes is not None and np.array_equal(nodes, self._nodes):
            return
        joined = np.isin(nodes, self._base, assume_unique=True, invert=True)
        left = np.isin(self._base, nodes, assume_unique=True, invert=True)
        changed = int(joined.sum() + left.sum())
        self._nodes = nodes.copy()
        if not len(self._base) or changed > max(2, _BORDER * len(nodes)):
            self._factorise(nodes)
            return
        self._same = changed == 0
        if self._same:
            return
        self._joined, self._left = np.flatnonzero(joined), np.flatnonzero(left)
        self._kept, self._kept_base = np.flatnonzero(~joined), np.flatnonzero(~left)
        new = nodes[self._joined]
        self._cross = self.block(self._base, new)
        many = len(self._joined)
        sides = np.zeros((len(self._base), changed))
        sides[:, :many] = self._cross
        sides[self._left, many + np.arange(len(self._left))] = 1.0
        self._reach = self._plain(sides)
        schur = -sides.T @ self._reach
        schur[:many, :many] += self.block(new, new) + self._extra * np.eye(many)
        self._schur = schur

    def _factorise(self, nodes: np.ndarray) -> None:
        matrix = self.block(nodes, nodes)
        matrix[np.diag_indices(len(nodes))] += self._extra
        self._lower, status = dpotrf(matrix, lower=1)
        if status != 0:
            raise ConvergenceError(
                "the compliance of a contact is not positive definite: its mesh is too coarse or distorted"
            )
        self._base = nodes.copy()
        self._same = True
        self.factorisations += 1
