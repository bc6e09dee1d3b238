"""The structural compliances of a bearing, and the small system that rigid rings become with them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import attrs
import numpy as np

from raceway.core.condensed.structural import RingCompliance
from raceway.core.system import System


@attrs.frozen(eq=False)
class ElasticBodies:
    """What rings and balls add to the approach of each contact beyond Hertz.

    Attributes
    ----------
    inner, outer : of the rings, at the same angles
    ball_own, ball_opposite : of a ball, by its load on the same and on the other race [m/N]
    """

    inner: RingCompliance
    outer: RingCompliance
    ball_own: float
    ball_opposite: float

    def at(self, angle: float) -> tuple[float, float]:
        """Compliances (inner, outer) of ring and ball together at a contact angle [rad], in m/N."""
        inner, outer = (float(np.interp(angle, one.angles, one.own)) for one in (self.inner, self.outer))
        return inner + self.ball_own, outer + self.ball_own

    @property
    def largest_across(self) -> float:
        """Largest compliance between two balls through a ring [m/N]."""
        return float(max(np.abs(one.across[:, 1:]).max(initial=0.0) for one in (self.inner, self.outer)))


def elastic_system(rigid: System, bodies: ElasticBodies, angles: np.ndarray | None = None) -> System:
    """The system of rigid rings with elastic ones in their place.

    Parameters
    ----------
    rigid : with kernels of rigid bodies
    angles : (Z,) contact angles [rad] for the compliances between balls; None leaves those out

    Notes
    -----
    Tables over the angle become cubic splines without slope at their ends.  The compliance between two balls is taken at the
    mean of their angles and does not change with the motion, so that forces keep a potential.
    """
    from scipy.interpolate import CubicSpline

    count = bodies.inner.across.shape[1]
    knots = bodies.inner.angles
    distance = knots[1] - knots[0]
    tables = []
    for one in (bodies.inner, bodies.outer):
        values = np.interp(knots, one.angles, one.own) + bodies.ball_own
        if not np.isfinite(values).all():
            raise FloatingPointError("a body gives way further than its contacts are deep: it is too soft for its load")
        tables += [values, distance * CubicSpline(knots, values, bc_type=((1, 0.0), (1, 0.0)))(knots, 1)]
    head = [bodies.ball_opposite, 0.0 if angles is None else 1.0, count, knots[0], distance, len(knots)]
    parts = [rigid.table.copy()]
    if angles is not None:
        parts += [between_balls(one, angles) for one in (bodies.inner, bodies.outer)]
    return attrs.evolve(
        rigid,
        kernel=_elastic(rigid.kernel),
        base_kernel=_elastic(rigid.base_kernel),
        scalars=np.concatenate([rigid.scalars, head, *tables]),
        table=np.ascontiguousarray(np.hstack(parts)),
    )


def between_balls(one: RingCompliance, angles: np.ndarray) -> np.ndarray:
    """(rows Z, Z) symmetric compliance of one ring between the balls of each row [m/N], with zeros on the diagonal.

    Parameters
    ----------
    angles : (rows Z,) contact angles [rad], row after row
    """
    count = one.across.shape[1]
    ball = np.arange(count)
    # A ball's neighbour on the left is as far as the one on the right.
    lag = (ball[:, None] - ball[None, :]) % count
    lag = np.minimum(lag, count - lag)
    out = []
    for row in angles.reshape(-1, count):
        mean = 0.5 * (row[:, None] + row[None, :])
        matrix = np.empty((count, count))
        for k in range(count // 2 + 1):
            here = lag == k
            matrix[here] = np.interp(mean[here], one.angles, one.across[:, k])
        np.fill_diagonal(matrix, 0.0)
        out.append(0.5 * (matrix + matrix.T))
    return np.concatenate(out)


def _elastic(kernel: Any) -> Any:
    """The kernel of elastic bodies that belongs to one of rigid bodies; the others are not imported, hence not compiled."""
    name = kernel.__name__.replace("rigid", "condensed")
    return getattr(import_module(f"raceway.core.bodies.{name}"), name)
