"""Grids of surface points on which a ball meets a race, and the compliances of both bodies on them.

Rows run along the groove, columns along the rolling direction.  Ball and race have the same spacing of points, so that
the angles obey d(phi) R_ball = d(alpha) R_groove: the ball's mesh is turned until its row ``anchor`` lies on the race's
row of that number, and the race's mesh, being axisymmetric, is phased to the azimuth of the ball.  Nothing is
interpolated.  Away from the anchor the two rows of a pair drift apart by R_groove / R_ball - 1 of the distance, 4 % of
it: the gap is that of the ball's own point, and the compliance of the race belongs to a place so much off.
"""

from math import ceil, cos, pi
from typing import NamedTuple

import attrs
import numpy as np
from numba import float64, int64, void

from raceway.core.fem.mesh.part_meshes import RingShape
from raceway.core.fem.revolution.body import Revolution, groove_compliance
from raceway.core.fem.revolution.sections import Profile, ball_profile, dofs, graded_profile
from raceway.core.jit import jit
from raceway.core.signatures import MATRIX, VECTOR, record
from raceway.errors import MeshError


class Points(NamedTuple):
    """Of a sphere in a groove: geometry (4,) s, R_g, R_c, R_b, meridian (2, m) cosine and sine of phi, parallel (2, n) of l."""

    geometry: np.ndarray
    meridian: np.ndarray
    parallel: np.ndarray


_POINTS = record(Points, VECTOR, MATRIX, MATRIX)


@jit(void(float64, float64, _POINTS, MATRIX))
def sphere_in_torus(axial, radial, points, gap):  # type: ignore[no-untyped-def]
    """gap (m, n) [m] of every point of a sphere, exactly.

    With D = (axial, radial) the place of the ball's centre seen from the groove's centre in the ball's meridian plane, a
    point at angle phi and latitude l lies at

        radial  R = R_c + D_r + s R_b cos(l) cos(phi),   rolling  y = R_b sin(l),   axial  z = D_a + s R_b cos(l) sin(phi)

    and its gap is g = R_g - rho with rho = hypot(hypot(R, y) - R_c, z); s = -1 on the inner race, 1 on the outer one.
    """
    geometry, meridian, parallel = points
    sense, groove, circle, ball = geometry[0], geometry[1], geometry[2], geometry[3]
    for i in range(parallel.shape[1]):
        size = sense * ball * parallel[0, i]
        y = ball * parallel[1, i]
        for k in range(meridian.shape[1]):
            away = circle + radial + size * meridian[0, k]
            z = axial + size * meridian[1, k]
            u = np.sqrt(away * away + y * y) - circle
            gap[k, i] = groove - np.sqrt(u * u + z * z)


@jit(void(float64, float64, _POINTS, int64[::1], VECTOR, MATRIX, VECTOR))
def derivatives(axial, radial, points, nodes, load, slope, curvature):  # type: ignore[no-untyped-def]
    """slope (n, 2): derivatives of chosen points' gaps by D; curvature (3,): aa, ar, rr of sum(load * second derivatives).

    nodes : (n,) numbers k * columns + i;  load : (n,)
    """
    geometry, meridian, parallel = points
    sense, circle, ball = geometry[0], geometry[2], geometry[3]
    columns = parallel.shape[1]
    curvature[0], curvature[1], curvature[2] = 0.0, 0.0, 0.0
    for n in range(nodes.size):
        k, i = nodes[n] // columns, nodes[n] % columns
        size = sense * ball * parallel[0, i]
        y = ball * parallel[1, i]
        away = circle + radial + size * meridian[0, k]
        z = axial + size * meridian[1, k]
        reach = np.sqrt(away * away + y * y)
        u = reach - circle
        rho = np.sqrt(u * u + z * z)
        lean = away / reach
        slope[n, 0] = -z / rho
        slope[n, 1] = -u / rho * lean
        w = load[n] / rho
        curvature[0] -= w * (1.0 - z * z / (rho * rho))
        curvature[1] += w * z * u / (rho * rho) * lean
        curvature[2] -= w * ((1.0 - u * u / (rho * rho)) * lean * lean + u * y * y / (reach * reach * reach))


