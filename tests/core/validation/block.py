"""A small elastic block on a rigid plane z = 0, with a penalty and Coulomb friction at its lowest nodes: a stepped system."""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as solvers

from checks.validation.reference import elastic
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.extend import HexOperator, Motion, Observation, State, ThreadPool

YOUNG, POISSON, DENSITY = 2e9, 0.3, 7810.0


class Block:
    """Pressed down by ``weight`` [N], pulled along x by ``pull(t)`` [N], both spread over the mass.

    mass : of the whole block [kg]
    """

    ball_count, conservative, smooth = 0, False, False

    def __init__(
        self,
        weight: float,
        coefficient: float,
        pull: Callable[[float], float] = lambda t: 0.0,
        penalty: float = 1e12,
        stick: float = 1e12,
        sides: tuple[float, float, float] = (4e-3, 3e-3, 2e-3),
        counts: tuple[int, int, int] = (3, 2, 2),
        symmetric: bool = True,
    ) -> None:
        points, cells = elastic.block(sides, counts)
        self.points = points
        self.operator = HexOperator(points, cells, YOUNG, POISSON, DENSITY, "full")
        self.matrix = sp.csr_matrix(self.operator.stiffness())
        self.lumped = self.operator.lumped_mass()
        self.masses = np.repeat(self.lumped, 3)
        self.mass, self.size = float(self.lumped.sum()), points.size
        self.weight, self.pull, self.penalty = weight, pull, penalty
        self.base = np.flatnonzero(points[:, 2] < 1e-9)
        share = np.full(len(self.base), 1.0 / (counts[0] * counts[1]))
        for axis in (0, 1):
            place = points[self.base, axis]
            share[(place < 1e-9) | (place > sides[axis] - 1e-9)] *= 0.5
        self.area = share * sides[0] * sides[1]
        self.friction = CoulombFriction(coefficient, np.full(len(self.base), stick), symmetric) if coefficient else None
        self.normal = np.tile([0.0, 0.0, 1.0], (len(self.base), 1))
        self.threads = ThreadPool(1)

    def begin(self, motion: Motion) -> State:
        assert motion.full_state is not None
        if self.friction is not None and "friction" in motion.full_state:
            self.friction.restore(dict(motion.full_state))
        return State(*(motion.full_state[name].copy() for name in ("u", "v", "a", "rest")))

    def motion(self, state: State) -> Motion:
        s = state.copy()
        whole = {"u": s.u, "v": s.v, "a": s.a, "rest": -self.mass_times(s.a) if s.net_force is None else s.net_force}
        if self.friction is not None:
            whole |= self.friction.state()
        still = np.zeros((0, 2))
        return Motion(self._mean(s.u), self._mean(s.v), self._mean(s.a), still, still, full_state=whole)

    def at_rest(self, v: float = 0.0) -> Motion:
        """Settled under the weight (without friction), moving along x with v [m/s]."""
        friction, self.friction = self.friction, None
        u, zero = np.zeros(self.size), np.zeros(self.size)
        for _ in range(20):
            rest = self.internal(0.0, 0.0, u, zero) - self.external(0.0, 0.0)
            if self.measure(rest) < 1e-12 * self.weight:
                break
            # Sideways nothing holds the block but its inertia.
            u = u + self.solve(1.0, 0.0, 1e3, -rest)
        self.friction = friction
        motion = Motion(np.zeros(5), np.zeros(5), np.zeros(5), np.zeros((0, 2)), np.zeros((0, 2)))
        speed = np.tile([v, 0.0, 0.0], len(self.points))
        whole = {"u": u, "v": speed, "a": zero.copy(), "rest": zero.copy()}
        if friction is not None:
            friction.place = u.reshape(-1, 3)[self.base]
            pressure = self.penalty * np.maximum(-self._place(u)[:, 2], 0.0)
            if v:  # it has been sliding
                friction.committed[:, 0] = friction.coefficient * pressure
            whole |= friction.state()
        return Motion(motion.q, motion.v, motion.a, motion.ball, motion.ball_before, full_state=whole)

    def outer_force(self, t: float) -> np.ndarray:
        return np.array([self.pull(t), 0.0, 0.0, 0.0, 0.0])

    def external(self, t: float, scale: float) -> np.ndarray:
        return (np.outer(self.lumped / self.mass, [scale * self.pull(t), 0.0, -self.weight])).ravel()

    def internal(self, t: float, dt: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        place = self._place(u)
        gap = place[:, 2]
        pressure = self.penalty * np.maximum(-gap, 0.0)
        d_gap = np.where(gap < 0.0, -self.penalty, 0.0)
        self._gap, self._pressure = gap, pressure
        force = np.asarray(self.operator.internal_force(u)).copy()
        push = -pressure[:, None] * self.normal
        self._blocks = -d_gap[:, None, None] * (self.normal[:, :, None] * self.normal[:, None, :])
        if self.friction is not None:
            traction, tangent = self.friction.evaluate(u.reshape(-1, 3)[self.base], self.normal, pressure, d_gap)
            push, self._blocks = push - traction, self._blocks + tangent
        force[self.base] += self.area[:, None] * push
        return force.ravel()

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray) -> np.ndarray:
        rows = (3 * self.base[:, None] + np.arange(3))[:, :, None]
        i, j = np.broadcast_arrays(rows, np.swapaxes(rows, 1, 2))
        contact = sp.csr_matrix(
            ((self.area[:, None, None] * self._blocks).ravel(), (i.ravel(), j.ravel())), shape=self.matrix.shape
        )
        return solvers.spsolve((c_k * (self.matrix + contact) + sp.diags(c_m * self.masses)).tocsc(), right)

    def mass_times(self, a: np.ndarray) -> np.ndarray:
        return self.masses * a

    def accelerations(self, outer: np.ndarray, inner: np.ndarray, a: np.ndarray, c: float) -> np.ndarray:
        return (outer - inner) / self.masses

    def measure(self, r: np.ndarray) -> float:
        return float(np.linalg.norm(r))

    def contacts(self) -> tuple[float, float, float]:
        force = self.area * self._pressure
        return max(-float(self._gap.min()), 0.0), float(force.max()), float(force.sum())

    def stable_step(self) -> float:
        """Elements and contact springs together cannot be faster than both added."""
        spring = (np.maximum(self.penalty, self.friction.stick.max() if self.friction else 0.0)) * self.area
        fastest = (2.0 / self.operator.stable_step()) ** 2 + (spring / self.lumped[self.base]).max()
        return float(2.0 / np.sqrt(fastest))

    def explicit(self, dt: float, where: str) -> None:
        """No steps of its own."""

    def stiffened(self) -> bool:
        return False  # the bound counts every spring

    def commit(self) -> None:
        if self.friction is not None:
            self.friction.commit()

    def rollback(self) -> None:
        pass

    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation:
        friction = self.friction
        energies = {
            "elastic": self.operator.energy(u),
            "kinetic": float(0.5 * self.masses @ v**2),
            "contact": float(0.5 * self.penalty * self.area @ np.minimum(self._gap, 0.0) ** 2)
            + (float(self.area @ friction.stored()) if friction else 0.0),
            "friction": float(self.area @ friction.dissipated) if friction else 0.0,
        }
        return Observation(self._mean(u), self._mean(v), np.zeros(0), np.zeros(0), np.zeros((0, 2)), energies)

    def _place(self, u: np.ndarray) -> np.ndarray:
        return (self.points + u.reshape(-1, 3))[self.base]

    def _mean(self, u: np.ndarray) -> np.ndarray:
        return np.r_[self.lumped @ u.reshape(-1, 3) / self.mass, 0.0, 0.0]
