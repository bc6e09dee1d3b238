"""Scenes and bearings that a kind of bodies is tried on."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.errors import SceneError
from raceway.framework.hookspecs import hookimpl
from raceway.framework.registry import Registry
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage.tables import Tables
from raceway.testing.asked import Changes
from raceway.testing.suite import ConformityError

if TYPE_CHECKING:
    from raceway.framework.contracts import BodiesKind

#: For kinds that give no scene of their own.
_USUAL = {
    "title": "conformance",
    "bearing": {"preset": "B7206C"},
    "load": {"axial": 1000.0, "radial": [200.0, 0.0]},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4},
    "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
    "kinematics": {"ball_inertia": False},
}


class _Only:
    """A plug-in module with one kind of bodies."""

    def __init__(self, kind: type) -> None:
        self.kind = kind

    @hookimpl
    def raceway_bodies(self) -> list[type]:
        return [self.kind]


def registry_with(bodies: BodiesKind) -> Registry:
    """What is installed, what else the kind's own package brings, and the kind itself."""
    registry, cls = Registry(), type(bodies)
    # A package's own contact laws may be all that its bodies run with.
    for name in (cls.__module__.split(".")[0], cls.__module__):
        module = sys.modules.get(name)
        if any(word.startswith("raceway_") for word in vars(module or object)) and name != "raceway":
            registry.add(module)
    if ("bodies", cls.name) not in registry.entries:
        registry.add(_Only(cls))
    return registry


def tables_of(bodies: BodiesKind) -> Tables:
    """The kind's own ``example_scene()``, or a ball bearing of 30 mm bore under a skew load and a turning force."""
    own = getattr(type(bodies), "example_scene", None)
    return dict(_USUAL if own is None else own())


def scene_of(bodies: BodiesKind, changes: Changes | None = None, registry: Registry | None = None) -> Scene:
    """The scene with these bodies; ``changes`` : keys by table."""
    registry = registry or registry_with(bodies)
    tables = {name: table for name, table in tables_of(bodies).items() if name != "bodies"}
    for name, keys in (changes or {}).items():
        tables[name] = {**tables.get(name, {}), **keys}
    try:
        scene = scene_from_dict(tables, registry)
    except SceneError as why:
        raise ConformityError(f"example_scene() is no scene: {why}") from why
    return attrs.evolve(scene, bodies=bodies, source={**scene.source, "bodies": {"kind": bodies.name}})


def settled(scene: Scene) -> tuple[Model, Equilibrium]:
    """What is built for a scene, and its equilibrium."""
    model = build_model(scene, make_plan(scene))
    return model, settle(model)


def is_key(scene: Scene, path: str) -> bool:
    """Whether a path names a key, or a whole table, of the scene."""
    table, *rest = path.split(".")
    if table not in (*TABLES, *PLUGIN_TABLES):
        return False
    part = getattr(scene, table)
    plugin = (
        next((getattr(part, f.name) for f in attrs.fields(type(part)) if "plugin" in f.metadata), None) if part else None
    )
    for word in rest[:1]:
        named = [f.name for each in (part, plugin) if each is not None for f in attrs.fields(type(each))]
        return part is None or word == "kind" or word in named
    return True


def unbalanced(model: Model, q: np.ndarray, ball: np.ndarray) -> float:
    """What is left of the loads on the free coordinates at a state (5,), (Z, k), over all forces."""
    from raceway.core.ring.kernels.layout import CAGE

    system = model.system
    still = system.without(CAGE)
    now = still.evaluate(q, ball=ball)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm]) * system.free
    rest = now.force + system.stiffness @ q - system.load
    return float(np.abs(rest * weight).max() / (np.abs(now.contact_force).sum() + np.abs(system.load * weight).sum()))
