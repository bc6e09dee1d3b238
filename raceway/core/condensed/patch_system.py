"""The ring on balls whose contacts are nodal patches: the interface of ``raceway.core.system.System``, stepped from Python."""

from __future__ import annotations

from functools import partial
from typing import Any

import attrs
import numpy as np

from raceway.core.bodies.ring import (
    CENTRIFUGAL,
    DAMPING,
    LEVER,
    OFFSET_INNER,
    OFFSET_OUTER,
    OUTER_SHARE,
    SIDE,
    TILT_ARM,
    place,
)
from raceway.core.condensed.balls import Balls, Linear
from raceway.core.condensed.pool import STEP, Pool, Row
from raceway.core.system import TOLERANCE, Evaluation, System
from raceway.errors import ConvergenceError

_LIMIT = 60
#: Balls' residual over the largest contact force at which they are in equilibrium.
_BALLS = 1e-11


@attrs.define(eq=False)
class PatchSystem(System):
    """M q'' + C q' + K q + f(q, q') = load + force(t), f from pressures at surface points of finite elements.

    The kernels of the base class are those of rigid rings with Hertz's contacts: they give first guesses.

    Attributes
    ----------
    pool : patches and solvers, shared by all copies of this system
    """

    pool: Pool = attrs.field(kw_only=True)

    @property
    def companion(self) -> System:
        """The same ring with rigid bodies and Hertz's contacts, compiled."""
        fields = [f.name for f in attrs.fields(System)]
        return System(**{name: getattr(self, name) for name in fields})

    @property
    def conservative(self) -> bool:
        return True

    @property
    def ball_columns(self) -> int:
        return 2

    def evaluate(
        self,
        q: np.ndarray,
        v: np.ndarray | None = None,
        ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None,
        t: float = 0.0,
        *,
        dt: float = 0.0,
        ball_gain: float = 0.0,
        memory: np.ndarray | None = None,
    ) -> Evaluation:
        q = np.asarray(q, dtype=float)
        v = np.zeros(5) if v is None else np.asarray(v, dtype=float)
        return self.pool.widened(lambda: self._evaluate(q, v, ball, ball_rate, t, ball_gain))

    def _evaluate(
        self, q: np.ndarray, v: np.ndarray, ball: np.ndarray | None, ball_rate: np.ndarray | None, t: float, gain: float
    ) -> Evaluation:
        row = self.pool.row(self.table)
        centre, jacobian, velocity = self._groove(q, v, t)
        where = self._places(centre, ball)
        moving = bool(v.any()) or ball_rate is not None
        rate = self._rates(row, velocity, where, ball_rate, gain) if moving else np.zeros((2 * self.ball_count, 2))
        where, now = row.settle(centre, where, rate, _BALLS)
        return self._answer(row.balls, centre, jacobian, where, rate, now)

    def stiffness_at(self, q: np.ndarray, now: Evaluation) -> np.ndarray:
        """Stiffness of the contacts (5, 5) at an equilibrium, without the ripple of points that come and go."""

        def found() -> np.ndarray:
            row, still = self.pool.row(self.table), np.zeros((2 * self.ball_count, 2))
            centre, jacobian, _ = self._groove(q, np.zeros(5), 0.0)
            where, last = row.settle(centre, now.ball, still, _BALLS)
            smooth = row.balls.without_ripple(last, centre, where)
            return np.asarray(jacobian.T @ row.balls.tangent(smooth) @ jacobian)

        return self.pool.widened(found)

    def settle(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under ``load``: ring and balls together by Newton, from the equilibrium of rigid bodies.

        Raises
        ------
        ConvergenceError
            With the last state.
        """
        if ball is not None and np.any(ball):
            try:
                return self.pool.widened(lambda: self._newton(q, np.asarray(ball), self.load, tolerance))
            except ConvergenceError:
                pass  # from rigid bodies, then
        for parts in (1, 4, 16):
            try:
                return self._by_load(q, parts, tolerance)
            except ConvergenceError as why:
                if parts == 16 or "nothing holds" in str(why):
                    raise
        raise AssertionError("unreachable")

    def _by_load(self, q: np.ndarray, parts: int, tolerance: float) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under the load in so many parts, the first from the equilibrium of rigid bodies."""
        first = attrs.evolve(self.companion, load=self.load / parts)
        place, ball, _ = first.settle(q)
        if not self.table[:, CENTRIFUGAL].any():
            ball = np.zeros_like(ball)  # weightless balls of rigid bodies have no place of their own
        total = 0
        for part in range(1, parts + 1):
            task = partial(self._newton, place, ball, self.load * (part / parts), tolerance)
            place, ball, count = self.pool.widened(task)
            total += count
        return place, ball, total

    def _newton(
        self, q: np.ndarray, ball: np.ndarray, load: np.ndarray, tolerance: float
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Ring and balls in one iteration."""
        row, none = self.pool.row(self.table), np.zeros(5)
        balls = row.balls
        still = np.zeros((2 * self.ball_count, 2))
        q = q.copy()
        centre, jacobian, _ = self._groove(q, none, 0.0)
        where, force = self._places(centre, ball), np.zeros((2 * self.ball_count, 2))
        now = balls.linear(centre, where, force, still)
        weight = np.array([1.0, 1.0, 1.0, 1.0 / self.arm, 1.0 / self.arm]) * self.free
        limit = STEP * self.pool.diameter
        chosen = self.free > 0.0
        best = np.inf
        for iteration in range(1, _LIMIT + 1):
            rest = jacobian.T @ balls.carried(now) + self.stiffness @ q - load
            out = jacobian.T @ now.force[: self.ball_count].reshape(-1) + self.stiffness @ q - load
            size = max(float(np.abs(out * weight).max()), balls.residual(now))
            scale = float(np.abs(now.force[: self.ball_count]).sum() + np.abs(load * weight).sum())
            relative = size / max(scale, 1e-300)
            if relative <= tolerance or (relative <= 1e3 * tolerance and size >= best):
                row.force, row.last, row.centre, row.where = now.force, now, centre, where
                return q, where, iteration
            best = min(best, size)
            tangent = jacobian.T @ balls.tangent(now) @ jacobian + self.stiffness
            dq = np.zeros(5)
            matrix = self.reduced(tangent)
            matrix += 1e-12 * max(np.trace(matrix), 1.0) * np.eye(len(matrix))
            dq[chosen] = np.linalg.solve(matrix, -rest[chosen])
            step, change = balls.move(now, jacobian @ dq)
            reach = max(float(np.abs(jacobian @ dq).max()), float(np.abs(step).max()))
            if not np.isfinite(reach):
                break
            part = min(1.0, limit / max(reach, 1e-300))
            before = size
            for _ in range(6):
                other_q = q + part * dq
                centre, _, _ = self._groove(other_q, none, 0.0)
                other = balls.linear(centre, where + part * step, force + part * change, still)
                out = jacobian.T @ other.force[: self.ball_count].reshape(-1) + self.stiffness @ other_q - load
                if max(float(np.abs(out * weight).max()), balls.residual(other)) < 2.0 * before:
                    break
                part *= 0.4
            q, where, force, now = other_q, where + part * step, force + part * change, other
        raise ConvergenceError(
            f"no static equilibrium of the nodal contacts found after {_LIMIT} iterations, relative residual {relative:.1e}",
            {"q": q, "ball": where},
        )

    def pressures(self) -> list[Any]:
        """Answers of all contacts (``raceway.core.condensed.contact.Pressed``), inner races first, at the last state."""
        last = self.pool.row(self.table).last
        return [] if last is None else last.pressed

    def _answer(
        self, balls: Balls, centre: np.ndarray, jacobian: np.ndarray, where: np.ndarray, rate: np.ndarray, now: Linear
    ) -> Evaluation:
        force = np.array([one.force for one in now.pressed])
        size = np.hypot(force[:, 0], force[:, 1])
        viscous = np.zeros((4 * self.ball_count, 4 * self.ball_count))
        for k, one in enumerate(now.pressed):
            block = one.viscous
            if self.scalars[DAMPING] > 0.0 and size[k] > 0.0:
                normal = force[k] / size[k]
                dashpot = self.scalars[DAMPING] * np.outer(normal, normal)
                pull = -float(normal @ dashpot @ rate[k])
                if size[k] + pull > 0.0:
                    force[k] += pull * normal
                    block = block + dashpot
            viscous[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
        along = balls.slip(now) @ jacobian
        inner = force[: self.ball_count]
        reach = np.concatenate([centre - where, where])
        rest = np.repeat([self.scalars[OFFSET_INNER], self.scalars[OFFSET_OUTER]], self.ball_count)
        return Evaluation(
            jacobian.T @ inner.reshape(-1),
            jacobian.T @ balls.tangent(now) @ jacobian,
            along.T @ viscous @ along,
            rest - np.hypot(reach[:, 0], reach[:, 1]),
            np.hypot(force[:, 0], force[:, 1]),
            where,
            self.law_state.copy(),
        )

    def _groove(self, q: np.ndarray, v: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(Z, 2) inner groove centres, (2 Z, 5) their derivatives by q, (Z, 2) their velocities."""
        work = np.zeros((3, 2 * self.ball_count))
        place(float(t), np.ascontiguousarray(q, dtype=float), v, self.scalars, self.table, work, 0, 1, 2)
        (c, s), centre, velocity = work[0].reshape(2, -1), work[1].reshape(2, -1).T.copy(), work[2].reshape(2, -1).T.copy()
        side, lever, arm = self.table[:, SIDE], self.table[:, LEVER], self.scalars[TILT_ARM]
        jacobian = np.zeros((self.ball_count, 2, 5))
        jacobian[:, 0, 0], jacobian[:, 0, 3], jacobian[:, 0, 4] = side, side * arm * s, -side * arm * c
        jacobian[:, 1, 1], jacobian[:, 1, 2] = c, s
        jacobian[:, 1, 3], jacobian[:, 1, 4] = -lever * s, lever * c
        return centre, jacobian.reshape(-1, 5), velocity

    def _places(self, centre: np.ndarray, ball: np.ndarray | None) -> np.ndarray:
        """(Z, 2) first guess of the balls' places; rows of zeros are guessed from the groove centres."""
        out = np.zeros((self.ball_count, 2)) if ball is None else np.array(ball[:, :2], dtype=float)
        unknown = ~out.any(axis=1)
        if unknown.any():
            reach = np.hypot(centre[:, 0], centre[:, 1])
            li, lo = self.scalars[OFFSET_INNER], self.scalars[OFFSET_OUTER]
            over = reach - li - lo
            share = np.where(over > 0.0, (lo + self.table[:, OUTER_SHARE] * over) / reach, lo / (li + lo))
            out[unknown] = (share[:, None] * centre)[unknown]
        return out

    def _rates(
        self, row: Row, velocity: np.ndarray, where: np.ndarray, ball_rate: np.ndarray | None, gain: float
    ) -> np.ndarray:
        """(2 Z, 2) velocities of the balls seen from both grooves; balls follow the ring where no rate is given."""
        if ball_rate is not None:
            own = gain * where + ball_rate[:, :2]
        elif row.last is not None:
            own = (row.balls.follow(row.last) @ velocity.reshape(-1)).reshape(-1, 2)
        else:
            own = self.table[:, [OUTER_SHARE]] * velocity
        return np.concatenate([own - velocity, own])