@attrs.frozen
class Spacing:
    """Distances of the surface points."""

    #: along, across : along the groove and along the rolling direction [m]
    along: float
    across: float
    ball_divisions: int  # points around the ball's equator
    columns: int  # points on each side of the middle one, along the rolling direction

    @property
    def area(self) -> float:
        """Of one point [m2]."""
        return self.along * self.across

    @classmethod
    def of(cls, semi_axes: tuple[float, float], nodes: float, radius: float, widest: float) -> "Spacing":
        """Spacing of ``nodes`` points per semi-axis.

        semi_axes : major and minor one at the load that counts [m];  radius : of the ball [m]
        widest : largest minor semi-axis that has to fit, with margin [m]

        MeshError: An ellipse so long that no two points lie around the ball's equator: it is no contact of this ball.
        """
        divisions = round(2.0 * pi * radius / (semi_axes[0] / nodes))
        if divisions < 2:
            size = f"{1e3 * semi_axes[0]:.3g} mm, of a ball of {2e3 * radius:.3g} mm"
            raise MeshError(f"a contact's major semi-axis is {size}: it reaches around the ball")
        divisions += divisions % 2  # the opposite pole is a point too
        across = float(semi_axes[1]) / nodes
        return cls(2.0 * pi * radius / divisions, across, divisions, ceil(widest / across))

    def holding(self, widest: float) -> "Spacing":
        """The same distances, with points for a minor semi-axis with margin [m]."""
        return attrs.evolve(self, columns=max(self.columns, ceil(widest / self.across)))


@attrs.frozen(eq=False)
class _Race:
    """A race's surface points and its compliance, seen from any ball."""

    sense: float  # -1 inner, 1 outer
    #: groove, centre_radius : radius of the groove, and of the circle of its centres [m]
    groove: float
    centre_radius: float
    angle: np.ndarray  # (m,) contact angles of the rows [rad], increasing
    #: (columns, m, m) displacement of a row by a force on another one, so many columns apart, both along the normal, less
    #: n.M n' of ``crossing`` [m/N]
    compliance: np.ndarray
    across: float  # distance of neighbouring columns [m]
    edges: tuple[float, float]  # (2,) contact angles of the groove's edges [rad], ascending
    #: (Z, 2, 2) displacement (axial, radial) of the groove's centre by a force (axial, radial) on the groove under the k-th
    #: next ball [m/N]; row 0: the part of what the ball itself moves it by that is not in ``compliance``
    crossing: np.ndarray
    shear: np.ndarray | None = None  # like ``compliance``, both along the groove; None without friction

    @property
    def name(self) -> str:
        return "inner" if self.sense < 0.0 else "outer"

    @property
    def anchor(self) -> int:
        """The row on which a row of the ball lies exactly."""
        return len(self.angle) // 2

    @property
    def ends(self) -> tuple[bool, bool]:
        """Whether the first and the last row are the last ones before the groove's edges."""
        reach = 1.5 * (self.angle[1] - self.angle[0])  # rows end half a step before the edge
        return bool(self.angle[0] - reach < self.edges[0]), bool(self.angle[-1] + reach > self.edges[1])


@attrs.frozen(eq=False)
class _Ball:
    """The ball's surface points and its compliance, about its centre of mass."""

    radius: float  # [m]
    latitude: np.ndarray  # (columns,) of the points along the rolling direction [rad], symmetric about 0
    #: (rows, columns, columns) displacement of a column by a force on another one, so many rows apart, both along the normal
    #: [m/N]
    compliance: np.ndarray
    opposite: float  # displacement at a contact by a force at the opposite pole, along the normals [m/N]
    #: like ``compliance``, both along the rows' direction, that of the groove; None without friction
    shear: np.ndarray | None = None


