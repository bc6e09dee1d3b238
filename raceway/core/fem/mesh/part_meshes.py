"""Structured meshes of one ring and of one ball.

A ring is a solid of revolution: profile with the true groove arc, shoulders and bore, swept uniformly in azimuth.  The profile is one mapped block: lines along the surface of lands and groove, from side face to side face, times layers
from there to the seat (bore, or outer cylinder).  x is the axis of the bearing, the azimuth runs from +y to +z.

A ball is a cubed sphere: a rounded inner cube and six blocks from its faces to the surface.  Its local axes: u along the rolling
direction, v across the raceway, w through both contacts; +w is the outer one.
"""

from math import acos, asin, cos, pi, sin, sqrt
from typing import Any

import attrs
import numpy as np

from raceway.core.fem.mesh.hex_mesh import HexMesh, nodes_of
from raceway.core.fem.mesh.ring_section import Outline, polygon_outline
from raceway.errors import MeshError
from raceway.storage.tables import Tables


@attrs.frozen
class RingShape:
    """Profile of a ring, lengths in metres."""

    inner: bool  # whether it is the inner ring (groove on its outside)
    #: seat, land : radius of bore or outer cylinder, and of the shoulders
    seat: float
    land: float
    width: float  # between the side faces at -width/2 and width/2
    groove: float  # radius of the groove
    #: centre_x, centre_r : axial place and radius of the circle of groove centres
    centre_x: float
    centre_r: float
    contact: float  # angle from the groove's radial direction to the free contact [rad], along increasing x
    #: what a user's polygon gives in place of seat, land and width; these three are then its extremes
    profile: Outline | None = None

    def __attrs_post_init__(self) -> None:
        name = "inner ring" if self.inner else "outer ring"
        if self.profile is None:
            over = self.sign * (self.land - self.centre_r)
            if not 0.0 < over < self.groove:
                raise MeshError(
                    f"{name}: the shoulder at radius {1e3 * self.land:.4g} mm does not cut the groove between its bottom and its "
                    "centre: change `bearing.shoulder_height`"
                )
            half = self.groove * sin(self.edge)
            if abs(self.centre_x) + half >= 0.5 * self.width:
                raise MeshError(
                    f"{name}: a width of {1e3 * self.width:.4g} mm does not hold the groove, which reaches to "
                    f"{1e3 * (abs(self.centre_x) + half):.4g} mm from its middle: give a larger `bearing.width`"
                )
        if self.wall <= 0.0:
            raise MeshError(f"{name}: no wall is left below the groove ({1e3 * self.wall:.4g} mm)")
        low, high = self.edges
        if not low < self.contact < high:
            raise MeshError(
                f"{name}: the contact angle of {abs(self.contact) * 180 / pi:.3g} deg lies outside the groove, which ends at "
                f"{-low * 180 / pi:.3g} and {high * 180 / pi:.3g} deg: give a larger `bearing.shoulder_height`"
            )

    @property
    def sign(self) -> float:
        """-1 for the inner ring, whose groove bottom lies below its centre, 1 for the outer one."""
        return -1.0 if self.inner else 1.0

    @property
    def edge(self) -> float:
        """Angle from the groove's bottom to its edge, of unequal shoulders to the lower one's [rad]."""
        if self.profile is not None:
            return min(-self.profile.edges[0], self.profile.edges[1])
        return acos(self.sign * (self.land - self.centre_r) / self.groove)

    @property
    def edges(self) -> tuple[float, float]:
        """Angles of the groove's edges at smaller and larger x [rad]."""
        return self.outline.edges

    @property
    def outline(self) -> Outline:
        """The section without its groove."""
        if self.profile is not None:
            return self.profile
        reach = self.groove * sin(self.edge)
        # A hollow cylinder: radii of seat and land, width between its faces, and the groove's ends on the land [m].
        half, land = 0.5 * self.width, self.land
        before = np.array([[-half, land], [self.centre_x - reach, land]])
        beyond = np.array([[self.centre_x + reach, land], [half, land]])
        return Outline(before, beyond, np.array([[-half, self.seat], [half, self.seat]]), (-self.edge, self.edge))

    @property
    def wall(self) -> float:
        """Least thickness under the groove [m]; plain rings: under its bottom."""
        if self.profile is None:
            return self.sign * (self.seat - (self.centre_r + self.sign * self.groove))
        x, r = self.surface(np.linspace(*self.profile.edges, 181)).T
        return float((self.sign * (np.interp(x, *self.profile.seat.T) - r)).min())

    @property
    def thickness(self) -> float:
        """Thickness at the shoulders [m]."""
        return abs(self.seat - self.land)

    @property
    def volume(self) -> float:
        """Exact volume [m3]: hollow cylinder less the groove's circular segment (Pappus)."""
        if self.profile is not None:
            return self.moments[0]
        away = abs(self.centre_r - self.land)
        half = sqrt(self.groove**2 - away**2)
        area = self.groove**2 * asin(half / self.groove) - half * away
        radius = self.centre_r + self.sign * 2.0 * half**3 / (3.0 * area)
        tube = pi * abs(self.land**2 - self.seat**2) * self.width
        return tube - 2.0 * pi * radius * area

    @property
    def moments(self) -> tuple[float, float, float]:
        """Volume [m3], and the integrals of r^2 / 2 + x^2 and r^2 over it [m5]: inertia about y and x over density."""
        at, weights = np.polynomial.legendre.leggauss(48)
        out = np.zeros(3)

        def add(x: np.ndarray, r: np.ndarray, slope: np.ndarray, side: float) -> None:
            # Between the axis and the line, so that the section is the difference of its two lines.
            for k, part in enumerate((r**2, r**4 / 4.0 + x**2 * r**2, r**4 / 2.0)):
                out[k] += side * pi * float(weights @ (part * slope))

        def along(line: np.ndarray, side: float) -> None:
            for a, b in zip(line[:-1], line[1:], strict=True):
                half = 0.5 * (b - a)
                point = 0.5 * (a + b) + at[:, None] * half
                add(point[:, 0], point[:, 1], np.full(len(at), half[0]), side)

        outline, race = self.outline, -self.sign
        along(outline.seat, -race)
        along(outline.left, race)
        along(outline.right, race)
        low, high = outline.edges
        angle = 0.5 * (low + high) + 0.5 * (high - low) * at
        x, r = self.surface(angle).T
        add(x, r, 0.5 * (high - low) * self.groove * np.cos(angle), race)
        return float(out[0]), float(out[1]), float(out[2])

    def surface(self, angles: np.ndarray) -> np.ndarray:
        """(n, 2) x and radius of points of the groove, angle from its bottom towards +x [rad]."""
        return np.column_stack(
            [self.centre_x + self.groove * np.sin(angles), self.centre_r + self.sign * self.groove * np.cos(angles)]
        )


