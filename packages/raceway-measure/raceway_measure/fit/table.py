"""Fit to a table of measured quantities over keys of a scene: ``load.axial [N], K [N/µm], K error [N/µm]``, a row per measurement.

Residuals are those of the scene's answers, with their exact derivatives by the free keys.
"""

import re
from collections.abc import Iterable, Mapping, Sequence

import attrs
import numpy as np

from raceway import Function, RacewayError, Scene, SceneError, build_model, evolve, function
from raceway.extend import (
    AMPLITUDE, DIFFERENTIABLE, C, K, Key, NumberTable, X, continuous_keys, default_registry, definitions, key_of, nearest,
    number_in, quantity_of, read_in, resolved, solve_equilibrium, stated_columns, with_number,
)  # fmt: skip
from raceway_measure.fit.column_headers import IGNORE
from raceway_measure.fit.estimate import COVERAGE, Free, estimate, free_keys, uncertain, with_free
from raceway_measure.fit.fitted import Fitted, Series, refuse_few

#: Index of displacements across the axis in the coordinates at rest.
_ACROSS = {"y": 1, "z": 2}
#: Quantities of a motion, which need its orbit.
_MOTION = (K.symbol, C.symbol, AMPLITUDE.symbol)
#: Relative tolerance of the 1x lines of orbits.
_TOLERANCE = 1e-10
#: Standard errors by which measurements of the same quantity may differ before they contradict each other.
_CONTRADICT = 6.0
_HEADER = re.compile(r"^\s*(?P<name>[^\[(]*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*$")


@attrs.frozen(eq=False)
class _Measurements:
    """Measurements, one per row."""

    source: str  # file
    keys: dict[str, np.ndarray]  # path -> numbers (n,), in the unit of the key
    values: dict[str, np.ndarray]  # quantity -> numbers (n,), SI
    errors: dict[str, np.ndarray]  # quantity -> standard errors (n,), SI, of those whose errors are stated

    @property
    def count(self) -> int:
        """Rows."""
        return len(next(iter(self.values.values())))

    @property
    def stated(self) -> bool:
        """Whether every quantity has its errors."""
        return set(self.errors) == set(self.values)

    @property
    def weights(self) -> dict[str, np.ndarray]:
        """Standard errors (n,) by quantity; where none are stated, those of one relative size for all quantities."""
        if self.stated:
            return self.errors
        return {name: np.full(self.count, float(np.median(np.abs(numbers))) or 1.0) for name, numbers in self.values.items()}

    def scenes(self, scene: Scene) -> list[Scene]:
        """The scene of each row."""
        scenes = [scene] * self.count
        for row in range(self.count):
            for path, numbers in self.keys.items():
                try:
                    scenes[row] = with_number(scenes[row], path, float(numbers[row]))
                except ValueError as why:
                    words = f"measurement {row + 1}: `{path}` = {numbers[row]:g}: {why}"
                    raise SceneError.at(self.source, None, words) from None
        return scenes


