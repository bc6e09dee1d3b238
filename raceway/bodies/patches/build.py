"""Condensed rings and balls whose contacts are pressures at surface points.

The answer of rigid rings on Hertz's contacts says how far the contacts reach and which load the points are laid out for;
where contacts go further than that, the patches are made wider.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.bodies.basis import Basis, call_plugin, make_basis
from raceway.bodies.mounting import place_ring
from raceway.bodies.patches.plan import nodes_of
from raceway.bodies.patches.report import NodalBearing
from raceway.bodies.rigid.build import probe, rigid_system
from raceway.contact_laws.hertz import Hertz
from raceway.core.mesh.ring_mesh import ring_shape
from raceway.core.patches.patch import Patch, RingBody, Solid, Spacing, make_ball, make_patch
from raceway.core.patches.pressure import BeyondPatch, PointLaw, Reach, reach_of
from raceway.core.patches.system import PatchSystem, Pool
from raceway.core.ring.kernels.layout import CENTRIFUGAL
from raceway.core.ring.orbit import steady_orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System, surrogate
from raceway.core.signatures import LAW
from raceway.errors import ConvergenceError
from raceway.framework.contracts import ContactPairs
from raceway.framework.plugin_kernel import plugin_kernel
from raceway.planning.plan import Plan
from raceway.scene.scene import Scene

if TYPE_CHECKING:
    from raceway.core.contact.hertz import Ellipse

#: Size of elements far from the contacts [m] where the scene says nothing.
BULK = 0.8e-3
#: Contacts that are laid out may carry this much more than rigid bodies say before patches are made anew.
_ROOM = 1.2


def build(scene: Scene, plan: Plan) -> NodalBearing:
    """The bearing of a scene with condensed bodies and pressures at surface points.

    Raises
    ------
    MeshError
        Rings without dimensions, sections that cannot be meshed.
    """
    basis = make_basis(scene)
    contact = attrs.evolve(scene.contact, kind="hertz", law=Hertz(), discretisation="resultant")
    as_rigid = attrs.evolve(scene, contact=contact)
    rigid = rigid_system(as_rigid, plan, basis)
    probe(as_rigid, basis, rigid)
    guess = place_ring(as_rigid, basis, rigid)
    reach = _first_reach(scene, basis, rigid, guess)
    nodes, load = _layout(scene, reach)
    system, spacing = _system(scene, basis, rigid, reach, nodes, load)
    beside = guess
    if scene.bearing.preloaded or scene.supports.axial == "displacement":
        rigid = attrs.evolve(rigid, table=rigid.table.copy())
        guess = place_ring(as_rigid, basis, system)

    def coarser() -> Ring:
        coarse, _ = _system(scene, basis, system, reach, 0.5 * nodes, load)
        return coarse

    fewer = coarser if nodes >= 2.0 else None
    return NodalBearing(basis, system, guess, nodes, load, spacing, system.pool, rigid, beside, fewer)


def _system(scene: Scene, basis: Basis, like: Ring, reach: Reach, nodes: float, load: float) -> tuple[PatchSystem, Spacing]:
    """A ring like another one, on patches with so many points along the semi-axes at a load [N]."""
    spacing = Spacing.of(_semi_axes(basis.inner, load), nodes, 0.5 * basis.geometry.ball_diameter, reach.widest)
    make = _maker(scene, spacing)
    laws = _point_laws(scene, basis, spacing)
    pool = Pool(make(reach), laws, _widening(basis, reach, make), scene.contact.friction)
    mass = basis.geometry.ball_mass(scene.bearing.balls.density) if scene.kinematics.ball_inertia else 0.0
    fields = {f.name: getattr(like, f.name) for f in attrs.fields(Ring)}
    return PatchSystem(**{**fields, "table": like.table.copy()}, rigid=surrogate(like), pool=pool, ball_mass=mass), spacing


def _semi_axes(ellipse: Ellipse, load: float) -> tuple[float, float]:
    a, b = ellipse.semi_axes(load)
    return float(a), float(b)


def _first_reach(scene: Scene, basis: Basis, rigid: System, guess: np.ndarray) -> Reach:
    """Loads and contact angles of rigid bodies at rest and, where the excitation repeats, on its orbit."""
    q, ball, _ = rigid.settle(guess)
    states = [(q, ball, 0.0)]
    excitation = scene.excitation
    if excitation is not None and excitation.period_s is not None:
        try:
            orbit = steady_orbit(rigid.at_standstill(), excitation.period_s, q, samples=33)
            times = np.arange(33) * orbit.period / 33
            states += [(q, ball, t) for q, ball, t in zip(orbit.displacement, orbit.ball, times, strict=True)]
        except ConvergenceError:
            pass  # patches grow on the way
    angles: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    loads: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    still = rigid.at_standstill()
    for q, ball, t in states:
        now = still.evaluate(q, ball=ball, t=t)
        centre = still.centre_vectors(q, t)[0]
        z = still.ball_count
        place = now.ball[:, :2] if rigid.table[:, CENTRIFUGAL].any() else 0.5 * centre
        for race, vector in enumerate((centre - place, place)):
            angles[race].append(np.arctan2(vector[:, 0], vector[:, 1]))
            loads[race].append(now.contact_force[race * z : (race + 1) * z])
    free = basis.geometry.contact_angle
    given = [(np.concatenate(a), np.concatenate(f)) for a, f in zip(angles, loads, strict=True)]
    return reach_of(given[0], given[1], (basis.inner, basis.outer), 0.5 * basis.geometry.ball_diameter, free, _ROOM)


def _layout(scene: Scene, reach: Reach) -> tuple[float, float]:
    """Points per semi-axis, and the load [N] at which they count: the mesh's, or the mean of the balls that carry.

    Notes
    -----
    The mean is rounded to two digits: states near each other then share their compliances.
    """
    nodes = float(nodes_of(scene))
    load = getattr(scene.mesh, "ball_load", None)
    return nodes, float(load) if load is not None else float(f"{reach.mean_load:.1e}")


def _maker(scene: Scene, spacing: Spacing) -> Callable[[Reach], tuple[Patch, Patch]]:
    """Patches for a reach; the ball's grid follows the larger one of the two."""
    b = scene.bearing
    bulk = float(getattr(scene.mesh, "element_size", BULK))
    rings = Solid(b.rings.young, b.rings.poisson, bulk=bulk)
    steel = Solid(b.balls.young, b.balls.poisson, bulk=bulk)
    seats = [
        value if isinstance(value, float) else "clamped" for value in (scene.supports.inner_seat, scene.supports.outer_seat)
    ]

    def make(reach: Reach) -> tuple[Patch, Patch]:
        grid = spacing.holding(reach.widest)
        # Half a row for mean stiffnesses, which slide so far, and half a row since the last one must carry nothing.
        slide = grid.along / min(ring_shape(b, inner).groove for inner in (True, False))
        bodies = [
            RingBody(ring_shape(b, inner), rings, seat, (window[0] - slide, window[1] + slide))
            for inner, seat, window in zip((True, False), seats, (reach.inner, reach.outer), strict=True)
        ]
        rows = max(int((body.window[1] - body.window[0]) * body.shape.groove / grid.along) + 2 for body in bodies)
        ball = make_ball(0.5 * b.ball_diameter, steel, grid, rows, shear=scene.contact.friction > 0.0)
        first, second = (make_patch(body, ball, grid, b.ball_count) for body in bodies)
        return first, second

    return make