def ring_mesh(
    shape: RingShape, left: np.ndarray, arc: np.ndarray, right: np.ndarray, layers: np.ndarray, azimuths: np.ndarray,
    band: tuple[float, float] | None = None,
) -> HexMesh:  # fmt: skip
    """The swept mesh.

    left, right : (n,) points 0 to 1 on the lands, left from the side face to the groove, right from the groove
    arc : (n,) angles of points on the groove [rad], from edge to edge
    layers : (n,) points 0 to 1 from the raceway to the seat
    azimuths : (n,) of the nodes around the ring, ascending within one turn [rad]
    band : angles between which facets belong to the set "band", the refined zone of the raceway

    Sets of facets and of nodes: raceway, band, land, seat, face_negative, face_positive.
    """
    divisions = len(azimuths)
    if divisions < 3:
        raise MeshError(f"a ring needs at least 3 cells around it, not {divisions}")
    outline = shape.outline
    top = np.concatenate([outline.top("left", left)[:-1], shape.surface(arc), outline.top("right", right)[1:]])
    seat = np.interp(top[:, 0], *outline.seat.T)
    ni, nj = len(top), len(layers)
    # Radius outward with j: the inner ring's layers begin at its bore.
    depth = 1.0 - layers[::-1] if shape.inner else layers
    inside, outside = (seat, top[:, 1]) if shape.inner else (top[:, 1], seat)
    radius = inside[None, :] + depth[:, None] * (outside - inside)[None, :]
    psi = np.asarray(azimuths)
    x = np.broadcast_to(top[:, 0], (divisions, nj, ni))
    points = np.stack([x, np.cos(psi)[:, None, None] * radius, np.sin(psi)[:, None, None] * radius], axis=-1)
    k, j, i = np.meshgrid(np.arange(divisions), np.arange(nj - 1), np.arange(ni - 1), indexing="ij")
    near, far = (k * nj + j) * ni + i, ((k + 1) % divisions * nj + j) * ni + i
    cells = np.stack([n + o for n in (near, far) for o in (0, 1, ni + 1, ni)], axis=-1).reshape(-1, 8)
    facets = _facets(shape.inner, (ni, nj, divisions), (len(left) - 1, len(right) - 1), arc, band)
    return HexMesh(points.reshape(-1, 3), cells, {name: nodes_of(cells, f) for name, f in facets.items()}, facets)


