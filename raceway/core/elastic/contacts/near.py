"""The nodal displacements that the places of a contact hang on, and the motion of the places by these alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@attrs.frozen(eq=False)
class Near:
    """The columns of B that are not empty: a few of all nodes.

    Attributes
    ----------
    entries : (k,) int, of the nodal displacements, sorted
    move : (3 n, k) sparse, B at these entries
    """

    entries: np.ndarray
    move: csr_matrix

    @classmethod
    def of(cls, move: csr_matrix) -> Near:
        """Of B (3 n, 3 nodes)."""
        from scipy.sparse import csr_array

        met = np.zeros(move.shape[1], dtype=bool)
        met[move.indices] = True
        entries = np.flatnonzero(met)
        number = np.cumsum(met) - 1
        short = csr_array((move.data, number[move.indices], move.indptr), shape=(move.shape[0], len(entries)))
        return cls(entries, short)
