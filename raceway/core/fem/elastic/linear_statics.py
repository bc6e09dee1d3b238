"""Static equilibrium of one elastic body: K u = f with some displacements prescribed.

Large systems: conjugate gradients, preconditioned by smoothed aggregation whose coarse spaces hold the six rigid motions,
so that the number of iterations hardly grows with the mesh.  Small systems: a sparse factorisation, which costs less there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np
from numba import float32, float64, int32, void

from raceway.core.jit import Kernel, jit
from raceway.errors import ConvergenceError, RacewayError

if TYPE_CHECKING:
    from numba.core.typing.templates import Signature
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU

#: Neighbours up to this many times the distance of the nearest one are strong: all corners of a cube (1.73) and somewhat more,
#: for every direction that is left out makes the next level larger.
REACH = 2.2
#: Coarse nodes, of six unknowns each, at which a factorisation is cheap.
COARSEST = 80


@attrs.frozen(eq=False)
class _Levels:
    """Aggregates from fine to coarse."""

    strong: list[csr_matrix]  # for each level (n, n), which nodes are strongly coupled
    #: for each level (n, k), 1 where a node belongs to an aggregate; the k nodes of the next level
    aggregates: list[csr_matrix]


def _aggregates(graph: csr_matrix, points: np.ndarray, fewest: float = 1.0) -> _Levels:
    """Aggregates of nodes, of these aggregates, and so on.

    graph : (n, n) CSR, not zero where two nodes share a cell;  points : (n, 3) float [m]
    fewest : nodes that an aggregate holds on average at least; aggregates of aggregates are taken until they do

    An aggregate stands at the mean of its nodes, and neighbours those that share a cell with one of its nodes.

    Cells that are long or flat are stiff along their short edges. Smoothing there only works along them, so that coarsening
    has to follow: an aggregate takes the neighbours that are hardly farther than the nearest one. Distances tell that more
    surely than entries of the stiffness, whose couplings along and across a long trilinear cell are of one size.
    """
    import scipy.sparse as sp
    from pyamg.aggregation.aggregate import standard_aggregation

    levels = _Levels([], [])
    strong, belongs = graph, None  # of the last level kept: its strong pairs, and what its nodes belong to
    while graph.shape[0] > COARSEST:
        # Pairs that one of the two counts among its nearest, and the diagonal, as ones.
        pairs = graph.tocoo()
        apart = pairs.row != pairs.col
        row, column = pairs.row[apart], pairs.col[apart]
        distance = np.linalg.norm(points[row] - points[column], axis=1)
        nearest = np.full(len(points), np.inf)
        np.minimum.at(nearest, row, distance)
        close = distance <= REACH * nearest[row]
        one_way = sp.csr_matrix((np.ones(close.sum()), (row[close], column[close])), shape=graph.shape)
        near = (one_way + one_way.T + sp.eye(len(points), format="csr")).tocsr()
        near.data[:] = 1.0
        aggregates = standard_aggregation(near)[0].tocsr().astype(float)
        if aggregates.shape[1] > 0.9 * aggregates.shape[0]:  # nothing left to put together
            break
        if belongs is None:
            strong, belongs = near, aggregates
        else:
            belongs = (belongs @ aggregates).tocsr()
        points = (aggregates.T @ points) / np.maximum(np.asarray(aggregates.sum(axis=0)).reshape(-1, 1), 1.0)
        graph = (aggregates.T @ graph @ aggregates).tocsr()
        if belongs.shape[0] >= fewest * belongs.shape[1]:
            levels.strong.append(strong)
            levels.aggregates.append(belongs)
            belongs = None
    if belongs is not None:
        levels.strong.append(strong)
        levels.aggregates.append(belongs)
    return levels


#: Columns of ``rigid_motions``.
MOTIONS = (*(f"translation along {axis}" for axis in "xyz"), *(f"rotation about {axis}" for axis in "xyz"))
#: Squared singular values below this part of the largest are zero: a support over 1e-4 of a body is no support, rounding 1e-16.
_RANK = 1e-8


def rigid_motions(points: np.ndarray, centre: np.ndarray | None = None) -> np.ndarray:
    """Three translations and three rotations about the centre (3 n, 6), these divided by the largest distance from it.

    points : (n, 3) float [m];  centre : (3,) float [m]; mean of the points when None
    """
    arm = points - (points.mean(axis=0) if centre is None else centre)
    largest = float(np.abs(arm).max()) if len(arm) else 1.0
    arm = arm / (largest or 1.0)
    motions = np.zeros((len(points), 3, 6))
    for axis in range(3):
        motions[:, axis, axis] = 1.0
        motions[:, :, 3 + axis] = np.cross(np.eye(3)[axis], arm)
    return motions.reshape(-1, 6)


def _signature(real: Any) -> Signature:
    vector = real[::1]
    return void(int32[::1], int32[::1], vector, vector, vector, real, vector)


def _multiply(starts, columns, blocks, x, base, factor, out):  # type: ignore[no-untyped-def]
    for row in range(starts.size - 1):
        i = 3 * row
        a, b, c = factor * base[i], factor * base[i + 1], factor * base[i + 2]
        for k in range(starts[row], starts[row + 1]):
            j, at = 3 * columns[k], 9 * k
            p, q, r = x[j], x[j + 1], x[j + 2]
            a += blocks[at] * p + blocks[at + 1] * q + blocks[at + 2] * r
            b += blocks[at + 3] * p + blocks[at + 4] * q + blocks[at + 5] * r
            c += blocks[at + 6] * p + blocks[at + 7] * q + blocks[at + 8] * r
        out[i], out[i + 1], out[i + 2] = a, b, c


_MULTIPLY = {np.float64: jit(_signature(float64))(_multiply), np.float32: jit(_signature(float32))(_multiply)}


class BlockMatrix:
    """A square sparse matrix of 3 x 3 blocks.

    matrix : (3 n, 3 n) scipy.sparse;  real : numpy.float64 or numpy.float32, of the blocks and of all vectors
    """

    def __init__(self, matrix: csr_matrix, real: type[np.floating] = np.float64) -> None:
        blocks = matrix.tobsr((3, 3))
        self._starts, self._columns = blocks.indptr.astype(np.int32), blocks.indices.astype(np.int32)
        self._blocks = np.ascontiguousarray(blocks.data.reshape(-1), dtype=real)
        self._real, self._nothing = real, np.zeros(matrix.shape[0], dtype=real)
        self._kernel: Kernel = _MULTIPLY[real]

    def times(self, x: np.ndarray, base: np.ndarray | None = None, factor: float = 0.0) -> np.ndarray:
        """(3 n,) A x + factor base."""
        out = np.empty_like(self._nothing)
        first = self._nothing if base is None else base
        self._kernel(self._starts, self._columns, self._blocks, x, first, self._real(factor), out)
        return out


#: Degree of the Chebyshev smoother, and the part of the spectrum that it damps: from a thirtieth of the bound to it.
_DEGREE, _LOWEST, _MARGIN = 4, 1.0 / 30.0, 1.1


class _WCycle:
    """A symmetric W-cycle.

    levels : list of objects with ``A`` and, but for the last, ``P`` and ``R``: sparse, symmetric, R = P^T

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
            polynomial = -chebyshev_polynomial_coefficients(_LOWEST * bound, _MARGIN * bound, _DEGREE)[:-1]
            self._smoothers.append([float(c) for c in polynomial])
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
        matrix, solution = self._matrices[level], self._smooth(level, right)
        coarse = self._down[level] @ (right - matrix.times(solution))
        correction = self._cycle(level + 1, coarse)
        if level + 1 < len(self._matrices):  # the coarsest system is solved at once
            correction += self._cycle(level + 1, coarse - self._matrices[level + 1].times(correction))
        solution += self._up[level] @ correction
        solution += self._smooth(level, right - matrix.times(solution))
        return solution

    def _smooth(self, level: int, residual: np.ndarray) -> np.ndarray:
        """p(A) residual by Horner's rule."""
        matrix, coefficients = self._matrices[level], self._smoothers[level]
        out = coefficients[0] * residual
        for c in coefficients[1:]:
            out = matrix.times(out, residual, c)
        return np.asarray(out)


