"""Sections of rings: graded to a contact, or coarse with a finer groove."""

from __future__ import annotations

from math import ceil, floor

import numpy as np

from raceway.core.mesh.ring_mesh import RingShape
from raceway.core.mesh.spacing import growing
from raceway.core.revolution.profile import Profile, corner_areas, mapped
from raceway.errors import MeshError

#: Ratio of neighbouring elements between the fine zone and the bulk.
GROWTH = 1.25
#: Sizes of the coarse section [m]: bulk and surface of the groove.
BULK, SURFACE = 2e-3, 0.25e-3
#: Lines into the ring follow the groove's normals (1), which shoulders of some outlines forbid, or stand upright (0).
_LEANS = (1.0, 0.5, 0.0)


def graded_profile(
    shape: RingShape,
    arc_step: float,
    window: tuple[float, float],
    depth_step: float,
    bulk: float,
    growth: float = GROWTH,
) -> Profile:
    """A section that is fine around a contact.

    Parameters
    ----------
    arc_step : float
        Distance of the race's nodes along the groove [m]; one of them lies at the free contact angle.
    window : (2,) float
        Lowest and highest contact angle of the race's nodes [rad], positive at the free contact angle; what runs over the
        groove's edge is left out.
    depth_step, bulk : float
        Size of the first layer below the surface and of the elements far from it [m].
    growth : float
        Ratio of neighbouring elements.

    Returns
    -------
    profile : Profile
        ``race`` holds the nodes within the window.
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
        raise MeshError(
            f"a step of {1e3 * arc_step:.4g} mm along the groove leaves fewer than two nodes in the contact window: take a "
            "smaller one"
        )
    zone = contact + step * np.arange(first, last + 1)
    coarse = bulk / shape.groove
    below = zone[0] - growing(zone[0] - edges[0], min(growth * step, coarse), coarse, growth)[:0:-1]
    above = zone[-1] + growing(edges[1] - zone[-1], min(growth * step, coarse), coarse, growth)[1:]
    angles = np.concatenate([below, zone, above])
    return _section(shape, angles, slice(len(below), len(below) + len(zone)), depth_step, bulk, growth)


def coarse_profile(shape: RingShape, bulk: float = BULK, surface: float = SURFACE, growth: float = GROWTH) -> Profile:
    """A section with elements of ``surface`` [m] on the whole groove, growing to ``bulk`` [m]; ``race`` is the whole groove."""
    low, high = _contact_edges(shape)
    cells = max(ceil((high - low) * shape.groove / min(surface, bulk) - 1e-9), 2)
    angles = np.linspace(low, high, cells + 1)
    return _section(shape, angles, slice(0, len(angles)), min(surface, bulk), bulk, growth)


def _contact_edges(shape: RingShape) -> tuple[float, float]:
    """The groove's edges as contact angles, ascending [rad]."""
    low, high = shape.edges
    return (low, high) if shape.sign > 0.0 else (-high, -low)


def _section(shape: RingShape, angles: np.ndarray, race: slice, depth_step: float, bulk: float, growth: float) -> Profile:
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
        points, quads = mapped(top[:, ::-1], bottom[:, ::-1], depth)
        if lean == _LEANS[-1] or corner_areas(points, quads).min() > 0.0:
            break
    rows = len(depth)
    lines = len(left) + np.arange(len(angles))[:: int(sign)][race]
    # Chamfers stand off the bore or the cylinder that the ring sits on.
    on_seat = np.flatnonzero(np.abs(bottom[:, 1] - shape.seat) <= 1e-9 * shape.seat)
    if len(on_seat) < 2 or np.ptp(on_seat) != len(on_seat) - 1:
        raise MeshError(
            f"the seat of the ring, its surface at radius {1e3 * shape.seat:.4g} mm, is not one cylinder: a support needs one"
        )
    return Profile(points, quads, lines * rows, on_seat * rows + rows - 1, angles[race], rows)


def _onto(lines: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Ends of lines (m,) moved along x, so that one of them meets each corner (k,), ascending."""
    if not len(corners):
        return lines
    taken: list[int] = []
    for i, corner in enumerate(corners):
        low, high = (taken[-1] + 1 if taken else 1), len(lines) - 1 - (len(corners) - i)
        if high < low:
            raise MeshError(
                f"the outline has {len(corners)} corners on its seat side, the mesh {len(lines)} lines: too coarse"
            )
        taken.append(low + int(np.argmin(np.abs(lines[low : high + 1] - corner))))
    ends = [0, len(lines) - 1]
    old, new = lines[[ends[0], *taken, ends[1]]], np.concatenate([lines[:1], corners, lines[-1:]])
    return np.asarray(np.interp(lines, old, new))
