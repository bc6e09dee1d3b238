"""The states of a result that are drawn: at rest, and through the last turn of its motion.

Drawing them is the business of ``raceway.plugins.reports.view``.
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

#: The largest motion in an animation over the ball diameter.
_LARGEST = 0.12
#: Moments of a turn among which the peak is looked for.
_EVERY = 360


@attrs.frozen(eq=False)
class Turn:
    """One turn in equal steps.

    Attributes
    ----------
    states : n states, motions about the state of rest times ``factor``
    factor : how much larger than in truth motions are drawn
    orbit : (k, 2) of the whole turn, y and z of the ring's reference point about its state of rest [m], not exaggerated
    force : (n, 2) of the excitation, y and z [N]
    angle : (n,) since the turn began [rad]
    """

    states: list[State]
    factor: float
    orbit: np.ndarray
    force: np.ndarray
    angle: np.ndarray


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
    """The moment of the last turn when a ball carries most on the inner race, and how far the turn is by then [deg]."""
    z = result.model.system.ball_count
    turn = last_turn(result, _EVERY)
    k = int(np.argmax([state.load[:z].max() for state in turn.states]))
    return attrs.evolve(turn.states[k], motion=np.zeros(5)), float(np.degrees(turn.angle[k]))


def last_turn(result: Result, frames: int) -> Turn:
    """The last turn of the recorded motion in at most so many frames.

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
    turn = record.displacement[first:] - result.equilibrium.displacement
    size = np.abs(turn * [1.0, 1.0, 1.0, model.system.arm, model.system.arm]).max()
    factor = _round_down(_LARGEST * model.geometry.ball_diameter / max(float(size), 1e-12))
    chosen = first + np.unique(np.linspace(0, len(turn), frames, endpoint=False).astype(int))
    z = model.system.ball_count
    states = []
    for k in chosen:
        load, t = record.contact_force[k], float(record.time[k])
        now = attrs.evolve(model, system=model.system.at_speed(t))
        angle = np.concatenate(now.bearing.contact_angles(now, record.displacement[k], record.ball[k], load, t))
        halves, peaks = zip(*(_ellipse(now, race, part) for race, part in enumerate((load[:z], load[z:]))), strict=True)
        motion = factor * (record.displacement[k] - result.equilibrium.displacement)
        direction = now.system.centre_vectors(record.displacement[k], t)[1]
        azimuth = np.arctan2(direction[:, 1], direction[:, 0])
        states.append(State(azimuth, load, angle, np.concatenate(halves), np.concatenate(peaks), motion))
    angle = 2.0 * np.pi * (chosen - first) / per_turn
    return Turn(states, factor, turn[:, 1:3], record.force[chosen, 1:3], angle)


def _ellipse(model: Model, race: int, load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Semi-axes (n, 2) [m] and largest pressure (n,) [Pa]."""
    pressure, major, minor = model.bearing.contact_ellipse(model, race, load)
    return np.column_stack([major, minor]), pressure


def _round_down(value: float) -> float:
    """To 1, 2 or 5 times a power of ten: a factor that people remember."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(digit for digit in (1.0, 2.0, 5.0) if digit <= value / power * (1.0 + 1e-12)))
