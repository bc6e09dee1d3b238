"""Explicit steps of one-point hexahedra in contact at surface points, compiled: no Python between two samples of a record.

The equations are those of ``raceway.core.time``.  Of the surface points only those are evaluated that may touch: a gap grows or shrinks by
no more than the surfaces travel, and what they have travelled since all gaps were known is summed from their largest speed.
"""

from functools import partial
from typing import Any

import numpy as np

from raceway.core.fem.elastic import explicit_kernels as kernels
from raceway.core.fem.elastic.assembly import Cage
from raceway.core.fem.elastic.contact import IN_MOTION, NodalContact, surface_gaps
from raceway.core.fem.elastic.explicit_kernels import DONE, DT, LEFT, advance, balance, evaluate, follow, move
from raceway.core.fem.hexahedron.stiffness import WORK
from raceway.core.record import State, ramp
from raceway.core.recorder import BOUND, Recorder
from raceway.core.time.stepped import CLOSED, compare

#: Elements times steps of one call, some tenths of a second.
_CALL = 5_000_000


def served(system: Any) -> bool:
    """Whether all of a system is in these loops."""
    a = system.assembly
    plain = all(body.operator.formulation == "one_point" for body in a.bodies) and not a.foundations
    return plain and isinstance(system.contact, NodalContact) and (a.cage is None or len(a.cage.fields) > 0)


