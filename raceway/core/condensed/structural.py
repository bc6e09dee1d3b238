"""Structural compliances: deflection of a body's finite elements beyond the half-space of Hertz's formula.

Notes
-----
A contact force presses with the line density of its Hertz ellipse on the nodes of the surface.  Below it, on the inward
normal, the elements' displacement and that of a half-space under the same line differ by a nearly constant amount, the
structural compliance: mean over depth of (u_elements - u_half-space) / Q.  No displacement at the patch itself enters, so the
result does not depend on the mesh there.  Depths and sizes scale with ``reach``, the smaller of the ring's
wall below the groove and 0.34 D: 1.0 to 2.5 mm where they were found (B7206C: wall 3.23 mm, D 9.525 mm).
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.condensed.line_load import half_space, nodal_weights
from raceway.core.mesh.ring_mesh import RingShape
from raceway.core.revolution.body import Revolution
from raceway.core.revolution.harmonics import offset_weights, solved_harmonics
from raceway.core.revolution.profile import Profile
from raceway.core.revolution.ring_profile import coarse_profile
from raceway.storage.array_cache import kept
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

#: Sources on which kept numbers depend.
SOURCES = ("core/revolution", "core/hexahedron", "core/condensed", "core/patches", "core/mesh")
#: Depths between which the fields are compared, over ``reach``, and how many.
DEPTHS, COUNT = (0.31, 0.77), 7
#: Sizes of the elements over ``reach``: in the bulk, at the groove's surface, around the ring.
BULK, SURFACE, AROUND = 0.62, 0.077, 0.154
#: Angles of the table.
ANGLES = 13


@attrs.frozen(eq=False)
class RingCompliance:
    """Structural compliance of one ring.

    Attributes
    ----------
    angles : (n,) float, contact angles [rad], equidistant;  own : (n,) float, a contact on itself [m/N]
    across : (n, n, Z) float, displacement along the normal at one angle by a force along that at another, k balls further
        round; entry 0 is not used [m/N]
    elements : hexahedra that the ring stands for;  depths : (COUNT,) float [m]
    surface : distance of the nodes along the groove [m]
    """

    angles: np.ndarray
    own: np.ndarray
    across: np.ndarray
    elements: int
    depths: np.ndarray
    surface: float

    @cached_property
    def smooth(self) -> CubicSpline:
        """``own`` over the angle [rad]."""
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.angles, self.own)


def reach(shape: RingShape, ball_diameter: float) -> float:
    """The length that depths and sizes of elements scale with [m]."""
    return min(shape.wall, 0.34 * ball_diameter)


def ring_compliance(
    shape: RingShape,
    ball_diameter: float,
    balls: int,
    half: float,
    young: float,
    poisson: float,
    seat: str | float = "clamped",
    bulk: float | None = None,
    surface: float | None = None,
    around: float | None = None,
    angles: int = ANGLES,
) -> RingCompliance:
    """Structural compliance of a ring at contact angles all over its groove.

    Parameters
    ----------
    balls : Z, evenly spaced
    half : semi-major axis of a contact at a typical load [m]; the result hardly depends on it
    young, poisson : of the ring [Pa, -];  seat : see ``Revolution``
    bulk, surface, around : sizes of the elements [m]; None: from ``reach``
    """
    length = reach(shape, ball_diameter)
    profile = ring_section(shape, ball_diameter, bulk, surface)
    step = around or min(AROUND * length, 2.0 * (bulk or np.inf))
    radius = shape.centre_r + shape.sign * shape.groove * np.cos(shape.contact)
    divisions = max(balls * round(2.0 * np.pi * radius / (step * balls)), 3 * balls)
    # The whole line load lies on the groove.
    last = max(shape.edge - half / shape.groove, abs(shape.contact))
    table = np.linspace(-last, last, angles)
    depths = length * np.linspace(*DEPTHS, COUNT)
    inputs: Tables = {
        "points": profile.points, "quads": profile.quads, "race": profile.race, "race_angles": profile.angles,
        "seat_nodes": profile.seat, "divisions": divisions, "balls": balls, "half": half, "young": young,
        "poisson": poisson, "seat": seat, "angles": table, "depths": depths, "inner": shape.inner,
        "groove": shape.groove, "centre": [shape.centre_r, shape.centre_x],
    }  # fmt: skip

    def make() -> dict[str, np.ndarray]:
        body = Revolution(profile, divisions, young, poisson, 1.0, seat=seat)
        raw = _columns(body, shape, table, half, depths, divisions // balls * np.arange(balls))
        return {"compliance": raw, "half_space": half_space(depths, half, young, poisson).mean(keepdims=True)}

    name = "inner" if shape.inner else "outer"
    found = kept("structural", f"{name} ring, {divisions} x {len(profile.quads)} elements", inputs, SOURCES, make)
    across = found["compliance"]
    own = np.diagonal(across[:, :, 0]) - found["half_space"]
    along = shape.groove * float(profile.angles[1] - profile.angles[0])
    return RingCompliance(table, own, across, len(profile.quads) * divisions, depths, along)


def ring_section(shape: RingShape, ball_diameter: float, bulk: float | None = None, surface: float | None = None) -> Profile:
    """The section that a ring's compliance is computed on; sizes [m] as in ``ring_compliance``."""
    length = reach(shape, ball_diameter)
    return coarse_profile(shape, bulk or BULK * length, surface or min(SURFACE * length, bulk or np.inf))


