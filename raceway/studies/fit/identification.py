"""From the 1x line at the sensor to force, moment and motion in the bearing.

Notes
-----
The shaft's answers are linear in unbalance force U, bearing force F and bearing moment M.  The sensor's line is one complex
equation for F and M; the other says that the bearing, under F and M, tilts as the shaft does.  The tilt is the scene's bearing's
(it cannot be seen beside a bearing); the deflection, and so the radial stiffness, is the signal's.
"""

from __future__ import annotations

from cmath import exp
from collections.abc import Callable
from math import pi, radians
from pathlib import Path

import attrs
import numpy as np

from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import without_nan
from raceway.scene.rig import Rig
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables
from raceway.studies.fit.shaft_angle import Turning, turning
from raceway.studies.fit.signals import Recording, Signals, read_signals, recording_of
from raceway.studies.fit.synchronous import Order, RunOut, given, less_response, order, slow_roll
from raceway.studies.shaft.bearing import Bearing, State, bearing, find_root
from raceway.studies.shaft.rotor import Rotor, rotor


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


#: Half-width of an interval of 95 % over the standard error.
_COVERAGE = 1.96
#: Deflection of the bearing below this part of the sensor's line is a small difference of large numbers.
_SMALL = 0.1
#: Part by which the tilt stiffness may be off over that by which the scene misses K.
_TILT = 2.0
#: K off the scene's by more than this is told.
_UNLIKE = 0.3


@attrs.frozen(eq=False)
class Found:
    """The bearing as identified from signals.

    Attributes
    ----------
    turning, order : of the record;  run_out : that was subtracted;  state : of the bearing
    scene : K of the scene's bearing under the same force and moment [N/m]
    parts : half-widths at 95 % by cause, (4,) like ``inversion.values``
    changes : ``sensitivities``
    """

    turning: Turning
    order: Order
    run_out: RunOut
    state: State
    scene: float
    parts: dict[str, np.ndarray]
    changes: list[dict[str, float | str]]

    @property
    def uncertainty(self) -> np.ndarray:
        """Half-widths at 95 %, all causes together (4,): K [N/m] and C [N s/m] with the rig's tilt, then with it locked."""
        return np.sqrt(sum(part**2 for part in self.parts.values()))

    def to_dict(self) -> Tables:
        """Tables for JSON."""
        state = self.state
        return without_nan(
            {
                **self._signals(),
                "bearing": {
                    "force_n": abs(state.force),
                    "moment_nm": abs(state.moment),
                    "deflection_m": abs(state.deflection),
                    "slope_rad": abs(state.slope),
                    "sensor_m": abs(state.sensor),
                    "runs": state.runs,
                },
                "identification": self._identification(),
                "uncertainty": {
                    "how": "half-widths at 95 %: scatter of the blocks of turns, slow roll, marks between samples, least squares against "
                    "whole-turn Fourier, the tilt stiffness that is assumed; what is taken as known of the rig is in `sensitivities`",
                    "parts": {
                        name: {"stiffness": part[0], "damping": part[1] if self.order.marked else None}
                        for name, part in self.parts.items()
                    },
                },
                "sensitivities": self.changes,
                "warnings": self.warnings(),
            }
        )

    def _signals(self) -> Tables:
        """What the signals hold: ``signals``, their 1x ``line``, the ``run_out``."""
        found, marked, time = self.order, self.order.marked, self.turning.recording.time
        return {
            "signals": {
                "samples": len(time),
                "duration_s": float(time[-1] - time[0]),
                "turns": found.turns,
                "speed_rpm": {name: value * 30.0 / pi for name, value in _speeds(found).items()},
                "angle_from": "marks of key" if marked else "integrated speed, no mark: the phase is not known",
            },
            "line": {
                "forward_m": abs(found.line),
                "angle_deg": float(np.degrees(np.angle(found.line))) if marked else None,
                "backward_m": found.backward,
                "error_m": found.error,
                "residual": found.residual,
                "fourier_m": abs(found.fourier),
            },
            "run_out": {
                "amplitude_m": abs(self.run_out.vector),
                "angle_deg": float(np.degrees(np.angle(self.run_out.vector))),
                "error_m": self.run_out.error,
                "how": self.run_out.how,
            },
        }

    def _identification(self) -> Tables:
        state, rest, marked = self.state, self.uncertainty, self.order.marked
        z, locked = state.dynamic_stiffness, state.locked
        return {
            "definition": "secant: force of the shaft on the inner ring over its deflection, 1x forward, tilt as in the rig",
            "speed_rpm": state.speed * 30.0 / pi,
            "dynamic_stiffness": {"real": z.real, "imag": z.imag if marked else None, "abs": abs(z)},
            "equivalent_stiffness": state.stiffness,
            "equivalent_stiffness_error": rest[0],
            "equivalent_damping": state.damping if marked else None,
            "equivalent_damping_error": rest[1] if marked else None,
            "mass_used_kg": state.mass,
            "scene_stiffness": self.scene,
            "tilt_locked": {
                "definition": "the same less the force that the bearing carries for its tilt, by the scene's coupling at rest",
                "equivalent_stiffness": locked[0],
                "equivalent_stiffness_error": rest[2],
                "equivalent_damping": locked[1] if marked else None,
                "equivalent_damping_error": rest[3] if marked else None,
            },
        }

    def warnings(self) -> list[str]:
        """What a user should know."""
        state, k, out = self.state, self.uncertainty[0], []
        if not self.order.marked:
            out.append("no mark (`key`): the phase is taken as zero, so that C is not identified")
        if not self.run_out.vector:
            out.append("no run-out was subtracted: give --slow-roll or --run-out")
        if abs(state.stiffness / self.scene - 1.0) > _UNLIKE:
            out.append(
                f"under the same force and moment the scene's bearing has a K of {1e-6 * self.scene:.4g} N/µm: is it the bearing "
                "of the rig, in the rig's arrangement? Its tilt enters the result"
            )
        if abs(state.deflection) < _SMALL * abs(state.sensor):
            part = 100.0 * abs(state.deflection) / abs(state.sensor)
            out.append(f"the bearing moves by {part:.2g} % of what the sensor sees; the rest is the shaft's bow")
        if k > 0.1 * abs(state.stiffness):
            out.append(f"K is known to {100.0 * k / abs(state.stiffness):.2g} % only")
        if self.order.backward > 0.1 * abs(self.order.line):
            part = 100.0 * self.order.backward / abs(self.order.line)
            out.append(f"the orbit is no circle (backward line {part:.2g} %): the rig is taken to be the same in y and z")
        return out


