"""Mesh files by meshio: hexahedra with their sets.

.vtu   VTK's XML files of unstructured grids, with sets as fields that ParaView can colour
.msh   files of Gmsh, read only: physical groups of quadrilaterals and points as sets
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, ClassVar, TypeVar

import attrs
import numpy as np

from raceway import MeshError
from raceway.extend import HexMesh, ReadTables, memory_for, size_of, size_words

if TYPE_CHECKING:
    from meshio import Mesh

T = TypeVar("T")
#: Bytes of the largest mesh file.
LARGEST = 2**32
#: Solids that meshio knows and the kernels do not.
_SOLIDS = ("tetra", "wedge", "pyramid", "hexahedron2", "polyhedron", "voxel")


def meshio() -> ModuleType:
    """The package meshio, imported when a file is read or written."""
    import meshio as package

    return package


def load(path: Path, reader: Callable[[Path], T]) -> T:
    """What is read; MeshError, by name: a file that is missing, empty, unpacks without end, or cannot be read."""
    path = Path(path)
    size = readable(path)
    if not size:
        raise MeshError(f"'{path}' is empty")
    try:
        with memory_for(size):
            return reader(path)
    except MemoryError:
        raise MeshError(
            f"'{path}' cannot be read: its {size_words(size)} unpack to more memory than a mesh of that size needs (compressed "
            "blocks, generated sets): write it again uncompressed"
        ) from None
    except OSError as why:
        raise MeshError(f"'{path}' cannot be read: {why.strerror or why}") from why
    except Exception as why:  # meshio raises whatever its parsers stumble over
        cause = f" ({type(why).__name__}: {why})" if str(why) else ""
        raise MeshError(f"'{path}' cannot be read: it is damaged, cut off, or not of the type of its suffix{cause}") from why


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

    MeshError: Solids that are not hexahedra of 8 nodes, or no hexahedra at all.
    """
    foreign: dict[str, int] = {}
    for block in content.cells:
        if block.type.startswith(_SOLIDS):
            foreign[block.type] = foreign.get(block.type, 0) + len(block.data)
    if foreign:
        solids = ", ".join(f"{count} of type {kind}" for kind, count in foreign.items())
        raise MeshError(
            f"'{path}' has solids that are not hexahedra of 8 nodes: {solids}. Only such hexahedra are supported: mesh the "
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
    points = np.asarray(points, dtype=float)
    if points.ndim == 2 and points.shape[1] == 3 and cells.min() >= 0 and cells.max() < len(points):
        in_cells = np.zeros(len(points), dtype=bool)
        in_cells[cells] = True
        if not in_cells.all():
            number = np.cumsum(in_cells) - 1
            node_sets = {k: number[n[in_cells[n]]] for k, nodes in node_sets.items() for n in [np.asarray(nodes, dtype=int)]}
            points, cells = points[in_cells], number[cells]
    try:
        return HexMesh(points, cells, dict(node_sets), dict(facet_sets))
    except MeshError as why:
        raise MeshError(f"'{path}': {why}") from why


def facets_of_quads(path: Path | str, cells: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """(k, 2) cell and local face of quadrilaterals (k, 4) that lie on cells; MeshError where they lie on none."""
    from raceway.extend import FACES

    faces = np.sort(cells[:, FACES].reshape(-1, 4), axis=1)
    sorted_quads = np.sort(np.asarray(quads, dtype=np.int64), axis=1)
    _, number = np.unique(np.concatenate([faces, sorted_quads]), axis=0, return_inverse=True)
    number = number.reshape(-1)
    owner = np.full(number.max() + 1, -1)
    owner[number[: len(faces)]] = np.arange(len(faces))
    keys = owner[number[len(faces) :]]
    if (keys < 0).any():
        raise MeshError(f"'{path}': {(keys < 0).sum()} quadrilaterals of its sets are faces of no hexahedron")
    return np.column_stack([keys // 6, keys % 6])


def example() -> HexMesh:
    """Two cells with sets, for the conformance suite."""
    corner = [(x, y, z) for z in (0.0, 0.7) for x, y in ((0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1.3))]
    cells = [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]
    sets = {"bottom": [[0, 0], [1, 0]], "end": [[1, 3]]}
    return HexMesh(1e-3 * np.array(corner) / 3.0, np.array(cells), {"seat": [0, 3, 6, 9], "corner": [0]}, sets)


_NODES, _FACETS = "nodes:", "facets:"


@attrs.frozen
class Vtu:
    """Hexahedral meshes as .vtu; a node set is a field of 0 and 1, a facet set a field with bit k for local face k."""

    name: ClassVar[str] = "vtu"
    suffixes: ClassVar[tuple[str, ...]] = (".vtu",)

    def read(self, path: Path) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        content = load(path, meshio().vtu.read)
        cells, first = hexahedra(path, content)
        nodes = {
            name.removeprefix(_NODES): np.flatnonzero(np.asarray(values) != 0)
            for name, values in content.point_data.items()
            if name.startswith(_NODES)
        }
        facets = {}
        for name, blocks in content.cell_data.items():
            if name.startswith(_FACETS):
                parts = [np.asarray(b, dtype=int) for b, start in zip(blocks, first, strict=True) if start is not None]
                bits = np.concatenate(parts)[:, None] >> np.arange(6) & 1
                facets[name.removeprefix(_FACETS)] = np.argwhere(bits)
        return used_only(path, content.points, cells, nodes, facets)

    def write(self, path: Path, mesh: HexMesh) -> None:
        """Write a mesh with its sets."""
        package = meshio()
        point_data, cell_data = {}, {}
        for name, nodes in mesh.node_sets.items():
            point_data[_NODES + name] = np.isin(np.arange(len(mesh.points)), nodes).astype(np.uint8)
        for name, facets in mesh.facet_sets.items():
            bits = np.zeros(len(mesh.cells), dtype=np.uint8)
            np.bitwise_or.at(bits, facets[:, 0], (1 << facets[:, 1]).astype(np.uint8))
            cell_data[_FACETS + name] = [bits]
        content = package.Mesh(mesh.points, [("hexahedron", mesh.cells)], point_data=point_data, cell_data=cell_data)
        store(path, package.vtu.write, content)

    def example_content(self) -> HexMesh:
        return example()


_PHYSICAL = "gmsh:physical"


@attrs.frozen
class Msh:
    """Reads hexahedral meshes from .msh (versions 2 and 4); sets are physical groups of dimension 2 and 0."""

    name: ClassVar[str] = "msh"
    suffixes: ClassVar[tuple[str, ...]] = (".msh",)

    def read(self, path: Path) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        content = load(path, meshio().gmsh.read)
        cells, _ = hexahedra(path, content)
        names = {(int(tag), int(dimension)): name for name, (tag, dimension) in content.field_data.items()}
        groups: dict[str, dict[str, list[np.ndarray]]] = {"quad": {}, "vertex": {}}
        for block, tags in zip(content.cells, content.cell_data.get(_PHYSICAL, []), strict=False):
            dimension = {"quad": 2, "vertex": 0}.get(block.type, -1)
            for tag in np.unique(tags) if dimension >= 0 else ():
                name = names.get((int(tag), dimension), f"physical_{tag}") if tag else None
                if name is not None:
                    groups[block.type].setdefault(name, []).append(np.asarray(block.data)[np.asarray(tags) == tag])
        nodes = {name.removeprefix(_NODES): np.concatenate(parts).ravel() for name, parts in groups["vertex"].items()}
        facets = {name: facets_of_quads(path, cells, np.concatenate(parts)) for name, parts in groups["quad"].items()}
        return used_only(path, content.points, cells, nodes, facets)
