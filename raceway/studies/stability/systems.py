"""Systems that the catalogue's cases are measured on, and what is expected of them by a law's own force and stored energy.

Approaches are the inverse of the law's force function, found by bisection; forces on the ring are slopes of the stored energy.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import atan2, sin, sqrt
from typing import TYPE_CHECKING, cast

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, build_model
from raceway.bodies.running import running_pairs
from raceway.core.contact.damping import stored_energy
from raceway.core.excitations import no_force
from raceway.core.record import Motion, Record, Schedule
from raceway.core.ring.energy import energy_balance
from raceway.core.ring.orbit import at_rest
from raceway.core.ring.system import System, surrogate
from raceway.framework.duties import law_params, reach_of, renews
from raceway.framework.registry import Registry
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.run import run
from raceway.planning.plan import make_plan
from raceway.points.axes import tables_at
from raceway.scene.changes import without
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.framework.contracts import ContactLaw, Integrator
    from raceway.pipeline.result import Result

#: Halvings of an interval: to the last bit of a double from any first one.
_HALVINGS = 200
#: Rounds in which the contact angle settles: films depend on its cosine, and move it by a thousandth of that.
_ANGLES = 6
#: Loads of a ball over the mean one at which bodies that deform refuse a law.
_LOADS = (1.0, 5.0)
#: Step of a difference over the deepest penetration: its error is the square of that.
_PART = 1e-3


def mass_at(position: float, speed: float = 0.0, acceleration: float = 0.0) -> Motion:
    """The motion of one mass on one contact, along x."""
    x = np.eye(5)[0]
    return Motion(position * x, speed * x, acceleration * x, np.zeros((1, 2)), np.zeros((1, 2)))


@attrs.frozen(eq=False)
class Still:
    """A bearing in its equilibrium, without an excitation.

    Attributes
    ----------
    limit : stable step of central differences for small motions [s]
    dissipative : whether the law loses energy by itself
    """

    model: Model
    system: System
    equilibrium: Equilibrium
    limit: float
    dissipative: bool

    def displaced(self, by: np.ndarray) -> Motion:
        """At rest, moved by (5,) [m, rad]."""
        system, q = self.system, self.equilibrium.displacement + by
        now = system.evaluate(q, ball=self.equilibrium.ball)
        a = system.acceleration(q, np.zeros(5), np.zeros(5), now)
        return Motion(q, np.zeros(5), a, now.ball, now.ball.copy())

    def direction(self, size: float) -> np.ndarray:
        """(5,) along every free coordinate, ``size`` of the axial approach; tilts by the arm."""
        weight = np.array([1.0, 0.5, 0.3, 0.2 / self.system.arm, 0.1 / self.system.arm])
        return size * abs(self.equilibrium.displacement[0]) * weight * self.system.free


@attrs.frozen
class Bench:
    """What a case is measured on: the bearing of a scene's tables with some keys changed, and the plug-ins of a registry."""

    tables: Tables
    changes: Tables
    registry: Registry

    def over(self, changes: Tables) -> Bench:
        """With more keys changed, its own changes upon them."""
        return attrs.evolve(self, changes={**changes, **self.changes})

    def changed(self, changes: Tables) -> Bench:
        """With more keys changed, upon its own changes."""
        return attrs.evolve(self, changes={**self.changes, **changes})

    @property
    def scene(self) -> Scene:
        """The scene; a change to None takes the key out."""
        tables = tables_at(
            self.tables, {key: value for key, value in self.changes.items() if value is not None}, self.registry
        )
        for key in (key for key, value in self.changes.items() if value is None):
            tables = without(tables, key)
        return scene_from_dict(tables, self.registry)

    def model(self) -> Model:
        return build_model(scene := self.scene, make_plan(scene))

    def result(self) -> Result:
        return run(self.scene, self.registry)

    def still(self) -> Still:
        """The bearing in equilibrium, nothing exciting it."""
        model = self.model()
        equilibrium = solve_equilibrium(model)
        system = attrs.evolve(surrogate(model.system), force=no_force, force_params=np.zeros(1))
        damping = system.evaluate(equilibrium.displacement, ball=equilibrium.ball).damping
        limit = system.damped_time_step(equilibrium.stiffness_rows_held, damping)
        return Still(model, system, equilibrium, limit, model.problem.contact.law.dissipative)

    def method(self, name: str, tolerance: float | None = None) -> Integrator:
        """An integrator; an implicit one with another tolerance of its steps."""
        plugin = self.registry.find("integrator", name).plugin
        options = {} if tolerance is None or "tolerance" not in attrs.fields_dict(plugin) else {"tolerance": tolerance}
        return cast("Integrator", plugin(**options))


def inverted(function: Callable[[float], float], value: float, first: float) -> float:
    """Argument at which a function that grows from 0 at 0 takes a value; ``first``: a guess of the size."""
    low, high = 0.0, first
    while function(high) < value:
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if function(middle) < value else (low, middle)
    return high


