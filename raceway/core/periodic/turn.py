"""The mesh of a turn: the rule of Gauss collocation, and the symmetry of equal balls about the axis."""

from functools import cache

import attrs
import numpy as np

from raceway.core.periodic.intervals import forces
from raceway.core.ring.kernels.layout import CAGE, COSINE, LEVER, REST_RADIAL, SIDE, SINE
from raceway.core.ring.orbit import States, responses
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError

#: Gauss points of an interval.
STAGES = 4
#: Places at which the motion's polynomial is tried against the balance of forces, besides the Gauss points.
_TRIED = (0.0, 0.19, 0.5, 0.81, 1.0)


@attrs.frozen(eq=False)
class GaussRule:
    """Numbers of the rule with s stages.

    points : (s,) in (0, 1)
    velocity, position : (s, s) first and second integrals of the Lagrange polynomials up to each point
    packed : (2 s + 3, s) velocity, position, the same up to the end of the interval and points one below the other, for kernels
    tried : (e,) further points;  tried_values, tried_velocity, tried_position : (e, s) values there, and integrals up to them
    gain : (2, s + e) what the position and the velocity at the end take more of the values at all points than of those at the Gauss points
    legendre : (s, s) Legendre coefficients of values at the points

    On an interval of length h the acceleration is the polynomial through its values A_j at the Gauss points c_j; v(u) = v0 +
    h sum_j a_j(u) A_j, q(u) = q0 + u h v0 + h^2 sum_j aa_j(u) A_j with a_j, aa_j the first and second integral of the
    Lagrange polynomial l_j, u from 0 to 1. For s points the error at the ends of intervals is of order 2 s where the motion
    is smooth, between them of order s + 2.

    Source: de Boor, Swartz, SIAM J. Numer. Anal. 10 (1973), 582-606: collocation at Gaussian points.
    """

    points: np.ndarray
    velocity: np.ndarray
    position: np.ndarray
    packed: np.ndarray
    tried: np.ndarray
    tried_values: np.ndarray
    tried_velocity: np.ndarray
    tried_position: np.ndarray
    gain: np.ndarray
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
def gauss_rule(stages: int = STAGES) -> GaussRule:
    """The rule with a number of Gauss points an interval."""
    x, _ = np.polynomial.legendre.leggauss(stages)
    points = 0.5 * (x + 1.0)
    _, velocity, position = integrals(points, points)
    _, v_end, q_end = integrals(points, np.ones(1))
    trial_points = np.array(_TRIED)
    _, v_all, q_all = integrals(np.concatenate([points, trial_points]), np.ones(1))
    gain = np.vstack([q_all, v_all])
    gain[:, :stages] -= np.vstack([q_end, v_end])
    legendre = np.linalg.inv(np.polynomial.legendre.legvander(x, stages - 1))
    both = np.ascontiguousarray(np.vstack([velocity, position, v_end, q_end, points]))
    return GaussRule(points, velocity, position, both, trial_points, *integrals(points, trial_points), gain, legendre)


#: Largest difference that counts as rounding, over the largest force: ball solves end near 1e-12.
_SAME = 1e-9


@attrs.frozen(eq=False)
class Symmetry:
    """The motion repeats itself after ``span`` [rad of the force's angle], rotated.

    rotation : (5, 5) P;  angle : by which P rotates about x [rad]
    order : (Z,) the ball that stood where each ball stands one span later
    pitch : whether the span is one ball pitch
    """

    span: float
    rotation: np.ndarray
    angle: float
    order: np.ndarray
    pitch: bool


def rotations(angles: np.ndarray) -> np.ndarray:
    """(n, 5, 5) x, y, z, tilt_y, tilt_z turned by angles (n,) about x."""
    c, s = np.cos(angles), np.sin(angles)
    out = np.zeros((len(c), 5, 5))
    out[:, 0, 0] = 1.0
    out[:, 1, 1] = out[:, 2, 2] = out[:, 3, 3] = out[:, 4, 4] = c
    out[:, 2, 1] = out[:, 4, 3] = s
    out[:, 1, 2] = out[:, 3, 4] = -s
    return out


def one_turn(system: System) -> Symmetry:
    """No symmetry: the motion repeats itself after a turn."""
    return Symmetry(2.0 * np.pi, np.eye(5), 0.0, np.arange(system.ball_count), False)


