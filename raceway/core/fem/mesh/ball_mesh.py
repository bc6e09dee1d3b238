"""A ball as a cubed sphere: a rounded inner cube and six blocks from its faces to the surface.

Local axes: u along the rolling direction, v across the raceway, w through both contacts; +w is the outer one.
"""

import numpy as np

from raceway.core.fem.mesh.hex_mesh import HexMesh, nodes_of

#: Half the inner cube's width over the ball's radius, and how far its faces bulge (0: flat, 1: a sphere): the largest
#: smallest scaled Jacobian of uniform balls among those tried (0.4 to 0.65, 0 to 0.8).
CUBE, BULGE = 0.5, 0.5


def ball_mesh(
    radius: float, u: np.ndarray, v: np.ndarray, w: np.ndarray, layers: np.ndarray, patch: tuple[float, float] | None = None
) -> HexMesh:
    """A ball about the origin.

    u, v, w : (n,) points from -1 to 1: lines of the cube, at equal angles where equally spaced
    layers : (n,) points 0 to 1 from the inner cube to the surface
    patch : semi-axes (along u, along v) [m] of the facets that belong to "inner_patch" (-w) and "outer_patch" (+w)

    Sets of facets and of nodes: surface, inner_patch, outer_patch; set of nodes: centre (the node nearest to it).
    """
    nu, nv, nw = len(u), len(v), len(w)
    grid = np.stack(np.meshgrid(u, v, w, indexing="ij"), axis=-1)
    lattice = np.tan(0.25 * np.pi * grid)
    core = CUBE * radius * _rounded(lattice)
    number = np.arange(nu * nv * nw).reshape(nu, nv, nw)
    edge = np.ones((nu, nv, nw), dtype=bool)
    edge[1:-1, 1:-1, 1:-1] = False
    skin = number[edge]
    rank = np.full(number.size, -1)
    rank[skin] = np.arange(len(skin))
    direction = lattice[edge]
    outside = radius * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    base = core[edge]
    shell = base[None] + layers[1:, None, None] * (outside - base)[None]
    points = np.concatenate([core.reshape(-1, 3), shell.reshape(-1, 3)])

    i, j, k = np.meshgrid(np.arange(nu - 1), np.arange(nv - 1), np.arange(nw - 1), indexing="ij")
    around = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cube = np.stack([number[i + a, j + b, k + c] for a, b, c in around], axis=-1).reshape(-1, 8)
    # Lattice nodes of the cube's surface quadrilaterals, anticlockwise seen from outside.
    sides = []
    for axis in range(3):
        for end, flip in ((0, True), (-1, False)):
            # Axes in cyclic order, so that (first, second, normal) is right-handed.
            face = np.moveaxis(number, axis, 0)[end]
            face = face.T if axis == 1 else face
            quad = [face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]]
            sides.append(np.stack(quad[::-1] if flip else quad, axis=-1).reshape(-1, 4))
    quads = rank[np.concatenate(sides)]
    blocks = []
    for layer in range(len(layers) - 1):
        below = skin[quads] if layer == 0 else number.size + (layer - 1) * len(skin) + quads
        blocks.append(np.hstack([below, number.size + layer * len(skin) + quads]))
    cells = np.concatenate([cube, *blocks])
    first = len(cells) - len(quads)
    facets = {"surface": np.column_stack([np.arange(first, len(cells)), np.ones(len(quads), dtype=int)])}
    if patch is not None:
        middle = outside[quads].mean(axis=1)
        inside = (middle[:, 0] / patch[0]) ** 2 + (middle[:, 1] / patch[1]) ** 2 < 1.0
        for name, side in (("inner_patch", -1.0), ("outer_patch", 1.0)):
            facets[name] = facets["surface"][inside & (side * middle[:, 2] > 0.0)]
    nodes = {name: nodes_of(cells, f) for name, f in facets.items()}
    nodes["centre"] = np.array([np.argmin((core.reshape(-1, 3) ** 2).sum(axis=1))])
    return HexMesh(points, cells, nodes, facets)


def ball_cells(nu: int, nv: int, nw: int, layers: int) -> int:
    """Number of cells of a ball with that many cells along u, v, w and outward."""
    return nu * nv * nw + 2 * layers * (nu * nv + nv * nw + nw * nu)


def _rounded(p: np.ndarray) -> np.ndarray:
    """Points of the cube [-1, 1]^3 moved part of the way to where the smooth map of cube to ball takes them."""
    s = p * p
    out = np.empty_like(p)
    for a in range(3):
        b, c = s[..., (a + 1) % 3], s[..., (a + 2) % 3]
        out[..., a] = p[..., a] * ((1.0 - BULGE) + BULGE * np.sqrt(1.0 - 0.5 * (b + c) + b * c / 3.0))
    return out
