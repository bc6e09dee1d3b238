"""Hexahedral meshes: points, cells, named sets of nodes and of facets; volume, areas, normals, merging, renumbering; shape functions.

Nodes of a cell stand in VTK's order: 0 to 3 around the bottom, 4 to 7 above them.  A facet is a cell and one of its six
local faces (``FACES``), which are Abaqus's S1 to S6 in the same order.
"""

import difflib
from collections.abc import Mapping
from math import ceil, cos, log, pi, sin
from typing import Any

import attrs
import numpy as np
from numpy.typing import NDArray

from raceway.errors import MeshError
from raceway.storage.tables import ReadTables, Tables

#: (6, 4) nodes of the local faces, anticlockwise seen from outside.
FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
#: (12, 2) nodes of the local edges: four along each local axis.
EDGES = np.array([[0, 1], [3, 2], [4, 5], [7, 6], [0, 3], [1, 2], [4, 7], [5, 6], [0, 4], [1, 5], [2, 6], [3, 7]])
#: (8, 3) local coordinates of the nodes, -1 or 1.
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
#: Cells that are worked on at once, so that temporary arrays stay small.
BLOCK = 65536


def floats(value: object) -> np.ndarray:
    return np.ascontiguousarray(value, dtype=np.float64)


def integers(value: object) -> np.ndarray:
    return np.ascontiguousarray(value, dtype=np.int64)


def _node_sets(value: ReadTables) -> dict[str, np.ndarray]:
    return {str(name): np.unique(np.asarray(nodes, dtype=np.int64)) for name, nodes in value.items()}


