"""A block under pressure on its whole surface, computed by CalculiX from the .inp file that the format `abaqus` writes."""

import re
import shutil
import subprocess

import attrs
import numpy as np

from checks.validation.cubes import block
from checks.validation.scenes import built_in

Abaqus = built_in("format", "abaqus")

YOUNG, POISSON, PRESSURE = 212e9, 0.29, 1e9

#: What a mesh lacks: a material, supports of the motions of a rigid body, the pressure.
REST = f"""*MATERIAL, NAME=STEEL
*ELASTIC
{YOUNG:g}, {POISSON}
*SOLID SECTION, ELSET=EALL, MATERIAL=STEEL
*BOUNDARY
corner, 1, 3
edge, 1, 2
side, 1, 1
*STEP
*STATIC
*DSLOAD
outside, P, {PRESSURE:g}
*NODE PRINT, NSET=far
U
*END STEP
"""


def squeezed(formulation, folder):
    """What CalculiX prints on the screen; displacement (3,) of the corner far from the held one; the exact one.  Uniform
    strain p (1 - 2 nu) / E is exact in an element of any formulation."""
    assert shutil.which("ccx"), "CalculiX is not installed: apt-get install calculix-ccx, or the line of make apt-line"
    mesh = block()
    far = len(mesh.points) - 1
    # Along z and along y from the corner: three, two and one displacements are held.
    edge, side = (int(np.argmax(mesh.points @ axis)) for axis in ([-9.0, -9.0, 1.0], [-9.0, 1.0, -9.0]))
    sets = {"corner": [0], "edge": [edge], "side": [side], "far": [far]}
    Abaqus(formulation).write(folder / "body.inp", attrs.evolve(mesh, node_sets=sets))
    with (folder / "body.inp").open("a", encoding="utf-8") as file:
        file.write(REST)
    done = subprocess.run(["ccx", "body"], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    data = folder / "body.dat"
    printed = re.findall(rf"^ +{far + 1} +(\S+) +(\S+) +(\S+)$", data.read_text() if data.exists() else "", re.MULTILINE)
    found = np.array(printed[-1], dtype=float) if printed else np.full(3, np.nan)
    return done.stdout, found, -PRESSURE * (1.0 - 2.0 * POISSON) / YOUNG * mesh.points[far]
