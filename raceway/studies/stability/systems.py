"""Systems that the catalogue's cases are measured on: the base scene's bearing, and one mass on one of its contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.framework.registry import Entry, Registry
from raceway.planning.plan import make_plan
from raceway.scene.file import scene_from_dict
from raceway.scene.tables import Scene
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
#: Halvings of an interval of time steps, and what an eigenvalue of size 1 may be off by.
_HALVINGS, _NEUTRAL = 40, 1e-9
#: Nothing that loses energy.
UNDAMPED = {"contact.damping": 0.0, "rotor.damping": 0.0, "contact.friction": 0.0}


def transient(registry: Registry) -> list[str]:
    """Names of the integrators that march through time with inertia."""
    entries = [entry for entry in registry.all() if entry.kind == "integrator"]
    return [entry.name for entry in entries if is_transient(entry)]


def is_transient(entry: Entry) -> bool:
    plugin: type[Integrator] = entry.plugin
    return plugin.inertial and not plugin.steady


def pair_laws(registry: Registry) -> list[str]:
    """Names of the laws that rigid bodies can use, without memory: they have a stored energy."""
    entries = [entry for entry in registry.all() if entry.kind == "contact_law"]
    return [e.name for e in entries if "resultant" in e.plugin.discretisations]


def scene_at(tables: ReadTables, changes: ReadTables, registry: Registry) -> Scene:
    """A scene with some keys changed; a value None takes the key out."""
    changed = tables_at(tables, {key: value for key, value in changes.items() if value is not None}, registry)
    for key in (key for key, value in changes.items() if value is None):
        table, _, last = key.rpartition(".")
        owner = changed if not table else changed[table]
        owner.pop(last, None)
    return scene_from_dict(changed, registry)


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


def still(scene: Scene) -> Still:
    """The bearing of a scene, in equilibrium, nothing exciting it."""
    from raceway.bodies.model import build_model
    from raceway.core.excitations.harmonic import no_force
    from raceway.core.ring.surrogate import surrogate
    from raceway.pipeline.settle import settle

    model = build_model(scene, make_plan(scene))
    equilibrium = settle(model)
    system = attrs.evolve(surrogate(model.system), force=no_force, force_params=np.zeros(1))
    damping = system.evaluate(equilibrium.displacement, ball=equilibrium.ball).damping
    limit = explicit_limit(system, equilibrium.stiffness, damping)
    return Still(model, system, equilibrium, limit, scene.contact.law.dissipative)


def explicit_limit(system: System, stiffness: np.ndarray, damping: np.ndarray) -> float:
    """Stable step [s] of central differences with contacts of a stiffness and a damping (5, 5).

    Notes
    -----
    Contacts see the predicted velocity, v + dt a (``raceway.core.schemes.explicit``): (M + dt C0 / 2) a1 = -(K + K0) q1 -
    C (v0 + dt a0) - C0 (v0 + dt a0 / 2), with C0 and K0 of the ground.  That makes the limit shorter than 2 / w, and it is the
    largest dt whose amplification matrix has no eigenvalue beyond 1.
    """
    undamped = float(system.critical_time_step(stiffness))
    if not damping.any():
        return undamped
    free = np.flatnonzero(system.free > 0.0)
    part = np.ix_(free, free)
    m, c, c0, k = (each[part] for each in (system.mass, damping, system.damping, stiffness + system.stiffness))
    one, zero = np.eye(len(free)), np.zeros((len(free), len(free)))

    def grows(dt: float) -> bool:
        place = np.hstack([one, dt * one, 0.5 * dt**2 * one])
        pull = k @ place + np.hstack([zero, c + c0, dt * c + 0.5 * dt * c0])
        push = -np.linalg.solve(m + 0.5 * dt * c0, pull)
        step = np.vstack([place, np.hstack([zero, one, 0.5 * dt * one]) + 0.5 * dt * push, push])
        return bool(np.abs(np.linalg.eigvals(step)).max() > 1.0 + _NEUTRAL)

    low, high = 0.0, undamped
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high
