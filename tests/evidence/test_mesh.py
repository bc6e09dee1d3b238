"""The article's mesh: size, quality, cost."""

import json
import subprocess
import sys

import pytest

from checks.validation.command_line import EXAMPLES

pytestmark = pytest.mark.night

SCENE = EXAMPLES / "b7206_article_mesh.toml"
#: Of the article (Lubricants 2026, 14(3), 128, section 3.1).
ELEMENTS = 1_061_016
#: In a process of its own, so that the memory is that of the mesh.
BUILD = """
import json, resource, sys, time
from raceway import load_scene
from raceway.plugins.bodies.mesh import mesh_bodies
from raceway.planning.resolve import resolve
scene = load_scene(sys.argv[1])
begin = time.process_time()
meshes = mesh_bodies(resolve(scene))
seconds = time.process_time() - begin
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
from raceway_view.mesh_summary import summary
print(json.dumps({"seconds": seconds, "memory": memory, "summary": summary(meshes)}))
"""


def test_mesh_of_the_article(claim):
    words = [sys.executable, "-c", BUILD, str(SCENE)]
    done = json.loads(subprocess.run(words, cwd=EXAMPLES.parent, stdout=subprocess.PIPE, check=True).stdout)
    found, article = done["summary"], "Lubricants 2026, 14(3), 128, section 3.1"
    published, once = {"basis": "published", "source": article}, {"basis": "regression", "source": "one core"}
    claim("article's mesh: elements", found["elements"], near=ELEMENTS, within=0.02, **published)
    claim("article's mesh: largest edge", 1e3 * found["element_size_m"]["max"], at_most=0.5, unit="mm", **published)
    bounds = {"basis": "closed form", "source": "1 is a cube, 0 a cell without volume in a corner"}
    claim("article's mesh: smallest scaled Jacobian", found["scaled_jacobian"]["min"], at_least=0.2, **bounds)
    claim("article's mesh: CPU time", done["seconds"], at_most=30.0, unit="s", **once)
    claim("article's mesh: peak memory", done["memory"] / 2**30, at_most=4.0, unit="GiB", **once)
