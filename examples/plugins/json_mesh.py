import json
from pathlib import Path

import attrs
import numpy as np

from raceway import RacewayError, hookimpl
from raceway.extend import HexMesh


@attrs.frozen
class JsonMesh:
    """Hexahedral meshes as JSON."""

    name = "json_mesh"
    suffixes = (".mesh.json",)

    def read(self, path):
        try:
            content = json.loads(Path(path).read_text(encoding="utf-8"))
            points, cells = np.array(content["points"]), np.array(content["cells"])
            return HexMesh(points, cells, content["node_sets"], content["facet_sets"])
        except (OSError, ValueError, TypeError, KeyError) as why:
            raise RacewayError(f"'{path}' cannot be read: {why}") from why

    def write(self, path, content):
        Path(path).write_text(json.dumps(attrs.asdict(content), default=np.ndarray.tolist), encoding="utf-8")

    def example_content(self):
        corner = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        return HexMesh(np.array(corner), np.arange(8)[None], {"corner": [0]}, {"bottom": [[0, 0]]})


@hookimpl
def raceway_formats():
    return [JsonMesh]