def one_pitch(system: System, speed: float, q: np.ndarray) -> Symmetry | None:
    """The symmetry of one ball pitch, or None where forces or bodies do not have it.

    speed : of the force [rad/s];  q : (5,) equilibrium; bodies are tried some way off it

    A force that turns with w over equal, equally spaced balls meets the same bearing again after it has passed one pitch:
    q(theta + Theta) = P q(theta), P the rotation by the angle that the force has turned meanwhile, ball k then standing
    where ball ``order[k]`` stood. With balls at rest Theta = 2 pi / Z; balls that travel with w_c are passed more slowly,
    Theta = (2 pi / Z) / |1 - w_c / w|, and a turn of the force is then no period at all. Whether forces and bodies are
    equivariant is tried on the system itself, so that nothing has to be known about laws and bodies.
    """
    table = system.table
    rows: dict[tuple[float, float], list[int]] = {}
    for k, row in enumerate(table[:, [SIDE, LEVER]].tolist()):
        rows.setdefault((row[0], row[1]), []).append(k)
    counts = {len(row) for row in rows.values()}
    count = counts.pop()
    # A load across the axis is no part of it whatever the balls are.
    if counts or count < 2 or np.any(system.load[1:] * system.free[1:]):
        return None
    direction = np.arctan2(table[:, SINE], table[:, COSINE])
    cage = system.scalars[CAGE] / speed
    for sense in (1.0, -1.0):
        if sense == cage:
            continue
        span = 2.0 * np.pi / count / abs(sense - cage)
        symmetry = Symmetry(span, rotations(np.array([sense * span]))[0], sense * span, np.arange(len(table)), True)
        # Whether the force one span later is the force now, turned.
        times = np.array([0.0, 0.37, 1.9]) / speed
        push = np.empty((6, 5))
        forces(system.force, system.force_params, np.concatenate([times, times + symmetry.span / speed]), push)
        push *= system.free
        if not bool(np.abs(push[3:] - push[:3] @ symmetry.rotation.T).max() <= _SAME * np.abs(push).max()):
            continue
        order = _order(direction, list(rows.values()), -np.sign(sense - cage) * 2.0 * np.pi / count)
        if order is None:
            return None
        symmetry = attrs.evolve(symmetry, order=order)
        return symmetry if _bodies_turn(system, symmetry, speed, q) else None
    return None


def _order(direction: np.ndarray, rows: list[list[int]], by: float) -> np.ndarray | None:
    """For every ball the one of its row that stands at an angle ``by`` from it; None where there is none."""
    order = np.empty(len(direction), dtype=int)
    for row in rows:
        off = direction[row][:, None] + by - direction[row][None, :]
        off = np.abs((off + np.pi) % (2.0 * np.pi) - np.pi)
        if off.min(axis=1).max() > 1e-9:
            return None
        order[row] = np.array(row)[off.argmin(axis=1)]
    return order


def _bodies_turn(system: System, symmetry: Symmetry, speed: float, q: np.ndarray) -> bool:
    """Whether mass, damping, shaft and contacts answer a turned motion with turned forces."""
    turn, free = symmetry.rotation, system.free
    linear = np.array([system.mass, system.damping, system.stiffness, np.diag(free)])
    apart = np.abs(turn @ linear - linear @ turn).max(axis=(1, 2))
    if (apart > 1e-12 * np.abs(linear).max(axis=(1, 2))).any():
        return False
    # Some way off the axis, in no special direction: a tenth of what the axial load presses the rings together.
    size = 0.1 * max(abs(q[0]), 1e-3 * abs(system.scalars[REST_RADIAL]), 1e-9)
    off = np.array([0.2, 1.0, 0.6, -0.4 / system.arm, 0.7 / system.arm]) * size * free
    state = q + off
    v = 0.3 * speed * off[[0, 2, 1, 4, 3]]
    z = system.ball_count
    ball = np.zeros((2, z, system.ball_columns))
    times = np.array([0.0, symmetry.span / speed])
    states = States(times, np.array([state, turn @ state]), np.array([v, turn @ v]), ball, np.zeros_like(ball))
    try:
        _, _, _, gap, load = responses(system, states)
    except ConvergenceError:
        return False
    # Forces, gaps and places of all balls are what the ring's force is made of.
    both = np.concatenate([symmetry.order, symmetry.order + z])
    pairs = ((ball[0], ball[1], symmetry.order), (gap[0], gap[1], both), (load[0], load[1], both))
    return all(np.abs(second - first[order]).max() <= _SAME * np.abs(first).max() for first, second, order in pairs)
