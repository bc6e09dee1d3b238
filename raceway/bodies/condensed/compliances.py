"""Structural compliances of a scene's rings and balls, calibrated on contacts at surface points."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

import attrs

from raceway.bodies.basis import Basis, seat_of
from raceway.core.contact.hertz import ball_compliance
from raceway.core.mesh.ring_mesh import ring_shape
from raceway.core.patches.patch import RingBody, Solid
from raceway.core.structural import SURFACE, ElasticBodies, calibrated, reach, ring_compliance
from raceway.errors import SceneError
from raceway.scene.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Hashable

    from raceway.core.mesh.ring_mesh import RingShape

#: Peak pressure [Pa] of the contact whose length the line loads on the rings have: independent of the scene's load, so that
#: one table serves all of them; the compliance changes by less than 0.01 nm/N with it.
_PRESSURE = 1.5e9
#: Size of elements far from a contact that is calibrated at its surface points, over ``reach``.
_CALIBRATED_BULK = 0.4
#: Compliances of the last scenes: a run asks for them up to four times, a study for the same bodies again and again.
_KEPT = 8
_BODIES: dict[Hashable, ElasticBodies] = {}


def sections(scene: Scene, basis: Basis) -> Hashable:
    """All that the compliances of the rings and their calibrations are computed from: loads and masses are not."""
    b = scene.bearing
    shape = b.ball_diameter, b.pitch_diameter, b.ball_count, b.conformity_inner, b.conformity_outer, b.contact_angle
    sizes = b.bore, b.outer_diameter, b.width, b.shoulder_height, b.inner_profile, b.outer_profile
    elastic = b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson
    pairs = tuple((float(one.factor), *(float(axis) for axis in one.semi_axes(1.0))) for one in (basis.inner, basis.outer))
    return shape, sizes, elastic, pairs, scene.supports.inner_seat, scene.supports.outer_seat, scene.mesh


def elastic_bodies(scene: Scene, basis: Basis, coarser: float = 1.0) -> ElasticBodies:
    """Structural compliances of a scene's rings and balls; those of the last few scenes are kept.

    Parameters
    ----------
    coarser : factor on all sizes of elements

    Raises
    ------
    SceneError
        Bodies so soft that their contacts are as large as a ball.
    """
    key = (sections(scene, basis), coarser)
    found = _BODIES.pop(key, None) or _elastic_bodies(scene, basis, coarser)
    _BODIES[key] = found  # the last in, and the last to go
    if len(_BODIES) > _KEPT:
        del _BODIES[next(iter(_BODIES))]
    b, (a, across) = scene.bearing, (float(x) for x in basis.inner.semi_axes(basis.ball_load))
    own, opposite = ball_compliance(0.5 * b.ball_diameter, b.balls.young, b.balls.poisson, a, across)
    if not abs(own) * basis.ball_load < b.ball_diameter:
        soft, steel = min(("balls", b.balls), ("rings", b.rings), key=lambda one: one[1].young)
        why = f"is too soft for {basis.ball_load:.3g} N a ball: its contacts would be as large as the ball. Steel has 2.1e11 Pa"
        raise SceneError.at(f"bearing.{soft}.young", steel.young, why)
    return attrs.evolve(found, ball_own=own, ball_opposite=opposite)


def _elastic_bodies(scene: Scene, basis: Basis, coarser: float) -> ElasticBodies:
    """Rings and calibrations; the ball's own compliance, which follows the load, is filled in each time."""
    b = scene.bearing
    typical = typical_load(basis)
    rings, calibrations = [], []
    for inner in (True, False):
        shape = ring_shape(b, inner)
        half = float((basis.inner if inner else basis.outer).semi_axes(typical)[0])
        bulk, fine = element_sizes(scene, shape, half)
        rings.append(
            ring_compliance(
                shape,
                b.ball_diameter,
                b.ball_count,
                half,
                b.rings.young,
                b.rings.poisson,
                seat_of(scene, inner),
                coarser * bulk,
                coarser * min(fine, bulk),
                coarser * min(2.0 * fine, bulk),
            )  # fmt: skip
        )
        size = _CALIBRATED_BULK * reach(shape, b.ball_diameter)
        steel, balls = (Solid(one.young, one.poisson, bulk=size) for one in (b.rings, b.balls))
        body = RingBody(shape, steel, seat_of(scene, inner), (0.0, 0.0))
        both = basis.inner, basis.outer
        calibrations.append(
            calibrated(body, balls, both, typical, 0.5 * b.ball_diameter, b.ball_count, abs(b.contact_angle))
        )
    return ElasticBodies(rings[0], rings[1], nan, nan, (calibrations[0], calibrations[1]))


def typical_load(basis: Basis) -> float:
    """The load of ``_PRESSURE`` on the inner race [N]: p0 grows with the cube root of the load."""
    return float((_PRESSURE / basis.inner.peak_pressure(1.0)) ** 3)


def element_sizes(scene: Scene, shape: RingShape, half: float) -> tuple[float, float]:
    """Sizes of a ring's elements far from the groove and on it [m]; ``half``: semi-major axis of a typical contact."""
    length = reach(shape, scene.bearing.ball_diameter)
    if scene.mesh is None:
        return 0.62 * length, SURFACE * length
    return min(scene.mesh.element_size, 0.62 * length), half / scene.mesh.nodes_per_semi_axis
