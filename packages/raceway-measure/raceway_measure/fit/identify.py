"""K and C of a bearing in a rig from measured signals: ``raceway.identify`` and its answer."""

from __future__ import annotations

from cmath import exp
from collections.abc import Iterable, Mapping
from math import pi, radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig, rig_of
from raceway_rotor.shaft import Bearing, Rotor, State, bearing, rotor

from raceway import Answer, ConvergenceError, SceneError, door
from raceway.extend import (
    PATH, PATHS, Fact, Part, SceneSource, ShowProgress, Tables, Words, as_scene, given_axes, labelled_dataset, number,
    registry_with, sections, telling, without_nan, writable,
)  # fmt: skip
from raceway_measure.fit.estimate import COVERAGE
from raceway_measure.fit.fitted import interval
from raceway_measure.fit.rig import changed_rotors, invert, refuse_no_load, with_tilt_of
from raceway_measure.fit.shaft_angle import Rotation, rotation_of
from raceway_measure.fit.signals import COLUMNS, RUN_OUT, Data, Recording, faults_at, recording_of, signals_of
from raceway_measure.fit.synchronous import RunOut, Synchronous, response_of, stated_run_out, synchronous

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

#: Deflection of the bearing below this part of that at the sensor is a small difference of large numbers.
_SMALL = 0.1
#: Part by which the tilt stiffness may be off, over that by which the scene misses K.
_TILT = 2.0
#: Relative difference from the scene's K above which a warning is due.
_UNLIKE = 0.3


