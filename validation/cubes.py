"""A block of cells that tests distort."""

import numpy as np

from raceway.core.mesh.hex_mesh import HexMesh, boundary, nodes_of


def block(nx=3, ny=4, nz=5, size=(1.0, 2.0, 3.0)):
    """nx x ny x nz cells; facet set "outside"; node set "corner"."""
    axes = [np.linspace(0.0, s, n + 1) for s, n in zip(size, (nx, ny, nz), strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(nx + 1, ny + 1, nz + 1)
    i, j, k = np.meshgrid(np.arange(nx), np.arange(ny), np.arange(nz), indexing="ij")
    around = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cells = np.stack([number[i + a, j + b, k + c] for a, b, c in around], axis=-1).reshape(-1, 8)
    outside = boundary(cells)
    assert len(nodes_of(cells, outside)) == len(points) - (nx - 1) * (ny - 1) * (nz - 1)
    return HexMesh(points, cells, {"corner": [0]}, {"outside": outside})
