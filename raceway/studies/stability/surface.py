"""Contacts at surface points, of condensed and of elastic bodies: cases, and what they measure.

An equilibrium takes a second and a step a tenth of one, so there are few steps, and elastic bodies are three balls on some
four thousand elements: every path, no accuracy.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import attrs
import numpy as np

from raceway.planning.patches import INTEGRATORS
from raceway.registry import Registry
from raceway.studies.stability.case import AtMost, Case, Measured, Near, Row, judged, refused
from raceway.studies.stability.extremes import CERAMIC, RUBBER, STATIC, Changes
from raceway.studies.stability.systems import scene_at, transient

_POINTS: Changes = {
    "bodies.kind": "condensed", "contact.discretisation": "nodal", "mesh": {"kind": "structured", "nodes_per_semi_axis": 2}, **STATIC,
}  # fmt: skip
#: Scenes at rest whose contacts lie inside the grooves.
_STILL: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("radial load 5 x axial, balls unloaded", {"load.radial": [5000.0, 0.0]}),
    ("3 balls", {"bearing.ball_count": 3}),
    ("conformity 0.60", {"bearing.conformity_inner": 0.6, "bearing.conformity_outer": 0.6}),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("tilt free", {"supports.tilt": "free", "load.radial": [500.0, 0.0]}),
)
_NEARLY_INCOMPRESSIBLE: Changes = {"bearing.rings": {"poisson": 0.4999}, "bearing.balls": {"poisson": 0.4999}}
#: Scenes at rest that a user must be told something about.
_WARNED: tuple[tuple[str, Changes, str, str], ...] = (
    ("axial load 100 kN", {"load.axial": 1e5}, "groove's edge", "contacts are cut off by the shoulder"),
    (
        "conformity 0.501", {"bearing.conformity_inner": 0.501, "bearing.conformity_outer": 0.501},
        "groove's edge", "the ellipse is longer than the groove",
    ),
    (
        "rubber balls in ceramic rings", {"bearing.rings": CERAMIC, "bearing.balls": RUBBER, "load.axial": 10.0},
        "groove's edge", "the balls fill the grooves",
    ),
    ("Poisson's ratio 0.4999", _NEARLY_INCOMPRESSIBLE, "elements lock", "contacts are nearly twice too stiff"),
)  # fmt: skip

_TINY: dict[str, Any] = {
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
_ELASTIC: tuple[tuple[str, Changes], ...] = (
    ("base", {}),
    ("axial load 1 N", {"load.axial": 1.0}),
    ("axial load 100 kN", {"load.axial": 1e5}),
    ("rubber balls in ceramic rings", {"bearing.rings": CERAMIC, "bearing.balls": RUBBER, "load.axial": 10.0}),
    ("ceramic balls in steel rings", {"bearing.balls": CERAMIC}),
    ("friction 1.0", {"contact.friction": 1.0}),
    ("Poisson's ratio 0.4999", _NEARLY_INCOMPRESSIBLE),
)
#: 15 000 r/min, a force that acts at once.
_EXCITED: Changes = {
    "excitation.kind": "bidirectional", "excitation.speed_rpm": 15000.0, "excitation.amplitude": "constant",
    "excitation.force": 60.0,
}  # fmt: skip
#: Steps of implicit methods, each of a time in which an explicit one takes ``_EXPLICIT`` at 0.9 of its limit.
_IMPLICIT, _EXPLICIT = 20, 20


def surface_cases(base: Changes, registry: Registry) -> Iterator[Case]:
    """Condensed bodies with every law that surface points can have, elastic bodies with those that penetrate."""
    entries: list[Any] = [entry for entry in registry.all() if entry.kind == "contact_law"]
    laws = [entry for entry in entries if "nodal" in entry.plugin.discretisations]
    for law in (entry.name for entry in laws):
        shown: Changes = {"law": law, "bodies": "condensed, points"}
        for name, changes in _STILL:
            arguments: Changes = {"tables": base, "changes": {**_POINTS, **changes, "contact.kind": law}, "shown": shown}
            yield Case(f"surface points: {name}", "surface:condensed_at_rest", arguments, 2.0)
        for name, changes, words, reason in _WARNED:
            arguments = {
                "tables": base, "changes": {**_POINTS, **changes, "contact.kind": law, "excitation": None}, "shown": shown,
                "words": words, "reason": reason,
            }  # fmt: skip
            yield Case(f"surface points: {name}", "scenes:warning", arguments, 3.0)
        for name in transient(registry):
            yield _moving(base, law, name)
    for law in (entry.name for entry in laws if "resultant" in entry.plugin.discretisations):
        shown = {"law": law, "bodies": "elastic"}
        for name, changes in _ELASTIC if law == "hertz" else _ELASTIC[:1]:
            arguments = {"tables": _TINY, "changes": {**changes, "contact.kind": law}, "shown": shown}
            yield Case(f"elastic bodies: {name}", "surface:elastic_at_rest", arguments, 6.0)
    for name in transient(registry):
        arguments = {"tables": _TINY, "changes": _EXCITED, "integrator": name, "shown": {"bodies": "elastic"}}
        yield Case("elastic bodies: a force acts at once", "surface:elastic_motion", arguments, 15.0)


def _moving(base: Changes, law: str, name: str) -> Case:
    changes: Changes = {**_POINTS, "contact.kind": law, "integrator.turns": 1, "integrator.steps_per_turn": 40}
    arguments: Changes = {
        "tables": base,
        "integrator": name,
        "shown": {"law": law, "bodies": "condensed, points", "integrator": name},
    }
    if name in INTEGRATORS:
        return Case("surface points: a turn", "surface:turn", {**arguments, "changes": changes}, 12.0)
    arguments["changes"] = {**changes, "integrator.kind": name}
    arguments |= {"words": "through too many steps", "reason": "a step takes a tenth of a second"}
    return Case("surface points: a turn", "scenes:refusal", arguments, 0.5)


def condensed_at_rest(case: Case, registry: Registry) -> list[Row]:
    """The axial displacement against the calibrated law on the same bodies, and the balls' axial forces against the load."""
    from raceway.run import run

    a = case.arguments
    changes = {**a["changes"], "excitation": None}
    like = {
        **{k: v for k, v in changes.items() if k != "mesh"},
        "contact.kind": "hertz",
        "contact.discretisation": "resultant",
    }
    found = run(scene_at(a["tables"], changes, registry), registry)
    known = run(scene_at(a["tables"], like, registry), registry)
    balls = found.as_dict()["equilibrium"]["balls"]
    pressed = [b for b in balls if b["contact_angle_inner_deg"] is not None]
    axial = sum(b["load_inner_n"] * np.sin(np.radians(b["contact_angle_inner_deg"])) for b in pressed)
    close = Near(0.06, "two points along a semi-axis are off by percents; converged ones differ by 1 %")
    along = Near(0.02, "a ball's angle is that of its centre, the resultant of its pressures leans by a degree from it")
    x, wanted = (float(one.equilibrium.displacement[0]) for one in (found, known))
    words = "axial displacement [m], predicted by Hertz on these bodies"
    load = found.model.scene.load.axial
    return [
        judged(case.name, a["shown"], words, close, wanted, lambda: (x, None)),
        judged(case.name, a["shown"], "sum of the balls' axial forces [N]", along, load, lambda: (axial, None)),
    ]