@attrs.frozen(eq=False, repr=False)
class Identified(Answer):
    """A bearing's dynamic stiffness as identified from signals, at their speed, the tilt as in the rig.

    Attributes
    ----------
    rotation, component : of the record;  run_out : that was subtracted;  state : of the bearing
    scene_stiffness : K of the scene's bearing under the same force and moment [N/m]
    parts : half-widths at 95 % by cause, (4,) like ``inversion.coefficients``;  changes : ``inversion.sensitivities``
    title : of the scene;  source : file of the signals, or "signals"

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> orbit = {"time_s": time, "y_um": 15.0 * np.cos(angle), "z_um": 15.0 * np.sin(angle), "speed_rpm": 12000.0 + 0.0 * time}
    >>> rig = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000}, "rig": {}, "integrator": {"kind": "quasi_static"}}
    >>> bearing = rw.identify(orbit, rig)
    >>> round(bearing.speed_rpm), round(1e-6 * bearing.equivalent_stiffness)  # [r/min], K [N/um]
    (12000, 84)
    """

    stem: ClassVar[str] = "identify"
    rotation: Rotation
    component: Synchronous
    run_out: RunOut
    state: State
    scene_stiffness: float
    parts: dict[str, np.ndarray]
    changes: list[dict[str, float | str]]
    title: str = ""
    source: str = "signals"

    @property
    def uncertainty(self) -> np.ndarray:
        """Half-widths at 95 %, all causes together (4,): K [N/m] and C [N s/m] with the rig's tilt, then with it locked."""
        return np.sqrt(sum(part**2 for part in self.parts.values()))

    @property
    def speed_rpm(self) -> float:
        """Mean speed of the record [r/min]."""
        return self.state.speed * 30.0 / pi

    @property
    def dynamic_stiffness(self) -> complex | None:
        """Z, complex [N/m]; None without pulses, which leave its size alone."""
        return complex(self.state.dynamic_stiffness) if self.component.marked else None

    @property
    def equivalent_stiffness(self) -> float:
        """K = Re Z + m w^2 [N/m]."""
        return float(self.state.stiffness)

    @property
    def equivalent_stiffness_error(self) -> float:
        """Half-width of K at 95 % [N/m]."""
        return float(self.uncertainty[0])

    @property
    def equivalent_damping(self) -> float | None:
        """C = Im Z / w [N s/m]; None without pulses."""
        return float(self.state.damping) if self.component.marked else None

    @property
    def equivalent_damping_error(self) -> float | None:
        """Half-width of C at 95 % [N s/m]; None without pulses."""
        return float(self.uncertainty[1]) if self.component.marked else None

    @property
    def warnings(self) -> list[str]:
        """Sentences that a reader of K needs."""
        state, component, k, out = self.state, self.component, self.uncertainty[0], []
        if not component.marked:
            out.append("no mark (`key`): the phase is set to zero, so C is not identified")
        if not self.run_out.vector:
            out.append("no run-out was subtracted: give --slow-roll or --run-out")
        if abs(state.stiffness / self.scene_stiffness - 1.0) > _UNLIKE:
            out.append(
                f"under the same force and moment the scene's bearing has a K of {1e-6 * self.scene_stiffness:.4g} N/µm: check bearing and arrangement "
                "of the rig; their tilt stiffness enters the result"
            )
        if abs(state.deflection) < _SMALL * abs(state.sensor):
            part = 100.0 * abs(state.deflection) / abs(state.sensor)
            out.append(f"the bearing moves by {part:.2g} % of the sensor signal; the remainder is the bow of the shaft")
        if k > 0.1 * abs(state.stiffness):
            out.append(f"K is known to {100.0 * k / abs(state.stiffness):.2g} % only")
        if component.backward > 0.1 * abs(component.forward):
            part = 100.0 * component.backward / abs(component.forward)
            out.append(f"the orbit is not a circle (backward component {part:.2g} %): the rig is assumed equal in y and z")
        return out

    def to_dict(self) -> Tables:
        """Everything but the samples, as in identify.json."""
        return {"title": self.title, "file": self.source, **self.content()}

    def content(self) -> Tables:
        """Signals, their 1x component, the bearing and its uncertainty, as tables for JSON."""
        component, with_mark, state = self.component, self.component.marked, self.state
        time = self.rotation.recording.time
        speeds = {"mean": component.speed, "lowest": component.lowest, "highest": component.highest}
        return without_nan({
            "signals": {
                "samples": len(time),
                "duration_s": float(time[-1] - time[0]),
                "turns": component.turns,
                "speed_rpm": {name: value * 30.0 / pi for name, value in speeds.items()},
                "angle_from": "marks of key" if with_mark else "integrated speed, no mark: the phase is unknown",
            },
            "line": {
                "forward_m": abs(component.forward),
                "angle_deg": float(np.degrees(np.angle(component.forward))) if with_mark else None,
                "backward_m": component.backward,
                "error_m": component.error,
                "residual": component.residual,
                "fourier_m": abs(component.fourier),
            },
            "run_out": {
                "amplitude_m": abs(self.run_out.vector),
                "angle_deg": float(np.degrees(np.angle(self.run_out.vector))),
                "error_m": self.run_out.error,
                "how": self.run_out.how,
            },
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
                "how": "half-widths at 95 %: spread of the blocks of turns, slow roll, marks between samples, least squares against "
                "whole-turn Fourier, the assumed tilt stiffness; parameters of the rig taken as known are in `sensitivities`",
                "parts": {
                    name: {"stiffness": part[0], "damping": part[1] if with_mark else None}
                    for name, part in self.parts.items()
                },
            },
            "sensitivities": self.changes,
            "warnings": self.warnings,
        })  # fmt: skip

    def _identification(self) -> Tables:
        """K and C with the rig's tilt, then with it locked; what needs a phase is None without pulses."""
        with_mark, state, z, error = self.component.marked, self.state, self.state.dynamic_stiffness, self.uncertainty
        stiffness, damping = state.locked
        return {
            "definition": "secant: force of the shaft on the inner ring over its deflection, 1x forward, tilt as in the rig",
            "speed_rpm": self.speed_rpm,
            "dynamic_stiffness": {"real": z.real, "imag": z.imag if with_mark else None, "abs": abs(z)},
            "equivalent_stiffness": state.stiffness,
            "equivalent_stiffness_error": error[0],
            "equivalent_damping": self.equivalent_damping,
            "equivalent_damping_error": self.equivalent_damping_error,
            "mass_used_kg": state.mass,
            "scene_stiffness": self.scene_stiffness,
            "tilt_locked": {
                "definition": "the same less the force that the bearing carries for its tilt, by the scene's coupling at rest",
                "equivalent_stiffness": stiffness,
                "equivalent_stiffness_error": error[2],
                "equivalent_damping": damping if with_mark else None,
                "equivalent_damping_error": error[3] if with_mark else None,
            },
        }

    def to_xarray(self) -> Dataset:
        """The full turns of the record that were used: y, z [m], angle [rad], speed [rad/s], key over time [s].

        ``raceway.identify`` takes it as signals.

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        record = self.rotation.recording
        columns = {"y": (record.y, "m"), "z": (record.z, "m"), "key": (record.key, ""), "speed": (record.speed, "rad/s")}
        variables = {
            name: ("time", np.asarray(values), {"units": unit} if unit else {})
            for name, (values, unit) in columns.items()
            if values is not None
        }
        return labelled_dataset(variables, {"time": ("time", record.time, {"units": "s"})}, {"title": self.title})

    def drawings(self) -> dict[str, Figure]:
        """Signals, spectrum and orbits."""
        from raceway_measure.fit.picture import figures

        return figures(self.rotation, self.component, self.state)

    @door
    def plot(self, what: str = "orbits", ax: Axes | None = None) -> Axes:
        """Draw the orbits at the sensor and in the bearing [um], or the spectrum over orders.

        Parameters
        ----------
        what : "orbits" or "spectrum"
        ax : matplotlib axes; new ones without

        Raises
        ------
        SceneError
            Another word.
        RacewayError
            matplotlib is missing.
        """
        from raceway_measure.fit.picture import draw_orbits, draw_spectrum

        if what not in ("orbits", "spectrum"):
            raise SceneError.at("what", what, "must be one of orbits, spectrum")
        axes = given_axes(ax, 6.0, 6.0 if what == "orbits" else 3.5)
        if what == "spectrum":
            draw_spectrum(self.rotation, axes)
        else:
            draw_orbits(self.rotation, self.component, self.state, axes)
            axes.legend(frameon=False, fontsize=8)
        return axes

    def _coefficients(self) -> list[Fact]:
        """K and C with their half-widths, and K of the scene."""
        c, wide, state = self.equivalent_damping, self.equivalent_damping_error, self.state
        facts = [
            interval("K", self.equivalent_stiffness, self.uncertainty[0], "N/m", f"Re Z + m w^2, m = {state.mass:.4g} kg")
        ]
        if c is not None and wide is not None:
            value = number(c, "N s/m", 4) if abs(c) > wide else "not resolved"
            facts.append(("C", value, f"+- {number(wide, 'N s/m', 2)} at 95 %"))
        locked_tilt = interval(
            "K, tilt locked", state.locked[0], self.uncertainty[2], "N/m", "less the force of the bearing's tilt"
        )
        scene = number(1e-6 * self.scene_stiffness, "N/µm")
        return [*facts, ("K of the scene's bearing", scene, "under the same force and moment"), locked_tilt]

    def report(self) -> list[Part]:
        """Signals, 1x component, bearing, K and C."""
        content, component, state, run_out = self.content(), self.component, self.state, self.run_out
        signals, speed = content["signals"], content["signals"]["speed_rpm"]
        angle = f"{content['line']['angle_deg']:.2f} deg from the mark" if component.marked else ""
        rows = [
            ("Signals", "", f"{signals['samples']} samples, {signals['turns']} turns, angle from {signals['angle_from']}"),
            ("speed", number(speed["mean"], "r/min", 6), f"{speed['lowest']:.1f} to {speed['highest']:.1f} r/min"),
            ("1x component, forward", number(1e6 * abs(component.forward), "µm"), angle),
            ("1x component, backward", number(1e6 * component.backward, "µm", 3), f"residual of the fit {100 * component.residual:.2g} %"),
            ("run-out", number(1e6 * abs(run_out.vector), "µm", 4), run_out.how),
            ("Bearing", "", "by inversion of the beam"),
            ("deflection", number(1e6 * abs(state.deflection), "µm"), f"of {1e6 * abs(state.sensor):.4g} µm at the sensor"),
            ("force, moment", number(abs(state.force), "N"), f"{abs(state.moment):.4g} N m, slope {abs(state.slope):.3g} rad"),
            (f"Dynamic stiffness at {self.speed_rpm:.0f} r/min", "", content["identification"]["definition"]),
            ("|Z|", number(1e-6 * abs(state.dynamic_stiffness), "N/µm"), "force over deflection"),
            *self._coefficients(),
            ("Relative change of K by", "", "a change of what is taken as known"),
            *((str(change["change"]), f"{100 * float(change['stiffness']):+.2f} %", "") for change in self.changes),
        ]  # fmt: skip
        warnings = [Words(f"warning: {text}", "yellow") for text in self.warnings]
        return [Words(self.title, "bold"), sections(rows), *warnings]

    def _facts(self) -> tuple[str, list[Fact]]:
        title = f"Identified from {self.source} at {self.speed_rpm:.1f} r/min\n{self.title.splitlines()[0]}"
        return title, [*self._coefficients(), *(("warning", "", text) for text in self.warnings)]


@door
def identify(
    signals: Data,
    scene: SceneSource,
    *,
    slow_roll: Data | None = None,
    run_out: Annotated[tuple[float, float] | None, RUN_OUT] = None,
    columns: Annotated[Mapping[str, str] | None, COLUMNS] = None,
    out: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Identified:
    """Identify a bearing's K and C, with their uncertainty, from the signals of a sensor beside it.

    Parameters
    ----------
    signals : CSV file, mapping of arrays (n,), pandas.DataFrame or xarray.Dataset; columns as ``time_s``, ``y_um``, ``z_um`` and
        ``key`` (once-per-turn probe) or ``speed_rpm``, or as other programs name them, ``Time (s)``, ``X [um]``, ``Y [um]``
    scene : Scene, path, TOML text or dict of tables, with a table ``rig`` and ``load.axial`` [N] as in the measurement
    slow_roll : signals at a low speed, in any of these forms, whose run-out is subtracted
    run_out : the run-out itself: amplitude [m] and angle from the mark [deg]
    columns : header of a column -> name, ``{"X [um]": "y_um"}``; "ignore" leaves it out
    out : folder in which identify.json is written; None: nothing is written
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Identified
        ``equivalent_stiffness`` [N/m], ``equivalent_damping`` [N s/m] and their errors, half-widths at 95 %

    Raises
    ------
    SceneError
        The fault of signals or scene.  Records of one axis, and of force and displacement, are read, and refused
        with what they hold and what is missing.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> orbit = {"time_s": time, "y_um": 15.0 * np.cos(angle), "z_um": 15.0 * np.sin(angle), "speed_rpm": 12000.0 + 0.0 * time}
    >>> rig = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "integrator": {"kind": "quasi_static"}}
    >>> rig["rig"] = {}  # a shaft of 426 mm with a disc, see ``raceway dev schema``
    >>> bearing = rw.identify(orbit, rig)
    >>> round(1e-6 * bearing.equivalent_stiffness)  # K [N/um]
    84
    """
    registry = registry_with(plugins)
    read = as_scene(scene, plugins=plugins)
    rig = rig_of(read)
    refuse_no_load(read)
    folder = None if out is None else writable(Path(out))
    with telling(progress) as report:
        report("reading signals", 0, 3)
        run_out_known = stated_run_out(slow_roll, run_out, columns)
        record = signals_of(signals, columns)
        recording = recording_of(record)
        report("bearing at rest", 1, 3)
        tested = bearing(read, read.load.axial, registry)
        report("identifying", 2, 3)
        with faults_at(record.source):
            answer = identify_recording(recording, rig, tested, run_out_known)
    answer = attrs.evolve(answer, title=read.title, source=record.source)
    if folder is not None:
        answer.save(folder)
    return answer


def coefficients_of_state(state: State) -> np.ndarray:
    """K [N/m] and C [N s/m] with the rig's tilt, then with the tilt locked (4,)."""
    return np.array([state.stiffness, state.damping, *state.locked])


