"""A ring with bore, width and groove, integrated over its section: moments, and the growth of its raceway as it turns."""

from collections.abc import Sequence
from functools import cache
from math import atan2, ceil, pi
from typing import Any

import attrs
import numpy as np

from raceway.core import columns
from raceway.errors import MeshError

#: Gauss points along the axis in each of three parts, and along the radius: more change growth and moments by 2e-15.
_ALONG, _ACROSS = 20, 10

#: Of the polynomials of the rotating ring; finite elements differ by 1 % (tests/core/test_growth.py).
_DEGREE = 8


@attrs.frozen(eq=False)
class RingSection:
    """Places and areas to integrate over."""

    #: x, r : (n,) place along the axis, 0 in the balls' plane, and radius [m]
    x: np.ndarray
    r: np.ndarray
    area: np.ndarray  # (n,) [m2]
    contact: tuple[float, float]  # x and radius of the groove at the free contact angle [m]

    @classmethod
    def of(cls, bearing: Any, shoulder_height: float) -> "RingSection":
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
        slope = 0.5 * (high - low) * groove * np.cos(angle)
        tops = [(centre_x + groove * np.sin(angle), centre_r - groove * np.cos(angle), slope)]
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

    def growth(self, young: columns.Number, poisson: columns.Number) -> columns.Number:
        """Radial growth of the raceway at the contact when a free ring turns [m], for 1 kg/m3 and 1 rad/s.

        Ritz' method on the section: u_r and u_x are polynomials in x and r up to degree 8 that minimise the elastic energy less
        the work of the centrifugal force.  The groove's shoulders bend with it: an annulus from bore to land grows by 5 % more.
        Energies are integrated over the radius at each x first, then along the axis.
        """
        x, n = self.x[..., ::_ACROSS], _DEGREE + 1
        r, area = (part.reshape(*part.shape[:-1], -1, _ACROSS) for part in (self.r, self.area))
        middle, high = 0.5 * (self.r.max(-1) + self.r.min(-1)), 0.5 * np.ptp(self.r, -1)
        wide = 0.5 * np.ptp(self.x, -1)
        places = self.contact[0] / wide, (self.contact[1] - middle) / high
        at_x, at_r = (_legendre(np.expand_dims(place, -1))[0] for place in places)
        high, wide = (np.expand_dims(size, (-1, -2)) for size in (high, wide))
        (q, q_x), (p, p_r) = _legendre(x / wide[..., 0]), _legendre((r - middle[..., None, None]) / high)
        q_x, p_r = q_x / wide, p_r / high[..., None]

        def across(left: np.ndarray, right: np.ndarray, weight: np.ndarray) -> np.ndarray:
            """Integrals of products over the radius, (..., m, n, n) of m places along the axis."""
            return np.swapaxes(left * weight[..., None], -1, -2) @ right

        def along(radial: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
            """Of such integrals times polynomials of x the integrals along the axis, (..., n^2, n^2)."""
            pairs = (left[..., :, None] * right[..., None, :]).reshape(*left.shape[:-1], -1)
            total = np.swapaxes(radial.reshape(*radial.shape[:-2], -1), -1, -2) @ pairs
            total = np.swapaxes(total.reshape(*total.shape[:-2], n, n, n, n), -3, -2)
            return total.reshape(*total.shape[:-4], n * n, n * n)

        lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        lame, shear = (np.expand_dims(m, (-1, -2, -3)) for m in (lame, young / (2.0 * (1.0 + poisson))))
        weight, both = r * area, across(p, p_r, area)
        plain, mixed, steep = across(p, p, weight), across(p, p_r, weight), across(p_r, p_r, weight)
        # Strains: radial and hoop of u_r, axial of u_x, shear of both.
        hoop = (lame + 2.0 * shear) * (steep + across(p, p, area / r)) + lame * (both + np.swapaxes(both, -1, -2))
        radial = along(hoop, q, q) + along(shear * plain, q_x, q_x)
        axial = along((lame + 2.0 * shear) * plain, q_x, q_x) + along(shear * steep, q, q)
        coupled = lame * (np.swapaxes(mixed, -1, -2) + across(p, p, area))
        coupled = along(coupled, q, q_x) + along(shear * mixed, q_x, q)
        powers = np.array([n * i + j for i in range(n) for j in range(n - i)])
        shifted = powers[1:]  # a shift along the axis strains nothing
        rows = (radial[..., powers[:, None], powers], coupled[..., powers[:, None], shifted])
        sides = (np.swapaxes(rows[1], -1, -2), axial[..., shifted[:, None], shifted])
        stiffness = np.concatenate([np.concatenate(parts, axis=-1) for parts in (rows, sides)], axis=-2)
        pushed = np.swapaxes((np.swapaxes(p, -1, -2) @ (r * weight)[..., None])[..., 0], -1, -2) @ q
        force = np.zeros((*stiffness.shape[:-1], 1))
        force[..., : len(powers), 0] = pushed.reshape(*pushed.shape[:-2], -1)[..., powers]
        amount = np.linalg.solve(stiffness, force)[..., : len(powers), 0]
        there = np.swapaxes(at_r, -1, -2) * at_x
        growth = (amount * there.reshape(*there.shape[:-2], -1)[..., powers]).sum(-1)
        return growth if growth.ndim else float(growth)


def _legendre(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Legendre's polynomials to ``_DEGREE`` at z, on a last axis, and their derivatives."""
    slopes = np.polynomial.legendre.legder(np.eye(_DEGREE + 1), axis=1)
    value = np.polynomial.legendre.legvander(z, _DEGREE)
    return value, value[..., :-1] @ slopes.T


@cache
def _rule(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights on [-1, 1]; nobody writes into them."""
    at, weight = np.polynomial.legendre.leggauss(points)
    at.flags.writeable = weight.flags.writeable = False
    return at, weight


@attrs.frozen(eq=False)
class Outline:
    """Lines (k, 2) of x and radius [m], x strictly increasing.

    The section is what lies between two lines over x: the seat's side (bore of the inner ring, outer cylinder of the outer
    one) and the race's side, out of which the groove's circle is cut. Chamfers, steps that lean, unequal shoulders and
    hollow sides are all such lines; an undercut is not, and is refused.
    """

    #: left, right : race side, from the left side face to the groove, and from the groove to the right side face
    left: np.ndarray
    right: np.ndarray
    seat: np.ndarray  # seat side, from face to face
    edges: tuple[float, float]  # angles of the groove's left and right edge [rad], from its bottom towards +x

    def shares(self, side: str, size: float) -> np.ndarray:
        """(n,) Points 0 to 1 along x of "left" or "right", at most ``size`` [m] apart, one on each corner of it.

        The corners of the seat side below it are met, too, where they are farther than a tenth of ``size`` from others.
        """
        line = self.left if side == "left" else self.right
        marks = list(line[:, 0])
        for x in self.seat[1:-1, 0]:
            if line[0, 0] < x < line[-1, 0] and min(abs(x - mark) for mark in marks) > 0.1 * size:
                marks.append(x)
        marks.sort()
        parts = [np.linspace(a, b, ceil((b - a) / size - 1e-9) + 1)[1:] for a, b in zip(marks[:-1], marks[1:], strict=True)]
        x = np.concatenate([[marks[0]], *parts])
        return np.asarray((x - marks[0]) / (marks[-1] - marks[0]))

    def top(self, side: str, shares: np.ndarray) -> np.ndarray:
        """(n, 2) x and radius at shares from 0 to 1 along x of "left" or "right"."""
        line = self.left if side == "left" else self.right
        x = line[0, 0] + shares * (line[-1, 0] - line[0, 0])
        return np.column_stack([x, np.interp(x, *line.T)])


def polygon_outline(
    key: str, polygon: Sequence[Sequence[float]], inner: bool, groove: float, centre_x: float, centre_r: float
) -> Outline:
    """The outline that a polygon of a section, its groove not yet cut, stands for.

    key : the scene's key, for messages;  polygon : [x, radius] of the corners in their order around the section [m]
    groove, centre_x, centre_r : radius of the groove and its centre
    MeshError: what is no section, or cannot be filled with quadrilaterals between two lines.
    """
    points = np.asarray(polygon, dtype=float)
    if len(points) < 4:
        raise MeshError(f"`{key}` has {len(points)} points: a section needs at least 4, [x, radius] around it")
    if points[:, 1].min() <= 0.0:
        raise MeshError(f"`{key}`: the radius {points[:, 1].min():g} m must be greater than 0")
    # The lines between the left and the right side face, at small and at large radius.
    x = points[:, 0]
    size = np.ptp(x)
    count = len(points)
    lines = []
    faces = []
    for end in (x.min(), x.max()):
        on = np.flatnonzero(np.abs(x - end) <= 1e-9 * size)
        if len(on) != 2 or (on[1] - on[0]) % count not in (1, count - 1):
            why = f"`{key}` has {len(on)} points at x = {1e3 * end:.4g} mm: each end of a ring is a side face, two neighbouring points with the same x"
            raise MeshError(why)
        faces.append(on)
    for first in faces[0]:
        step = 1 if (first + 1) % count not in faces[0] else -1
        walk = [int(first)]
        while walk[-1] not in faces[1]:
            walk.append((walk[-1] + step) % count)
        lines.append(points[walk])
    for line in lines:
        bad = np.flatnonzero(np.diff(line[:, 0]) <= 1e-9 * size)
        if len(bad):
            at = line[bad[0]]
            why = f"`{key}` does not go on in x after [{at[0]:g}, {at[1]:g}]: a vertical step or an undercut cannot be meshed: incline or remove it"
            raise MeshError(why)
    lines.sort(key=lambda line: float(np.interp(0.5 * (x.min() + x.max()), line[:, 0], line[:, 1])))
    every = np.union1d(lines[0][:, 0], lines[1][:, 0])
    wall = np.interp(every, *lines[1].T) - np.interp(every, *lines[0].T)
    if wall.min() <= 0.0:
        raise MeshError(f"`{key}` crosses itself near x = {1e3 * every[np.argmin(wall)]:.4g} mm")
    low, high = lines[0], lines[1]
    race, seat = (high, low) if inner else (low, high)
    side = -1.0 if inner else 1.0
    left, right = _cut_groove(key, race, groove, np.array([centre_x, centre_r]))
    angles = [atan2(p[0] - centre_x, side * (p[1] - centre_r)) for p in (left[-1], right[0])]
    if max(abs(a) for a in angles) >= 0.5 * pi:
        raise MeshError(
            f"`{key}`: the shoulder at x = {1e3 * left[-1, 0]:.4g} or {1e3 * right[0, 0]:.4g} mm closes over the groove: it "
            "must lie between the groove's bottom and its centre"
        )
    return Outline(left, right, seat, (angles[0], angles[1]))


def _cut_groove(key: str, race: np.ndarray, groove: float, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The race side left and right of the groove's circle, both ending on it."""
    places: list[tuple[int, float]] = []
    for i, (a, b) in enumerate(zip(race[:-1], race[1:], strict=True)):
        d, e = b - a, a - centre
        roots = np.roots([d @ d, 2.0 * d @ e, e @ e - groove**2])
        places += [(i, float(t)) for t in sorted(roots.real) if np.isreal(roots).all() and 0.0 <= t < 1.0]
    if len(places) != 2:
        raise MeshError(
            f"`{key}`: the groove's circle meets the race side {len(places)} times; it must cut it twice, once on each "
            f"shoulder (centre x = {1e3 * centre[0]:.4g}, r = {1e3 * centre[1]:.4g} mm, radius {1e3 * groove:.4g} mm)"
        )
    (i, t), (j, s) = places
    first, last = race[i] + t * (race[i + 1] - race[i]), race[j] + s * (race[j + 1] - race[j])
    if np.hypot(*(race[0] - centre)) <= groove or np.hypot(*(race[-1] - centre)) <= groove:
        raise MeshError(f"`{key}`: a side face lies within the groove's circle: the ring is too narrow")
    return np.concatenate([race[: i + 1], [first]]), np.concatenate([[last], race[j + 1 :]])
