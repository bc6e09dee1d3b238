"""Mesh files of Gmsh: hexahedra, and physical groups of quadrilaterals and points as sets."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.plugins.formats import _exchange as exchange

if TYPE_CHECKING:
    from pathlib import Path

    from raceway.core.mesh.hex_mesh import HexMesh

_GROUPS_OF_NODES, _PHYSICAL, _ENTITY = "nodes:", "gmsh:physical", "gmsh:geometrical"


@attrs.frozen
class Msh:
    """Hexahedral meshes as .msh (read: versions 2 and 4, written: 2.2); sets are physical groups of dimension 2 and 0."""

    name: ClassVar[str] = "msh"
    suffixes: ClassVar[tuple[str, ...]] = (".msh",)

    def read(self, path: Path) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        content = exchange.load(path, exchange.meshio().gmsh.read)
        cells, _ = exchange.hexahedra(path, content)
        names = {(int(tag), int(dimension)): name for name, (tag, dimension) in content.field_data.items()}
        groups: dict[str, dict[str, list[np.ndarray]]] = {"quad": {}, "vertex": {}}
        for block, tags in zip(content.cells, content.cell_data.get(_PHYSICAL, []), strict=False):
            dimension = {"quad": 2, "vertex": 0}.get(block.type, -1)
            for tag in np.unique(tags) if dimension >= 0 else ():
                name = names.get((int(tag), dimension), f"physical_{tag}") if tag else None
                if name is not None:
                    groups[block.type].setdefault(name, []).append(np.asarray(block.data)[np.asarray(tags) == tag])
        nodes = {
            name.removeprefix(_GROUPS_OF_NODES): np.concatenate(parts).ravel() for name, parts in groups["vertex"].items()
        }
        facets = {
            name: exchange.facets_of_quads(path, cells, np.concatenate(parts)) for name, parts in groups["quad"].items()
        }
        return exchange.used_only(path, content.points, cells, nodes, facets)

    def write(self, path: Path, what: HexMesh) -> None:
        """Write a mesh; node sets become groups "nodes:NAME", because a name may stand for one group only."""
        package = exchange.meshio()
        blocks, tags = [("hexahedron", what.cells)], [1]
        field_data = {"body": np.array([1, 3])}
        for name in what.facet_sets:
            if len(what.facet_sets[name]):
                tags.append(len(tags) + 1)
                blocks.append(("quad", what.facet_nodes(name)))
                field_data[name] = np.array([tags[-1], 2])
        for name, nodes in what.node_sets.items():
            if len(nodes):
                tags.append(len(tags) + 1)
                blocks.append(("vertex", nodes[:, None]))
                field_data[_GROUPS_OF_NODES + name] = np.array([tags[-1], 0])
        data = [np.full(len(block[1]), tag, dtype=np.int32) for block, tag in zip(blocks, tags, strict=True)]
        content = package.Mesh(
            what.points, blocks, cell_data={_PHYSICAL: data, _ENTITY: [d.copy() for d in data]}, field_data=field_data
        )
        exchange.store(path, lambda p, c: package.gmsh.write(p, c, fmt_version="2.2"), content)

    def example_content(self) -> HexMesh:
        return exchange.example()
