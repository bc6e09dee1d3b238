"""Stiffness that one motion meets: the smallest change of the tangent that carries it."""

from __future__ import annotations

import numpy as np


def secant(tangent: np.ndarray, motion: np.ndarray, load: np.ndarray, unit: np.ndarray) -> np.ndarray:
    """Real symmetric (n, n) K with K u = f, nearest to the tangent.

    Parameters
    ----------
    tangent : (n, n) [N/m, N, N m/rad]
    motion, load : (n,) complex amplitudes u, f of one harmonic
    unit : (n,) length of a unit of each coordinate [1 for m, an arm in m for rad], which makes changes comparable

    Notes
    -----
    With U = [Re u, Im u], R = [Re f, Im f] - K_t U and the pseudoinverse U+ the symmetric D of least Frobenius norm with D U = R is

        D = R U+ + (R U+)' - (U+)' U'R U+

    (the symmetric update of Powell for one vector, here for two).  It exists where U'R is symmetric: where the motion takes
    no work from the ring in a turn.  On a circle it is the same change of kyy and kzz, without cross terms; along a line it
    leaves the stiffness across as it was.

    References
    ----------
    Dennis & Schnabel, Numerical Methods for Unconstrained Optimization and Nonlinear Equations, 1983, section 9.1 and
    Schnabel, Quasi-Newton methods using multiple secant equations, 1983.
    """
    columns = np.column_stack([motion.real, motion.imag]) * unit[:, None]
    rest = np.column_stack([load.real, load.imag]) / unit[:, None] - (tangent / np.outer(unit, unit)) @ columns
    inverse = np.linalg.pinv(columns, rcond=1e-9)
    work = columns.T @ rest
    part = rest @ inverse
    change = part + part.T - inverse.T @ (0.5 * (work + work.T)) @ inverse
    return np.asarray(tangent + change * np.outer(unit, unit))
