"""Multifrontal Cholesky factors of a mesh of hexahedra, down to the nodes that are kept.

Every domain of a dissection has a dense front: the sum of its elements or of its children's Schur complements.  Its inner
unknowns are eliminated, what is left goes to the parent.  What is left of the whole mesh is its stiffness seen from the kept
nodes: a superelement, exact.  It is computed in double precision; the factors are kept in single precision, half as large and
twice as quick: a solution has six digits, and each refinement with a residual in double precision adds six.

Duff, Reid: The multifrontal solution of indefinite sparse symmetric linear systems, ACM Transactions on Mathematical
Software 9 (1983) 302;  Przemieniecki: Matrix structural analysis of substructures, AIAA Journal 1 (1963) 138.
"""

from collections.abc import Callable, Mapping

import attrs
import numpy as np
from numba import float64, int64, uint32, void
from numpy.typing import NDArray

from raceway.core.fem.elastic.unknowns import of_nodes
from raceway.core.jit import jit
from raceway.core.signatures import CUBE
from raceway.errors import ConvergenceError

Nodes = NDArray[np.int64]

#: Cells that are no longer divided: 64 to 200 cost the same flops, and fewer matrices are quicker.
_LEAF = 128
#: Smallest share of the cells on one side of a cut, and what an unbalanced cut costs over a balanced one.
_SMALLEST, _UNBALANCED = 0.3, 0.5
#: Directions of the cuts: axes, and planes through edges of a cube.
_DIRECTIONS = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]], dtype=float
)


@attrs.frozen(eq=False)
class _Domain:
    """Cells that are eliminated together."""

    inner: Nodes  # (k,) sorted nodes that belong to these cells alone and to no child's inner ones: eliminated here
    border: Nodes  # (b,) sorted nodes that other cells share, or that are kept
    children: tuple[int, ...]  # numbers of the two halves, lower than the own one; none of a leaf
    cells: tuple[int, int] | None  # (first, last + 1) of a leaf in ``_Dissection.order``


@attrs.frozen(eq=False)
class _Dissection:
    """Domains, children before parents, the whole mesh last, and the order of the cells in which leaves are contiguous."""

    domains: list[_Domain]
    order: Nodes


def dissect(points: np.ndarray, cells: np.ndarray, interface: np.ndarray) -> _Dissection:
    """Halves of halves of a mesh, cut where few nodes lie.

    points : (n, 3) float;  cells : (m, 8) int
    kept : (k,) int
        Nodes that are not eliminated.

    George, A.: Nested dissection of a regular finite element mesh, SIAM Journal on Numerical Analysis 10 (1973) 345.
    """
    numbers = np.asarray(cells, dtype=np.int64)
    centre = points[numbers].mean(axis=1)
    centre -= centre.mean(axis=0)
    size = float(np.ptp(points, axis=0).max())
    radius = np.linalg.norm(centre, axis=1)
    # Rounded: layers of cells stay together.
    measures = [np.round(x / size, 7) for x in (*(centre @ _DIRECTIONS.T).T, radius, np.abs(centre).max(axis=1))]
    uses = np.bincount(numbers.ravel(), minlength=len(points))
    uses[interface] = len(numbers) + 1
    domains: list[_Domain] = []
    leaves: list[Nodes] = []
    position = 0

    def visit(part: Nodes) -> int:
        nonlocal position
        nodes, local = np.unique(numbers[part], return_inverse=True)
        local = local.reshape(-1, 8)
        inside = np.bincount(local.ravel()) >= uses[nodes]
        border = nodes[~inside]
        if len(part) <= _LEAF:
            leaves.append(part)
            domains.append(_Domain(nodes[inside], border, (), (position, position + len(part))))
            position += len(part)
            return len(domains) - 1
        _, first, second = min((_bisect(x[part], local, len(nodes)) for x in measures), key=lambda cut: cut[0])
        children = visit(part[first]), visit(part[second])
        both = np.union1d(domains[children[0]].border, domains[children[1]].border)
        domains.append(_Domain(np.setdiff1d(both, border, assume_unique=True), border, children, None))
        return len(domains) - 1

    visit(np.arange(len(numbers)))
    return _Dissection(domains, np.concatenate(leaves))