def _speeds(found: Order) -> dict[str, float]:
    return {"mean": found.speed, "lowest": found.lowest, "highest": found.highest}


@attrs.frozen(eq=False)
class Seen:
    """The 1x line at the sensor against the unbalance: of a record, less its run-out.

    Attributes
    ----------
    run_out : that was subtracted
    line, fourier : deflection at the sensor [m], by least squares and by a whole-turn Fourier transform; without a mark their sizes
    """

    run_out: RunOut
    line: complex
    fourier: complex


def seen(found: Order, rig: Rig, held: Bearing, run_out: RunOut | None = None, slow: Order | None = None) -> Seen:
    """The 1x line of a record.

    Parameters
    ----------
    found : the order of the record
    held : the scene's bearing, by which the unbalance's response is taken off a slow roll
    run_out : known run-out;  slow : instead of it, the 1x line of a slow roll

    Raises
    ------
    RacewayError
        An orbit that turns against the shaft, or a run-out without a mark.
    """
    if found.backward > abs(found.line):
        raise RacewayError(
            f"the orbit turns from z towards y, against the shaft ({1e6 * found.backward:.3g} µm backward, "
            f"{1e6 * abs(found.line):.3g} µm forward): change the sign of one column, or swap y and z"
        )
    angle = radians(rig.unbalance_angle_deg)
    run_out = run_out or RunOut()
    if slow is not None:
        run_out = less_response(slow, held, rotor(rig, slow.speed), angle)
    if run_out.vector and not found.marked:
        raise RacewayError("no `key`: without a mark the run-out cannot be subtracted; leave it out, or record the mark")
    if found.marked:
        line, fourier = ((value - run_out.vector) * exp(-1j * angle) for value in (found.line, found.fourier))
    else:
        line, fourier = abs(found.line) + 0j, abs(found.fourier) + 0j
    return Seen(run_out, line, fourier)


def identify(
    recording: Recording, rig: Rig, held: Bearing, run_out: RunOut | None = None, slow: Order | None = None
) -> Found:
    """K and C from a record.

    Parameters
    ----------
    held : the scene's bearing under the record's axial load
    run_out : known run-out;  slow : instead of it, the 1x line of a slow roll

    Raises
    ------
    RacewayError
        A record that cannot be used.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.
    """
    turned = turning(recording)
    found = order(turned)
    there = seen(found, rig, held, run_out, slow)
    line_at, fourier, run_out = there.line, there.fourier, there.run_out
    angle = radians(rig.unbalance_angle_deg)
    line = rotor(rig, found.speed)
    try:
        state = invert(line, held, line_at)
    except ConvergenceError as why:
        raise ConvergenceError(
            f"no bearing like the scene's moves the sensor by {1e6 * abs(line_at):.4g} µm at {found.speed * 30 / pi:.0f} r/min "
            f"({why}). Are unbalance, sensor's place and run-out right?"
        ) from None
    other = with_tilt_of(line, state, fourier)
    parts = {
        "spread": _COVERAGE * scatter(line, state, found.error),
        "slow roll": _COVERAGE * scatter(line, state, run_out.error),
        "marks": _turned(line, state, found.line * exp(-1j * angle), found.doubt),
        "window": np.abs(values(other) - values(state)),
    }
    x = held.answer(state.speed, state.force, state.moment)[0]
    scene = (state.force / x).real + state.mass * state.speed**2
    parts["tilt"] = _tilted(line, state, _TILT * abs(float(scene) / state.stiffness - 1.0))
    return Found(
        turned, found, run_out, state, float(scene), parts, sensitivities(changed_rotors(rig, found.speed), line, state)
    )


