"""What a user should know about a recorded motion: balls that unload, ellipses over the edge, motions that cannot be."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.stepping.record import Record
from raceway.errors import ConvergenceError
from raceway.storage.tables import Tables

#: Samples of the last turn that are looked at.
_SAMPLES = 60
#: Part of what a body gives way, by which it lags behind, that is worth a sentence.
_LAG = 0.01


def refuse_impossible(model: Model, equilibrium: Equilibrium, record: Record) -> None:
    """Refuse a motion that leaves the grooves.

    Raises
    ------
    ConvergenceError
        The ring moves further than the groove centres are apart: the ball would climb out of its groove.
    """
    moved = float(np.abs(record.displacement[:, :3] - equilibrium.displacement[:3]).max())
    limit = model.bearing.largest_motion
    if moved > limit:
        raise ConvergenceError(
            f"the ring moves by {1e3 * moved:.3g} mm, more than the groove centres are apart ({1e3 * limit:.3g} mm): balls "
            f"would leave their grooves. The excitation's force is {model.excitation.amplitude_n:.4g} N: check its unit "
            "(unbalance in kg m), or load the bearing more.",
            {"q": record.final.q, "v": record.final.v, "ball": record.final.ball},
        )


def motion_warnings(model: Model, record: Record) -> tuple[str, ...]:
    """Sentences about the last turn of a record, each said once."""
    z = model.system.ball_count
    chosen = np.unique(np.linspace(max(len(record.time) - _turn(record), 0), len(record.time) - 1, _SAMPLES).astype(int))
    found = []
    open_balls = int((record.contact_force[chosen, :z] == 0.0).any(axis=0).sum())
    if open_balls:
        found.append(f"{open_balls} of {z} balls lose contact with the inner race during a turn")
    inner, outer = _angles(model, record, chosen)
    force = record.contact_force[chosen]
    over = model.bearing.over_edges(model, inner, outer, force)
    beyond: dict[str, str] = {}
    for k in np.flatnonzero(over):
        model.bearing.refuse_impossible(model, force[k])
        for text in model.bearing.edge_warnings(model, inner[k], outer[k], force[k]):
            beyond.setdefault(text.split(" reaches ")[0], text)
    if model.geometry.contact_angle > 0.0 and np.nanmin(inner, initial=np.inf) <= 0.0:
        found.append("the bearing unseats during a turn: the contact angle of a loaded ball is zero or negative")
    return (*found, *(f"during a turn {text}" for text in beyond.values()))


def _angles(model: Model, record: Record, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (n, Z) [rad] of some samples."""
    if model.system.spin is None:
        parts = record.displacement, record.ball, record.contact_force, record.time
        return model.bearing.contact_angles(model, *(part[chosen] for part in parts))
    found = []
    for k in chosen:
        now = attrs.evolve(model, system=model.system.at_speed(record.time[k]))
        found.append(
            model.bearing.contact_angles(
                now, record.displacement[k], record.ball[k], record.contact_force[k], record.time[k]
            )
        )
    inner, outer = zip(*found, strict=True)
    return np.array(inner), np.array(outer)


def _turn(record: Record) -> int:
    return max(record.schedule.steps_per_turn // record.schedule.stride, 1)


def inertia_warnings(table: Tables | None, total: float | None) -> list[str]:
    """Where motions that follow at once are off by more than a result's stated error says, and by more than 1 %."""
    found = {} if table is None else table.get("inertia") or {}
    parts = {
        "the inner ring": found.get("inner_supported_error"),
        "the outer ring": found.get("outer_supported_error"),
        "a ball along its grooves": found.get("ball_along_grooves_error"),
    }
    limit = max(_LAG, total or 0.0)
    beyond = {name: share for name, share in parts.items() if share is not None and share > limit}
    if not beyond:
        return []
    worst = max(beyond, key=lambda name: beyond[name])
    return [
        f"{worst} follows at once, which is off by (w / w1)^2 = {beyond[worst]:.2g} of what it gives way: that is not in the stated "
        "error. Elastic bodies (bodies.kind = 'elastic') move with their mass"
    ]
