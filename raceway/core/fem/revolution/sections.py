"""The section of a body of revolution: quadrilaterals in the half plane of radius and axis."""

from math import ceil, floor

import attrs
import numpy as np

from raceway.core.fem.mesh.hex_mesh import floats, growing, integers
from raceway.core.fem.mesh.part_meshes import RingShape
from raceway.errors import MeshError


@attrs.frozen(eq=False)
class Profile:
    """Nodes and quadrilaterals of a section."""

    points: np.ndarray = attrs.field(converter=floats)  # (N, 2) float, radius r > 0 and place x along the axis [m]
    quads: np.ndarray = attrs.field(converter=integers)  # (M, 4) int, turned on input so that their nodes run from +x to +r
    race: np.ndarray = attrs.field(converter=integers)  # (n,) int, nodes of the loaded surface in the order of ``angles``
    #: (k,) int, nodes of the bore or the outer cylinder, in their order along x; empty for a ball
    seat: np.ndarray = attrs.field(converter=integers)
    #: (n,) float [rad], ascending.  Of a ring: contact angles, so that race node i lies at r = centre_r + sign groove
    #: cos(angle), x = centre_x + sign groove sin(angle), with sign -1 for the inner ring and 1 for the outer one, and the
    #: bearing's free contact angle is positive.  Of a ball: latitudes, x = R sin, r = R cos
    angles: np.ndarray = attrs.field(converter=floats)
    depth: int = 1  # nodes of each line from the surface into the body: node ``race[i] + k``, k < depth, lies k layers below

    def __attrs_post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or self.quads.ndim != 2 or self.quads.shape[1] != 4:
            raise MeshError(f"a profile has points (N, 2) and quads (M, 4), not {self.points.shape} and {self.quads.shape}")
        if not np.isfinite(self.points).all() or self.points[:, 0].min() <= 0.0:
            raise MeshError("a profile's points must be finite and lie off the axis (radius above 0)")
        if len(self.angles) != len(self.race):
            raise MeshError(f"{len(self.race)} race nodes with {len(self.angles)} angles")
        r, x = self.points[self.quads, 0], self.points[self.quads, 1]
        area = (x[:, 2] - x[:, 0]) * (r[:, 3] - r[:, 1]) - (r[:, 2] - r[:, 0]) * (x[:, 3] - x[:, 1])
        anticlockwise = self.quads[:, ::-1] if area.sum() < 0.0 else self.quads
        object.__setattr__(self, "quads", np.ascontiguousarray(anticlockwise))
        corner = _corner_areas(self.points, anticlockwise)
        if not (corner > 0.0).all():
            bad = int(np.argmin(corner.min(axis=1)))
            at = self.points[self.quads[bad]].mean(axis=0)
            raise MeshError(
                f"the profile folds over itself at r = {1e3 * at[0]:.4g} mm, x = {1e3 * at[1]:.4g} mm: the wall is too thin or "
                "its outline too jagged for a mesh of quadrilaterals there"
            )


