"""The map of a bearing: quantities of ``raceway.function`` over keys of its scene, as Chebyshev series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import attrs
import numpy as np

from raceway.core.ring.ring import COORDINATES
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import default_registry
from raceway.out.quantities import KNOWN, STIFFNESS, C, K, entry_unit, plugin_quantities
from raceway.points.derivatives import Columns
from raceway.points.function import Function, PointStatus, function
from raceway.scene.changes import continuous_keys, key_of, with_numbers
from raceway.scene.scene import Scene
from raceway.studies.fmu.chebyshev import Interval, Series, fit
from raceway.studies.fmu.unit import Unit, Variable, c_array

_SPEED = "excitation.speed_rpm"
#: Ranges of keys over their values, where nothing is said.
_RANGES = {
    "load.axial": (0.5, 2.0),
    "excitation.force": (0.5, 1.5),
    "excitation.unbalance": (0.5, 1.5),
    _SPEED: (0.25, 1.25),
    "kinematics.spin_speed_rpm": (0.25, 1.25),
}
#: Points of one fit.
_MOST_POINTS = 20_000
#: The stated error over the largest difference at control points.
_SAFETY = 2.0
#: Loss factor w C / K below which an error of C is taken of what C would be there.
_LOSS = 1e-3
#: Entries of the stiffness below this part of the mean of their diagonal entries are rounding; a quantity below this part of its largest
#: value has errors relative to that.
_ROUNDING, _SMALL = 1e-9, 1e-3


def default_ranges(scene: Scene) -> dict[str, tuple[float, float]]:
    """Ranges of loads and speed about the scene's."""
    keys = {key.path: key.value for key in continuous_keys(scene)}
    if _SPEED in keys:
        keys.pop("kinematics.spin_speed_rpm", None)
    return {
        path: (low * keys[path], high * keys[path]) for path, (low, high) in _RANGES.items() if keys.get(path, 0.0) > 0.0
    }


@attrs.frozen(eq=False)
class Map:
    """Quantities over keys.

    Attributes
    ----------
    scene : at the middle;  keys : of the inputs
    outputs : name -> unit and words;  series : of them, in this order
    """

    scene: Scene
    keys: tuple[str, ...]
    outputs: dict[str, tuple[str, str]]
    series: Series

    @property
    def stated(self) -> np.ndarray:
        """(m,) relative error that is stated: twice the largest difference at points that no fit used."""
        return np.asarray(_SAFETY * self.series.error)

    def unit(self, name: str) -> Unit:
        """The FMU."""
        inputs, axes = [key_of(self.scene, key) for key in self.keys], self.series.axes
        errors = dict(zip(self.outputs, self.stated.tolist(), strict=True))
        ranges = [f"{key.path} {axis.low:g} to {axis.high:g} {key.unit}" for key, axis in zip(inputs, axes, strict=True)]
        terms = self.series.terms
        numbers = [
            f"#define TERMS {terms[0].size}",
            f"#define MOST {max(terms.shape[1:])}",
            f"static const int degrees[INPUTS] = {{{', '.join(map(str, terms.shape[1:]))}}};",
            f"static const int logarithmic[INPUTS] = {{{', '.join(str(int(axis.logarithmic)) for axis in axes)}}};",
            c_array("low", np.array([axis.low for axis in axes])),
            c_array("high", np.array([axis.high for axis in axes])),
            c_array("terms", terms.reshape(len(terms), -1)),
        ]
        return Unit(
            name,
            f"{self.scene.title.splitlines()[0]}: map over {', '.join(ranges)}; relative error at most {max(errors.values()):.1e}.",
            "map.c",
            "\n".join(numbers),
            f"an input is out of range: its end stands for it ({'; '.join(ranges)})",
            tuple(
                Variable(key.path, key.unit, key.help, key.value, axis.low, axis.high)
                for key, axis in zip(inputs, axes, strict=True)
            ),
            tuple(
                Variable(
                    output, unit, f"{words}; error at most {_SAFETY * difference:.1e} {unit}, relative {errors[output]:.1e}"
                )
                for (output, (unit, words)), difference in zip(self.outputs.items(), self.series.difference, strict=True)
            ),
            tuple(
                Variable(f"relative_error.{output}", "1", "twice the largest at points that the fit did not use", error)
                for output, error in errors.items()
            ),
        )


