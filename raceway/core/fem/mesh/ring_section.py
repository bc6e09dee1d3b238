"""A ring with bore, width and groove, integrated over its section: moments, and the growth of its raceway as it turns."""

from __future__ import annotations

from functools import cache
from math import pi
from typing import Any

import attrs
import numpy as np

from raceway.core import columns

#: Gauss points along the axis in each of three parts, and along the radius: more change growth and moments by 2e-15.
_ALONG, _ACROSS = 20, 10


#: Of the polynomials of the rotating ring; finite elements differ by 1 % (tests/depth/test_growth.py).
_DEGREE = 8


@attrs.frozen(eq=False)
class RingSection:
    """Places and areas to integrate over.

    Attributes
    ----------
    x, r : (n,) place along the axis, 0 in the balls' plane, and radius [m];  area : (n,) [m2]
    contact : x and radius of the groove at the free contact angle [m]
    """

    x: np.ndarray
    r: np.ndarray
    area: np.ndarray
    contact: tuple[float, float]

    @classmethod
    def of(cls, bearing: Any, shoulder_height: float) -> RingSection:
        """From bore, width and groove of a scene's [bearing]; where these are columns, arrays have an axis of points before."""
        b = bearing
        offset, alpha = (b.conformity_inner - 0.5) * b.ball_diameter, b.contact_angle
        groove = b.conformity_inner * b.ball_diameter
        centre_x, centre_r = offset * columns.sin(alpha), 0.5 * b.pitch_diameter + offset * columns.cos(alpha)
        bore, land = 0.5 * b.bore, 0.5 * (b.pitch_diameter - b.ball_diameter) + shoulder_height
        half = columns.sqrt(columns.largest(groove**2 - (centre_r - land) ** 2, 0.0))
        # Where the groove meets the land, or a side face before that.
        ends = centre_x - half, centre_x + half
        left, right = (columns.least(columns.largest(x, -0.5 * b.width), 0.5 * b.width) for x in ends)
        sines = (columns.largest(columns.least((x - centre_x) / groove, 1.0), -1.0) for x in (left, right))
        low, high = (columns.per_ball(columns.asin(sine)) for sine in sines)
        contact = centre_x - groove * columns.sin(alpha), centre_r - groove * columns.cos(alpha)
        numbers = (centre_x, centre_r, groove, bore, land, b.width, left, right)
        centre_x, centre_r, groove, bore, land, width, left, right = map(columns.per_ball, numbers)
        at, weight = _rule(_ALONG)
        angle = 0.5 * (low + high) + 0.5 * (high - low) * at
        tops = [
            (
                centre_x + groove * np.sin(angle),
                centre_r - groove * np.cos(angle),
                0.5 * (high - low) * groove * np.cos(angle),
            )
        ]
        for first, last in ((-0.5 * width, left), (right, 0.5 * width)):
            x = 0.5 * (first + last) + 0.5 * (last - first) * at
            tops.append((x, land, 0.5 * (last - first)))
        shape = np.broadcast_shapes(*(np.shape(part) for parts in tops for part in parts))
        x, top, slope = (
            np.concatenate([np.broadcast_to(part, shape) for part in parts], axis=-1) for parts in zip(*tops, strict=True)
        )
        along = slope * np.tile(weight, len(tops))
        up, share = _rule(_ACROSS)
        wall = 0.5 * (top - bore)
        r = np.expand_dims(bore, -1) + wall[..., None] * (1.0 + up)
        area = along[..., None] * wall[..., None] * share
        r, area = (part.reshape(*part.shape[:-2], -1) for part in (r, area))
        return cls(np.repeat(x, _ACROSS, axis=-1), r, area, contact)

    @property
    def moments(self) -> tuple[columns.Number, columns.Number, columns.Number]:
        """Volume [m3], transverse inertia about x = 0 and polar inertia over density [m5]."""
        volume = 2.0 * pi * self.r * self.area
        by = 0.5 * self.r**2 + self.x**2, self.r**2
        return volume.sum(axis=-1), *(np.squeeze(volume[..., None, :] @ square[..., None], (-2, -1)) for square in by)

    def growth(self, young: float, poisson: float) -> float:
        """Radial growth of the raceway at the contact when a free ring turns [m], for 1 kg/m3 and 1 rad/s.

        Notes
        -----
        Ritz' method on the section: u_r and u_x are polynomials in x and r up to degree 8 that minimise the elastic energy less
        the work of the centrifugal force.  The groove's shoulders bend with it: an annulus from bore to land grows by 5 % more.
        """
        middle, high, wide = 0.5 * (self.r.max() + self.r.min()), 0.5 * np.ptp(self.r), 0.5 * np.ptp(self.x)
        x, r = _legendre(self.x / wide), _legendre((self.r - middle) / high)
        at_x, at_r = _legendre(np.array([self.contact[0] / wide])), _legendre(np.array([(self.contact[1] - middle) / high]))
        powers = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
        radial, axial = [], []  # strains (4, n): radial, hoop, axial, shear
        none = np.zeros_like(self.r)
        for i, j in powers:
            value, by_r, by_x = r[0][i] * x[0][j], r[1][i] * x[0][j] / high, r[0][i] * x[1][j] / wide
            radial.append((by_r, value / self.r, none, by_x))
            if i or j:  # a shift along the axis strains nothing
                axial.append((none, none, by_x, by_r))
        strain = np.array(radial + axial)
        lame, shear = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson))
        elastic = np.diag([2.0 * shear] * 3 + [shear])
        elastic[:3, :3] += lame
        weight = self.r * self.area
        stress = np.matmul(elastic, strain)
        # In parts of a size that libraries of linear algebra give one thread: two wait for each other longer than they compute.
        left, right = (part.reshape(len(strain), -1, 3 * _ACROSS) for part in (strain * weight, stress))
        stiffness = (left.transpose(1, 0, 2) @ right.transpose(1, 2, 0)).sum(axis=0)
        work = np.zeros(len(strain))
        work[: len(powers)] = [(r[0][i] * x[0][j] * self.r) @ weight for i, j in powers]
        amount = np.linalg.solve(stiffness, work)[: len(powers)]
        return float(amount @ [at_r[0][i, 0] * at_x[0][j, 0] for i, j in powers])


def _legendre(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Legendre's polynomials to ``_DEGREE`` at z (n,), (degree + 1, n), and their derivatives."""
    identity = np.eye(_DEGREE + 1)
    slopes = np.polynomial.legendre.legder(identity, axis=1)
    value = np.polynomial.legendre.legvander(z, _DEGREE).T
    return value, slopes @ value[:-1]


@cache
def _rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights on [-1, 1]; nobody writes into them."""
    at, weight = np.polynomial.legendre.leggauss(points)
    at.flags.writeable = weight.flags.writeable = False
    return at, weight
