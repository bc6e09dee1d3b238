"""K identified from 12 turns of a transient, against the periodic motion found by independent code."""

from __future__ import annotations

from benchmarks.evidence import Row
from raceway import scene_from_dict
from raceway.pipeline.run import run
from validation.identified_stiffness import CASES, INTEGRATORS, LIMIT, reference
from validation.scenes import rotating

TITLE = "Identified stiffness against a periodic solve by independent code"
COMMAND = "python -m benchmarks.evidence identified_stiffness"


def rows() -> list[Row]:
    found = []
    for tilt, axial, speed, inertia in CASES:
        wanted, _ = reference(axial, tilt, speed, inertia)
        balls = "with" if inertia else "without"
        where = f"tilt {tilt}, {axial:.0f} N, {speed:.0f} r/min, {balls} centrifugal force"
        for integrator in INTEGRATORS:
            result = run(scene_from_dict(rotating(axial, tilt, speed, inertia, integrator)))
            k = result.identification.equivalent_stiffness
            limit = f"{wanted / 1e6:.4f} within {100 * LIMIT:g} %"
            note = f"off by {100 * (k / wanted - 1.0):.5f} %"
            ok = abs(k / wanted - 1.0) <= LIMIT
            found.append(Row(f"{where}, {integrator}: K [N/um]", k / 1e6, limit, ok, COMMAND, note))
    return found