def fit_map(scene: Scene, ranges: Mapping[str, tuple[float, float]], names: Sequence[str], tolerance: float) -> Map:
    """The map of a scene.

    Parameters
    ----------
    ranges : key -> low, high;  names : outputs of ``raceway.function``, numbers or "stiffness", or their symbols
    tolerance : relative error that terms are added for

    Raises
    ------
    SceneError
        A key or an output that the function does not have.
    RacewayError
        A point within the ranges that has no answer.
    """
    middle = {key: min(max(key_of(scene, key).value, low), high) for key, (low, high) in ranges.items()}
    asked = function(scene, ranges, names)
    f = function(scene, ranges, dict.fromkeys([*asked.outputs, *([K.name] if C.name in asked.outputs else [])]))
    corners = [column.ravel() for column in np.meshgrid(*(np.linspace(*ends, 3) for ends in ranges.values()))]
    outputs = _outputs(asked.outputs, _answer(f, corners))

    def quantities(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        answer = _answer(f, columns)
        values = np.stack([_value(answer, name) for name in outputs])
        return values, np.stack([_size(scene, dict(zip(ranges, columns, strict=True)), answer, name) for name in outputs])

    series = fit(quantities, [Interval(*ends) for ends in ranges.values()], tolerance, _MOST_POINTS)
    return Map(with_numbers(scene, middle), tuple(ranges), outputs, series)


def _answer(f: Function, columns: list[np.ndarray]) -> Columns:
    """Of the function; a point without answer is refused."""
    answer = f.columns(dict(zip(f.inputs, columns, strict=True)))
    lost = np.flatnonzero(answer["status"] > PointStatus.RUN)
    if lost.size:
        point = ", ".join(f"{key} = {column[lost[0]]:g}" for key, column in zip(f.inputs, columns, strict=True))
        raise RacewayError(f"the map has no answer at {point}: {answer['reason'][lost[0]]}. Narrow its ranges with --range.")
    return answer


def _outputs(names: Sequence[str], answer: Columns) -> dict[str, tuple[str, str]]:
    """Names of the map's outputs -> unit and words: numbers, and entries of the stiffness that are not rounding."""
    known = KNOWN | {name: quantity for name, (_, quantity) in plugin_quantities(default_registry()).items()}
    outputs = {}
    for name in names:
        if name == STIFFNESS.name:
            mean = _diagonal_mean(answer)
            for i, j in zip(*np.nonzero(np.max(np.abs(answer[name]) / mean, axis=0) > _ROUNDING), strict=True):
                entry = COORDINATES[i], COORDINATES[j]
                outputs[f"{name}.{'.'.join(entry)}"] = (entry_unit(STIFFNESS.unit, entry), STIFFNESS.words)
        elif answer[name].ndim > 1:
            raise SceneError.at("outputs", name, "is an array: a map has numbers, or stiffness")
        else:
            outputs[name] = (known[name].unit, known[name].words) if name in known else ("1", name)
    return outputs


def _value(answer: Columns, output: str) -> np.ndarray:
    name, _, entry = output.partition(".")
    if not entry:
        return answer[name]
    row, column = map(COORDINATES.index, entry.split("."))
    return np.asarray(answer[name][:, row, column])


def _size(scene: Scene, inputs: Columns, answer: Columns, output: str) -> np.ndarray:
    """What an error of an output is divided by: its own size where that has any."""
    value = np.abs(_value(answer, output))
    if output == C.name:
        rpm = inputs.get(_SPEED, scene.excitation.speed_rpm if scene.excitation else 0.0)
        return np.maximum(value, _LOSS * np.abs(answer[K.name]) / (np.pi / 30.0 * np.asarray(rpm)))
    if output.startswith(f"{STIFFNESS.name}."):
        value = np.maximum(value, _SMALL * _value({STIFFNESS.name: _diagonal_mean(answer)}, output))
    return np.maximum(value, _SMALL * value.max() or 1.0)


def _diagonal_mean(answer: Columns) -> np.ndarray:
    """(n, 5, 5) geometric means of the diagonal entries of a row and a column."""
    diagonal = np.sqrt(np.abs(np.einsum("nii->ni", answer[STIFFNESS.name])))
    return diagonal[:, :, np.newaxis] * diagonal[:, np.newaxis, :]
