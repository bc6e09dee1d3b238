"""Rigid rings on cylindrical rollers: the arrays of a ring on its rollers, and what a result says of line contacts."""

from math import pi
from typing import ClassVar, Protocol

import attrs
import numpy as np

from raceway.bodies.basis import Basis, changing_speed, excitation, linear_parts, make_basis
from raceway.bodies.columns import ColumnBearing, assembled_columns
from raceway.bodies.model import BuiltBearing, Equilibrium, Model, Told
from raceway.core.columns import Number, per_ball
from raceway.core.quantities.ratings import STRIBECK
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels import rollers as lines
from raceway.core.ring.system import System
from raceway.core.signatures import LAW, States
from raceway.errors import ConvergenceError
from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import law_params
from raceway.framework.loading.probe import plugin_kernel, probe_excitation, probe_law
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.scene.bearing import DIMENSIONS
from raceway.scene.bearing import Bearing as BearingTable
from raceway.storage.tables import Tables


class Rollers(Protocol):
    """Options of rollers: effective length of the line contacts [m], crown A / D, laminae."""

    @property
    def roller_length(self) -> float: ...
    @property
    def crown(self) -> float: ...
    @property
    def laminae(self) -> int: ...
    def ring_mass(self, b: BearingTable) -> float:
        """Of the inner ring [kg]."""


