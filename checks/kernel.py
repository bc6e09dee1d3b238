"""Speed of the hexahedron's kernels, as ratios inside one run: ``python -m checks.kernel`` prints them as JSON.

Each row is one mesh, a sector of a thick ring.  Times are minima of CPU time, so other programs on the machine cost
little.
"""

import json
import time
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from checks.validation.reference import hexahedron as reference
from raceway.extend import HexMesh, HexOperator

STEEL = (2.12e11, 0.29, 7810.0)
SIZES = (100_000, 1_000_000)
#: Elements that the readable loop is timed on: its time an element does not depend on how many there are.
_READABLE = 20_000


def sector(elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and cells of 1.2 rad of a ring, about ``elements`` of them, numbered along its shape."""
    count = round((elements / 2) ** (1 / 3))
    radial, axial, around = count, count, round(elements / count**2)
    ends = ((0.0, 1.2, around + 1), (0.0, 8e-3, axial + 1), (1e-2, 1.5e-2, radial + 1))
    angle, z, r = np.meshgrid(*(np.linspace(*each) for each in ends), indexing="ij")
    points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1).reshape(-1, 3)
    k, j, i = np.meshgrid(np.arange(around), np.arange(axial), np.arange(radial), indexing="ij")
    row, layer = radial + 1, (radial + 1) * (axial + 1)
    n = (k * layer + j * row + i).ravel()
    face = np.stack([n, n + 1, n + 1 + layer, n + layer], axis=1)
    return points, np.concatenate([face, face + row], axis=1)


def least(work: Callable[[], Any], repeats: int, clock: Callable[[], float] = time.thread_time) -> float:
    """Least CPU time of several runs [s], of this thread unless by another clock, after one that is not counted."""
    work()
    times = []
    for _ in range(repeats):
        begin = clock()
        work()
        times.append(clock() - begin)
    return min(times)


def readable_ns(points: np.ndarray, cells: np.ndarray) -> float:
    """The readable reference loop, compiled [ns an element]."""
    part = cells[:_READABLE]
    points = points[: part.max() + 1]
    u, f = np.random.default_rng(0).standard_normal(points.shape), np.zeros_like(points)
    loop = numba.njit(error_model="numpy")(reference.one_point_force)
    work = least(lambda: loop(part, points, u, 1e11, 8e10, 0.05, *reference.CENTRE, reference.HOURGLASS, f), 5)
    return 1e9 * work / len(part)


def renumbered_s(points: np.ndarray, cells: np.ndarray, repeats: int) -> float:
    """Force on the same mesh whose nodes and elements were in random order and are renumbered [s]."""
    generator = np.random.default_rng(1)
    order = generator.permutation(len(points))
    mesh = HexMesh(points[order], np.argsort(order)[cells][generator.permutation(len(cells))])
    mesh = mesh.renumbered()
    op, u, f = HexOperator(mesh.points, mesh.cells, *STEEL), generator.standard_normal(points.shape), np.empty_like(points)
    return least(lambda: op.internal_force(u, f), repeats)


def row(elements: int, repeats: int = 9) -> dict[str, Any]:
    """Times of one mesh over that of the force of this run, and memory of an explicit step [bytes an element]."""
    points, cells = sector(elements)
    op = HexOperator(points, cells, *STEEL)
    u = np.random.default_rng(0).standard_normal(points.shape) * 1e-9
    f = np.empty_like(u)
    K, flat = op.stiffness(), u.reshape(-1)
    force = least(lambda: op.internal_force(u, f), repeats)
    return {
        "elements": len(cells),
        "bytes_per_element": (op.bytes + 4 * u.nbytes + op.lumped_mass().nbytes) / len(cells),
        "csr_over_force": least(lambda: K @ flat, 5) / force,
        "readable_over_force": readable_ns(points, cells) / (1e9 * force / len(cells)),
        "renumbered_over_force": renumbered_s(points, cells, min(repeats, 5)) / force,
    }


if __name__ == "__main__":
    print(json.dumps({"rows": [row(size) for size in SIZES]}, indent=1))
