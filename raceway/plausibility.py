"""What a user should know about a recorded motion: balls that unload, ellipses over the edge, motions that cannot be."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.record import Record
from raceway.errors import ConvergenceError
from raceway.model import Model
from raceway.statics import Equilibrium, beyond_the_groove, contact_angles, refuse_impossible_ellipses

#: Samples of the last turn that are looked at.
_SAMPLES = 60


def refuse_impossible(model: Model, equilibrium: Equilibrium, record: Record) -> None:
    """Refuse a motion that leaves the grooves.

    Raises
    ------
    ConvergenceError
        The ring moves further than the groove centres are apart: the ball would climb out of its groove.
    """
    moved = float(np.abs(record.displacement[:, :3] - equilibrium.displacement[:3]).max())
    limit = model.geometry.centre_distance
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
    least = np.inf
    beyond: dict[str, str] = {}
    for k in chosen:
        force = record.contact_force[k]
        now = attrs.evolve(model, system=model.system.at_speed(record.time[k]))
        inner, outer = contact_angles(now, record.displacement[k], record.ball[k], force, record.time[k])
        least = min(least, float(np.nanmin(inner, initial=np.inf)))
        refuse_impossible_ellipses(now, force)
        for text in beyond_the_groove(model, inner, outer, force):
            beyond.setdefault(text.split(" reaches ")[0], text)
    if model.geometry.contact_angle > 0.0 and least <= 0.0:
        found.append("the bearing unseats during a turn: the contact angle of a loaded ball is zero or negative")
    return (*found, *(f"during a turn {text}" for text in beyond.values()))


def _turn(record: Record) -> int:
    return max(record.schedule.steps_per_turn // record.schedule.stride, 1)
