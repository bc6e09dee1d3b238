"""Elastic rings and balls whose every node is a degree of freedom: pressures at points, or a calibrated force a contact."""

import attrs
import numpy as np

from raceway.bodies.basis import Basis, at_points, contact_pairs, make_basis
from raceway.bodies.mounting import place_ring
from raceway.bodies.rigid_bearing import probe, rigid_system, with_hertz
from raceway.core.fem.elastic.bearing import ElasticBearing
from raceway.core.fem.elastic.bearing_data import BearingData
from raceway.core.fem.elastic.resultant import ResultantContact
from raceway.core.fem.elastic.ring import ElasticRing
from raceway.core.ring.kernels.layout import CENTRIFUGAL, FRICTION
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System
from raceway.core.signatures import LAW
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.duties import is_hertzian, law_params
from raceway.framework.loading.probe import plugin_kernel
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.plugins.bodies.elastic_contacts import ElasticBodies, ElasticResultants
from raceway.plugins.bodies.elastic_stress import ElasticPoints
from raceway.plugins.bodies.mesh import check_sets, least_step, mesh_bodies, mesher_of

#: Loads of a ball over the mean one under which a law has to keep some compliance of its own.
_ENOUGH = 5.0


def build(problem: Problem, plan: ScenePlan) -> ElasticBodies:
    """The bearing of a scene with elastic bodies.

    MeshError: Bodies that cannot be meshed, or that overlap by more than an element before anything is loaded.
    """
    basis, resultants = make_basis(problem, meshed=True), problem.contact.discretisation == "resultant"
    as_rigid = problem if resultants else with_hertz(problem)
    rigid = rigid_system(as_rigid, plan, basis).without(FRICTION)
    probe(as_rigid, basis, rigid)
    guess = place_ring(as_rigid, basis, rigid)
    setup = _setup(problem, basis, rigid)
    if resultants:
        from raceway.plugins.bodies.condensed_bearing import elastic_bodies

        params = rigid.law_params
        angles = _angles(problem, plan, rigid, guess)
        # Of the bearing's own rings and balls, whatever mesh stands for them: the calibration is local.
        compliances = elastic_bodies(attrs.evolve(problem, mesh=None), basis)
        beyond = np.concatenate([compliances.beyond(race, of) for race, of in enumerate(np.split(angles, 2))])
        setup = attrs.evolve(setup, angles=angles, beyond=beyond, params=lambda pair, area: params[pair])
    meshes = mesh_bodies(problem)
    check_sets(mesher_of(problem), meshes, problem.supports)
    bodies = ElasticBearing(meshes, setup)
    if resultants:
        # A law that has less compliance than the mesh under its contacts.
        contact = bodies.system.contact
        assert isinstance(contact, ResultantContact)
        n, load = len(contact.local), _ENOUGH * basis.ball_load
        gap = np.full(n, -float(basis.inner.approach(load)))
        force, d_gap, d_rate = np.empty(n), np.empty(n), np.empty(n)
        contact.law(gap, np.zeros(n), contact.params, contact.memory, contact.memory.copy(), 0.0, force, d_gap, d_rate)
        if (-d_gap * contact.local).max() >= 1.0:
            remedy = "Take a smaller load" if is_hertzian(problem.contact.law) else "Use 'hertz' or a softer law"
            contacts = f"contact of {-1e-6 * d_gap.min():.3g} N/µm at an approach of {-1e6 * gap[0]:.3g} µm"
            mesh = f"the mesh below it, which gives {1e9 * contact.local.max():.3g} nm/N alone"
            remedy = f"{remedy}, or take contact.discretisation = 'nodal'"
            why = f"its {contacts} is stiffer than {mesh}: no compliance remains for the law. {remedy}"
            raise SceneError.at("contact.kind", problem.contact.kind, why)
    fields = {f.name: getattr(rigid, f.name) for f in attrs.fields(Ring)}
    held_by = problem.load.axial if problem.supports.axial == "displacement" else None
    fields["mass"] = rigid.mass + bodies.system.assembly.added_inertia()
    system = ElasticRing(**fields, rigid=rigid, bodies=bodies, held_by=held_by)
    if resultants:
        return ElasticResultants(basis, system, guess, bodies, rigid, compliances)
    return ElasticPoints(basis, system, guess, bodies, rigid)


def _angles(problem: Problem, plan: ScenePlan, rigid: System, guess: np.ndarray) -> np.ndarray:
    """(2 Z,) contact angles with rigid bodies, inner races first; the free one where a ball carries nothing."""
    angles = np.full(2 * rigid.ball_count, problem.bearing.contact_angle)
    try:
        q, ball, _ = rigid.solve_equilibrium(guess)
    except ConvergenceError:  # said better where the equilibrium is looked for
        return angles
    inner = outer = rigid.centre_vectors(q)[0]
    if plan.centrifugal:
        inner, outer = inner - ball[:, :2], ball[:, :2]
    loaded = np.concatenate([np.arctan2(way[:, 0], way[:, 1]) for way in (inner, outer)])
    return np.where(rigid.evaluate(q, ball=ball).contact_force > 0.0, loaded, angles)


def _setup(problem: Problem, basis: Basis, rigid: System) -> BearingData:
    b, rotor, contact = problem.bearing, problem.rotor, problem.contact
    inertia = [rotor.mass] * 3 + [rotor.transverse_inertia] * 2  # the ring's own is in its mesh
    pairs = contact_pairs(problem, basis)
    outer = 0.0 if problem.excitation is None else problem.excitation.amplitude_n
    # A radial load is carried by a few balls: 5 F / Z (Stribeck).
    most = basis.ball_load + 5.0 * (float(np.hypot(*problem.load.radial)) + outer) / b.ball_count
    # Stiffness of sticking points [N/m3] from that of a contact: spread over Hertz's ellipse.
    sticking, (along, across) = contact.stick_stiffness, map(float, basis.inner.semi_axes(basis.ball_load))
    return BearingData(
        geometry=basis.geometry,
        azimuth=basis.azimuth,
        rings=(b.rings.young, b.rings.poisson, b.rings.density),
        balls=(b.balls.young, b.balls.poisson, b.balls.density),
        reference_load=0.25 * most if most > 4.0 * basis.ball_load else basis.ball_load,
        law=plugin_kernel(contact.law, "contact law", LAW, "LAW"),
        params=lambda pair, area: law_params(contact.law, at_points(pairs, pair, area), "surface point"),
        state_size=contact.law.state_size,
        mass=np.diag(inertia),
        damping=rigid.damping,
        stiffness=rigid.stiffness,
        free=rigid.free > 0.0,
        load=rigid.load,
        formulation=problem.bodies.formulation,
        hourglass=problem.bodies.hourglass,
        least_step=least_step(problem),
        seat_inner=problem.supports.inner_seat,
        seat_outer=problem.supports.outer_seat,
        contact_damping=contact.dashpot,
        ball_force=float(rigid.table[0, CENTRIFUGAL]),
        growth=problem.running.radial_growth(b.of_rows[0]),
        friction=contact.friction,
        stick=None if sticking is None else sticking / (np.pi * along * across),
    )