#: Unknowns up to which a factorisation is faster than setting up the hierarchy (measured on solid bodies).
DIRECT_UNKNOWNS = 3000
#: Some twenty iterations are normal; ten times that means that the matrix is not what this solver is for.
MOST_ITERATIONS = 200


@attrs.frozen(eq=False)
class _Solution:
    """Displacements that balance a load."""

    displacement: np.ndarray  # (n, 3) float [m]
    iterations: int  # of the conjugate gradients; 0 where the system was factorised
    residual: float  # |K u - f| over |f| on the free degrees of freedom, with f the load and the pull of the prescribed ones


def solve_static(
    stiffness: csr_matrix,
    points: np.ndarray,
    load: np.ndarray,
    fixed_dofs: np.ndarray,
    values: np.ndarray | float = 0.0,
    tolerance: float = 1e-8,
) -> _Solution:
    """Displacements of a body under nodal forces and prescribed displacements.

    Parameters
    ----------
    stiffness : (3 n, 3 n) CSR, symmetric positive semi-definite [N/m]
    points : (n, 3) float [m]
    load : (n, 3) float [N]
    fixed_dofs : (n, 3) bool, prescribed degrees of freedom
    values : (n, 3) float or one number, what is prescribed there [m]
    tolerance : of the residual relative to the right-hand side

    Raises
    ------
    ConvergenceError
        A rigid motion that nothing holds, a load or matrix that is not finite, or iterations that end too early.
    """
    mask = np.asarray(fixed_dofs, dtype=bool)
    displacement = np.where(mask, np.broadcast_to(values, fixed_dofs.shape), 0.0)
    matrix = stiffness.tocsr()
    if not (np.isfinite(load).all() and np.isfinite(displacement).all() and np.isfinite(matrix.data).all()):
        raise ConvergenceError("the static system has loads, prescribed displacements or stiffness that are not finite")
    _refuse_free_motion(matrix, points, mask.reshape(-1))
    return StaticSolver(matrix, points, mask).solve(load, displacement, tolerance)


