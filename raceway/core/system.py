"""The arrays and kernels of one small model (five coordinates of the ring, balls condensed), ready for integrators."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from raceway.core.bodies import WORK_ROWS
from raceway.core.bodies.ring import TILT_ARM
from raceway.core.equilibrium import BALLS_FAILED, CONVERGED, RUN_AWAY, settle
from raceway.errors import ConvergenceError

#: Relative residual that an equilibrium is solved to.
TOLERANCE = 1e-11
COORDINATES = ("x", "y", "z", "tilt_y", "tilt_z")


@attrs.frozen(eq=False)
class Evaluation:
    """Contact forces at one state.

    Attributes
    ----------
    force : (5,) internal force of the contacts [N, N m]
    stiffness, damping : (5, 5) its derivatives by displacement and velocity
    gap, contact_force : (2 Z,) inner races first, then outer [m, N]
    ball : (Z, 2) positions of the balls in their meridian planes [m]
    """

    force: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    ball: np.ndarray


@attrs.define(eq=False)
class System:
    """M q'' + C q' + K q + f(q, q') = load + force(t) for the ring's reference point.

    Attributes
    ----------
    kernel : compiled ``SYSTEM``;  law : compiled ``LAW``
    law_params : (2 Z, k);  law_state : (2 Z, m) committed memory of the law
    scalars, table : constants, see ``raceway.core.bodies``
    mass, damping, stiffness : (5, 5) linear parts
    free : (5,) 1 for unknowns, 0 for coordinates that are held
    load : (5,) constant load [N, N m]
    force : compiled ``FORCE``, the excitation;  force_params : (k,)
    """

    kernel: Any
    law: Any
    law_params: np.ndarray
    law_state: np.ndarray
    scalars: np.ndarray
    table: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    free: np.ndarray
    load: np.ndarray
    force: Any
    force_params: np.ndarray

    @property
    def ball_count(self) -> int:
        return self.table.shape[0]

    @property
    def arm(self) -> float:
        """Arm of the tilts [m]."""
        return float(self.scalars[TILT_ARM])

    @property
    def model(self) -> tuple[Any, ...]:
        """The arguments that every compiled loop begins with, less the excitation."""
        return self.kernel, self.law, self.law_params, self.scalars, self.table

    def outer_force(self, t: float) -> np.ndarray:
        """(5,) the excitation at a time, without ramp."""
        out = np.zeros(5)
        self.force(float(t), self.force_params, out)
        return out

    def evaluate(
        self,
        q: np.ndarray,
        v: np.ndarray | None = None,
        ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None,
        t: float = 0.0,
    ) -> Evaluation:
        """Contact forces and tangents at displacement q (5,) and velocity v (5,).

        Raises
        ------
        ConvergenceError
            When the balls find no equilibrium between the races.
        """
        z = self.ball_count
        ball = np.zeros((z, 2)) if ball is None else np.array(ball, dtype=float)
        rate = np.zeros((z, 2)) if ball_rate is None else np.ascontiguousarray(ball_rate, dtype=float)
        v = np.zeros(5) if v is None else np.ascontiguousarray(v, dtype=float)
        work = np.zeros((WORK_ROWS, 2 * z))
        f, K, C = np.empty(5), np.empty((5, 5)), np.empty((5, 5))
        status = self.kernel(
            t, 0.0, np.ascontiguousarray(q, dtype=float), v, ball, 0.0, rate, self.law, self.law_params,
            self.law_state, self.law_state.copy(), self.scalars, self.table, work, f, K, C,
        )  # fmt: skip
        if status != 0:
            raise ConvergenceError("the balls find no equilibrium between the races", {"q": np.array(q)})
        return Evaluation(f, K, C, work[0].copy(), work[2].copy(), ball)

    def settle(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under ``load`` from a first guess q (5,): displacement, balls, iterations.

        Notes
        -----
        A load that the trust region does not reach at once is raised in steps.

        Raises
        ------
        ConvergenceError
            With the last state and its residual.
        """
        start = np.array(q, dtype=float)
        total = 0
        for parts in (1, 4, 16):
            q_now = start.copy()
            ball_now = np.zeros((self.ball_count, 2)) if ball is None else np.array(ball, dtype=float)
            report = np.zeros(2)
            status = CONVERGED
            for part in range(1, parts + 1):
                work = np.zeros((WORK_ROWS, 2 * self.ball_count))
                status = settle(
                    *self.model, self.stiffness, self.free, self.load * (part / parts), tolerance, q_now, ball_now,
                    self.law_state, work, np.empty(5), np.empty((5, 5)), report,
                )  # fmt: skip
                total += int(report[0]) + 1
                if status != CONVERGED:
                    break
            if status == CONVERGED:
                return q_now, ball_now, total
            if status == RUN_AWAY:
                free = COORDINATES[int(np.argmax(np.abs(q_now) * [1.0, 1.0, 1.0, self.arm, self.arm]))]
                raise ConvergenceError(
                    f"there is no static equilibrium: nothing holds the ring against the load along {free}. Hold it or load "
                    "more balls.",
                    {"q": start, "ball": ball_now},
                )
        what = "the balls find no place between the races" if status == BALLS_FAILED else "the iteration stalls"
        raise ConvergenceError(
            f"no static equilibrium found after {total} iterations: {what}, relative residual {report[1]:.1e}",
            {"q": q_now, "ball": ball_now},
        )

    def reduced(self, matrix: np.ndarray) -> np.ndarray:
        """The part of a (5, 5) matrix that belongs to the unknowns."""
        chosen = self.free > 0.0
        return matrix[np.ix_(chosen, chosen)]

    def acceleration(self, q: np.ndarray, v: np.ndarray, outer: np.ndarray, now: Evaluation) -> np.ndarray:
        """(5,) acceleration from the balance of forces at one state."""
        chosen = self.free > 0.0
        rest = self.load + outer - now.force - self.damping @ v - self.stiffness @ q
        a = np.zeros(5)
        a[chosen] = np.linalg.solve(self.reduced(self.mass), rest[chosen])
        return a

    def natural_frequencies(self, tangent: np.ndarray) -> np.ndarray:
        """Undamped natural frequencies [rad/s], ascending, with a contact tangent (5, 5)."""
        mass = self.reduced(self.mass)
        root = np.linalg.inv(np.linalg.cholesky(mass))
        squares = np.linalg.eigvalsh(root @ self.reduced(0.5 * (tangent + tangent.T) + self.stiffness) @ root.T)
        return np.sqrt(np.maximum(squares, 0.0))

    def critical_time_step(self, tangent: np.ndarray) -> float:
        """2 / (largest natural frequency) [s]: the stable limit of central differences."""
        highest = self.natural_frequencies(tangent)[-1]
        return 2.0 / highest if highest > 0.0 else float("inf")
