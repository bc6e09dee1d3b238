"""Bodies whose every node is a degree of freedom: cases, and what they measure.

With one calibrated force a contact coarse meshes know the displacement: it is held against condensed bodies.  Pressures at
points of coarse meshes do not (its result says so): there the seat's force and the slope of the stored energy are held against
the load.  Equilibria know no friction; motions do.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import attrs

from raceway.core.schemes.drivers import integrate
from raceway.framework.registry import Registry
from raceway.storage.tables import Tables
from raceway.studies.stability.case import AtLeast, AtMost, Case, Measured, Near, Row, judged, refused
from raceway.studies.stability.extremes import CERAMIC, NEARLY_INCOMPRESSIBLE, RUBBER, STATIC, Changes
from raceway.studies.stability.systems import scene_at, transient

if TYPE_CHECKING:
    from collections.abc import Callable

    from raceway.bodies.equilibrium import Equilibrium
    from raceway.pipeline.result import Result

#: Three balls on some four thousand elements, contacts narrower than an element: every path, no accuracy.
_TINY: Tables = {
    "title": "three balls on few elements",
    "bearing": {"preset": "B7206C", "ball_count": 3},
    "bodies": {"kind": "elastic", "formulation": "one_point"},
    "mesh": {
        "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 12, "growth": 3.0,
        "patch": 0.5, "ball_load": 300.0,
    },
    "load": {"axial": 250.0},
    "rotor": {"mass": 0.5},
    "contact": {"kind": "hertz", "discretisation": "nodal"},
}  # fmt: skip
_RUBBER: Changes = {"bearing.rings": CERAMIC, "bearing.balls": RUBBER, "load.axial": 10.0}
_POINTS: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("axial load 100 kN", {"load.axial": 1e5}),
    ("rubber balls in ceramic rings", _RUBBER),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("Poisson's ratio 0.4999", NEARLY_INCOMPRESSIBLE),
)
#: 2688 elements for the base scene's twelve balls.
_COARSE: Changes = {
    "bodies": {"kind": "elastic", "formulation": "incompatible"},
    "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 24}, **STATIC,
}  # fmt: skip
_RESULTANTS: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("3 balls", {"bearing.ball_count": 3, "load.axial": 250.0}),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
#: 15 000 r/min, a force that acts at once.
_EXCITED: Changes = {
    "excitation.kind": "bidirectional", "excitation.speed_rpm": 15000.0, "excitation.amplitude": "constant",
    "excitation.force": 60.0,
}  # fmt: skip
#: Steps of implicit methods, each of a time in which an explicit one takes ``_EXPLICIT`` at 0.9 of its limit.
_IMPLICIT, _EXPLICIT = 20, 20
#: Step [s] and steps of a motion with friction: a third of a period of the ring on its contacts.
_RUBBING = 1e-5, 15
#: How much larger the second of two loads is between which stored energies are compared.
_MORE = 0.02


def elastic_cases(base: Changes, registry: Registry) -> Iterator[Case]:
    """Whole contacts and pressures at points, with every law that both can have."""
    entries = [entry for entry in registry.all() if entry.kind == "contact_law"]
    both = [one.name for one in entries if {"nodal", "resultant"} <= set(one.plugin.discretisations)]
    for law in both:
        for name, changes in _RESULTANTS if law == "hertz" else _RESULTANTS[:1]:
            arguments: Changes = {
                "tables": base, "changes": {**changes, "contact.kind": law, "excitation": None},
                "shown": {"law": law, "bodies": "elastic, resultants"},
            }  # fmt: skip
            yield Case(f"elastic bodies: {name}", "elastic:calibrated_at_rest", arguments, 6.0)
        shown = {"law": law, "bodies": "elastic, points"}
        for name, changes in _POINTS if law == "hertz" else _POINTS[:1]:
            arguments = {"tables": _TINY, "changes": {**changes, "contact.kind": law}, "shown": shown}
            yield Case(f"elastic bodies: {name}", "elastic:points_at_rest", arguments, 12.0)
        told: Changes = {
            "tables": _TINY, "changes": {"contact.kind": law}, "shown": shown, "words": "the displacement depend on the mesh",
            "reason": "an element is wider than a contact: the displacement is a third too small",
        }  # fmt: skip
        yield Case("elastic bodies: base", "scenes:warning", told, 6.0)
    heavy: Changes = {
        "tables": base, "changes": {**_COARSE, "load.axial": 1e5, "excitation": None}, "shown": {"bodies": "elastic, resultants"},
        "words": "is stiffer than the mesh below it", "reason": "what the mesh gives way under a contact is more than Hertz's compliance",
    }  # fmt: skip
    yield Case("elastic bodies: axial load 100 kN", "scenes:refusal", heavy, 3.0)
    rubbed: Changes = {
        "tables": _TINY,
        "changes": {**_EXCITED, "contact.friction": 1.0},
        "shown": {"bodies": "elastic, points"},
    }
    yield Case("elastic bodies: friction 1.0, a force acts at once", "elastic:rubbing", rubbed, 30.0)
    for name in transient(registry):
        arguments = {"tables": _TINY, "changes": _EXCITED, "integrator": name, "shown": {"bodies": "elastic, points"}}
        yield Case("elastic bodies: a force acts at once", "elastic:motion", arguments, 15.0)


def calibrated_at_rest(case: Case, registry: Registry) -> list[Row]:
    """Axial displacement and radial stiffness against condensed bodies; what the seat carries against the load."""
    from raceway.pipeline.run import run

    a = case.arguments
    known = run(scene_at(a["tables"], {**STATIC, **a["changes"], "bodies.kind": "condensed"}, registry), registry)
    found = run(scene_at(a["tables"], {**_COARSE, **a["changes"]}, registry), registry)
    close = Near(0.02, "elements of 3.2 mm, two through a wall, bend too little: 1 % as a rule; twice that")
    rows = []
    for words, place in (("axial displacement [m]", _axial), ("radial stiffness [N/m]", _radial)):
        wanted, value = (float(place(one.equilibrium)) for one in (known, found))
        words += ", predicted by condensed bodies"
        rows.append(judged(case.name, a["shown"], words, close, wanted, partial(_known, value)))
    return [*rows, _carried(case, found.model.scene.load.axial, lambda: found)]


def _known(value: float) -> Measured:
    return value, None


def _axial(equilibrium: Equilibrium) -> float:
    return float(equilibrium.displacement[0])


def _radial(equilibrium: Equilibrium) -> float:
    return float(equilibrium.stiffness[1, 1])


def _carried(case: Case, load: float, result: Callable[[], Result]) -> Row:
    def reaction() -> Measured:
        return -float(result().to_dict()["model"]["reaction_n"]["x"]), None

    balance = Near(1e-5, "an equilibrium of all nodes is solved to 1e-7 of its forces")
    return judged(case.name, case.arguments["shown"], "axial force on the outer seat [N]", balance, load, reaction)


def points_at_rest(case: Case, registry: Registry) -> list[Row]:
    """What the outer seat carries, and the stored energy over the axial way between two loads, against the load."""
    from raceway.pipeline.run import run

    a = case.arguments
    scene = scene_at(a["tables"], a["changes"], registry)
    load = scene.load.axial

    def settled(axial: float) -> tuple[float, float, Result]:
        found = run(scene_at(a["tables"], {**a["changes"], "load.axial": axial}, registry), registry)
        stored = found.to_dict()["model"]["energies_j"]
        return float(found.equilibrium.displacement[0]), stored["elastic"] + stored["contact"], found

    def slope() -> Measured:
        x, stored, _ = one
        further, more, _ = settled((1.0 + _MORE) * load)
        return (more - stored) / (further - x), None

    one = settled(load)
    close = Near(
        0.02, "points are looked up anew on the race's facets after 0.02 of a facet's half width, as on another mesh"
    )
    words = "change of the stored energy over the axial way [N]"
    middle = (1.0 + 0.5 * _MORE) * load
    return [_carried(case, load, lambda: one[2]), judged(case.name, a["shown"], words, close, middle, slope)]


def motion(case: Case, registry: Registry) -> list[Row]:
    """Elastic bodies that a force meets at rest: a balance of energies; a step above the stable limit is refused."""
    from raceway.bodies.model import build_model
    from raceway.core.elastic.start import at_rest
    from raceway.core.stepping.energy import drift
    from raceway.core.stepping.record import Schedule
    from raceway.pipeline.settle import settle
    from raceway.planning.plan import make_plan

    a = case.arguments
    model = build_model(scene := scene_at(a["tables"], a["changes"], registry), make_plan(scene))
    still = settle(model)
    ring: Any = model.system
    start = at_rest(ring, still.displacement, still.ball, False)
    limit = float(ring.critical_time_step(still.stiffness))
    method = registry.find("integrator", a["integrator"]).plugin()
    if "tolerance" in {field.name for field in attrs.fields(type(method))}:
        method = attrs.evolve(method, tolerance=1e-6)
    step = (_EXPLICIT if method.implicit else 1.0) * 0.9 * limit
    steps = _IMPLICIT if method.implicit else _IMPLICIT * _EXPLICIT
    setting = {**a["shown"], "integrator": a["integrator"], "steps": steps, "step/limit": step / limit}

    def balance() -> Measured:
        record = integrate(method, ring, start, Schedule(step, steps, 1))
        worst = drift(record.energies) or 0.0
        return worst, worst

    small = AtMost(1e-3, "steps of nanoseconds follow all but the waves of single elements, which carry little")
    rows = [judged(case.name, setting, "energy not balanced by the work", small, 0.0, balance)]
    if not method.implicit:
        above = {**setting, "steps": 1, "step/limit": 1.02}
        far = Schedule(1.02 * limit, 10, 1)
        why = "it is refused before it blows up"
        rows.append(refused(case.name, above, "above the stable limit", why, lambda: integrate(method, ring, start, far)))
    return rows


def rubbing(case: Case, registry: Registry) -> list[Row]:
    """A force that meets contacts with friction at rest: the balance of energies, and that friction takes part."""
    from raceway.bodies.model import build_model
    from raceway.core.elastic.start import at_rest
    from raceway.core.stepping.energy import drift
    from raceway.core.stepping.record import Schedule
    from raceway.integrators.newmark import Newmark
    from raceway.pipeline.settle import settle
    from raceway.planning.plan import make_plan

    a = case.arguments
    model = build_model(scene := scene_at(a["tables"], a["changes"], registry), make_plan(scene))
    still = settle(model)
    ring: Any = model.system
    start = at_rest(ring, still.displacement, still.ball, False)
    step, steps = _RUBBING
    energies = integrate(Newmark(tolerance=1e-6), model.system, start, Schedule(step, steps, 1)).energies
    setting = {**a["shown"], "integrator": "newmark", "steps": steps, "step_s": step}
    worst = drift(energies) or 0.0
    small = AtMost(1e-3, "a period of the ring takes forty of these steps; waves of single elements carry little")
    given = float(energies["external"][-1] - energies["external"][0])
    share = float(energies["friction"][-1]) / given
    slips = AtLeast(1e-6, "the rims of contacts slip at any force; rounding is 1e-12, and without friction it is nothing")
    return [
        judged(case.name, setting, "energy not balanced by the work", small, 0.0, lambda: (worst, worst)),
        judged(case.name, setting, "energy that friction took over the work", slips, None, lambda: (share, worst)),
    ]
