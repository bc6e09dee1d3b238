"""Common parts of the mesh formats: calls of meshio, the choice of hexahedra, facets from quadrilaterals."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from raceway.errors import MeshError, extra
from raceway.storage.tables import ReadTables
from raceway.storage.user_files import memory_for, size_of, told

if TYPE_CHECKING:
    from meshio import Mesh

    from raceway.core.mesh.hex_mesh import HexMesh

#: Bytes of the largest mesh file.
LARGEST = 2**32
#: Solids that meshio knows and the kernels do not.
_SOLIDS = ("tetra", "wedge", "pyramid", "hexahedron2", "polyhedron", "voxel")


def meshio() -> ModuleType:
    """The package meshio, or a message that names the extra."""
    try:
        import meshio as package
    except ImportError as why:
        raise MeshError(f"meshes from files need the package meshio: {extra('mesh')} ({why})") from why
    return package


def load(path: Path, reader: Callable[[Path], Mesh]) -> Mesh:
    """meshio's own mesh.

    Raises
    ------
    MeshError
        A file that is missing, empty, unpacks without end, or cannot be read, by name.
    """
    path = Path(path)
    size = readable(path)
    if not size:
        raise MeshError(f"'{path}' is empty")
    try:
        with memory_for(size):
            return reader(path)
    except MemoryError:
        raise MeshError(
            f"'{path}' cannot be read: its {told(size)} unpack to more memory than any mesh of that size takes (compressed "
            "blocks, generated sets): write it again, plainly"
        ) from None
    except OSError as why:
        raise MeshError(f"'{path}' cannot be read: {why.strerror or why}") from why
    except Exception as why:  # meshio raises whatever its parsers stumble over
        cause = f" ({type(why).__name__}: {why})" if str(why) else ""
        raise MeshError(f"'{path}' cannot be read: it is damaged, cut short, or not what its ending says{cause}") from why


def readable(path: Path | str) -> int:
    """Bytes of a mesh file; ``MeshError`` names one that is missing, a pipe, a device or too large."""
    try:
        size = size_of(path, LARGEST)
    except ValueError as why:
        raise MeshError(f"'{path}' {why}") from None
    except FileNotFoundError:
        raise MeshError(f"'{path}' does not exist") from None
    except OSError as why:
        raise MeshError(f"'{path}' cannot be read: {why.strerror or why}") from None
    if not Path(path).is_file():
        raise MeshError(f"'{path}' is a folder")
    return size


def store(path: Path, writer: Callable[[Path, Mesh], object], content: Mesh) -> None:
    """Write meshio's mesh; ``MeshError`` names a place that cannot be written."""
    try:
        writer(path, content)
    except OSError as why:
        raise MeshError(f"'{path}' cannot be written: {why.strerror or why}") from why


def hexahedra(path: Path, content: Mesh) -> tuple[np.ndarray, list[int | None]]:
    """Cells (m, 8), and for each of meshio's blocks the number of its first cell, None for blocks of other things.

    Raises
    ------
    MeshError
        Solids that are not hexahedra of 8 nodes, or no hexahedra at all.
    """
    foreign: dict[str, int] = {}
    for block in content.cells:
        if block.type.startswith(_SOLIDS):
            foreign[block.type] = foreign.get(block.type, 0) + len(block.data)
    if foreign:
        told = ", ".join(f"{count} of type {kind}" for kind, count in foreign.items())
        raise MeshError(
            f"'{path}' has solids that are not hexahedra of 8 nodes: {told}. Only such hexahedra are computed with: mesh the "
            "body again with hexahedra (kind = 'gmsh' with method = 'subdivision' splits tetrahedra into them)"
        )
    parts: list[np.ndarray] = []
    first: list[int | None] = []
    count = 0
    for block in content.cells:
        if block.type == "hexahedron" and len(block.data):
            first.append(count)
            parts.append(np.asarray(block.data, dtype=np.int64))
            count += len(block.data)
        else:
            first.append(None)
    if not parts:
        kinds = ", ".join(sorted({block.type for block in content.cells})) or "no cells"
        raise MeshError(f"'{path}' has no hexahedra; it has {kinds}")
    return np.concatenate(parts), first


def used_only(path: Path, points: np.ndarray, cells: np.ndarray, node_sets: ReadTables, facet_sets: ReadTables) -> HexMesh:
    """A ``HexMesh`` without points that no cell uses; ``MeshError`` names the file if it is none."""
    from raceway.core.mesh.hex_mesh import HexMesh

    points = np.asarray(points, dtype=float)
    if points.ndim == 2 and points.shape[1] == 3 and cells.min() >= 0 and cells.max() < len(points):
        used = np.zeros(len(points), dtype=bool)
        used[cells] = True
        if not used.all():
            place = np.cumsum(used) - 1
            node_sets = {
                name: place[n[used[n]]] for name, nodes in node_sets.items() for n in [np.asarray(nodes, dtype=int)]
            }
            points, cells = points[used], place[cells]
    try:
        return HexMesh(points, cells, dict(node_sets), dict(facet_sets))
    except MeshError as why:
        raise MeshError(f"'{path}': {why}") from why


def facets_of_quads(path: Path | str, cells: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """(k, 2) cell and local face of quadrilaterals (k, 4) that lie on cells.

    Raises
    ------
    MeshError
        Quadrilaterals on no cell.
    """
    from raceway.core.mesh.hex_mesh import FACES

    faces = np.sort(cells[:, FACES].reshape(-1, 4), axis=1)
    wanted = np.sort(np.asarray(quads, dtype=np.int64), axis=1)
    _, number = np.unique(np.concatenate([faces, wanted]), axis=0, return_inverse=True)
    number = number.reshape(-1)
    owner = np.full(number.max() + 1, -1)
    owner[number[: len(faces)]] = np.arange(len(faces))
    keys = owner[number[len(faces) :]]
    if (keys < 0).any():
        raise MeshError(f"'{path}': {(keys < 0).sum()} quadrilaterals of its sets are faces of no hexahedron")
    return np.column_stack([keys // 6, keys % 6])


def example() -> HexMesh:
    """Two cells with sets, for the conformance suite."""
    from raceway.core.mesh.hex_mesh import HexMesh

    corner = [(x, y, z) for z in (0.0, 0.7) for x, y in ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1.3))]
    cells = [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]
    sets = {"bottom": [[0, 0], [1, 0]], "end": [[1, 3]]}
    return HexMesh(1e-3 * np.array(corner) / 3.0, np.array(cells), {"seat": [0, 3, 6, 9], "corner": [0]}, sets)
