"""Internal forces of all bodies of an assembly: equal parts by one matrix, the others by ranges of elements, in one queue."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.copied_stiffness import CopiedStiffness
from raceway.core.elastic.copies import Group
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
    groups : equal parts; bodies in none of them, and single ones of one-point elements, whose forces cost no more without a
        matrix, are computed element by element

    Notes
    -----
    The sums have one order whatever the number of threads (``raceway.core.hexahedron.ranges``).
    """

    def __init__(self, operators: list[HexOperator], starts: np.ndarray, groups: list[Group] | None = None) -> None:
        self._operators, self._starts = operators, [int(start) for start in starts]
        worth = [
            group
            for group in groups or []
            if len(group.copies.turns) > 1 or operators[group.members[0]].formulation != "one_point"
        ]
        #: By the first body of a group.
        self._copied = {group.members[0]: CopiedStiffness(group.copies, operators[group.members[0]]) for group in worth}
        alone = set(range(len(operators))) - {body for group in worth for body in group.members}
        ranges = [(int(n), body, r) for body in sorted(alone) for r, n in enumerate(operators[body].range_sizes)]
        #: Body and range, the largest first: what comes last shall not keep one thread busy alone.
        self._queue = [(body, r) for _, body, r in sorted(ranges, key=lambda one: -one[0])]
        self._products = [(one, part) for one in self._copied.values() for part in range(one.parts)]
        self._parts = [
            (body, first, min(first + _NODES, len(one.points)), body in alone)
            for body, one in enumerate(operators)
            for first in range(0, len(one.points), _NODES)
        ]
        self._force = np.empty(3 * self._starts[-1])

    def compute(self, u: np.ndarray, pool: ThreadPool, first: list[Callable[[], None]]) -> None:
        """All bodies at u (3 nodes,) [m], and other jobs ``first``; ``sum`` makes forces of them."""
        jobs = {body: self._operators[body].force_job(self._of(u, body)) for body, _ in self._queue}
        ahead, products = len(first), self._products

        def work(number: int) -> None:
            if number < ahead:
                first[number]()
            elif number < ahead + len(self._queue):
                body, r = self._queue[number - ahead]
                jobs[body](r)
            else:
                one, part = products[number - ahead - len(self._queue)]
                one.gather(part, u)

        pool.do(ahead + len(self._queue) + len(products), work)
        pool.do(len(products), lambda number: products[number][0].multiply(products[number][1], self._force))

    def sum(self, pool: ThreadPool, also: Callable[[np.ndarray, int, int], None]) -> np.ndarray:
        """(3 nodes,) forces [N], until the next call; ``also(forces, begin, end)`` is done with each part's entries."""
        force = self._force

        def work(number: int) -> None:
            body, first, last, alone = self._parts[number]
            if alone:
                self._operators[body].add_parts(first, last, self._of(force, body))
            start = self._starts[body]
            also(force, 3 * (start + first), 3 * (start + last))

        pool.do(len(self._parts), work)
        return force

    def of_body(self, body: int, u: np.ndarray) -> np.ndarray:
        """(3 n,) forces of one body at u (3 nodes,)."""
        copied = self._copied.get(body)
        if copied is None:
            return self._operators[body].internal_force(self._of(u, body)).reshape(-1)
        return self._of(copied.apply(u), body)

    def of_mesh(self, body: int, moved: np.ndarray) -> np.ndarray:
        """(3 n, m) forces of one body at displacements (3 n, m) of its own."""
        if body in self._copied:
            return self._copied[body].times(moved)
        force = [self._operators[body].internal_force(column).reshape(-1) for column in moved.T]
        return np.stack(force, axis=1)

    def hourglass_energy(self, u: np.ndarray, pool: ThreadPool) -> float:
        """The part of the strain energy at u (3 nodes,) that hourglass control holds [J]."""
        queue = [(body, r) for body, one in enumerate(self._operators) for r in range(len(one.range_sizes))]
        found = np.empty(len(queue))

        def work(number: int) -> None:
            body, r = queue[number]
            found[number] = self._operators[body].range_hourglass_energy(r, self._of(u, body))

        pool.do(len(queue), work)
        return float(found.sum())

    def _of(self, values: np.ndarray, body: int) -> np.ndarray:
        return values[3 * self._starts[body] : 3 * self._starts[body + 1]]
