"""The stable step of central differences, from the eigenvalues of the elements."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.hexahedron.mass import batches
from raceway.core.hexahedron.shape import Floats

_BATCH = 2048
#: Elements whose eigenvalues differ by less than this share are taken for equal.
_SAME = 1e-9


def stable_step(matrices: Callable[[slice], Floats], masses: Floats) -> float:
    """2 / (largest angular frequency of any single element with its share of the lumped mass) [s].

    Parameters
    ----------
    matrices : function
        Of a slice of elements: their stiffness matrices (k, 24, 24) [N/m].
    masses : (m, 8) float
        Shares of the nodes' lumped masses [kg].

    Notes
    -----
    No mode of the assembled mesh is faster than the fastest element (Fried 1972; Hughes, The Finite Element Method, 1987,
    section 9.1), so the step is safe.  Elements are visited in the order of a bound, the largest row sum of the scaled
    stiffness, until no bound left exceeds the largest eigenvalue found: the result is that of all elements.  Where many
    elements are alike, a Cholesky factorisation, a tenth of the time of the eigenvalues, shows that a batch holds none above it.
    """
    count = len(masses)
    bounds = np.empty(count)
    for part in batches(count, _BATCH):
        bounds[part] = np.abs(_scaled(matrices(part), masses[part])).sum(axis=2).max(axis=1)
    order = np.argsort(-bounds, kind="stable")
    largest = 0.0
    for begin, end in _growing(count):
        if bounds[order[begin]] <= largest:
            break
        chosen = order[begin:end]
        scaled = np.concatenate([_scaled(matrices(slice(e, e + 1)), masses[e : e + 1]) for e in chosen.tolist()])
        if not _all_below(scaled, largest * (1.0 + _SAME)):
            largest = max(largest, float(np.linalg.eigvalsh(scaled)[:, -1].max()))
    return float(2.0 / np.sqrt(largest))


def _all_below(matrices: Floats, bound: float) -> bool:
    """Whether all eigenvalues are below the bound: the difference is then positive definite."""
    try:
        np.linalg.cholesky(bound * np.eye(matrices.shape[-1]) - matrices)
    except np.linalg.LinAlgError:
        return False
    return True


def _growing(count: int) -> list[tuple[int, int]]:
    """Parts of ``count`` things: small ones first, as on graded meshes few elements need a look."""
    edges = [0]
    while edges[-1] < count:
        edges.append(min(count, edges[-1] + min(_BATCH, max(64, edges[-1]))))
    return list(zip(edges[:-1], edges[1:], strict=True))


def _scaled(stiffness: Floats, mass: Floats) -> Floats:
    """M^-1/2 K M^-1/2 with three components a node."""
    root = 1.0 / np.sqrt(np.repeat(mass, 3, axis=1))
    return stiffness * root[:, :, None] * root[:, None, :]
