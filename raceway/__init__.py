"""Dynamic stiffness of rolling bearings under axial load and rotor unbalance, with the error and cost of every number.

scene, scene_file, structure   what the user said: TOML to a frozen tree of attrs objects, checked
options, errors    how keys are declared; how things are refused
catalogue          bearing presets with the source of every number
contracts, hookspecs, registry   what plug-ins must do, the hooks, and how they are found
plan, model, run, result         scene -> plan -> model -> settle -> advance -> identify -> result
studies            many runs: compare, verify
core               numerics only
contact_laws, integrators, plugins   the built-in plug-ins, which come in through the same door as third parties'
cli                the commands; the only place that prints

Names below are imported when they are first used, so that ``import raceway`` stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {
    "hookimpl": "raceway.framework.hookspecs",
    "load_scene": "raceway.scene.file",
    "scene_from_dict": "raceway.scene.file",
    "Scene": "raceway.scene.tables",
    "make_plan": "raceway.planning.plan",
    "build_model": "raceway.bodies.model",
    "Result": "raceway.pipeline.result",
    "option": "raceway.framework.options",
    "RacewayError": "raceway.errors",
    "SceneError": "raceway.errors",
    "PluginError": "raceway.errors",
    "ConvergenceError": "raceway.errors",
    "StabilityError": "raceway.errors",
}
__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'raceway' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
