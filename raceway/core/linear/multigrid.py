"""One W-cycle over a hierarchy of smoothed aggregation, in single precision."""

from __future__ import annotations

from typing import Any

import numpy as np

from raceway.core.linear.blocks import BlockMatrix

#: Degree of the Chebyshev smoother, and the part of the spectrum that it damps: from a thirtieth of the bound to it.
_DEGREE, _LOWEST, _MARGIN = 4, 1.0 / 30.0, 1.1


class WCycle:
    """A symmetric W-cycle.

    Parameters
    ----------
    levels : list of objects with ``A`` and, but for the last, ``P`` and ``R``: sparse, symmetric, R = P^T

    Notes
    -----
    The same cycle as pyamg's with Chebyshev smoothing, without the norms that its solver takes, and with matrices in single
    precision: a preconditioner needs no more, and memory traffic is what it costs.  Every coarse system is solved by two
    cycles: flat cells are coarsened in many small steps, whose errors would add up in a V-cycle; on compact cells the coarse
    levels are so small that the second one costs next to nothing.
    """

    def __init__(self, levels: list[Any]) -> None:
        from pyamg.relaxation.chebyshev import chebyshev_polynomial_coefficients
        from pyamg.util.linalg import approximate_spectral_radius

        self._matrices = [BlockMatrix(level.A, np.float32) for level in levels[:-1]]
        self._up = [level.P.astype(np.float32) for level in levels[:-1]]
        self._down = [level.R.astype(np.float32) for level in levels[:-1]]
        self._smoothers = []
        for level in levels[:-1]:
            bound = float(approximate_spectral_radius(level.A))
            found = -chebyshev_polynomial_coefficients(_LOWEST * bound, _MARGIN * bound, _DEGREE)[:-1]
            self._smoothers.append([float(c) for c in found])
        self._coarse = np.linalg.pinv(levels[-1].A.toarray(), hermitian=True).astype(np.float32)

    def matvec(self, right: np.ndarray) -> np.ndarray:
        """(n,) approximate solution for a right-hand side (n,)."""
        size = float(np.abs(right).max())  # single precision holds 1e-38 to 1e38
        if size == 0.0 or not np.isfinite(size):
            return np.zeros_like(right) if size == 0.0 else np.full_like(right, np.nan)
        return size * self._cycle(0, (right / size).astype(np.float32)).astype(np.float64)

    def _cycle(self, level: int, right: np.ndarray) -> np.ndarray:
        if level == len(self._matrices):
            return np.asarray(self._coarse @ right)
        matrix = self._matrices[level]
        found = self._smooth(level, right)
        coarse = self._down[level] @ (right - matrix.times(found))
        correction = self._cycle(level + 1, coarse)
        if level + 1 < len(self._matrices):  # the coarsest system is solved at once
            correction += self._cycle(level + 1, coarse - self._matrices[level + 1].times(correction))
        found += self._up[level] @ correction
        found += self._smooth(level, right - matrix.times(found))
        return found

    def _smooth(self, level: int, residual: np.ndarray) -> np.ndarray:
        """p(A) residual by Horner's rule."""
        matrix, coefficients = self._matrices[level], self._smoothers[level]
        out = coefficients[0] * residual
        for c in coefficients[1:]:
            out = matrix.times(out, residual, c)
        return np.asarray(out)