def standard_errors(shaft: Rotor, state: State, error: float) -> np.ndarray:
    """Standard errors of ``coefficients_of_state`` (4,) for one of the deflection at the sensor [m], real and imaginary part together.

    Z is analytic in the deflection while moment over tilt stays; half of its variance lies along each direction.
    """
    step = 1e-4 * abs(state.sensor)
    more, less = (coefficients_of_state(with_tilt_of(shaft, state, state.sensor + sign * step)) for sign in (1.0, -1.0))
    change = (more - less) / (2.0 * step)
    slopes = np.hypot(change[::2], state.speed * change[1::2])
    stiffness = slopes * error / np.sqrt(2.0)
    return np.array([stiffness[0], stiffness[0] / state.speed, stiffness[1], stiffness[1] / state.speed])


def _largest_change(state: State, neighbours: Iterable[State]) -> np.ndarray:
    """Largest change of ``coefficients_of_state`` (4,) among changed states."""
    return np.max([np.abs(coefficients_of_state(near) - coefficients_of_state(state)) for near in neighbours], axis=0)


def identify_recording(
    recording: Recording, rig: Rig, tested: Bearing, run_out: RunOut | Synchronous | None = None
) -> Identified:
    """K and C from a record.

    tested : the scene's bearing under the record's axial load
    run_out : the run-out, or the 1x component of a slow roll that shows it

    RacewayError: A record that cannot be used.
    ConvergenceError: Signals that no bearing of the scene's kind gives.
    """
    rotation = rotation_of(recording)
    component = synchronous(rotation)
    response = response_of(component, rig, tested, run_out)
    shaft = rotor(rig, component.speed)
    try:
        state = invert(shaft, tested, response.deflection)
    except ConvergenceError as why:
        raise ConvergenceError(
            f"no bearing like the scene's moves the sensor by {1e6 * abs(response.deflection):.4g} µm at {component.speed * 30 / pi:.0f} r/min "
            f"({why}). Check unbalance, sensor position and run-out"
        ) from None
    with_run_out = component.forward * exp(-1j * radians(rig.unbalance_angle_deg))
    deflection = tested.answer(state.speed, state.force, state.moment)[0]
    scene_stiffness = float((state.force / deflection).real + state.mass * state.speed**2)
    # The tilt stiffness is the scene's, no sensor sees it: how far the scene misses K is all that is known of how far it misses that,
    # which goes with the axial stiffness and follows the contact angle more.
    stiffer = 1.0 + _TILT * abs(scene_stiffness / state.stiffness - 1.0)
    angles = (-component.angle_error, component.angle_error)
    parts = {
        "spread": COVERAGE * standard_errors(shaft, state, component.error),
        "slow roll": COVERAGE * standard_errors(shaft, state, response.run_out.error),
        "marks": _largest_change(
            state, [with_tilt_of(shaft, state, state.sensor + with_run_out * (exp(1j * turn) - 1.0)) for turn in angles]
        ),
        "window": _largest_change(state, [with_tilt_of(shaft, state, response.fourier)]),
        "tilt": _largest_change(state, [with_tilt_of(shaft, state, state.sensor, k) for k in (1.0 / stiffer, stiffer)]),
    }
    states = {word: with_tilt_of(other, state, state.sensor) for word, other in changed_rotors(rig, component.speed).items()}
    states["tilt stiffness of the bearing +10 %"] = with_tilt_of(shaft, state, state.sensor, 1.1)
    more = attrs.evolve(shaft, unbalance_force=1.01 * shaft.unbalance_force)
    states["unbalance +1 %"] = with_tilt_of(more, state, state.sensor)
    states["sensor's scale +1 %"] = with_tilt_of(shaft, state, 1.01 * state.sensor)
    base = with_tilt_of(shaft, state, state.sensor).stiffness
    changes: list[dict[str, float | str]] = [{"change": k, "stiffness": v.stiffness / base - 1.0} for k, v in states.items()]
    return Identified(rotation, component, response.run_out, state, scene_stiffness, parts, changes)
