"""The stiffness of a mesh as rows of 3 x 3 blocks, and its product with the displacements of many copies at once.

A matrix is read from memory once for all copies: on 60 000 elements with incompatible modes the forces of twelve copies take a
hundredth of what the same elements take one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import attrs
import numpy as np
from numba import int32, int64, uint64, void
from numpy.typing import NDArray

from raceway.core.fem.hexahedron.stiffness import WIDTH, add_to_sparse
from raceway.core.fem.mesh.hex_mesh import (
    Floats,
    centre_gradients,
    determinants,
    gauss,
    jacobians,
    mean_gradients,
    shape_slopes,
    shape_values,
)
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, VECTOR
from raceway.errors import MeshError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Elements of a batch: some 50 MB of work space.
BATCH = 16384


def batches(count: int, size: int = BATCH) -> Iterator[slice]:
    """Slices that cover ``count`` elements."""
    return (slice(begin, min(begin + size, count)) for begin in range(0, count, size))


def nodal_volumes(points: Floats, cells: NDArray[np.uint32]) -> Floats:
    """(m, 8) Integral of each shape function over each element [m3]; the 2 x 2 x 2 rule is exact.

    MeshError: An element whose Jacobian is not positive at a Gauss point, or that holds a coordinate that is not finite.
    """
    at, weights = gauss(2)
    slopes, values = shape_slopes(at), shape_values(at)
    out = np.empty((len(cells), 8))
    for part in batches(len(cells)):
        with np.errstate(invalid="ignore"):  # a coordinate that is no number is refused below
            determinant = determinants(jacobians(points[cells[part]], slopes))
        bad = ~(determinant > 0.0).all(axis=1)
        if bad.any():
            e = part.start + int(np.argmax(bad))
            raise MeshError(
                f"element {e} is inverted or degenerate: the determinant of its Jacobian falls to "
                f"{determinant[e - part.start].min():.3g} m3 at a Gauss point; it must be positive. Check the order of its nodes (VTK's hexahedron) and its shape"
            )
        out[part] = np.einsum("kp,pn->kn", determinant * weights, values)
    return out


#: Ranges of a mesh, and the most threads that can share it; fewer where elements would be less than this in each.
RANGES, _FEWEST = 8, 4096


def divide(cells: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Ranges of whole blocks of elements.

    returns : (at most RANGES, 5) first element, last element + 1, first node, last node + 1, first node's place among the parts

    The elements are cut into contiguous ranges, always the same for one mesh.  Each range has its own forces for the nodes
    between its lowest and its highest; these parts are added in the order of the ranges, whoever computed them.  On a mesh
    whose numbers follow its shape the parts hardly overlap.
    """
    blocks = -(-len(cells) // WIDTH)
    edges = np.unique(np.linspace(0, blocks, min(RANGES, 1 + len(cells) // _FEWEST) + 1).astype(np.int64)) * WIDTH
    edges[-1] = len(cells)
    rows, offset = [], 0
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        low, high = int(cells[first:last].min()), int(cells[first:last].max()) + 1
        rows.append((first, last, low, high, offset))
        offset += high - low
    return np.array(rows, dtype=np.int64)


@jit(void(int64, int64, int64[:, ::1], VECTOR, VECTOR), releases=True)
def add_parts(first, last, ranges, parts, f):  # type: ignore[no-untyped-def]
    """Forces of the nodes ``first`` to ``last - 1``: the sum over the ranges, in their order."""
    for i in range(uint64(3 * first), uint64(3 * last)):  # unsigned: no index counts from the end
        f[i] = 0.0
    for r in range(ranges.shape[0]):
        begin, end = max(first, ranges[r, 2]), min(last, ranges[r, 3])
        shift = uint64(3 * (ranges[r, 4] - ranges[r, 2]))
        for i in range(uint64(3 * begin), uint64(3 * max(begin, end))):
            f[i] += parts[i + shift]


def centre_stress(points: Floats, cells: NDArray[np.uint32], u: Floats, moduli: Floats, formulation: str) -> Floats:
    """(m, 6) Stresses at the elements' centres [Pa] of displacements u (n, 3) [m], xx yy zz xy yz zx.

    "one_point" knows its mean gradient only, "mean_dilatation" takes the volume change from it; incompatible modes
    have no gradient at the centre.
    """
    out = np.empty((len(cells), 6))
    lame, shear = moduli[0], moduli[1]
    for part in batches(len(cells)):
        corners, displacement = points[cells[part]], u[cells[part]]
        mean, _ = mean_gradients(corners)
        at = mean if formulation == "one_point" else centre_gradients(corners)
        gradient = np.einsum("kni,knj->kij", displacement, at)
        trace = np.trace(gradient, axis1=1, axis2=2)
        change = np.einsum("kni,kni->k", displacement, mean) if formulation == "mean_dilatation" else trace
        for k in range(3):
            out[part, k] = (lame + 2.0 * shear / 3.0) * change + 2.0 * shear * (gradient[:, k, k] - trace / 3.0)
            after = (k + 1) % 3
            out[part, 3 + k] = shear * (gradient[:, k, after] + gradient[:, after, k])
    return out


def von_mises(stress: Floats) -> Floats:
    """(m,) Equivalent stress [Pa] of stresses (m, 6), xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2)))


def largest_shear(stress: Floats) -> Floats:
    """(m,) Half the difference of the outer principal stresses [Pa] of stresses (m, 6)."""
    out = np.empty(len(stress))
    for part in batches(len(stress)):
        xx, yy, zz, xy, yz, zx = stress[part].T
        matrix = np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=1).reshape(-1, 3, 3)
        principal = np.linalg.eigvalsh(matrix)
        out[part] = 0.5 * (principal[:, 2] - principal[:, 0])
    return out


@jit(void(int64, int64[::1], int32[::1], int64[::1], int32[::1]))
def _spread_blocks(components, starts, neighbours, row_starts, columns):  # type: ignore[no-untyped-def]
    """Rows and columns of a node-by-node pattern with ``components`` unknowns a node."""
    at = 0
    row_starts[0] = 0
    for node in range(starts.size - 1):
        for a in range(components):
            for p in range(starts[node], starts[node + 1]):
                for b in range(components):
                    columns[at] = components * neighbours[p] + b
                    at += 1
            row_starts[components * node + a + 1] = at


def _assemble_blocks(
    cells: NDArray[np.uint32], count: int, components: int, element_matrices: Callable[[slice], Floats]
) -> tuple[NDArray[np.int64], NDArray[np.int32], Floats]:
    """Starts (count + 1,), neighbours and the rows of a node after each other.  Parameters: see ``assemble``."""
    # The sorted nodes that share an element with each node
    from scipy.sparse import csr_array

    size = 8 * len(cells)
    rows = np.arange(0, size + 1, 8, dtype=np.int32 if size < 2**31 else np.int64)
    incidence = csr_array((np.ones(size, dtype=np.int8), cells.ravel().astype(rows.dtype), rows), shape=(len(cells), count))
    pattern = (incidence.T.tocsr() @ incidence).tocsr()
    pattern.sort_indices()
    starts, neighbours = pattern.indptr.astype(np.int64), pattern.indices.astype(np.int32)
    data = np.zeros(components**2 * len(neighbours))
    for part in batches(len(cells), 2048):
        add_to_sparse(part.start, components, element_matrices(part), cells, starts, neighbours, data)
    return starts, neighbours, data


def assemble(
    cells: NDArray[np.uint32], count: int, components: int, element_matrices: Callable[[slice], Floats]
) -> csr_matrix:
    """Sum of element matrices, a csr_array (components count, components count).

    cells : (m, 8);  count : of nodes;  components : unknowns a node: 3 for a stiffness, 1 for the mass of one direction
    element_matrices : of a slice of elements (k, 8 components, 8 components)
    """
    from scipy.sparse import csr_array

    starts, neighbours, data = _assemble_blocks(cells, count, components, element_matrices)
    row_starts = np.empty(components * count + 1, dtype=np.int64)
    columns = np.empty(len(data), dtype=np.int32)
    _spread_blocks(components, starts, neighbours, row_starts, columns)
    if len(data) < 2**31:  # scipy's kernels are faster with short indices
        row_starts = row_starts.astype(np.int32)
    return csr_array((data, columns, row_starts), shape=(components * count, components * count))


_BATCH = 2048
#: Elements whose eigenvalues differ by less than this share are taken for equal.
_SAME = 1e-9


def stable_step(matrices: Callable[[slice], Floats], masses: Floats) -> float:
    """2 / (largest angular frequency of any single element with its share of the lumped mass) [s].

    matrices : stiffness of a slice of elements (k, 24, 24) [N/m];  masses : (m, 8) shares of the nodes' lumped masses [kg]

    No mode of the assembled mesh is faster than the fastest element (Fried 1972; Hughes, The Finite Element Method, 1987,
    section 9.1), so the step is safe.  Elements are visited in the order of a bound, the largest row sum of the scaled
    stiffness, until no bound left exceeds the largest eigenvalue found: the result is that of all elements.  Where many
    elements are alike, a Cholesky factorisation, a tenth of the time of the eigenvalues, shows that a batch holds none above it.
    """
    count = len(masses)
    bounds = np.empty(count)
    for part in batches(count, _BATCH):
        bounds[part] = np.abs(_mass_scaling(matrices(part), masses[part])).sum(axis=2).max(axis=1)
    order = np.argsort(-bounds, kind="stable")
    largest = 0.0
    # Small parts first, as on graded meshes few elements need a look
    edges = [0]
    while edges[-1] < count:
        edges.append(min(count, edges[-1] + min(_BATCH, max(64, edges[-1]))))
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        if bounds[order[begin]] <= largest:
            break
        elements = order[begin:end]
        each = [_mass_scaling(matrices(slice(e, e + 1)), masses[e : e + 1]) for e in elements.tolist()]
        frequencies_squared = np.concatenate(each)
        try:  # positive definite where all eigenvalues are below the bound
            np.linalg.cholesky(largest * (1.0 + _SAME) * np.eye(frequencies_squared.shape[-1]) - frequencies_squared)
        except np.linalg.LinAlgError:
            largest = max(largest, float(np.linalg.eigvalsh(frequencies_squared)[:, -1].max()))
    return float(2.0 / np.sqrt(largest))


def mass_factors(matrices: Callable[[slice], Floats], masses: Floats, step: float) -> Floats:
    """(m,) what the masses of elements are multiplied with so that no element by itself asks for a step below ``step`` [s].

    See ``stable_step``; 1 for all elements whose own step is as large.
    """
    out, least = np.ones(len(masses)), 4.0 / step**2
    for part in batches(len(masses), _BATCH):
        scaled = _mass_scaling(matrices(part), masses[part])
        small = np.flatnonzero(np.abs(scaled).sum(axis=2).max(axis=1) > least)
        if len(small):
            out[part.start + small] = np.maximum(np.linalg.eigvalsh(scaled[small])[:, -1] / least, 1.0)
    return out


def _mass_scaling(stiffness: Floats, mass: Floats) -> Floats:
    """M^-1/2 K M^-1/2 with three components a node."""
    root = 1.0 / np.sqrt(np.repeat(mass, 3, axis=1))
    return stiffness * root[:, :, None] * root[:, None, :]


@jit(void(int64, int64, int64[::1], int64[::1], int32[::1], VECTOR, CUBE, CUBE), releases=True)
def add_rows(first, last, nodes, starts, neighbours, data, u, force):  # type: ignore[no-untyped-def]
    """Forces on nodes[first:last], one after the other in ``force`` (m, 3, c), of displacements (n, 3, c) of c copies."""
    copies = u.shape[2]
    for row in range(first, last):
        for a in range(3):
            for c in range(copies):
                force[row, a, c] = 0.0
        begin = starts[nodes[row]]
        count = starts[nodes[row] + 1] - begin
        for p in range(count):
            column = neighbours[begin + p]
            for a in range(3):
                at = 9 * begin + 3 * (a * count + p)
                x, y, z = data[at], data[at + 1], data[at + 2]
                for c in range(copies):
                    force[row, a, c] += x * u[column, 0, c] + y * u[column, 1, c] + z * u[column, 2, c]


@attrs.frozen(eq=False)
class BlockRows:
    """A stiffness matrix."""

    starts: NDArray[np.int64]  # (n + 1,)
    #: (k,) nodes that share an element with node i, sorted: neighbours[starts[i] : starts[i + 1]]
    neighbours: NDArray[np.int32]
    data: Floats  # (9 k,) the three rows of a node after each other [N/m]

    @classmethod
    def assemble(cls, cells: NDArray[np.uint32], nodes: int, element_matrices: Callable[[slice], Floats]) -> BlockRows:
        """Sum of element matrices (k, 24, 24), which ``element_matrices`` gives for a slice of cells (m, 8)."""
        return cls(*_assemble_blocks(cells, nodes, 3, element_matrices))

    def times(self, nodes: NDArray[np.int64], displacement: Floats) -> Floats:
        """(m, 3, c) forces [N] on ``nodes`` (m,) of displacements (n, 3, c) [m]."""
        force = np.empty((len(nodes), 3, displacement.shape[2]))
        add_rows(0, len(nodes), nodes, self.starts, self.neighbours, self.data, displacement, force)
        return force
