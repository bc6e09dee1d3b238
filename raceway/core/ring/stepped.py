"""A ring in steps of time whose forces are not compiled: what elastic bodies and pressures at surface points share."""

import numpy as np

from raceway.core.record import Motion, Observation, State, check_start
from raceway.core.ring.ring import Evaluation, Increment, Ring
from raceway.core.threads import ThreadPool

#: Growth of the tangent's diagonal that asks for the stable step anew.
_STIFFER = 1.02


class SteppedBearing:
    """``SteppedSystem`` around a system with the interface of ``raceway.core.ring.ring.Ring``.

    system : object
        Offers ``ball_count``, ``ball_columns``, ``rated_columns``, ``conservative``, ``arm``, ``mass``, ``damping``, ``stiffness`` (5, 5), ``free``, ``load``
        (5,), ``law_state``, ``outer_force(t)``, ``critical_time_step(tangent)``, ``at_speed(t)`` (itself, or with the constants
        of the speed at t), ``stopped(t)`` (a copy whose balls stand where they are at t), and ``evaluate(q, v, ball, ball_rate, t, step)``, an ``Evaluation``.

    A ball's velocity follows the second-order backward difference (3 p1 - 4 p0 + p(-1)) / (2 dt): ``evaluate`` sees it as
    ball_gain * p1 + ball_rate.
    """

    size, smooth = 5, False

    def __init__(self, system: Ring) -> None:
        self.system = system
        self.ball_count: int = system.ball_count
        self.conservative: bool = system.conservative
        self._weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm]) * system.free
        self._ball = self._before = np.zeros((self.ball_count, system.ball_columns))
        self._memory = system.law_state.copy()
        self._now: Evaluation
        self._guess: np.ndarray | None = None
        self._stiffest = np.zeros(5)
        self._damping: np.ndarray = system.damping
        self.threads = ThreadPool(1)

    def begin(self, motion: Motion) -> State:
        check_start(self.system, motion)
        self._ball, self._before = motion.ball.copy(), motion.ball_before.copy()
        self._memory = (self.system.law_state if motion.memory is None else motion.memory).copy()
        self.rollback()
        net_force = -self.mass_times(motion.a) if motion.net_force is None else motion.net_force.copy()
        return State(motion.q.copy(), motion.v.copy(), motion.a.copy(), net_force)

    def motion(self, state: State) -> Motion:
        s = state.copy()
        net_force = -self.mass_times(s.a) if s.net_force is None else s.net_force
        return Motion(s.u, s.v, s.a, self._ball.copy(), self._before.copy(), net_force, self._memory.copy())

    def outer_force(self, t: float) -> np.ndarray:
        return np.asarray(self.system.outer_force(t))

    def external(self, t: float, scale: float) -> np.ndarray:
        return np.asarray(self.system.load + scale * self.system.outer_force(t))

    def internal(self, t: float, dt: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        system, rate, gain = self.system.at_speed(t), np.zeros_like(self._ball), 0.0
        self._damping = system.damping
        guess, rate_columns = self._ball.copy(), system.rated_columns
        if dt > 0.0:
            gain = 1.5 / dt
            rate[:, rate_columns] = (0.5 * self._before[:, rate_columns] - 2.0 * self._ball[:, rate_columns]) / dt
            guess[:, rate_columns] = 2.0 * self._ball[:, rate_columns] - self._before[:, rate_columns]
        else:
            system = system.stopped(t)
        if self._guess is not None:  # what is not rated, slips, is handed over as it was committed
            guess[:, rate_columns] = self._guess[:, rate_columns]
        self._now = system.evaluate(u, v, guess, rate, t, Increment(dt, gain, self._memory))
        self._guess = self._now.ball.copy()
        return np.asarray(self._now.force + system.damping @ v + system.stiffness @ u)

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray) -> np.ndarray:
        s, now = self.system, self._now
        return self._free_solve(
            c_k * (now.stiffness + s.stiffness) + c_c * (now.damping + self._damping) + c_m * s.mass, right
        )

    def mass_times(self, a: np.ndarray) -> np.ndarray:
        return np.asarray(self.system.mass @ a)

    def accelerations(self, outer: np.ndarray, inner: np.ndarray, a: np.ndarray, c: float) -> np.ndarray:
        return self._free_solve(self.system.mass + c * self._damping, outer - inner + c * (self._damping @ a))

    def measure(self, r: np.ndarray) -> float:
        return float(np.abs(r * self._weight).max())

    def contacts(self) -> tuple[float, float, float]:
        gap, force = self._now.gap, self._now.contact_force
        return max(float(-gap.min()), 0.0), max(float(force.max()), 0.0), float(np.abs(force).sum())

    def stable_step(self) -> float:
        np.maximum(self._stiffest, np.diag(self._now.stiffness), out=self._stiffest)
        return float(self.system.damped_time_step(self._now.stiffness, self._now.damping))

    def explicit(self, dt: float, where: str) -> None:
        """No steps of its own."""

    def stiffened(self) -> bool:
        return bool((np.diag(self._now.stiffness) > _STIFFER * self._stiffest).any())

    def commit(self) -> None:
        self._before, self._ball, self._memory = self._ball, self._now.ball, self._now.memory
        self._guess = None

    def rollback(self) -> None:
        self._guess = None

    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation:
        return Observation(u.copy(), v.copy(), self._now.gap, self._now.contact_force, self._ball.copy())

    def _free_solve(self, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
        free = self.system.free > 0.0
        out = np.zeros(5)
        try:
            out[free] = np.linalg.solve(self.system.reduced(matrix), right[free])
        except np.linalg.LinAlgError:
            out[free] = np.nan  # the next residual is not a number, which the loops report
        return out
