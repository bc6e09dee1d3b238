"""What this package adds to ``raceway``: meshes from gmsh and from files."""

from raceway import hookimpl


@hookimpl
def raceway_meshers() -> dict[str, str]:
    return {"file": "raceway_meshing.mesh_files:File", "gmsh": "raceway_meshing.gmsh:Gmsh"}


@hookimpl
def raceway_formats() -> dict[str, str]:
    return {
        "vtu": "raceway_meshing.formats:Vtu",
        "abaqus": "raceway_meshing.abaqus:Abaqus",
        "msh": "raceway_meshing.formats:Msh",
    }
