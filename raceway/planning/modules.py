"""Optional modules that a scene needs: the others are neither imported nor compiled.

Kernels are compiled at their first use: a module that is imported has compiled nothing yet, one that is not never will.
The modules that a plug-in imports are read off its code, so that none is named twice, and a third party's is told like ours.
"""

from __future__ import annotations

import dis
from collections.abc import Iterator
from types import FunctionType
from typing import Any

import attrs

from raceway.framework.duties import bodies, traits_of
from raceway.framework.registry import Registry
from raceway.planning.decisions import Balls
from raceway.planning.steady_orbits import compares_with_steady_motion, has_orbits, remembers_its_start, searches_orbits
from raceway.scene.scene import Scene

_LOOPS = "raceway.core.schemes."
#: Libraries and who imports them.
_MESHING = {
    "gmsh": ("gmsh",),
    "meshio": ("file", "gmsh"),
}
_PICTURES = ("matplotlib", "pyvista")


@attrs.frozen
class Module:
    """A module of the program or a library, and why a run of the scene imports it or not."""

    module: str
    needed: bool
    why: str


def optional_modules(scene: Scene, registry: Registry, balls: Balls, integrates: bool) -> tuple[Module, ...]:
    """Every optional module with its decision.

    Parameters
    ----------
    registry : whose kinds of bodies are told of
    balls : as planned;  integrates : whether an integrator takes part
    """
    found: list[Module] = []

    def decide(needed: bool, module: str, why: str, why_not: str) -> None:
        found.append(Module(module, needed, why if needed else why_not))

    imported = bodies(scene, "imports", balls)
    known: list[Any] = [entry.plugin for entry in registry.all() if entry.kind == "bodies"]
    for module in dict.fromkeys((*scene.bodies.modules, *(module for kind in known for module in kind.modules))):
        why_not = f"bodies.kind is {scene.bodies.name}, the balls are {balls.kind}"
        decide(module in imported, module, imported.get(module, ""), why_not)
    for module in imported_by(scene.contact.law, "kernel"):
        decide(True, module, f"contact.kind is {scene.contact.kind}", "")
    if scene.excitation is not None:
        for module in imported_by(scene.excitation, "kernel"):
            decide(True, module, f"the excitation is {scene.excitation.name}", "")
    method = scene.integrator.kind
    unused = "nothing is integrated" if not integrates else f"the integrator is {method}"
    for module in _loops(scene):
        rubs = module.endswith(".tangential")
        needed = integrates and (not rubs or balls.kind == "tangential")
        decide(needed, module, f"takes the steps of {method}", f"{unused}, the balls are {balls.kind}" if rubs else unused)
    searched = method == "periodic" or searches_orbits(scene) or compares_with_steady_motion(scene)
    searched = searched or (remembers_its_start(scene) and has_orbits(scene))
    unused = unused if not integrates else f"{unused}, no steady orbit is searched for"
    decide(integrates and searched, "raceway.core.periodic", "steady orbits and their multipliers", unused)
    mesher = None if scene.mesh is None else scene.mesh.name
    for library, meshers in _MESHING.items():
        decide(mesher in meshers, library, f"mesh.kind is {mesher}", "no mesh of another program is read or made")
    for library in _PICTURES:
        decide(False, library, "", "pictures are drawn by --pictures and raceway view only")
    return tuple(found)


def _loops(scene: Scene) -> list[str]:
    """Modules of the core that take the steps."""
    scheme = scene.integrator.method.scheme
    quick = traits_of(scene).compiled and scheme.compiled is not None
    found = imported_by(scheme, "compiled" if quick else "stepped")
    return [module for module in found if module.startswith(_LOOPS) and module != f"{_LOOPS}advance"]


def imported_by(plugin: Any, method: str) -> Iterator[str]:
    """Modules that a method of a plug-in imports when it is called, but for numpy."""
    function = getattr(type(plugin), method, None)
    if isinstance(function, FunctionType):
        names = (step.argval for step in dis.get_instructions(function) if step.opname == "IMPORT_NAME")
        yield from (name for name in dict.fromkeys(names) if name != "numpy")


def as_dicts(modules: tuple[Module, ...]) -> list[dict[str, Any]]:
    """``modules[{module, needed, why}]`` of the plan."""
    return [attrs.asdict(one) for one in modules]