def _facet_sets(value: ReadTables) -> dict[str, np.ndarray]:
    out = {}
    for name, facets in value.items():
        pairs = np.asarray(facets, dtype=np.int64).reshape(-1, 2)
        keys = np.unique(6 * pairs[:, 0] + pairs[:, 1])
        out[str(name)] = np.column_stack([keys // 6, keys % 6])
    return out


@attrs.frozen(eq=False)
class HexMesh:
    """One body, or several.

    Attributes
    ----------
    points : (n, 3) float64 [m]
    cells : (m, 8) int64, nodes in VTK's order
    node_sets : name -> (k,) int64, ascending
    facet_sets : name -> (k, 2) int64, cell and local face, ascending
    """

    points: np.ndarray = attrs.field(converter=floats)
    cells: np.ndarray = attrs.field(converter=integers)
    node_sets: dict[str, np.ndarray] = attrs.field(factory=dict, converter=_node_sets, repr=False)
    facet_sets: dict[str, np.ndarray] = attrs.field(factory=dict, converter=_facet_sets, repr=False)

    def __attrs_post_init__(self) -> None:
        points, cells = self.points, self.cells
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise MeshError(f"points have the shape {points.shape}; it must be (n, 3) with at least one point")
        if cells.ndim != 2 or cells.shape[1] != 8 or not len(cells):
            raise MeshError(f"cells have the shape {cells.shape}; it must be (m, 8), hexahedra, with at least one cell")
        if not np.isfinite(points).all():
            bad = int(np.argmin(np.isfinite(points).all(axis=1)))
            raise MeshError(f"point {bad} has a coordinate that is not a finite number: {points[bad]}")
        if cells.min() < 0 or cells.max() >= len(points):
            bad = int(np.argmax((cells < 0).any(axis=1) | (cells >= len(points)).any(axis=1)))
            raise MeshError(f"cell {bad} names a point that does not exist: {cells[bad]} of {len(points)} points")
        for name, nodes in self.node_sets.items():
            if len(nodes) and (nodes[0] < 0 or nodes[-1] >= len(points)):
                raise MeshError(f"node set '{name}' names a point that does not exist: there are {len(points)}")
        for name, facets in self.facet_sets.items():
            if len(facets) and (facets[0, 0] < 0 or facets[-1, 0] >= len(cells)):
                raise MeshError(f"facet set '{name}' names a cell that does not exist: there are {len(cells)}")

    @property
    def memory_bytes(self) -> int:
        """Bytes of all arrays."""
        arrays = [self.points, self.cells, *self.node_sets.values(), *self.facet_sets.values()]
        return sum(array.nbytes for array in arrays)

    def nodes(self, name: str) -> np.ndarray:
        """(k,) nodes of a node set.

        MeshError: A set that is missing, with the nearest name, or empty.
        """
        return _member(self.node_sets, name, "node")

    def facets(self, name: str) -> np.ndarray:
        """(k, 2) cells and local faces of a facet set; raises ``MeshError`` as ``nodes`` does."""
        return _member(self.facet_sets, name, "facet")

    def facet_nodes(self, name: str) -> np.ndarray:
        """(k, 4) nodes of the facets of a set, anticlockwise seen from outside."""
        facets = self.facets(name)
        return self.cells[facets[:, :1], FACES[facets[:, 1]]]

    def cell_volumes(self) -> np.ndarray:
        """(m,) volumes [m3] by 2 x 2 x 2 Gauss points, which is exact: the determinant is quadratic in each coordinate."""
        slopes = shape_slopes(CORNERS / np.sqrt(3.0)).swapaxes(1, 2).reshape(24, 8)
        out = np.empty(len(self.cells))
        for first in range(0, len(out), BLOCK):
            corner = self.points[self.cells[first : first + BLOCK]]
            jacobian = np.matmul(slopes, corner).reshape(-1, 8, 3, 3)
            a, b, c = jacobian[:, :, 0], jacobian[:, :, 1], jacobian[:, :, 2]
            out[first : first + BLOCK] = np.einsum("mgi,mgi->m", a, np.cross(b, c))
        return out

    def volume(self) -> float:
        """Volume [m3]."""
        return float(self.cell_volumes().sum())

    def facet_areas(self, name: str) -> np.ndarray:
        """(k,) areas [m2] of the bilinear facets of a set, by 2 x 2 Gauss points."""
        a, b, c, d = np.moveaxis(self.points[self.facet_nodes(name)], 1, 0)
        total = np.zeros(len(a))
        for s in (-1.0, 1.0):
            for t in (-1.0, 1.0):
                u, v = s / np.sqrt(3.0), t / np.sqrt(3.0)
                along = (1 - v) * (b - a) + (1 + v) * (c - d)
                across = (1 - u) * (d - a) + (1 + u) * (c - b)
                total += np.linalg.norm(np.cross(along, across), axis=1) / 16.0
        return total

    def renumbered(self) -> "HexMesh":
        """The same mesh with neighbours near each other in memory.

        Nodes by reverse Cuthill-McKee on the graph of the cells' edges, unless the given numbers are nearer already, as
        those of swept meshes are; cells by their smallest node.
        """
        count = len(self.points)
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        pairs = self.cells.astype(np.int32)[:, EDGES].reshape(-1, 2)
        # Each edge once: cells that share it repeat it, and the conversion would carry all of them along.
        keys = np.unique(pairs.min(axis=1).astype(np.int64) * count + pairs.max(axis=1))
        low, high = keys // count, keys % count
        rows, columns = np.concatenate([low, high]), np.concatenate([high, low])
        graph = coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(count, count)).tocsr()
        order = np.asarray(reverse_cuthill_mckee(graph, symmetric_mode=True), dtype=np.int64)
        rank = np.empty(len(order), dtype=np.int64)
        rank[order] = np.arange(len(order))
        cells = rank[self.cells]
        if np.ptp(cells, axis=1).sum() >= np.ptp(self.cells, axis=1).sum():
            order = rank = np.arange(len(order))
            cells = self.cells
        sequence = np.argsort(cells.min(axis=1), kind="stable")
        cell_rank = np.empty(len(sequence), dtype=np.int64)
        cell_rank[sequence] = np.arange(len(sequence))
        node_sets = {name: rank[nodes] for name, nodes in self.node_sets.items()}
        facet_sets = {name: np.column_stack([cell_rank[f[:, 0]], f[:, 1]]) for name, f in self.facet_sets.items()}
        return HexMesh(self.points[order], cells[sequence], node_sets, facet_sets)


def merged(meshes: Mapping[str, HexMesh]) -> HexMesh:
    """Several meshes as one, points not shared; set ``s`` of body ``b`` is called ``b.s``, all cells of ``b`` also ``b``.

    MeshError: No mesh at all.
    """
    if not meshes:
        raise MeshError("there is no mesh to merge")
    node_sets: Tables = {}
    facet_sets: Tables = {}
    cells, point, cell = [], 0, 0
    for body, mesh in meshes.items():
        cells.append(mesh.cells + point)
        node_sets[body] = np.arange(point, point + len(mesh.points))
        node_sets.update({f"{body}.{name}": nodes + point for name, nodes in mesh.node_sets.items()})
        facet_sets.update({f"{body}.{name}": facets + [cell, 0] for name, facets in mesh.facet_sets.items()})
        point, cell = point + len(mesh.points), cell + len(mesh.cells)
    return HexMesh(np.concatenate([m.points for m in meshes.values()]), np.concatenate(cells), node_sets, facet_sets)


def boundary(cells: np.ndarray) -> np.ndarray:
    """(k, 2) facets that belong to one cell only: the surface."""
    nodes = np.sort(cells[:, FACES].reshape(-1, 4), axis=1)
    order = np.lexsort(nodes.T)
    sequence = nodes[order]
    alike = (sequence[1:] == sequence[:-1]).all(axis=1)
    single = ~(np.r_[False, alike] | np.r_[alike, False])
    keys = np.sort(order[single])
    return np.column_stack([keys // 6, keys % 6])


def nodes_of(cells: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """(k,) nodes of facets, ascending."""
    return np.unique(cells[facets[:, :1], FACES[facets[:, 1]]])


def shape_slopes(at: np.ndarray) -> np.ndarray:
    """(p, 8, 3) derivatives of the shape functions along xi, eta, zeta at points (p, 3) of the reference cube."""
    parts = 1.0 + at[:, None, :] * CORNERS
    out = np.empty((len(at), 8, 3))
    for k in range(3):
        out[:, :, k] = CORNERS[:, k] * parts[:, :, (k + 1) % 3] * parts[:, :, (k + 2) % 3] / 8.0
    return out


def _member(sets: dict[str, np.ndarray], name: str, kind: str) -> np.ndarray:
    if name not in sets:
        close = difflib.get_close_matches(name, list(sets), n=1, cutoff=0.4)
        hint = f" (did you mean '{close[0]}'?)" if close else ""
        raise MeshError(f"the mesh has no {kind} set '{name}'{hint}; it has {', '.join(sorted(sets)) or 'none'}")
    members = sets[name]
    if not len(members):
        full = [filled for filled in sorted(sets) if len(sets[filled])]
        raise MeshError(f"{kind} set '{name}' is empty; sets that are not: {', '.join(full) or 'none'}")
    return members


def azimuth(bearing: Any, index: int) -> float:
    """Azimuth of a ball [rad], from +y towards +z."""
    return float(bearing.first_ball_azimuth_deg * pi / 180.0 + 2.0 * pi * index / bearing.ball_count)


def ball_names(bearing: Any) -> list[str]:
    """ball_00, ball_01, ..., with as many digits as the largest needs."""
    digits = len(str(bearing.ball_count - 1))
    return [f"ball_{index:0{digits}d}" for index in range(bearing.ball_count)]


def placed(points: np.ndarray, bearing: Any, psi: float, side: float = 1.0, axial: float = 0.0) -> np.ndarray:
    """A ball's points (n, 3) from its own axes (rolling, across, towards the outer contact) to its place in the bearing."""
    alpha = bearing.contact_angle
    radial = np.array([0.0, cos(psi), sin(psi)])
    u = np.array([0.0, -sin(psi), cos(psi)])
    w = np.array([side * sin(alpha), 0.0, 0.0]) + cos(alpha) * radial
    v = np.cross(w, u)
    centre = 0.5 * bearing.pitch_diameter * radial + [axial, 0.0, 0.0]
    return np.asarray(points @ np.stack([u, v, w]) + centre)


def growing(length: float, first: float, coarse: float, growth: float) -> np.ndarray:
    """(n + 1,) points from 0 to ``length``: distances start at ``first`` or less, grow by ``growth``, end at ``coarse``.

    The row of distances first * growth^i, cut at ``coarse``, is continued until it is long enough and then shrunk by one
    factor to fit, so that no distance exceeds what was asked.
    """
    if length <= 0.0:
        return np.zeros(1)
    first = min(first, coarse)
    rising = ceil(log(coarse / first) / log(growth)) if first < coarse else 0
    steps = first * growth ** np.arange(rising)
    reach = steps.sum()
    if reach < length:
        steps = np.r_[steps, np.full(max(ceil((length - reach) / coarse - 1e-9), 1), coarse)]
    points = np.r_[0.0, np.cumsum(steps)]
    last = int(np.searchsorted(points, length * (1.0 - 1e-9)))
    return points[: last + 1] * (length / points[last])


def graded(
    low: float, high: float, fine_low: float, fine_high: float, fine: float, coarse: float, growth: float
) -> np.ndarray:
    """Points from ``low`` to ``high``: distance ``fine`` between ``fine_low`` and ``fine_high``, growing outside of them.

    The zone's number of cells is even, so that a point lies in its middle.
    """
    fine = min(fine, coarse)
    fine_low, fine_high = max(fine_low, low), min(fine_high, high)
    cells = 2 * max(ceil((fine_high - fine_low) / (2.0 * fine) - 1e-9), 1)
    zone = np.linspace(fine_low, fine_high, cells + 1)
    size = min(growth * (fine_high - fine_low) / cells, coarse)
    below = fine_low - growing(fine_low - low, size, coarse, growth)[:0:-1]
    above = fine_high + growing(high - fine_high, size, coarse, growth)[1:]
    return np.concatenate([below, zone, above])


Floats = NDArray[np.float64]

#: (8, 4) Nodal values of eta zeta, xi zeta, xi eta and xi eta zeta: what a constant gradient does not see.
HOURGLASS: Floats = np.column_stack([CORNERS[:, [1, 0, 0]] * CORNERS[:, [2, 2, 1]], CORNERS.prod(axis=1)])


def shape_values(at: Floats) -> Floats:
    """(p, 8) Shape functions at points (p, 3) of the reference cube."""
    return np.asarray(np.prod(1.0 + at[:, None, :] * CORNERS, axis=2) / 8.0)


def gauss(count: int) -> tuple[Floats, Floats]:
    """Points (count^3, 3) and weights of the Gauss rule on the reference cube."""
    x, w = np.polynomial.legendre.leggauss(count)
    grid = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return grid, np.einsum("i,j,k->ijk", w, w, w).ravel()


def jacobians(corners: Floats, slopes: Floats) -> Floats:
    """(k, p, 3, 3) d(x_i) / d(xi_j) of elements with corners (k, 8, 3) at p points."""
    return np.asarray(np.einsum("kni,pnj->kpij", corners, slopes, optimize=True))


def determinants(jacobian: Floats) -> Floats:
    """(...) of matrices (..., 3, 3): six times as quick as a factorisation of each."""
    a, b, c = (jacobian[..., i, :] for i in range(3))
    return np.asarray(
        a[..., 0] * (b[..., 1] * c[..., 2] - b[..., 2] * c[..., 1])
        + a[..., 1] * (b[..., 2] * c[..., 0] - b[..., 0] * c[..., 2])
        + a[..., 2] * (b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0])
    )


def mean_gradients(corners: Floats) -> tuple[Floats, Floats]:
    """Exact means of the gradients of the shape functions (k, 8, 3) [1/m], and volumes (k,) [m3].

    The 2 x 2 x 2 rule is exact: the integrand, slopes times cofactors, is quadratic in each coordinate.
    """
    slopes = shape_slopes(gauss(2)[0])
    jacobian = jacobians(corners, slopes)
    determinant = determinants(jacobian)
    cofactors = determinant[..., None, None] * np.linalg.inv(jacobian)
    volume = determinant.sum(axis=1)
    return np.einsum("pnj,kpji->kni", slopes, cofactors, optimize=True) / volume[:, None, None], volume


def centre_gradients(corners: Floats) -> Floats:
    """(k, 8, 3) Gradients of the shape functions at the elements' centres [1/m]."""
    slopes = shape_slopes(np.zeros((1, 3)))
    return np.asarray(slopes[0] @ np.linalg.inv(jacobians(corners, slopes)[:, 0]))