def _corner_areas(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """(M, 4) Cross products of the edges that meet at each corner [m2]: positive where the corner is convex."""
    p = points[quads]
    onward, back = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    area = onward[..., 1] * back[..., 0] - onward[..., 0] * back[..., 1]
    # Quadrilaterals that all run the other way are as good: the profile turns them.
    return np.asarray(area if area.sum() > 0.0 else -area)


def dofs(nodes: np.ndarray, components: tuple[int, ...] = (0, 2)) -> np.ndarray:
    """(len(components) n, 2) degrees of freedom (node, component), one component after the other: 0 r, 1 theta, 2 x."""
    nodes = np.asarray(nodes, dtype=np.int64)
    return np.concatenate([np.column_stack([nodes, np.full(len(nodes), c)]) for c in components])


def _map_between(top: np.ndarray, bottom: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A block of quadrilaterals between two lines.

    top, bottom : (m, 2) ends of the lines into the body [m];  depth : (k,) from 0 to 1
    Returns points : (m k, 2), line after line, each from top to bottom
    quads : ((m - 1) (k - 1), 4)
    """
    lines, rows = len(top), len(depth)
    points = top[:, None] * (1.0 - depth)[None, :, None] + bottom[:, None] * depth[None, :, None]
    first = (np.arange(lines - 1)[:, None] * rows + np.arange(rows - 1)).ravel()
    return points.reshape(-1, 2), np.stack([first, first + rows, first + rows + 1, first + 1], axis=1)


#: Ratio of neighbouring elements between the fine zone and the bulk.
GROWTH = 1.25
#: Sizes of the coarse section [m]: bulk and surface of the groove.
BULK, SURFACE = 2e-3, 0.25e-3
#: Lines into the ring follow the groove's normals (1), which shoulders of some outlines forbid, or stand upright (0).
_LEANS = (1.0, 0.5, 0.0)


def graded_profile(
    shape: RingShape, arc_step: float, window: tuple[float, float], depth_step: float, bulk: float, growth: float = GROWTH
) -> Profile:
    """A section that is fine around a contact.

    arc_step : distance of the race's nodes along the groove [m]; one of them lies at the free contact angle
    window : lowest and highest contact angle of the nodes in ``race`` [rad], positive at the free contact angle; what runs over
        the groove's edge is left out
    depth_step, bulk : size of the first layer below the surface and of the elements far from it [m]
    growth : ratio of neighbouring elements
    """
    contact, step = shape.sign * shape.contact, arc_step / shape.groove
    edges = _contact_edges(shape)
    low, high = max(window[0], edges[0] + 0.5 * step), min(window[1], edges[1] - 0.5 * step)
    if not low < high:
        raise MeshError(
            f"the contact window of {np.rad2deg(window[0]):.4g} to {np.rad2deg(window[1]):.4g} deg lies outside the groove, "
            f"which ends at {np.rad2deg(edges[0]):.4g} and {np.rad2deg(edges[1]):.4g} deg"
        )
    first, last = ceil((low - contact) / step - 1e-9), floor((high - contact) / step + 1e-9)
    if last - first < 1:
        why = f"a step of {1e3 * arc_step:.4g} mm along the groove leaves fewer than two nodes in the contact window: use a smaller one"
        raise MeshError(why)
    zone = contact + step * np.arange(first, last + 1)
    coarse = bulk / shape.groove
    below = zone[0] - growing(zone[0] - edges[0], min(growth * step, coarse), coarse, growth)[:0:-1]
    above = zone[-1] + growing(edges[1] - zone[-1], min(growth * step, coarse), coarse, growth)[1:]
    angles = np.concatenate([below, zone, above])
    return _profile(shape, angles, slice(len(below), len(below) + len(zone)), depth_step, bulk, growth)


def coarse_profile(shape: RingShape, bulk: float = BULK, surface: float = SURFACE, growth: float = GROWTH) -> Profile:
    """A section with elements of ``surface`` [m] all over the groove, growing to ``bulk`` [m]; ``race`` is the full groove."""
    low, high = _contact_edges(shape)
    cells = max(ceil((high - low) * shape.groove / min(surface, bulk) - 1e-9), 2)
    angles = np.linspace(low, high, cells + 1)
    return _profile(shape, angles, slice(0, len(angles)), min(surface, bulk), bulk, growth)


def _contact_edges(shape: RingShape) -> tuple[float, float]:
    """The groove's edges as contact angles, ascending [rad]."""
    low, high = shape.edges
    return (low, high) if shape.sign > 0.0 else (-high, -low)


def _profile(shape: RingShape, angles: np.ndarray, race: slice, depth_step: float, bulk: float, growth: float) -> Profile:
    """Lines from lands and groove into the ring: along the groove's normals, bent towards the side faces."""
    outline, sign = shape.outline, shape.sign
    groove = shape.surface(sign * angles)
    slope = np.abs(shape.centre_r - shape.seat) * np.tan(sign * angles)
    if sign < 0.0:  # contact angles run against x on the inner ring
        groove, slope = groove[::-1], slope[::-1]
    left = outline.top("left", outline.shares("left", bulk))[:-1]
    right = outline.top("right", outline.shares("right", bulk))[1:]
    top = np.concatenate([left, groove, right])
    middle, half = 0.5 * (top[0, 0] + top[-1, 0]), 0.5 * (top[-1, 0] - top[0, 0])
    room = 0.8 * half
    normal = middle + room * np.tanh((shape.centre_x + slope - middle) / room)
    ends = [top[0, 0], groove[0, 0], groove[-1, 0], top[-1, 0]]
    along = np.interp(top[:, 0], ends, [top[0, 0], normal[0], normal[-1], top[-1, 0]])
    along[len(left) : len(left) + len(normal)] = normal
    depth = growing(shape.wall, depth_step, bulk, growth) / shape.wall
    for lean in _LEANS:
        seat = _onto(lean * along + (1.0 - lean) * top[:, 0], outline.seat[1:-1, 0])
        bottom = np.column_stack([seat, np.interp(seat, *outline.seat.T)])
        points, quads = _map_between(top[:, ::-1], bottom[:, ::-1], depth)
        if lean == _LEANS[-1] or _corner_areas(points, quads).min() > 0.0:
            break
    rows = len(depth)
    lines = len(left) + np.arange(len(angles))[:: int(sign)][race]
    # Chamfers stand off the bore or the cylinder that the ring sits on.
    on_seat = np.flatnonzero(np.abs(bottom[:, 1] - shape.seat) <= 1e-9 * shape.seat)
    if len(on_seat) < 2 or np.ptp(on_seat) != len(on_seat) - 1:
        why = f"the seat of the ring, its surface at radius {1e3 * shape.seat:.4g} mm, is not one cylinder: a support needs one"
        raise MeshError(why)
    return Profile(points, quads, lines * rows, on_seat * rows + rows - 1, angles[race], rows)


def _onto(lines: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Ends of lines (m,) moved along x, so that one of them meets each corner (k,), ascending."""
    if not len(corners):
        return lines
    corner_lines: list[int] = []
    for i, corner in enumerate(corners):
        low, high = (corner_lines[-1] + 1 if corner_lines else 1), len(lines) - 1 - (len(corners) - i)
        if high < low:
            why = f"the outline has {len(corners)} corners on its seat side, the mesh {len(lines)} lines: too coarse"
            raise MeshError(why)
        corner_lines.append(low + int(np.argmin(np.abs(lines[low : high + 1] - corner))))
    ends = [0, len(lines) - 1]
    old, new = lines[[ends[0], *corner_lines, ends[1]]], np.concatenate([lines[:1], corners, lines[-1:]])
    return np.asarray(np.interp(lines, old, new))


#: Radius of the hole on the axis over the ball's: it takes 2e-3 of the volume's moment arm and none of the contact's field.
HOLE = 0.04
#: Latitude at which the surface ends [rad], and the share of the hole's points that is spread evenly.
POLE, EVEN = np.deg2rad(80.0), 0.6


def ball_profile(
    radius: float, lateral_step: float, half_width: float, depth_step: float, bulk: float, growth: float = 1.25
) -> Profile:
    """Section of a ball; x is the rolling direction, the equator holds both contacts and all contact angles.

    lateral_step : distance of the nodes along the rolling direction at the equator, as arc length [m]; one lies on the equator
    half_width : arc length from the equator up to which nodes keep that distance [m]; they are ``race``, from -x to +x
    depth_step, bulk : size of the first layer below the surface and of the elements far from it [m]
    """
    count = ceil(half_width / lateral_step - 1e-9)
    fine = lateral_step / radius * np.arange(count + 1)
    coarse = bulk / radius
    further = fine[-1] + growing(POLE - fine[-1], min(growth * lateral_step / radius, coarse), coarse, growth)[1:]
    north = np.concatenate([fine, further])
    latitude = np.concatenate([-north[:0:-1], north])
    top = radius * np.column_stack([np.cos(latitude), np.sin(latitude)])
    even = np.linspace(-1.0, 1.0, len(latitude))
    axis = radius * np.sin(POLE) * (EVEN * even + (1.0 - EVEN) * latitude / POLE)
    hole = HOLE * radius
    depth = growing(radius - hole, depth_step, bulk, growth) / (radius - hole)
    points, quads = _map_between(top, np.column_stack([np.full(len(axis), hole), axis]), depth)
    rows, middle = len(depth), len(north) - 1
    lines = np.arange(middle - count, middle + count + 1)
    return Profile(points, quads, lines * rows, np.empty(0, dtype=np.int64), latitude[lines], rows)
