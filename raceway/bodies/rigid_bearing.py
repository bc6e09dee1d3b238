"""Rigid rings and balls: only the contacts deform."""

from typing import Any

import attrs
import numpy as np

from raceway.bodies.basis import Basis, changing_speed, contact_pairs, excitation, linear_parts, make_basis
from raceway.bodies.model import BuiltBearing, Equilibrium, Model, Told, against_hertz
from raceway.bodies.mounting import place_ring
from raceway.core.columns import Number, has_columns, per_ball
from raceway.core.contact.geometry import BallBearing
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.system import System
from raceway.core.signatures import LAW
from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import law_params
from raceway.framework.estimate import Estimate
from raceway.framework.loading.probe import plugin_kernel, probe_excitation, probe_law
from raceway.framework.loading.registry import default_registry
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.storage.tables import Tables

#: Shares of a ball's gyroscopic moment that inner and outer race carry, by hypothesis; 2 together.
_SHARES = {"outer_race": (0.0, 2.0), "shared": (1.0, 1.0), "traction": (1.0, 1.0)}
#: What rolling contacts carry at most, over their load: the coefficient of friction of synthetic oils and greases, on which fast
#: bearings run, in full films (SKF, The SKF model for calculating the frictional moment).
_TRACTION = 0.04


class RigidBearing(BuiltBearing):
    """Rigid rings and balls: the error of their law is all there is to report."""

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """None."""
        return None, Estimate.NO_MESH()

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Against Hertz."""
        return against_hertz(model, equilibrium)


def build(problem: Problem, plan: ScenePlan) -> RigidBearing:
    """The bearing of a scene with rigid bodies."""
    basis = make_basis(problem)
    system = rigid_system(problem, plan, basis)
    probe(problem, basis, system)
    return RigidBearing(basis, system, place_ring(problem, basis, system))


def with_hertz(problem: Problem) -> Problem:
    """The problem with Hertz's law and one force a contact, where other bodies start from."""
    law = default_registry().find("contact_law", "hertz").plugin()
    return attrs.evolve(problem, contact=attrs.evolve(problem.contact, kind=law.name, law=law, discretisation="resultant"))


def rigid_system(problem: Problem, plan: ScenePlan, basis: Basis) -> System:
    """Arrays and kernels; the preload of a pair is not built in yet (``raceway.bodies.mounting``)."""
    law_state = np.zeros((2 * len(basis.azimuth), problem.contact.law.state_size))
    parts = contact_parts(problem, plan, basis) | linear_parts(problem, plan) | excitation(problem)
    return System(law_state=law_state, spin=changing_speed(problem), **parts)


def contact_parts(problem: Problem, plan: ScenePlan, basis: Basis) -> Tables:
    """Kernels of balls and law, and their numbers, with a first axis of n operating points where these have columns."""
    from raceway.core.ring.kernels.rigid_inertial import rigid_inertial, rigid_tangential

    params = law_of_contacts(problem, basis)
    geometry, inner, outer, reference = basis.geometry, basis.inner, basis.outer, basis.ball_load
    out = np.zeros((*problem.points, ring.SCALARS))
    out[..., ring.REST_AXIAL : ring.TILT_ARM + 1] = _grooves(problem, geometry)
    out[..., ring.REST_AXIAL : ring.TILT_ARM + 1] += basis.growth.common
    out[..., ring.DAMPING], out[..., ring.TIME_CONSTANT] = problem.contact.dashpot, problem.time_constant
    if problem.kinematics.orbiting:
        out[..., ring.CAGE] = geometry.cage_speed(problem.spin_speed)
    out[..., ring.DIAMETER] = geometry.ball_diameter
    if problem.contact.friction > 0.0:
        out[..., ring.FRICTION] = problem.contact.friction
        # Along the groove, the ellipse's major axis, the mean of both races.
        nu = 0.5 * (problem.bearing.rings.poisson + problem.bearing.balls.poisson)
        sticking = (e.stick_ratio(nu)[0] * 1.5 * reference / float(e.approach(reference)) for e in (inner, outer))
        out[..., ring.STICK] = problem.contact.stick_stiffness or 0.5 * sum(sticking)
    if plan.gyroscopic:
        add_moments(out, problem, geometry)
    return {
        "kernel": rigid_tangential if plan.balls == "tangential" else rigid_inertial,
        "base_kernel": rigid_inertial,  # whose forces have a potential
        "law": plugin_kernel(problem.contact.law, "contact law", LAW, "LAW"),
        "law_params": params,
        "scalars": out,
        "table": _ball_table(problem, plan, basis),
    }


class _Pairs(ContactPairs):
    """Contacts that know whether their reference load was asked for."""

    load_matters = False

    def __getattribute__(self, name: str) -> Any:
        if name == "reference_load":
            object.__setattr__(self, "load_matters", True)
        return super().__getattribute__(name)


