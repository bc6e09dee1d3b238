"""Dynamic stiffness of rolling bearings under axial load and rotor unbalance, with the error and cost of every number.

cli            the command line: ``raceway``
commands       what all commands share: options, progress, screens, how a command ends
studies        many runs made into one answer, a folder a study, each with its command
testing        conformance suites for plug-ins; the scaffold of a new one
front          what ``import raceway`` offers for one scene: run, plan, check, evolve
pipeline       one run: equilibrium, motion, identification, error, result
bodies         rings and balls: rigid, condensed or elastic; from scene and plan to a model
planning       what a scene needs, what is left out, what it will cost
contact_laws, integrators   built-in plug-ins of these kinds
plugins        built-in excitations, identifiers, meshers, formats, reports and executors
scene          the scene file: tables, catalogue of bearings, schema
framework      kinds of plug-ins: contracts, hooks, options, registry
core           numerics: arrays in, arrays out
storage        files and caches on disk
errors         exceptions, one class by who must act
data           bearings, reference cases, meshes, templates of plug-ins

Imports run one way, from the top of this list to its bottom; contact_laws, integrators, plugins and scene do not know each other.
Plug-ins, built in or foreign, are found by the registry alone.

Names below are imported when they are first used, so that ``import raceway`` stays light.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_PUBLIC = {
    "run": "raceway.front.run",
    "plan": "raceway.front.plan",
    "check": "raceway.front.check",
    "evolve": "raceway.front.evolve",
    "compare": "raceway.studies.compare.front",
    "sweep": "raceway.studies.sweep.front",
    "precision": "raceway.studies.precision.front",
    "identify": "raceway.studies.measured.front",
    "export_ross": "raceway.studies.ross.front",
    "view": "raceway.studies.view.front",
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
