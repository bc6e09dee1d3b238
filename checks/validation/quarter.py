"""A quarter of a ball above a quarter of a grooved block: the smallest model of one ball-race contact.

x runs across the groove, y along the rolling direction, z from the race to the ball; x = 0 and y = 0 are planes of
symmetry and the origin is the ball's centre.
"""

import numpy as np

from raceway.core.fem.mesh.part_meshes import CUBE, ball_mesh
from raceway.extend import FACES, HexMesh, boundary, growing, nodes_of


def half_line(zone: float, length: float, fine: float, coarse: float, growth: float) -> np.ndarray:
    """Points from 0 to ``length``: distance ``fine`` up to ``zone``, growing beyond."""
    cells = max(int(np.ceil(zone / fine - 1e-9)), 1)
    fine = zone / cells
    return np.concatenate(
        [np.linspace(0.0, zone, cells + 1)[:-1], zone + growing(length - zone, growth * fine, coarse, growth)]
    )


def quarter_ball(radius: float, across: np.ndarray, along: np.ndarray, up: np.ndarray, layers: np.ndarray) -> HexMesh:
    """The quarter x > 0, y > 0 of the lower half of a ball.

    across, along, up : (n,) points 0 to 1: lines of the cube in x, y and z at equal angles, 1 at 45 degrees
    layers : (n,) points 0 to 1 from the inner cube to the surface
    Sets of facets and nodes: surface, middle (z = 0), side_x (x = 0), side_y (y = 0).
    """
    u, v, w = (np.concatenate([-line[:0:-1], line]) for line in (across, along, up))
    mesh = ball_mesh(radius, u, v, w, layers)
    middle = mesh.points[mesh.cells].mean(axis=1)
    cells = mesh.cells[(middle[:, 0] > 0.0) & (middle[:, 1] > 0.0) & (middle[:, 2] < 0.0)]
    used, cells = np.unique(cells, return_inverse=True)
    points = mesh.points[used]
    tiny = 1e-9 * radius
    points[np.abs(points) < tiny] = 0.0
    return _with_sets(points, cells.reshape(-1, 8), radius)


def _with_sets(points: np.ndarray, cells: np.ndarray, radius: float) -> HexMesh:
    outer = boundary(cells)
    corners = points[cells[outer[:, :1], FACES[outer[:, 1]]]]
    facets = {"surface": outer[(np.linalg.norm(corners, axis=2) > radius * (1.0 - 1e-6)).all(axis=1)]}
    for name, axis in (("side_x", 0), ("side_y", 1), ("middle", 2)):
        facets[name] = outer[(corners[:, :, axis] == 0.0).all(axis=1)]
    return HexMesh(points, cells, {name: nodes_of(cells, f) for name, f in facets.items()}, facets)


def quarter_groove(
    ball_radius: float, groove: float, rolling: float, across: np.ndarray, along: np.ndarray, depth: np.ndarray
) -> HexMesh:
    """The quarter x > 0, y > 0 of a block below a groove that touches the ball at (0, 0, -ball_radius).

    groove, rolling : radius of the groove, and of its bottom about the axis of the ring [m]
    across : (n,) angles of points on the groove from its bottom [rad]
    along : (n,) angles about the ring's axis [rad]
    depth : (n,) distances below the groove's bottom [m]
    Sets of facets and nodes: raceway, base, side_x (x = 0), side_y (y = 0).
    """
    circle = rolling + groove
    x, top = groove * np.sin(across), circle - groove * np.cos(across)
    share = depth / depth[-1]
    radius = top[None, :] + share[:, None] * (rolling - depth[-1] - top)[None, :]
    ni, nj, nk = len(across), len(depth), len(along)
    shape = (nk, nj, ni)
    y, z = np.sin(along)[:, None, None] * radius, np.cos(along)[:, None, None] * radius - (ball_radius + rolling)
    points = np.stack([np.broadcast_to(x, shape), y, z], axis=-1).reshape(-1, 3)
    number = np.arange(points.shape[0]).reshape(shape)
    k, j, i = np.meshgrid(np.arange(nk - 1), np.arange(nj - 1), np.arange(ni - 1), indexing="ij")
    # Local axes x, -depth, y would be left-handed the other way round: bottom first.
    around = ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0))
    cells = np.stack([number[k + a, j + b, i + c] for a, b, c in around], axis=-1).reshape(-1, 8)
    mesh_cells = np.arange(len(cells)).reshape(nk - 1, nj - 1, ni - 1)

    def facets(chosen: np.ndarray, face: int) -> np.ndarray:
        return np.column_stack([chosen.ravel(), np.full(chosen.size, face)])

    sets = {
        "raceway": facets(mesh_cells[:, 0], 1), "base": facets(mesh_cells[:, -1], 0),
        "side_x": facets(mesh_cells[:, :, 0], 5), "side_y": facets(mesh_cells[0], 2),
    }  # fmt: skip
    points[number[:, :, 0].ravel(), 0] = 0.0
    points[number[0].ravel(), 1] = 0.0
    return HexMesh(points, cells, {name: nodes_of(cells, f) for name, f in sets.items()}, sets)


def ball_layers(radius: float, fine: float, coarse: float, growth: float) -> np.ndarray:
    """(n,) points 0 to 1 from the inner cube of a ball to its surface, where the first layer is ``fine`` thick."""
    length = (1.0 - CUBE) * radius
    return 1.0 - growing(1.0, fine / length, coarse / length, growth)[::-1]


def unfolded(points: np.ndarray, cells: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The quarter with its mirror images about x = 0 and y = 0: points (4 n, 3), cells (4 m, 8), displacements (4 n, 3)."""
    # Nodes in another order, so that mirrored cells are not inverted.
    swapped = [1, 0, 3, 2, 5, 4, 7, 6]
    for axis in (0, 1):
        sign = np.where(np.arange(3) == axis, -1.0, 1.0)
        cells = np.concatenate([cells, cells[:, swapped] + len(points)])
        points, u = np.concatenate([points, sign * points]), np.concatenate([u, sign * u])
    return points, cells, u