@attrs.frozen(eq=False)
class Patch:
    """One ball on one race: both grids together."""

    ball: _Ball
    race: _Race
    area: float  # of a surface point [m2]
    phi: np.ndarray = attrs.field(init=False)  # (m,) angle of every row on the ball [rad]
    points: Points = attrs.field(init=False)  # for kernels

    @phi.default
    def _phi(self) -> np.ndarray:
        race = self.race
        middle = race.angle[race.anchor]
        return middle + (race.angle - middle) * race.groove / self.ball.radius

    @points.default
    def _points(self) -> Points:
        race, ball = self.race, self.ball
        geometry = np.array([race.sense, race.groove, race.centre_radius, ball.radius], dtype=float)
        meridian, parallel = (np.ascontiguousarray([np.cos(x), np.sin(x)]) for x in (self.phi, ball.latitude))
        return Points(geometry, meridian, parallel)

    @property
    def rows(self) -> int:
        return len(self.phi)

    @property
    def columns(self) -> int:
        return len(self.ball.latitude)


@attrs.frozen
class Solid:
    """Material and element formulation of a body."""

    #: young, poisson, formulation : [Pa, -], see ``raceway.core.fem.revolution.body``; between points of a contact "full"
    #: converges faster than "incompatible" (at 4 points along a semi-axis the peak pressure is 0.4 % low, not 0.7 %)
    young: float
    poisson: float
    formulation: str = "full"
    bulk: float = 0.8e-3  # size of elements far from the contacts [m]


@attrs.frozen
class RingBody:
    """One ring of a row.

    shape, solid
    """

    shape: RingShape
    solid: Solid
    seat: str | float  # "clamped" or the stiffness of a bed [N/m3]
    window: tuple[float, float]  # (2,) contact angles between which it has surface points [rad]


