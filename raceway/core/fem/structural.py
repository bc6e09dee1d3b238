"""Structural compliances: deflection of a body's finite elements beyond the half-space of Hertz's formula.

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

from raceway.core.contact.hertz import normal_displacement
from raceway.core.fem.calibration import SOURCES, Calibration
from raceway.core.fem.mesh.part_meshes import RingShape
from raceway.core.fem.revolution.body import (
    Revolution,
    along_normal,
    direct_compliance,
    groove_compliance,
    offset_weights,
    solved_harmonics,
    symmetric_factors,
)
from raceway.core.fem.revolution.sections import Profile, coarse_profile
from raceway.core.ring.kernels.structural import condensed
from raceway.core.ring.system import System
from raceway.storage.array_cache import kept

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline


def density(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points on (-1, 1) and weights of 3/4 (1 - x^2), the ellipse's pressure summed over its minor axis; sum 1."""
    x, w = np.polynomial.legendre.leggauss(points)
    return x, 0.75 * (1.0 - x * x) * w


def line_load_weights(places: np.ndarray, centre: float, half: float) -> np.ndarray:
    """Consistent nodal forces of a unit line load on piecewise linear shape functions.

    places : (n,) float, ascending [m or rad]
    centre, half : middle and half length of the load, in the same unit; what lies beyond the ends acts on the last nodes

    Returns weights : (n,) float, sum 1

    The minor axis is left out: at the depths that are looked at it is far smaller than the distance.
    """
    x, w = density(64)
    at = np.clip(centre + half * x, places[0], places[-1])
    node = np.clip(np.searchsorted(places, at) - 1, 0, len(places) - 2)
    share = (at - places[node]) / (places[node + 1] - places[node])
    weights = np.zeros(len(places))
    np.add.at(weights, node, w * (1.0 - share))
    np.add.at(weights, node + 1, w * share)
    return weights


def half_space(depth: np.ndarray, half: float, young: float, poisson: float) -> np.ndarray:
    """Normal displacement below the middle of a unit line load on a half-space [m/N].

    depth : (n,) float [m];  half : half length of the load [m];  young : [Pa]
    """
    x, w = density(41)
    return np.asarray(normal_displacement(depth, half * x, young, poisson) @ w)


#: Depths between which the fields are compared, over ``reach``, and how many.
DEPTHS, COUNT = (0.31, 0.77), 7
#: Sizes of the elements over ``reach``: in the bulk, at the groove's surface, around the ring.
BULK, SURFACE, AROUND = 0.62, 0.077, 0.154
#: Angles of the table.
ANGLES = 13


@attrs.frozen(eq=False)
class RingCompliance:
    """Structural compliance of one ring."""

    angles: np.ndarray  # (n,) float, contact angles [rad], equidistant
    direct: np.ndarray  # (n,) float, a contact on itself [m/N]
    #: (n, n, Z) float, displacement along the normal at one angle by a force along that at another, k balls further round;
    #: entry 0 is not used [m/N]
    across: np.ndarray
    elements: int  # hexahedra that the ring stands for
    depths: np.ndarray  # (COUNT,) float [m]
    surface: float  # distance of the nodes along the groove [m]

    @cached_property
    def smooth(self) -> CubicSpline:
        """``direct`` over the angle [rad]."""
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.angles, self.direct)


def reach(shape: RingShape, ball_diameter: float) -> float:
    """The length that depths and sizes of elements scale with [m]."""
    return min(shape.wall, 0.34 * ball_diameter)


def ring_compliance(
    shape: RingShape, ball_diameter: float, balls: int, half: float, young: float, poisson: float,
    seat: str | float = "clamped", bulk: float | None = None, surface: float | None = None,
    around: float | None = None, angles: int = ANGLES,
) -> RingCompliance:  # fmt: skip
    """Structural compliance of a ring at contact angles all over its groove.

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
    inputs: dict[str, object] = {
        "points": profile.points, "quads": profile.quads, "race": profile.race, "race_angles": profile.angles,
        "seat_nodes": profile.seat, "divisions": divisions, "balls": balls, "half": half, "young": young,
        "poisson": poisson, "seat": seat, "angles": table, "depths": depths, "inner": shape.inner,
        "groove": shape.groove, "centre": [shape.centre_r, shape.centre_x],
    }  # fmt: skip

    def make() -> dict[str, np.ndarray]:
        body = Revolution(profile, divisions, young, poisson, seat=seat)
        raw = _load_columns(body, shape, table, half, depths, divisions // balls * np.arange(balls))
        return {"compliance": raw, "half_space": half_space(depths, half, young, poisson).mean(keepdims=True)}

    name = "inner" if shape.inner else "outer"
    arrays = kept("structural", f"{name} ring, {divisions} x {len(profile.quads)} elements", inputs, SOURCES, make)
    across = arrays["compliance"]
    direct = np.diagonal(across[:, :, 0]) - arrays["half_space"]
    along = shape.groove * float(profile.angles[1] - profile.angles[0])
    return RingCompliance(table, direct, across, len(profile.quads) * divisions, depths, along)


def ring_section(shape: RingShape, ball_diameter: float, bulk: float | None = None, surface: float | None = None) -> Profile:
    """The section that a ring's compliance is computed on; sizes [m] as in ``ring_compliance``."""
    length = reach(shape, ball_diameter)
    return coarse_profile(shape, bulk or BULK * length, surface or min(SURFACE * length, bulk or np.inf))


