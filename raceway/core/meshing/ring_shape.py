"""The profile of a ring from the dimensions of a scene's [bearing] table."""

from __future__ import annotations

from math import cos, sin
from typing import Any

from raceway.core.meshing.ring import RingShape
from raceway.errors import MeshError


def ring_shape(bearing: Any, inner: bool) -> RingShape:
    """Profile of a ring of a row with side +1, from the dimensions of the scene's [bearing] table.

    Raises
    ------
    MeshError
        Dimensions that are missing, or that do not fit together.
    """
    for key in ("bore", "outer_diameter", "width"):
        if getattr(bearing, key, None) is None:
            raise MeshError(f"`bearing.{key}` is missing: rings of hexahedra need bore, outer_diameter and width")
    d, middle, alpha = bearing.ball_diameter, 0.5 * bearing.pitch_diameter, bearing.contact_angle
    conformity = bearing.conformity_inner if inner else bearing.conformity_outer
    offset, sense = (conformity - 0.5) * d, 1.0 if inner else -1.0
    depth = bearing.shoulder_height or 0.2 * d
    return RingShape(
        inner=inner,
        seat=0.5 * (bearing.bore if inner else bearing.outer_diameter),
        land=middle - sense * (0.5 * d - depth),
        width=bearing.width,
        groove=conformity * d,
        centre_x=sense * offset * sin(alpha),
        centre_r=middle + sense * offset * cos(alpha),
        contact=-sense * alpha,
    )
