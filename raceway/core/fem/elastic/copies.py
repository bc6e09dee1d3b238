"""Equal parts of bodies: whole balls, and the sectors of a ring about its balls."""

from __future__ import annotations

import attrs
import numpy as np

#: Distance of nodes over the size of a body up to which two meshes are the same: rounding of a turn, no tenth digit.
SAME = 1e-13


@attrs.frozen(eq=False)
class Copies:
    """A mesh and where its copies lie."""

    points: np.ndarray  # (n, 3) of the first copy [m]
    cells: np.ndarray  # (m, 8)
    nodes: np.ndarray  # (copies, n) numbers of the copies' nodes in the mesh that they make up
    turns: np.ndarray  # (copies, 3, 3) from the first copy to each
    #: before, behind : (k,) nodes of a sector on its first cut plane, and their images on its second one; none of whole
    #: bodies
    before: np.ndarray
    behind: np.ndarray

    @classmethod
    def single(cls, points: np.ndarray, cells: np.ndarray, first: int = 0) -> Copies:
        """A body of its own whose nodes are numbered from ``first``."""
        none = np.zeros(0, dtype=np.int64)
        return cls(points, cells, first + np.arange(len(points))[None], np.eye(3)[None], none, none)


@attrs.frozen(eq=False)
class Group:
    """Copies of a mesh, and the bodies that they make up: one each of balls, together one of sectors."""

    copies: Copies
    members: list[int]


def turn(angle: float) -> np.ndarray:
    """(3, 3) about x by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def same_bodies(
    bodies: list[tuple[np.ndarray, np.ndarray]], azimuth: np.ndarray, starts: np.ndarray
) -> list[tuple[Copies, list[int]]]:
    """Groups of equal bodies: the mesh of each group with its copies, and which bodies these are.

    bodies : points (n, 3), cells (m, 8) of each
    azimuth : (bodies,) by which each is turned [rad];  starts : (bodies,) number of its first node
    """
    members: list[list[int]] = []
    for k, (points, cells) in enumerate(bodies):
        for group in members:
            first_points, first_cells = bodies[group[0]]
            if points.shape != first_points.shape or not np.array_equal(cells, first_cells):
                continue
            rotation = first_points @ turn(azimuth[k] - azimuth[group[0]]).T
            if np.abs(points - rotation).max() <= SAME * np.abs(points).max():
                group.append(k)
                break
        else:
            members.append([k])
    out = []
    none = np.zeros(0, dtype=np.int64)
    for group in members:
        points, cells = bodies[group[0]]
        nodes = starts[group][:, None] + np.arange(len(points))
        turns = np.array([turn(azimuth[k] - azimuth[group[0]]) for k in group])
        out.append((Copies(points, cells, nodes, turns, none, none), group))
    return out


def sectors(points: np.ndarray, cells: np.ndarray, azimuth: np.ndarray, marks: np.ndarray, first: int) -> Copies | None:
    """A ring as equal sectors, one about each ball; None where it is none.

    points, cells : of the ring;  azimuth : (Z,) of the balls [rad]
    marks : (n, k) bool, what must be the same at copies of a node: whether it is held, or belongs to a seat
    first : number of the ring's first node
    """
    from scipy.spatial import cKDTree

    count, numbers = len(azimuth), np.asarray(cells, dtype=np.int64)
    step = 2.0 * np.pi / count
    if count < 3 or len(cells) % count or np.abs(np.diff(azimuth) - step).max() > SAME:
        return None
    middle = points[numbers].mean(axis=1)
    away = np.mod(np.arctan2(middle[:, 2], middle[:, 1]) - azimuth[0], 2.0 * np.pi)
    # Sectors are cut behind a ball, where the middles of cells leave room.
    places = np.unique(np.round(np.mod(away, step) / step, 9)) * step
    between = 0.5 * (places + np.append(places[1:], places[0] + step))
    cut = float(between[np.argmin(np.abs(between - 0.5 * step))])
    sector = np.floor(np.mod(away + step - cut, 2.0 * np.pi) / step).astype(np.int64) % count
    cell_of = np.flatnonzero(sector == 0)
    if (np.bincount(sector, minlength=count) != len(cell_of)).any():
        return None
    nodes_of_sector, local = np.unique(numbers[cell_of], return_inverse=True)
    local = local.reshape(-1, 8)
    tree, size = cKDTree(points), np.abs(points).max()
    turns = np.array([turn(k * step) for k in range(count)])
    nodes = np.empty((count, len(nodes_of_sector)), dtype=np.int64)
    for k in range(count):
        distance, nodes[k] = tree.query(points[nodes_of_sector] @ turns[k].T)
        rows = np.sort(nodes[k][local], axis=1), np.sort(numbers[sector == k], axis=1)
        image, original = (each[np.lexsort(each.T)] for each in rows)
        other = (marks[nodes[k]] != marks[nodes_of_sector]).any() or not np.array_equal(image, original)
        if distance.max() > SAME * size or other:
            return None
    before = np.flatnonzero(np.isin(nodes[0], nodes[-1]))
    # The image of a node of the first cut plane is that node's copy in the next sector, which this sector shares.
    order = np.argsort(nodes[0])
    behind = order[np.searchsorted(nodes[0][order], nodes[1][before])]
    if not np.array_equal(nodes[0][behind], nodes[1][before]) or np.isin(before, behind).any():
        return None
    return Copies(points[nodes_of_sector], local, first + nodes, turns, before, behind)
