"""What becomes of a small disturbance of a motion over its span, from samples of the derivatives along it.

A disturbance v of a motion obeys M w^2 v'' + A1 v' + A0 v = 0 over the force's angle, A0 and A1 trigonometric polynomials through
their samples: y' = B y with y = (v, v').  Magnus's expansion of fourth order takes y over a step, its exponential by the diagonal
Pade approximant of fourth order: both are symplectic where B is Hamiltonian, so that multipliers of motions without damping
stay on the unit circle.

Blanes, Casas, Oteo, Ros, The Magnus expansion and some of its applications, Physics Reports 470 (2009), equation 253.
"""

import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.elimination import eliminate
from raceway.core.signatures import CUBE, MATRIX, VECTOR

#: Phase of the fastest vibration in a step where the stiffness hardly changes, and steps between two samples at least.
_PHASE, _LEAST = 1.0, 2
_GAUSS = 0.5 * 3.0**-0.5


@jit(void(CUBE, CUBE, VECTOR, int64[::1], float64, CUBE))
def _slope(A0, A1, mass, dofs, position, S):
    """S (2, d, d) at a position in samples: v'' = S_0 v + S_1 v'; ``mass`` (5,) times w^2."""
    n, d = A0.shape[0], dofs.size
    S[:] = 0.0
    for m in range(n):
        angle = 2.0 * np.pi * (position - m) / n
        weight = np.sin(0.5 * n * angle) / (n * np.tan(0.5 * angle))  # between samples: never at one
        for a in range(d):
            share = weight / mass[dofs[a]]
            for b in range(d):
                S[0, a, b] -= share * A0[m, dofs[a], dofs[b]]
                S[1, a, b] -= share * A1[m, dofs[a], dofs[b]]


@jit(void(CUBE, CUBE, float64, MATRIX))
def _exponent(first, second, h, omega):
    """omega (2 d, 2 d) of a step h from S at both its Gauss points: h (B_1 + B_2) / 2 + h^2 sqrt(3) / 12 [B_2, B_1]."""
    d, turn = first.shape[1], 0.5 * h * h * _GAUSS
    for a in range(d):
        for b in range(d):
            cross, lower = 0.0, 0.0
            for k in range(d):
                cross += second[1, a, k] * first[0, k, b] - first[1, a, k] * second[0, k, b]
                lower += second[1, a, k] * first[1, k, b] - first[1, a, k] * second[1, k, b]
            change = first[0, a, b] - second[0, a, b]
            omega[a, b] = turn * change
            omega[a, d + b] = turn * (first[1, a, b] - second[1, a, b]) + (h if a == b else 0.0)
            omega[d + a, b] = 0.5 * h * (first[0, a, b] + second[0, a, b]) + turn * cross
            omega[d + a, d + b] = 0.5 * h * (first[1, a, b] + second[1, a, b]) + turn * (lower - change)


@jit(int64(CUBE, VECTOR, int64[::1], float64))
def _transfer_parts(A0, mass, dofs, distance):
    """Steps between two samples a distance [rad] apart: by the fastest vibration, and by how much A0 changes."""
    n, fastest, change = A0.shape[0], 0.0, 0.0
    for i in dofs:
        for k in dofs:
            mean, spread = 0.0, 0.0
            for j in range(n):
                mean += A0[j, i, k] / n
            for j in range(n):
                spread = max(spread, abs(A0[j, i, k] - mean))
            fastest += mean * mean / (mass[i] * mass[k])
            change += spread * spread / (mass[i] * mass[k])
    phase = _PHASE * min(1.0, 0.4 * (fastest / max(change, 1e-300)) ** 0.125)
    return max(_LEAST, int(np.ceil(distance * fastest**0.25 / phase)))


@jit(void(MATRIX, MATRIX, float64, MATRIX))
def _add_product(a, b, factor, out):
    """out += factor a b."""
    n = a.shape[0]
    for i in range(n):
        for k in range(n):
            value = factor * a[i, k]
            if value != 0.0:
                for j in range(n):
                    out[i, j] += value * b[k, j]


@jit(boolean(CUBE, CUBE, VECTOR, int64[::1], float64, MATRIX), allocates=True)
def span_transfer(A0, A1, mass, dofs, span, out):
    """out (2 d, 2 d): a disturbance (v, v') of the unknowns after a span [rad], by samples A0, A1 (n, 5, 5); ``mass`` (5,) times w^2.

    False where a step has no inverse.
    """
    n, d = A0.shape[0], dofs.size
    parts = _transfer_parts(A0, mass, dofs, span / n)
    h = span / (n * parts)
    first, second, omega = np.empty((2, d, d)), np.empty((2, d, d)), np.empty((2 * d, 2 * d))
    square, even, odd = np.empty((2 * d, 2 * d)), np.empty((2 * d, 2 * d)), np.empty((2 * d, 2 * d))
    pair = np.empty((2 * d, 4 * d))
    for a in range(2 * d):
        for b in range(2 * d):
            out[a, b] = 1.0 if a == b else 0.0
    for step in range(n * parts):
        middle = (step + 0.5) / parts
        _slope(A0, A1, mass, dofs, middle - _GAUSS / parts, first)
        _slope(A0, A1, mass, dofs, middle + _GAUSS / parts, second)
        _exponent(first, second, h, omega)
        square[:] = 0.0
        _add_product(omega, omega, 1.0, square)
        for a in range(2 * d):
            for b in range(2 * d):
                even[a, b] = 3.0 / 28.0 * square[a, b] + (1.0 if a == b else 0.0)
                odd[a, b] = 0.5 * omega[a, b]
        _add_product(square, square, 1.0 / 1680.0, even)
        _add_product(omega, square, 1.0 / 84.0, odd)
        for a in range(2 * d):
            for b in range(2 * d):
                pair[a, b], pair[a, 2 * d + b] = even[a, b] - odd[a, b], 0.0
                square[a, b] = even[a, b] + odd[a, b]
        for a in range(2 * d):
            for k in range(2 * d):
                for b in range(2 * d):
                    pair[a, 2 * d + b] += square[a, k] * out[k, b]
        if not eliminate(pair):
            return False
        for a in range(2 * d):
            for b in range(2 * d):
                out[a, b] = pair[a, 2 * d + b]
    return True
