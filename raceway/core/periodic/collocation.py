"""The periodic boundary-value problem on one mesh, and Newton's iteration for all its unknowns at once."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.periodic.newton import (
    CORRECTION,
    IMBALANCE,
    REPORT,
    SHORTENED,
    SINGULAR,
    SIZE,
    SOLVED,
    STALLED,
    SWEEPS,
    newton,
)
from raceway.core.periodic.rule import Rule, rule
from raceway.core.periodic.sweep import differentiate, forces
from raceway.core.periodic.symmetry import Symmetry
from raceway.core.system import System
from raceway.errors import ConvergenceError


@attrs.frozen(eq=False)
class Problem:
    """M q'' + C q' + K q + f = load + share * force(t) with q(theta + span) = P q(theta).

    Attributes
    ----------
    speed : of the force, w [rad/s]: a turn of theta is a turn of the force
    share : of the excitation that acts;  clock : speed that belongs to the excitation's own time, ``speed`` unless a branch
        is followed over speed while the bodies keep theirs
    free : (n,) numbers of the unknown coordinates
    weight : (5,) makes moments forces; lengths of tilts are tilts over it
    closing : (2 n, 2 n) rotation of an unknown state (q, v) by the span
    """

    system: System
    speed: float
    symmetry: Symmetry
    share: float = 1.0
    clock: float = attrs.field()
    rule: Rule = attrs.field(factory=rule)

    free: np.ndarray = attrs.field(init=False)
    weight: np.ndarray = attrs.field(init=False)
    closing: np.ndarray = attrs.field(init=False)

    @clock.default
    def _clock(self) -> float:
        return self.speed

    @free.default
    def _free(self) -> np.ndarray:
        return np.flatnonzero(self.system.free > 0.0)

    @weight.default
    def _weight(self) -> np.ndarray:
        arm = self.system.arm
        return np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm])

    @closing.default
    def _closing(self) -> np.ndarray:
        part = self.symmetry.rotation[np.ix_(self.free, self.free)]
        n = len(part)
        out = np.zeros((2 * n, 2 * n))
        out[:n, :n] = out[n:, n:] = part
        return out

    def angles(self, nodes: np.ndarray) -> np.ndarray:
        """(m s,) of the Gauss points."""
        return (nodes[:-1, None] + np.diff(nodes)[:, None] * self.rule.points).ravel()

    def force(self, nodes: np.ndarray) -> np.ndarray:
        """The whole excitation at the Gauss points (m s, 5)."""
        angles = self.angles(nodes)
        force = np.empty((len(angles), 5))
        forces(self.system.force, self.system.force_params, angles / self.clock, force)
        return force

    def push(self, nodes: np.ndarray) -> np.ndarray:
        """Load and excitation at the Gauss points (m s, 5)."""
        return self.system.load + self.share * self.force(nodes)

    def fill_rates(self, path: Path) -> None:
        """The balls' rates of a motion from their places; those of the next and the last span are this one's, renumbered."""
        order, h = self.symmetry.order, np.diff(path.nodes)
        before, after = path.ball[-2:][:, np.argsort(order)], path.ball[:2][:, order]
        rated = self.system.rated_columns
        ball = np.ascontiguousarray(np.concatenate([before, path.ball, after])[:, :, rated])
        nodes = np.concatenate([[path.nodes[0] - h[-1]], path.nodes, [path.nodes[-1] + h[0]]])
        rate = np.empty_like(ball)
        differentiate(nodes, self.rule.points, self.speed, ball, rate)
        path.rate[:, :, rated] = rate[2:-2]


@attrs.frozen(eq=False)
class Path:
    """A motion over one span, its derivatives by the angle.

    Attributes
    ----------
    nodes : (m + 1,) angles, from 0 to the span;  q, v : (m + 1, 5) at nodes;  a : (m s, 5) at Gauss points
    ball, rate : (m s, Z, c) columns of ``System.evaluate`` and their rates [m/s]
    """

    nodes: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    rate: np.ndarray

    @property
    def intervals(self) -> int:
        return len(self.nodes) - 1


@attrs.frozen(eq=False)
class Solved:
    """A periodic motion on one mesh.

    Attributes
    ----------
    stages, transfer, whole : the last linearisation, see ``raceway.core.periodic.sweep``
    size : largest derivative by the angle [m], the amplitude of a 1x motion; tilts as lengths at the arm
    direct : whether full steps of Newton's iteration sufficed
    sweeps : of all intervals that it took;  correction : the last one [m]
    """

    problem: Problem
    path: Path
    stages: np.ndarray
    transfer: np.ndarray
    whole: np.ndarray
    size: float
    direct: bool
    sweeps: int
    correction: float


def solve(problem: Problem, path: Path, tolerance: float, patience: int = 12, limit: int = 40) -> Solved:
    """Newton's iteration from a first guess.

    Parameters
    ----------
    tolerance : largest last correction over the motion's size
    patience : halvings of a step that may follow each other

    Raises
    ------
    ConvergenceError
        With the state at the start of the span that the iteration ended at, finite or the first guess.
    """
    system, free = problem.system, problem.free
    m, s, n = path.intervals, len(problem.rule.points), len(free)
    push = problem.push(path.nodes)
    out = np.empty((m * s * n, 2 * n + 2)), np.empty((2 * m * n, 2 * n + 2)), np.empty((2 * n, 2 * n + 2))
    report = np.zeros(REPORT)
    q, v, a, ball, rate = path.q.copy(), path.v.copy(), path.a.copy(), path.ball.copy(), path.rate.copy()
    status = newton(
        *system.model, system.law_state, system.mass, system.damping, system.stiffness, problem.weight, free, problem.speed,
        problem.closing, problem.symmetry.order, np.array(system.rated_columns), path.nodes, problem.rule.points,
        problem.rule.packed, q, v, a, ball, rate, push, np.zeros_like(push), tolerance, limit, patience, *out, report,
    )  # fmt: skip
    if status != SOLVED:
        why = {STALLED: "the iteration stalls", SINGULAR: "the motion is singular"}.get(
            status, "the balls find no place between the races"
        )
        raise ConvergenceError(
            f"no periodic motion found near the first guess: {why} after {int(report[SWEEPS])} iterations, imbalance "
            f"{report[IMBALANCE]:.2g} N",
            {"q": q[0] if np.isfinite(q[0]).all() else path.q[0].copy()},
        )
    found = attrs.evolve(path, q=q, v=v, a=a, ball=ball, rate=rate)
    return Solved(
        problem, found, *out, float(report[SIZE]), report[SHORTENED] == 0.0, int(report[SWEEPS]), float(report[CORRECTION])
    )
