"""Picture of a bearing in one state: rings, balls by their load, arrows, contact ellipses by their pressure."""

from __future__ import annotations

from functools import lru_cache
from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway import SceneError

if TYPE_CHECKING:
    from raceway import Result
    from raceway.extend import Bearing as Dimensions
    from raceway.extend import Tables

#: Corners sharper than this are edges, and are not shaded over [rad].
_CORNER = 0.4


@attrs.frozen(eq=False)
class Surface:
    """Triangles."""

    #: points, normals : (n, 3) [mm], and unit vectors out of the body
    points: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray  # (m, 3) int
    values: np.ndarray | None = None  # (n,) what the points are coloured by; None for one colour

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


def _surface_of_revolution(line: np.ndarray, azimuths: np.ndarray) -> Surface:
    """The surface that a closed line (k, 2) of x and radius sweeps, the body to the left of it.

    line : first and last point differ; corners are kept sharp;  azimuths : (n,) [rad], from +y towards +z
    """
    # The closed line, cut at its corners
    outline = np.concatenate([line, line[:1]])
    step = np.diff(outline, axis=0)
    angle = np.arctan2(step[:, 1], step[:, 0])
    turn = np.abs((np.diff(angle) + pi) % (2.0 * pi) - pi)
    cuts = [0, *(np.flatnonzero(turn > _CORNER) + 1), len(outline) - 1]
    return joined([_band(outline[a : b + 1], azimuths) for a, b in zip(cuts[:-1], cuts[1:], strict=True)])


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


def _section(race: np.ndarray, seat: np.ndarray, azimuth: float, sense: float) -> Surface:
    """The cut face of a ring between two lines (k, 2) over the same x, facing along ``sense`` times growing azimuth."""
    points = _swept(np.concatenate([race, seat]), np.array([azimuth]))
    normal = sense * np.array([0.0, -np.sin(azimuth), np.cos(azimuth)])
    return Surface(points, np.tile(normal, (len(points), 1)), _grid(2, len(race)))


def ball(diameter: float, rows: int = 24, columns: int = 36) -> Surface:
    """A ball at the origin."""
    latitude, longitude = np.linspace(0.0, pi, rows + 1), np.linspace(0.0, 2.0 * pi, columns + 1)
    normals = _swept(np.column_stack([np.cos(latitude), np.sin(latitude)]), longitude)
    return Surface(0.5 * diameter * normals, normals, _grid(columns + 1, rows + 1))


def contact_patch(
    centre: np.ndarray, towards: np.ndarray, along: np.ndarray, diameter: float, half: tuple[float, float], peak: float
) -> Surface:
    """A contact ellipse on a ball, with Hertz's pressure.

    centre, towards, along : (3,) the ball's centre [mm], unit vectors to the contact and in the rolling direction
    half : semi-axes across and in the rolling direction [mm];  peak : its largest pressure
    """
    share = np.linspace(0.0, 1.0, 6)[:, None]
    angle = np.linspace(0.0, 2.0 * pi, 25)[None, :]
    across = np.cross(along, towards)
    s, t = half[0] * share * np.cos(angle), half[1] * share * np.sin(angle)
    on_plane = 0.5 * diameter * towards + s[..., None] * across + t[..., None] * along
    normals = on_plane / np.linalg.norm(on_plane, axis=-1, keepdims=True)
    # A little above the surface, so that it is seen.
    points = centre + 1.004 * 0.5 * diameter * normals
    values = np.broadcast_to(peak * np.sqrt(1.0 - share**2), s.shape)
    return Surface(points.reshape(-1, 3), normals.reshape(-1, 3), _grid(*s.shape), np.ascontiguousarray(values).ravel())


@lru_cache(maxsize=64)
def _arrow_along_x(length: float, thickness: float) -> Surface:
    head = min(2.5 * thickness, 0.6 * length)
    thin, wide = 0.3 * thickness * head / (2.5 * thickness), 0.8 * thickness * head / (2.5 * thickness)
    line = np.array([[0.0, 0.0], [0.0, thin], [length - head, thin], [length - head, wide], [length, 0.0]])
    return _surface_of_revolution(line[::-1], np.linspace(0.0, 2.0 * pi, 17))


_MM = 1e3
#: Azimuths that are cut out of the rings [rad], from +y towards +z.
_CUT = (-0.08 * pi, 0.55 * pi)
#: The longest arrow over the ball diameter.
_LONGEST = 1.1
#: The longest semi-axis of a contact as it is drawn over the ball's diameter.
_WIDEST = 0.45
INNER, OUTER, _FACE = "#6f93b5", "#b9a679", "#dfe3e7"


@attrs.frozen(eq=False)
class Snapshot:
    """Balls and inner ring at one moment."""

    azimuth: np.ndarray  # (Z,) [rad]
    load: np.ndarray  # (2 Z,) inner races first [N]
    angle: np.ndarray  # (2 Z,) contact angles, nan where a contact carries nothing [rad]
    #: half, peak : (2 Z, 2) semi-axes of the contacts, major ones first [m], and (2 Z,) their largest pressures [Pa]
    half: np.ndarray
    peak: np.ndarray
    motion: np.ndarray  # (5,) of the inner ring as it is drawn, exaggerated where that is said: x, y, z [m], tilts [rad]


