"""Lowest natural frequencies of one elastic body: K u = w^2 M u, free or held."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway import ConvergenceError
from raceway.core.fem.elastic.linear_statics import DIRECT_UNKNOWNS, Preconditioner, rigid_motions

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Residual |K u - w^2 M u| over w^2 |M u|; the error of w^2 goes with its square.
_RESIDUAL = 1e-4
_ROUNDS, _STEPS = 12, 12


@attrs.frozen(eq=False)
class Modes:
    """Elastic modes of a body, the lowest first; the rigid motions of a free body are left out.

    Attributes
    ----------
    frequency_hz : (k,) float
    shape : (k, n, 3) float, of unit modal mass [kg^-1/2]
    residual : largest |K u - w^2 M u| / |w^2 M u|
    """

    frequency_hz: np.ndarray
    shape: np.ndarray
    residual: float


def natural_modes(
    stiffness: csr_matrix, mass: csr_matrix, points: np.ndarray, count: int, held: np.ndarray | None = None
) -> Modes:
    """Lowest elastic modes; small bodies by shifted inverse iteration, large ones by LOBPCG with multigrid.

    Parameters
    ----------
    stiffness, mass : (3 n, 3 n) CSR [N/m], [kg]
    points : (n, 3) float [m]
    count : how many modes
    held : (n, 3) bool, degrees of freedom at rest; None for a free body, whose rigid motions are projected out

    Raises
    ------
    ConvergenceError
        More modes asked for than the body can have, or iterations that end too early.

    References
    ----------
    A. V. Knyazev, SIAM J. Sci. Comput. 23 (2001) 517-541: LOBPCG.
    """
    mask = np.zeros(3 * len(points), dtype=bool) if held is None else np.asarray(held, dtype=bool).reshape(-1)
    free = np.flatnonzero(~mask)
    rigid = None if mask.any() else rigid_motions(points)
    lost = 0 if rigid is None else 6
    if not 0 < count <= (len(free) - lost) // 5:
        raise ConvergenceError(f"{count} modes of a body with {len(free)} free unknowns: at most {(len(free) - lost) // 5}")
    k, m = stiffness.tocsr()[free][:, free], mass.tocsr()[free][:, free]
    # A shift far below the elastic frequencies makes a free body's matrix definite.
    shift = 1e-4 * _strain_estimate(stiffness, mass, points)
    if len(free) <= DIRECT_UNKNOWNS:
        values, vectors = _direct(k, m, count + lost, shift)
        values, vectors = values[lost:], vectors[:, lost:]
    else:
        precondition = Preconditioner((stiffness + shift * mass).tocsr(), points, mask)
        values, vectors = _lobpcg(k, m, count, precondition, rigid)
    worst = float(_residuals(k, m, values, vectors).max())
    if not worst <= 10.0 * _RESIDUAL:
        raise ConvergenceError(f"natural frequencies stopped at a residual of {worst:.1e}, {_RESIDUAL:g} was asked for")
    shape = np.zeros((count, 3 * len(points)))
    shape[:, free] = vectors.T
    return Modes(np.sqrt(values) / (2.0 * np.pi), shape.reshape(count, -1, 3), worst)


def _strain_estimate(stiffness: csr_matrix, mass: csr_matrix, points: np.ndarray) -> float:
    """Smallest w^2 of the three uniform stretchings along the axes: the size of a body's squared frequencies."""
    arm = points - points.mean(axis=0)
    found = []
    for axis in range(3):
        field = np.zeros_like(points)
        field[:, axis] = arm[:, axis]
        u = field.reshape(-1)
        found.append(float(u @ (stiffness @ u)) / float(u @ (mass @ u)))
    return min(found)


def _direct(k: csr_matrix, m: csr_matrix, count: int, shift: float) -> tuple[np.ndarray, np.ndarray]:
    import scipy.sparse.linalg as sparse

    start = np.random.default_rng(0).standard_normal(k.shape[0])
    values, vectors = sparse.eigsh(k.tocsc(), count, m.tocsc(), sigma=-shift, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _lobpcg(
    k: csr_matrix, m: csr_matrix, count: int, precondition: Preconditioner, rigid: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Rounds of a few steps, so that the end is judged by relative residuals and a poor basis is made anew."""
    import warnings

    import scipy.sparse.linalg as sparse

    # Two more than asked for: the last ones of a block converge slowly, and modes of a ring come in pairs.
    block = np.random.default_rng(0).standard_normal((k.shape[0], count + 2))
    inverse = sparse.LinearOperator(k.shape, matvec=precondition, matmat=precondition)
    stiff, heavy = 1.0 / k.diagonal().max(), 1.0 / m.diagonal().max()
    values = np.ones(count + 2)
    for _ in range(_ROUNDS):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # "exited at iteration": the residual is judged below
            values, block = sparse.lobpcg(
                k * stiff, block, m * heavy, inverse, rigid, tol=1e-14, maxiter=_STEPS, largest=False
            )
        order = np.argsort(values)
        values, block = values[order] * heavy / stiff, block[:, order] * np.sqrt(heavy)
        if _residuals(k, m, values[:count], block[:, :count]).max() <= _RESIDUAL:
            break
    return values[:count], block[:, :count]


def _residuals(k: csr_matrix, m: csr_matrix, values: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    inertia = (m @ vectors) * values
    return np.asarray(np.linalg.norm(k @ vectors - inertia, axis=0) / np.linalg.norm(inertia, axis=0))
