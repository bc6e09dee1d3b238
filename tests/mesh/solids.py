"""Solids for the gmsh mesher, made by Gmsh."""

from __future__ import annotations

from pathlib import Path


def write(path: Path, solid: str) -> str:
    """Write a box of 10 x 8 x 6 or a ball of radius 4 [mm] as STEP or BREP; its path."""
    import gmsh

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
