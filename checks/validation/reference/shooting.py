"""Periodic motion of the ring by shooting: DOP853 over one period with its variational equations, Newton on the monodromy.

M q'' + C q' + f(q) = load + F(t); balls follow quasi-statically.  The 1x dynamic stiffness comes from the dense output.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from checks.validation.reference.ring import Ring

Force = Callable[[float], np.ndarray]


def rotating(amplitude: float, speed: float) -> Force:
    """Forward rotating force in the radial plane [N]; speed [rad/s]."""
    return lambda t: np.array([0.0, amplitude * np.cos(speed * t), amplitude * np.sin(speed * t), 0.0, 0.0])


def swinging(amplitude: float, speed: float) -> Force:
    """Force along +y [N]; speed [rad/s]."""
    return lambda t: np.array([0.0, amplitude * np.cos(speed * t), 0.0, 0.0, 0.0])


def trajectory(
    ring: Ring, mass: np.ndarray, load: np.ndarray, force: Force, free: np.ndarray, q0: np.ndarray, v0: np.ndarray,
    times: np.ndarray, tolerance: float = 1e-11, variational: bool = False,
):  # fmt: skip
    """States at ``times`` (n,): q, v (n, 5), and with ``variational`` the (2 f, 2 f) derivative of the last by the first.

    mass : (5, 5);  free : (5,) 1 for unknowns, the others keep q0
    """
    chosen = np.flatnonzero(free)
    n = len(chosen)
    inverse = np.linalg.inv(mass[np.ix_(chosen, chosen)])
    # Lengths in micrometres and velocities in mm/s keep the error control of all parts alike.
    unit = np.concatenate([np.full(n, 1e-6), np.full(n, 1e-3)])
    unit[:n][chosen > 2] /= ring.arm
    unit[n:][chosen > 2] /= ring.arm
    part, gyroscopic = np.ix_(chosen, chosen), ring.gyroscopic

    def rate(t: float, state: np.ndarray) -> np.ndarray:
        q = q0.copy()
        q[chosen] = state[:n] * unit[:n]
        v = np.zeros(5)
        v[chosen] = state[n : 2 * n] * unit[n:]
        inner, tangent, _ = ring(q)
        dashpot = gyroscopic + (ring.damping_matrix(q) if ring.damping else 0.0)
        rest = load + force(t) - inner - dashpot @ v
        out = np.empty_like(state)
        out[:n] = v[chosen] / unit[:n]
        out[n : 2 * n] = inverse @ rest[chosen] / unit[n:]
        if variational:
            flow = np.zeros((2 * n, 2 * n))
            flow[:n, n:] = np.diag(unit[n:] / unit[:n])
            flow[n:, :n] = -(inverse @ tangent[part]) * unit[:n] / unit[n:, None]
            flow[n:, n:] = -(inverse @ dashpot[part]) * unit[n:] / unit[n:, None]
            out[2 * n :] = (flow @ state[2 * n :].reshape(2 * n, 2 * n)).ravel()
        return out

    state = np.concatenate([q0[chosen], v0[chosen]]) / unit
    if variational:
        state = np.concatenate([state, np.eye(2 * n).ravel()])
    done = solve_ivp(
        rate, (times[0], times[-1]), state, method="DOP853", t_eval=times, rtol=tolerance, atol=tolerance, first_step=None
    )
    if not done.success:
        raise RuntimeError(done.message)
    q, v = np.tile(q0, (len(times), 1)), np.zeros((len(times), 5))
    q[:, chosen] = done.y[:n].T * unit[:n]
    v[:, chosen] = done.y[n : 2 * n].T * unit[n:]
    last = done.y[2 * n :, -1].reshape(2 * n, 2 * n) * unit[:, None] / unit if variational else None
    return q, v, last


def periodic(
    ring: Ring, mass: np.ndarray, load: np.ndarray, force: Force, free: np.ndarray, period: float, q0: np.ndarray,
    v0: np.ndarray, samples: int = 120, tolerance: float = 1e-9,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Times (n,), q (n, 5) and the Floquet multipliers of the periodic motion near q0, v0.  RuntimeError: when Newton does
    not close the orbit."""
    chosen = np.flatnonzero(free)
    n = len(chosen)
    times = np.linspace(0.0, period, samples + 1)
    q0, v0 = q0.copy(), v0.copy()
    weight = np.concatenate(
        [np.where(chosen > 2, ring.arm, 1.0), np.where(chosen > 2, ring.arm, 1.0) * period / (2 * np.pi)]
    )
    for _ in range(12):
        q, v, flow = trajectory(ring, mass, load, force, free, q0, v0, times, variational=True)
        miss = np.concatenate([(q[-1] - q[0])[chosen], (v[-1] - v[0])[chosen]])
        size = np.abs(miss * weight).max() / np.ptp(q[:, :3], axis=0).max()
        if size < tolerance:
            return times[:-1], q[:-1], np.linalg.eigvals(flow)
        step = np.linalg.solve(np.eye(2 * n) - flow, miss)
        q0[chosen] += step[:n]
        v0[chosen] += step[n:]
    raise RuntimeError(f"shooting did not close the orbit: {size:.1e}")


def dynamic_stiffness(times: np.ndarray, q: np.ndarray, force: Force, speed: float) -> complex:
    """Z [N/m] = F^H F / F^H x of the 1x phasors over one period of equidistant samples."""
    kernel = 2.0 * np.exp(-1j * speed * times)[:, None] / len(times)
    line = (kernel * q).sum(axis=0)[:3]
    push = (kernel * np.array([force(t) for t in times])).sum(axis=0)[:3]
    return complex(np.vdot(push, push) / np.vdot(push, line))
