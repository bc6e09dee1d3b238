"""Steady motions by harmonic balance, alternating between frequency and time: nothing of Raceway's solver is in it.

q(theta) is a Fourier series with H harmonics.  The balance of forces w^2 M q'' + w C q' + f(q) = F(theta) is taken at N > 2 H times
and projected back on the series (Cameron, Griffin, J. Appl. Mech. 56 (1989) 149); Newton's iteration with the tangents at these times.
"""

from collections.abc import Callable

import numpy as np

#: q (n,) -> force (n,) and tangent (n, n).
Inner = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


def series(harmonics: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1, cos theta, sin theta, ... at angles (N,) and their first and second derivatives, (N, 1 + 2 H) each."""
    out = np.zeros((3, len(angles), 1 + 2 * harmonics))
    out[0, :, 0] = 1.0
    for h in range(1, harmonics + 1):
        c, s = np.cos(h * angles), np.sin(h * angles)
        out[0, :, 2 * h - 1], out[0, :, 2 * h] = c, s
        out[1, :, 2 * h - 1], out[1, :, 2 * h] = -h * s, h * c
        out[2, :, 2 * h - 1], out[2, :, 2 * h] = -h * h * c, -h * h * s
    return out[0], out[1], out[2]


def harmonic_balance(
    inner: Inner, mass: np.ndarray, damping: np.ndarray, force: np.ndarray, speed: float, first: np.ndarray, harmonics: int,
    size: float,
) -> np.ndarray:  # fmt: skip
    """Displacements (N, n) of the steady motion at N equidistant angles.

    mass, damping : (n, n);  force : (N, n) load and excitation at the angles;  speed : w [rad/s]
    first : (N, n) first guess;  size : of the motion, of which the last correction is 1e-11
    """
    count, n = first.shape
    at, once, twice = series(harmonics, 2.0 * np.pi * np.arange(count) / count)
    back = np.linalg.pinv(at)
    found = back @ first
    for _ in range(60):
        q, v, a = at @ found, speed * once @ found, speed**2 * twice @ found
        rest, terms = a @ mass.T + v @ damping.T - force, at.shape[1]
        slope = np.zeros((terms, n, terms, n))
        for i in range(count):
            f, tangent = inner(q[i])
            rest[i] += f
            here = speed**2 * np.multiply.outer(twice[i], mass) + speed * np.multiply.outer(once[i], damping)
            here += np.multiply.outer(at[i], tangent)
            slope += np.einsum("k,lij->kilj", back[:, i], here)
        step = np.linalg.solve(slope.reshape(terms * n, -1), (back @ rest).ravel()).reshape(terms, n)
        found = found - step
        if np.abs(at @ step).max() <= 1e-11 * size:
            return np.asarray(at @ found)
    raise RuntimeError("harmonic balance does not converge")
