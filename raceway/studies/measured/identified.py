"""The answer of ``raceway.identify``: K and C with their uncertainty, as an object."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.commands.notebook import few_lines, html_table
from raceway.errors import RacewayError, SceneError, extra
from raceway.plugins.reports.pictures import given_axes
from raceway.storage.tables import Tables
from raceway.studies.measured.identify import Found

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

_PLOTS = ("orbits", "spectrum")


@attrs.frozen(eq=False, repr=False, slots=False)
class Identified:
    """A bearing's dynamic stiffness as identified from signals, at their speed, the tilt as in the rig.

    Attributes
    ----------
    found : lines, run-out and state in detail;  title : of the scene;  source : file of the signals, or "signals"
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
        try:
            import xarray
        except ImportError as why:
            raise RacewayError(f"labelled results need xarray: {extra('sweep')} ({why})") from None
        record = self.found.turning.recording
        given = {"y": (record.y, "m"), "z": (record.z, "m"), "key": (record.key, ""), "speed": (record.speed, "rad/s")}
        variables = {
            name: ("time", np.asarray(values), {"units": unit} if unit else {})
            for name, (values, unit) in given.items()
            if values is not None
        }
        return xarray.Dataset(variables, {"time": ("time", record.time, {"units": "s"})}, {"title": self.title})

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
        from raceway.studies.measured.figures import draw_orbits, draw_spectrum

        if what not in _PLOTS:
            raise SceneError.at("what", what, f"must be one of {', '.join(_PLOTS)}")
        axes = given_axes(ax, 6.0, 6.0 if what == "orbits" else 3.5)
        (draw_orbits if what == "orbits" else draw_spectrum)(self.found, axes)
        if what == "orbits":
            axes.legend(frameon=False, fontsize=8)
        return axes

    def _rows(self) -> list[dict[str, str]]:
        """Quantity, value, half-width at 95 % and unit."""
        k, c = self._numbers, self.equivalent_damping
        rows = [
            {"quantity": "K", "value": f"{1e-6 * k['equivalent_stiffness']:.5g}", "+- at 95 %": f"{1e-6 * k['equivalent_stiffness_error']:.2g}", "unit": "N/µm"},
        ]  # fmt: skip
        if c is not None:
            wide = k["equivalent_damping_error"]
            rows.append(
                {"quantity": "C", "value": f"{c:.4g}" if abs(c) > wide else "not resolved", "+- at 95 %": f"{wide:.2g}", "unit": "N s/m"}
            )  # fmt: skip
        locked = k["tilt_locked"]
        rows.append(
            {
                "quantity": "K, tilt locked",
                "value": f"{1e-6 * locked['equivalent_stiffness']:.5g}",
                "+- at 95 %": f"{1e-6 * locked['equivalent_stiffness_error']:.2g}",
                "unit": "N/µm",
            }
        )
        return rows

    def __repr__(self) -> str:
        rows = [f"{row['quantity']} {row['value']} +- {row['+- at 95 %']} {row['unit']}" for row in self._rows()]
        return few_lines(f"Identified from {self.source} at {self.speed_rpm:.1f} r/min", [self.title, *rows, *self.warnings])

    def _repr_html_(self) -> str:
        return html_table(f"{self.title}: {self.source} at {self.speed_rpm:.1f} r/min", self._rows(), self.warnings)