def _facets(
    inner: bool, nodes: tuple[int, int, int], ends: tuple[int, int], arc: np.ndarray, band: tuple[float, float] | None
) -> dict[str, np.ndarray]:
    """Facets of the named surfaces; local faces: 2 towards the axis, 4 away from it, 5 at -x, 3 at +x.

    nodes : along the axis, across the wall and around;  ends : cells of the two lands beside the groove
    arc : (i,) places along the groove;  band : part of them that may touch
    """
    (ni, nj, nk), (left, right) = nodes, ends
    number = np.arange(nk * (nj - 1) * (ni - 1)).reshape(nk, nj - 1, ni - 1)
    raceway, seat = (number[:, -1], number[:, 0]) if inner else (number[:, 0], number[:, -1])
    up, down = (4, 2) if inner else (2, 4)

    def facets(cells: np.ndarray, face: int) -> np.ndarray:
        return np.column_stack([cells.ravel(), np.full(cells.size, face)])

    groove = raceway[:, left : ni - 1 - right]
    out = {
        "raceway": facets(groove, up),
        "land": facets(np.concatenate([raceway[:, :left], raceway[:, ni - 1 - right :]], axis=1), up),
        "seat": facets(seat, down),
        "face_negative": facets(number[:, :, 0], 5),
        "face_positive": facets(number[:, :, -1], 3),
    }
    if band is not None:
        middle = 0.5 * (arc[1:] + arc[:-1])
        out["band"] = facets(groove[:, (middle > band[0]) & (middle < band[1])], up)
    return out


def ring_shape(bearing: Any, inner: bool) -> RingShape:
    """Profile of a ring of a row with side +1, from the dimensions of the scene's [bearing] table.

    MeshError: Dimensions that are missing, or that do not fit together.
    """
    key = "inner_profile" if inner else "outer_profile"
    if getattr(bearing, key, None) is not None:
        # A ring whose section the user gives.
        groove = _groove_arc(bearing, inner)
        outline = polygon_outline(
            f"bearing.{key}", getattr(bearing, key), inner, groove["groove"], groove["centre_x"], groove["centre_r"]
        )
        radii, lands = outline.seat[:, 1], np.r_[outline.left[-1, 1], outline.right[0, 1]]
        seat, land = (radii.min(), lands.max()) if inner else (radii.max(), lands.min())
        word, diameter = ("bore", bearing.bore) if inner else ("outer_diameter", bearing.outer_diameter)
        if diameter is not None and abs(2.0 * seat - diameter) > 1e-6 * diameter:
            raise MeshError(
                f"`bearing.{key}` has a seat diameter of {2.0 * seat:g} m, `bearing.{word}` = {diameter:g} m: give the same"
            )
        width = float(outline.seat[-1, 0] - outline.seat[0, 0])
        return RingShape(inner, float(seat), float(land), width, **groove, profile=outline)
    for key in ("bore", "outer_diameter", "width"):
        if getattr(bearing, key, None) is None:
            raise MeshError.at(f"bearing.{key}", None, "is missing: rings of hexahedra need bore, outer_diameter and width")
    middle, depth = 0.5 * bearing.pitch_diameter, bearing.shoulder_height or 0.2 * bearing.ball_diameter
    seat = 0.5 * (bearing.bore if inner else bearing.outer_diameter)
    land = middle + (-1.0 if inner else 1.0) * (0.5 * bearing.ball_diameter - depth)
    return RingShape(inner=inner, seat=seat, land=land, width=bearing.width, **_groove_arc(bearing, inner))


def _groove_arc(bearing: Any, inner: bool) -> Tables:
    alpha, sense = bearing.contact_angle, 1.0 if inner else -1.0
    conformity = bearing.conformity_inner if inner else bearing.conformity_outer
    offset = sense * (conformity - 0.5) * bearing.ball_diameter
    return {
        "groove": conformity * bearing.ball_diameter,
        "centre_x": offset * sin(alpha),
        "centre_r": 0.5 * bearing.pitch_diameter + offset * cos(alpha),
        "contact": -sense * alpha,
    }


