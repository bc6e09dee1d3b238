"""K and C of a bearing that were identified in measured signals: numbers, screen, files, picture."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np
from raceway_rotor.shaft import State

from raceway import Answer, SceneError, door
from raceway.extend import Fact, Part, Tables, Words, given_axes, labelled_dataset, number, sections, without_nan
from raceway_measure.fit.fitted import interval
from raceway_measure.fit.shaft_angle import Rotation
from raceway_measure.fit.synchronous import RunOut, Synchronous

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

#: Deflection of the bearing below this part of that at the sensor is a small difference of large numbers.
_SMALL = 0.1
#: Part by which the tilt stiffness may be off, over that by which the scene misses K.
TILT = 2.0
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
            model = f"under the same force and moment the scene's bearing has a K of {1e-6 * self.scene_stiffness:.4g} N/µm"
            out.append(f"{model}: check bearing and arrangement of the rig; their tilt stiffness enters the result")
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
        definition = f"Re Z + m w^2, m = {state.mass:.4g} kg"
        facts = [interval("K", self.equivalent_stiffness, self.uncertainty[0], "N/m", definition)]
        if c is not None and wide is not None:
            value = number(c, "N s/m", 4) if abs(c) > wide else "not resolved"
            facts.append(("C", value, f"+- {number(wide, 'N s/m', 2)} at 95 %"))
        locked_tilt = interval("K, tilt locked", state.locked[0], self.uncertainty[2], "N/m", "less the force of the tilt")
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
