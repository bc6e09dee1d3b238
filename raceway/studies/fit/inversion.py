"""From the 1x response at the sensor to force, moment and motion in the bearing, and how its K and C follow changes.

Notes
-----
The shaft's answers are linear in unbalance force U, bearing force F and bearing moment M.  The response at the sensor is one complex
equation for F and M; the other says that the bearing, under F and M, tilts as the shaft does.  The tilt is that of the scene's bearing
(it cannot be seen beside a bearing); the deflection, and so the radial stiffness, is that of the signal.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Iterable

import attrs
import numpy as np

from raceway.scene.rig import Rig
from raceway.studies.shaft.bearing import Bearing, State, find_root
from raceway.studies.shaft.rotor import Rotor, rotor


def invert(shaft: Rotor, bearing: Bearing, sensor: complex) -> State:
    """State of the bearing from the deflection at the sensor [m], its phase against the unbalance.

    Raises
    ------
    ConvergenceError
        No moment found at which bearing and shaft tilt alike.
    """

    def force(moment: complex) -> complex:
        return complex((sensor - shaft.at_sensor(0.0, moment)) / shaft.sensor[1])

    def difference(moment: np.ndarray) -> np.ndarray:
        load = force(moment[0])
        return bearing.answer(shaft.speed, load, moment[0])[1:] - shaft.at_ring(load, moment[0])[1:]

    # With the tilts' tangent at rest the difference is linear in the moment.
    step = -shaft.sensor[2] / shaft.sensor[1]
    gain = (bearing.compliance[1] - shaft.ring[1, 1:]) @ np.array([step, 1.0])
    at_zero = bearing.compliance[1, 0] * force(0.0) - shaft.at_ring(force(0.0), 0.0)[1]
    start = np.array([-at_zero / gain])
    size = np.abs(bearing.compliance[1]) @ np.abs([force(start[0]), start[0]])
    (moment,), runs = find_root(difference, start, np.array([[gain]]), np.array([size]))
    return _state(shaft, force(moment), moment, bearing, runs)


def with_tilt_of(shaft: Rotor, state: State, sensor: complex, stiffer: float = 1.0) -> State:
    """State of the bearing by the deflection at the sensor, with the moment over tilt of a state nearby; costs no run.

    Parameters
    ----------
    stiffer : factor on the moment over tilt; 0 for a bearing that resists no tilt
    """
    # Unknown F, M and slope: sensor, slope of the shaft, and M * slope_0 = stiffer * M_0 * slope.
    matrix = np.array(
        [
            [shaft.sensor[1], shaft.sensor[2], 0.0],
            [shaft.ring[1, 1], shaft.ring[1, 2], -1.0],
            [0.0, state.slope, -stiffer * state.moment],
        ]
    )
    scale = np.array([1.0, abs(state.moment / state.force), abs(state.slope / state.force)])
    rows = np.array([abs(shaft.sensor[1]), scale[2], abs(state.slope) * scale[1]])
    right = np.array([sensor - shaft.sensor[0] * shaft.unbalance_force, -shaft.ring[1, 0] * shaft.unbalance_force, 0.0])
    load = scale * np.linalg.solve(matrix * scale / rows[:, None], right / rows)
    return _state(shaft, load[0], load[1], state, 0)


def with_moment(shaft: Rotor, sensor: complex, moment: complex, like: State | Bearing) -> State:
    """State of the bearing by the deflection at the sensor under a moment [N m]."""
    force = (sensor - shaft.at_sensor(0.0, moment)) / shaft.sensor[1]
    return _state(shaft, force, moment, like, 0)


def _state(shaft: Rotor, force: complex, moment: complex, like: State | Bearing, runs: int) -> State:
    deflection, slope = shaft.at_ring(force, moment)
    sensor = shaft.at_sensor(force, moment)
    return State(shaft.speed, force, moment, deflection, slope, sensor, like.mass, like.coupling, runs)


def coefficients(state: State) -> np.ndarray:
    """K [N/m] and C [N s/m] with the rig's tilt, then with the tilt locked (4,)."""
    return np.array([state.stiffness, state.damping, *state.locked])