class ExplicitSteps:
    """The loops over one system.

    system : ElasticSystem, see ``served``;  dt : step [s]
    """

    #: What takes the steps; gap up to which points are evaluated [m]; lanes of sums.
    device, margin, lanes = "cpu", kernels.MARGIN, 1

    def __init__(self, system: Any, dt: float) -> None:
        a = system.assembly
        assert isinstance(system.contact, NodalContact)
        self._system, self._contact, self._dt = system, system.contact, dt
        self.most = max(1, _CALL // sum(len(body.operator.cells) for body in a.bodies))
        ranges, moduli, cells, shift = [], [], [], np.zeros(5, dtype=np.int64)
        for body, first in zip(a.bodies, a.starts, strict=False):
            mine = body.operator.ranges + shift + [0, 0, first, first, 0]
            ranges.append(mine)
            moduli.append(np.tile(body.operator.moduli, (len(mine), 1)))
            cells.append(body.operator.cells + np.uint32(first))
            last = mine[-1]
            shift[:2], shift[4] = last[1], last[4] + last[3] - last[2]
        table = np.concatenate(ranges)
        parts, work = np.zeros(3 * shift[4]), np.zeros(WORK * len(table))
        self._bodies = kernels.Bodies(
            table, np.concatenate(cells), a.points.reshape(-1), np.concatenate(moduli), work, parts
        )
        m, n = a.frame_size, 3 * a.nodes
        load, inverse = np.zeros(n), np.zeros(n)
        load[a.free], inverse[a.free] = system.load[m:], 1.0 / a.free_mass
        self._nodes = kernels.Nodes(np.zeros(n), np.zeros(n), np.zeros(n), load, inverse, a.own_mass)
        cage = a.cage or Cage(None, np.zeros(0), np.zeros(0))
        spans = [(begin // 3, (begin + values.shape[1]) // 3) for _, begin, values in (a.means.blocks if a.means else ())]
        self._cage = kernels.Cages(
            np.array(spans, dtype=np.int64).reshape(-1, 2), cage.fields, cage.stiffness.reshape(len(spans), -1), cage.centres,
            np.zeros((len(spans), self.lanes, 6)), np.zeros((len(spans), 6)),
        )  # fmt: skip
        free = np.ix_(a.frame_free, a.frame_free)
        accelerating = np.zeros((m, m))
        accelerating[free] = np.linalg.inv((a.frame_mass + 0.5 * dt * a.frame_damping)[free])
        rows, at = [], []
        for first, last, shifted in zip(table[:, 2], table[:, 3], table[:, 4], strict=True):
            mine = np.flatnonzero((a.tied >= 3 * first) & (a.tied < 3 * last))
            rows.append(mine)
            at.append(a.tied[mine] + 3 * (shifted - first))
        self._frame = kernels.Frame(
            np.zeros(m), np.zeros(m), np.zeros(m), np.zeros((1, m)), a.frame_stiffness, a.frame_damping, accelerating, a.tied,
            np.ascontiguousarray(a.tie), np.concatenate(at), np.concatenate(rows), np.zeros((m, self.lanes)), np.zeros(m),
        )  # fmt: skip
        #: Of each node its place among the parts: in the last range that holds it.
        self._place = np.zeros(a.nodes, dtype=np.int64)
        for first, last, shifted in table[:, 2:]:
            self._place[first:last] = 3 * (np.arange(last - first) + shifted)

    def take(self, recorder: Recorder, count: int) -> tuple[State, float, float, float]:
        """The state after ``count`` steps from the recorder's, their outer work [J], greatest penetration [m] and contact force [N]."""
        system, dt, a, nodes = self._system, self._dt, self._system.assembly, self._nodes
        contact, m, before = self._contact, a.frame_size, recorder.state
        half = before.v + 0.5 * dt * before.a
        u = before.u + dt * half
        for values, out in ((u, nodes.u), (half, nodes.half), (before.a, nodes.a)):
            a.nodal(values, out)
        times = [recorder.time_of(recorder.done + k) for k in range(count + 1)]
        push = system.load[:m] + np.array([ramp(t, recorder.schedule.ramp) * system.on_frame(t) for t in times])
        frame = self._frame = self._frame._replace(q=u[:m].copy(), half=half[:m].copy(), a=before.a[:m].copy(), push=push)
        friction, numbers, deepest = contact.friction, np.zeros(kernels.PEAK + len(contact.counts)), 0.0
        numbers[DT], numbers[kernels.DAMPING] = dt, contact.damping
        if friction is not None:
            numbers[kernels.COEFFICIENT], numbers[kernels.SYMMETRIC] = friction.coefficient, float(friction.symmetric)
        done = 0
        while done < count:
            rows, points = self._points(contact)
            numbers[kernels.TRAVEL : LEFT + 1] = 0.0
            self._advance(recorder, done, count, numbers, points)
            done, deepest = int(numbers[DONE]), max(deepest, float(points.scalar[kernels.DEEPEST].max(initial=0.0)))
            moved = nodes.u - (0.0 if done == count else dt) * nodes.half
            if not np.abs(moved).max() < BOUND:
                raise recorder.unbounded()
            # The last step once more, at all points: its beginning is their history still.
            shift, velocity = contact.move @ moved, np.zeros((len(contact.area), 3))
            shift.reshape(-1, 3)[rows], velocity[rows] = points.displacement, points.velocity
            contact.memory[rows] = points.memory
            if friction is not None:
                friction.committed[rows], friction.place[rows] = points.committed, points.place
                friction.dissipated[rows] = points.dissipated
            contact.respond(dt, shift, velocity.reshape(-1), 0.0)
            if contact.stiffened():
                now = recorder.time_of(recorder.done + done)
                compare(system.stable_step(), system, recorder, f" at t = {now:.6g} s, {CLOSED}")
            system.commit()
        v = nodes.half + 0.5 * dt * nodes.a
        parts = (frame.q, nodes.u), (frame.half + 0.5 * dt * frame.a, v), (frame.a, nodes.a)
        state = State(*(np.concatenate([of_frame, of_nodes[a.free]]) for of_frame, of_nodes in parts))
        work = numbers[kernels.WORK] + system.load[m:] @ (state.u - before.u)[m:]
        return state, float(work), deepest, float(numbers[kernels.PEAK :].max())

    def _points(self, contact: NodalContact) -> tuple[np.ndarray, kernels.Points]:
        """The points that may touch before the surfaces have travelled by the margin, all where the law remembers, and their data."""
        shift = (contact.move @ self._nodes.u).reshape(-1, 3)
        gap, normal, bend = np.empty(len(shift)), np.empty_like(shift), np.empty((len(shift), 3, 3))
        surface_gaps(contact.place + shift, contact.pair, contact.surfaces, gap, normal, bend)
        rows = np.flatnonzero((gap < self.margin) | (contact.memory.shape[1] > 0))
        k, friction, nodes = len(rows), contact.friction, contact.nodes[rows]
        pair, pairs = contact.pair[rows], len(contact.counts)
        starts = np.searchsorted(pair, np.arange(pairs + 1))
        history = [np.zeros(k), np.zeros((k, 3)), np.zeros((k, 3)), np.zeros(k)]
        if friction is not None:
            history = [each[rows] for each in (friction.stick, friction.committed, friction.place, friction.dissipated)]
        return rows, kernels.Points._make([
            nodes, contact.weights[rows], contact.place[rows], pair, starts, contact.surfaces, contact.area[rows],
            contact.params[rows], contact.memory[rows], contact.memory[rows], *history,
            contact.projected[rows], IN_MOTION * contact.facet[rows], contact.stiffest[rows],
            *np.zeros((9, k, 3)), *np.zeros((3, k, 3, 3)), np.zeros((8, k)),
            np.zeros((pairs, self.lanes, 3)), self._place[nodes], contact.near.entries,
        ])  # fmt: skip

    def _advance(self, recorder: Recorder, first: int, count: int, numbers: np.ndarray, points: kernels.Points) -> None:
        """``advance``, whose steps threads share where there are several: they leave the same digits."""
        law, bodies, nodes, cage, frame, pool = (
            self._contact.law, self._bodies, self._nodes, self._cage, self._frame, self._system.threads
        )  # fmt: skip
        if pool.count == 1:
            advance(numbers, law, bodies, nodes, cage, frame, points, first, count)
            return
        step = first
        while step < count and numbers[LEFT] == 0.0:
            onward, again = step + 1 < count, step > first

            def job(part: int, again: bool = again) -> None:
                evaluate(part, again, numbers, law, bodies, nodes, cage, points)

            pool.do(len(bodies.ranges) + 2, job)
            balance(step, onward, numbers, bodies, frame, points)
            pool.do_shares(len(nodes.mass), partial(self._move, onward))
            follow(numbers, nodes, frame, points)
            step += 1

    def _move(self, onward: bool, first: int, last: int) -> None:
        move(first, last, onward, self._dt, self._bodies, self._nodes, self._cage)