def _turned(line: Rotor, state: State, seen: complex, angle: float) -> np.ndarray:
    """Largest change of ``values`` (4,) when the line that is seen, run-out and all, turns by an angle [rad] either way."""
    moved = [state.sensor + seen * (exp(1j * turn) - 1.0) for turn in (-angle, angle)]
    return np.max([np.abs(values(with_tilt_of(line, state, other)) - values(state)) for other in moved], axis=0)


def _tilted(line: Rotor, state: State, part: float) -> np.ndarray:
    """Largest change of ``values`` (4,) when the tilt stiffness that is assumed is off by a part of itself either way.

    Notes
    -----
    The tilt stiffness is the scene's bearing's, and no sensor sees it.  How far the scene misses the K of the signals is
    all that is known of how far it misses the tilt stiffness, which goes with the axial stiffness and follows the contact angle more.
    """
    changed = [with_tilt_of(line, state, state.sensor, factor) for factor in (1.0 / (1.0 + part), 1.0 + part)]
    return np.max([np.abs(values(other) - values(state)) for other in changed], axis=0)


def changed_rotors(rig: Rig, speed: float) -> dict[str, Rotor]:
    """The rotor with one thing changed that is taken as known."""
    farther = rig.sensor_distance + 5e-4
    rigs: dict[str, Rig] = {
        "shaft's diameter +1 %": attrs.evolve(rig, shaft_diameter=1.01 * rig.shaft_diameter),
        "Young's modulus of the shaft +1 %": attrs.evolve(rig, young=1.01 * rig.young),
        "density of shaft and disc +1 %": attrs.evolve(rig, density=1.01 * rig.density),
    }
    hub = 2.0 * (rig.hub_diameter or rig.shaft_diameter)
    if hub <= 2.0 * rig.disc_radius:
        rigs["disc stiffens the shaft (hub twice as thick)"] = attrs.evolve(rig, hub_diameter=hub)
    try:
        rigs["sensor 0.5 mm farther from the bearing"] = attrs.evolve(rig, sensor_distance=farther)
    except ValueError:  # it sits at the end already
        rigs["sensor 0.5 mm nearer to the bearing"] = attrs.evolve(rig, sensor_distance=rig.sensor_distance - 5e-4)
    return {what: rotor(other, speed) for what, other in rigs.items()}


OnProgress = Callable[[str, int, int], None]


def from_files(
    signals: Path,
    scene: Scene,
    rig: Rig,
    registry: Registry,
    slow: Path | None = None,
    run_out: tuple[float, float] | None = None,
    on_progress: OnProgress | None = None,
) -> Found:
    """``from_signals`` of a record's file and the file of a slow roll."""
    still = None if slow is None else read_signals(slow)
    return from_signals(read_signals(signals), scene, rig, registry, still, run_out, on_progress)


def refuse_no_load(scene: Scene) -> None:
    """A bearing that nothing seats has no stiffness to compare with.

    Raises
    ------
    SceneError
        Naming the key.
    """
    if scene.load.axial <= 0.0:
        message = "must be the axial load of the measurement, greater than 0: add --set load.axial=..."
        raise SceneError.at("load.axial", scene.load.axial, message)


def roll_of(slow: Signals | None) -> Order | None:
    """The 1x line of a slow roll, if there is one.

    Raises
    ------
    SceneError
        What is wrong with it.
    """
    if slow is None:
        return None
    try:
        return slow_roll(recording_of(slow))
    except RacewayError as why:
        raise why if isinstance(why, SceneError) else SceneError.at(slow.source, None, str(why)) from None


def from_signals(
    signals: Signals,
    scene: Scene,
    rig: Rig,
    registry: Registry,
    slow: Signals | None = None,
    run_out: tuple[float, float] | None = None,
    on_progress: OnProgress | None = None,
) -> Found:
    """K and C from a record.

    Parameters
    ----------
    slow : a slow roll;  run_out : instead of it, its amplitude [m] and angle from the mark [deg]

    Raises
    ------
    SceneError
        What is wrong with a record or the scene.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.
    """

    def tell(what: str, done: int) -> None:
        if on_progress is not None:
            on_progress(what, done, 3)

    refuse_no_load(scene)
    recording = recording_of(signals)
    roll = roll_of(slow)
    tell("bearing at rest", 1)
    held = bearing(scene, scene.load.axial, registry)
    tell("identifying", 2)
    known = None if run_out is None else given(*run_out)
    try:
        return identify(recording, rig, held, known, roll)
    except RacewayError as why:
        if why.exit_code != 2 or isinstance(why, SceneError):
            raise
        raise SceneError.at(signals.source, None, str(why)) from None
