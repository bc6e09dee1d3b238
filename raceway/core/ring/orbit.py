"""The steady orbit under a periodic force, by Fourier collocation in time.

At N equidistant times of one period M D2 q + C D q + K q + f(q, D q) = load + force(t), with D the spectral
differentiation matrix; Newton on all N states at once.  It contains the inertia forces, so that a transient that
starts on it starts without a jump: the contacts carry F0 + m w^2 r, not F0.

Trefethen, Spectral Methods in MATLAB (2000), chapter 3; Krack, Gross, Harmonic Balance for Nonlinear Vibration Problems
(2019), chapter 2.
"""

from typing import NamedTuple

import attrs
import numpy as np
from numba import int64

from raceway.core.jit import jit
from raceway.core.record import Motion
from raceway.core.ring.kernels import CONTACT_FORCE, GAP
from raceway.core.ring.kernels.layout import work_rows
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System, compiled, surrogate
from raceway.core.signatures import CUBE, FORCES, MATRIX, VECTOR, Balls, Contacts, Response, record
from raceway.errors import ConvergenceError

#: Times of a period, and residual, of systems that are evaluated from Python: each takes a millisecond or a hundred, and
#: pressures at points make forces that are smooth to 1e-5 only.
_SAMPLES_PYTHON, _TOLERANCE_PYTHON = 17, 1e-7


class States(NamedTuple):
    """Times (n,), displacements and velocities (n, 5), places of the balls (n, Z, c) and their rates."""

    times: np.ndarray
    q: np.ndarray
    v: np.ndarray
    ball: np.ndarray
    rate: np.ndarray


STATES = record(States, VECTOR, MATRIX, MATRIX, CUBE, CUBE)


class Responses(NamedTuple):
    """Of n states: contact forces on the ring f (n, 5), their tangents K and C (n, 5, 5), or (n, 0, 0), gaps and forces of contacts (n, 2 Z)."""

    f: np.ndarray
    K: np.ndarray
    C: np.ndarray
    gap: np.ndarray
    force: np.ndarray


RESPONSES = record(Responses, MATRIX, CUBE, CUBE, MATRIX, MATRIX)


@jit(int64(FORCES, MATRIX, STATES, RESPONSES), allocates=True)
def _respond(forces, memory, states, responses):
    """The responses at n states; the index of the first that fails, or n."""
    constants, (f, K, C, gap, force) = forces.constants, responses
    work = np.zeros((work_rows(constants.scalars, constants.table), 2 * constants.table.shape[0]))
    contacts = Contacts(forces.law, forces.law_params, memory, memory.copy(), 0.0)
    for i in range(states.times.size):
        balls, response = Balls(states.ball[i], 0.0, states.rate[i]), Response(f[i], K[i], C[i], work)
        if forces.system(states.times[i], states.q[i], states.v[i], balls, contacts, constants, response) != 0:
            return i
        for c in range(gap.shape[1]):
            gap[i, c] = work[GAP, c]
            force[i, c] = work[CONTACT_FORCE, c]
    return states.times.size


def _room(system: Ring, n: int, tangents: bool) -> Responses:
    size = 5 if tangents else 0
    K, C = np.empty((2, n, size, size))
    return Responses(np.empty((n, 5)), K, C, *np.empty((2, n, 2 * system.ball_count)))


def responses(system: System, states: States, tangents: bool = False) -> Responses:
    """What the contacts do at many states, whose balls are a guess and become the places.

    ConvergenceError: Where the balls of one find no place.
    """
    n, out = len(states.times), _room(system, len(states.times), tangents)
    q, v = np.ascontiguousarray(states.q), np.ascontiguousarray(states.v)
    status = _respond(system.compiled_forces, system.law_state, states._replace(q=q, v=v), out)
    if status < n:
        raise ConvergenceError("the balls have no equilibrium between the races", {"q": q[status].copy()})
    return out


