"""The map of a bearing: quantities of ``raceway.function`` over keys of its scene, as Chebyshev series."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import product

import attrs
import numpy as np
from numpy.polynomial import chebyshev

from raceway import Function, PointStatus, RacewayError, Scene, SceneError, function
from raceway.extend import (
    DIMENSIONS, KNOWN, STIFFNESS, C, K, continuous_keys, default_registry, entry_unit, key_of, plugin_quantities,
)  # fmt: skip
from raceway_fmu.unit import Unit, Variable

#: Terms of an axis at first, by how much they grow, and the power of 2 of further control points.
_FIRST, _GROWTH, _SOBOL = 7, 1.5, 10
#: Shares of the tolerance: of the last two terms of an axis that grows no more, and of terms that are dropped.
_ENOUGH, _DROPPED = 0.2, 0.02

#: Values (m, n) of m quantities from the columns of d inputs (n,), and the sizes (m, n) that their errors are divided by.
Quantities = Callable[[list[np.ndarray]], tuple[np.ndarray, np.ndarray]]


@attrs.frozen
class Interval:
    """The range of an input, and whether its logarithm is what polynomials are of."""

    low: float
    high: float
    logarithmic: bool = False

    def at(self, place: np.ndarray) -> np.ndarray:
        """Inputs at places from -1 to 1."""
        share = 0.5 * (place + 1.0)
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** share).clip(self.low, self.high)
        return np.asarray(self.low + share * (self.high - self.low)).clip(self.low, self.high)


@attrs.frozen(eq=False)
class Series:
    """Quantities over a box: f(x_1 ... x_d) = sum of c_ij.. T_i(t_1) T_j(t_2) ..., each t the input, or its logarithm, on -1 ... 1.

    Coefficients interpolate at the roots of T_n of each axis.  Control points, which no fit uses, are the n + 1 extremes of T_n, ends
    and corners included, between which the roots lie and where errors of interpolation are largest, and a Sobol sequence in the box.

    Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3, 4 and 8.
    """

    axes: tuple[Interval, ...]  # of the inputs
    terms: np.ndarray  # (m, n_1, ..., n_d) coefficients
    size: np.ndarray  # (m,) least size of the quantities at the nodes
    #: error, relative, difference : (m,) largest difference at control points over the size of the quantity, over its value
    #: (or 1e-200 if that changes its sign), and in its unit
    error: np.ndarray = attrs.field(factory=lambda: np.zeros(0))
    relative: np.ndarray = attrs.field(factory=lambda: np.zeros(0))
    difference: np.ndarray = attrs.field(factory=lambda: np.zeros(0))

    def share(self, axis: int) -> np.ndarray:
        """(n,) largest sum of the terms of one degree of an axis over the least size of the quantity."""
        others = tuple(k for k in range(1, self.terms.ndim) if k != axis + 1)
        return np.asarray(np.max(np.abs(self.terms).sum(axis=others) / self.size[:, np.newaxis], axis=0))

    @property
    def tails(self) -> np.ndarray:
        """Of each axis the last two terms, relative."""
        return np.array([self.share(k)[-2:].sum() for k in range(len(self.axes))])

    def __call__(self, columns: Sequence[np.ndarray]) -> np.ndarray:
        """(m, n) at inputs within the box."""
        values = np.broadcast_to(self.terms[..., np.newaxis], (*self.terms.shape, len(columns[0])))
        for axis, column, count in reversed(list(zip(self.axes, columns, self.terms.shape[1:], strict=True))):
            first, last, now = (np.log(x) if axis.logarithmic else np.asarray(x) for x in (axis.low, axis.high, column))
            polynomials = chebyshev.chebvander((2.0 * now - first - last) / (last - first), count - 1)
            values = np.einsum("...kn,nk->...n", values, polynomials)
        return np.asarray(values)


def fit(function: Quantities, axes: Sequence[Interval], tolerance: float, most: int) -> Series:
    """Series with as many terms as the tolerance asks for, and logarithms of inputs where these need fewer.

    axes : ``logarithmic`` of one says nothing yet
    tolerance : of the error, relative;  most : points of one fit
    """
    counts, without_progress = [_FIRST] * len(axes), np.zeros(len(axes), dtype=bool)
    best = _interpolant(function, axes, counts)
    for k, axis in enumerate(axes):
        if axis.low > 0.0:
            with_logarithm = [*best.axes[:k], attrs.evolve(axis, logarithmic=True), *best.axes[k + 1 :]]
            trial = _interpolant(function, with_logarithm, counts)
            best = trial if trial.tails[k] < best.tails[k] else best
    while True:
        missing = np.where(without_progress | (best.tails < _ENOUGH * tolerance), 0.0, best.tails)
        k = int(np.argmax(missing))
        more = [math.ceil(_GROWTH * n) if j == k else n for j, n in enumerate(counts)]
        if not missing[k] or math.prod(more) > most:
            break
        trial = _interpolant(function, best.axes, more)
        without_progress[k] = trial.tails[k] > 0.5 * best.tails[k]
        if trial.tails[k] < best.tails[k]:
            counts, best = more, trial
    from scipy.stats import qmc

    extremes = _grid(best.axes, [np.cos(np.pi * np.arange(n + 1) / n) for n in counts])
    inside = qmc.Sobol(len(best.axes), rng=np.random.default_rng(0)).random_base2(_SOBOL).T
    columns = [np.concatenate([e, a.at(2.0 * u - 1.0)]) for e, a, u in zip(extremes, best.axes, inside, strict=True)]
    values, size = function(columns)
    for k in range(len(axes)):
        left = np.cumsum(best.share(k)[::-1])[::-1]
        terms = best.terms.take(range(max(2, int(np.sum(left > _DROPPED * tolerance)))), axis=k + 1)
        best = attrs.evolve(best, terms=terms)
    difference = np.abs(best(columns) - values)
    one_sign = np.abs(np.sign(values).sum(axis=1, keepdims=True)) == values.shape[1]
    relative = np.max(difference / np.where(one_sign, np.abs(values), 1e-200), axis=1)
    error, difference = np.max(difference / size, axis=1), np.max(difference, axis=1)
    return attrs.evolve(best, error=error, relative=relative, difference=difference)


def _interpolant(function: Quantities, axes: Sequence[Interval], counts: Sequence[int]) -> Series:
    places = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in counts]
    values, size = function(_grid(axes, places))
    terms = values.reshape(-1, *counts)
    for k, (n, place) in enumerate(zip(counts, places, strict=True), start=1):
        weights = 2.0 / n * chebyshev.chebvander(place, n - 1).T
        weights[0] *= 0.5
        terms = np.moveaxis(np.tensordot(weights, terms, (1, k)), 0, k)
    return Series(tuple(axes), terms, size.min(axis=1))


def _grid(axes: Sequence[Interval], places: Sequence[np.ndarray]) -> list[np.ndarray]:
    lines = [axis.at(place) for axis, place in zip(axes, places, strict=True)]
    return [column.ravel() for column in np.meshgrid(*lines, indexing="ij")]


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

    ranges : key -> low, high;  outputs_wanted : outputs of ``raceway.function``, numbers or "stiffness", by names or symbols
    tolerance : relative error that terms are added for

    SceneError: A key or an output that the function does not have.
    RacewayError: A point within the ranges that has no answer, or runs for longer than two minutes.
    """
    names = function(scene, ranges, outputs_wanted).outputs
    f = function(scene, ranges, dict.fromkeys([*names, *([K.name] if C.name in names else [])]))
    if f.why_slow:
        f.refuse_time(_LEAST_POINTS, "a map needs at least these. `raceway sweep` computes a table of fewer")
    corners = [column.ravel() for column in np.meshgrid(*(np.linspace(*ends, 3) for ends in ranges.values()))]
    scales = _samples(f, names, corners).items()
    outputs = [_variable(name) for name, (v, scale) in scales if name in names or np.any(np.abs(v) > _ROUNDING * scale)]

    def quantities(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        found = _samples(f, names, columns)
        values, sizes = (np.stack([found[output.name][k] for output in outputs]) for k in range(2))
        return values, np.maximum(np.abs(values), _SMALL * sizes)

    series = fit(quantities, [Interval(*ends) for ends in ranges.values()], tolerance, _MOST_POINTS)
    terms, axes, low, high = series.terms, series.axes, *np.array(list(ranges.values())).T
    keys = [key_of(scene, path) for path in ranges]
    words = "; ".join(f"{key.path} {a:g} to {b:g} {key.unit}" for key, a, b in zip(keys, low, high, strict=True))
    relative, difference, excess = (_SAFETY * x for x in (series.relative, series.difference, series.error))
    inputs = [Variable(k.path, k.unit, k.help, float(np.clip(k.value, *ranges[k.path])), *ranges[k.path]) for k in keys]
    stated, errors = list[Variable](), list[Variable]()
    for v, d, r in zip(outputs, difference, relative, strict=True):
        words_of_error = f"error at most {d:.1e} {v.unit}{f', relative {r:.1e}' if r < _RESOLVED else ''}"
        stated.append(attrs.evolve(v, words=f"{v.words}; {words_of_error}"))
        relative_error = Variable(f"relative_error.{v.name}", "1", _STATED, float(r))
        errors.append(relative_error if r < _RESOLVED else Variable(f"error.{v.name}", v.unit, _STATED, float(d)))
    resolved = zip(outputs, relative, strict=True)
    largest, of = max(((r, v.name) for v, r in resolved if r < _RESOLVED), default=(0.0, ""))
    error_words = f"relative error at most {largest:.1e} ({of})" if of else "errors are those of each output"
    if excess.max() > tolerance:
        error_words += f", above the tolerance {tolerance:g}. {_NARROW[:-1]}"
    degrees, logarithmic = np.array(terms.shape[1:]), np.array([int(axis.logarithmic) for axis in axes])
    numbers = {"TERMS": terms[0].size, "MOST": max(terms.shape[1:]), "degrees": degrees, "logarithmic": logarithmic}
    numbers |= {"low": low, "high": high, "terms": terms.reshape(len(terms), -1)}
    title, beyond = f"map over {words}; {error_words}.", f"an input is out of range: its end stands for it ({words})"
    return Unit(name, title, "map.c", numbers, beyond, tuple(inputs), tuple(stated), tuple(errors))


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
