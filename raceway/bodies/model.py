"""A bearing that was built, whatever its bodies are made of, and the model that a run computes with."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import attrs
import numpy as np

from raceway.bodies.basis import Basis
from raceway.bodies.contacts import (
    beyond_the_groove,
    contact_angles,
    contact_ellipse,
    ellipse_ends,
    groove_edges,
    law_of_pair,
)
from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import Ellipse
from raceway.core.record import Motion, Record
from raceway.core.ring.orbit import Orbit, at_rest, from_orbit, static_orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import compiled
from raceway.errors import ConvergenceError, PluginError, SceneError
from raceway.framework.contracts import Traits
from raceway.framework.doors import door, reader
from raceway.framework.duties import renews
from raceway.framework.estimate import Estimate
from raceway.planning.plan import ScenePlan, make_plan
from raceway.planning.resolve import Problem, resolve
from raceway.scene.scene import SCENE, Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.core.fem.structural import ElasticBodies

#: A number and how it was found, or None and why there is none.
Told = tuple[float | None, str]


@attrs.frozen(eq=False)
class BuiltBearing(ABC):
    """A bearing of one kind of bodies.

    basis : geometry and contacts that do not depend on loads
    system : the ring on its balls
    guess : (5,) first guess of the equilibrium, with a held axial displacement
    """

    #: Contact pressure [Pa] on which static load ratings are based; 4.0e9 of rollers (ISO 76: ball and race then dent by 1e-4 D).
    static_pressure: ClassVar[float] = 4.2e9
    basis: Basis
    system: Ring
    guess: np.ndarray

    def solve_equilibrium(
        self, near: np.ndarray | None = None, on_progress: Callable[[str, int, int], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Displacement (5,), balls (Z, k) and iterations at the equilibrium under the constant loads.

        near : (5,) equilibrium of a similar bearing;  on_progress : called as ``on_progress(what, done, total)``, ``total``
            0 where nobody knows; both for bodies whose equilibria take long

        ConvergenceError: None was found.
        """
        return self.system.solve_equilibrium(self.guess)

    def periodic_system(self, system: Ring) -> Ring:
        """The ring whose steady orbit a motion may start on: without friction, its balls at their azimuths."""
        return system.at_standstill()

    def on_orbit(self, system: Ring, orbit: Orbit, dt: float) -> Motion:
        """The start on a steady orbit, moving with it."""
        return from_orbit(system, orbit, dt)

    def at_rest(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """The start at rest in an equilibrium; without a ramp the excitation acts at once."""
        return at_rest(system, q, ball, ramped)

    def at_equilibrium(self, system: Ring, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
        """The start of a series of equilibria, without a ramp under the excitation's force at time zero."""
        return static_orbit(system, q, ball, ramped)

    def friction_lost(self, system: Ring, record: Record) -> float:
        """Energy that friction has taken at the end of a record [J]."""
        from raceway.core.ring.energy import friction_energy

        ring = compiled(system)
        return 0.0 if ring is None else float(friction_energy(ring, record).lost[-1])

    @property
    def foreseen(self) -> Ring | None:
        """A system that shows in milliseconds what nothing holds; None where the own equilibrium does."""
        return None

    def has_places(self, balls: str) -> bool:
        """Whether ``ball[:, :2]`` are the balls' places; False where they lie between the groove centres.

        balls : the plan's "weightless", "inertial" or "tangential"
        """
        return True

    def contact_angles(
        self, model: Model, q: np.ndarray, ball: np.ndarray, force: np.ndarray, t: np.ndarray | float = 0.0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Inner and outer contact angles (Z,) [rad] under contact forces (2 Z,); nan where a contact carries nothing.

        Of several states (n, 5), (n, Z, k), (n, 2 Z) at times (n,): (n, Z).
        """
        return contact_angles(model.system.centre_vectors(q, t, ball)[0], self.has_places(model.plan.balls), ball, force)

    def contact_ellipse(self, model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Peak pressure [Pa] and semi-axes [m] (n,) of the contacts of a race (0 inner, 1 outer) at loads (n,) [N]."""
        return contact_ellipse(model.problem, self.basis, model.system, race, load)

    def refuse_impossible(self, model: Model, force: np.ndarray, state: dict[str, np.ndarray] | None = None) -> None:
        """Loads (2 Z,) [N] that no contact can carry: an ellipse longer than half the ball's circumference.

        ConvergenceError: With ``state``, the solution that says so.
        """
        basis, radius = self.basis, self.basis.ball_radius
        inner, outer = np.split(force, 2)
        for race, ellipse, load in (("inner", basis.inner, inner), ("outer", basis.outer, outer)):
            half = ellipse.semi_axes(load)[0] / radius
            if half.max(initial=0.0) >= 0.5 * np.pi:
                raise ConvergenceError(
                    f"the contact ellipse on the {race} race would be {np.degrees(2.0 * half.max()):.0f} deg of the ball, more than half its "
                    f"circumference, under {load[np.argmax(half)]:.3g} N per ball: no such contact exists. Check units and loads "
                    "(bearing.rings.young in Pa, lengths in m)",
                    state,
                )

    def edge_warnings(self, model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> list[str]:
        """A sentence for each race whose contacts run over its edge; angles (Z,), forces (2 Z,)."""
        return beyond_the_groove(model.problem, self.basis, inner, outer, force)

    def over_edges(self, model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> np.ndarray:
        """(n,) whether any contact of a state may run over its edge; angles (n, Z), forces (n, 2 Z)."""
        ends = ellipse_ends(self.basis, inner, outer, force)
        return np.asarray(np.logical_or(*(end > groove_edges(model.problem, self.basis) for end in ends)).any(axis=-1))

    @property
    def largest_motion(self) -> float:
        """Displacement [m] beyond which no ball stays in its groove."""
        return self.basis.geometry.centre_distance

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,)."""
        return {}

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json; empty where there is nothing to report."""
        return {}

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """What a user should know of the bodies at the equilibrium."""
        return []

    @abstractmethod
    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Relative error of the stiffness or displacement by the bodies' meshes."""

    @abstractmethod
    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Relative error of loaded contacts by their law or its calibration; some contact is loaded."""


@attrs.frozen(eq=False)
class Model:
    """Everything that a run computes with.

    Attributes
    ----------
    bearing : what was built of the bodies;  system : its ring, or a copy at another speed
    """

    problem: Problem
    plan: ScenePlan
    bearing: BuiltBearing
    system: Ring

    @property
    def scene(self) -> Scene:
        """What the user said."""
        return self.problem.scene

    @property
    def basis(self) -> Basis:
        return self.bearing.basis

    @property
    def geometry(self) -> BallBearing:
        """Lengths of the row."""
        return self.basis.geometry

    @property
    def inner(self) -> Ellipse:
        """Load-independent Hertz contact of the inner race."""
        return self.basis.inner

    @property
    def outer(self) -> Ellipse:
        """Load-independent Hertz contact of the outer race."""
        return self.basis.outer

    @property
    def azimuth(self) -> np.ndarray:
        """(Z,) at time zero, rows one after the other [rad]."""
        return self.basis.azimuth

    @property
    def guess(self) -> np.ndarray:
        """(5,) first guess of the equilibrium, with a held axial displacement."""
        return self.bearing.guess

    @property
    def excitation(self) -> Any:
        return self.problem.excitation

    @property
    def traits(self) -> Traits:
        """Of the bodies in this scene."""
        return self.problem.traits

    @property
    def mass_used(self) -> float:
        """m of K = Re Z + m w^2 [kg]: that of the ring and its share of the rotor; 0 without inertia forces."""
        return float(self.system.mass[1, 1]) if self.problem.integrator.method.inertial else 0.0


@door
def build_model(
    scene: Annotated[Scene, SCENE],
    plan: Annotated[ScenePlan | None, reader("a plan, as raceway.make_plan makes it", ScenePlan)] = None,
) -> Model:
    """Arrays and kernels of a scene, by its kind of bodies, and by ``make_plan(scene)`` where no plan is given.

    Raises
    ------
    PluginError
        A law that builds parameters of a wrong shape, or bodies that build no bearing.
    ConvergenceError
        No equilibrium under the axial load whose displacement is to be held.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = rw.Scene.from_toml("examples/b7206.toml")
    >>> round(rw.build_model(scene).mass_used, 2)  # of ring and rotor [kg]
    2.06
    """
    plan = make_plan(scene) if plan is None else plan
    if scene.heat is not None and plan.problem.mounting is scene.mounting:
        why = "is supported by runs, functions, sweeps and bands: set the temperatures of [mounting] here"
        raise SceneError.at("heat", None, why)
    return model_of(plan.problem if plan.problem.scene is scene else resolve(scene), plan)


def model_of(problem: Problem, plan: ScenePlan) -> Model:
    """The same as ``build_model``, of a problem."""
    bearing = problem.body_kind.build(plan)
    if not isinstance(bearing, BuiltBearing):
        why = f"bodies '{problem.bodies.name}': build() returned {type(bearing).__name__}; it must be a raceway.extend.BuiltBearing"
        raise PluginError(why)
    return Model(problem, plan, bearing, bearing.system)


@attrs.frozen(eq=False)
class Equilibrium:
    """The static state under the constant loads.

    Attributes
    ----------
    displacement : (5,) x, y, z [m], tilts [rad]
    stiffness : (5, 5) tangent of the contacts, rows on a spring following: how the constant loads change by the displacement
    damping : (5, 5) of the contacts there, of slow motions, w -> 0 [N s/m, N s/rad, N m s/m, N m s/rad]; 0 for elastic bodies, which
        know it in motion only
    stiffness_rows_held, damping_rows_held : the same with rows on a spring held where they stand, as within a motion
    ball : (Z, 2) positions in the meridian planes [m]
    gap, contact_force : (2 Z,) inner races first [m, N]
    angle_inner, angle_outer : (Z,) contact angles [rad], nan where a contact is open
    warnings : what a user should know
    """

    displacement: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    stiffness_rows_held: np.ndarray
    damping_rows_held: np.ndarray
    ball: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    angle_inner: np.ndarray
    angle_outer: np.ndarray
    iterations: int
    warnings: tuple[str, ...]


def tilts_follow(stiffness: np.ndarray, tilt: float | str) -> float | None:
    """Static condensation of the tilts: kyy - k_yt (k_tt + k_shaft I)^-1 k_ty [N/m].

    stiffness : (5, 5) tangent stiffness of the equilibrium
    tilt : the scene's ``supports.tilt``: "locked" (None is returned), "free", or the tilt stiffness of the shaft [N m/rad]
    """
    if tilt == "locked":
        return None
    tilts = stiffness[3:, 3:] + (tilt if isinstance(tilt, float) else 0.0) * np.eye(2)
    if not np.linalg.det(tilts):
        return float(stiffness[1, 1])
    return float(stiffness[1, 1] - stiffness[1, 3:] @ np.linalg.solve(tilts, stiffness[3:, 1]))


def calibration_error(
    compliances: ElasticBodies, model: Model, equilibrium: Equilibrium, more: float = 0.0
) -> tuple[float | None, str]:
    """Relative error of a ball's stiffness by what its contacts' calibration leaves, the largest of all loaded balls; and how.

    more : error of the compliance of each contact besides [m/N]
    """
    at_inner, at_outer = compliances.calibrations
    if at_inner is None or at_outer is None:
        return None, Estimate.NOT_CALIBRATED()
    z = model.system.ball_count
    force = equilibrium.contact_force
    loaded = (force[:z] > 0.0) & (force[z:] > 0.0)
    if not loaded.any():
        return None, Estimate.NO_BALL_LOADED()
    inner, outer = force[:z][loaded], force[z:][loaded]
    give = model.inner.approach(inner) / (1.5 * inner) + model.outer.approach(outer) / (1.5 * outer)
    give += sum(compliances.at(float(np.nanmean(equilibrium.angle_inner)))) + 2.0 * compliances.ball_opposite
    error = at_inner.error(inner) + at_outer.error(outer) + 2.0 * more
    return float((error / give).max()), Estimate.CALIBRATED()


#: Differences from Hertz's approach below this are rounding, of an equilibrium solved to 1e-11.
_ROUNDING = 1e-8


def against_hertz(model: Model, equilibrium: Equilibrium) -> Told:
    """Largest relative difference of a loaded contact's approach or stiffness from Hertz's at the same load."""
    if renews(model.problem.contact.law):
        return None, Estimate.BEYOND_HERTZ(kind=model.problem.contact.kind)
    loaded = equilibrium.contact_force > 0.0
    split = model.system.ball_count
    force = equilibrium.contact_force
    hertz = np.concatenate([model.inner.approach(force[:split]), model.outer.approach(force[split:])])
    approach = -equilibrium.gap
    off = float(np.abs(approach[loaded] / hertz[loaded] - 1.0).max())
    slope = np.concatenate([
        law_of_pair(model.system, race, part)[1] for race, part in enumerate((approach[:split], approach[split:]))
    ])  # fmt: skip
    stiffness = float(np.abs(slope[loaded] * hertz[loaded] / (1.5 * force[loaded]) - 1.0).max())
    if max(off, stiffness) < _ROUNDING:
        return None, Estimate.HERTZ_ITSELF()
    return max(off, stiffness), Estimate.AGAINST_HERTZ(stiffness=stiffness, approach=off)


def overlap(columns: Mapping[str, np.ndarray], equilibrium: Equilibrium) -> Told:
    """Largest share of a loaded contact's approach that the surfaces overlap; ``columns`` : those of the balls."""
    loaded = equilibrium.contact_force > 0.0
    penetration, approach = (
        np.concatenate([columns[f"{name}_{race}_m"] for race in ("inner", "outer")])[loaded]
        for name in ("approach_penetration", "approach")
    )
    return float((penetration / np.maximum(approach, 1e-300)).max()), Estimate.OVERLAP()


def untold(model: Model) -> Told:
    """Of laws that are calibrated to Hertz and nothing more is known of."""
    return None, Estimate.LAW_UNKNOWN(kind=model.problem.contact.kind)
