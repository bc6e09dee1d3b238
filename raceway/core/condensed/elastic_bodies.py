"""The structural compliances of a bearing, and the small system that rigid rings become with them."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.condensed.calibration import Calibration
from raceway.core.condensed.structural import RingCompliance
from raceway.core.revolution.grooves import along_normal, groove_compliance, own_compliance
from raceway.core.ring.address import plain
from raceway.core.ring.kernels.condensed import condensed
from raceway.core.ring.system import System

#: Least standard deviation of the contact angles that compliances between groove centres are fitted for [rad].
_WIDTH = 0.2


@attrs.frozen(eq=False)
class ElasticBodies:
    """Structural compliances of rings and balls, added to the approach of each contact.

    Attributes
    ----------
    inner, outer : of the rings, at the same angles
    ball_own, ball_opposite : of a ball, by its load on the same and on the other race [m/N]
    calibrations : of contacts on the inner and the outer race at their surface points, where those are known
    """

    inner: RingCompliance
    outer: RingCompliance
    ball_own: float
    ball_opposite: float
    calibrations: tuple[Calibration | None, Calibration | None] = (None, None)

    def own(self, race: int, angles: np.ndarray) -> np.ndarray:
        """Compliance of ring and ball together at contact angles [rad], in m/N; race: 0 inner, 1 outer.

        Notes
        -----
        The rings' tables tell how it changes over the groove, calibrations how large it is.
        """
        return self._matched(race, angles) + self.beyond(race, angles)

    def beyond(self, race: int, angles: np.ndarray) -> np.ndarray:
        """Compliance of contacts at surface points beyond that of depth matching, at contact angles [rad], in m/N."""
        calibration = self.calibrations[race]
        if calibration is None:
            return np.zeros(len(angles))
        known = calibration.compliance - self._matched(race, calibration.angles)
        return np.asarray(np.interp(np.abs(angles), calibration.angles, known))

    def _matched(self, race: int, angles: np.ndarray) -> np.ndarray:
        one = (self.inner, self.outer)[race]
        return np.asarray(one.smooth(np.clip(angles, one.angles[0], one.angles[-1])) + self.ball_own)

    def at(self, angle: float) -> tuple[float, float]:
        """Compliances (inner, outer) of ring and ball together at a contact angle [rad], in m/N."""
        inner, outer = (float(self.own(race, np.array([angle]))[0]) for race in (0, 1))
        return inner, outer

    @property
    def largest_across(self) -> float:
        """Largest compliance between two balls through a ring [m/N]."""
        between = (np.diagonal(one.across[:, :, 1:]) for one in (self.inner, self.outer))
        return float(max(np.abs(one).max(initial=0.0) for one in between))


def elastic_system(rigid: System, bodies: ElasticBodies, angles: np.ndarray | None = None) -> System:
    """The system of rigid rings with elastic ones in their place.

    Parameters
    ----------
    rigid : with kernels of rigid bodies
    angles : (Z,) contact angles [rad] about which balls act on each other through the rings; None leaves that out

    Notes
    -----
    Tables over the angle become cubic splines without slope at their ends.  Where balls act on each other the table holds what
    a contact's own compliance has beyond n.M n of its groove centre's motion.
    """
    from scipy.interpolate import CubicSpline

    count = bodies.inner.across.shape[2]
    knots = bodies.inner.angles
    distance = knots[1] - knots[0]
    tables, rings = [], []
    for race, one in enumerate((bodies.inner, bodies.outer)):
        values = bodies.own(race, knots)
        if angles is not None:
            rings.append(between_grooves(one, angles))
            values -= along_normal(knots, rings[-1][0])
        tables += [values, distance * CubicSpline(knots, values, bc_type=((1, 0.0), (1, 0.0)))(knots, 1)]
    head = [bodies.ball_opposite, 0.0 if angles is None else 1.0, count, knots[0], distance, len(knots)]
    if angles is not None:
        tables.append(np.column_stack([rings[0] + rings[1], rings[1][:, 1:]]).ravel())
    return attrs.evolve(
        rigid,
        kernel=condensed(plain(rigid.kernel)),
        base_kernel=condensed(plain(rigid.base_kernel)),
        scalars=np.concatenate([rigid.scalars, head, *tables]),
        table=rigid.table.copy(),
    )


def between_grooves(one: RingCompliance, angles: np.ndarray) -> np.ndarray:
    """Compliance of one ring between groove centres, from loads and displacements along the normals of contacts.

    Parameters
    ----------
    angles : (n,) contact angles of the balls [rad], about which the compliance is to hold

    Returns
    -------
    compliance : (Z, 3) axial by axial, axial by radial, radial by radial force of a ball so many balls further round [m/N]

    Notes
    -----
    Angles of the table have the weight of a normal distribution about those of the balls.
    """
    middle, width = float(angles.mean()), float(np.hypot(_WIDTH, angles.std()))
    weight = np.exp(-0.5 * ((one.angles - middle) / width) ** 2)
    out = np.empty((one.across.shape[2], 3))
    out[0] = own_compliance(one.angles, one.own, weight)
    out[1:] = groove_compliance(one.angles, one.across[:, :, 1:], weight)
    return out
