"""Quasi-random samples of independent numbers, and Sobol indices of what is computed from them.

Notes
-----
Samples of a scrambled Sobol' sequence in 2 d dimensions make the two matrices A and B of Saltelli's design; A with one column of B at
a time gives first-order and total indices by the estimators of scipy.stats.sobol_indices.  Rows of A and B together are the
samples of the band.

References
----------
Saltelli et al., Comput. Phys. Commun. 181 (2010) 259.
"""

from __future__ import annotations

import attrs
import numpy as np


@attrs.frozen(eq=False)
class Indices:
    """First-order and total Sobol indices, each (quantities, d)."""

    first: np.ndarray
    total: np.ndarray


def design(count: int, dimensions: int, seed: int) -> np.ndarray:
    """((d + 2) n, d) numbers in [0, 1): rows of A, of B, then of A with each column of B in turn; n a power of 2.

    Parameters
    ----------
    count : n;  dimensions : d
    """
    from scipy.stats import qmc

    both = qmc.Sobol(2 * dimensions, seed=seed).random(count)
    a, b = both[:, :dimensions], both[:, dimensions:]
    mixed = [np.where(np.arange(dimensions) == k, b, a) for k in range(dimensions)]
    return np.vstack([a, b, *mixed])


def indices(values: np.ndarray, dimensions: int) -> Indices:
    """Sobol indices of quantities (q, (d + 2) n) at the samples of ``design``."""
    from scipy.stats import sobol_indices

    count = values.shape[1] // (dimensions + 2)
    parts = values.reshape(len(values), dimensions + 2, count)
    centred = parts - parts[:, :2].mean(axis=(1, 2))[:, None, None]
    func = {"f_A": centred[:, 0], "f_B": centred[:, 1], "f_AB": np.moveaxis(centred[:, 2:], 1, 0)}
    found = sobol_indices(func=func, n=count)
    shape = len(values), dimensions  # scipy leaves out axes of length 1
    return Indices(np.reshape(found.first_order, shape), np.reshape(found.total_order, shape))
