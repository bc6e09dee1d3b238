"""The states of a result that are drawn: at rest, and through the last turn of its motion.

Drawing them is the business of ``raceway.studies.view``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.pipeline.result import Result, equilibrium_table
from raceway.studies.view.bearing import State

if TYPE_CHECKING:
    from raceway.bodies.model import Model

#: Moments of a turn among which the peak is looked for.
_EVERY = 360


def at_rest(result: Result) -> State:
    """The static state, with the numbers of result.json."""
    found, model = result.equilibrium, result.model
    balls = equilibrium_table(model, found)["balls"]

    def column(name: str) -> np.ndarray:
        return np.array([ball[name.format(race)] for race in ("inner", "outer") for ball in balls])

    half = np.column_stack([column("semi_major_{}_m"), column("semi_minor_{}_m")])
    angle = np.r_[found.angle_inner, found.angle_outer]
    return State(model.azimuth, column("load_{}_n"), angle, half, column("peak_pressure_{}_pa"), np.zeros(5))


def at_peak(result: Result) -> tuple[State, float]:
    """The moment of the last turn when a ball carries most on either race, and how far the turn is by then [deg].

    Raises
    ------
    SceneError
        A result without motion.
    """
    if result.simulation is None:
        message = "nothing moves in this scene: give it the table [excitation], and an identifier that looks at motion"
        raise SceneError.at("excitation", None, message)
    record, model = result.simulation.record, result.model
    per_turn = max(record.schedule.steps_per_turn // record.schedule.stride, 1)
    first = max(len(record.time) - per_turn, 0)
    chosen = first + np.unique(np.linspace(0, len(record.time) - first, _EVERY, endpoint=False).astype(int))
    k = int(chosen[np.argmax(record.contact_force[chosen].max(axis=1))])
    z, load, t = model.system.ball_count, record.contact_force[k], float(record.time[k])
    now = attrs.evolve(model, system=model.system.at_speed(t))
    angle = np.concatenate(now.bearing.contact_angles(now, record.displacement[k], record.ball[k], load, t))
    halves, peaks = zip(*(_ellipse(now, race, part) for race, part in enumerate((load[:z], load[z:]))), strict=True)
    direction = now.system.centre_vectors(record.displacement[k], t)[1]
    azimuth = np.arctan2(direction[:, 1], direction[:, 0])
    state = State(azimuth, load, angle, np.concatenate(halves), np.concatenate(peaks), np.zeros(5))
    return state, 360.0 * (k - first) / per_turn


def _ellipse(model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Semi-axes (n, 2) [m] and largest pressure (n,) [Pa]."""
    pressure, major, minor = model.bearing.contact_ellipse(model, race, load)
    return np.column_stack([major, minor]), pressure