def _columns(
    body: Revolution, shape: RingShape, table: np.ndarray, half: float, depths: np.ndarray, offsets: np.ndarray
) -> np.ndarray:
    """(angles, angles, offsets) mean normal displacement over the depths below each angle, under a unit line load at another [m/N]."""
    from scipy.sparse.linalg import splu

    profile, sign = body.profile, shape.sign
    size = 3 * len(profile.points)
    loads, seen = np.zeros((size, len(table))), np.zeros((size, len(table)))
    for a, angle in enumerate(table):
        weights = nodal_weights(profile.angles, angle, half / shape.groove)
        loads[3 * profile.race, a] = weights * sign * np.cos(profile.angles)
        loads[3 * profile.race + 2, a] = weights * sign * np.sin(profile.angles)
        normal = sign * np.array([np.cos(angle), np.sin(angle)])
        centre = np.array([shape.centre_r, shape.centre_x])
        nodes, shares = interpolation(profile, centre + (shape.groove + depths)[:, None] * normal)
        for component, part in ((0, normal[0]), (2, normal[1])):
            np.add.at(seen[:, a], (3 * nodes + component).ravel(), (shares * part / len(depths)).ravel())
    unknowns = body.unknowns
    loads, seen = loads[unknowns], seen[unknowns]
    solved = solved_harmonics(body.divisions, "sampled")
    even, _ = offset_weights(body.divisions, solved, offsets)
    harmonic = np.empty((len(solved), len(table), len(table)))
    for i, n in enumerate(solved):
        factor = splu(
            body.harmonic(int(n)), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.0
        )
        harmonic[i] = seen.T @ factor.solve(loads)
    return np.ascontiguousarray(np.moveaxis(np.tensordot(even, harmonic, axes=1), 0, 2))


def interpolation(profile: Profile, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) and shares (n, 3) of the triangles (halves of the quadrilaterals) that hold points (n, 2) of a section.

    A point outside is put into the nearest triangle and extrapolated.
    """
    q = profile.quads
    triangles = np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]])
    p = profile.points[triangles]
    base = p[:, 0]
    edge_1, edge_2 = p[:, 1] - base, p[:, 2] - base
    det = edge_1[:, 0] * edge_2[:, 1] - edge_1[:, 1] * edge_2[:, 0]
    delta = places[:, None] - base
    second = (delta[..., 0] * edge_2[:, 1] - delta[..., 1] * edge_2[:, 0]) / det
    third = (edge_1[:, 0] * delta[..., 1] - edge_1[:, 1] * delta[..., 0]) / det
    shares = np.stack([1.0 - second - third, second, third], axis=2)
    best = shares.min(axis=2).argmax(axis=1)
    return triangles[best], shares[np.arange(len(places)), best]