def _load_columns(
    body: Revolution, shape: RingShape, table: np.ndarray, half: float, depths: np.ndarray, offsets: np.ndarray
) -> np.ndarray:
    """(angles, angles, offsets) mean normal displacement over the depths below each angle, under a unit line load at another [m/N]."""
    profile, sign = body.profile, shape.sign
    size = 3 * len(profile.points)
    loads, responses = np.zeros((size, len(table))), np.zeros((size, len(table)))
    for a, angle in enumerate(table):
        weights = line_load_weights(profile.angles, angle, half / shape.groove)
        loads[3 * profile.race, a] = weights * sign * np.cos(profile.angles)
        loads[3 * profile.race + 2, a] = weights * sign * np.sin(profile.angles)
        normal = sign * np.array([np.cos(angle), np.sin(angle)])
        centre = np.array([shape.centre_r, shape.centre_x])
        # Triangles that hold the points: a point outside is extrapolated from the nearest
        places = centre + (shape.groove + depths)[:, None] * normal
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
        nodes, shares = triangles[best], shares[np.arange(len(places)), best]
        for component, part in ((0, normal[0]), (2, normal[1])):
            np.add.at(responses[:, a], (3 * nodes + component).ravel(), (shares * part / len(depths)).ravel())
    unknowns = body.unknowns
    loads, responses = loads[unknowns], responses[unknowns]
    harmonics = solved_harmonics(body.divisions, "sampled")
    even, _ = offset_weights(body.divisions, harmonics, offsets)
    harmonic = np.empty((len(harmonics), len(table), len(table)))
    for i, n in enumerate(harmonics):
        harmonic[i] = responses.T @ symmetric_factors(body.harmonic(int(n)), ordered=False).solve(loads)
    return np.ascontiguousarray(np.moveaxis(np.tensordot(even, harmonic, axes=1), 0, 2))


#: Harmonics that are looked at; the lowest mode of a free ring is its second, that of a mounted one the 0th or 1st.
_HARMONICS = (0, 1, 2, 3)
_DIVISIONS = 120


def first_frequency(
    shape: RingShape, ball_diameter: float, young: float, poisson: float, density: float, seat: str | float
) -> float:
    """Lowest elastic natural frequency of a ring [Hz]; seat as of ``Revolution``."""
    size = 0.31 * reach(shape, ball_diameter)
    profile = ring_section(shape, ball_diameter, size, size)
    inputs = {
        "points": profile.points, "quads": profile.quads, "seat_nodes": profile.seat, "seat": seat, "young": young,
        "poisson": poisson, "density": density, "divisions": _DIVISIONS,
    }  # fmt: skip

    def make() -> dict[str, np.ndarray]:
        body = Revolution(profile, _DIVISIONS, young, poisson, density, seat=seat)
        return {"frequency": np.array([body.frequencies(_HARMONICS, 1).min()])}

    name = "inner" if shape.inner else "outer"
    return float(kept("frequency", f"{name} ring, seat {seat}", inputs, SOURCES, make)["frequency"][0])


#: Least standard deviation of the contact angles that compliances between groove centres are fitted for [rad].
_WIDTH = 0.2