def law_of_contacts(problem: Problem, basis: Basis) -> np.ndarray:
    """(..., 2 Z, k) parameters of the law; those of one point stand for all whose contacts differ in their reference load, unless it reads that."""
    law, points = problem.contact.law, problem.points
    if points and not has_columns(problem.bearing) and not has_columns(problem.contact):
        first = attrs.evolve(basis, ball_load=float(np.ravel(basis.ball_load)[0]))
        one = _Pairs(**attrs.asdict(contact_pairs(attrs.evolve(problem, points=(1,)), first), recurse=False))
        params = law_params(law, one)
        if not one.load_matters:
            return np.repeat(params[None], points[0], axis=0)
    params = law_params(law, contact_pairs(problem, basis))
    return params.reshape(*points, -1, params.shape[1])


def probe(problem: Problem, basis: Basis, system: System) -> None:
    """Try the plug-ins' kernels as deep as the load presses, and well beyond: a ball may have many times the mean."""
    load = basis.ball_load + 5.0 * max(np.abs(system.load[:3]).max(), 1.0) / len(basis.azimuth)
    approach = float(np.max(basis.inner.approach(load)))
    depths = [factor * approach for factor in (0.3, 1.0, 3.0, 10.0)]
    probe_law(problem.contact.law, system.law, system.law_params, system.law_state, depths=depths)
    if problem.excitation is not None:
        probe_excitation(problem.excitation, system.force, system.force_params)


def _grooves(problem: Problem, geometry: BallBearing) -> np.ndarray:
    """(..., 5) of the scalars REST_AXIAL to TILT_ARM of a row's geometry, before anything grows [m]."""
    arm = geometry.inner_centre_radius if problem.bearing.tilt_arm == "groove" else 0.5 * geometry.pitch_diameter
    numbers = (*geometry.rest, geometry.offset_inner, geometry.offset_outer, arm)
    return np.stack(np.broadcast_arrays(*numbers), axis=-1)


def add_moments(scalars: np.ndarray, problem: Problem, geometry: BallBearing) -> None:
    """The balls' gyroscopic moments, by the scene's hypothesis."""
    scalars[..., [ring.SHARE_INNER, ring.SHARE_OUTER]] = _SHARES[problem.kinematics.gyroscopic]
    scalars[..., ring.TRACTION] = _TRACTION if problem.kinematics.gyroscopic == "traction" else 0.0
    scalars[..., ring.BALL_OVER_PITCH] = geometry.ball_diameter / geometry.pitch_diameter
    moment_of_inertia = geometry.ball_mass(problem.bearing.balls.density) * geometry.ball_diameter**2 / 10.0
    scalars[..., ring.GYROSCOPIC] = moment_of_inertia * problem.spin_speed * geometry.cage_speed(problem.spin_speed)


def _ball_table(problem: Problem, plan: ScenePlan, basis: Basis) -> np.ndarray:
    """(..., Z, k); numbers of balls are columns of the table, those of points have their axis before the balls'."""
    inner, outer, azimuth, row, several = basis.inner, basis.outer, basis.azimuth, basis.row, not problem.bearing.equal_rows

    def spread(value: Number) -> Number:
        return value if several else per_ball(value)

    softness = inner.factor ** (-2.0 / 3.0), outer.factor ** (-2.0 / 3.0)
    side, lever = np.array(problem.bearing.rows)[row].T
    columns = {
        ring.COSINE: np.cos(azimuth), ring.SINE: np.sin(azimuth), ring.SIDE: side, ring.LEVER: lever,
        ring.OUTER_SHARE: spread(softness[1] / sum(softness)), ring.OUTER_FACTOR: spread(outer.factor),
    }  # fmt: skip
    # What points share is written into all of them at once.
    table = np.zeros((len(row), ring.COLUMNS))
    for column in [column for column, value in columns.items() if np.ndim(value) < 2]:
        table[:, column] = columns.pop(column)
    table = np.broadcast_to(table, (*problem.points, *table.shape)).copy()
    for column, value in columns.items():
        table[..., column] = value
    if plan.centrifugal:
        for k, geometry in enumerate(basis.geometries):
            cage, mass = geometry.cage_speed(problem.spin_speed), geometry.ball_mass(problem.bearing.balls.density)
            table[..., row == k, ring.CENTRIFUGAL] = per_ball(mass * 0.5 * geometry.pitch_diameter * cage**2)
    if several:
        grooves = np.array([_grooves(problem, geometry) for geometry in basis.geometries])
        table[:, ring.OWN_REST_AXIAL : ring.OWN_TILT_ARM + 1] = (grooves - grooves[0])[row]
    if np.any(basis.growth.by_ball):
        table[..., ring.OWN_REST_AXIAL : ring.OWN_TILT_ARM + 1] += basis.growth.by_ball
    return table
