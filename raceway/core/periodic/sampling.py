"""Equidistant samples of a periodic motion, as the ``Record`` that identifiers, energies and lines read."""

from __future__ import annotations

from typing import Any

import numpy as np

from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.rule import integrals
from raceway.core.periodic.sweep import contacts, forces
from raceway.core.periodic.symmetry import rotations
from raceway.core.ring.orbit import States
from raceway.core.stepping.record import Motion, Record, Schedule
from raceway.errors import ConvergenceError
from raceway.storage.tables import Tables


def motion_at(problem: Problem, path: Path, angles: np.ndarray) -> tuple[np.ndarray, ...]:
    """q, dq/dtheta, d2q/dtheta2 (n, 5), balls and rates (n, Z, c) at angles (n,) within the span; balls are interpolated."""
    k, step, u, q, (values, once, _), a = _displacement_at(problem, path, angles)
    s = len(problem.rule.points)
    v = path.v[k] + step * np.einsum("ns,nsc->nc", once, a)
    shape = (path.intervals, s, *path.ball.shape[1:])
    ball, rate = (np.einsum("ns,nszc->nzc", values, x.reshape(shape)[k]) for x in (path.ball, path.rate))
    return q, v, np.einsum("ns,nsc->nc", values, a), ball, rate


def _displacement_at(problem: Problem, path: Path, angles: np.ndarray) -> tuple[Any, ...]:
    """Of angles (n,) the intervals, their lengths (n, 1), the places in them, q (n, 5), the rule's integrals, accelerations."""
    s, h = len(problem.rule.points), np.diff(path.nodes)
    k = np.clip(np.searchsorted(path.nodes, angles, side="right") - 1, 0, path.intervals - 1)
    step = h[k][:, None]
    u = (angles - path.nodes[k]) / h[k]
    rule = integrals(problem.rule.points, u)
    a = path.a.reshape(path.intervals, s, 5)[k]
    q = path.q[k] + u[:, None] * step * path.v[k] + step**2 * np.einsum("ns,nsc->nc", rule[2], a)
    return k, step, u, q, rule, a


def displacements(solved: Solved, angles: np.ndarray) -> np.ndarray:
    """q (n, 5) at any angles (n,): the first of ``states``."""
    problem, symmetry = solved.problem, solved.problem.symmetry
    spans = _spans(symmetry.span, angles)
    q = _displacement_at(problem, solved.path, angles - spans * symmetry.span)[3]
    return np.einsum("nij,nj->ni", rotations(symmetry.angle * np.arange(spans.max() + 1))[spans], q) if spans.any() else q


def _spans(span: float, angles: np.ndarray) -> np.ndarray:
    """How many whole spans lie before each angle; a sample at the very end of one belongs to it: nothing has to be turned then."""
    return np.maximum(np.ceil(angles / span - 1e-12).astype(int) - 1, 0)


def record(solved: Solved, schedule: Schedule, counts: Tables) -> Record:
    """Samples at every ``stride``-th step of a schedule, which begins at angle zero.

    Parameters
    ----------
    counts : what the record says about its making; penetration and contact force are added
    """
    problem = solved.problem
    system, span = problem.system, problem.symmetry.span
    every = problem.speed * schedule.dt * schedule.stride
    total = schedule.steps // schedule.stride
    angles = every * np.arange(1, total + 1)
    # Where samples of one span fall on those of the next they need not be computed again.
    a_turn = schedule.steps_per_turn // schedule.stride
    inside = round(span / every)
    if a_turn * schedule.stride != schedule.steps_per_turn or abs(inside * every - span) > 1e-9 * span:
        inside = total
    inside = min(inside, total)
    q, v, a, ball, rate, gap, force = _with_contacts(solved, angles[:inside])
    repeat = _Repeat(problem, inside, total)
    push = np.empty((total, 5))
    time = schedule.dt * schedule.stride * np.arange(1, total + 1)
    forces(system.force, system.force_params, time, push)
    displacement, velocity, places = repeat.states(q), repeat.states(v) * problem.speed, repeat.balls(ball)
    before = places[-2] if schedule.stride == 1 and total > 1 else places[-1] - schedule.dt * repeat.balls(rate)[-1]
    acceleration = repeat.states(a)[-1] * problem.speed**2 * (system.free > 0.0)
    return Record(
        time=time,
        displacement=displacement,
        velocity=velocity,
        force=push,
        gap=repeat.contacts(gap),
        contact_force=repeat.contacts(force),
        ball=places,
        final=Motion(displacement[-1].copy(), velocity[-1].copy(), acceleration, places[-1].copy(), before.copy()),
        schedule=schedule,
        counts={
            **counts,
            "max_penetration_m": float(max(-gap.min(), 0.0)),
            "peak_contact_force_n": float(force.max(initial=0.0)),
        },
    )


