"""From a scene to the arrays of a ring on its rollers, and what a result tells of line contacts."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway import LAW, ConvergenceError
from raceway.bodies.basis import Basis, changing_speed, excitation, linear_parts, make_basis
from raceway.bodies.model import Bearing, Told
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.system import System
from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import law_params
from raceway.framework.probe import plugin_kernel, probe_excitation, probe_law
from raceway_cylindrical_rollers.compiled import rollers
from raceway_cylindrical_rollers.kind import STRIBECK

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.planning.plan import ScenePlan
    from raceway.planning.resolve import Problem


@attrs.frozen(eq=False)
class RollerBearing(Bearing):
    """Rigid rings on cylindrical rollers.

    Attributes
    ----------
    length : of the line contacts [m];  radii : reduced radii R of the inner and outer contact [m]
    clearance : radial, on the diameter [m]
    """

    length: float
    radii: tuple[float, float]
    clearance: float

    def contact_angles(
        self, model: Model, q: np.ndarray, ball: np.ndarray, force: np.ndarray, t: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Zero where a contact is loaded."""
        inner, outer = np.split(np.where(force > 0.0, 0.0, np.nan), 2, axis=-1)
        return inner, outer

    def contact_ellipse(self, model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Hertz's line contact: p0 = 2 Q / (pi b L), semi-axes L / 2 and b = sqrt(4 Q R / (pi L E*)).

        References
        ----------
        Johnson, Contact Mechanics (1985), section 4.2(c), with E* of both bodies.
        """
        load = np.asarray(load, dtype=float)
        half = np.sqrt(4.0 * load * self.radii[race] / (pi * self.length * self.basis.modulus))
        pressure = 2.0 * load / (pi * np.maximum(half, 1e-300) * self.length)
        return pressure, np.where(load > 0.0, 0.5 * self.length, 0.0), half

    def refuse_impossible(self, model: Model, force: np.ndarray, state: dict[str, np.ndarray] | None = None) -> None:
        """A contact as wide as half a roller."""
        if self.over_edges(model, force, force, force[None]).any():
            raise ConvergenceError(
                f"{force.max():.3g} N a roller make a contact as wide as half a roller: check the units", state
            )

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
        return None, f"law '{model.problem.contact.kind}' was found by experiment: what it is off by is not estimated"


def build(problem: Problem, plan: ScenePlan, length: float, ring_mass: float) -> RollerBearing:
    """The bearing of a scene.

    Parameters
    ----------
    length : of the line contacts [m];  ring_mass : of the inner ring [kg]
    """
    b, found = problem.bearing, make_basis(problem)
    # Clearance makes no contact angle here.
    basis = attrs.evolve(found, geometry=attrs.evolve(found.geometry, contact_angle=0.0))
    inner, outer = 0.5 * (b.pitch_diameter - b.ball_diameter), 0.5 * (b.pitch_diameter + b.ball_diameter)
    radii = 1.0 / (2.0 / b.ball_diameter + 1.0 / inner), 1.0 / (2.0 / b.ball_diameter - 1.0 / outer)
    clearance, force = b.radial_clearance or 0.0, np.array(problem.load.radial)
    most = max(STRIBECK * float(np.hypot(*force)) / b.ball_count, 1.0)
    params = _law_params(problem, basis, length, radii, most)
    state = np.zeros((2 * b.ball_count, problem.contact.law.state_size))
    linear = linear_parts(problem, plan)
    linear["mass"][:3, :3] = (problem.rotor.mass + ring_mass) * np.eye(3)
    system = System(
        kernel=rollers,
        base_kernel=rollers,
        law=plugin_kernel(problem.contact.law, "contact law", LAW, "LAW"),
        law_params=params,
        law_state=state,
        scalars=_scalars(problem, basis, clearance),
        table=_table(problem, plan, basis, length),
        **linear,
        **excitation(problem),
        spin=changing_speed(problem),
    )
    probe_law(problem.contact.law, system.law, params, state)
    if problem.excitation is not None:
        probe_excitation(problem.excitation, system.force, system.force_params)
    guess = np.zeros(5)
    guess[1:3] = (0.5 * clearance + 1e-3 * b.ball_diameter) * force / max(float(np.hypot(*force)), 1e-300)
    return RollerBearing(basis, system, guess, length, radii, clearance)


def _law_params(problem: Problem, basis: Basis, length: float, radii: tuple[float, float], load: float) -> np.ndarray:
    """(2 Z, k): a line contact has no curvature along the roller, and no Hertz factor of an ellipse."""
    z = problem.bearing.ball_count
    both = np.repeat(radii, z)
    pairs = ContactPairs(
        curvature_a=np.zeros(2 * z),
        curvature_b=0.5 / both,
        contact_modulus=np.full(2 * z, basis.modulus),
        hertz_factor=np.full(2 * z, np.nan),
        reference_load=np.full(2 * z, load),
        length=np.full(2 * z, length),
    )
    return law_params(problem.contact.law, pairs)


def _scalars(problem: Problem, basis: Basis, clearance: float) -> np.ndarray:
    out = np.zeros(ring.SCALARS)
    out[ring.REST_RADIAL] = problem.kinematics.radial_expansion - 0.5 * clearance
    out[ring.TILT_ARM] = 0.5 * basis.geometry.pitch_diameter
    out[ring.DAMPING] = problem.contact.dashpot
    if problem.kinematics.orbiting:
        out[ring.CAGE] = basis.geometry.cage_speed(problem.spin_speed)
    return out


def _table(problem: Problem, plan: ScenePlan, basis: Basis, length: float) -> np.ndarray:
    geometry, azimuth = basis.geometry, basis.azimuth
    table = np.zeros((len(azimuth), ring.COLUMNS))
    table[:, ring.COSINE], table[:, ring.SINE], table[:, ring.SIDE] = np.cos(azimuth), np.sin(azimuth), 1.0
    if plan.centrifugal:
        mass = problem.bearing.balls.density * 0.25 * pi * geometry.ball_diameter**2 * length
        table[:, ring.CENTRIFUGAL] = mass * 0.5 * geometry.pitch_diameter * geometry.cage_speed(problem.spin_speed) ** 2
    return table