@attrs.frozen(eq=False)
class Orbit:
    """A periodic motion at N equidistant times.

    period : float [s];  displacement, velocity, acceleration, force : (N, 5);  ball : (N, Z, 2)
    stiffness, damping : (N, 5, 5) derivatives of the contact forces by displacement and velocity;  residual : largest imbalance over the largest force;  iterations : int
    """

    period: float
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray
    ball: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    residual: float
    iterations: int


def differentiation(count: int, period: float) -> np.ndarray:
    """Spectral first-derivative matrix (N, N) on N (odd) equidistant times of a period."""
    j = np.arange(count)
    difference = j[:, None] - j[None, :]
    with np.errstate(divide="ignore"):
        matrix = 0.5 * (-1.0) ** difference / np.sin(np.pi * difference / count)
    matrix[j, j] = 0.0
    return matrix * (2.0 * np.pi / period)


def steady_orbit(
    system: Ring, period: float, start: np.ndarray, samples: int = 65, inertial: bool = True, tolerance: float = 1e-8
) -> Orbit:
    """The periodic motion near a first guess.

    Parameters
    ----------
    start : (5,) static equilibrium; the guess is the series of equilibria under load and force, and failing that the
        static equilibrium at all times.  A guess that is far off lets Newton end on another, resonant orbit.
    samples : odd number of times per period
    inertial : False leaves out inertia and damping: a series of equilibria

    Raises
    ------
    ConvergenceError
        With the last residual.
    """
    if compiled(system) is None:
        samples = min(samples, _SAMPLES_PYTHON)
        # The nearest start is the surrogate's orbit, moved to this system's equilibrium.
        near = steady_orbit(surrogate(system), period, start, samples, inertial)
        at_rest = near.displacement - near.displacement.mean(axis=0) + start
        return orbit_near(system, period, at_rest, samples, inertial, max(tolerance, _TOLERANCE_PYTHON))
    if inertial:
        try:
            slow = steady_orbit(system, period, start, samples, inertial=False)
            return orbit_near(system, period, slow.displacement, samples, True, tolerance)
        except ConvergenceError:
            pass
    return orbit_near(system, period, np.tile(start, (samples, 1)), samples, inertial, tolerance)


def orbit_near(
    system: Ring, period: float, start: np.ndarray, samples: int, inertial: bool, tolerance: float, limit: int = 60
) -> Orbit:
    """Newton on all times at once from a guess (samples, 5), an odd number of equidistant times; ConvergenceError."""
    times = np.arange(samples) * (period / samples)
    force = np.array([system.outer_force(t) for t in times])
    first = differentiation(samples, period)
    second = first @ first
    free = np.flatnonzero(system.free > 0.0)
    n = len(free)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])[free]
    q = start.copy()
    ball = np.zeros((samples, system.ball_count, system.ball_columns))
    rate = np.zeros_like(ball)
    rate_columns = system.rated_columns
    f, K, C, _, _ = now = _room(system, samples, tangents=True)
    scale = max(np.abs(force).max(), np.abs(system.load).max(), 1e-300)
    # (N, n, N, n) tangent of the linear parts at all times.
    part, linear, diagonal = np.ix_(free, free), np.zeros((samples, n, samples, n)), np.arange(samples)
    if inertial:
        linear += np.einsum("ij,ab->iajb", second, system.mass[part])
        linear += np.einsum("ij,ab->iajb", first, system.damping[part])
    linear[diagonal, :, diagonal, :] += system.stiffness[part]
    residual, worst, iterations, damping_factor = np.inf, np.inf, 0, 1.0
    step = np.zeros_like(q)
    for iterations in range(1, limit + 1):
        v = first @ q if inertial else np.zeros_like(q)
        if inertial and iterations > 1:
            rate[:, :, rate_columns] = np.einsum("ij,jkc->ikc", first, ball[:, :, rate_columns])
        status = _evaluate(system, States(times, q, v, ball, rate), now)
        imbalance = f + q @ system.stiffness.T - system.load - force
        if inertial:
            imbalance += v @ system.damping.T + (second @ q) @ system.mass.T
        r = imbalance[:, free]
        residual = float(np.abs(r * weight).max() / scale) if status == samples and np.isfinite(r).all() else np.inf
        if residual <= tolerance and iterations > 2:
            break
        if residual > 2.0 * worst and damping_factor > 1e-3:
            damping_factor *= 0.5
            step *= 0.5
            q = q - step
            continue
        worst, damping_factor = residual, min(1.0, 2.0 * damping_factor)
        matrix = linear.copy()
        matrix[diagonal, :, diagonal, :] += K[:, free[:, None], free[None, :]]
        if inertial:
            matrix += np.einsum("iab,ij->iajb", C[:, free[:, None], free[None, :]], first)
        size = samples * n
        try:
            delta = -np.linalg.solve(matrix.reshape(size, size), r.reshape(size)).reshape(samples, n)
        except np.linalg.LinAlgError:  # nothing is in contact, or a resonance is met
            raise ConvergenceError("no periodic orbit found: its equations are singular", {"q": q}) from None
        step = np.zeros_like(q)
        step[:, free] = damping_factor * delta
        q = q + step
    else:
        remainder = f"relative residual {residual:.1e}" if np.isfinite(residual) else "forces beyond all numbers"
        raise ConvergenceError(f"no periodic orbit found after {iterations} iterations, {remainder}", {"q": q})
    return Orbit(period, q, first @ q, second @ q, force, ball, K, C, residual, iterations)


