"""Triangles of what a bearing is made of, with normals, in millimetres: arrays that any renderer takes."""

from __future__ import annotations

from math import pi

import attrs
import numpy as np

#: Corners sharper than this are edges, and are not shaded over [rad].
_CORNER = 0.4


@attrs.frozen(eq=False)
class Surface:
    """Triangles.

    Attributes
    ----------
    points, normals : (n, 3) [mm], and unit vectors out of the body
    triangles : (m, 3) int
    values : (n,) what the points are coloured by; None for one colour
    """

    points: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    values: np.ndarray | None = None

    def moved(self, by: np.ndarray) -> Surface:
        """The same surface at another place (3,) [mm]."""
        return attrs.evolve(self, points=self.points + by)


def joined(parts: list[Surface]) -> Surface:
    """Several surfaces as one."""
    starts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    values = [part.values for part in parts if part.values is not None]
    return Surface(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
        np.concatenate(values) if len(values) == len(parts) else None,
    )


def revolved(line: np.ndarray, azimuths: np.ndarray) -> Surface:
    """The surface that a closed line (k, 2) of x and radius sweeps, the body to the left of it.

    Parameters
    ----------
    line : first and last point differ; corners are kept sharp
    azimuths : (n,) [rad], from +y towards +z
    """
    return joined([_band(piece, azimuths) for piece in _smooth_pieces(line)])


def _smooth_pieces(line: np.ndarray) -> list[np.ndarray]:
    """The closed line, cut at its corners."""
    closed = np.concatenate([line, line[:1]])
    step = np.diff(closed, axis=0)
    angle = np.arctan2(step[:, 1], step[:, 0])
    turn = np.abs((np.diff(angle) + pi) % (2.0 * pi) - pi)
    cuts = [0, *(np.flatnonzero(turn > _CORNER) + 1), len(closed) - 1]
    return [closed[a : b + 1] for a, b in zip(cuts[:-1], cuts[1:], strict=True)]


def _band(line: np.ndarray, azimuths: np.ndarray) -> Surface:
    slope = np.gradient(line, axis=0)
    # The body lies left of the line: its outside is to the right.
    out = np.column_stack([slope[:, 1], -slope[:, 0]]) / np.linalg.norm(slope, axis=1)[:, None]
    return Surface(_swept(line, azimuths), _swept(out, azimuths), _grid(len(azimuths), len(line)))


def _swept(line: np.ndarray, azimuths: np.ndarray) -> np.ndarray:
    x, r = line.T
    cosine, sine = np.cos(azimuths)[:, None], np.sin(azimuths)[:, None]
    return np.stack([np.broadcast_to(x, (len(azimuths), len(x))), cosine * r, sine * r], axis=-1).reshape(-1, 3)


def _grid(rows: int, columns: int) -> np.ndarray:
    """(m, 3) triangles of a grid of points, row by row."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (i * columns + j).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def section(race: np.ndarray, seat: np.ndarray, azimuth: float, sense: float) -> Surface:
    """The cut face of a ring between two lines (k, 2) over the same x, facing along ``sense`` times growing azimuth."""
    points = _swept(np.concatenate([race, seat]), np.array([azimuth]))
    normal = sense * np.array([0.0, -np.sin(azimuth), np.cos(azimuth)])
    return Surface(points, np.tile(normal, (len(points), 1)), _grid(2, len(race)))


def ball(diameter: float, rows: int = 24, columns: int = 36) -> Surface:
    """A ball at the origin."""
    latitude, longitude = np.linspace(0.0, pi, rows + 1), np.linspace(0.0, 2.0 * pi, columns + 1)
    line = np.column_stack([np.cos(latitude), np.sin(latitude)])
    normals = _swept(line, longitude)
    return Surface(0.5 * diameter * normals, normals, _grid(columns + 1, rows + 1))


def contact_patch(
    centre: np.ndarray, towards: np.ndarray, along: np.ndarray, diameter: float, half: tuple[float, float], peak: float
) -> Surface:
    """A contact ellipse on a ball, with Hertz's pressure.

    Parameters
    ----------
    centre, towards, along : (3,) the ball's centre [mm], unit vectors to the contact and in the rolling direction
    half : semi-axes across and in the rolling direction [mm];  peak : its largest pressure
    """
    share = np.linspace(0.0, 1.0, 7)[:, None]
    angle = np.linspace(0.0, 2.0 * pi, 33)[None, :]
    across = np.cross(along, towards)
    s, t = half[0] * share * np.cos(angle), half[1] * share * np.sin(angle)
    on_plane = 0.5 * diameter * towards + s[..., None] * across + t[..., None] * along
    normals = on_plane / np.linalg.norm(on_plane, axis=-1, keepdims=True)
    # A little above the surface, so that it is seen.
    points = centre + 1.004 * 0.5 * diameter * normals
    values = np.broadcast_to(peak * np.sqrt(1.0 - share**2), s.shape)
    return Surface(points.reshape(-1, 3), normals.reshape(-1, 3), _grid(*s.shape), np.ascontiguousarray(values).ravel())


def arrow(start: np.ndarray, towards: np.ndarray, length: float, thickness: float) -> Surface:
    """An arrow from ``start`` (3,) along a unit vector; its head is at most 2.5 thicknesses long [mm]."""
    head = min(2.5 * thickness, 0.6 * length)
    thin, wide = 0.3 * thickness * head / (2.5 * thickness), 0.8 * thickness * head / (2.5 * thickness)
    line = np.array([[0.0, 0.0], [0.0, thin], [length - head, thin], [length - head, wide], [length, 0.0]])
    solid = revolved(line[::-1], np.linspace(0.0, 2.0 * pi, 17))
    side = np.cross(towards, [1.0, 0.0, 0.0] if abs(towards[0]) < 0.9 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    frame = np.stack([towards, side, np.cross(towards, side)])
    return Surface(start + solid.points @ frame, solid.normals @ frame, solid.triangles)
