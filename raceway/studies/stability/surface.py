"""Contacts at surface points of condensed bodies: cases, and what they measure.

An equilibrium takes a second and a step a tenth of one, so there are few steps.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from raceway.framework.registry import Registry
from raceway.studies.stability.case import Case, Measured, Near, Row, judged
from raceway.studies.stability.extremes import CERAMIC, NEARLY_INCOMPRESSIBLE, RUBBER, STATIC, Changes
from raceway.studies.stability.systems import scene_at, transient

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator

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
    ("Poisson's ratio 0.4999", NEARLY_INCOMPRESSIBLE, "elements lock", "contacts are nearly twice too stiff"),
)  # fmt: skip


def surface_cases(base: Changes, registry: Registry) -> Iterator[Case]:
    """Condensed bodies with every law that surface points can have."""
    entries = [entry for entry in registry.all() if entry.kind == "contact_law"]
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
            yield _moving(base, law, name, registry)


def _moving(base: Changes, law: str, name: str, registry: Registry) -> Case:
    changes: Changes = {**_POINTS, "contact.kind": law, "integrator.turns": 1, "integrator.steps_per_turn": 40}
    arguments: Changes = {
        "tables": base,
        "integrator": name,
        "shown": {"law": law, "bodies": "condensed, points", "integrator": name},
    }
    method: type[Integrator] = registry.find("integrator", name).plugin
    if method.implicit:
        return Case("surface points: a turn", "surface:turn", {**arguments, "changes": changes}, 12.0)
    arguments["changes"] = {**changes, "integrator.kind": name}
    arguments |= {"words": "through too many steps", "reason": "a step takes a tenth of a second"}
    return Case("surface points: a turn", "scenes:refusal", arguments, 0.5)


def condensed_at_rest(case: Case, registry: Registry) -> list[Row]:
    """The axial displacement against the calibrated law on the same bodies, and the balls' axial forces against the load."""
    from raceway.pipeline.run import run

    a = case.arguments
    changes = {**a["changes"], "excitation": None}
    like = {
        **{k: v for k, v in changes.items() if k != "mesh"},
        "contact.kind": "hertz",
        "contact.discretisation": "resultant",
    }
    found = run(scene_at(a["tables"], changes, registry), registry)
    known = run(scene_at(a["tables"], like, registry), registry)
    balls = found.to_dict()["equilibrium"]["balls"]
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
    from raceway.pipeline.run import run

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