def states(solved: Solved, angles: np.ndarray) -> tuple[np.ndarray, ...]:
    """q, dq/dtheta, d2q/dtheta2 (n, 5), balls and rates (n, Z, c) at any angles (n,): those beyond the span are turned there."""
    problem, symmetry = solved.problem, solved.problem.symmetry
    spans = _spans(symmetry.span, angles)
    q, v, a, ball, rate = motion_at(problem, solved.path, angles - spans * symmetry.span)
    if spans.any():
        repeat = _Repeat(problem, 1, int(spans.max()) + 1)
        turn = repeat.turns[spans]
        q, v, a = (np.einsum("nij,nj->ni", turn, x) for x in (q, v, a))
        order = repeat.orders[spans][:, :, None]
        ball, rate = (np.take_along_axis(x, np.broadcast_to(order, x.shape), axis=1) for x in (ball, rate))
    return q, v, a, np.ascontiguousarray(ball), np.ascontiguousarray(rate)


def half_a_turn_later(solved: Solved, problem: Problem) -> Path:
    """The motion on its own mesh as it is half a turn later, for a problem whose force is the opposite of its own."""
    nodes = solved.path.nodes
    q, v, _, _, _ = states(solved, nodes + np.pi)
    _, _, a, ball, rate = states(solved, problem.angles(nodes) + np.pi)
    return Path(nodes, np.ascontiguousarray(q), np.ascontiguousarray(v), np.ascontiguousarray(a), ball, rate)


def _with_contacts(solved: Solved, angles: np.ndarray) -> tuple[np.ndarray, ...]:
    """The same, balls where they are at rest, with gaps and contact forces (n, 2 Z)."""
    problem, system = solved.problem, solved.problem.system
    q, v, a, ball, rate = states(solved, angles)
    gap, force = np.empty((2, len(angles), 2 * system.ball_count))
    at = States(angles / problem.speed, np.ascontiguousarray(q), np.ascontiguousarray(v * problem.speed), ball, rate)
    done = contacts(system.compiled_forces, system.law_state, at, gap, force)
    if done < len(angles):
        raise ConvergenceError("the balls find no place between the races", {"q": q[done].copy()})
    return q, v, a, ball, rate, gap, force


class _Repeat:
    """Samples of one span, ``inside`` of them, continued to ``total``: turned, with the balls renumbered."""

    def __init__(self, problem: Problem, inside: int, total: int) -> None:
        self.inside, self.total = inside, total
        spans = -(-total // inside)
        z = problem.system.ball_count
        self.turns = rotations(problem.symmetry.angle * np.arange(spans))
        self.orders = np.empty((spans, z), dtype=int)
        self.orders[0] = np.arange(z)
        for k in range(1, spans):
            self.orders[k] = problem.symmetry.order[self.orders[k - 1]]

    def states(self, values: np.ndarray) -> np.ndarray:
        """(total, 5) from (inside, 5)."""
        return (values @ self.turns.transpose(0, 2, 1)).reshape(-1, 5)[: self.total]

    def contacts(self, values: np.ndarray) -> np.ndarray:
        """(total, 2 Z) from (inside, 2 Z)."""
        both = np.concatenate([self.orders, self.orders + self.orders.shape[1]], axis=1)
        return values[:, both].swapaxes(0, 1).reshape(-1, values.shape[1])[: self.total]

    def balls(self, values: np.ndarray) -> np.ndarray:
        """(total, Z, c) from (inside, Z, c)."""
        return values[:, self.orders].swapaxes(0, 1).reshape(-1, *values.shape[1:])[: self.total]
