"""Static equilibrium of one elastic body: K u = f with some displacements prescribed.

Large systems: conjugate gradients, preconditioned by smoothed aggregation whose coarse spaces hold the six rigid motions,
so that the number of iterations hardly grows with the mesh.  Small systems: a sparse factorisation, which costs less there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.linear.aggregates import aggregated
from raceway.core.linear.multigrid import WCycle
from raceway.core.linear.rigid_motions import MOTIONS, free_motions, rigid_motions
from raceway.errors import ConvergenceError, RacewayError

if TYPE_CHECKING:
    from types import ModuleType

    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU

#: Unknowns up to which a factorisation is faster than setting up the hierarchy (measured on solid bodies).
DIRECT_UNKNOWNS = 3000
#: Some twenty iterations are normal; ten times that means that the matrix is not what this solver is for.
MOST_ITERATIONS = 200


@attrs.frozen(eq=False)
class Solution:
    """Displacements that balance a load.

    Attributes
    ----------
    displacement : (n, 3) float [m]
    iterations : of the conjugate gradients; 0 where the system was factorised
    residual : |K u - f| over |f| on the free degrees of freedom, with f the load and the pull of the prescribed ones
    """

    displacement: np.ndarray
    iterations: int
    residual: float


def solve_static(
    stiffness: csr_matrix,
    points: np.ndarray,
    load: np.ndarray,
    held: np.ndarray,
    values: np.ndarray | float = 0.0,
    tolerance: float = 1e-8,
) -> Solution:
    """Displacements of a body under nodal forces and prescribed displacements.

    Parameters
    ----------
    stiffness : (3 n, 3 n) CSR, symmetric positive semi-definite [N/m]
    points : (n, 3) float [m]
    load : (n, 3) float [N]
    held : (n, 3) bool, prescribed degrees of freedom
    values : (n, 3) float or one number, what is prescribed there [m]
    tolerance : of the residual relative to the right-hand side

    Raises
    ------
    ConvergenceError
        A rigid motion that nothing holds, a load or matrix that is not finite, or iterations that end too early.
    """
    mask = np.asarray(held, dtype=bool)
    given = np.where(mask, np.broadcast_to(values, held.shape), 0.0)
    matrix = stiffness.tocsr()
    if not (np.isfinite(load).all() and np.isfinite(given).all() and np.isfinite(matrix.data).all()):
        raise ConvergenceError("the static system has loads, prescribed displacements or stiffness that are not finite")
    _refuse_free_motion(matrix, points, mask.reshape(-1))
    return StaticSolver(matrix, points, mask).solve(load, given, tolerance)


class StaticSolver:
    """Factors or multigrid of a body, for many loads.

    Parameters
    ----------
    stiffness : (3 n, 3 n) CSR, positive definite on the degrees of freedom that are not held [N/m]
    points : (n, 3) float [m];  held : (n, 3) bool
    """

    def __init__(self, stiffness: csr_matrix, points: np.ndarray, held: np.ndarray) -> None:
        from scipy.sparse.linalg import splu

        mask = np.asarray(held, dtype=bool).reshape(-1)
        self._matrix, self._free = stiffness, np.flatnonzero(~mask)
        self._inner = stiffness[self._free][:, self._free]
        self._factors: SuperLU = None
        self._precondition: Preconditioner | None = None
        if len(self._free) > DIRECT_UNKNOWNS:
            self._precondition = Preconditioner(stiffness, points, mask)
        elif len(self._free):
            self._factors = splu(self._inner.tocsc(), permc_spec="MMD_AT_PLUS_A")

    def solve(self, load: np.ndarray, values: np.ndarray | float = 0.0, tolerance: float = 1e-8) -> Solution:
        """Displacements under nodal forces (n, 3), where held as prescribed (n, 3).

        Raises
        ------
        ConvergenceError
            Iterations that end too early.
        """
        displacement = np.array(np.broadcast_to(values, load.shape), dtype=float).reshape(-1)
        displacement[self._free] = 0.0
        right = (np.asarray(load, dtype=float).reshape(-1) - self._matrix @ displacement)[self._free]
        size = float(np.linalg.norm(right))
        if size == 0.0:
            return Solution(displacement.reshape(-1, 3), 0, 0.0)
        iterations = 0
        if self._precondition is None:
            found = self._factors.solve(right)
        else:
            found, iterations = _conjugate_gradients(self._inner, right, self._precondition, tolerance)
        residual = float(np.linalg.norm(self._inner @ found - right)) / size
        displacement[self._free] = found
        if not residual <= 10.0 * tolerance:  # the true residual may lag behind the recursive one, and NaN fails too
            message = f"the static solution stopped after {iterations} iterations at a residual of {residual:.1e}"
            raise ConvergenceError(f"{message}, {tolerance:g} was asked for", {"displacement": displacement.reshape(-1, 3)})
        return Solution(displacement.reshape(-1, 3), iterations, residual)


class Preconditioner:
    """One W-cycle of smoothed aggregation on the symmetrically scaled matrix, coarsened along short edges first.

    Scaling with the root of the diagonal makes Chebyshev smoothing, which knows one spectral bound for all rows, work on
    graded meshes whose rows differ by orders of magnitude.

    Parameters
    ----------
    matrix : (3 n, 3 n) CSR, symmetric, positive definite on the free degrees of freedom
    points : (n, 3) float [m]
    held : (3 n,) bool
    fewest : nodes of an aggregate, see ``aggregated``

    References
    ----------
    P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996) 179-196: algebraic multigrid by smoothed aggregation.
    """

    def __init__(self, matrix: csr_matrix, points: np.ndarray, held: np.ndarray, fewest: float = 1.0) -> None:
        import scipy.sparse as sp

        pyamg = _pyamg()
        # Whole nodes, so that aggregates are made of nodes: a node that is held in part keeps unit rows for what is held.
        kept = np.repeat(~held.reshape(-1, 3).all(axis=1), 3)
        loose = ~held[kept]
        self._rows = np.flatnonzero(loose)
        inner = matrix[kept][:, kept]
        scale = np.where(loose, 1.0 / np.sqrt(inner.diagonal()), 0.0)
        scaled = sp.diags(scale) @ inner @ sp.diags(scale) + sp.diags((~loose).astype(float))
        motions = rigid_motions(points)[kept]
        candidates = np.divide(motions, scale[:, None], out=np.zeros_like(motions), where=loose[:, None])
        self.scale = scale[loose]
        self._size = len(loose)
        blocks = scaled.tobsr((3, 3))
        graph = sp.csr_matrix((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr), (len(loose) // 3,) * 2)
        nodes = aggregated(graph, points[kept[::3]], fewest)
        state = np.random.get_state()  # pyamg starts its spectral estimates at random: the same start, the same answer
        np.random.seed(0)
        try:
            self.levels = pyamg.smoothed_aggregation_solver(
                blocks,
                B=candidates,
                strength=[("predefined", {"C": strong}) for strong in nodes.strong],
                aggregate=[("predefined", {"AggOp": found}) for found in nodes.aggregates],
                # Weak couplings take no part in the smoothing of the coarse space either, or it would fill up.
                smooth=("jacobi", {"omega": 4.0 / 3.0, "filter_entries": True}),
                presmoother=None,
                postsmoother=None,
                improve_candidates=None,
                coarse_solver=None,
            )
        finally:
            np.random.set_state(state)
        self._cycle = WCycle(self.levels.levels)

    def __call__(self, residual: np.ndarray) -> np.ndarray:
        """Approximate solution (m,) or (m, k) for a residual, both on the m free degrees of freedom."""
        if residual.ndim == 1:
            whole = np.zeros(self._size)
            whole[self._rows] = self.scale * residual
            found: np.ndarray = self.scale * self._cycle.matvec(whole)[self._rows]
            return found
        return np.column_stack([self(column) for column in residual.T])


def _conjugate_gradients(
    matrix: csr_matrix, right: np.ndarray, precondition: Preconditioner, tolerance: float
) -> tuple[np.ndarray, int]:
    """Solution and iterations; ends at the tolerance or at ``MOST_ITERATIONS``."""
    found, residual = np.zeros_like(right), right.copy()
    direction, before = np.zeros_like(right), 1.0
    goal = tolerance * float(np.linalg.norm(right))
    for done in range(MOST_ITERATIONS):
        if np.linalg.norm(residual) <= goal:
            return found, done
        corrected = precondition(residual)
        now = float(residual @ corrected)
        direction = corrected + (now / before if done else 0.0) * direction
        image = matrix @ direction
        step = now / float(direction @ image)
        found += step * direction
        residual -= step * image
        before = now
    return found, MOST_ITERATIONS


def _refuse_free_motion(matrix: csr_matrix, points: np.ndarray, mask: np.ndarray) -> None:
    """Every connected part has to be held against all six rigid motions."""
    from scipy.sparse.csgraph import connected_components

    count, label = connected_components(matrix, directed=False)
    part = label[::3]
    # Zero blocks may be left out of the matrix, so a node's three rows can be in parts of their own only where they are empty.
    for index in np.unique(part):
        nodes = np.flatnonzero(part == index)
        loose = free_motions(points[nodes], mask.reshape(-1, 3)[nodes])
        if loose:
            where = f" of part {index + 1} of {count}, {len(nodes)} nodes," if count > 1 else ""
            names = ", ".join(MOTIONS[i] for i in loose)
            raise ConvergenceError(
                f"nothing holds the rigid motion{where or ' of the body'}: {names}. Prescribe displacements that stop it"
            )


def _pyamg() -> ModuleType:
    try:
        import pyamg
    except ImportError:
        raise RacewayError("large elastic bodies need pyamg: pip install '.[mesh]' in a checkout of Raceway") from None
    return pyamg
