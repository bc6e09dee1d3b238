"""Observed order of each transient integrator, on a linear oscillator and on a bearing."""

from __future__ import annotations

import numpy as np

from benchmarks.evidence import Row
from validation.orders import INTEGRATORS, MARGIN, contact_errors, independent, linear_errors, order

TITLE = "Observed order of the transient integrators"
COMMAND = "python -m benchmarks.evidence orders"


def rows() -> list[Row]:
    found = []

    def add(name: str, counts: np.ndarray, errors: np.ndarray) -> None:
        slope = order(counts, errors)
        note = f"error {errors[0]:.1e} at {counts[0]} to {errors[-1]:.1e} at {counts[-1]} steps a turn"
        found.append(Row(f"{name}: order", slope, f"2 within {MARGIN:g}", abs(slope - 2.0) <= MARGIN, COMMAND, note))

    for integrator in INTEGRATORS:
        for ratio in (0.0, 0.2):
            add(f"linear oscillator, damping ratio {ratio:g}, {integrator}", *linear_errors(integrator, ratio))
    for tilt, coarsest in (("locked", 360), ("free", 720)):
        wanted = independent(tilt, 60)
        for integrator in INTEGRATORS:
            name = f"Hertz contacts, tilt {tilt}, no damping, {integrator}"
            add(name, *contact_errors(integrator, tilt, False, 0.0, wanted, coarsest))
    for inertia in (False, True):
        balls = "with" if inertia else "without"
        for integrator in INTEGRATORS:
            name = f"Hertz contacts, tilt locked, 500 N s/m a contact, {balls} centrifugal force, {integrator}"
            add(name, *contact_errors(integrator, "locked", inertia, 500.0, None, 360))
    return found
