"""A ring whose contact forces are compiled: kernels and their arrays, ready for compiled loops."""

import attrs
import numpy as np

from raceway.core.contact.geometry import Growth
from raceway.core.jit import Kernel, jit
from raceway.core.record import check_state
from raceway.core.ring.equilibrium import BALLS_FAILED, CONVERGED, ITERATIONS, RESIDUAL, RUN_AWAY, SLOW, solve_equilibrium
from raceway.core.ring.kernels import CONTACT_FORCE, GAP, layout
from raceway.core.ring.kernels.layout import are_condensed, elastic_columns, work_rows
from raceway.core.ring.ring import AT_ONCE, COORDINATES, TOLERANCE, Evaluation, Increment, Ring
from raceway.core.signatures import FORCE, Balls, Constants, Contacts, Forces, Linear, Response, StaticState
from raceway.errors import ConvergenceError

#: Rounding of a force over stiffness and distance of ball and groove centres; 0.4 to 0.7 of 2.2e-16 were measured.
_ROUNDING = 8.9e-16


@jit(FORCE)
def no_force(t, params, out):  # type: ignore[no-untyped-def]
    """The force of no excitation."""
    for i in range(out.size):
        out[i] = 0.0


@attrs.define(eq=False, kw_only=True)
class System(Ring):
    """A ring whose contact forces are compiled.

    Attributes
    ----------
    kernel : compiled ``SYSTEM``;  law : compiled ``LAW``
    base_kernel : the same bodies without gyroscopic moments and friction, whose forces have a potential; ``kernel``
        itself where there are none
    law_params : (2 Z, k);  mounted_params : those at standstill, where the law has others
    reach : (2 Z,) how far from touching the contacts begin to carry [m], which the table's offsets hold
    """

    kernel: Kernel
    base_kernel: Kernel
    law: Kernel
    law_params: np.ndarray
    mounted_params: np.ndarray | None = None
    reach: np.ndarray | None = None

    @property
    def conservative(self) -> bool:
        """Whether the ball forces have a potential: neither friction nor gyroscopic moments."""
        return self.base_kernel is self.kernel

    def of_balls(self, balls: np.ndarray, table: np.ndarray) -> "System":
        """With the law's parameters of their contacts."""
        ring, contacts = super().of_balls(balls, table), self.contacts_of(balls)
        ring.law_params = np.ascontiguousarray(self.law_params[contacts])
        if self.mounted_params is not None and self.reach is not None:
            ring.mounted_params, ring.reach = self.mounted_params[contacts].copy(), self.reach[contacts].copy()
        return ring

    def running(self, law_params: np.ndarray, reach: np.ndarray) -> "System":
        """A copy with the law's parameters (2 Z, k) and reach (2 Z,) [m] at a running speed."""
        table, before = self.table.copy(), 0.0 if self.reach is None else self.reach
        table[:, [layout.OWN_OFFSET_INNER, layout.OWN_OFFSET_OUTER]] -= (reach - before).reshape(2, -1).T
        rest_params = self.law_params if self.mounted_params is None else self.mounted_params
        return attrs.evolve(self, table=table, law_params=law_params, mounted_params=rest_params, reach=reach)

    def standing(self, growth: Growth) -> "System":
        """At standstill, where laws have the parameters of standstill."""
        ring = super().standing(growth)
        if ring.mounted_params is None or ring.reach is None:
            return ring
        return ring.running(ring.mounted_params, np.zeros_like(ring.reach))

    def at_standstill(self) -> "System":
        """Where nothing else is tangential, by the kernel whose forces have a potential."""
        still = super().at_standstill()
        return (
            still if still.scalars[layout.GYROSCOPIC] else attrs.evolve(still.without(layout.STICK), kernel=self.base_kernel)
        )

    @property
    def ball_columns(self) -> int:
        return (2 if self.conservative else 4) + elastic_columns(self.scalars)

    @property
    def condensed(self) -> bool:
        """Whether rings and balls are elastic: ``ball`` then has columns for that behind positions and slips."""
        return are_condensed(self.scalars)

    @property
    def coupled(self) -> bool:
        """Whether balls interact through elastic rings, which move groove centres."""
        return elastic_columns(self.scalars) == 4

    @property
    def rated_columns(self) -> list[int]:
        """Columns of ``ball`` that have rates: positions and what elasticity adds, not slips."""
        return [0, 1, *range(2 if self.conservative else 4, self.ball_columns)]

    def structural_approach(self, ball: np.ndarray) -> np.ndarray:
        """(..., 2 Z) what the elasticity of the bodies adds to the approach of each contact [m], from ball (..., Z, k)."""
        inner, outer = (2, 3) if self.conservative else (4, 5)
        return np.concatenate([ball[..., inner], ball[..., outer]], axis=-1)

    def groove_displacement(self, ball: np.ndarray) -> np.ndarray:
        """(..., Z, 2) motion (axial, radial) of the inner groove centres against the outer ones by elastic rings [m]."""
        return ball[..., -2:] if self.coupled else np.zeros((*ball.shape[:-1], 2))

    def between_balls(self) -> tuple[np.ndarray, np.ndarray]:
        """M and M_o (2 Z, 2 Z) between groove centres, axial and radial ball by ball [m/N]; see ``raceway.core.ring.kernels.between``.

        Of M_o only the columns of radial forces are known.
        """
        row, count = int(self.scalars[layout.ROW]), self.ball_count
        blocks = self.scalars[-layout.BLOCK * row :].reshape(row, layout.BLOCK)
        both, outer = np.zeros((count, 2, count, 2)), np.zeros((count, 2, count, 2))
        for k in range(count):
            for j in range(k // row * row, k // row * row + row):
                axial, cross, radial, *by_radial = blocks[(k - j) % row]
                both[k, :, j] = [[axial, cross], [cross, radial]]
                outer[k, :, j, 1] = by_radial
        return both.reshape(2 * count, -1), outer.reshape(2 * count, -1)

    def ring_energy(self, ball: np.ndarray) -> np.ndarray:
        """(...) energy F.M F / 2 that rings store by balls acting on each other [J], but for a constant, from ball (..., Z, k)."""
        if not self.coupled:
            return np.zeros(ball.shape[:-2])
        both, outer = self.between_balls()
        push = np.zeros((self.ball_count, 2))
        push[:, 1] = self.table[:, layout.CENTRIFUGAL]
        elastic_shift = -(self.groove_displacement(ball).reshape(*ball.shape[:-2], -1) + outer @ push.reshape(-1))
        return 0.5 * np.einsum("...i,ij,...j->...", elastic_shift, np.linalg.pinv(both, rcond=1e-12), elastic_shift)

    def _work(self) -> np.ndarray:
        return np.zeros((work_rows(self.scalars, self.table), 2 * self.ball_count))

    @property
    def compiled_forces(self) -> Forces:
        """The compiled forces of the contacts, for compiled loops."""
        return Forces(self.kernel, self.law, self.law_params, Constants(self.scalars, self.table))

    @property
    def linear(self) -> Linear:
        """The linear parts, for compiled loops."""
        return Linear(self.mass, self.damping, self.stiffness, self.free, self.load)

    def evaluate(
        self,
        q: np.ndarray,
        v: np.ndarray | None = None,
        ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None,
        t: float = 0.0,
        step: Increment = AT_ONCE,
    ) -> Evaluation:
        check_state(self, "System.evaluate()", q=q, v=v, ball=ball, ball_rate=ball_rate, memory=step.memory)
        scalars, shape = self.scalars, (self.ball_count, self.ball_columns)
        rate = np.zeros(shape) if ball_rate is None else np.array(ball_rate, dtype=float)
        if not self.conservative:  # slips have no rates: what was committed stands there
            rate[:, 2:4] = 0.0 if ball is None else np.asarray(ball)[:, 2:4]
        if ball is None:
            # Without a history nothing sticks.
            ball, scalars = np.zeros(shape), self.without(layout.FRICTION).scalars
        else:
            ball = np.array(ball, dtype=float)
        v = np.zeros(5) if v is None else np.ascontiguousarray(v, dtype=float)
        work = self._work()
        f, K, C = np.empty(5), np.empty((5, 5)), np.empty((5, 5))
        old = self.law_state if step.memory is None else step.memory
        new = old.copy()
        contacts = Contacts(self.law, self.law_params, old, new, step.dt)
        status = self.kernel(
            t, np.ascontiguousarray(q, dtype=float), v, Balls(ball, step.gain, rate), contacts,
            Constants(scalars, self.table), Response(f, K, C, work),
        )  # fmt: skip
        if status != 0:
            raise ConvergenceError("the balls have no equilibrium between the races", {"q": np.array(q)})
        return Evaluation(f, K, C, work[GAP].copy(), work[CONTACT_FORCE].copy(), ball, new)

    def stiffness_at_rate(self, q: np.ndarray, now: Evaluation, rate: float) -> np.ndarray:
        """K(g) + g C(g) (5, 5) of motions with exp(g t), g = rate [1/s], about an equilibrium: the balls move with the ring."""
        evaluation = self.evaluate(q, ball=now.ball, ball_rate=-rate * now.ball, step=Increment(gain=rate))
        return evaluation.stiffness + rate * evaluation.damping

    def force_rounding(self, q: np.ndarray, ball: np.ndarray | None = None) -> float:
        """What rounding leaves of an imbalance of forces near a state [N]: that of gaps, times the stiffness."""
        stiffness = (
            np.abs(np.diag(self.evaluate(q, ball=ball).stiffness)) / np.array([1.0, 1.0, 1.0, self.arm, self.arm]) ** 2
        )
        return float(_ROUNDING * (self.scalars[layout.OFFSET_INNER] + self.scalars[layout.OFFSET_OUTER]) * stiffness.max())

    def damping_at(self, q: np.ndarray, now: Evaluation) -> np.ndarray:
        """Damping of the contacts (5, 5) at an equilibrium that was evaluated, of slow motions: the balls move, too.

        In a motion with exp(g t) every rate is g times a displacement, the balls' as well: the force changes by K(g) + g C(g), and
        the damping is the derivative of that by g at 0.  C(0) alone is that of a ring which moves while the balls stay.
        """
        if not now.damping.any():
            return now.damping
        rate = SLOW * float(np.diag(now.stiffness)[:3].max() / np.diag(now.damping)[:3].max())
        return (self.stiffness_at_rate(q, now, rate) - self.stiffness_at_rate(q, now, -rate)) / (2.0 * rate)

    def viscous_stiffness_at(self, q: np.ndarray, ball: np.ndarray, frequency: float) -> np.ndarray:
        still = self.without(layout.CAGE)
        now = still.evaluate(q, ball=ball)
        if not now.damping.any():
            return np.zeros((5, 5), dtype=complex)
        from raceway.core.ring.viscous_stiffness import viscous_stiffness

        damping, cage = still.damping_at(q, now), self.scalars[layout.CAGE]
        return viscous_stiffness(lambda rate: still.stiffness_at_rate(q, now, rate), damping, frequency, cage)

    def solve_equilibrium(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """By a trust region on the potential; what has none is added to that equilibrium.

        A load that the trust region does not reach at once is raised in steps.  Gyroscopic moments are added to the
        equilibrium without them, all at once or in steps.  Friction is left out: the balls have rolled into place, and
        their slips are set so that no contact carries a tangential force.
        """
        check_state(self, "System.solve_equilibrium()", q=q, ball=ball)
        base = attrs.evolve(self, kernel=self.base_kernel)
        start = None if ball is None or not self.conservative else ball
        q_now, ball_now, total = base._by_parts(solve_equilibrium, q, start, tolerance, base.load, (1, 4, 16))
        if self.conservative:
            return q_now, ball_now, total
        from raceway.core.ring.equilibrium import find_root

        frictionless = self.without(layout.FRICTION, layout.CAGE)
        guess = np.zeros((self.ball_count, self.ball_columns))
        if self.scalars[layout.GYROSCOPIC] != 0.0:
            q_now, guess, more = frictionless._by_parts(find_root, q_now, None, tolerance, None, (1, 4, 16, 64))
            total += more
        guess = frictionless.evaluate(q_now, ball=guess).ball
        guess[:, 2:4] = self.stress_free_slip(q_now, guess)
        return q_now, guess, total

    def _by_parts(
        self,
        solver: Kernel,
        q: np.ndarray,
        ball: np.ndarray | None,
        tolerance: float,
        load: np.ndarray | None,
        parts: tuple[int, ...],
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Solve at once, or with a growing part of the load (load given) or of the gyroscopic moment (load None)."""
        total = 0
        report = np.zeros(2)
        status = CONVERGED
        for count in parts:
            q_now = np.array(q, dtype=float)
            ball_now = np.zeros((self.ball_count, self.ball_columns)) if ball is None else np.array(ball, dtype=float)
            for part in range(1, count + 1):
                scalars, linear = self.scalars.copy(), self.linear
                if load is None:
                    scalars[layout.GYROSCOPIC] *= part / count
                else:
                    linear = linear._replace(load=load * (part / count))
                forces = self.compiled_forces._replace(constants=Constants(scalars, self.table))
                response = Response(np.empty(5), np.empty((5, 5)), np.empty((5, 5)), self._work())
                status = solver(
                    forces, linear, tolerance, 0.0, StaticState(q_now, ball_now, self.law_state), response, report
                )
                total += int(report[ITERATIONS]) + 1
                if status != CONVERGED:
                    break
            if status == CONVERGED:
                return q_now, ball_now, total
            if status == RUN_AWAY:
                free = COORDINATES[int(np.argmax(np.abs(q_now) * [1.0, 1.0, 1.0, self.arm, self.arm]))]
                why = f"no static equilibrium: no stiffness against the load along {free}. Hold it or load more balls."
                raise ConvergenceError(why, {"q": np.array(q, dtype=float), "ball": ball_now})
        cause = "the balls have no equilibrium between the races" if status == BALLS_FAILED else "the iteration stalls"
        remainder = f"relative residual {report[RESIDUAL]:.1e}"
        if not np.isfinite(report[RESIDUAL]):
            remainder = "the forces exceed the range of floating-point arithmetic: check the units of loads and materials"
        why = f"no static equilibrium found after {total} iterations: {cause}, {remainder}"
        raise ConvergenceError(why, {"q": q_now, "ball": ball_now})


@attrs.define(eq=False, kw_only=True)
class SteppedRing(Ring):
    """A ring whose contact forces are not compiled; ``rigid`` is it with rigid bodies and Hertz's contacts."""

    rigid: System

    @property
    def surrogate(self) -> System:
        """The rigid ring under this one's loads."""
        return attrs.evolve(self.rigid, **{f.name: getattr(self, f.name) for f in attrs.fields(Ring)})


def compiled(ring: Ring) -> System | None:
    """The ring for compiled loops; None where it is stepped from Python."""
    return ring if isinstance(ring, System) else None


def surrogate(ring: Ring) -> System:
    """A compiled ring near this one; itself where it is one."""
    if isinstance(ring, System):
        return ring
    assert isinstance(ring, SteppedRing), "rings are compiled or stepped"
    return ring.surrogate