def measurements_in(
    table: NumberTable, source: str, scene: Scene, columns: Mapping[str, str] | None = None
) -> _Measurements:
    """The measurements in a table.

    columns : header -> the header that is meant, or "ignore"

    SceneError: The fault, with its column or row.
    """
    try:
        kinds = _column_kinds(table.header, scene, columns or {})
        if not len(table.values):
            raise ValueError("has no measurements: rows of numbers are needed below the column headers")
        parts: dict[str, dict[str, np.ndarray]] = {"key": {}, "value": {}, "error": {}, IGNORE: {}}
        for k, (kind, name, factor) in enumerate(kinds):
            parts[kind][name] = factor * table.values[:, k]
        for name, errors in parts["error"].items():
            if (errors <= 0.0).any():
                row = f"{table.word} {table.lines[int(np.argmin(errors))]}"
                raise ValueError(f"{row}: '{name} error' must be greater than 0: half the width of its 95 %")
        if parts["error"] and (missing := [name for name in parts["value"] if name not in parts["error"]]):
            raise ValueError(
                f"errors are stated of {', '.join(parts['error'])}, none of {', '.join(missing)}: state all of them or none"
            )
        standard_errors = {name: numbers / COVERAGE for name, numbers in parts["error"].items()}
        measurements = _Measurements(source, parts["key"], parts["value"], standard_errors)
        # Measurements under the same keys that their stated errors hold apart
        if measurements.errors:
            keys = np.column_stack([*measurements.keys.values(), np.zeros(measurements.count)])
            _, groups = np.unique(keys, axis=0, return_inverse=True)
            for name, numbers in measurements.values.items():
                for group in range(int(groups.max()) + 1):
                    rows = np.flatnonzero(groups.ravel() == group)
                    low, high = rows[np.argmin(numbers[rows])], rows[np.argmax(numbers[rows])]
                    distance = (numbers[high] - numbers[low]) / np.hypot(
                        measurements.errors[name][low], measurements.errors[name][high]
                    )
                    if distance > _CONTRADICT:
                        raise ValueError(
                            f"measurements {min(low, high) + 1} and {max(low, high) + 1} contradict each other: under the same keys {name} is "
                            f"{numbers[low]:.6g} and {numbers[high]:.6g} {_quantity_unit(name)}, {distance:.3g} of their stated standard errors apart"
                        )
        return measurements
    except ValueError as why:
        raise SceneError.at(source, None, str(why)) from None


def _column_kinds(header: Sequence[str], scene: Scene, meanings: Mapping[str, str]) -> list[tuple[str, str, float]]:
    """Kind ("key", "value", "error" or "ignore"), name and factor of each column."""
    if unknown := next((text for text in meanings if text not in header), None):
        raise ValueError(f"no column '{unknown}' for --map; there are {', '.join(map(repr, header))}")
    keys = {key.path: key for key in continuous_keys(scene)}
    quantities = [*DIFFERENTIABLE, *_ACROSS, *stated_columns(scene, default_registry())]
    columns = [_column(meanings.get(text, text), text, keys, quantities) for text in header]
    names = [(kind, name) for kind, name, _ in columns if kind != IGNORE]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ValueError(f"'{twice[1]}' stands there twice: leave one of its columns out with --map \"HEADER={IGNORE}\"")
    values = [name for kind, name in names if kind == "value"]
    if not values:
        raise ValueError(
            f"no measured quantity among {', '.join(map(repr, header))}: name one of {', '.join(quantities)}, such as K [N/µm]"
        )
    if "kyy_tilts_follow" in values and scene.supports.tilt == "locked":
        raise ValueError(
            "kyy_tilts_follow needs free or sprung tilts, and supports.tilt = 'locked': name it kyy, or change supports.tilt"
        )
    if lonely := next((name for kind, name in names if kind == "error" and name not in values), None):
        raise ValueError(f"'{lonely} error' has no column {lonely} beside it")
    return columns


def _quantity_unit(name: str) -> str:
    """SI unit of a quantity that may be measured: those of sensitivities and of plug-ins, and displacements across the axis at rest."""
    return X.unit if name in _ACROSS else quantity_of(name).unit


def _column(text: str, header: str, keys: Mapping[str, Key], quantities: Sequence[str]) -> tuple[str, str, float]:
    if text.strip() == IGNORE:
        return IGNORE, header, 0.0
    match = _HEADER.match(text)
    name, unit = (match["name"], match["unit"]) if match else (text, None)
    quantity = "_".join(name.removesuffix(" error").split())
    if quantity in quantities:
        if not unit:
            raise ValueError(f"'{header}' has no unit: write {name} [{read_in(1.0, _quantity_unit(quantity))[1]}]")
        return "error" if name.endswith(" error") else "value", quantity, _factor(header, _quantity_unit(quantity), unit)
    # A key by its path, or by its last word where one key of the scene ends so.
    paths = [name] if name in keys else [path for path in keys if path.rpartition(".")[2] == name]
    if len(paths) != 1:
        raise ValueError(
            f"unknown column '{header}'{nearest(name, [*quantities, *keys])}. Known are {', '.join(quantities)}, each with a unit, '... error', "
            f'keys of the scene; --map "{header}=NAME" names it, or {IGNORE}'
        )
    return "key", paths[0], _factor(header, keys[paths[0]].unit, unit) if unit else 1.0


