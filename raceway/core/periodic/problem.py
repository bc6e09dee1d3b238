"""The boundary-value problem of a periodic motion, and a motion on a mesh."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.arrays import Eliminated, Equations, Mesh, Samples
from raceway.core.periodic.rule import Rule, rule
from raceway.core.periodic.sweep import forces
from raceway.core.periodic.symmetry import Symmetry
from raceway.core.ring.system import System


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
    watch : called between the tries of a search, which what it raises ends
    """

    system: System
    speed: float
    symmetry: Symmetry
    share: float = 1.0
    clock: float = attrs.field()
    rule: Rule = attrs.field(factory=rule)
    watch: Callable[[], None] = lambda: None

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

    @property
    def equations(self) -> Equations:
        """What compiled parts need of it."""
        system = self.system
        return Equations(system.compiled_forces, system.linear, system.law_state, self.free, self.weight, self.speed)

    def mesh(self, nodes: np.ndarray) -> Mesh:
        """Nodes (m + 1,) with the rule inside the intervals."""
        return Mesh(nodes, self.rule.packed)

    def eliminated(self, nodes: np.ndarray) -> Eliminated:
        """Room for a linearisation on a mesh."""
        m, s, n = len(nodes) - 1, len(self.rule.points), len(self.free)
        return Eliminated(np.empty((m * s * n, 2 * n + 2)), np.empty((2 * m * n, 2 * n + 2)), np.empty((2 * n, 2 * n + 2)))


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

    def samples(self, push: np.ndarray, slope: np.ndarray | None = None) -> Samples:
        """For compiled parts, with outer forces ``push`` (m s, 5) and their derivative ``slope``; zeros for none."""
        by = np.zeros_like(push) if slope is None else slope
        return Samples(self.q, self.v, self.a, self.ball, self.rate, push, by)