def turn(case: Case, registry: Registry) -> list[Row]:
    """One turn at surface points against the calibrated law on the same bodies."""
    from raceway.run import run

    a = case.arguments
    changes = {**a["changes"], "integrator.kind": a["integrator"]}
    like = {k: v for k, v in a["changes"].items() if k != "mesh" and not k.startswith("integrator.")}
    like |= {"integrator.kind": "periodic", "contact.kind": "hertz", "contact.discretisation": "resultant"}
    known = run(scene_at(a["tables"], like, registry), registry).identification

    def motion() -> Measured:
        found = run(scene_at(a["tables"], changes, registry), registry).identification
        assert found is not None
        return abs(found.dynamic_stiffness), None

    assert known is not None
    close = Near(0.05, "two points along a semi-axis are off by percents; converged ones differ by 1 %")
    words = "|Z| [N/m], predicted by Hertz on these bodies"
    return [judged(case.name, a["shown"], words, close, abs(known.dynamic_stiffness), motion)]


def elastic_at_rest(case: Case, registry: Registry) -> list[Row]:
    """What the outer seat carries against the load."""
    from raceway.run import run

    a = case.arguments
    scene = scene_at(a["tables"], a["changes"], registry)

    def reaction() -> Measured:
        told = run(scene, registry).as_dict()["model"]
        return -float(told["reaction_n"]["x"]), None

    balance = Near(1e-5, "an equilibrium of all nodes is solved to 1e-7 of its forces")
    return [judged(case.name, a["shown"], "axial force on the outer seat [N]", balance, scene.load.axial, reaction)]


def elastic_motion(case: Case, registry: Registry) -> list[Row]:
    """Elastic bodies that a force meets at rest: a balance of energies; a step above the stable limit is refused."""
    from raceway.core.record import Schedule
    from raceway.core.start import at_rest
    from raceway.core.stepping.energy import drift
    from raceway.model import build_model
    from raceway.plan import make_plan
    from raceway.statics import settle

    a = case.arguments
    model = build_model(scene := scene_at(a["tables"], a["changes"], registry), make_plan(scene))
    still = settle(model)
    ring: Any = model.system
    start = at_rest(ring, still.displacement, still.ball, False)
    limit = float(ring.critical_time_step(still.stiffness))
    method: Any = registry.find("integrator", a["integrator"]).plugin()
    if "tolerance" in {field.name for field in attrs.fields(type(method))}:
        method = attrs.evolve(method, tolerance=1e-6)
    step = (_EXPLICIT if method.implicit else 1.0) * 0.9 * limit
    steps = _IMPLICIT if method.implicit else _IMPLICIT * _EXPLICIT
    setting = {**a["shown"], "integrator": a["integrator"], "steps": steps, "step/limit": step / limit}

    def balance() -> Measured:
        record = method.advance(ring, start, Schedule(step, steps, 1))
        worst = drift(record.energies) or 0.0
        return worst, worst

    small = AtMost(1e-3, "steps of nanoseconds follow all but the waves of single elements, which carry little")
    rows = [judged(case.name, setting, "energy not balanced by the work", small, 0.0, balance)]
    if not method.implicit:
        above = {**setting, "steps": 1, "step/limit": 1.02}
        far = Schedule(1.02 * limit, 10, 1)
        why = "it is refused before it blows up"
        rows.append(refused(case.name, above, "above the stable limit", why, lambda: method.advance(ring, start, far)))
    return rows
