"""The profile of a ring from the dimensions of a scene's [bearing] table."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np

from raceway.core.mesh.outline import polygon_outline
from raceway.core.mesh.ring_mesh import RingShape
from raceway.errors import MeshError
from raceway.storage.tables import Tables


def ring_shape(bearing: Any, inner: bool) -> RingShape:
    """Profile of a ring of a row with side +1, from the dimensions of the scene's [bearing] table.

    Raises
    ------
    MeshError
        Dimensions that are missing, or that do not fit together.
    """
    key = "inner_profile" if inner else "outer_profile"
    if getattr(bearing, key, None) is not None:
        return _given(bearing, key, inner)
    for key in ("bore", "outer_diameter", "width"):
        if getattr(bearing, key, None) is None:
            raise MeshError.at(f"bearing.{key}", None, "is missing: rings of hexahedra need bore, outer_diameter and width")
    middle, depth = 0.5 * bearing.pitch_diameter, bearing.shoulder_height or 0.2 * bearing.ball_diameter
    return RingShape(
        inner=inner,
        seat=0.5 * (bearing.bore if inner else bearing.outer_diameter),
        land=middle + (-1.0 if inner else 1.0) * (0.5 * bearing.ball_diameter - depth),
        width=bearing.width,
        **_groove(bearing, inner),
    )


def _groove(bearing: Any, inner: bool) -> Tables:
    alpha, sense = bearing.contact_angle, 1.0 if inner else -1.0
    conformity = bearing.conformity_inner if inner else bearing.conformity_outer
    offset = sense * (conformity - 0.5) * bearing.ball_diameter
    return {
        "groove": conformity * bearing.ball_diameter,
        "centre_x": offset * sin(alpha),
        "centre_r": 0.5 * bearing.pitch_diameter + offset * cos(alpha),
        "contact": -sense * alpha,
    }


def _given(bearing: Any, key: str, inner: bool) -> RingShape:
    """A ring whose section the user gives."""
    groove = _groove(bearing, inner)
    outline = polygon_outline(
        f"bearing.{key}", getattr(bearing, key), inner, groove["groove"], groove["centre_x"], groove["centre_r"]
    )
    radii, lands = outline.seat[:, 1], np.r_[outline.left[-1, 1], outline.right[0, 1]]
    seat, land = (radii.min(), lands.max()) if inner else (radii.max(), lands.min())
    word, diameter = ("bore", bearing.bore) if inner else ("outer_diameter", bearing.outer_diameter)
    if diameter is not None and abs(2.0 * seat - diameter) > 1e-6 * diameter:
        raise MeshError(
            f"`bearing.{key}` has its seat at a diameter of {2.0 * seat:g} m, `bearing.{word}` = {diameter:g} m: give the same"
        )
    width = float(outline.seat[-1, 0] - outline.seat[0, 0])
    return RingShape(inner, float(seat), float(land), width, **groove, given=outline)