@attrs.frozen(eq=False)
class ElasticBodies:
    """Structural compliances of rings and balls, added to the approach of each contact.

    inner, outer : of the rings, at the same angles
    ball_direct, ball_opposite : of a ball, by its load on the same and on the other race [m/N]
    calibrations : of contacts on the inner and the outer race at their surface points, where those are known
    """

    inner: RingCompliance
    outer: RingCompliance
    ball_direct: float
    ball_opposite: float
    calibrations: tuple[Calibration | None, Calibration | None] = (None, None)

    def direct(self, race: int, angles: np.ndarray) -> np.ndarray:
        """Compliance of ring and ball together at contact angles [rad], in m/N; race: 0 inner, 1 outer.

        The rings' tables give its change over the groove, calibrations its size.
        """
        return self._at_angles(race, angles) + self.beyond(race, angles)

    def beyond(self, race: int, angles: np.ndarray) -> np.ndarray:
        """Compliance of contacts at surface points beyond that of depth matching, at contact angles [rad], in m/N."""
        calibration = self.calibrations[race]
        if calibration is None:
            return np.zeros(len(angles))
        excess = calibration.compliance - self._at_angles(race, calibration.angles)
        return np.asarray(np.interp(np.abs(angles), calibration.angles, excess))

    def _at_angles(self, race: int, angles: np.ndarray) -> np.ndarray:
        ring = (self.inner, self.outer)[race]
        return np.asarray(ring.smooth(np.clip(angles, ring.angles[0], ring.angles[-1])) + self.ball_direct)

    def at(self, angle: float) -> tuple[float, float]:
        """Compliances (inner, outer) of ring and ball together at a contact angle [rad], in m/N."""
        inner, outer = (float(self.direct(race, np.array([angle]))[0]) for race in (0, 1))
        return inner, outer

    @property
    def largest_across(self) -> float:
        """Largest compliance between two balls through a ring [m/N]."""
        between = (np.diagonal(ring.across[:, :, 1:]) for ring in (self.inner, self.outer))
        return float(max(np.abs(ring).max(initial=0.0) for ring in between))


def elastic_system(rigid: System, bodies: ElasticBodies, angles: np.ndarray | None = None) -> System:
    """The system of rigid rings with elastic ones in their place; ``angles`` as in ``elastic_scalars``."""
    kernel, base = condensed(rigid.kernel), condensed(rigid.base_kernel)
    scalars = elastic_scalars(rigid.scalars, bodies, angles)
    return attrs.evolve(rigid, kernel=kernel, base_kernel=base, scalars=scalars, table=rigid.table.copy())


def elastic_scalars(rigid: np.ndarray, bodies: ElasticBodies, angles: np.ndarray | None = None) -> np.ndarray:
    """The scalars (..., k) of kernels of condensed bodies, from those of the rigid ones.

    angles : (Z,) contact angles [rad] about which balls act on each other through the rings; None leaves that out

    Tables over the angle become cubic splines without slope at their ends.  Where balls act on each other the table holds what
    a contact's direct compliance has beyond n.M n of its groove centre's motion.
    """
    from scipy.interpolate import CubicSpline

    count = bodies.inner.across.shape[2]
    knots = bodies.inner.angles
    distance = knots[1] - knots[0]
    tables, rings = [], []
    for race, ring in enumerate((bodies.inner, bodies.outer)):
        values = bodies.direct(race, knots)
        if angles is not None:
            rings.append(between_grooves(ring, angles))
            values -= along_normal(knots, rings[-1][0])
        tables += [values, distance * CubicSpline(knots, values, bc_type=((1, 0.0), (1, 0.0)))(knots, 1)]
    head = [bodies.ball_opposite, 0.0 if angles is None else 1.0, count, knots[0], distance, len(knots)]
    if angles is not None:
        tables.append(np.column_stack([rings[0] + rings[1], rings[1][:, 1:]]).ravel())
    elastic = np.concatenate([head, *tables])
    return np.concatenate([rigid, np.broadcast_to(elastic, (*rigid.shape[:-1], len(elastic)))], axis=-1)


def between_grooves(ring: RingCompliance, angles: np.ndarray) -> np.ndarray:
    """Compliance of one ring between groove centres, from loads and displacements along the normals of contacts.

    angles : (n,) contact angles of the balls [rad], about which the compliance is to hold

    Returns (Z, 3) axial by axial, axial by radial, radial by radial force of a ball so many balls further round [m/N]

    Angles of the table have the weight of a normal distribution about those of the balls.
    """
    middle, width = float(angles.mean()), float(np.hypot(_WIDTH, angles.std()))
    weight = np.exp(-0.5 * ((ring.angles - middle) / width) ** 2)
    out = np.empty((ring.across.shape[2], 3))
    out[0] = direct_compliance(ring.angles, ring.direct, weight)
    out[1:] = groove_compliance(ring.angles, ring.across[:, :, 1:], weight)
    return out
