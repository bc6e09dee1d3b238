"""Errors of Z at each speed of a run-up.

Notes
-----
What a window of a changing motion is away from the steady motion at its speed is its error: free vibrations, an amplitude that
lags behind, and the steps in time are in it.  Where no such motion can be solved for, it is the identifier's own error of the
window, plus that of the time step.
"""

from __future__ import annotations

from math import pi

import attrs

from raceway.bodies.model import Model
from raceway.core.signals.identification import Identification
from raceway.errors import BeyondPlanError
from raceway.pipeline.error.steady_motion import Settled
from raceway.pipeline.simulate import OnProgress
from raceway.planning.steady_orbits import compares_with_steady_motion
from raceway.storage.tables import Tables

#: Relative error of Z in a window above which it is told.
_MUCH = 0.05


def with_series_error(
    model: Model, found: Identification, error: Tables, steady: Settled, on_progress: OnProgress | None = None
) -> Identification:
    """The same with ``series_error`` held against steady motions where the speed changes.

    Parameters
    ----------
    error : table ``error`` of the result;  steady : motions that it was made with
    on_progress : called in searches for steady motions; of windows whose search it ends no error is stated
    """
    if not found.series_error:
        return found
    held = model.excitation.period_s is None and compares_with_steady_motion(model.scene)
    told: list[float | None] = []
    for (speed, z), own in zip(found.series, found.series_error, strict=True):
        try:
            settled = steady.value(speed, on_progress) if held else None
        except BeyondPlanError:  # of this window and of those to come nothing is known
            told += [None] * (len(found.series) - len(told))
            break
        if settled is not None:
            told.append(abs(z - settled) / min(abs(z), abs(settled)))
        else:
            told.append(None if own is None else own + (error["time_step"] or 0.0))
    return attrs.evolve(found, series_error=tuple(told))


def series_warnings(found: Identification | None) -> list[str]:
    """Says where windows of a run-up do not tell Z."""
    if found is None:
        return []
    known = [(size, speed) for size, (speed, _) in zip(found.series_error, found.series, strict=False) if size is not None]
    bad = [speed * 30.0 / pi for size, speed in known if not size <= _MUCH]
    if not bad:
        return []
    size, speed = max(known)
    return [
        f"the motion does not follow the speed in {len(bad)} of {len(found.series)} windows, {min(bad):.0f} to {max(bad):.0f} r/min: "
        f"the error of Z is up to {size:.2g} of |Z| there (at {speed * 30.0 / pi:.0f} r/min). Change the speed more slowly, or run "
        "these speeds one by one"
    ]
