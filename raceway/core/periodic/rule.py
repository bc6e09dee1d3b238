"""Collocation at Gauss points with a polynomial acceleration on each interval.

Notes
-----
On an interval of length h the acceleration is the polynomial through its values A_j at the Gauss points c_j;
v(u) = v0 + h sum_j a_j(u) A_j,  q(u) = q0 + u h v0 + h^2 sum_j aa_j(u) A_j  with a_j, aa_j the first and second integral of
the Lagrange polynomial l_j, u from 0 to 1.  For s points the error at the ends of intervals is of order 2 s where the
motion is smooth, between them of order s + 2.

References
----------
de Boor, Swartz, SIAM J. Numer. Anal. 10 (1973), 582-606: collocation at Gaussian points.
"""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np

#: Gauss points of an interval.
STAGES = 4
#: Places at which the motion's polynomial is tried against the balance of forces, besides the Gauss points.
_TRIED = (0.0, 0.19, 0.5, 0.81, 1.0)


@attrs.frozen(eq=False)
class Rule:
    """Numbers of the rule with s stages.

    Attributes
    ----------
    points : (s,) in (0, 1)
    velocity, position : (s, s) first and second integrals of the Lagrange polynomials up to each point
    end : (2, s) the same up to the end of the interval
    packed : (2 s + 3, s) velocity, position, end and points one below the other, for kernels
    tried : (e,) further points, tried_values : (e, s) values there from those at the points;  try_packed : (2 e + 3, s + e) integrals up to them (columns 0 to s - 1), then weights of
        all s + e points for the velocity and the position at the end, then the points themselves in columns 0 to e - 1
    legendre : (s, s) Legendre coefficients of values at the points
    """

    points: np.ndarray
    velocity: np.ndarray
    position: np.ndarray
    end: np.ndarray
    packed: np.ndarray
    tried: np.ndarray
    tried_values: np.ndarray
    try_packed: np.ndarray
    legendre: np.ndarray


def integrals(points: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lagrange polynomials of points (s,) in [0, 1] at places (n,): values, first and second integrals from 0, (n, s) each."""
    s = len(points)
    powers = np.linalg.inv(np.vander(points, s, increasing=True))  # s <= 9 points: 1e-10 of rounding at worst
    k = np.arange(s)
    monomials = at[:, None] ** k
    once = monomials * at[:, None] / (k + 1)
    return monomials @ powers, once @ powers, (once * at[:, None] / (k + 2)) @ powers


@cache
def rule(stages: int = STAGES) -> Rule:
    """The rule with a number of Gauss points an interval."""
    x, _ = np.polynomial.legendre.leggauss(stages)
    points = 0.5 * (x + 1.0)
    _, velocity, position = integrals(points, points)
    _, v_end, q_end = integrals(points, np.ones(1))
    end = np.vstack([v_end, q_end])
    tried = np.array(_TRIED)
    values, v_tried, q_tried = integrals(points, tried)
    both = np.concatenate([points, tried])
    _, v_all, q_all = integrals(both, np.ones(1))
    e = len(tried)
    packed = np.zeros((2 * e + 3, stages + e))
    packed[:e, :stages], packed[e : 2 * e, :stages] = v_tried, q_tried
    packed[2 * e], packed[2 * e + 1], packed[2 * e + 2, :e] = v_all[0], q_all[0], tried
    legendre = np.linalg.inv(np.polynomial.legendre.legvander(x, stages - 1))
    return Rule(
        points, velocity, position, end, np.ascontiguousarray(np.vstack([velocity, position, end, points])), tried,
        values, packed, legendre,
    )  # fmt: skip