def _bisect(along: np.ndarray, local: np.ndarray, nodes: int) -> tuple[float, Nodes, Nodes]:
    """Cost of the best cut across a measure of the cells (m,), and the cells of both sides; ``local`` (m, 8) nodes from 0."""
    count = len(along)
    order = np.argsort(along, kind="stable")
    rank = np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    first, last = np.full(nodes, count), np.zeros(nodes, dtype=np.int64)
    ranks = np.repeat(rank, 8)
    np.minimum.at(first, local.ravel(), ranks)
    np.maximum.at(last, local.ravel(), ranks)
    # A node lies in the cut after k cells where first < k <= last.
    change = np.bincount(first + 1, minlength=count + 2) - np.bincount(last + 1, minlength=count + 2)
    overlap = np.cumsum(change)
    low = max(1, int(_SMALLEST * count))
    places = np.arange(low, count - low + 1)
    larger = np.maximum(places, count - places) / count
    cost = overlap[places] * (1.0 + _UNBALANCED * (2.0 * larger - 1.0))
    best = int(np.argmin(cost))
    return float(cost[best]), order[: places[best]], order[places[best] :]


#: Pivots over the diagonal of their front below which they are rounding, 1e-15: bodies a hundred times as long as thick have 1e-8.
_ROUNDING = 1e-12
#: A square in Fortran's order, as LAPACK takes it.
_SQUARE = float64[::1, :]


