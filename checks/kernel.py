"""Speed of the hexahedron's kernels, as ratios inside one run: ``python -m checks.kernel [--json] [--elements N ...]``.

Each row is one mesh, a sector of a thick ring.  Times are minima of CPU time, so other programs on the machine cost
little; they share its memory bandwidth, which the triad of the same run tells.  Two threads are timed by the clock on
the wall, and only while the machine is otherwise idle.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
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
    angle, z, r = np.meshgrid(
        np.linspace(0.0, 1.2, around + 1),
        np.linspace(0.0, 8e-3, axial + 1),
        np.linspace(1e-2, 1.5e-2, radial + 1),
        indexing="ij",
    )
    points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1).reshape(-1, 3)
    k, j, i = np.meshgrid(np.arange(around), np.arange(axial), np.arange(radial), indexing="ij")
    row, layer = radial + 1, (radial + 1) * (axial + 1)
    n = (k * layer + j * row + i).ravel()
    face = np.stack([n, n + 1, n + 1 + layer, n + layer], axis=1)
    return points, np.concatenate([face, face + row], axis=1)


def least(work: Callable[[], Any], repeats: int, clock: Callable[[], float] = time.thread_time) -> float:
    """Least time of several runs [s], after one that is not counted."""
    work()
    times = []
    for _ in range(repeats):
        begin = clock()
        work()
        times.append(clock() - begin)
    return min(times)


@numba.njit(error_model="numpy")
def _triad(a, b, c):  # type: ignore[no-untyped-def]
    for i in range(a.size):
        a[i] = b[i] + 3.0 * c[i]


def triad_gb_s(size: int = 20_000_000) -> float:
    """Memory bandwidth of one thread, a = b + 3 c, 24 bytes an entry [GB/s]."""
    a, b, c = np.zeros(size), np.ones(size), np.ones(size)
    return 24e-9 * size / least(lambda: _triad(a, b, c), 5)


def readable_ns(points: np.ndarray, cells: np.ndarray, rule: tuple[np.ndarray, np.ndarray]) -> float:
    """The readable reference loop, compiled [ns an element]."""
    part = cells[:_READABLE]
    points = points[: part.max() + 1]
    u, f = np.random.default_rng(0).standard_normal(points.shape), np.zeros_like(points)
    loop = numba.njit(error_model="numpy")(reference.one_point_force)
    work = least(lambda: loop(part, points, u, 1e11, 8e10, 0.05, *rule, reference.HOURGLASS, f), 5)
    return 1e9 * work / len(part)


def two_threads_ns(op: HexOperator, u: np.ndarray, f: np.ndarray) -> float | str:
    """Force with two threads [ns an element, wall time], or why there is no number."""
    if os.cpu_count() == 1 or os.getloadavg()[0] > 1.3:  # this process itself is 1
        return "not measured: machine busy"
    return 1e9 * least(lambda: op.internal_force(u, f, threads=2), 9, time.perf_counter) / len(op.cells)


def numbering_ns(points: np.ndarray, cells: np.ndarray, repeats: int) -> tuple[float, float]:
    """Force on the same mesh with nodes and elements in random order, and after renumbering [ns an element]."""
    generator = np.random.default_rng(1)
    order = generator.permutation(len(points))
    mesh = HexMesh(points[order], np.argsort(order)[cells][generator.permutation(len(cells))])
    found = []
    for each in (mesh, mesh.renumbered()):
        op, u = HexOperator(each.points, each.cells, *STEEL), generator.standard_normal(points.shape)
        f = np.empty_like(u)
        found.append(1e9 * least(functools.partial(op.internal_force, u, f), repeats) / len(cells))
    return found[0], found[1]


def row(elements: int, repeats: int = 9) -> dict[str, Any]:
    """The columns of one mesh; the last ones are ratios to the force of this run."""
    points, cells = sector(elements)
    count = len(cells)
    op = HexOperator(points, cells, *STEEL)
    u = np.random.default_rng(0).standard_normal(points.shape) * 1e-9
    f, v, load = np.empty_like(u), np.zeros_like(u), np.zeros_like(u)
    inverse, dt = 1.0 / op.lumped_mass(), 1e-12  # tiny: the state must stay a number, the arithmetic is the same

    def ns(work: Callable[[], Any], repeats: int = repeats) -> float:
        return 1e9 * least(work, repeats) / count

    found: dict[str, Any] = {
        "elements": count,
        "ns_per_element": ns(lambda: op.internal_force(u, f)),
        "step_ns_per_element": ns(lambda: op.advance(u, v, load, inverse, dt)),
        "two_threads_ns_per_element": two_threads_ns(op, u, f),
        "readable_ns_per_element": readable_ns(points, cells, reference.CENTRE),
        "readable_exact_ns_per_element": readable_ns(points, cells, reference.EXACT),
        "bytes_per_element": (op.bytes + u.nbytes + v.nbytes + f.nbytes + load.nbytes + inverse.nbytes) / count,
    }
    random, renumbered = numbering_ns(points, cells, min(repeats, 5))
    found["random_numbering_ns_per_element"], found["renumbered_ns_per_element"] = random, renumbered
    K, flat = op.stiffness(), u.reshape(-1)
    found["csr_bytes_per_element"] = (K.data.nbytes + K.indices.nbytes + K.indptr.nbytes) / count
    found["csr_ns_per_element"] = ns(lambda: K @ flat, 5)
    found["csr_difference"] = float(np.abs(K @ flat - op.internal_force(u).reshape(-1)).max() / np.abs(f).max())
    force = found["ns_per_element"]
    found["csr_over_force"] = found["csr_ns_per_element"] / force
    found["readable_over_force"] = found["readable_ns_per_element"] / force
    found["step_over_force"] = found["step_ns_per_element"] / force
    found["renumbered_over_force"] = renumbered / force
    return found


def measure(sizes: tuple[int, ...] = SIZES) -> dict[str, Any]:
    """All rows, and the bandwidth of the same run."""
    return {"triad_gb_s": triad_gb_s(), "rows": [row(size) for size in sizes]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="machine-readable answer")
    parser.add_argument("--elements", type=int, nargs="+", default=SIZES, help="sizes of the meshes")
    options = parser.parse_args()
    found = measure(tuple(options.elements))
    if options.json:
        print(json.dumps(found, indent=1))
        return
    print(f"triad: {found['triad_gb_s']:.1f} GB/s")
    for entry in found["rows"]:
        for name, value in entry.items():
            print(f"{name:34}", value if isinstance(value, str) else f"{value:.4g}")
        print()


if __name__ == "__main__":
    main()
