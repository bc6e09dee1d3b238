"""What this package adds to ``raceway``: meshes from gmsh and from files."""

from __future__ import annotations

from raceway import hookimpl


@hookimpl
def raceway_meshers() -> list[type]:
    from raceway_meshing.gmsh import Gmsh
    from raceway_meshing.mesh_files import File

    return [File, Gmsh]


@hookimpl
def raceway_formats() -> list[type]:
    from raceway_meshing.abaqus import Abaqus
    from raceway_meshing.formats import Msh, Vtu

    return [Vtu, Abaqus, Msh]