class StaticSolver:
    """Factors or multigrid of a body, for many loads.

    stiffness : (3 n, 3 n) CSR, positive definite on the degrees of freedom that are not held [N/m]
    points : (n, 3) float [m];  held : (n, 3) bool
    """

    def __init__(self, stiffness: csr_matrix, points: np.ndarray, fixed_dofs: np.ndarray) -> None:
        from scipy.sparse.linalg import splu

        mask = np.asarray(fixed_dofs, dtype=bool).reshape(-1)
        self._matrix, self._free = stiffness, np.flatnonzero(~mask)
        self._inner = stiffness[self._free][:, self._free]
        self._factors: SuperLU = None
        self._precondition: Preconditioner | None = None
        if len(self._free) > DIRECT_UNKNOWNS:
            self._precondition = Preconditioner(stiffness, points, mask)
        elif len(self._free):
            self._factors = splu(self._inner.tocsc(), permc_spec="MMD_AT_PLUS_A")

    def solve(self, load: np.ndarray, values: np.ndarray | float = 0.0, tolerance: float = 1e-8) -> _Solution:
        """Displacements under nodal forces (n, 3), where held as prescribed (n, 3); ConvergenceError of the iterations."""
        displacement = np.array(np.broadcast_to(values, load.shape), dtype=float).reshape(-1)
        displacement[self._free] = 0.0
        right = (np.asarray(load, dtype=float).reshape(-1) - self._matrix @ displacement)[self._free]
        if (size := float(np.linalg.norm(right))) == 0.0:
            return _Solution(displacement.reshape(-1, 3), 0, 0.0)
        if self._precondition is None:
            solution, iterations = self._factors.solve(right), 0
        else:
            solution, iterations = _conjugate_gradients(self._inner, right, self._precondition, tolerance)
        residual = float(np.linalg.norm(self._inner @ solution - right)) / size
        displacement[self._free] = solution
        if not residual <= 10.0 * tolerance:  # the true residual may lag behind the recursive one, and NaN fails too
            message = f"the static solution stopped after {iterations} iterations at a residual of {residual:.1e}"
            raise ConvergenceError(f"{message}, {tolerance:g} was asked for", {"displacement": displacement.reshape(-1, 3)})
        return _Solution(displacement.reshape(-1, 3), iterations, residual)


