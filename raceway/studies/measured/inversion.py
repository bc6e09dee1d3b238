"""From the 1x line at the sensor to force, moment and motion in the bearing.

Notes
-----
The shaft's answers are linear in unbalance force U, bearing force F and bearing moment M.  The sensor's line is one complex
equation for F and M; the other says that the bearing, under F and M, tilts as the shaft does.  The tilt is the scene's bearing's
(it cannot be seen beside a bearing); the deflection, and so the radial stiffness, is the signal's.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.studies.shaft.balance import State, find_root
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import Rotor


def invert(line: Rotor, held: Bearing, sensor: complex) -> State:
    """State of the bearing from the deflection at the sensor [m], its phase against the unbalance.

    Raises
    ------
    ConvergenceError
        No moment found at which bearing and shaft tilt alike.
    """

    def force(moment: complex) -> complex:
        return complex((sensor - line.at_sensor(0.0, moment)) / line.sensor[1])

    def apart(moment: np.ndarray) -> np.ndarray:
        load = force(moment[0])
        return held.answer(line.speed, load, moment[0])[1:] - line.at_ring(load, moment[0])[1:]

    # With the tilts' tangent at rest the difference is linear in the moment.
    step = -line.sensor[2] / line.sensor[1]
    gain = (held.compliance[1] - line.ring[1, 1:]) @ np.array([step, 1.0])
    at_zero = held.compliance[1, 0] * force(0.0) - line.at_ring(force(0.0), 0.0)[1]
    start = np.array([-at_zero / gain])
    size = np.abs(held.compliance[1]) @ np.abs([force(start[0]), start[0]])
    (moment,), runs = find_root(apart, start, np.array([[gain]]), np.array([size]))
    return _state(line, force(moment), moment, held, runs)


def with_tilt_of(line: Rotor, state: State, sensor: complex, stiffer: float = 1.0) -> State:
    """State of the bearing by the sensor's line, with the moment over tilt of a state nearby; costs no run.

    Parameters
    ----------
    stiffer : factor on the moment over tilt; 0 for a bearing that resists no tilt
    """
    # Unknown F, M and slope: sensor, slope of the shaft, and M * slope_0 = stiffer * M_0 * slope.
    matrix = np.array(
        [
            [line.sensor[1], line.sensor[2], 0.0],
            [line.ring[1, 1], line.ring[1, 2], -1.0],
            [0.0, state.slope, -stiffer * state.moment],
        ]
    )
    scale = np.array([1.0, abs(state.moment / state.force), abs(state.slope / state.force)])
    rows = np.array([abs(line.sensor[1]), scale[2], abs(state.slope) * scale[1]])
    known = np.array([sensor - line.sensor[0] * line.unbalance_force, -line.ring[1, 0] * line.unbalance_force, 0.0])
    load = scale * np.linalg.solve(matrix * scale / rows[:, None], known / rows)
    return _state(line, load[0], load[1], state, 0)


def with_moment(line: Rotor, sensor: complex, moment: complex, like: State | Bearing) -> State:
    """State of the bearing by the sensor's line under a known moment [N m]."""
    force = (sensor - line.at_sensor(0.0, moment)) / line.sensor[1]
    return _state(line, force, moment, like, 0)


def _state(line: Rotor, force: complex, moment: complex, like: State | Bearing, runs: int) -> State:
    deflection, slope = line.at_ring(force, moment)
    sensor = line.at_sensor(force, moment)
    return State(line.speed, force, moment, deflection, slope, sensor, like.mass, like.coupling, runs)


def values(state: State) -> np.ndarray:
    """K [N/m] and C [N s/m] with the rig's tilt, then with the tilt locked (4,)."""
    return np.array([state.stiffness, state.damping, *state.locked])


def scatter(line: Rotor, state: State, error: float) -> np.ndarray:
    """Standard errors of ``values`` (4,) for one of the sensor's line [m], real and imaginary part together.

    Notes
    -----
    Z is analytic in the line while moment over tilt stays; half of the line's variance lies along each direction.
    """
    step = 1e-4 * abs(state.sensor)
    more, less = (values(with_tilt_of(line, state, state.sensor + sign * step)) for sign in (1.0, -1.0))
    change = (more - less) / (2.0 * step)
    slopes = np.hypot(change[::2], state.speed * change[1::2])
    each = slopes * error / np.sqrt(2.0)
    return np.array([each[0], each[0] / state.speed, each[1], each[1] / state.speed])


def sensitivities(rig_lines: dict[str, Rotor], line: Rotor, state: State) -> list[dict[str, float | str]]:
    """Relative change of K when one thing that is taken as known is otherwise.

    Parameters
    ----------
    rig_lines : the rotor of each changed rig, by what was changed
    """
    base = with_tilt_of(line, state, state.sensor).stiffness

    def changed(what: str, other: State) -> dict[str, float | str]:
        return {"change": what, "stiffness": other.stiffness / base - 1.0}

    rows = [changed(what, with_tilt_of(other, state, state.sensor)) for what, other in rig_lines.items()]
    rows.append(changed("tilt stiffness of the bearing +10 %", with_tilt_of(line, state, state.sensor, 1.1)))
    more = attrs.evolve(line, unbalance_force=1.01 * line.unbalance_force)
    rows.append(changed("unbalance +1 %", with_tilt_of(more, state, state.sensor)))
    rows.append(changed("sensor's scale +1 %", with_tilt_of(line, state, 1.01 * state.sensor)))
    return rows
