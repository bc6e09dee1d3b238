"""The outline of a ring's section without its groove: what a user's polygon says, split where a mesh needs it.

The section is what lies between two lines over x: the seat's side (bore of the inner ring, outer cylinder of the outer one)
and the race's side, out of which the groove's circle is cut.  Chamfers, steps that lean, unequal shoulders and hollow sides
are all such lines; an undercut is not, and is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, ceil, pi

import attrs
import numpy as np

from raceway.errors import MeshError


@attrs.frozen(eq=False)
class Outline:
    """Lines (k, 2) of x and radius [m], x strictly increasing.

    Attributes
    ----------
    left, right : race side, from the left side face to the groove, and from the groove to the right side face
    seat : seat side, from face to face
    edges : angles of the groove's left and right edge [rad], from its bottom towards +x
    """

    left: np.ndarray
    right: np.ndarray
    seat: np.ndarray
    edges: tuple[float, float]

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


def plain_outline(seat: float, land: float, width: float, ends: tuple[float, float], edge: float) -> Outline:
    """A hollow cylinder: radii of seat and land, width between its faces, and the groove's ends on the land [m]."""
    half = 0.5 * width
    return Outline(
        np.array([[-half, land], [ends[0], land]]),
        np.array([[ends[1], land], [half, land]]),
        np.array([[-half, seat], [half, seat]]),
        (-edge, edge),
    )


def polygon_outline(
    key: str, polygon: Sequence[Sequence[float]], inner: bool, groove: float, centre_x: float, centre_r: float
) -> Outline:
    """The outline that a polygon of the whole section, groove not yet cut, stands for.

    Parameters
    ----------
    key : the scene's key, for messages
    polygon : [x, radius] of the corners in their order around the section [m]
    groove, centre_x, centre_r : radius of the groove and its centre

    Raises
    ------
    MeshError
        What is no section, or cannot be filled with quadrilaterals between two lines.
    """
    points = np.asarray(polygon, dtype=float)
    if len(points) < 4:
        raise MeshError(f"`{key}` has {len(points)} points: a section needs at least 4, [x, radius] around it")
    if points[:, 1].min() <= 0.0:
        raise MeshError(f"`{key}`: the radius {points[:, 1].min():g} m must be greater than 0")
    low, high = _chains(key, points)
    race, seat = (high, low) if inner else (low, high)
    side = -1.0 if inner else 1.0
    left, right = _cut(key, race, groove, np.array([centre_x, centre_r]))
    angles = [atan2(p[0] - centre_x, side * (p[1] - centre_r)) for p in (left[-1], right[0])]
    if max(abs(a) for a in angles) >= 0.5 * pi:
        raise MeshError(
            f"`{key}`: the shoulder at x = {1e3 * left[-1, 0]:.4g} or {1e3 * right[0, 0]:.4g} mm closes over the groove: it "
            "must lie between the groove's bottom and its centre"
        )
    return Outline(left, right, seat, (angles[0], angles[1]))


def _chains(key: str, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lines between the left and the right side face, at small and at large radius."""
    x = points[:, 0]
    size = np.ptp(x)
    count = len(points)
    lines = []
    faces = []
    for end in (x.min(), x.max()):
        on = np.flatnonzero(np.abs(x - end) <= 1e-9 * size)
        if len(on) != 2 or (on[1] - on[0]) % count not in (1, count - 1):
            raise MeshError(
                f"`{key}` has {len(on)} points at x = {1e3 * end:.4g} mm: each end of a ring is a side face, two neighbouring "
                "points with the same x"
            )
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
            raise MeshError(
                f"`{key}` does not go on in x after [{at[0]:g}, {at[1]:g}]: an upright step or an undercut cannot be meshed; "
                "lean it a little, or leave it out"
            )
    lines.sort(key=lambda line: float(np.interp(0.5 * (x.min() + x.max()), line[:, 0], line[:, 1])))
    every = np.union1d(lines[0][:, 0], lines[1][:, 0])
    wall = np.interp(every, *lines[1].T) - np.interp(every, *lines[0].T)
    if wall.min() <= 0.0:
        raise MeshError(f"`{key}` crosses itself near x = {1e3 * every[np.argmin(wall)]:.4g} mm")
    return lines[0], lines[1]


def _cut(key: str, race: np.ndarray, groove: float, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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
