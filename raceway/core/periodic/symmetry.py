"""Symmetry of the periodic motion: the angle after which it repeats itself, one turn or one ball pitch.

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

from raceway.core.periodic.sweep import contacts, forces
from raceway.core.ring.kernels.layout import CAGE, COSINE, LEVER, REST_RADIAL, SIDE, SINE
from raceway.core.ring.orbit import States
from raceway.core.ring.system import System

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

    Parameters
    ----------
    speed : of the force [rad/s];  q : (5,) equilibrium; bodies are tried some way off it
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
        found = Symmetry(span, rotations(np.array([sense * span]))[0], sense * span, np.arange(len(table)), True)
        if not _forces_turn(system, found, speed):
            continue
        order = _order(direction, list(rows.values()), -np.sign(sense - cage) * 2.0 * np.pi / count)
        if order is None:
            return None
        found = attrs.evolve(found, order=order)
        return found if _bodies_turn(system, found, speed, q) else None
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


def _forces_turn(system: System, found: Symmetry, speed: float) -> bool:
    """Whether the force one span later is the force now, turned."""
    times = np.array([0.0, 0.37, 1.9]) / speed
    push = np.empty((6, 5))
    forces(system.force, system.force_params, np.concatenate([times, times + found.span / speed]), push)
    push *= system.free
    return bool(np.abs(push[3:] - push[:3] @ found.rotation.T).max() <= _SAME * np.abs(push).max())


def _bodies_turn(system: System, found: Symmetry, speed: float, q: np.ndarray) -> bool:
    """Whether mass, damping, shaft and contacts answer a turned motion with turned forces."""
    turn, free = found.rotation, system.free
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
    ball, gap, load = np.zeros((2, z, system.ball_columns)), np.empty((2, 2 * z)), np.empty((2, 2 * z))
    times = np.array([0.0, found.span / speed])
    states = States(times, np.array([state, turn @ state]), np.array([v, turn @ v]), ball, np.zeros_like(ball))
    if contacts(system.compiled_forces, system.law_state, states, gap, load) < 2:
        return False
    # Forces, gaps and places of all balls are what the ring's force is made of.
    both = np.concatenate([found.order, found.order + z])
    pairs = ((ball[0], ball[1], found.order), (gap[0], gap[1], both), (load[0], load[1], both))
    return all(np.abs(two - one[order]).max() <= _SAME * np.abs(one).max() for one, two, order in pairs)
