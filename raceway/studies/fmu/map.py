"""The map of a bearing: quantities of ``raceway.function`` over keys of its scene, as Chebyshev series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import attrs
import numpy as np

from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import default_registry
from raceway.out.quantities import KNOWN, STIFFNESS, C, K, entry_unit, plugin_quantities
from raceway.points.chebyshev import Interval, fit
from raceway.points.column_quantities import DIMENSIONS
from raceway.points.derivatives import Columns
from raceway.points.function import Function, PointStatus, function
from raceway.scene.changes import continuous_keys, key_of
from raceway.scene.scene import Scene
from raceway.studies.fmu.unit import Unit, Variable

_DOF, _SPEED = DIMENSIONS["dof"], "excitation.speed_rpm"
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
    positive = [path for path in _RANGES if keys.get(path, 0.0) > 0.0]
    return {path: (_RANGES[path][0] * keys[path], _RANGES[path][1] * keys[path]) for path in positive}


def map_unit(
    scene: Scene, name: str, ranges: Mapping[str, tuple[float, float]], asked: Sequence[str], tolerance: float
) -> Unit:
    """The FMU of a scene's map.

    Parameters
    ----------
    ranges : key -> low, high;  asked : outputs of ``raceway.function``, numbers or "stiffness", by names or symbols
    tolerance : relative error that terms are added for

    Raises
    ------
    SceneError
        A key or an output that the function does not have.
    RacewayError
        A point within the ranges that has no answer.
    """
    names = function(scene, ranges, asked).outputs
    f = function(scene, ranges, dict.fromkeys([*names, *([K.name] if C.name in names else [])]))
    corners = [column.ravel() for column in np.meshgrid(*(np.linspace(*ends, 3) for ends in ranges.values()))]
    outputs = _outputs(names, _answer(f, corners))

    def quantities(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        answer, inputs = _answer(f, columns), dict(zip(ranges, columns, strict=True))
        values = np.stack([_value(answer, output.name) for output in outputs])
        return values, np.stack([_size(scene, inputs, answer, output.name) for output in outputs])

    series = fit(quantities, [Interval(*ends) for ends in ranges.values()], tolerance, _MOST_POINTS)
    terms, axes, low, high = series.terms, series.axes, *np.array(list(ranges.values())).T
    keys = [key_of(scene, path) for path in ranges]
    words = "; ".join(f"{key.path} {a:g} to {b:g} {key.unit}" for key, a, b in zip(keys, low, high, strict=True))
    errors, differences = _SAFETY * series.error, _SAFETY * series.difference
    return Unit(
        name,
        f"map over {words}; relative error at most {errors.max():.1e}.",
        "map.c",
        {
            "TERMS": terms[0].size,
            "MOST": max(terms.shape[1:]),
            "degrees": np.array(terms.shape[1:]),
            "logarithmic": np.array([int(axis.logarithmic) for axis in axes]),
            "low": low,
            "high": high,
            "terms": terms.reshape(len(terms), -1),
        },
        f"an input is out of range: its end stands for it ({words})",
        tuple(
            Variable(key.path, key.unit, key.help, float(np.clip(key.value, *ranges[key.path])), *ranges[key.path])
            for key in keys
        ),
        tuple(
            attrs.evolve(v, words=f"{v.words}; error at most {difference:.1e} {v.unit}, relative {error:.1e}")
            for v, error, difference in zip(outputs, errors, differences, strict=True)
        ),
        tuple(
            Variable(f"relative_error.{v.name}", "1", "twice the largest at points that the fit did not use", float(error))
            for v, error in zip(outputs, errors, strict=True)
        ),
    )


def _answer(f: Function, columns: list[np.ndarray]) -> Columns:
    """Of the function; a point without answer is refused."""
    answer = f.columns(dict(zip(f.inputs, columns, strict=True)))
    lost = np.flatnonzero(answer["status"] > PointStatus.RUN)
    if lost.size:
        point = ", ".join(f"{key} = {column[lost[0]]:g}" for key, column in zip(f.inputs, columns, strict=True))
        raise RacewayError(f"the map has no answer at {point}: {answer['reason'][lost[0]]}. Narrow its ranges with --range.")
    return answer


def _outputs(names: Sequence[str], answer: Columns) -> list[Variable]:
    """Variables of the map: numbers, and entries of the stiffness that are not rounding."""
    known = KNOWN | {name: quantity for name, (_, quantity) in plugin_quantities(default_registry()).items()}
    outputs = []
    for name in names:
        if name == STIFFNESS.name:
            present = np.max(np.abs(answer[name]) / _diagonal_mean(answer), axis=0) > _ROUNDING
            for row, column in zip(*np.nonzero(present), strict=True):
                entry = _DOF[row], _DOF[column]
                outputs.append(Variable(f"{name}.{'.'.join(entry)}", entry_unit(STIFFNESS.unit, entry), STIFFNESS.words))
        elif answer[name].ndim > 1:
            raise SceneError.at("outputs", name, "is an array: a map has numbers, or stiffness")
        else:
            outputs.append(
                Variable(name, known[name].unit, known[name].words) if name in known else Variable(name, "1", name)
            )
    return outputs


def _value(answer: Columns, output: str) -> np.ndarray:
    name, _, entry = output.partition(".")
    if not entry:
        return answer[name]
    row, column = map(_DOF.index, entry.split("."))
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
