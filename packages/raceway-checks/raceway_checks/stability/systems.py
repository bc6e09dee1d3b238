"""Systems that the catalogue's cases are measured on."""

from collections.abc import Callable
from typing import cast

import attrs
import numpy as np

from raceway import Result, Scene, build_model, scene_from_dict
from raceway.extend import (
    ContactLaw, Equilibrium, Integrator, Model, Motion, Registry, System, Tables, no_force, run, solve_equilibrium,
    stored_energy, surrogate, tables_at, without,
)  # fmt: skip

#: Halvings of an interval: to the last bit of a double from any first one.
_HALVINGS = 200


@attrs.frozen(eq=False)
class Still:
    """A bearing in its equilibrium, without an excitation."""

    model: Model
    system: System
    equilibrium: Equilibrium
    limit: float  # stable step of central differences for small motions [s]
    dissipative: bool  # whether the law loses energy by itself

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

    def over(self, changes: Tables) -> "Bench":
        """With more keys changed, its own changes upon them."""
        return attrs.evolve(self, changes={**changes, **self.changes})

    def changed(self, changes: Tables) -> "Bench":
        """With more keys changed, upon its own changes."""
        return attrs.evolve(self, changes={**self.changes, **changes})

    @property
    def scene(self) -> Scene:
        """The scene; a change to None takes the key out."""
        tables = tables_at(self.tables, {key: v for key, v in self.changes.items() if v is not None}, self.registry)
        for key in (key for key, value in self.changes.items() if value is None):
            tables = without(tables, key)
        return scene_from_dict(tables, self.registry)

    def model(self) -> Model:
        return build_model(self.scene)

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


def energy_of_contacts(law: ContactLaw, params: np.ndarray, state: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """(n,) energy [J] stored in contacts at gaps (n,), integrated from first touch."""
    energy = np.empty(len(gap))
    stored_energy(law, params, state, state.copy(), gap, np.empty((6, len(gap))), energy)
    return energy