def _force_and_slope(model: Model, pair: int, approach: float, params: np.ndarray | None = None) -> tuple[float, float]:
    """Force [N] and stiffness [N/m] of one ball-race pair at rest, by the law's kernel; ``params`` (2 Z, k): not the model's."""
    system = surrogate(model.system)
    law_params = system.law_params if params is None else params
    params, state = (np.ascontiguousarray(each[pair : pair + 1]) for each in (law_params, system.law_state))
    force, d_gap, d_rate = np.empty(1), np.empty(1), np.empty(1)
    system.law(np.array([-approach]), np.zeros(1), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return float(force[0]), -float(d_gap[0])


def _force_at(model: Model, pair: int, params: np.ndarray | None, approach: float) -> float:
    return _force_and_slope(model, pair, approach, params)[0]


def axial_displacement(model: Model) -> float:
    """Displacement [m] under the axial load alone, the balls weightless.

    Notes
    -----
    All balls carry the same load Q at both races, so that groove centres are s = s0 + delta_i(Q) + delta_o(Q) apart; their
    radial distance r stays, and cos alpha = r / s, F = Z Q sin alpha, which grows with Q and is inverted.  A law that begins to
    carry before surfaces touch has its reach taken off delta; one that follows speed and loads is built at Q and alpha.
    """
    z, rest_axial, rest_radial = model.system.ball_count, *model.geometry.rest
    size = 1e-3 * model.geometry.ball_diameter

    def axial(load: float) -> float:
        angle = model.problem.bearing.contact_angle
        for _ in range(_ANGLES if renews(model.problem.contact.law) else 1):
            params, reach = _at_load(model, load, angle)
            approach = 0.0
            for pair in (0, z):
                force_at = partial(_force_at, model, pair, params)
                approach += inverted(force_at, load, size) - float(reach[pair])
            distance = model.geometry.centre_distance + approach
            moved = sqrt(max(distance**2 - rest_radial**2, 0.0))
            angle = atan2(moved, rest_radial)
        return moved

    def force(load: float) -> float:
        moved = axial(load)
        return z * load * moved / sqrt(moved**2 + rest_radial**2)

    total = model.problem.load.axial
    load = inverted(force, total, total / (z * max(sin(model.problem.bearing.contact_angle), 0.1)))
    return axial(load) - rest_axial


def _at_load(model: Model, load: float, angle: float) -> tuple[np.ndarray | None, np.ndarray]:
    """Parameters and reach (2 Z,) of the law where all contacts carry a load [N] at an angle [rad]."""
    z, law = model.system.ball_count, model.problem.contact.law
    if not renews(law):
        return None, np.zeros(2 * z)
    angles = np.full(z, angle)
    pairs = running_pairs(model.problem, model.basis, np.full(2 * z, load), (angles, angles))
    return law_params(law, pairs), reach_of(law, pairs)


def stiffer_than_hertz(model: Model, ball_load: float) -> bool:
    """Whether the law's own slope is above Hertz's where bodies that deform look at it; they leave Hertz's law room."""
    for pair, ellipse in ((0, model.inner), (model.system.ball_count, model.outer)):
        for load in (factor * ball_load for factor in _LOADS):
            approach = float(ellipse.approach(load))
            if _force_and_slope(model, pair, approach)[1] > 1.5 * load / approach:
                return True
    return False


def axial_force(model: Model, equilibrium: Equilibrium) -> float:
    """Slope [N] of the stored energy along the ring's axial displacement, in equilibrium; for conservative forces.

    Notes
    -----
    Balls are in equilibrium themselves, so that what follows of them does not count.  Unlike a sum over the balls' loads it
    holds what a compliance that varies with the contact angle pushes along the groove.
    """
    system, axis, q = surrogate(model.system), np.eye(5)[0], equilibrium.displacement
    step = _PART * float(np.max(-system.evaluate(q, ball=equilibrium.ball).gap))
    moved = np.array([q + sign * step * axis for sign in (-1.0, 1.0)])
    states = [system.evaluate(each, ball=equilibrium.ball) for each in moved]
    gap, force, ball = (np.array([getattr(state, name) for state in states]) for name in ("gap", "contact_force", "ball"))
    rates, final = np.zeros((2, 5)), at_rest(system, moved[1], ball[1], False)
    record = Record(np.array([0.0, 1.0]), moved, rates, rates, gap, force, ball, final, Schedule(1.0, 2, 1), {})
    stored = energy_balance(system, record).stored
    # Contacts by the law's force between both gaps: over the whole approach a law with a short transition at first touch, such
    # as a roughness, is integrated to 1e-5 only, which the small difference of two energies magnifies.
    before, after = (energy_of_contacts(system.law, system.law_params, system.law_state, each).sum() for each in gap)
    change = stored[1] - stored[0] - float(after - before) + _between(system, gap)
    # The stored energy counts the load's potential, too, whose slope is the load.
    return float(system.load[0] + change / (2.0 * step))


def energy_of_contacts(law: ContactLaw, params: np.ndarray, state: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """(n,) energy [J] stored in contacts at gaps (n,), integrated from first touch."""
    energy = np.empty(len(gap))
    stored_energy(law, params, state, state.copy(), gap, np.empty((6, len(gap))), energy)
    return energy


def _between(system: System, gap: np.ndarray) -> float:
    """What all contacts store [J] from the first of two gaps (2, n) to the second."""
    (first, last), n = gap, gap.shape[1]
    total = 0.0
    for at, weight in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        force, slopes = np.empty(n), np.empty((2, n))
        here = first + 0.5 * (1.0 + at) * (last - first)
        system.law(here, np.zeros(n), system.law_params, system.law_state, system.law_state.copy(), 0.0, force, *slopes)
        total -= 0.5 * weight * float((force * (last - first)).sum())
    return total
