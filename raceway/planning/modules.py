"""Optional modules that a scene needs: the others are neither imported nor compiled.

A kernel is compiled when its module is imported, so a module that is not imported costs nothing.
"""

from __future__ import annotations

from typing import Any

import attrs

from raceway.planning.steady_orbits import compares_with_steady_motion, has_orbits, remembers_its_start, searches_orbits
from raceway.scene.tables import Scene

_BODIES = "raceway.core.ring.kernels"
_LOOPS = "raceway.core.schemes.compiled"
#: Kernels of the bodies by what their balls need.
_BALLS = {
    "weightless": "balls follow the ring at once",
    "inertial": "balls with centrifugal force",
    "tangential": "friction or gyroscopic moments of the balls",
}
#: Built-in integrators and the module that takes their steps.
_METHODS = {
    "newmark": "implicit",
    "generalized_alpha": "implicit",
    "central_difference": "central_difference",
    "quasi_static": "quasi_static",
}
#: Kernels of the built-in contact laws and the laws that they serve.
_LAWS = {"hertz": ("hertz",), "penalty": ("penalty", "unilateral")}
#: Kernels of the built-in excitations; without one, the force that is none.
_EXCITATIONS = {
    "unidirectional": "harmonic",
    "bidirectional": "harmonic",
    "run_up": "run_up",
    "measured": "samples",
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
        decide(
            here and kind == "condensed",
            f"{_BODIES}.condensed_{word}",
            what,
            _not(kind, "condensed", f"the balls are {balls}"),
        )
    no_potential = "forces on the balls have no potential"
    decide(balls == "tangential", "raceway.core.ring.root", no_potential, f"the balls are {balls}")
    for law, kinds in _LAWS.items():
        why = f"contact.kind is {scene.contact.kind}"
        decide(scene.contact.kind in kinds, f"raceway.core.contact_laws.{law}", why, why)
    calibrates = kind == "elastic" and scene.contact.discretisation == "resultant"
    why = "calibrates the contact resultants" if calibrates else "elastic rings and balls, reduced"
    for part in ("condensed", "revolution"):
        decide(kind == "condensed" or calibrates, f"raceway.core.{part}", why, f"bodies.kind is {kind}")
    decide(kind == "elastic", "raceway.core.elastic", "every node moves", f"bodies.kind is {kind}")
    decide(kind != "rigid", "raceway.core.hexahedron", "finite elements of the bodies", "no body is meshed")
    excitation = "none" if scene.excitation is None else scene.excitation.name
    if excitation in (*_EXCITATIONS, "none"):
        for part in dict.fromkeys(_EXCITATIONS.values()):
            if excitation == "run_up" and part == "harmonic":
                continue  # it may start on the orbit of its first moment
            needed = part == _EXCITATIONS.get(excitation, "harmonic")
            decide(
                needed,
                f"raceway.core.excitations.{part}",
                f"the excitation is {excitation}",
                f"the excitation is {excitation}",
            )
    method = scene.integrator.kind
    unused = "nothing is integrated" if not integrates else f"the integrator is {method}"
    if method in _METHODS or method == "periodic" or not integrates:
        for loop in dict.fromkeys(_METHODS.values()):
            needed = integrates and _METHODS.get(method) == loop
            decide(needed, f"{_LOOPS}.{loop}", f"takes the steps of {method}", unused)
        rubs = integrates and method == "quasi_static" and balls == "tangential"
        decide(rubs, f"{_LOOPS}.quasi_static_tangential", no_potential, f"{unused}, the balls are {balls}")
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


def _not(kind: str, wanted: str, else_why: str) -> str:
    return f"bodies.kind is {kind}" if kind != wanted else else_why


def as_dicts(modules: tuple[Module, ...]) -> list[dict[str, Any]]:
    """``modules[{module, needed, why}]`` of the plan."""
    return [attrs.asdict(one) for one in modules]