class Preconditioner:
    """One W-cycle of smoothed aggregation on the symmetrically scaled matrix, coarsened along short edges first.

    Scaling with the root of the diagonal makes Chebyshev smoothing, which knows one spectral bound for all rows, work on
    graded meshes whose rows differ by orders of magnitude.

    matrix : (3 n, 3 n) CSR, symmetric, positive definite on the free degrees of freedom
    points : (n, 3) float [m];  held : (3 n,) bool;  fewest : nodes of an aggregate, see ``_aggregates``

    P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996) 179-196: algebraic multigrid by smoothed aggregation.
    """

    def __init__(self, matrix: csr_matrix, points: np.ndarray, fixed_dofs: np.ndarray, fewest: float = 1.0) -> None:
        import scipy.sparse as sp

        try:
            import pyamg
        except ImportError:
            why = "large elastic bodies need pyamg: pip install '.[elastic]' in a checkout of Raceway"
            raise RacewayError(why) from None
        # Whole nodes, so that aggregates are made of nodes: a node that is held in part keeps unit rows for what is held.
        free = np.repeat(~fixed_dofs.reshape(-1, 3).all(axis=1), 3)
        loose = ~fixed_dofs[free]
        self._rows = np.flatnonzero(loose)
        inner = matrix[free][:, free]
        scale = np.where(loose, 1.0 / np.sqrt(inner.diagonal()), 0.0)
        unit_diagonal = sp.diags(scale) @ inner @ sp.diags(scale) + sp.diags((~loose).astype(float))
        motions = rigid_motions(points)[free]
        candidates = np.divide(motions, scale[:, None], out=np.zeros_like(motions), where=loose[:, None])
        self.scale, self._size = scale[loose], len(loose)
        blocks = unit_diagonal.tobsr((3, 3))
        graph = sp.csr_matrix((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr), (len(loose) // 3,) * 2)
        nodes = _aggregates(graph, points[free[::3]], fewest)
        state = np.random.get_state()  # pyamg starts its spectral estimates at random: the same start, the same answer
        np.random.seed(0)
        try:
            self.levels = pyamg.smoothed_aggregation_solver(
                blocks,
                B=candidates,
                strength=[("predefined", {"C": strong}) for strong in nodes.strong],
                aggregate=[("predefined", {"AggOp": operator}) for operator in nodes.aggregates],
                # Weak couplings take no part in the smoothing of the coarse space either, or it would fill up.
                smooth=("jacobi", {"omega": 4.0 / 3.0, "filter_entries": True}),
                presmoother=None,
                postsmoother=None,
                improve_candidates=None,
                coarse_solver=None,
            )
        finally:
            np.random.set_state(state)
        self._cycle = _WCycle(self.levels.levels)

    def __call__(self, residual: np.ndarray) -> np.ndarray:
        """Approximate solution (m,) or (m, k) for a residual, both on the m free degrees of freedom."""
        if residual.ndim == 1:
            right = np.zeros(self._size)
            right[self._rows] = self.scale * residual
            correction: np.ndarray = self.scale * self._cycle.matvec(right)[self._rows]
            return correction
        return np.column_stack([self(column) for column in residual.T])


def _conjugate_gradients(
    matrix: csr_matrix, right: np.ndarray, precondition: Preconditioner, tolerance: float
) -> tuple[np.ndarray, int]:
    """Solution and iterations; ends at the tolerance or at ``MOST_ITERATIONS``."""
    solution, residual = np.zeros_like(right), right.copy()
    direction, before = np.zeros_like(right), 1.0
    goal = tolerance * float(np.linalg.norm(right))
    for iteration in range(MOST_ITERATIONS):
        if np.linalg.norm(residual) <= goal:
            return solution, iteration
        correction = precondition(residual)
        now = float(residual @ correction)
        direction = correction + (now / before if iteration else 0.0) * direction
        image = matrix @ direction
        step = now / float(direction @ image)
        solution += step * direction
        residual -= step * image
        before = now
    return solution, MOST_ITERATIONS


def _refuse_free_motion(matrix: csr_matrix, points: np.ndarray, mask: np.ndarray) -> None:
    """Every connected part has to be held against all six rigid motions."""
    from scipy.sparse.csgraph import connected_components

    count, label = connected_components(matrix, directed=False)
    part = label[::3]
    # Zero blocks may be left out of the matrix, so a node's three rows can be in parts of their own only where they are empty.
    for index in np.unique(part):
        nodes = np.flatnonzero(part == index)
        here, held, loose = points[nodes], mask.reshape(-1, 3)[nodes], list(range(6))
        if held.any():  # rotations are those about the middle of the held points
            rows = rigid_motions(here, here[held.any(axis=1)].mean(axis=0))[held.reshape(-1)]
            _, sizes, directions = np.linalg.svd(rows.T @ rows)  # 6 x 6; its values are squares of the singular values
            share = (directions[sizes <= _RANK * sizes[0]] ** 2).sum(axis=0)
            loose = [i for i in range(6) if share[i] > 0.1]
        if loose:
            where = f" of part {index + 1} of {count}, {len(nodes)} nodes," if count > 1 else ""
            names = ", ".join(MOTIONS[i] for i in loose)
            why = f"no support against the rigid motion{where or ' of the body'}: {names}. Prescribe displacements that stop it"
            raise ConvergenceError(why)
