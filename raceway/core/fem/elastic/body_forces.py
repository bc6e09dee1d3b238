"""Forces K u of all bodies: element by element, or of equal parts by one product with the rows of their matrix."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import int64, void

from raceway.core.fem.elastic.copies import Copies, Group
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.fem.hexahedron.rows import BlockRows, add_rows
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, VECTOR
from raceway.core.threads import ThreadPool, usable_cores

#: Nodes of a mesh whose forces are computed together: enough work for a thread.
_ROWS = 4096
_NUMBERS = int64[:, ::1]


@jit(void(int64, int64, _NUMBERS, CUBE, VECTOR, CUBE), releases=True)
def _gather_copies(first, last, numbers, turns, u, displacement):  # type: ignore[no-untyped-def]
    """Displacements of nodes ``first`` to ``last - 1`` of every copy, turned back to the first: displacement (n, 3, c)."""
    for i in range(first, last):
        for c in range(turns.shape[0]):
            at = 3 * numbers[c, i]
            for a in range(3):
                displacement[i, a, c] = turns[c, 0, a] * u[at] + turns[c, 1, a] * u[at + 1] + turns[c, 2, a] * u[at + 2]


@jit(void(int64, int64, int64[::1], _NUMBERS, CUBE, CUBE, VECTOR), releases=True)
def _spread_copies(first, last, nodes, numbers, turns, force, out):  # type: ignore[no-untyped-def]
    """The way back of forces (m, 3, c) on nodes[first:last], written to ``out`` (3 nodes of all copies,)."""
    for row in range(first, last):
        for c in range(turns.shape[0]):
            at = 3 * numbers[c, nodes[row]]
            for a in range(3):
                out[at + a] = (
                    turns[c, a, 0] * force[row, 0, c] + turns[c, a, 1] * force[row, 1, c] + turns[c, a, 2] * force[row, 2, c]
                )


class CopiedStiffness:
    """K u of all copies of a mesh.

    copies : Copies;  operator : HexOperator, whose material and formulation it has

    A node on a cut plane belongs to the sector behind it, and the cells of the sector before it that share its cut plane are
    part of the matrix: every row is whole, every force is written once.
    """

    def __init__(self, copies: Copies, operator: HexOperator) -> None:
        points, cells, numbers = copies.points, copies.cells, copies.nodes
        belongs = np.ones(len(points), dtype=bool)
        belongs[copies.behind] = False
        if len(copies.behind):
            beyond = cells[np.isin(cells, copies.behind).any(axis=1)]  # of the sector before, at the first cut plane
            more = np.setdiff1d(beyond, copies.behind)
            number = np.empty(len(points), dtype=np.int64)
            number[copies.behind], number[more] = copies.before, len(points) + np.arange(len(more))
            points = np.concatenate([points, copies.points[more] @ copies.turns[-1].T])
            cells = np.concatenate([cells, number[beyond]])
            numbers = np.concatenate([numbers, np.roll(copies.nodes, 1, axis=0)[:, more]], axis=1)
        mesh = operator.of_mesh(points, cells)
        self.rows = BlockRows.assemble(mesh.cells, len(points), mesh.element_stiffness)
        self._own = np.flatnonzero(belongs)
        self._numbers, self._turns = np.ascontiguousarray(numbers), np.ascontiguousarray(copies.turns)
        self._moved = np.empty((len(points), 3, len(copies.turns)))
        self._force = np.empty((len(self._own), 3, len(copies.turns)))

    @property
    def parts(self) -> int:
        """How many jobs a product is made of."""
        return -(-len(self._moved) // _ROWS)

    def gather(self, part: int, u: np.ndarray) -> None:
        """First round of jobs: displacements (3 nodes,) into the frame of the first copy."""
        last = min((part + 1) * _ROWS, len(self._moved))
        _gather_copies(part * _ROWS, last, self._numbers, self._turns, u, self._moved)

    def multiply(self, part: int, out: np.ndarray) -> None:
        """Second round: forces into ``out`` (3 nodes,)."""
        first, last = part * _ROWS, min((part + 1) * _ROWS, len(self._own))
        r = self.rows
        add_rows(first, last, self._own, r.starts, r.neighbours, r.data, self._moved, self._force)
        _spread_copies(first, last, self._own, self._numbers, self._turns, self._force, out)

    def apply(self, u: np.ndarray) -> np.ndarray:
        """(3 nodes,) forces of all copies at u (3 nodes,), zero elsewhere."""
        out = np.zeros_like(u)
        for part in range(self.parts):
            self.gather(part, u)
        for part in range(self.parts):
            self.multiply(part, out)
        return out

    def times(self, displacement: np.ndarray) -> np.ndarray:
        """(3 n, m) forces on the first copy of displacements (3 n, m), of a body that is one copy."""
        columns = np.ascontiguousarray(displacement.reshape(len(self._moved), 3, -1))
        return self.rows.times(self._own, columns).reshape(displacement.shape)


#: Elements below which one more thread costs more than it saves: handing over work takes some 50 us, 1000 elements.
_EACH = 8000
#: Nodes that are summed together, so that what follows finds their forces in the second cache.
_NODES = 8192


def threads_for(elements: int) -> int:
    """Threads for so many elements: all cores that this process may use, fewer for small bodies."""
    return max(1, min(usable_cores(), elements // _EACH))


class BodyForces:
    """Forces K u of bodies whose nodes follow one another.

    operators : of the bodies;  starts : (bodies + 1,) first node of each
    groups : equal parts; bodies in none of them, and those of one-point elements, whose forces cost a third of what the product
        with a matrix does, are computed element by element

    The sums have one order whatever the number of threads (``raceway.core.fem.hexahedron.rows``).
    """

    def __init__(self, operators: list[HexOperator], starts: np.ndarray, groups: list[Group] | None = None) -> None:
        self._operators, self._starts = operators, [int(start) for start in starts]
        worth = [group for group in groups or [] if operators[group.members[0]].formulation != "one_point"]
        #: By the first body of a group.
        self._copied = {group.members[0]: CopiedStiffness(group.copies, operators[group.members[0]]) for group in worth}
        alone = set(range(len(operators))) - {body for group in worth for body in group.members}
        ranges = [(int(n), body, r) for body in sorted(alone) for r, n in enumerate(operators[body].range_sizes)]
        #: Body and range, the largest first: what comes last shall not keep one thread busy alone.
        self._queue = [(body, r) for _, body, r in sorted(ranges, key=lambda job: -job[0])]
        self._products = [(copies, part) for copies in self._copied.values() for part in range(copies.parts)]
        self._parts = [
            (body, first, min(first + _NODES, len(operator.points)), body in alone)
            for body, operator in enumerate(operators)
            for first in range(0, len(operator.points), _NODES)
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
                copies, part = products[number - ahead - len(self._queue)]
                copies.gather(part, u)

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
        copies = self._copied.get(body)
        if copies is None:
            return self._operators[body].internal_force(self._of(u, body)).reshape(-1)
        return self._of(copies.apply(u), body)

    def of_mesh(self, body: int, displacement: np.ndarray) -> np.ndarray:
        """(3 n, m) forces of one body at displacements (3 n, m) of its own."""
        if body in self._copied:
            return self._copied[body].times(displacement)
        force = [self._operators[body].internal_force(column).reshape(-1) for column in displacement.T]
        return np.stack(force, axis=1)

    def hourglass_energy(self, u: np.ndarray, pool: ThreadPool) -> float:
        """The part of the strain energy at u (3 nodes,) that hourglass control holds [J]."""
        queue = [(body, r) for body, operator in enumerate(self._operators) for r in range(len(operator.range_sizes))]
        energy = np.empty(len(queue))

        def work(number: int) -> None:
            body, r = queue[number]
            energy[number] = self._operators[body].range_hourglass_energy(r, self._of(u, body))

        pool.do(len(queue), work)
        return float(energy.sum())

    def _of(self, values: np.ndarray, body: int) -> np.ndarray:
        return values[3 * self._starts[body] : 3 * self._starts[body + 1]]
