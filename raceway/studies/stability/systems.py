"""Systems that the catalogue's cases are measured on: the base scene's bearing, and one mass on one of its contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import attrs
import numpy as np

from raceway.framework.registry import Registry
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.points import tables_at

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.ring.system import System
    from raceway.core.stepping.record import Motion
    from raceway.framework.contracts import Integrator

#: The article's bearing, load and force; every case that names no other scene changes this one.
BASE: Tables = {
    "title": "B7206C, 1 kN axial, rig unbalance at 12 000 r/min",
    "bearing": {"preset": "B7206C"},
    "rotor": {"mass": 2.0},
    "load": {"axial": 1000.0},
    "excitation": {
        "kind": "bidirectional",
        "speed_rpm": 12000.0,
        "unbalance": 6.39e-4,
        "load_share": 0.5,
        "reference_speed_rpm": 10980.0,
    },
    "contact": {"damping": 0.001},
    "integrator": {"kind": "newmark", "turns": 12},
}
#: Nothing that loses energy.
UNDAMPED = {"contact.damping": 0.0, "rotor.damping": 0.0, "contact.friction": 0.0}


def transient(registry: Registry) -> list[str]:
    """Names of the integrators that march through time with inertia."""
    entries = [entry for entry in registry.all() if entry.kind == "integrator"]
    return [entry.name for entry in entries if entry.plugin.inertial and not entry.plugin.steady]


def laws_with(registry: Registry, *wanted: str) -> list[str]:
    """Names of the laws that know these discretisations."""
    return [e.name for e in registry.all() if e.kind == "contact_law" and set(wanted) <= set(e.plugin.discretisations)]


def with_law(name: str, registry: Registry) -> Tables:
    """The changes that give a scene a law: a law that needs options has those of its first example."""
    plugin = registry.find("contact_law", name).plugin
    try:
        plugin()
    except (TypeError, ValueError):
        first = plugin.examples()[0]
        fields = [field for field in attrs.fields(plugin) if getattr(first, field.name) != field.default]
        return {"contact.kind": name, **{f"contact.{field.name}": getattr(first, field.name) for field in fields}}
    return {"contact.kind": name}


def scene_at(tables: ReadTables, changes: ReadTables, registry: Registry) -> Scene:
    """A scene with some keys changed; a value None takes the key out."""
    changed = tables_at(tables, {key: value for key, value in changes.items() if value is not None}, registry)
    for key in (key for key, value in changes.items() if value is None):
        table, _, last = key.rpartition(".")
        owner = changed if not table else changed[table]
        owner.pop(last, None)
    return scene_from_dict(changed, registry)


def model_at(tables: ReadTables, changes: ReadTables, registry: Registry) -> Model:
    """The bearing of such a scene."""
    from raceway.bodies.model import build_model

    return build_model(scene := scene_at(tables, changes, registry), make_plan(scene))


def method_of(name: str, registry: Registry, tolerance: float | None = None) -> Integrator:
    """An integrator; an implicit one with another tolerance of its steps."""
    method: Any = registry.find("integrator", name).plugin()
    if tolerance is None or "tolerance" not in {field.name for field in attrs.fields(type(method))}:
        return cast("Integrator", method)
    return cast("Integrator", attrs.evolve(method, tolerance=tolerance))


def mass_at(place: float, speed: float = 0.0, acceleration: float = 0.0) -> Motion:
    """The motion of one mass on one contact, along x."""
    from raceway.core.stepping.record import Motion

    x = np.eye(5)[0]
    return Motion(place * x, speed * x, acceleration * x, np.zeros((1, 2)), np.zeros((1, 2)))


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
        from raceway.core.stepping.record import Motion

        system, q = self.system, self.equilibrium.displacement + by
        now = system.evaluate(q, ball=self.equilibrium.ball)
        a = system.acceleration(q, np.zeros(5), np.zeros(5), now)
        return Motion(q, np.zeros(5), a, now.ball, now.ball.copy())

    def direction(self, size: float) -> np.ndarray:
        """(5,) along every free coordinate, ``size`` of the axial approach; tilts by the arm."""
        weight = np.array([1.0, 0.5, 0.3, 0.2 / self.system.arm, 0.1 / self.system.arm])
        return size * abs(self.equilibrium.displacement[0]) * weight * self.system.free


def still(tables: ReadTables, changes: ReadTables, registry: Registry) -> Still:
    """The bearing of a scene, in equilibrium, nothing exciting it."""
    from raceway.core.excitations.harmonic import no_force
    from raceway.core.ring.surrogate import surrogate
    from raceway.pipeline.settle import settle

    model = model_at(tables, changes, registry)
    equilibrium = settle(model)
    system = attrs.evolve(surrogate(model.system), force=no_force, force_params=np.zeros(1))
    damping = system.evaluate(equilibrium.displacement, ball=equilibrium.ball).damping
    limit = system.damped_time_step(equilibrium.stiffness_rows_held, damping)
    return Still(model, system, equilibrium, limit, model.scene.contact.law.dissipative)
