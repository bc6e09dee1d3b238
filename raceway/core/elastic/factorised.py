"""A sparse factorisation in the place of multigrid: for few unknowns, and for bodies that hardly touch each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Unknowns up to which factors are made.  Rings and balls couple at their contacts only, so that factors stay small: at
#: 97 000 unknowns of a coarse bearing 4.4 CPU-s and 0.75 GB, at 15 000 0.7 CPU-s.  One compact body fills up: two of 16 000
#: unknowns each cost more than multigrid with all its iterations.
MOST_UNKNOWNS, MOST_OF_A_BODY = 60_000, 15_000


class Factorised:
    """LU of a symmetric matrix on the rows that are not held.

    Parameters
    ----------
    matrix : (n, n) CSR;  held : (n,) bool

    Raises
    ------
    ConvergenceError
        A singular matrix: a motion that nothing holds.
    """

    def __init__(self, matrix: csr_matrix, held: np.ndarray) -> None:
        from scipy.sparse.linalg import splu

        rows = np.flatnonzero(~held)
        inner = matrix[rows][:, rows].tocsc()
        try:
            self._factors = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError as why:  # "Factor is exactly singular"
            raise ConvergenceError(f"the stiffness of the bodies is singular: something is held by nothing ({why})") from why

    def __call__(self, residual: np.ndarray) -> np.ndarray:
        """Solution for a residual (m,), or columns of them, on the m rows."""
        return np.asarray(self._factors.solve(residual))
