"""Scenes, models and results that tests are made of; the tests of plug-ins of third parties as well as the program's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.scene.scene import Scene


def b7206c(**tables: object) -> Tables:
    """The tables of a B7206C under 1000 N, without gyroscopic moments and growth at speed; each keyword replaces or extends one table."""
    scene: Tables = {
        "title": "test", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
        "kinematics": {"gyroscopic": "none", "ring_growth": False},
    }  # fmt: skip
    for name, table in tables.items():
        scene[name] = {**scene.get(name, {}), **table} if isinstance(table, dict) else table
    return scene


def model_of(scene: Scene | Tables) -> Model:
    """The built model of a scene, or of its tables."""
    from raceway import build_model, scene_from_dict

    scene = scene_from_dict(scene) if isinstance(scene, dict) else scene
    return build_model(scene)


def settled(scene: Scene | Tables) -> tuple[Model, Equilibrium]:
    """Model and static equilibrium of a scene, or of its tables."""
    from raceway.pipeline.equilibrium import solve_equilibrium

    model = model_of(scene)
    return model, solve_equilibrium(model)
