"""A block of cells that tests distort."""

import numpy as np

from checks.validation.reference import elastic
from raceway.extend import HexMesh, boundary


def block(nx=3, ny=4, nz=5, size=(1.0, 2.0, 3.0)):
    """nx x ny x nz cells; facet set "outside"; node set "corner"."""
    points, cells = elastic.block(size, (nx, ny, nz))
    return HexMesh(points, cells.astype(np.int64), {"corner": [0]}, {"outside": boundary(cells)})