def _factor(header: str, unit: str, unit_text: str) -> float:
    if unit_text.strip() == unit or not unit and unit_text.strip() in ("", "1", "-"):
        return 1.0
    try:
        return number_in(unit, f"1 {unit_text}")
    except ValueError as why:
        raise ValueError(f"'{header}': {why}") from None


@attrs.define(eq=False)
class TableResiduals:
    """Weighted residuals of a table of measurements: ``raceway_measure.fit.estimate.Residuals``.

    All rows, and all steps of the differences that make their derivatives, are columns of one call.
    """

    measured: _Measurements
    free: Sequence[Free]
    scene: Scene
    scenes: list[Scene] = attrs.field(init=False)  # of the rows
    _last: np.ndarray = attrs.field(init=False)
    _functions: dict[tuple[str, ...], Function] = attrs.field(factory=dict, init=False)

    def __attrs_post_init__(self) -> None:
        self.scenes = self.measured.scenes(self.scene)
        self._last = np.array([key.start for key in self.free])
        of_plugins = self.scene.excitation is not None and {*self.measured.values} - {*DIFFERENTIABLE, *_ACROSS}
        if of_plugins or any(name in _MOTION for name in self.measured.values):
            self.scene = evolve(self.scene, {"integrator": None, "identifier": None}, {"integrator.kind": "periodic"})

    def residuals(self, at: np.ndarray) -> np.ndarray:
        answers, weights = self.answers(at), self.measured.weights
        return np.concatenate([(answers[name] - numbers) / weights[name] for name, numbers in self.measured.values.items()])

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        self._last = at
        return self._slopes([key.name for key in self.free]).T

    def answers(self, at: np.ndarray) -> dict[str, np.ndarray]:
        """Quantity -> the scene's answers (n,), SI."""
        self._last = at
        answer = self._function().columns(self._columns())
        for row in np.flatnonzero(answer["reason"] != ""):
            raise RacewayError(f"measurement {row + 1}: {answer['reason'][row]}")
        if C.symbol in self.measured.values and not resolved(answer["z_real"], answer["z_imag"]).all():
            raise SceneError.at(C.symbol, None, "is not a number of this scene: its motion has too little of it")
        return {name: _quantity_values(answer, name) for name in self.measured.values}

    def _function(self, more: Iterable[str] = ()) -> Function:
        """The scene as a function of the table's keys, the free ones, and more."""
        inputs = tuple(dict.fromkeys([*self.measured.keys, *(key.name for key in self.free), *more]))
        if inputs in self._functions:
            return self._functions[inputs]
        outputs = ["displacement" if name in _ACROSS else name for name in self.measured.values]
        outputs += ["z_real", "z_imag"] if C.symbol in outputs else []
        self._functions[inputs] = function(self.scene, inputs, outputs, tolerance=_TOLERANCE, force=True)
        return self._functions[inputs]

    def _columns(self, more: Iterable[str] = ()) -> dict[str, np.ndarray]:
        """Numbers of these keys (n,)."""
        numbers = {key: np.full(self.measured.count, key_of(self.scene, key).value) for key in more}
        free = zip(self.free, self._last, strict=True)
        return numbers | {key.name: np.full(self.measured.count, number) for key, number in free} | self.measured.keys

    def uncertain(self) -> tuple[dict[str, np.ndarray], list[str]]:
        """Cause -> change of the residuals (n, 1) by its standard error, at the last numbers; causes that are left out."""
        names, keys = [key.name for key in self.free], tuple(self.measured.keys)
        columns, left_out = {}, []
        rows = [uncertain(scene, names, keys) for scene in self.scenes]  # a range in per cent is that of each row's number
        for same in zip(*rows, strict=True):
            cause = same[0].cause
            sizes = np.array([list(row.sizes.values()) for row in same]).T
            try:
                columns[cause] = self._slopes(list(same[0].sizes), sizes).sum(axis=0)[:, None]
            except SceneError as why:
                left_out.append(f"the uncertainty of {cause} is not in the intervals: {why.mistakes[0].message}")
        return columns, left_out

    def _slopes(self, paths: list[str], sizes: np.ndarray | float = 1.0) -> np.ndarray:
        """Derivatives (k, n) of the weighted residuals by keys, times sizes (k, rows)."""
        slopes, weights = self._function(paths).slopes(self._columns(paths), paths), self.measured.weights
        by_keys = [{output: by_key[path] for output, by_key in slopes.items()} for path in paths]
        out = [sizes * np.array([_quantity_values(slope, name) for slope in by_keys]) / weights[name] for name in weights]
        for k, path in enumerate(paths):
            if not all(np.isfinite(part[k]).all() for part in out):
                raise SceneError.at(path, None, "has no derivative: near a measurement the scene has no answer")
        return np.concatenate(out, axis=1)

    def notes(self) -> list[str]:
        """Definitions of measured numbers whose names may mean another quantity to the reader."""
        names = ["largest_ball_load", *(["kyy"] if self.scene.supports.tilt != "locked" else [])]
        if not any(name in self.measured.values for name in names):
            return []
        model = build_model(with_free(self.scenes[0], self.free, self._last))
        words = definitions(model, solve_equilibrium(model))
        return [f"{name} is taken as {words[name]}" for name in names if name in self.measured.values]