def standard_errors(shaft: Rotor, state: State, error: float) -> np.ndarray:
    """Standard errors of ``coefficients`` (4,) for one of the deflection at the sensor [m], real and imaginary part together.

    Notes
    -----
    Z is analytic in the deflection while moment over tilt stays; half of its variance lies along each direction.
    """
    step = 1e-4 * abs(state.sensor)
    more, less = (coefficients(with_tilt_of(shaft, state, state.sensor + sign * step)) for sign in (1.0, -1.0))
    change = (more - less) / (2.0 * step)
    slopes = np.hypot(change[::2], state.speed * change[1::2])
    stiffness = slopes * error / np.sqrt(2.0)
    return np.array([stiffness[0], stiffness[0] / state.speed, stiffness[1], stiffness[1] / state.speed])


def largest_change(state: State, changed: Iterable[State]) -> np.ndarray:
    """Largest change of ``coefficients`` (4,) among changed states."""
    return np.max([np.abs(coefficients(other) - coefficients(state)) for other in changed], axis=0)


def turned(shaft: Rotor, state: State, response: complex, angle: float) -> list[State]:
    """States when the response with its run-out [m] turns by an angle [rad] either way."""
    moved = [state.sensor + response * (exp(1j * turn) - 1.0) for turn in (-angle, angle)]
    return [with_tilt_of(shaft, state, sensor) for sensor in moved]


def tilted(shaft: Rotor, state: State, part: float) -> list[State]:
    """States when the tilt stiffness that is assumed is off by a part of itself either way.

    Notes
    -----
    The tilt stiffness is that of the scene's bearing, and no sensor sees it.  How far the scene misses the K of the signals is
    all that is known of how far it misses the tilt stiffness, which goes with the axial stiffness and follows the contact angle more.
    """
    return [with_tilt_of(shaft, state, state.sensor, factor) for factor in (1.0 / (1.0 + part), 1.0 + part)]


def changed_rotors(rig: Rig, speed: float) -> dict[str, Rotor]:
    """The rotor with one change of what is taken as known."""
    rigs: dict[str, Rig] = {
        "shaft's diameter +1 %": attrs.evolve(rig, shaft_diameter=1.01 * rig.shaft_diameter),
        "Young's modulus of the shaft +1 %": attrs.evolve(rig, young=1.01 * rig.young),
        "density of shaft and disc +1 %": attrs.evolve(rig, density=1.01 * rig.density),
    }
    hub = 2.0 * (rig.hub_diameter or rig.shaft_diameter)
    if hub <= 2.0 * rig.disc_radius:
        rigs["disc stiffens the shaft (hub twice as thick)"] = attrs.evolve(rig, hub_diameter=hub)
    try:
        farther = attrs.evolve(rig, sensor_distance=rig.sensor_distance + 5e-4)
        rigs["sensor 0.5 mm farther from the bearing"] = farther
    except ValueError:  # it sits at the end already
        rigs["sensor 0.5 mm nearer to the bearing"] = attrs.evolve(rig, sensor_distance=rig.sensor_distance - 5e-4)
    return {change: rotor(other, speed) for change, other in rigs.items()}


def sensitivities(rotors: dict[str, Rotor], shaft: Rotor, state: State) -> list[dict[str, float | str]]:
    """Relative change of K by one change of what is taken as known.

    Parameters
    ----------
    rotors : of changed rigs, by their change
    """
    states = {change: with_tilt_of(other, state, state.sensor) for change, other in rotors.items()}
    states["tilt stiffness of the bearing +10 %"] = with_tilt_of(shaft, state, state.sensor, 1.1)
    more = attrs.evolve(shaft, unbalance_force=1.01 * shaft.unbalance_force)
    states["unbalance +1 %"] = with_tilt_of(more, state, state.sensor)
    states["sensor's scale +1 %"] = with_tilt_of(shaft, state, 1.01 * state.sensor)
    base = with_tilt_of(shaft, state, state.sensor).stiffness
    return [{"change": change, "stiffness": other.stiffness / base - 1.0} for change, other in states.items()]