def _widening(
    basis: Basis, reach: Reach, make: Callable[[Reach], tuple[Patch, Patch]]
) -> Callable[[BeyondPatch], tuple[Patch, Patch]]:
    """What a pool calls when a contact leaves its patch."""
    now = [reach]

    def wider(left: BeyondPatch) -> tuple[Patch, Patch]:
        ellipse = basis.inner if left.sense < 0.0 else basis.outer
        now[0] = now[0].grown(left, ellipse, 0.5 * basis.geometry.ball_diameter, _ROOM)
        return make(now[0])

    return wider


def _point_laws(scene: Scene, basis: Basis, spacing: Spacing) -> tuple[PointLaw | None, PointLaw | None]:
    """Laws of the inner and the outer race's points; the plan has refused those that remember."""
    law = scene.contact.law
    if getattr(law, "constraint", False):
        return None, None
    both = [basis.inner, basis.outer]
    pairs = ContactPairs(
        curvature_a=np.array([e.curvatures[0] for e in both]),
        curvature_b=np.array([e.curvatures[1] for e in both]),
        contact_modulus=np.full(2, basis.modulus),
        hertz_factor=np.array([e.factor for e in both]),
        reference_load=np.full(2, basis.ball_load),
        area=np.full(2, spacing.area),
    )
    params = call_plugin(f"contact law '{scene.contact.kind}'", "build()", lambda: law.build(pairs))
    kernel = plugin_kernel(law, "contact law", LAW, "LAW")
    first, second = (PointLaw(kernel, row, spacing.area) for row in params)
    return first, second
