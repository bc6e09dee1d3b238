"""Quality of cells (scaled Jacobian, aspect, skew), and refusal of those that cannot be computed with.

Knupp, Ernst, Thompson, Stimpson, Pebay: The Verdict geometric quality library, SAND2007-1751 (2007): scaled Jacobian,
edge ratio, skew of hexahedra.
"""

from collections.abc import Mapping

import attrs
import numpy as np

from raceway.core.fem.mesh.hex_mesh import BLOCK, EDGES, HexMesh
from raceway.errors import MeshError

#: Neighbours of each corner along the three local axes, in right-handed order.
_AROUND = np.array([[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]])
#: A scaled Jacobian below this is flat to the rounding of coordinates.
DEGENERATE = 1e-6


@attrs.frozen(eq=False)
class _Quality:
    #: (m,) smallest determinant of the unit edge vectors at the corners: 1 for a cuboid, <= 0 is inverted
    scaled_jacobian: np.ndarray
    aspect: np.ndarray  # (m,) longest edge / shortest edge
    skew: np.ndarray  # (m,) largest |cosine| between the cell's principal axes: 0 for a cuboid


def cell_quality(mesh: HexMesh) -> _Quality:
    """Quality of every cell; flat cells get a scaled Jacobian of 0 and an infinite aspect."""
    count = len(mesh.cells)
    jacobian, aspect, skew = np.empty(count), np.empty(count), np.empty(count)
    for first in range(0, count, BLOCK):
        here = slice(first, first + BLOCK)
        # (3, 8, k): components outermost, so that every product below runs along contiguous memory.
        corner = np.ascontiguousarray(mesh.points[mesh.cells[here]].transpose(2, 1, 0))
        edge = corner[:, EDGES[:, 1]] - corner[:, EDGES[:, 0]]
        length = np.sqrt((edge * edge).sum(axis=0))
        shortest, longest = length.min(axis=0), length.max(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            aspect[here] = np.where(shortest > 0.0, longest / shortest, np.inf)
        worst = np.full(corner.shape[2], np.inf)
        for at, ends in enumerate(_AROUND):
            worst = np.minimum(worst, _unit_determinant(*(corner[:, end] - corner[:, at] for end in ends)))
        jacobian[here] = worst
        axes = [edge[:, 4 * i : 4 * i + 4].sum(axis=1) for i in range(3)]
        skew[here] = np.maximum.reduce([_cosine(axes[i], axes[(i + 1) % 3]) for i in range(3)])
    return _Quality(jacobian, aspect, skew)


def refuse_bad_cells(mesh: HexMesh, body: str = "") -> _Quality:
    """The quality, unless a cell is inverted or degenerate.

    MeshError: How many cells, the first of them, its centre and its nodes.
    """
    measures = cell_quality(mesh)
    bad = np.flatnonzero(measures.scaled_jacobian < DEGENERATE)
    if not len(bad):
        return measures
    cell = int(bad[0])
    value = float(measures.scaled_jacobian[cell])
    word = "inverted" if value < -DEGENERATE else "degenerate"
    centre = ", ".join(f"{x:.6g}" for x in mesh.points[mesh.cells[cell]].mean(axis=0))
    nodes = ", ".join(str(node) for node in mesh.cells[cell])
    where = f"`{body}`: " if body else ""
    raise MeshError(
        f"{where}{len(bad)} of {len(mesh.cells)} cells are inverted or degenerate; the first is cell {cell}, {word} (scaled "
        f"Jacobian {value:.3g}), centre ({centre}) m, nodes {nodes}. Nodes 0 to 3 of a cell go around its bottom, 4 to 7 "
        "stand above them: check their order, and points that coincide"
    )


def _unit_determinant(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """a . (b x c) of vectors (3, k), divided by their lengths; 0 where one has none."""
    value = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    size = np.sqrt((a * a).sum(axis=0) * (b * b).sum(axis=0) * (c * c).sum(axis=0))
    return np.where(size > 0.0, value / np.where(size > 0.0, size, 1.0), 0.0)


def _cosine(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    size = np.sqrt((a * a).sum(axis=0) * (b * b).sum(axis=0))
    return np.where(size > 0.0, np.abs((a * b).sum(axis=0)) / np.where(size > 0.0, size, 1.0), 1.0)


#: Bytes a cell that a mesh keeps: points, cells, sets (92 to 104 measured, more where sets are many).
_BYTES_KEPT = 110
#: Bytes a cell beside them while a structured mesh is made and judged (80 to 103 measured, 1.1 and 0.5 million cells).
_BYTES_BESIDE = 120
#: Above this a mesh is refused [bytes].
MEMORY_LIMIT = 4 * 2**30


@attrs.frozen
class Prediction:
    """Size of meshes that have not been made.

    Attributes
    ----------
    bodies : name of the body -> number of hexahedra
    beside_bytes : what is needed at the peak beside the meshes themselves
    """

    bodies: dict[str, int]
    beside_bytes: int

    @classmethod
    def of(cls, bodies: Mapping[str, float], beside_bytes: float | None = None) -> "Prediction":
        """The prediction for bodies of so many cells; by default with what a structured mesh needs beside."""
        if beside_bytes is None:
            beside_bytes = _BYTES_BESIDE * sum(bodies.values())
        return cls({name: int(cells) for name, cells in bodies.items()}, int(beside_bytes))

    @property
    def cells(self) -> int:
        """Hexahedra of all bodies."""
        return sum(self.bodies.values())

    @property
    def memory_bytes(self) -> int:
        """Bytes at the peak, while the meshes are made and judged."""
        return sum(map(body_bytes, self.bodies.values())) + self.beside_bytes


def body_bytes(cells: int) -> int:
    """Bytes that a mesh of so many cells keeps."""
    return _BYTES_KEPT * cells


def refuse_memory(prediction: Prediction, key: str, value: float | str, remedy: str) -> None:
    """Refuse what will not fit.

    MeshError: With the predicted number of elements and bytes.
    """
    if prediction.memory_bytes > MEMORY_LIMIT:
        elements, limit = f"{float(prediction.cells):.3g} elements", f"{MEMORY_LIMIT / 2**30:.0f} GiB"
        why = f"would give about {elements} and take {prediction.memory_bytes / 2**30:.3g} GiB, above {limit}: {remedy}"
        raise MeshError.at(key, value, why)


def refuse_coarse(size: float, wall: float, where: str) -> None:
    """Refuse elements that are larger than what they shall fill.

    MeshError: With both numbers.
    """
    if size > wall:
        why = f"is larger than the {where}, {wall:.4g} m: use no more than that, in metres"
        raise MeshError.at("mesh.element_size", size, why)
