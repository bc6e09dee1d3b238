"""After what angle the motion repeats itself, turned: one turn, or one ball pitch.

Notes
-----
A force that turns with w over equal, equally spaced balls meets the same bearing again after it has passed one pitch:
q(theta + Theta) = P q(theta), P the rotation by the angle that the force has turned meanwhile, ball k then standing where
ball ``order[k]`` stood.  With balls at rest Theta = 2 pi / Z; balls that travel with w_c are passed more slowly,
Theta = (2 pi / Z) / |1 - w_c / w|, and a turn of the force is then no period at all.  Whether forces and bodies are
equivariant is tried on the system itself, so that nothing has to be known about laws and bodies.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.bodies.ring import CAGE, COSINE, LEVER, SIDE, SINE
from raceway.core.periodic.sweep import forces
from raceway.core.system import System

#: Largest difference that counts as rounding, over the largest force: ball solves end near 1e-12.
_SAME = 1e-9


@attrs.frozen(eq=False)
class Symmetry:
    """The motion repeats itself after ``span`` [rad of the force's angle], rotated.

    Attributes
    ----------
    rotation : (5, 5) P;  angle : by which P rotates about x [rad]
    order : (Z,) the ball that stood where each ball stands one span later
    pitch : whether the span is one ball pitch
    """

    span: float
    rotation: np.ndarray
    angle: float
    order: np.ndarray
    pitch: bool


def rotation(angle: float) -> np.ndarray:
    """(5, 5) x, y, z, tilt_y, tilt_z turned by an angle about x."""
    c, s = np.cos(angle), np.sin(angle)
    out = np.eye(5)
    out[1:3, 1:3] = out[3:5, 3:5] = [[c, -s], [s, c]]
    return out


def one_turn(system: System) -> Symmetry:
    """No symmetry: the motion repeats itself after a turn."""
    return Symmetry(2.0 * np.pi, np.eye(5), 0.0, np.arange(system.ball_count), False)


def one_pitch(system: System, speed: float, q: np.ndarray) -> Symmetry | None:
    """The symmetry of one ball pitch, or None where forces or bodies do not have it.

    Parameters
    ----------
    speed : of the force [rad/s];  q : (5,) a state off the axis on which the bodies are tried
    """
    table = system.table
    direction = np.arctan2(table[:, SINE], table[:, COSINE])
    rows = [np.flatnonzero(np.isclose(table[:, SIDE], s) & np.isclose(table[:, LEVER], x)) for s, x in _rows(table)]
    count = len(rows[0])
    if count < 2 or any(len(row) != count for row in rows):
        return None
    cage = system.scalars[CAGE] / speed
    for sense in (1.0, -1.0):
        if sense == cage:
            continue
        span = 2.0 * np.pi / count / abs(sense - cage)
        order = _order(direction, rows, -np.sign(sense - cage) * 2.0 * np.pi / count)
        if order is None:
            return None
        found = Symmetry(span, rotation(sense * span), sense * span, order, True)
        if _equivariant(system, found, speed, q):
            return found
    return None


def _rows(table: np.ndarray) -> list[tuple[float, float]]:
    return list(dict.fromkeys((float(row[SIDE]), float(row[LEVER])) for row in table))


def _order(direction: np.ndarray, rows: list[np.ndarray], by: float) -> np.ndarray | None:
    """For every ball the one of its row that stands at an angle ``by`` from it; None where there is none."""
    order = np.empty(len(direction), dtype=int)
    for row in rows:
        off = direction[row][:, None] + by - direction[row][None, :]
        off = np.abs((off + np.pi) % (2.0 * np.pi) - np.pi)
        nearest = off.argmin(axis=1)
        if off.min(axis=1).max() > 1e-9:
            return None
        order[row] = row[nearest]
    return order


def _equivariant(system: System, found: Symmetry, speed: float, q: np.ndarray) -> bool:
    turn = found.rotation
    for matrix in (system.mass, system.damping, system.stiffness, np.diag(system.free)):
        if np.abs(turn @ matrix - matrix @ turn).max() > 1e-12 * np.abs(matrix).max():
            return False
    load = system.load * system.free
    times = np.array([0.0, 0.37, 1.9]) / speed
    push = np.empty((6, 5))
    forces(system.force, system.force_params, np.concatenate([times, times + found.span / speed]), push)
    push *= system.free
    size = max(np.abs(push).max(), np.abs(load).max())
    if np.abs(push[3:] - push[:3] @ turn.T).max() > _SAME * size or np.abs(turn @ load - load).max() > _SAME * size:
        return False
    v = speed * (q[::-1] * 0.1)
    one = system.evaluate(q, v)
    two = system.evaluate(turn @ q, turn @ v, t=found.span / speed)
    largest = max(float(np.abs(one.contact_force).max()), 1e-300)
    same_balls = np.abs(two.ball - one.ball[found.order]).max() <= _SAME * np.abs(one.ball).max()
    return same_balls and bool(np.abs((two.force - turn @ one.force) * system.free).max() <= _SAME * largest)
