"""K and C of a bearing in a rig from measured signals, for Python and the command line alike: ``raceway.identify``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.commands.progress import ShowProgress, telling
from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import registry_with
from raceway.framework.shown import Fact, Shown, number, number_within
from raceway.pipeline.result import write_json
from raceway.plugins.labelled import labelled_dataset
from raceway.plugins.pictures import given_axes
from raceway.scene.given import as_scene
from raceway.scene.reading import rig_of
from raceway.storage.files import writable
from raceway.storage.tables import Tables
from raceway.studies.fit.identification import Found, from_signals, refuse_no_load
from raceway.studies.fit.signals import signals_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

_PLOTS = ("orbits", "spectrum")


@attrs.frozen(eq=False, repr=False, slots=False)
class Identified(Shown):
    """A bearing's dynamic stiffness as identified from signals, at their speed, the tilt as in the rig.

    Attributes
    ----------
    found : lines, run-out and state in detail;  title : of the scene;  source : file of the signals, or "signals"

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> orbit = {"time_s": time, "y_um": 15.0 * np.cos(angle), "z_um": 15.0 * np.sin(angle), "speed_rpm": 12000.0 + 0.0 * time}
    >>> rig = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000}, "rig": {}, "integrator": {"kind": "quasi_static"}}
    >>> found = rw.identify(orbit, rig)
    >>> round(found.speed_rpm), round(1e-6 * found.equivalent_stiffness)  # [r/min], K [N/um]
    (12000, 84)
    """

    found: Found
    title: str
    source: str

    @cached_property
    def _numbers(self) -> Tables:
        return self.found.to_dict()["identification"]

    @property
    def speed_rpm(self) -> float:
        """Mean speed of the record [r/min]."""
        return float(self._numbers["speed_rpm"])

    @property
    def dynamic_stiffness(self) -> complex | None:
        """Z, complex [N/m]; None without a mark, which gives its size alone."""
        z = self._numbers["dynamic_stiffness"]
        return None if z["imag"] is None else complex(z["real"], z["imag"])

    @property
    def equivalent_stiffness(self) -> float:
        """K = Re Z + m w^2 [N/m]."""
        return float(self._numbers["equivalent_stiffness"])

    @property
    def equivalent_stiffness_error(self) -> float:
        """Half-width of K at 95 % [N/m]."""
        return float(self._numbers["equivalent_stiffness_error"])

    @property
    def equivalent_damping(self) -> float | None:
        """C = Im Z / w [N s/m]; None without a mark."""
        value = self._numbers["equivalent_damping"]
        return None if value is None else float(value)

    @property
    def equivalent_damping_error(self) -> float | None:
        """Half-width of C at 95 % [N s/m]; None without a mark."""
        value = self._numbers["equivalent_damping_error"]
        return None if value is None else float(value)

    @property
    def warnings(self) -> list[str]:
        """What a reader of K should know."""
        return self.found.warnings()

    def to_dict(self) -> Tables:
        """Everything but the samples, as in identify.json."""
        return {"title": self.title, "file": self.source, **self.found.to_dict()}

    def to_xarray(self) -> Dataset:
        """The whole turns of the record that were used: y, z [m], angle [rad], speed [rad/s], key over time [s].

        ``raceway.identify`` takes it as signals.

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        record = self.found.turning.recording
        given = {"y": (record.y, "m"), "z": (record.z, "m"), "key": (record.key, ""), "speed": (record.speed, "rad/s")}
        variables = {
            name: ("time", np.asarray(values), {"units": unit} if unit else {})
            for name, (values, unit) in given.items()
            if values is not None
        }
        return labelled_dataset(variables, {"time": ("time", record.time, {"units": "s"})}, {"title": self.title})

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
        from raceway.studies.fit.picture import draw_orbits, draw_spectrum

        if what not in _PLOTS:
            raise SceneError.at("what", what, f"must be one of {', '.join(_PLOTS)}")
        axes = given_axes(ax, 6.0, 6.0 if what == "orbits" else 3.5)
        (draw_orbits if what == "orbits" else draw_spectrum)(self.found, axes)
        if what == "orbits":
            axes.legend(frameon=False, fontsize=8)
        return axes

    def _shown(self) -> tuple[str, list[Fact]]:
        k, c, locked = self._numbers, self.equivalent_damping, self._numbers["tilt_locked"]
        facts = [_within("K", k["equivalent_stiffness"], k["equivalent_stiffness_error"], "tilt as in the rig")]
        if c is not None:
            wide = k["equivalent_damping_error"]
            value = number(c, "N s/m", 4) if abs(c) > wide else "not resolved"
            facts.append(("C", value, f"+- {number(wide, 'N s/m', 2)} at 95 %"))
        facts.append(_within("K, tilt locked", locked["equivalent_stiffness"], locked["equivalent_stiffness_error"], ""))
        facts.append(("K of the scene", number(1e-6 * k["scene_stiffness"], "N/µm"), "under the same force and moment"))
        title = f"Identified from {self.source} at {self.speed_rpm:.1f} r/min\n{self.title.splitlines()[0]}"
        return title, [*facts, *(("warning", "", text) for text in self.warnings)]


def _within(name: str, value: float, error: float, remark: str) -> Fact:
    """A stiffness [N/m] with its half-width at 95 %."""
    words = f"+- {number(1e-6 * error, 'N/µm', 2)} at 95 %"
    return name, number_within(1e-6 * value, 1e-6 * error, "N/µm"), f"{words}; {remark}" if remark else words


#: The answer, in the folder of the results.
CONTENT = "identify.json"


@door
def identify(
    signals: Any,
    scene: Any,
    *,
    slow_roll: Any = None,
    run_out: tuple[float, float] | None = None,
    columns: Mapping[str, str] | None = None,
    out: str | Path | None = None,
    plugins: Iterable[str | Path] = (),
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
    columns : head of a column -> name, ``{"X [um]": "y_um"}``; "ignore" leaves it out
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
        What is wrong with the signals or the scene.  Records of one axis, and of force and displacement, are read, and refused
        with what they hold and what is missing.
    ConvergenceError
        Signals that no bearing of the scene's kind gives.

    Examples
    --------
    >>> import numpy as np, raceway as rw
    >>> angle = 2.0 * np.pi * 200.0 * (time := np.arange(0.0, 0.1, 5e-5))
    >>> signals = {
    ...     "time_s": time,
    ...     "y_um": 15.0 * np.cos(angle),
    ...     "z_um": 15.0 * np.sin(angle),
    ...     "speed_rpm": 12000.0 + 0.0 * time,
    ... }
    >>> rig = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "rig": {},  # a shaft of 426 mm with a disc, see ``raceway schema``
    ...     "integrator": {"kind": "quasi_static"},
    ... }
    >>> found = rw.identify(signals, rig)
    >>> round(1e-6 * found.equivalent_stiffness)  # K [N/um]
    84
    """
    if run_out is not None and slow_roll is not None:
        raise SceneError.at("run_out", run_out, "the slow roll tells it already: leave one of them out")
    registry = registry_with(plugins)
    read = as_scene(scene, plugins=plugins)
    rig = rig_of(read)
    refuse_no_load(read)
    folder = None if out is None else writable(Path(out))
    with telling(progress) as told:
        told("reading signals", 0, 3)
        record = signals_of(signals, columns)
        slow = None if slow_roll is None else signals_of(slow_roll, columns)
        found = from_signals(record, read, rig, registry, slow, run_out, told)
    made = Identified(found, read.title, record.source)
    if folder is not None:
        write_json(made.to_dict(), folder / CONTENT)
    return made
