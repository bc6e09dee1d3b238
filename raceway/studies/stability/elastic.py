"""Bodies whose every node is a degree of freedom.

With one calibrated force a contact coarse meshes know the displacement: it is held against condensed bodies.  Pressures at
points of coarse meshes do not (its result says so): there the seat's force and the slope of the stored energy are held against
the load.  Equilibria know no friction; motions do.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from raceway.bodies.equilibrium import Equilibrium
from raceway.core.elastic.start import at_rest
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.energy import drift
from raceway.core.stepping.record import Motion, Schedule
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.storage.tables import Tables
from raceway.studies.stability.case import Rows
from raceway.studies.stability.extremes import COARSE, STATIC
from raceway.studies.stability.systems import method_of, model_at, scene_at

#: Steps of implicit methods, each of a time in which an explicit one takes ``_EXPLICIT`` at 0.9 of its limit.
_IMPLICIT, _EXPLICIT = 20, 20
#: Step [s] and steps of a motion with friction: a third of a period of the ring on its contacts.
_RUBBING = 1e-5, 15
#: How much larger the second of two loads is between which stored energies are compared.
_MORE = 0.02
#: Tolerance of implicit steps, and drift of the energy.
_TOLERANCE, _DRIFT = 1e-6, 1e-3


def calibrated_at_rest(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> None:
    """Axial displacement and radial stiffness against condensed bodies; what the seat carries against the load."""
    known = run(scene_at(tables, {**STATIC, **changes, "bodies.kind": "condensed"}, registry), registry).equilibrium
    result = run(scene_at(tables, {**COARSE, **changes}, registry), registry)
    found = result.equilibrium
    why = "elements of 3.2 mm, two through a wall, bend too little: 1 % as a rule; twice that"
    near = float(known.displacement[0])
    words = "axial displacement [m], predicted by condensed bodies"
    rows.check(words, float(found.displacement[0]), why, near=near, within=0.02)
    near = float(known.stiffness[1, 1])
    words = "radial stiffness [N/m], predicted by condensed bodies"
    rows.check(words, float(found.stiffness[1, 1]), why, near=near, within=0.02)
    _carried(rows, result)


def _carried(rows: Rows, result: Result) -> None:
    seat, load = -float(result.to_dict()["model"]["reaction_n"]["x"]), result.model.scene.load.axial
    why = "an equilibrium of all nodes is solved to 1e-7 of its forces"
    rows.check("axial force on the outer seat [N]", seat, why, near=load, within=1e-5)


def points_at_rest(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> None:
    """What the outer seat carries, and the stored energy over the axial way between two loads, against the load."""

    def settled(axial: float) -> tuple[float, float, Result]:
        found = run(scene_at(tables, {**changes, "load.axial": axial}, registry), registry)
        stored = found.to_dict()["model"]["energies_j"]
        return float(found.equilibrium.displacement[0]), stored["elastic"] + stored["contact"], found

    load = scene_at(tables, changes, registry).load.axial
    x, stored, result = settled(load)
    _carried(rows, result)

    def slope() -> float:
        further, more, _ = settled((1.0 + _MORE) * load)
        return (more - stored) / (further - x)

    why = "points are looked up anew on the race's facets after 0.02 of a facet's half width, as on another mesh"
    words = "change of the stored energy over the axial way [N]"
    rows.check(words, slope, why, near=(1.0 + 0.5 * _MORE) * load, within=0.02)


def _begun(tables: Tables, changes: Tables, registry: Registry) -> tuple[Any, Motion, Equilibrium]:
    """Elastic bodies at rest, as a force meets them."""
    model = model_at(tables, changes, registry)
    still = settle(model)
    system: Any = model.system
    return system, at_rest(system, still.displacement, still.ball, False), still


def motion(rows: Rows, registry: Registry, tables: Tables, integrator: str, changes: Tables) -> None:
    """A force that acts at once: a balance of energies; a step above the stable limit is refused."""
    ring, start, still = _begun(tables, changes, registry)
    limit, method = float(ring.critical_time_step(still.stiffness)), method_of(integrator, registry, _TOLERANCE)
    step, steps = 0.9 * limit, _IMPLICIT * _EXPLICIT
    if method.implicit:
        step, steps = _EXPLICIT * step, _IMPLICIT

    def balance() -> tuple[float, float]:
        worst = drift(integrate(method, ring, start, Schedule(step, steps, 1)).energies) or 0.0
        return worst, worst

    why = "steps of nanoseconds follow all but the waves of single elements, which carry little"
    setting = {"steps": steps, "step/limit": step / limit}
    rows.check("energy not balanced by the work", balance, why, at_most=_DRIFT, at=setting)
    if not method.implicit:
        far = partial(integrate, method, ring, start, Schedule(1.02 * limit, 10, 1))
        rows.refused("above the stable limit", "it is refused before it blows up", far, {"steps": 1, "step/limit": 1.02})


def rubbing(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> None:
    """A force that meets contacts with friction at rest: the balance of energies, and that friction takes part."""
    ring, start, _ = _begun(tables, changes, registry)
    step, steps = _RUBBING
    setting = {"integrator": "newmark", "steps": steps, "step_s": step}
    energies = integrate(method_of("newmark", registry, _TOLERANCE), ring, start, Schedule(step, steps, 1)).energies
    worst = drift(energies) or 0.0
    why = "a period of the ring takes forty of these steps; waves of single elements carry little"
    rows.check("energy not balanced by the work", (worst, worst), why, at_most=_DRIFT, at=setting)
    share = float(energies["friction"][-1] / (energies["external"][-1] - energies["external"][0]))
    why = "the rims of contacts slip at any force; rounding is 1e-12, and without friction it is nothing"
    rows.check("energy that friction took over the work", (share, worst), why, at_least=1e-6, at=setting)
