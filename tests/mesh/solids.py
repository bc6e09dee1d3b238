"""Solids for the gmsh mesher, made by Gmsh: files of data, and scripts, which are programs."""

from __future__ import annotations

from pathlib import Path

#: A quarter of a ring, [mm]: radii 15 and 19, 8 wide, axis x; a rotated rectangle of its own transfinite cells.
RING_SCRIPT = """
Point(1) = {-4, 15, 0};
Point(2) = {4, 15, 0};
Point(3) = {4, 19, 0};
Point(4) = {-4, 19, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 5;
Transfinite Curve {2, 4} = 3;
Transfinite Surface {1};
Recombine Surface {1};
out[] = Extrude { {1, 0, 0}, {0, 0, 0}, Pi / 2 } { Surface{1}; Layers{8}; Recombine; };
Physical Volume("ring") = {out[1]};
Physical Surface("bore") = {out[2]};
Physical Surface("outside") = {out[4]};
"""


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