#: Half the inner cube's width over the ball's radius, and how far its faces bulge (0: flat, 1: a sphere): the largest
#: smallest scaled Jacobian of uniform balls among those tried (0.4 to 0.65, 0 to 0.8).
CUBE, BULGE = 0.5, 0.5


def ball_mesh(
    radius: float, u: np.ndarray, v: np.ndarray, w: np.ndarray, layers: np.ndarray, patch: tuple[float, float] | None = None
) -> HexMesh:
    """A ball about the origin.

    u, v, w : (n,) points from -1 to 1: lines of the cube, at equal angles where equally spaced
    layers : (n,) points 0 to 1 from the inner cube to the surface
    patch : semi-axes (along u, along v) [m] of the facets that belong to "inner_patch" (-w) and "outer_patch" (+w)

    Sets of facets and of nodes: surface, inner_patch, outer_patch; set of nodes: centre (the node nearest to it).
    """
    nu, nv, nw = len(u), len(v), len(w)
    grid = np.stack(np.meshgrid(u, v, w, indexing="ij"), axis=-1)
    lattice = np.tan(0.25 * np.pi * grid)
    core = CUBE * radius * _rounded(lattice)
    number = np.arange(nu * nv * nw).reshape(nu, nv, nw)
    edge = np.ones((nu, nv, nw), dtype=bool)
    edge[1:-1, 1:-1, 1:-1] = False
    skin = number[edge]
    rank = np.full(number.size, -1)
    rank[skin] = np.arange(len(skin))
    direction = lattice[edge]
    outside = radius * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    base = core[edge]
    shell = base[None] + layers[1:, None, None] * (outside - base)[None]
    points = np.concatenate([core.reshape(-1, 3), shell.reshape(-1, 3)])

    i, j, k = np.meshgrid(np.arange(nu - 1), np.arange(nv - 1), np.arange(nw - 1), indexing="ij")
    around = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    cube = np.stack([number[i + a, j + b, k + c] for a, b, c in around], axis=-1).reshape(-1, 8)
    # Lattice nodes of the cube's surface quadrilaterals, anticlockwise seen from outside.
    sides = []
    for axis in range(3):
        for end, flip in ((0, True), (-1, False)):
            # Axes in cyclic order, so that (first, second, normal) is right-handed.
            face = np.moveaxis(number, axis, 0)[end]
            face = face.T if axis == 1 else face
            quad = [face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]]
            sides.append(np.stack(quad[::-1] if flip else quad, axis=-1).reshape(-1, 4))
    quads = rank[np.concatenate(sides)]
    blocks = []
    for layer in range(len(layers) - 1):
        below = skin[quads] if layer == 0 else number.size + (layer - 1) * len(skin) + quads
        blocks.append(np.hstack([below, number.size + layer * len(skin) + quads]))
    cells = np.concatenate([cube, *blocks])
    first = len(cells) - len(quads)
    facets = {"surface": np.column_stack([np.arange(first, len(cells)), np.ones(len(quads), dtype=int)])}
    if patch is not None:
        middle = outside[quads].mean(axis=1)
        inside = (middle[:, 0] / patch[0]) ** 2 + (middle[:, 1] / patch[1]) ** 2 < 1.0
        for name, side in (("inner_patch", -1.0), ("outer_patch", 1.0)):
            facets[name] = facets["surface"][inside & (side * middle[:, 2] > 0.0)]
    nodes = {name: nodes_of(cells, f) for name, f in facets.items()}
    nodes["centre"] = np.array([np.argmin((core.reshape(-1, 3) ** 2).sum(axis=1))])
    return HexMesh(points, cells, nodes, facets)


def ball_cells(nu: int, nv: int, nw: int, layers: int) -> int:
    """Number of cells of a ball with that many cells along u, v, w and outward."""
    return nu * nv * nw + 2 * layers * (nu * nv + nv * nw + nw * nu)


def _rounded(p: np.ndarray) -> np.ndarray:
    """Points of the cube [-1, 1]^3 moved part of the way to where the smooth map of cube to ball takes them."""
    s = p * p
    out = np.empty_like(p)
    for a in range(3):
        b, c = s[..., (a + 1) % 3], s[..., (a + 2) % 3]
        out[..., a] = p[..., a] * ((1.0 - BULGE) + BULGE * np.sqrt(1.0 - 0.5 * (b + c) + b * c / 3.0))
    return out