def make_patch(ring: RingBody, ball: _Ball, spacing: Spacing, balls: int) -> Patch:
    """The patch of a ring for a ball, ``balls`` in a row; compliances along the groove where the ball has them.

    MeshError: A section that cannot be meshed, a window beyond the groove.
    """
    shape, sense = ring.shape, ring.shape.sign
    middle = 0.5 * (ring.window[0] + ring.window[1])
    finest = min(spacing.along, spacing.across)
    section = graded_profile(shape, spacing.along, ring.window, finest, ring.solid.bulk)
    # Points around a race so that they lie ``across`` [m] apart at a contact angle; a multiple of the balls.
    circle = 2.0 * pi * (shape.centre_r + sense * shape.groove * cos(middle))
    count = balls * max(round(circle / spacing.across / balls), 1)
    columns, rows = 2 * spacing.columns + 1, len(section.race)
    neighbours = np.arange(1, balls // 2 + 1) * (count // balls)
    steps = np.concatenate([np.arange(columns), neighbours])
    load = dofs(section.race)
    label = f"{'inner' if sense < 0.0 else 'outer'} ring, {count} x {len(section.quads)} elements, {rows} rows of points"
    solid = ring.solid
    body = Revolution(section, count, solid.young, solid.poisson, formulation=solid.formulation, seat=ring.seat)
    full = body.cached_compliance(label, load, load, steps)
    normal = np.array([np.cos(section.angles), np.sin(section.angles)])  # radial, axial
    near = _projection(full[:columns], normal)
    along = np.array([-normal[1], normal[0]])
    shear = None if ball.shear is None else _projection(full[:columns], along)
    between = np.moveaxis(_projection(full[columns:], normal), 0, 2)
    low, high = shape.edges
    edges = (low, high) if sense > 0.0 else (-high, -low)
    crossing = np.zeros((balls, 2, 2))
    for k, block in enumerate(groove_compliance(section.angles, between, np.ones(rows)), start=1):
        crossing[k] = crossing[-k] = block[[0, 1, 1, 2]].reshape(2, 2)
    # What the ball itself moves its groove by is as exact as a vector, too, and not along each point's normal: any part of it
    # that leaves the points' own compliance positive will do.
    crossing[0] = crossing[1]
    along_axis = normal[::-1]
    near = np.ascontiguousarray(near - along_axis.T @ crossing[0] @ along_axis)
    race = _Race(sense, shape.groove, shape.centre_r, section.angles, near, spacing.across, edges, crossing, shear)
    return Patch(ball, race, spacing.area)


#: Digits kept of the mesh's dimensionless sizes, so that equal balls of unequal size find the same entry.
_DIGITS = 9


@attrs.frozen(eq=False)
class _FreeBall:
    """Compliance of a floating ball between points near its equator.

    A displacement u of a ball of radius R and Young's modulus E under a force F is c F / (E R), where c belongs to radius 1
    and modulus 1. Rigid motions stand apart: c gives displacements relative to the mean motion of the ball's masses ("ball
    centre"), under loads balanced by uniform acceleration, which for the ball's own balanced contacts is no load at all.
    """

    latitudes: np.ndarray  # (n,) of the surface nodes [rad], towards the rolling direction
    dimensionless: np.ndarray  # (o, len(components) n, len(components) n) u E R / F, components one after the other

    def compliance(self, radius: float, young: float) -> np.ndarray:
        """(o, observed, loads) of a ball of that radius [m] and modulus [Pa], in m/N."""
        return np.asarray(self.dimensionless / (radius * young))


@attrs.frozen
class BallElements:
    """Sizes of a ball's elements."""

    divisions: int  # sectors around the equator
    #: lateral_step, half_width : distance of the nodes along the rolling direction, and up to where, as arc lengths [m]
    lateral_step: float
    half_width: float
    #: depth_step, bulk : first layer below the surface, and elements far from it [m]
    depth_step: float
    bulk: float

    def profile(self, radius: float) -> Profile:
        """The section of a ball of radius 1 with the sizes of a ball of that radius [m]."""
        sizes = (self.lateral_step, self.half_width, self.depth_step, self.bulk)
        return ball_profile(1.0, *(round(length / radius, _DIGITS) for length in sizes))


def free_ball(
    radius: float, poisson: float, mesh: BallElements, offsets: np.ndarray, components: tuple[int, ...] = (0, 2),
    formulation: str = "incompatible", harmonics: str = "all",
) -> _FreeBall:  # fmt: skip
    """The floating ball of a radius [m], from the cache where it is there.

    offsets : (o,) sectors from the loaded to the observed meridian; the opposite pole lies divisions / 2 away
    components : 0 r (outward), 1 theta, 2 x (rolling direction)
    harmonics : a ball has but some hundred, and it is coarsest around its equator, where sampling is least exact
    """
    profile = mesh.profile(radius)
    degrees = dofs(profile.race, components)
    body = Revolution(profile, mesh.divisions, 1.0, poisson, formulation=formulation, seat="free")
    label = f"ball, {mesh.divisions} x {len(profile.quads)} elements, Poisson's ratio {poisson:g}"
    return _FreeBall(profile.angles, body.cached_compliance(label, degrees, degrees, np.asarray(offsets), harmonics))


def make_ball(radius: float, solid: Solid, spacing: Spacing, rows: int, shear: bool = False) -> _Ball:
    """The floating ball on a grid of so many rows; ``shear``: with its compliance along the rows' direction, for friction."""
    steps = np.append(np.arange(rows), spacing.ball_divisions // 2)
    finest = min(spacing.along, spacing.across)

    half_width = (spacing.columns - 0.5) * spacing.across
    mesh = BallElements(spacing.ball_divisions, spacing.across, half_width, finest, solid.bulk)
    along_normal = free_ball(radius, solid.poisson, mesh, steps, (0, 2), solid.formulation)
    assert len(along_normal.latitudes) == 2 * spacing.columns + 1
    normal = np.array([np.cos(along_normal.latitudes), np.sin(along_normal.latitudes)])
    near = _projection(along_normal.compliance(radius, solid.young), normal)
    middle = len(along_normal.latitudes) // 2
    opposite, around = float(near[-1, middle, middle]), None
    if shear:
        rolling = free_ball(radius, solid.poisson, mesh, steps, (1,), solid.formulation)
        around = np.ascontiguousarray(rolling.compliance(radius, solid.young)[:-1])
    return _Ball(radius, along_normal.latitudes, np.ascontiguousarray(near[:-1]), opposite, around)


def _projection(full: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(o, n, n) along directions normal (2, n), from (o, 2 n, 2 n) of two components."""
    n = normal.shape[1]
    parts = np.asarray(full).reshape(len(full), 2, n, 2, n)
    return np.ascontiguousarray(np.einsum("ci,ocidj,dj->oij", normal, parts, normal, optimize=True))
