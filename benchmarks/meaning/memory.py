"""Memory of elastic bodies whose contacts are far larger than those that their mesh is made for, over the plan's."""

from __future__ import annotations

import subprocess
import sys

from benchmarks.evidence import Row, below

COMMAND = "python -m benchmarks.meaning memory"
#: Resident memory at the peak over the plan's, at most.
_MOST = 2.0
_BASE = ["contact.discretisation=nodal", "mesh.nodes_per_semi_axis=1", "load.axial=6000", "contact.kind=penalty"]
SCENES = {
    "that converge, soft contacts ten times as large": ["contact.stiffness=1e12"],
    "that converge after some 90 iterations, friction": [
        "contact.stiffness=1e11", "contact.friction=0.5", "load.radial=[50000,0]"
    ],
    "that do not converge, friction on hard contacts": [
        "contact.stiffness=1e19", "contact.friction=0.5", "load.radial=[50000,0]"
    ],
}  # fmt: skip
#: A process for each; ``ru_maxrss`` of a child begins with its parent's peak, VmHWM with its own program.
_CHILD = """
import re, sys
from pathlib import Path
import raceway as rw
scene = rw.evolve("examples/b7206_elastic_coarse.toml", *sys.argv[1:])
end = "converges"
try:
    rw.run(scene)
except rw.RacewayError as why:
    end = type(why).__name__
peak = 1024 * int(re.search(r"VmHWM:\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
print(peak / rw.make_plan(scene).predicted_bytes, end)
"""


def rows() -> list[Row]:
    """Of the table of this subject."""
    found = []
    for words, changes in SCENES.items():
        told = subprocess.run([sys.executable, "-c", _CHILD, *_BASE, *changes], capture_output=True, text=True, check=True)
        ratio, end = told.stdout.split()
        found.append(below(f"elastic bodies {words}: peak of memory over the plan's", float(ratio), _MOST, COMMAND, end))
    return found
