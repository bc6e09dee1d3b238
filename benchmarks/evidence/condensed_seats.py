"""Condensed bodies on elastic seats: resultants against pressures at surface points, and against springs in series."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.evidence import Row, near
from benchmarks.evidence.condensed_calibrated import quantities, tables
from raceway.core.revolution.body import seat_areas
from validation.scenes import model_of, settled

TITLE = "Condensed bodies: elastic seats"
COMMAND = "python -m benchmarks.evidence condensed_seats"
#: Beds under both rings [N/m3], axial loads [N].
BEDS, LOADS = (5e11, 1e11, 5e10), (400.0, 1000.0)
#: Young's modulus of rings that do not deform [Pa].
RIGID = 2e17
NODAL = {
    "contact": {"kind": "unilateral", "discretisation": "nodal"},
    "mesh": {"kind": "structured", "nodes_per_semi_axis": 8},
}


def rows() -> list[Row]:
    return [*beds(), *series()]


def scene(
    bed: float | None, load: float, tilt: str = "locked", seats: tuple[str, ...] = ("inner", "outer")
) -> dict[str, Any]:
    """B7206C under an axial load, the named seats on a bed [N/m3]."""
    supports = {} if bed is None else {f"{seat}_seat": bed for seat in seats}
    return tables(tilt, load={"axial": load}, supports=supports)


def beds() -> list[Row]:
    """Stiffness of the same bodies with both kinds of contacts; radial with free tilt: with the tilts eliminated."""
    out = []
    for bed in BEDS:
        for load in LOADS:
            for tilt in ("locked", "free"):
                (_, ours), (_, theirs) = (settled({**scene(bed, load, tilt), **more}) for more in ({}, NODAL))
                where = f"beds of {bed:.0e} N/m3, {load:g} N, tilt {tilt}"
                one, two = quantities(ours), quantities(theirs)
                pairs = {"kxx": (one["kxx"], two["kxx"]), "kyy": (one["kyy"], two["kyy"])}
                if tilt == "free":
                    pairs["kyy, tilts eliminated"] = (_radial(ours.stiffness), _radial(theirs.stiffness))
                for name, (found, expected) in pairs.items():
                    out.append(
                        near(f"{where}: {name}, N/um, against 8 points per semi-axis", found, expected, 0.01, COMMAND)
                    )
    return out


def _radial(stiffness: np.ndarray) -> float:
    """Radial stiffness with the other coordinates free [N/um]."""
    return float(1e-6 / np.linalg.inv(stiffness)[1, 1])


def series() -> list[Row]:
    """Rings that do not deform: under an axial load a bed is one more spring behind the bearing on rigid seats."""
    out = []
    for load in LOADS:
        for bed in (5e10, 1e10):
            for seats in (("outer",), ("inner", "outer")):
                stiff = {"rings": {"young": RIGID, "poisson": 0.29}}
                ours, firm = (scene(value, load, seats=seats) for value in (bed, None))
                for one in (ours, firm):
                    one["bearing"] = {**one["bearing"], **stiff}
                expected = 1.0 / settled(firm)[1].stiffness[0, 0]
                expected += sum(1.0 / (bed * _area(ours, seat == "inner")) for seat in seats)
                found = quantities(settled(ours)[1])["kxx"]
                what = (
                    f"rings of {RIGID:g} Pa, {load:g} N, bed of {bed:.0e} N/m3 under {' and '.join(seats)} ring: kxx, N/um"
                )
                out.append(near(what, found, 1e-6 / expected, 0.005, COMMAND, "springs in series"))
    return out


def _area(tables: dict[str, Any], inner: bool) -> float:
    """Of a ring's seat [m2]."""
    model, divisions = model_of(tables), 360
    return float(seat_areas(model.bearing.ring_section(model, inner), divisions).sum() * divisions)
