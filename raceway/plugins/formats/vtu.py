"""VTK's XML files of unstructured grids, with sets as fields that ParaView can colour."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.plugins.formats import _exchange as exchange

if TYPE_CHECKING:
    from pathlib import Path

    from raceway.core.mesh.hex_mesh import HexMesh

_NODES, _FACETS = "nodes:", "facets:"


@attrs.frozen
class Vtu:
    """Hexahedral meshes as .vtu; a node set is a field of 0 and 1, a facet set a field with bit k for local face k."""

    name: ClassVar[str] = "vtu"
    suffixes: ClassVar[tuple[str, ...]] = (".vtu",)

    def read(self, path: Path) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        content = exchange.load(path, exchange.meshio().vtu.read)
        cells, first = exchange.hexahedra(path, content)
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
        return exchange.used_only(path, content.points, cells, nodes, facets)

    def write(self, path: Path, what: HexMesh) -> None:
        """Write a mesh with its sets."""
        package = exchange.meshio()
        point_data, cell_data = {}, {}
        for name, nodes in what.node_sets.items():
            point_data[_NODES + name] = np.isin(np.arange(len(what.points)), nodes).astype(np.uint8)
        for name, facets in what.facet_sets.items():
            bits = np.zeros(len(what.cells), dtype=np.uint8)
            np.bitwise_or.at(bits, facets[:, 0], (1 << facets[:, 1]).astype(np.uint8))
            cell_data[_FACETS + name] = [bits]
        content = package.Mesh(what.points, [("hexahedron", what.cells)], point_data=point_data, cell_data=cell_data)
        exchange.store(path, package.vtu.write, content)

    def example_content(self) -> HexMesh:
        return exchange.example()