def _evaluate(system: Ring, states: States, out: Responses) -> int:
    """``_respond`` for any system; the balls of one that is evaluated from Python follow the ring, ``rate`` is not used."""
    ring, ball = compiled(system), states.ball
    if ring is not None:
        return int(_respond(ring.compiled_forces, system.law_state, states, out))
    for i, t in enumerate(states.times):
        try:
            now = system.evaluate(states.q[i], states.v[i], ball[i] if ball[i].any() else None, None, float(t))
        except ConvergenceError:
            return i
        out.f[i], out.K[i], out.C[i], ball[i] = now.force, now.stiffness, now.damping, now.ball
    return len(states.times)


def at_time(values: np.ndarray, period: float, t: float | np.ndarray) -> np.ndarray:
    """Trigonometric interpolation of samples (N, ...) of a period at a time [s], or at times (n,)."""
    lines, n = np.fft.rfft(values, axis=0) / len(values), len(values)
    lines[1 : (n + 1) // 2] *= 2.0  # but the line at half the sampling rate
    waves = np.exp(2j * np.pi / period * np.multiply.outer(t, np.arange(len(lines))))
    return np.tensordot(waves, lines, axes=(-1, 0)).real


def from_orbit(system: Ring, orbit: Orbit, dt: float) -> Motion:
    """On a steady orbit, at the first of its times, moving with it."""
    balls = orbit.ball
    if balls.shape[2] < system.ball_columns:  # of a ring without friction: there are no slips behind the places
        balls = np.insert(balls, [2, 2], 0.0, axis=2)
    before, ball = at_time(balls, orbit.period, -dt), balls[0].copy()
    if not system.conservative:
        ball[:, 2:4] = before[:, 2:4] = system.stress_free_slip(orbit.displacement[0], ball)
    now = system.evaluate(orbit.displacement[0], orbit.velocity[0], ball=ball)
    a = system.acceleration(orbit.displacement[0], orbit.velocity[0], orbit.force[0], now)
    return Motion(orbit.displacement[0], orbit.velocity[0], a, now.ball, before)


def at_rest(system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """At rest in a static equilibrium; under a ramp the excitation is still zero, else it acts at once."""
    outer = np.zeros(5) if ramped else system.outer_force(0.0)
    a = system.acceleration(q, np.zeros(5), outer, system.evaluate(q, ball=ball))
    return Motion(q, np.zeros(5), a, ball, ball.copy())


def static_orbit(system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """The equilibrium under the constant load and the excitation's force at time zero: for series of equilibria."""
    outer = np.zeros(5) if ramped else system.outer_force(0.0)
    under_load = attrs.evolve(system, load=system.load + outer)
    q, ball, _ = under_load.solve_equilibrium(q, ball)
    return Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy())
