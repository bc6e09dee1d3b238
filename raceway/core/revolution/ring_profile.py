"""Sections of rings: graded to a contact, or coarse with a finer groove."""

from __future__ import annotations

from math import ceil, floor

import numpy as np

from raceway.core.meshing.ring import RingShape
from raceway.core.meshing.spacing import growing
from raceway.core.revolution.profile import Profile, mapped
from raceway.errors import MeshError

#: Ratio of neighbouring elements between the fine zone and the bulk.
GROWTH = 1.25
#: Sizes of the coarse section [m]: bulk and surface of the groove.
BULK, SURFACE = 2e-3, 0.25e-3


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
    contact, step = abs(shape.contact), arc_step / shape.groove
    edge = shape.edge - 0.5 * step
    low, high = max(window[0], -edge), min(window[1], edge)
    if not low < high:
        raise MeshError(
            f"the contact window of {np.rad2deg(window[0]):.4g} to {np.rad2deg(window[1]):.4g} deg lies outside the groove, "
            f"which ends at {np.rad2deg(shape.edge):.3g} deg"
        )
    first, last = ceil((low - contact) / step - 1e-9), floor((high - contact) / step + 1e-9)
    if last - first < 1:
        raise MeshError(
            f"a step of {1e3 * arc_step:.4g} mm along the groove leaves fewer than two nodes in the contact window: take a "
            "smaller one"
        )
    zone = contact + step * np.arange(first, last + 1)
    coarse = bulk / shape.groove
    below = zone[0] - growing(zone[0] + shape.edge, min(growth * step, coarse), coarse, growth)[:0:-1]
    above = zone[-1] + growing(shape.edge - zone[-1], min(growth * step, coarse), coarse, growth)[1:]
    angles = np.concatenate([below, zone, above])
    return _section(shape, angles, slice(len(below), len(below) + len(zone)), depth_step, bulk, growth)


def coarse_profile(shape: RingShape, bulk: float = BULK, surface: float = SURFACE, growth: float = GROWTH) -> Profile:
    """A section with elements of ``surface`` [m] on the whole groove, growing to ``bulk`` [m]; ``race`` is the whole groove."""
    cells = max(ceil(2.0 * shape.edge * shape.groove / min(surface, bulk) - 1e-9), 2)
    angles = np.linspace(-shape.edge, shape.edge, cells + 1)
    return _section(shape, angles, slice(0, len(angles)), min(surface, bulk), bulk, growth)


def _section(shape: RingShape, angles: np.ndarray, race: slice, depth_step: float, bulk: float, growth: float) -> Profile:
    """Lines from lands and groove into the ring: along the groove's normals, bent towards the side faces."""
    half, sign = 0.5 * shape.width, shape.sign
    groove = shape.surface(sign * angles)
    if sign < 0.0:  # contact angles run against x on the inner ring
        groove = groove[::-1]
    left = np.linspace(-half, groove[0, 0], max(1, ceil((groove[0, 0] + half) / bulk - 1e-9)) + 1)[:-1]
    right = np.linspace(groove[-1, 0], half, max(1, ceil((half - groove[-1, 0]) / bulk - 1e-9)) + 1)[1:]
    top = np.concatenate([_level(left, shape.land), groove, _level(right, shape.land)])
    slope = np.abs(shape.centre_r - shape.seat) * np.tan((sign * angles)[:: int(sign)])
    room = 0.8 * half
    below = room * np.tanh((shape.centre_x + slope) / room)
    ends = [-half, top[len(left), 0], groove[-1, 0], half]
    seat = np.concatenate(
        [
            np.interp(left, ends[:2], [-half, below[0]]),
            below,
            np.interp(right, ends[2:], [below[-1], half]),
        ]
    )
    depth = growing(shape.wall, depth_step, bulk, growth) / shape.wall
    points, quads = mapped(top[:, ::-1], _level(seat, shape.seat)[:, ::-1], depth)
    rows = len(depth)
    lines = len(left) + np.arange(len(angles))[:: int(sign)][race]
    return Profile(points, quads, lines * rows, np.arange(len(top)) * rows + rows - 1, angles[race], rows)


def _level(x: np.ndarray, radius: float) -> np.ndarray:
    return np.column_stack([x, np.full(len(x), radius)])
