"""Section of a ball about its rolling direction: a half disk with a small hole on the axis, fine at the equator."""

from __future__ import annotations

from math import ceil

import numpy as np

from raceway.core.mesh.spacing import growing
from raceway.core.revolution.profile import Profile, mapped

#: Radius of the hole on the axis over the ball's: it takes 2e-3 of the volume's moment arm and none of the contact's field.
HOLE = 0.04
#: Latitude at which the surface ends [rad], and the share of the hole's points that is spread evenly.
POLE, EVEN = np.deg2rad(80.0), 0.6


def ball_profile(
    radius: float, lateral_step: float, half_width: float, depth_step: float, bulk: float, growth: float = 1.25
) -> Profile:
    """Section of a ball; x is the rolling direction, the equator holds both contacts and all contact angles.

    Parameters
    ----------
    radius : float [m]
    lateral_step : float
        Distance of the nodes along the rolling direction at the equator, as arc length [m]; one lies on the equator.
    half_width : float
        Arc length from the equator up to which nodes keep that distance [m]; they are ``race``, from -x to +x.
    depth_step, bulk : float
        Size of the first layer below the surface and of the elements far from it [m].
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
    points, quads = mapped(top, np.column_stack([np.full(len(axis), hole), axis]), depth)
    rows, middle = len(depth), len(north) - 1
    lines = np.arange(middle - count, middle + count + 1)
    return Profile(points, quads, lines * rows, np.empty(0, dtype=np.int64), latitude[lines], rows)
