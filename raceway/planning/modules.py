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

from raceway.planning.steady_orbits import compares_with_steady_motion, has_orbits, remembers_its_start, searches_orbits
from raceway.scene.tables import Scene

_BODIES = "raceway.core.ring.kernels"
_LOOPS = "raceway.core.schemes."
#: Kernels of the bodies by what their balls need.
_BALLS = {
    "weightless": "balls follow the ring at once",
    "inertial": "balls with centrifugal force",
    "tangential": "friction or gyroscopic moments of the balls",
}
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


def optional_modules(scene: Scene, balls: str, centrifugal: bool, integrates: bool) -> tuple[Module, ...]:
    """Every optional module with its decision.

    Parameters
    ----------
    balls : "weightless", "inertial" or "tangential", as planned;  centrifugal : whether they have that force
    integrates : whether an integrator takes part
    """
    found: list[Module] = []

    def decide(needed: bool, module: str, why: str, why_not: str) -> None:
        found.append(Module(module, needed, why if needed else why_not))

    kind = scene.bodies.name
    # Friction and gyroscopic moments are added to an equilibrium without them.
    base = "inertial" if centrifugal else "weightless"
    for word, what in _BALLS.items():
        here = word in (balls, base)
        # Condensed and elastic bodies have a model of rigid rings beside them.
        decide(here, f"{_BODIES}.rigid_{word}", what, f"the balls are {balls}")
    no_potential = "forces on the balls have no potential"
    decide(balls == "tangential", "raceway.core.ring.root", no_potential, f"the balls are {balls}")
    for module in imported_by(scene.contact.law, "kernel"):
        decide(True, module, f"contact.kind is {scene.contact.kind}", "")
    calibrates = kind == "elastic" and scene.contact.discretisation == "resultant"
    why = "calibrates the contact resultants" if calibrates else "elastic rings and balls, reduced"
    for part in ("condensed", "revolution"):
        decide(kind == "condensed" or calibrates, f"raceway.core.{part}", why, f"bodies.kind is {kind}")
    decide(kind == "elastic", "raceway.core.elastic", "every node moves", f"bodies.kind is {kind}")
    decide(kind != "rigid", "raceway.core.hexahedron", "finite elements of the bodies", "no body is meshed")
    if scene.excitation is not None:
        for module in imported_by(scene.excitation, "kernel"):
            decide(True, module, f"the excitation is {scene.excitation.name}", "")
    method = scene.integrator.kind
    unused = "nothing is integrated" if not integrates else f"the integrator is {method}"
    for module in _loops(scene):
        rubs = module.endswith(".tangential")
        needed = integrates and (not rubs or balls == "tangential")
        decide(needed, module, f"takes the steps of {method}", f"{unused}, the balls are {balls}" if rubs else unused)
    searched = method == "periodic" or searches_orbits(scene) or compares_with_steady_motion(scene)
    searched = searched or (remembers_its_start(scene) and has_orbits(scene))
    unused = unused if not integrates else f"{unused}, no steady orbit is searched for"
    decide(integrates and searched, "raceway.core.periodic", "steady orbits and their multipliers", unused)
    mesher = getattr(scene.mesh, "name", None) if kind != "rigid" else None
    for library, meshers in _MESHING.items():
        decide(mesher in meshers, library, f"mesh.kind is {mesher}", "no mesh of another program is read or made")
    for library in _PICTURES:
        decide(False, library, "", "pictures are drawn by --pictures and raceway view only")
    return tuple(found)


def _loops(scene: Scene) -> list[str]:
    """Modules of the core that take the steps."""
    scheme = scene.integrator.method.scheme
    quick = scene.bodies.traits(scene).compiled and scheme.compiled is not None
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
