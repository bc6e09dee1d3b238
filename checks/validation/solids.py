"""Solids for the gmsh mesher, made by Gmsh, meshes as Gmsh writes them, and normals of facets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from raceway.extend import HexMesh


def write(path: Path, solid: str) -> str:
    """Write a box of 10 x 8 x 6 or a ball of radius 4 [mm] as STEP or BREP; its path."""
    import gmsh
    from raceway_meshing.gmsh import signals_as_before

    with signals_as_before():
        gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        if solid == "box":
            gmsh.model.occ.addBox(0, 0, 0, 10, 8, 6)
        else:
            gmsh.model.occ.addSphere(0, 0, 0, 4)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return str(path)


def write_msh(path: Path, mesh: HexMesh) -> None:
    """Write a mesh as .msh 2.2; facet sets are physical groups of quadrilaterals, node sets groups "nodes:NAME" of points."""
    import meshio

    blocks, tags, names = [("hexahedron", mesh.cells)], [1], {"body": np.array([1, 3])}
    for name, members, kind, dimension in (
        *((name, mesh.facet_nodes(name), "quad", 2) for name in mesh.facet_sets),
        *((f"nodes:{name}", nodes[:, None], "vertex", 0) for name, nodes in mesh.node_sets.items()),
    ):
        tags.append(len(tags) + 1)
        blocks.append((kind, members))
        names[name] = np.array([tags[-1], dimension])
    data = [np.full(len(members), tag, dtype=np.int32) for (_, members), tag in zip(blocks, tags, strict=True)]
    cell_data = {"gmsh:physical": data, "gmsh:geometrical": [part.copy() for part in data]}
    content = meshio.Mesh(mesh.points, blocks, cell_data=cell_data, field_data=names)
    meshio.gmsh.write(path, content, fmt_version="2.2")


def facet_normals(mesh: HexMesh, name: str) -> np.ndarray:
    """(k, 3) mean unit normals of the facets of a set, outward."""
    a, b, c, d = np.moveaxis(mesh.points[mesh.facet_nodes(name)], 1, 0)
    normal = np.cross(c - a, d - b)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)
