"""A ring of five coordinates on its balls, however their forces are computed."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Self, TypeVar

import attrs
import numpy as np

from raceway.core.contact.geometry import Growth
from raceway.core.jit import Kernel
from raceway.core.record import SteppedSystem
from raceway.core.ring.kernels import layout
from raceway.core.ring.kernels.layout import place, stop
from raceway.core.signatures import Constants


@attrs.frozen(eq=False)
class Increment:
    """A step of an integrator since the law's memory was committed.

    dt : its length [s];  gain : derivative of the balls' rates by their places [1/s]
    memory : (2 Z, m); None for the ring's ``law_state``
    """

    dt: float = 0.0
    gain: float = 0.0
    memory: np.ndarray | None = None


#: No time has passed.
AT_ONCE = Increment()


@attrs.frozen(eq=False)
class Evaluation:
    """Contact forces at one state.

    force : (5,) internal force of the contacts [N, N m]
    stiffness, damping : (5, 5) its derivatives by displacement and velocity
    gap, contact_force : (2 Z,) inner races first, then outer [m, N]
    ball : (Z, 2 to 8) positions of the balls in their meridian planes, slips, structural approaches and displacements [m]
    memory : (2 Z, m) what the law would remember
    """

    force: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    ball: np.ndarray
    memory: np.ndarray


#: Relative residual that an equilibrium is solved to.
TOLERANCE = 1e-11
#: A frequency [rad/s] whose square is lost beside any other: derivatives by it are exact.
_INFINITESIMAL = 1e-30
COORDINATES = ("x", "y", "z", "tilt_y", "tilt_z")


R = TypeVar("R", bound="Ring")
#: Half the interval over which a phase is differentiated [s]: its rounding then makes 1e-9 of the speed.
_INTERVAL = 1e-5


@attrs.frozen(eq=False)
class ChangingSpeed:
    """The speed w(t) of the inner ring, and the parts of a system that belong to a reference speed w_r.

    phase : function of times (n,) [s] -> angle of the rotor (n,) [rad]
    reference : w_r that the system's constants were made for [rad/s]
    growth : of the inner raceway [m]: at w_r by speed, by its fit at standstill, and what w_r takes from that fit, down to none
    gyroscopic : (5, 5) part of the system's damping at w_r that goes with w
    shift : function of speeds (n,) [rad/s] -> shift of the first sprung row (n,) [m], with which all on the spring slide; None
        where rows stay

    Centrifugal forces, gyroscopic moments of the balls and centrifugal growth go with w^2, the cage speed and gyroscopic moments
    of the rotor with w.  A sprung row slides to where the spring's force is met at w, as in a steady run.
    """

    phase: Callable[[np.ndarray], np.ndarray]
    reference: float
    growth: tuple[float, float, float]
    gyroscopic: np.ndarray
    shift: Callable[[np.ndarray], np.ndarray] | None = None
    law: Callable[[Any, float], Any] | None = None

    def speed(self, time: np.ndarray) -> np.ndarray:
        """w (n,) [rad/s] at times (n,) [s] from zero on."""
        before, after = np.maximum(time - _INTERVAL, 0.0), time + _INTERVAL
        return np.asarray((self.phase(after) - self.phase(before)) / (after - before))

    def grown(self, speed: np.ndarray) -> np.ndarray:
        """Growth of the inner raceway (n,) [m] at speeds (n,) [rad/s] beyond that at w_r."""
        (free, fit, loss), square = self.growth, (speed / self.reference) ** 2
        return np.asarray(free * (square - 1.0) + np.maximum(fit - loss * square, 0.0) - max(fit - loss, 0.0))

    def cage_angle(self, cage: float, time: np.ndarray) -> np.ndarray:
        """(n,) [rad] by which balls have travelled since time zero; ``cage``: their speed at w_r [rad/s]."""
        return np.asarray(cage / self.reference * (self.phase(time) - self.phase(np.zeros(1))))

    def at(self, system: R, t: float) -> R:
        """The system with the constants of one moment; its kernels take a steady speed, so the azimuths at time zero are those
        from which balls at the speed of now would have come to their places of now."""
        now = np.array([t])
        speed = float(self.speed(now)[0])
        ring = self.constants(system, speed)
        if system.scalars[layout.CAGE] != 0.0:
            ahead = float(self.cage_angle(system.scalars[layout.CAGE], now)[0]) - ring.scalars[layout.CAGE] * t
            c, s = np.cos(ahead), np.sin(ahead)
            ring.table[:, layout.COSINE] = system.table[:, layout.COSINE] * c - system.table[:, layout.SINE] * s
            ring.table[:, layout.SINE] = system.table[:, layout.SINE] * c + system.table[:, layout.COSINE] * s
        return ring

    def constants(self, system: R, speed: float) -> R:
        """The system at a steady speed [rad/s]."""
        ratio = speed / self.reference
        if self.law is not None:
            system = self.law(system, speed)
        scalars, table = system.scalars.copy(), system.table.copy()
        scalars[layout.REST_RADIAL] += float(self.grown(np.array([speed]))[0])
        scalars[layout.GYROSCOPIC] *= ratio**2
        scalars[layout.CAGE] *= ratio
        table[:, layout.CENTRIFUGAL] *= ratio**2
        if self.shift is not None:
            second = table[:, layout.SIDE] != table[0, layout.SIDE]
            apart = table[second, layout.SHIFT] - table[second, layout.SHIFT][0]
            table[second, layout.SHIFT] = self.shift(np.array([speed]))[0] + apart
        damping = system.damping + (ratio - 1.0) * self.gyroscopic
        return attrs.evolve(system, scalars=scalars, table=table, damping=damping, spin=None)


@attrs.define(eq=False, kw_only=True)
class Ring(ABC):
    """M q'' + C q' + K q + f(q, q') = load + force(t) for the ring's reference point.

    scalars, table : constants of geometry and balls, see ``raceway.core.ring.kernels``
    mass, damping, stiffness : (5, 5) linear parts
    free : (5,) 1 for unknowns, 0 for coordinates that are held
    load : (5,) constant load [N, N m]
    force : compiled ``FORCE``, the excitation;  force_params : (k,)
    law_state : (2 Z, m) committed memory of the contacts
    spin : how the speed changes that constants belong to; None for a steady one
    sliding : (n,) indices of the balls whose rows slide together along x against a constant force; None where no row does
    """

    scalars: np.ndarray
    table: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    free: np.ndarray
    load: np.ndarray
    force: Kernel
    force_params: np.ndarray
    law_state: np.ndarray
    spin: ChangingSpeed | None = None
    sliding: np.ndarray | None = None

    @property
    @abstractmethod
    def conservative(self) -> bool:
        """Whether the ball forces have a potential: neither friction nor gyroscopic moments."""

    @property
    @abstractmethod
    def ball_columns(self) -> int:
        """Columns of ``ball`` (Z, k): places, slips, what elasticity adds."""

    @abstractmethod
    def evaluate(
        self,
        q: np.ndarray,
        v: np.ndarray | None = None,
        ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None,
        t: float = 0.0,
        step: Increment = AT_ONCE,
    ) -> Evaluation:
        """Contact forces and tangents at displacement q (5,) and velocity v (5,).

        ball : (Z, ``ball_columns``) a first guess, and the slips that were committed last
        ball_rate : (Z, ``ball_columns``), the rate of a ball is step.gain * ball + ball_rate [m/s]
        step : since the law's memory was committed

        ConvergenceError: When the balls find no equilibrium between the races.
        PluginError: An array of another shape: a compiled kernel would write beyond it.
        """

    @abstractmethod
    def solve_equilibrium(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under ``load`` from a first guess q (5,): displacement, balls (Z, k), iterations.

        ConvergenceError: With the last state and its residual.
        PluginError: An array of another shape.
        """

    def stepped(self) -> SteppedSystem | None:
        """What loops in Python step, where that is not ``raceway.core.ring.stepped.SteppedBearing`` around this ring."""
        return None

    def of_balls(self, balls: np.ndarray, table: np.ndarray) -> Self:
        """A copy with some of the balls, by their indices (n,), which have the table (n, COLUMNS)."""
        return attrs.evolve(self, table=table, law_state=self.law_state[self.contacts_of(balls)].copy(), sliding=None)

    def contacts_of(self, balls: np.ndarray) -> np.ndarray:
        """Rows of the contacts of some balls: inner races first."""
        every = np.arange(self.ball_count)[balls]
        return np.concatenate([every, self.ball_count + every])

    @property
    def rated_columns(self) -> list[int]:
        """Columns of ``ball`` that have rates: positions and what elasticity adds, not slips."""
        return [0, 1]

    def groove_displacement(self, ball: np.ndarray) -> np.ndarray:
        """(..., Z, 2) motion (axial, radial) of the inner groove centres against the outer ones by elastic rings [m]."""
        return np.zeros((*ball.shape[:-1], 2))

    def at_speed(self, t: float) -> Self:
        """With the speed of a time: itself where the speed is steady."""
        return self if self.spin is None else self.spin.at(self, t)

    @property
    def ball_count(self) -> int:
        return self.table.shape[0]

    @property
    def arm(self) -> float:
        """Arm of the tilts [m]."""
        return float(self.scalars[layout.TILT_ARM])

    def outer_force(self, t: float) -> np.ndarray:
        """(5,) the excitation at a time, without ramp."""
        out = np.zeros(5)
        self.force(float(t), self.force_params, out)
        return out

    def stopped(self, t: float) -> Self:
        """A copy whose orbiting balls stand still where they are at a time."""
        scalars, table = self.scalars.copy(), self.table.copy()
        stop(float(t), scalars, table)
        return attrs.evolve(self, scalars=scalars, table=table)

    def without(self, *entries: int) -> Self:
        """A copy with some ``scalars`` (FRICTION, GYROSCOPIC, CAGE of ``raceway.core.ring.kernels.layout``) set to zero."""
        scalars = self.scalars.copy()
        scalars[list(entries)] = 0.0
        return attrs.evolve(self, scalars=scalars)

    def standing(self, growth: Growth) -> Self:
        """A copy at standstill without a growth of its grooves: the state before mounting, where that is all of it."""
        scalars, table = self.scalars.copy(), self.table.copy()
        scalars[[layout.GYROSCOPIC, layout.CAGE]] = 0.0
        scalars[layout.REST_AXIAL : layout.TILT_ARM + 1] -= growth.common
        table[:, layout.OWN_REST_AXIAL : layout.OWN_TILT_ARM + 1] -= growth.by_ball
        table[:, layout.CENTRIFUGAL] = 0.0
        return attrs.evolve(self, scalars=scalars, table=table)

    def centre_vectors(
        self, q: np.ndarray, t: np.ndarray | float = 0.0, ball: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """(Z, 2) vector (axial, radial) from the outer to the inner groove centre of every ball, and its azimuth's
        direction (Z, 2) as cosine and sine; ``ball`` (Z, k): with what elastic rings add there.  Of several states q (n, 5)
        at times t (n,) everything has a first axis n."""
        states, still = np.ascontiguousarray(q, dtype=float).reshape(-1, 5), np.zeros(5)
        times = [t] if isinstance(t, float) else np.broadcast_to(t, len(states))
        work = np.zeros((3 * len(states), 2 * self.ball_count))
        constants = Constants(self.scalars, self.table)
        for k, (time, state) in enumerate(zip(times, states, strict=True)):
            place(time, state, still, constants, work, (3 * k, 3 * k + 1, 3 * k + 2))
        parts = work.reshape(*np.shape(q)[:-1], 3, 2, -1).swapaxes(-1, -2)
        groove_shift = 0.0 if ball is None else self.groove_displacement(ball)
        return parts[..., 1, :, :] + groove_shift, parts[..., 0, :, :].copy()

    def stress_free_slip(self, q: np.ndarray, ball: np.ndarray, t: float = 0.0) -> np.ndarray:
        """(Z, 2) slips of inner and outer contacts at which no friction acts [m]."""
        e, direction = self.centre_vectors(q, t, ball)
        inner = np.arctan2(e[:, 0] - ball[:, 0], e[:, 1] - ball[:, 1])
        outer = np.arctan2(ball[:, 0], ball[:, 1])
        section_turn = self.table[:, layout.SIDE] * (q[3] * direction[:, 1] - q[4] * direction[:, 0])
        groove = self.scalars[layout.OFFSET_INNER] + 0.5 * self.scalars[layout.DIAMETER]
        return np.column_stack(
            [self.scalars[layout.OFFSET_INNER] * inner - groove * section_turn, self.scalars[layout.OFFSET_OUTER] * outer]
        )

    def at_standstill(self) -> Self:
        """Without friction and with balls that do not orbit: for periodic motions that a transient may start on."""
        return self.without(layout.FRICTION, layout.CAGE)

    def reduced(self, matrix: np.ndarray) -> np.ndarray:
        """The part of (..., 5, 5) matrices that belongs to the unknowns."""
        free = np.flatnonzero(self.free > 0.0)
        return matrix[..., free[:, None], free]

    def acceleration(self, q: np.ndarray, v: np.ndarray, outer: np.ndarray, now: Evaluation) -> np.ndarray:
        """(5,) acceleration from the balance of forces at one state."""
        free = self.free > 0.0
        net_force = self.load + outer - now.force - self.damping @ v - self.stiffness @ q
        a = np.zeros(5)
        a[free] = np.linalg.solve(self.reduced(self.mass), net_force[free])
        return a

    def natural_frequencies(self, tangent: np.ndarray) -> np.ndarray:
        """Undamped natural frequencies [rad/s], ascending, with contact tangents (..., 5, 5)."""
        return np.sqrt(np.maximum(np.linalg.eigvalsh(self._per_mass(tangent, self.stiffness)), 0.0))

    def critical_time_step(self, tangent: np.ndarray) -> float:
        """2 / (largest natural frequency) [s]: the stable limit of central differences without damping."""
        highest = float(self.natural_frequencies(tangent).max())
        return 2.0 / highest if highest > 0.0 else float("inf")

    def damped_time_step(self, tangent: np.ndarray, damping: np.ndarray) -> float:
        """Stable limit of central differences [s] with tangents and dashpots (..., 5, 5) of the contacts, the least of all.

        Contacts see the predicted velocity v0 + dt a0 (``raceway.core.time``).  At the limit a motion changes its
        sign each step, q1 = -q0, v = 0, a0 = -4 q0 / dt^2, so that dt = 2 / s with the largest root s of
        det(s^2 M - 2 s C - K) = 0; of one mode with the damping ratio z it is (2 / w) (sqrt(1 + 4 z^2) - 2 z).  Damping of the
        ground acts at the end of the step and does not enter.
        """
        limit = self.critical_time_step(tangent)
        if not damping.any():
            return limit
        k, c = self._per_mass(tangent, self.stiffness), self._per_mass(damping)
        identity = np.broadcast_to(np.eye(k.shape[-1]), k.shape)
        fastest = float(np.linalg.eigvals(np.block([[0.0 * identity, identity], [k, 2.0 * c]])).real.max())
        return min(limit, 2.0 / fastest) if fastest > 0.0 else limit

    def _per_mass(self, matrix: np.ndarray, further: np.ndarray | float = 0.0) -> np.ndarray:
        """The symmetric part of matrices (..., 5, 5), plus a further one, among the unknowns, for coordinates of unit mass."""
        root = np.linalg.inv(np.linalg.cholesky(self.reduced(self.mass)))
        return np.asarray(root @ self.reduced(0.5 * (matrix + matrix.swapaxes(-1, -2)) + further) @ root.T)

    def stiffness_at(self, q: np.ndarray, now: Evaluation) -> np.ndarray:
        """Stiffness of the contacts (5, 5) at an equilibrium that was evaluated."""
        return now.stiffness

    def damping_at(self, q: np.ndarray, now: Evaluation) -> np.ndarray:
        """Damping of the contacts (5, 5) at an equilibrium that was evaluated, of slow motions."""
        return now.damping

    def rows_following(
        self, q: np.ndarray, now: Evaluation, stiffness: np.ndarray, damping: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Stiffness and damping (5, 5) at an equilibrium with sliding rows following, from those with these rows held.

        Without friction and mass the rows' place s follows by K_ss s = -K_sq q, so that the ring meets K - K_qs K_ss^-1 K_sq, where
        K_qs, K_sq, K_ss are the first column, row and entry of the rows' own K (the spring's rate is 0).  C is the derivative by
        j w at w = 0 of K + j w C condensed alike: of slow motions.
        """
        if self.sliding is None:
            return stiffness, damping
        rows = self.of_balls(self.sliding, self.table[self.sliding].copy())
        evaluation = rows.evaluate(q, ball=now.ball[self.sliding])
        impedance = rows.stiffness_at(q, evaluation) + 1j * _INFINITESIMAL * rows.damping_at(q, evaluation)
        condensate = stiffness + 1j * _INFINITESIMAL * damping - np.outer(impedance[:, 0], impedance[0]) / impedance[0, 0]
        return condensate.real.copy(), condensate.imag / _INFINITESIMAL

    def viscous_stiffness_at(self, q: np.ndarray, ball: np.ndarray, frequency: float) -> np.ndarray:
        """What dashpots of the contacts add to their stiffness (5, 5) at an equilibrium, complex: motions exp(j w t), w [rad/s]."""
        still = self.without(layout.CAGE)
        return 1j * frequency * still.damping_at(q, still.evaluate(q, ball=ball))
