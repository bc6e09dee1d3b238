"""Condensed bodies of thick and thin walls: resultants against pressures at surface points, and what a result states."""

from __future__ import annotations

from typing import Any

from benchmarks.evidence import Row
from benchmarks.evidence.condensed_calibrated import quantities, tables
from benchmarks.evidence.condensed_seats import NODAL
from validation.scenes import settled

TITLE = "Condensed bodies: the calibration of contact resultants"
COMMAND = "python -m benchmarks.evidence condensed_walls"
#: Walls below both grooves, with bore and outer diameter [mm].
WALLS = {3.24: (30.0, 62.0), 2.0: (32.48, 59.52), 1.24: (34.0, 58.0)}
LIMIT = 0.003


def rows() -> list[Row]:
    return [row for wall in WALLS for tilt in ("locked", "free") for row in _rows(wall, tilt)]


def _rows(wall: float, tilt: str) -> list[Row]:
    bore, outer = WALLS[wall]
    plain: dict[str, Any] = tables(tilt, bearing={"preset": "B7206C", "bore": 1e-3 * bore, "outer_diameter": 1e-3 * outer})
    (model, ours), (_, theirs) = (settled({**plain, **more}) for more in ({}, NODAL))
    stated = float(model.bearing.contact_error(model, ours)[0] or 0.0) + float(
        model.bearing.mesh_error(model, ours)[0] or 0.0
    )
    one, two, out = quantities(ours), quantities(theirs), []
    for name in ("x", "y", "kxx", "kyy", "kzz"):
        apart = one[name] / two[name] - 1.0
        what = f"walls of {wall:g} mm, tilt {tilt}: {name}, resultants over 8 points per semi-axis, less 1"
        limit = f"{LIMIT:g}, or the stated error"
        out.append(
            Row(what, apart, limit, abs(apart) <= max(LIMIT, stated), COMMAND, f"contact and mesh state {stated:.2g}")
        )
    return out
