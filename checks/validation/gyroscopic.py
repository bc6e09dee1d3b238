"""A ball with centrifugal force and gyroscopic moment between its races, by Harris' equations and another root finder."""

import numpy as np
from scipy.optimize import brentq, root

from raceway.extend import resolve
from raceway.testing import Model

#: Hypothesis -> shares of the moment's tangential forces at the inner and the outer race, in units of M / D.
SHARES = {"outer_race": (0.0, 2.0), "shared": (1.0, 1.0)}


def harris_ball(
    model: Model, e: np.ndarray, hypothesis: str, start: np.ndarray
) -> tuple[float, float, float, float, float, np.ndarray]:
    """Load and angle of both races, moment and place of a ball from Harris' two balances, by MINPACK's hybrid method.

    e : (2,) from the outer race's groove centre to the inner one's, axial and radial [m]
    start : (2,) from the outer race's groove centre to the ball [m]
    Q_i sin a_i - Q_o sin a_o - M/D (l_i cos a_i - l_o cos a_o) = 0,
    Q_i cos a_i - Q_o cos a_o + M/D (l_i sin a_i - l_o sin a_o) + F_c = 0 with
    M = J w_R w_c sin(beta), tan(beta) = sin(a_o) / (cos(a_o) + D/d_m)
    (Harris & Kotzalas, Advanced Concepts of Bearing Technology, chapters 2 and 3).
    """
    g, scene = model.geometry, model.scene
    inner_share, outer_share = SHARES[hypothesis]
    d, ratio = g.ball_diameter, g.ball_diameter / g.pitch_diameter
    spin, cage = resolve(scene).spin_speed, g.cage_speed(resolve(scene).spin_speed)
    mass = g.ball_mass(scene.bearing.balls.density)
    centrifugal = 0.5 * mass * g.pitch_diameter * cage**2
    lo, li = g.offset_outer, g.offset_inner

    def state(p: np.ndarray) -> tuple[float, float, float, float, float]:
        x = e - p
        si, so = np.hypot(*x), np.hypot(*p)
        ai, ao = np.arctan2(*x), np.arctan2(*p)
        qi, qo = model.inner.factor * max(si - li, 0.0) ** 1.5, model.outer.factor * max(so - lo, 0.0) ** 1.5
        beta = np.arctan2(np.sin(ao), np.cos(ao) + ratio)
        rolling = (np.cos(ao) + np.tan(beta) * np.sin(ao)) / (1 + ratio * np.cos(ao))
        rolling += (np.cos(ai) + np.tan(beta) * np.sin(ai)) / (1 - ratio * np.cos(ai))
        own = spin / (rolling * ratio * np.cos(beta))
        return qi, qo, ai, ao, mass * d**2 / 10.0 * own * cage * np.sin(beta)

    def balance(scaled: np.ndarray) -> list[float]:
        qi, qo, ai, ao, m = state(scaled * lo)
        t = m / d
        return [
            qi * np.sin(ai) - qo * np.sin(ao) - t * (inner_share * np.cos(ai) - outer_share * np.cos(ao)),
            qi * np.cos(ai) - qo * np.cos(ao) + t * (inner_share * np.sin(ai) - outer_share * np.sin(ao)) + centrifugal,
        ]

    found = root(balance, start / lo, method="hybr", options={"xtol": 1e-13})
    assert np.abs(found.fun).max() < 1e-6
    moment = state(found.x * lo)[4]
    assert inner_share * moment / d < state(found.x * lo)[0], "outside the range where the shares are the hypothesis' own"
    return *state(found.x * lo), found.x * lo


def axial_displacement(model: Model, hypothesis: str, start: np.ndarray, between: tuple[float, float]) -> float:
    """Axial displacement [m] at which Harris' balls carry a purely axial load; it lies between the two ends.

    start : (2,) from the outer race's groove centre to a ball, a guess [m]
    """
    share = SHARES[hypothesis][0] / model.geometry.ball_diameter

    def surplus(x: float) -> float:
        qi, _, ai, _, m, _ = harris_ball(model, np.asarray(model.geometry.rest) + [x, 0.0], hypothesis, start)
        return float(model.geometry.ball_count * (qi * np.sin(ai) - share * m * np.cos(ai)) - model.scene.load.axial)

    return float(brentq(surplus, *between, xtol=1e-15))
