"""The map of a bearing: quantities of ``raceway.function`` over keys of its scene, as Chebyshev series."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product

import attrs
import numpy as np

from raceway import Function, PointStatus, RacewayError, Scene, SceneError, function
from raceway.extend import (
    DIMENSIONS, KNOWN, STIFFNESS, C, K, continuous_keys, default_registry, entry_unit, key_of, plugin_quantities,
)  # fmt: skip
from raceway_fmu.chebyshev import Interval, fit
from raceway_fmu.unit import Unit, Variable

_DOF, _SPEED = DIMENSIONS["dof"], "excitation.speed_rpm"
#: Ranges of keys over their values, where nothing is said.
_RANGES = {
    "load.axial": (0.5, 2.0),
    "excitation.force": (0.5, 1.5),
    "excitation.unbalance": (0.5, 1.5),
    _SPEED: (0.25, 1.25),
    "kinematics.spin_speed_rpm": (0.25, 1.25),
}
#: Points of one fit;  of a map at least, for its error.
_MOST_POINTS, _LEAST_POINTS = 20_000, 1024
#: Share of points, or two, that may need a run of their own.
_IRREGULAR = 0.02
_NARROW = "Narrow its ranges with --range."
#: The stated error over the largest difference at control points.
_SAFETY = 2.0
#: Largest relative error that is stated: beyond it a value is hardly more than its error.
_RESOLVED = 0.01
_STATED = "twice the largest at points that the fit did not use"
#: Loss factor w C / K below which the tolerance of C is taken of what C would be there.
_LOSS = 1e-3
#: Entries of the stiffness below this part of the mean of their diagonal entries are rounding;  the tolerance of a quantity below this part
#: of its largest value is taken of that.
_ROUNDING, _SMALL = 1e-9, 1e-3


def default_ranges(scene: Scene) -> dict[str, tuple[float, float]]:
    """Ranges of loads and speed about the scene's."""
    keys = {key.path: key.value for key in continuous_keys(scene)}
    if _SPEED in keys:
        keys.pop("kinematics.spin_speed_rpm", None)
    positive = [path for path in _RANGES if keys.get(path, 0.0) > 0.0]
    return {path: (_RANGES[path][0] * keys[path], _RANGES[path][1] * keys[path]) for path in positive}


def map_unit(
    scene: Scene, name: str, ranges: Mapping[str, tuple[float, float]], outputs_wanted: Sequence[str], tolerance: float
) -> Unit:
    """The FMU of a scene's map.

    Parameters
    ----------
    ranges : key -> low, high;  outputs_wanted : outputs of ``raceway.function``, numbers or "stiffness", by names or symbols
    tolerance : relative error that terms are added for

    Raises
    ------
    SceneError
        A key or an output that the function does not have.
    RacewayError
        A point within the ranges that has no answer, or runs for longer than two minutes.
    """
    names = function(scene, ranges, outputs_wanted).outputs
    f = function(scene, ranges, dict.fromkeys([*names, *([K.name] if C.name in names else [])]))
    if f.why_slow:
        f.refuse_time(_LEAST_POINTS, "a map needs at least these. `raceway sweep` computes a table of fewer")
    corners = [column.ravel() for column in np.meshgrid(*(np.linspace(*ends, 3) for ends in ranges.values()))]
    scales = _samples(f, names, corners).items()
    outputs = [
        _variable(name) for name, (value, scale) in scales if name in names or np.any(np.abs(value) > _ROUNDING * scale)
    ]

    def quantities(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        found = _samples(f, names, columns)
        values, sizes = (np.stack([found[output.name][k] for output in outputs]) for k in range(2))
        return values, np.maximum(np.abs(values), _SMALL * sizes)

    series = fit(quantities, [Interval(*ends) for ends in ranges.values()], tolerance, _MOST_POINTS)
    terms, axes, low, high = series.terms, series.axes, *np.array(list(ranges.values())).T
    keys = [key_of(scene, path) for path in ranges]
    words = "; ".join(f"{key.path} {a:g} to {b:g} {key.unit}" for key, a, b in zip(keys, low, high, strict=True))
    relative, difference, excess = (_SAFETY * x for x in (series.relative, series.difference, series.error))
    bounds = list(zip(outputs, difference, relative, strict=True))
    largest, of = max(((r, v.name) for v, _, r in bounds if r < _RESOLVED), default=(0.0, ""))
    error_words = f"relative error at most {largest:.1e} ({of})" if of else "errors are those of each output"
    if excess.max() > tolerance:
        error_words += f", above the tolerance {tolerance:g}. {_NARROW[:-1]}"
    return Unit(
        name,
        f"map over {words}; {error_words}.",
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
            attrs.evolve(
                v, words=f"{v.words}; error at most {d:.1e} {v.unit}{f', relative {r:.1e}' if r < _RESOLVED else ''}"
            )
            for v, d, r in bounds
        ),
        tuple(
            Variable(f"relative_error.{v.name}", "1", _STATED, float(r))
            if r < _RESOLVED
            else Variable(f"error.{v.name}", v.unit, _STATED, float(d))
            for v, d, r in bounds
        ),
    )


def _variable(name: str) -> Variable:
    """Of a quantity, or of the entry of one."""
    name_of, *entry = name.split(".")
    quantity = (KNOWN | {n: q for n, (_, q) in plugin_quantities(default_registry()).items()}).get(name_of)
    return Variable(name, entry_unit(quantity.unit, entry), quantity.words) if quantity else Variable(name, "1", name)


def _samples(f: Function, names: Iterable[str], columns: list[np.ndarray]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Values (n,) of numbers and of entries of the stiffness, by their names, and their scales (n,).

    A scale is the largest value; of an entry of the stiffness the geometric mean of its diagonal entries; of C that of a loss factor.
    """
    inputs = dict(zip(f.inputs, columns, strict=True))
    answer = f.columns(inputs)

    def point(row: int) -> str:
        return ", ".join(f"{key} = {column[row]:g}" for key, column in inputs.items())

    failures = np.flatnonzero(answer["status"] > PointStatus.RUN)
    if failures.size:
        raise RacewayError(f"the map has no answer at {point(failures[0])}: {answer['reason'][failures[0]]}. {_NARROW}")
    irregular = np.flatnonzero(answer["status"] == PointStatus.RUN)
    if not f.why_slow and irregular.size > max(2.0, _IRREGULAR * len(answer["status"])):
        raise RacewayError(
            f"at {irregular.size} of {len(answer['status'])} points the compiled loop finds no regular solution, first at "
            f"{point(irregular[0])}: several motions exist there, over which no map is smooth. {_NARROW}"
        )
    columns_found = {}
    for name in names:
        value = answer[name]
        if name == STIFFNESS.name:
            diagonal = np.sqrt(np.abs(np.einsum("nii->in", value)))
            for i, j in product(range(5), repeat=2):
                columns_found[f"{name}.{_DOF[i]}.{_DOF[j]}"] = value[:, i, j], diagonal[i] * diagonal[j]
        elif value.ndim > 1:
            raise SceneError.at("outputs", name, "is an array: a map has numbers, or stiffness")
        else:
            columns_found[name] = value, np.full_like(value, np.abs(value).max() or 1.0)
    if C.name in columns_found:
        rpm = inputs.get(_SPEED, f.scene.excitation.speed_rpm if f.scene.excitation else 0.0)
        columns_found[C.name] = answer[C.name], _LOSS / _SMALL * np.abs(answer[K.name]) / (np.pi / 30.0 * np.asarray(rpm))
    return columns_found