@attrs.frozen(eq=False)
class Solid:
    """One surface and how it looks."""

    name: str
    surface: Surface
    #: of the surface; None where ``surface.values`` are loads [N] or pressures [MPa], as ``scale`` says
    colour: str | None = None
    opacity: float = 1.0
    scale: str | None = None
    load: float | None = None  # of a ball [N], for its colour; None for others
    ball: int | None = None  # number of the ball; None for others


@attrs.frozen(eq=False)
class BearingSolids:
    """The bodies of a result."""

    result: Result
    shape: Dimensions
    assumed: tuple[str, ...]  # dimensions that the scene does not give

    @classmethod
    def of(cls, result: Result) -> BearingSolids:
        """From a result; rings without dimensions get usual ones, by name.  SceneError: rows of different bearings."""
        b = result.model.problem.bearing
        if not b.equal_rows:
            raise SceneError.at("bearing.row", None, "rows of different bearings are not drawn: leave out what differs")
        wall = 0.85 * b.ball_diameter
        usual = {
            "bore": b.pitch_diameter - 2.0 * wall, "outer_diameter": b.pitch_diameter + 2.0 * wall, "width": 1.7 * b.ball_diameter
        }  # fmt: skip
        missing: Tables = {name: value for name, value in usual.items() if getattr(b, name) is None}
        return cls(result, attrs.evolve(b, **missing), tuple(missing))

    @property
    def diameter(self) -> float:
        """Of a ball [mm]."""
        return _MM * float(self.shape.ball_diameter)

    @property
    def outer_diameter(self) -> float:
        """Of the outer ring [mm], as it is drawn."""
        return _MM * float(self.shape.outer_diameter or 0.0)

    def centres(self, state: Snapshot) -> np.ndarray:
        """(Z, 3) places of the balls [mm]: each follows the inner ring by half, as contacts of nearly equal stiffness do."""
        radial = _radial(state.azimuth)
        follow = 0.5 * (self.moved(_groove_radius(self.shape) * radial, state) - _groove_radius(self.shape) * radial)
        places = np.repeat([axial for _, axial in self.shape.rows], self.shape.ball_count)
        axial = places[:, None] * [1.0, 0.0, 0.0]
        return np.asarray(_MM * (0.5 * self.shape.pitch_diameter * radial + axial + follow))

    def moved(self, points: np.ndarray, state: Snapshot) -> np.ndarray:
        """(n, 3) points of the inner ring [m] after its motion, tilts taken as small."""
        x, y, z, tilt_y, tilt_z = state.motion
        turn = np.cross([0.0, tilt_y, tilt_z], points)
        return np.asarray(points + turn + [x, y, z])

    def rings(self, cut: tuple[float, float] | None = _CUT, glass: bool = True, facets: int = 120) -> list[Solid]:
        """Both rings of each row at rest, without the azimuths between ``cut``; ``glass``: one sees through the outer one; of ``facets``."""
        parts = []
        low, high = (0.0, 0.0) if cut is None else cut
        azimuths = np.linspace(high, low + 2.0 * pi, facets + 1)
        for inner, colour in ((True, INNER), (False, OUTER)):
            for side, axial in self.shape.rows:
                race, seat = self.lines(inner, side, axial)
                outline = np.concatenate([seat, race[::-1]] if inner else [race, seat[::-1]])
                name = "inner ring" if inner else "outer ring"
                opacity = 0.32 if glass and not inner else 1.0
                parts.append(Solid(name, _surface_of_revolution(outline, azimuths), colour, opacity))
                if cut is not None:
                    faces = [_section(race, seat, at, sense) for at, sense in ((high, -1.0), (low, 1.0))]
                    parts.append(Solid(f"{name}, cut face", joined(faces), _FACE if glass else colour))
        return parts

    def lines(self, inner: bool, side: float, axial: float) -> tuple[np.ndarray, np.ndarray]:
        """Race side and seat side (k, 2) of a ring's section over the same x, ascending [mm]."""
        from raceway.extend import ring_shape

        shape = ring_shape(self.shape, inner)
        outline = shape.outline
        race = np.concatenate([outline.left[:-1], shape.surface(np.linspace(*outline.edges, 17)), outline.right[1:]])
        seat = np.column_stack([race[:, 0], np.interp(race[:, 0], *outline.seat.T)])
        lines = [_MM * (line * [side, 1.0] + [axial, 0.0]) for line in (race, seat)]
        return (lines[0][::-1], lines[1][::-1]) if side < 0.0 else (lines[0], lines[1])

    def balls(self, state: Snapshot) -> list[Solid]:
        """Each ball with the load of its inner contact."""
        solid, loads = ball(self.diameter), state.load.tolist()
        centres = enumerate(self.centres(state))
        return [Solid(f"ball {k}", solid.moved(centre), load=loads[k], ball=k) for k, centre in centres]

    def arrows(self, state: Snapshot, top: float) -> list[Solid]:
        """The force of each ball on the outer ring, outside of it; as long as the ball diameter at the load ``top`` [N]."""
        z, parts = len(state.azimuth), []
        towards = self.towards(state)[z:]
        for k, (start, tip) in enumerate(zip(*self.arrow_ends(state, top), strict=True)):
            length = float(f"{np.linalg.norm(tip - start):.6g}")
            if length > 0.01 * self.diameter:
                # The head is at most 2.5 thicknesses long
                direction = towards[k]
                solid = _arrow_along_x(length, 0.22 * self.diameter)
                side = np.cross(direction, [1.0, 0.0, 0.0] if abs(direction[0]) < 0.9 else [0.0, 1.0, 0.0])
                side /= np.linalg.norm(side)
                frame = np.stack([direction, side, np.cross(direction, side)])
                solid = Surface(start + solid.points @ frame, solid.normals @ frame, solid.triangles)
                parts.append(Solid(f"load {k}", solid, load=float(state.load[k])))
        return parts

    def arrow_ends(self, state: Snapshot, top: float) -> tuple[np.ndarray, np.ndarray]:
        """(Z, 3) starts and tips of the arrows along the lines of contact, begun where these leave the outer ring [mm]."""
        z, centres = len(state.azimuth), self.centres(state)
        towards = self.towards(state)[z:]
        reach = 0.5 * self.outer_diameter + 0.12 * self.diameter
        outward = np.maximum(np.hypot(*towards[:, 1:].T), 0.3)
        start = centres + towards * ((reach - np.hypot(*centres[:, 1:].T)) / outward)[:, None]
        length = _LONGEST * self.diameter * state.load[z:] / max(top, 1e-12)
        return start, start + towards * length[:, None]

    def tips(self, state: Snapshot, top: float) -> np.ndarray:
        """(Z, 3) places beyond the arrows, for their labels [mm]."""
        z = len(state.azimuth)
        length = self.diameter * (0.12 + _LONGEST * state.load[z:] / max(top, 1e-12) + 0.45)
        angle = np.where(np.isfinite(state.angle[z:]), state.angle[z:], self.shape.contact_angle)
        sides = np.repeat([side for side, _ in self.shape.rows], self.shape.ball_count)
        axial = self.centres(state)[:, 0] + sides * np.sin(angle) * length
        reach = 0.5 * self.outer_diameter + length
        return np.asarray(reach[:, None] * _radial(state.azimuth) + axial[:, None] * [1.0, 0.0, 0.0])

    def patches(self, state: Snapshot, races: tuple[str, ...] = ("inner", "outer")) -> list[Solid]:
        """The contact ellipses on the balls, ``widening`` times as large, coloured by Hertz's pressure [MPa]."""
        z, parts, factor = len(state.azimuth), [], self.widening(state)
        towards, centres = self.towards(state), self.centres(state)
        for i in np.flatnonzero(state.load > 0.0):
            k, race = int(i) % z, "inner" if i < z else "outer"
            if race in races:
                along = np.array([0.0, -np.sin(state.azimuth[k]), np.cos(state.azimuth[k])])
                a, b = factor * _MM * state.half[i]
                patch = contact_patch(centres[k], towards[i], along, self.diameter, (a, b), 1e-6 * state.peak[i])
                parts.append(Solid(f"{race} contact {k}", patch, scale="pressure", ball=k))
        return parts

    def widening(self, state: Snapshot) -> int:
        """How many times as large as they are contact ellipses are drawn: in truth they are specks on the balls."""
        widest = _MM * float(state.half[state.load > 0.0].max(initial=0.0))
        return max(int(_WIDEST * self.diameter / widest), 1) if widest > 0.0 else 1

    def towards(self, state: Snapshot) -> np.ndarray:
        """(2 Z, 3) unit vectors from the balls' centres to their contacts."""
        z = len(state.azimuth)
        angle = np.where(np.isfinite(state.angle), state.angle, self.shape.contact_angle)
        sides = np.tile(np.repeat([side for side, _ in self.shape.rows], self.shape.ball_count), 2)
        outward = np.concatenate([-np.ones(z), np.ones(z)])[:, None]
        radial = _radial(np.tile(state.azimuth, 2))
        axial = (sides * np.sin(angle))[:, None] * [1.0, 0.0, 0.0]
        return np.asarray(outward * (axial + np.cos(angle)[:, None] * radial))


def _groove_radius(bearing: Dimensions) -> float:
    """Radius of the circle of inner groove centres [m]."""
    from_balls = (bearing.conformity_inner - 0.5) * bearing.ball_diameter
    return float(0.5 * bearing.pitch_diameter + from_balls * np.cos(bearing.contact_angle))


def _radial(azimuth: np.ndarray) -> np.ndarray:
    return np.stack([np.zeros_like(azimuth), np.cos(azimuth), np.sin(azimuth)], axis=-1)
