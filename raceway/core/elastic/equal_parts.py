"""Which parts of a bearing are the same mesh: its balls, and the sectors of its rings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.core.elastic.copies import Copies, Group, same_bodies, sectors

if TYPE_CHECKING:
    from raceway.core.elastic.assembly import Assembly


def equal_parts(assembly: Assembly, azimuth: np.ndarray) -> list[Group]:
    """The inner ring, the outer ring and the balls (Z,) at their azimuths [rad], each body in one group; supports are equal, too."""
    rings = [Group(_ring(assembly, index, azimuth), [index]) for index in (0, 1)]
    bodies = [(body.points, np.asarray(body.operator.cells)) for body in assembly.bodies[2:]]
    balls = same_bodies(bodies, azimuth, assembly.starts[2:-1])
    return rings + [Group(copies, [ball + 2 for ball in members]) for copies, members in balls]


def free_nodes(assembly: Assembly, index: int) -> np.ndarray:
    """(n,) bool, nodes of a body that are neither held nor tied to a frame."""
    free = np.zeros(3 * assembly.nodes, dtype=bool)
    free[assembly.free] = True
    return np.asarray(free[assembly.part(index)].reshape(-1, 3).all(axis=1))


def _ring(assembly: Assembly, index: int, azimuth: np.ndarray) -> Copies:
    body, first = assembly.bodies[index], int(assembly.starts[index])
    seat = np.zeros(len(body.points), dtype=bool)
    if body.foundation is not None:
        seat[body.foundation[0].ravel()] = True
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    marks = np.column_stack([free_nodes(assembly, index), seat])
    found = sectors(body.points, cells, azimuth, marks, first)
    return Copies.single(body.points, cells, first) if found is None else found