def _quantity_values(columns: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """(n,) of a quantity that may be measured, among outputs of a function."""
    return columns["displacement"][:, _ACROSS[name]] if name in _ACROSS else columns[quantity_of(name).name]


def fit_table(measurements: _Measurements, scene: Scene, names: list[str]) -> Fitted:
    """Free keys of a scene from a table."""
    free = free_keys(scene, names)
    refuse_few(measurements.count * len(measurements.values), len(free), measurements.source)
    if both := next((key.name for key in free if key.name in measurements.keys), None):
        raise SceneError.at("--free", both, "is a column of the data, too: a key is free or known in each measurement")
    moving = [name for name in measurements.values if name in _MOTION]
    if moving and scene.excitation is None:
        raise SceneError.at("excitation", None, f"is missing: {', '.join(moving)} are those of a motion under an excitation")
    problem = TableResiduals(measurements, free, scene)
    answer = estimate(problem, free, measurements.stated)
    answers = problem.answers(answer.values)
    causes, left_out = problem.uncertain()
    notes = [*problem.notes(), *left_out]
    if "conformit" not in " ".join([*causes, *names, *left_out, *measurements.keys]):
        notes.append("groove conformities are taken as exact: state their uncertainty in [tolerances]")
    for cause, columns in causes.items():
        answer = answer.with_shifts(cause, columns)
    key = next((path for path, numbers in measurements.keys.items() if np.ptp(numbers) > 0.0), None)
    x = measurements.keys[key] if key else np.arange(1.0, measurements.count + 1.0)
    unit = key_of(scene, key).unit if key else ""
    band = answer.half_widths(answer.jacobian, causes).reshape(-1, measurements.count)
    noise = answer.widened if measurements.stated else (answer.scatter or 0.0)
    series = list[Series]()
    for k, (name, numbers) in enumerate(measurements.values.items()):
        axes, weights = (name, _quantity_unit(name), key or "measurement", unit), measurements.weights[name]
        series.append(Series(*axes, x, numbers, answers[name], noise * weights, band[k] * weights))
    return Fitted(scene.title, measurements.source, "table", measurements.stated, answer, tuple(series), (), tuple(notes))
