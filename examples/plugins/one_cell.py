from types import SimpleNamespace

import attrs
import numpy as np

from raceway import hookimpl


@attrs.frozen
class OneCell:
    """A cube as wide as the pitch diameter: only to show what is returned."""

    name = "one_cell"

    def mesh(self, bearing):
        corner = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        points = bearing.pitch_diameter * np.array(corner, dtype=float)
        return {"inner_ring": SimpleNamespace(points=points, cells=np.arange(8)[None])}


@hookimpl
def raceway_meshers():
    return [OneCell]
