"""Contacts at surface points of condensed bodies against the calibrated law on the same bodies: at rest, and one turn.

An equilibrium takes a second and a step a tenth of one, so there are few steps.
"""

from __future__ import annotations

import numpy as np

from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.storage.tables import Tables
from raceway.studies.stability.case import Rows
from raceway.studies.stability.systems import scene_at

_CALIBRATED: Tables = {"contact.kind": "hertz", "contact.discretisation": "resultant"}
_COARSE = "two points along a semi-axis are off by percents; converged ones differ by 1 %"


def condensed_at_rest(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> None:
    """The axial displacement, and the balls' axial forces against the load."""
    changes = {**changes, "excitation": None}
    like = {key: value for key, value in changes.items() if key != "mesh"} | _CALIBRATED
    found, known = (run(scene_at(tables, each, registry), registry) for each in (changes, like))
    balls = found.to_dict()["equilibrium"]["balls"]
    pressed = [b for b in balls if b["contact_angle_inner_deg"] is not None]
    axial = sum(b["load_inner_n"] * np.sin(np.radians(b["contact_angle_inner_deg"])) for b in pressed)
    x, wanted = (float(one.equilibrium.displacement[0]) for one in (found, known))
    rows.check("axial displacement [m], predicted by Hertz on these bodies", x, _COARSE, near=wanted, within=0.06)
    why = "a ball's angle is that of its centre, the resultant of its pressures leans by a degree from it"
    rows.check("sum of the balls' axial forces [N]", axial, why, near=found.model.scene.load.axial, within=0.02)


def turn(rows: Rows, registry: Registry, tables: Tables, integrator: str, changes: Tables) -> None:
    """The dynamic stiffness of one turn."""
    like = {
        key: value for key, value in changes.items() if key != "mesh" and not key.startswith("integrator.")
    } | _CALIBRATED
    known, found = (
        run(scene_at(tables, {**each, "integrator.kind": kind}, registry), registry).identification
        for each, kind in ((like, "periodic"), (changes, integrator))
    )
    assert known is not None and found is not None
    near, words = abs(known.dynamic_stiffness), "|Z| [N/m], predicted by Hertz on these bodies"
    rows.check(words, abs(found.dynamic_stiffness), _COARSE, near=near, within=0.05)
