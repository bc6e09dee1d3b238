"""Sparse factorisation of symmetric positive definite systems that share one pattern, and condensation by it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU

#: A symmetric elimination: pivots stay on the diagonal.
_SYMMETRIC: Tables = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


def factorised(matrix: csr_matrix, ordered: bool = True) -> SuperLU:
    """scipy.sparse.linalg.SuperLU of a symmetric csc_matrix; ``ordered``: its rows already stand in an order of little fill."""
    from scipy.sparse.linalg import splu

    return splu(matrix, permc_spec="NATURAL" if ordered else "MMD_AT_PLUS_A", **_SYMMETRIC)


def elimination_order(matrix: csr_matrix) -> np.ndarray:
    """(m,) Rows of a symmetric matrix in an order of little fill (minimum degree)."""
    return np.argsort(factorised(matrix, ordered=False).perm_c)


def condensed(factor: SuperLU, kept: np.ndarray) -> np.ndarray:
    """(s, s) The rows and columns ``kept`` of the inverse, where they are the last ones of the matrix that was factorised.

    Notes
    -----
    With K = L D L^T the last block of L D L^T is the condensed stiffness, and its inverse that block of K^-1.  SuperLU may
    renumber along the elimination tree, which changes no entry of the factors.
    """
    place = factor.perm_c[kept]
    by_place = np.argsort(place)
    lower, upper = factor.L, factor.U
    row = np.full(lower.shape[0], -1)
    row[place[by_place]] = np.arange(len(kept))
    block = np.zeros((len(kept), len(kept)))
    for column, at in enumerate(place[by_place]):
        part = slice(lower.indptr[at], lower.indptr[at + 1])
        rows = row[lower.indices[part]]
        block[rows[rows >= 0], column] = lower.data[part][rows >= 0]
    from scipy.linalg import solve_triangular

    inverse = solve_triangular(
        block, np.eye(len(kept)), lower=True, unit_diagonal=True, overwrite_b=True, check_finite=False
    )
    pivots = upper.diagonal()[place[by_place]]
    found = inverse.T @ (inverse / pivots[:, None])
    out = np.empty_like(found)
    out[np.ix_(by_place, by_place)] = found
    return out