@jit(void(int64[::1], uint32[:, ::1], CUBE, _SQUARE))
def _add_cells(position, cells, matrices, front):  # type: ignore[no-untyped-def]
    """Add element matrices (m, 24, 24) to the lower triangle of a front; ``place`` (3 nodes,) of an unknown in it, or -1."""
    for e in range(cells.shape[0]):
        for i in range(24):
            row = position[3 * cells[e, i // 3] + i % 3]
            if row >= 0:
                for j in range(24):
                    column = position[3 * cells[e, j // 3] + j % 3]
                    if 0 <= column <= row:
                        front[row, column] += matrices[e, i, j]


@jit(void(int64[::1], _SQUARE, _SQUARE))
def _add_front(position, child, front):  # type: ignore[no-untyped-def]
    """Add the lower triangle of a child's (k, k) to that of a front, at ``place`` (k,)."""
    for j in range(position.size):
        column = position[j]
        for i in range(j, position.size):
            row = position[i]
            front[max(row, column), min(row, column)] += child[i, j]


@attrs.frozen(eq=False)
class _Front:
    """What is kept of an elimination: A_ss = L L^T and W = L^-1 A_sb of inner unknowns s and border unknowns b."""

    #: inner, border : (s,), (b,) unknowns
    inner: np.ndarray
    border: np.ndarray
    lower: np.ndarray  # (s, s) float32 L
    across: np.ndarray  # (s, b) float32 W


class Fronts:
    """Factors of A with retained unknowns, of ``factored`` or of what it gave before.

    fronts : list of Front
    kept : (k,) unknowns that were not eliminated;  schur : (k, k) what A is for them, None where it is not known any more
    """

    def __init__(self, fronts: list[_Front], outer: np.ndarray, schur: np.ndarray | None = None) -> None:
        self.fronts, self.kept, self.schur = fronts, outer, schur

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, np.ndarray]) -> "Fronts":
        """The way back from ``arrays``; they are not copied."""
        unknowns, values, fronts, at, begin = arrays["unknowns"], arrays["factors"], [], 0, 0
        for s, b in arrays["sizes"].tolist():
            inner, border = unknowns[at : at + s], unknowns[at + s : at + s + b]
            lower = values[begin : begin + s * s].reshape((s, s), order="F")
            across = values[begin + s * s : begin + s * (s + b)].reshape((s, b), order="F")
            fronts.append(_Front(inner, border, lower, across))
            at, begin = at + s + b, begin + s * (s + b)
        return cls(fronts, arrays["kept"])

    def arrays(self) -> dict[str, np.ndarray]:
        """All but the Schur complement: sizes (fronts, 2), unknowns, factors, kept."""
        sizes = [(len(front.inner), len(front.border)) for front in self.fronts]
        factors = np.empty(sum(s * (s + b) for s, b in sizes), dtype=np.float32)
        begin = 0
        for front, (s, b) in zip(self.fronts, sizes, strict=True):
            factors[begin : begin + s * s] = front.lower.ravel(order="F")
            factors[begin + s * s : begin + s * (s + b)] = front.across.ravel(order="F")
            begin += s * (s + b)
        unknowns = [np.concatenate([front.inner, front.border]) for front in self.fronts]
        every = np.concatenate([np.zeros(0, dtype=np.int64), *unknowns])
        return {
            "sizes": np.array(sizes, dtype=np.int64).reshape(-1, 2),
            "unknowns": every,
            "factors": factors,
            "kept": self.kept,
        }

    @property
    def bytes(self) -> int:
        """Memory of the factors."""
        return sum(front.lower.nbytes + front.across.nbytes for front in self.fronts)

    def forward(self, right: np.ndarray) -> None:
        """Eliminate in place: of right sides (3 n, k) float32, what is left acts on the retained unknowns."""
        from scipy.linalg.blas import strsm

        for front in self.fronts:
            part = strsm(1.0, front.lower, right[front.inner].T, side=1, lower=1, trans_a=1).T
            right[front.inner] = part
            if front.border.size:
                right[front.border] -= front.across.T @ part

    def backward(self, values: np.ndarray) -> None:
        """In place: ``values`` (3 n, k) float32 holds what ``forward`` left, with the solution at the retained unknowns."""
        from scipy.linalg.blas import strsm

        for front in reversed(self.fronts):
            part = values[front.inner]
            if front.border.size:
                part -= front.across @ values[front.border]
            values[front.inner] = strsm(1.0, front.lower, part.T, side=1, lower=1, trans_a=0).T


def factored(
    dissection: _Dissection,
    cells: np.ndarray,
    matrices: Callable[[slice], np.ndarray],
    free: np.ndarray,
    on_front: Callable[[int, int], None] | None = None,
) -> Fronts:
    """Eliminate all unknowns but those retained.

    dissection : _Dissection;  cells : (m, 8) uint32, in the order of the dissection
    matrices : function of a slice of these cells -> (k, 24, 24);  free : (3 n,) bool, unknowns; the others are zero
    on_front : called after each front with the work done and that of all, in millions of operations; optional

    ConvergenceError: A singular matrix: a motion that neither the retained nodes nor supports hold.
    """
    position = np.full(len(free), -1, dtype=np.int64)
    waiting: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    fronts: list[_Front] = []
    count = len(dissection.domains)
    sizes = [(3 * len(domain.inner), 3 * len(domain.border)) for domain in dissection.domains]
    # Millions of multiplications that each front takes.
    work = np.cumsum([int(1e-6 * (s**3 / 3 + s * s * b + s * b * b)) + 1 for s, b in sizes]).tolist()
    for number, domain in enumerate(dissection.domains):
        inner, border = _unknowns(domain.inner, free), _unknowns(domain.border, free)
        s, size = len(inner), len(inner) + len(border)
        position[inner], position[border] = np.arange(s), np.arange(s, size)
        front = np.zeros((size, size), order="F")
        if domain.cells is not None and size:
            part = slice(*domain.cells)
            _add_cells(position, cells[part], matrices(part), front)
        for child in domain.children:
            unknowns, schur = waiting.pop(child)
            if size:  # no unknown where all nodes are held
                _add_front(position[unknowns], schur, front)
        position[inner] = position[border] = -1
        waiting[number] = border, _eliminate(front, s, inner, border, fronts)
        if on_front is not None:
            on_front(work[number], work[-1])
    interface, schur = waiting.pop(count - 1)
    return Fronts(fronts, interface, np.tril(schur) + np.tril(schur, -1).T)


def _unknowns(nodes: np.ndarray, free: np.ndarray) -> np.ndarray:
    unknowns = of_nodes(nodes)
    return unknowns[free[unknowns]]


def _eliminate(front: np.ndarray, s: int, inner: np.ndarray, border: np.ndarray, fronts: list[_Front]) -> np.ndarray:
    """Keep the factors of the first s unknowns; the Schur complement of the others, lower triangle."""
    from scipy.linalg.blas import dsyrk, dtrsm
    from scipy.linalg.lapack import dpotrf

    if not s:
        return front
    diagonal = np.diagonal(front)[:s].copy()
    lower, info = dpotrf(np.asfortranarray(front[:s, :s]), lower=1, clean=0, overwrite_a=1)
    if info or (np.diagonal(lower) ** 2 < _ROUNDING * diagonal).any():
        raise ConvergenceError("the stiffness of a body is singular: a part is unconstrained")
    across = dtrsm(1.0, lower, np.asfortranarray(front[s:, :s].T), lower=1, overwrite_b=1)
    complement = np.asfortranarray(front[s:, s:])
    del front
    fronts.append(_Front(inner, border, *(np.asarray(x, dtype=np.float32, order="F") for x in (lower, across))))
    if not len(border):
        return complement
    return np.asarray(dsyrk(-1.0, across, beta=1.0, c=complement, trans=1, lower=1, overwrite_c=1))