@attrs.frozen(eq=False)
class RollerBearing(BuiltBearing):
    """Rigid rings on cylindrical rollers."""

    static_pressure: ClassVar[float] = 4.0e9
    length: float  # of the line contacts [m]
    radii: tuple[float, float]  # reduced radii R of the inner and outer contact [m]
    clearance: float  # radial, on the diameter [m]

    def contact_angles(
        self, model: Model, q: np.ndarray, ball: np.ndarray, force: np.ndarray, t: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Zero where a contact is loaded."""
        inner, outer = np.split(np.where(force > 0.0, 0.0, np.nan), 2, axis=-1)
        return inner, outer

    def contact_ellipse(self, model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Hertz's line contact; see ``line_contact``."""
        return line_contact(np.asarray(load, dtype=float), self.radii[race], self.length, self.basis.modulus)

    def refuse_impossible(self, model: Model, force: np.ndarray, state: dict[str, np.ndarray] | None = None) -> None:
        """A contact as wide as half a roller."""
        if self.over_edges(model, force, force, force[None]).any():
            why = f"{force.max():.3g} N per roller make a contact as wide as half a roller: check the units"
            raise ConvergenceError(why, state)

    def edge_warnings(self, model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> list[str]:
        """None: the length is the effective one, inside the edges."""
        return []

    def over_edges(self, model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> np.ndarray:
        """(n,) whether a contact of a state is as wide as half a roller; forces (n, 2 Z)."""
        loads = np.split(force, 2, axis=-1)
        wide = (2.0 * self.contact_ellipse(model, race, load)[2].max(axis=-1) for race, load in enumerate(loads))
        return np.maximum(*wide) >= 0.5 * self.basis.geometry.ball_diameter

    @property
    def largest_motion(self) -> float:
        """A hundredth of the roller's diameter beyond the clearance [m]: contacts are no lines there."""
        return self.clearance + 0.01 * self.basis.geometry.ball_diameter

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """None."""
        return None, "rigid bodies have no mesh"

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Not known."""
        return None, f"law '{model.problem.contact.kind}' is empirical: its error is not estimated"


def _clearance(problem: Problem) -> Number:
    """Radial, on the diameter [m]; 0 where none is given."""
    return 0.0 if problem.bearing.radial_clearance is None else problem.bearing.radial_clearance


def line_contact(
    load: np.ndarray, radius: Number, length: float, modulus: Number
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Hertz's line contact: p0 = 2 Q / (pi b L) [Pa], semi-axes L / 2 and b = sqrt(4 Q R / (pi L E*)) [m].

    Mean over the length: the profile raises the pressure in the middle.

    Johnson, Contact Mechanics (1985), section 4.2(c), with E* of both bodies.
    """
    half = np.sqrt(4.0 * load * radius / (pi * length * modulus))
    pressure = 2.0 * load / (pi * np.maximum(half, 1e-300) * length)
    return pressure, np.where(load > 0.0, 0.5 * length, 0.0), half


def first_roller_guess(problem: Problem) -> np.ndarray:
    """(..., 5) displacement to look for the equilibrium from [m, rad]: along the radial load, beyond the clearance."""
    b, size, guess = problem.bearing, np.hypot(*problem.load.radial), np.zeros((*problem.points, 5))
    for axis, force in enumerate(problem.load.radial):
        guess[..., 1 + axis] = (0.5 * _clearance(problem) + 1e-3 * b.ball_diameter) * force / np.maximum(size, 1e-300)
    return guess


def build(problem: Problem, plan: ScenePlan, kind: Rollers) -> RollerBearing:
    """The bearing of a scene."""
    b, (basis, radii) = problem.bearing, roller_basis(problem)
    parts = roller_parts(problem, plan, basis, radii, kind)
    linear = linear_parts(problem, plan)
    linear["mass"][:3, :3] = (problem.rotor.mass + kind.ring_mass(b)) * np.eye(3)
    law_state = np.zeros((2 * b.ball_count, problem.contact.law.state_size))
    system = System(law_state=law_state, spin=changing_speed(problem), **parts, **linear, **excitation(problem))
    probe_law(problem.contact.law, system.law, system.law_params, system.law_state)
    if problem.excitation is not None:
        probe_excitation(problem.excitation, system.force, system.force_params)
    return RollerBearing(basis, system, first_roller_guess(problem), kind.roller_length, radii, b.radial_clearance or 0.0)


def roller_basis(problem: Problem) -> tuple[Basis, tuple[Number, Number]]:
    """Geometry, whose clearance makes no contact angle here, and the reduced radii R of the inner and outer contact [m]."""
    b, basis = problem.bearing, make_basis(problem)
    basis = attrs.evolve(basis, geometry=attrs.evolve(basis.geometry, contact_angle=0.0))
    inner, outer = 0.5 * (b.pitch_diameter - b.ball_diameter), 0.5 * (b.pitch_diameter + b.ball_diameter)
    return basis, (1.0 / (2.0 / b.ball_diameter + 1.0 / inner), 1.0 / (2.0 / b.ball_diameter - 1.0 / outer))


def roller_parts(problem: Problem, plan: ScenePlan, basis: Basis, radii: tuple[Number, Number], kind: Rollers) -> Tables:
    """Kernels of rollers and law, and their numbers, with a first axis of n operating points where these have columns."""
    length, geometry, azimuth = kind.roller_length, basis.geometry, basis.azimuth
    out = np.zeros((*problem.points, ring.SCALARS))
    out[..., ring.REST_RADIAL] = problem.kinematics.radial_expansion - 0.5 * _clearance(problem)
    out[..., ring.TILT_ARM] = 0.5 * geometry.pitch_diameter
    out[..., ring.DAMPING] = problem.contact.dashpot
    if problem.kinematics.orbiting:
        out[..., ring.CAGE] = geometry.cage_speed(problem.spin_speed)
    table = np.zeros((*problem.points, problem.bearing.ball_count, lines.DROP + kind.laminae))
    table[..., ring.COSINE], table[..., ring.SINE], table[..., ring.SIDE] = np.cos(azimuth), np.sin(azimuth), 1.0
    table[..., lines.LENGTH] = length
    profile = -np.log(1.0 - (2.0 * lines.places(length, kind.laminae) / length) ** 2)
    table[..., lines.DROP :] = np.multiply.outer(kind.crown * per_ball(geometry.ball_diameter), profile)
    if plan.centrifugal:
        mass = problem.bearing.balls.density * 0.25 * pi * geometry.ball_diameter**2 * length
        force = mass * 0.5 * geometry.pitch_diameter * geometry.cage_speed(problem.spin_speed) ** 2
        table[..., ring.CENTRIFUGAL] = per_ball(force)
    return {
        "kernel": lines.rollers,
        "base_kernel": lines.rollers,
        "law": plugin_kernel(problem.contact.law, "contact law", LAW, "LAW"),
        "law_params": _law_params(problem, basis, length, radii),
        "scalars": out,
        "table": table,
    }


def _law_params(problem: Problem, basis: Basis, length: float, radii: tuple[Number, Number]) -> np.ndarray:
    """(..., 2 Z, k): a line contact has no curvature along the roller, and no Hertz factor of an ellipse."""
    z, load = problem.bearing.ball_count, np.hypot(*problem.load.radial)
    shape = (*problem.points, 2 * z)

    def every(value: Number) -> np.ndarray:
        return np.broadcast_to(per_ball(value) if problem.points else value, shape).astype(float).ravel()

    halves = [np.broadcast_to(per_ball(r) if problem.points else r, (*problem.points, z)) for r in radii]
    pairs = ContactPairs(
        curvature_a=every(0.0),
        curvature_b=0.5 / np.concatenate(halves, axis=-1).ravel(),
        contact_modulus=every(basis.modulus),
        hertz_factor=every(np.nan),
        reference_load=every(np.maximum(STRIBECK * load / z, 1.0)),
        length=every(length),
    )
    params = law_params(problem.contact.law, pairs)
    return params.reshape(*shape, params.shape[1])


class RollerColumns(ColumnBearing):
    """The ring on its rollers at n points."""

    @property
    def conspicuous(self) -> np.ndarray:
        """(n,) whether numbers leave no bearing, or nothing loads it."""
        load, wrong = self.problem.load, np.zeros(self.problem.points, dtype=bool)
        for rule in DIMENSIONS:
            wrong |= rule.when(self.problem.bearing)
        return wrong | ~(np.hypot(*load.radial) + np.hypot(*load.moment) > 0.0)

    def contact_angles(self, states: States) -> tuple[np.ndarray, np.ndarray]:
        """Zero where a contact is loaded; nan where it is open."""
        inner, outer = np.split(np.where(states.force > 0.0, 0.0, np.nan), 2, axis=1)
        return inner, outer

    def contact_ellipse(self, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of line contacts, under loads (n, 2, Z) [N]."""
        kind: Rollers = self.problem.bodies
        basis, radii = roller_basis(self.problem)
        radius = np.stack([np.reshape(r, (-1, 1)) for r in radii], axis=1)
        return line_contact(load, radius, kind.roller_length, np.reshape(basis.modulus, (-1, 1, 1)))

    def pressures(self, force: np.ndarray) -> np.ndarray:
        """(n, 2 Z) peak pressures [Pa] under contact forces (n, 2 Z) [N]."""
        return self.contact_ellipse(force.reshape(len(force), 2, -1))[0].reshape(force.shape)

    def impossible(self, force: np.ndarray) -> np.ndarray:
        """(n,) whether any contact would be as wide as half a roller."""
        half = self.contact_ellipse(force.reshape(len(force), 2, -1))[2]
        return np.asarray(2.0 * half.max(axis=(1, 2)) >= 0.5 * self.basis.geometry.ball_diameter)


def roller_columns(problem: Problem, plan: ScenePlan) -> RollerColumns:
    """See ``raceway.bodies.columns.Builder``."""
    basis, radii = roller_basis(problem)
    kind: Rollers = problem.bodies
    bearing = assembled_columns(RollerColumns, problem, plan, basis, roller_parts(problem, plan, basis, radii, kind))
    bearing.points.guess[:] = first_roller_guess(problem)
    return bearing
