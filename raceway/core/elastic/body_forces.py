"""Internal forces of all bodies of an assembly: their ranges of elements in one queue, then the sums at their nodes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.threads import ThreadPool, usable_cores

#: Elements below which one more thread costs more than it saves: handing over work takes some 50 us, 1000 elements.
_EACH = 8000
#: Nodes that are summed together, so that what follows finds their forces in the second cache.
_NODES = 8192


def fitting_threads(elements: int) -> int:
    """Threads for so many elements: all cores that this process may use, fewer for small bodies."""
    return max(1, min(usable_cores(), elements // _EACH))


class BodyForces:
    """Forces K u of bodies whose nodes follow one another.

    Parameters
    ----------
    operators : of the bodies;  starts : (bodies + 1,) first node of each

    Notes
    -----
    The sums have one order whatever the number of threads (``raceway.core.hexahedron.ranges``).
    """

    def __init__(self, operators: list[HexOperator], starts: np.ndarray) -> None:
        self._operators, self._starts = operators, [int(start) for start in starts]
        ranges = [(int(n), body, r) for body, one in enumerate(operators) for r, n in enumerate(one.range_sizes)]
        #: Body and range, the largest first: what comes last shall not keep one thread busy alone.
        self._queue = [(body, r) for _, body, r in sorted(ranges, key=lambda one: -one[0])]
        self._parts = [
            (body, first, min(first + _NODES, len(one.points)))
            for body, one in enumerate(operators)
            for first in range(0, len(one.points), _NODES)
        ]
        self._force = np.empty(3 * self._starts[-1])

    def compute(self, u: np.ndarray, pool: ThreadPool, first: list[Callable[[], None]]) -> None:
        """All ranges at u (3 nodes,) [m], and other jobs ``first``; ``sum`` makes forces of them."""
        pairs = zip(self._operators, self._starts, strict=False)
        jobs = [one.force_job(u[3 * start : 3 * (start + len(one.points))]) for one, start in pairs]
        ahead = len(first)

        def work(number: int) -> None:
            if number < ahead:
                first[number]()
            else:
                body, r = self._queue[number - ahead]
                jobs[body](r)

        pool.do(ahead + len(self._queue), work)

    def sum(self, pool: ThreadPool, also: Callable[[np.ndarray, int, int], None]) -> np.ndarray:
        """(3 nodes,) forces [N], until the next call; ``also(forces, begin, end)`` is done with each part's entries."""
        force = self._force

        def work(number: int) -> None:
            body, first, last = self._parts[number]
            start, end = self._starts[body], self._starts[body + 1]
            self._operators[body].add_parts(first, last, force[3 * start : 3 * end])
            also(force, 3 * (start + first), 3 * (start + last))

        pool.do(len(self._parts), work)
        return force

    def hourglass_energy(self, u: np.ndarray, pool: ThreadPool) -> float:
        """The part of the strain energy at u (3 nodes,) that hourglass control holds [J]."""
        found = np.empty(len(self._queue))

        def work(number: int) -> None:
            body, r = self._queue[number]
            part = slice(3 * self._starts[body], 3 * self._starts[body + 1])
            found[number] = self._operators[body].range_hourglass_energy(r, u[part])

        pool.do(len(self._queue), work)
        return float(found.sum())
