"""A table of measured quantities over keys of a scene: ``load.axial [N], K [N/µm], K error [N/µm]`` and a line a measurement."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.framework.shown import read_in
from raceway.pipeline.gradient import UNITS, Gradient, Gradients, definitions, derivatives, values
from raceway.pipeline.settle import settle
from raceway.pipeline.static_gradient import NoDerivative, static_gradient
from raceway.planning.plan import make_plan
from raceway.scene.continuous import Key, continuous_keys, key_of, with_number
from raceway.scene.scene import Scene
from raceway.scene.units import number_in
from raceway.storage.number_table import NumberTable
from raceway.studies.fit.estimate import Free, uncertain

#: Quantities that may be measured, with units: those of sensitivities, and the displacement across the axis at rest.
MEASURED = UNITS | {"y": "m", "z": "m"}
#: Half-width at 95 % over the standard error.
COVERAGE = 1.96
#: Measurements of one thing that differ by more than this many standard errors contradict each other.
_CONTRADICT = 6.0
IGNORE = "ignore"
_HEAD = re.compile(r"^\s*(?P<name>[^\[(]*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*$")


@attrs.frozen
class Column:
    """A head: key of the scene or measured quantity, and its factor.  ``kind``: "key", "value", "error" or "ignore"."""

    kind: str
    name: str
    factor: float


@attrs.frozen(eq=False)
class Observed:
    """Measurements, one a row.

    Attributes
    ----------
    source : file;  keys : path -> numbers (n,), in the unit of the key
    values : quantity -> numbers (n,), SI;  errors : quantity -> standard errors (n,), SI, of those whose errors are stated
    """

    source: str
    keys: dict[str, np.ndarray]
    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]

    @property
    def stated(self) -> bool:
        """Whether every quantity has its errors."""
        return set(self.errors) == set(self.values)

    @property
    def weights(self) -> dict[str, np.ndarray]:
        """Standard errors (n,) by quantity; where none are stated, those of one relative size for all quantities."""
        if self.stated:
            return self.errors
        return {name: np.full(len(one), float(np.median(np.abs(one))) or 1.0) for name, one in self.values.items()}

    def scenes(self, scene: Scene) -> list[Scene]:
        """The scene of each row.

        Raises
        ------
        SceneError
            A number that a key of the scene cannot have.
        """
        count = len(next(iter(self.values.values())))
        out = []
        for row in range(count):
            here = scene
            for path, numbers in self.keys.items():
                try:
                    here = with_number(here, path, float(numbers[row]))
                except ValueError as why:
                    raise SceneError.at(
                        self.source, None, f"measurement {row + 1}: `{path}` = {numbers[row]:g}: {why}"
                    ) from None
            out.append(here)
        return out


def observed(table: NumberTable, source: str, scene: Scene, heads: Mapping[str, str] | None = None) -> Observed:
    """The measurements in a table.

    Parameters
    ----------
    heads : head -> what it is taken for, a head itself, or "ignore"

    Raises
    ------
    SceneError
        What is wrong with it, with the column or the row.
    """
    try:
        columns = columns_of(table.header, scene, heads)
        if not len(table.values):
            raise ValueError("has no measurements: a line of numbers each is needed below the heads")
        found = _taken(table, columns)
        _refuse_contradictions(found)
        return found if source == found.source else attrs.evolve(found, source=source)
    except ValueError as why:
        raise SceneError.at(source, None, str(why)) from None


def columns_of(header: Sequence[str], scene: Scene, heads: Mapping[str, str] | None = None) -> list[Column]:
    """What each head is.

    Raises
    ------
    ValueError
        A head that is nothing known, a unit that is missing or wrong, or heads without a measured quantity.
    """
    heads = dict(heads or {})
    if unknown := next((head for head in heads if head not in header), None):
        raise ValueError(f"no column '{unknown}' for --map; there are {', '.join(map(repr, header))}")
    keys = {key.path: key for key in continuous_keys(scene)}
    columns = [_column(heads.get(head, head), head, keys) for head in header]
    places = [(one.kind, one.name) for one in columns if one.kind != IGNORE]
    if twice := next((one for one in places if places.count(one) > 1), None):
        raise ValueError(f"'{twice[1]}' stands there twice: leave one of its columns out with --map \"HEAD={IGNORE}\"")
    values = [one.name for one in columns if one.kind == "value"]
    if not values:
        raise ValueError(
            f"no measured quantity among {', '.join(map(repr, header))}: name one of {', '.join(MEASURED)}, such as K [N/µm]"
        )
    if "kyy_tilts_follow" in values and scene.supports.tilt == "locked":
        raise ValueError(
            "kyy_tilts_follow is none of a scene with supports.tilt = 'locked': name it kyy, or let the tilts follow"
        )
    if lonely := next((one.name for one in columns if one.kind == "error" and one.name not in values), None):
        raise ValueError(f"'{lonely} error' has no column {lonely} beside it")
    return columns


def _column(text: str, head: str, keys: Mapping[str, Key]) -> Column:
    if text.strip() == IGNORE:
        return Column(IGNORE, head, 0.0)
    match = _HEAD.match(text)
    name, unit = (match["name"], match["unit"]) if match else (text, None)
    base, word = "_".join(name.removesuffix(" error").split()), name.endswith(" error")
    if base in MEASURED:
        if not unit:
            raise ValueError(f"'{head}' has no unit: write {name} [{read_in(1.0, MEASURED[base])[1]}]")
        return Column("error" if word else "value", base, _factor(head, MEASURED[base], unit))
    path = _path(name, keys)
    if path is None:
        known = [*MEASURED, *keys]
        what = f"{', '.join(MEASURED)}, each with a unit, '... error', keys of the scene"
        raise ValueError(
            f"unknown column '{head}'{nearest(name, known)}. Known are {what}; --map \"{head}=NAME\" says what it is, or {IGNORE}"
        )
    return Column("key", path, _factor(head, keys[path].unit, unit) if unit else 1.0)


def _path(name: str, keys: Mapping[str, Key]) -> str | None:
    """A key by its path, or by its last word where one key of the scene ends so."""
    if name in keys:
        return name
    ends = [path for path in keys if path.rpartition(".")[2] == name]
    return ends[0] if len(ends) == 1 else None


def _factor(head: str, unit: str, given: str) -> float:
    if not unit and given.strip() in ("", "1", "-"):
        return 1.0
    try:
        return number_in(unit, f"1 {given}")
    except ValueError as why:
        raise ValueError(f"'{head}': {why}") from None


def _taken(table: NumberTable, columns: Sequence[Column]) -> Observed:
    parts: dict[str, dict[str, np.ndarray]] = {"key": {}, "value": {}, "error": {}, IGNORE: {}}
    for place, column in enumerate(columns):
        parts[column.kind][column.name] = column.factor * table.values[:, place]
    for name, errors in parts["error"].items():
        if (errors <= 0.0).any():
            row = int(np.argmin(errors))
            raise ValueError(
                f"{table.word} {table.lines[row]}: '{name} error' must be greater than 0: half the width of its 95 %"
            )
    if parts["error"] and (rest := [name for name in parts["value"] if name not in parts["error"]]):
        raise ValueError(
            f"errors are stated of {', '.join(parts['error'])}, none of {', '.join(rest)}: state all of them or none"
        )
    return Observed("", parts["key"], parts["value"], {name: one / COVERAGE for name, one in parts["error"].items()})


def _refuse_contradictions(found: Observed) -> None:
    """Two measurements under one set of keys that their stated errors do not explain."""
    if not found.errors:
        return
    count = len(next(iter(found.values.values())))
    keys = np.column_stack([*found.keys.values(), np.zeros(count)])
    _, groups = np.unique(keys, axis=0, return_inverse=True)
    for name, numbers in found.values.items():
        for group in range(int(groups.max()) + 1):
            rows = np.flatnonzero(groups.ravel() == group)
            low, high = rows[np.argmin(numbers[rows])], rows[np.argmax(numbers[rows])]
            apart = (numbers[high] - numbers[low]) / np.hypot(found.errors[name][low], found.errors[name][high])
            if apart > _CONTRADICT:
                raise ValueError(
                    f"measurements {min(low, high) + 1} and {max(low, high) + 1} contradict each other: under the same keys {name} is "
                    f"{numbers[low]:.6g} and {numbers[high]:.6g} {MEASURED[name]}, {apart:.3g} of their stated standard errors apart"
                )


def refuse_few(points: int, free: int, source: str) -> None:
    """Fewer data than free numbers.

    Raises
    ------
    SceneError
        With both counts.
    """
    if points < free:
        numbers = "1 measured number" if points == 1 else f"{points} measured numbers"
        raise SceneError.at(
            source, None, f"{numbers} for {free} free ones: free fewer keys, or measure at more loads or speeds"
        )


#: Quantities of a motion, which need its orbit; place of displacements in the coordinates at rest.
_MOTION, _PLACES = ("K", "C", "amplitude"), {"y": 1, "z": 2}


@attrs.define(eq=False)
class Predicted:
    """Weighted residuals of a table of measurements: ``raceway.studies.fit.estimate.Residuals``.

    Attributes
    ----------
    scene : without the rows' keys;  scenes : of the rows
    """

    observed: Observed
    free: Sequence[Free]
    scenes: list[Scene]
    _answers: list[Gradients] = attrs.field(factory=list, init=False)

    @classmethod
    def of(cls, observed: Observed, scene: Scene, free: Sequence[Free]) -> Predicted:
        """Beside the answers of a scene.

        Raises
        ------
        SceneError
            A key that is free and measured under, a number that a key cannot have, or a motion that is asked of a scene at rest.
        """
        if both := next((one.name for one in free if one.name in observed.keys), None):
            raise SceneError.at(
                "--free", both, "is a column of the data, too: a key is either free or known in each measurement"
            )
        asked = [name for name in observed.values if name in _MOTION]
        if asked and scene.excitation is None:
            raise SceneError.at(
                "excitation", None, f"is missing: {', '.join(asked)} are those of a motion under an excitation"
            )
        return cls(observed, free, observed.scenes(scene))

    def residuals(self, at: np.ndarray) -> np.ndarray:
        return self._weighted(self.fitted(at), self.observed.values)

    def fitted(self, at: np.ndarray) -> dict[str, np.ndarray]:
        """Quantity -> the scene's answers (n,), SI."""
        self._answers = [self._answer(scene, at) for scene in self.scenes]
        rows = [self._values(one) for one in self._answers]
        return {name: np.array([row[name] for row in rows]) for name in self.observed.values}

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        return np.column_stack([self._column(one.name) for one in self.free])

    def uncertain(self) -> tuple[dict[str, np.ndarray], list[str]]:
        """Cause -> what a standard error of it moves the residuals by (n, 1), at the last numbers; what is left out of them."""
        names, keys = [one.name for one in self.free], tuple(self.observed.keys)
        found, left_out = {}, []
        rows = [uncertain(one, names, keys) for one in self.scenes]  # a range in per cent is that of each row's number
        for same in zip(*rows, strict=True):
            try:
                parts = [self._column(path, [one.sizes[path] for one in same]) for path in same[0].sizes]
            except SceneError as why:
                left_out.append(f"what {same[0].cause} may be off by is no part of the intervals: {why.mistakes[0].message}")
            else:
                found[same[0].cause] = np.sum(parts, axis=0)[:, None]
        return found, left_out

    def _column(self, path: str, sizes: Sequence[float] | None = None) -> np.ndarray:
        """Derivatives of the weighted residuals by a key, times a size a row."""
        gradients = [self._gradient(answer, path) for answer in self._answers]
        rows = [self._derivatives(a, g) for a, g in zip(self._answers, gradients, strict=True)]
        factors = np.ones(len(rows)) if sizes is None else np.array(sizes)
        return self._weighted({name: factors * [row[name] for row in rows] for name in self.observed.values})

    def _answer(self, scene: Scene, at: np.ndarray) -> Gradients:
        for one, value in zip(self.free, at, strict=True):
            try:
                scene = with_number(scene, one.name, float(value))
            except ValueError as why:
                raise SceneError.at(one.name, float(value), str(why)) from None
        model = build_model(scene, make_plan(scene))
        return Gradients(model, settle(model))

    def _values(self, answer: Gradients) -> dict[str, float]:
        model, equilibrium = answer.model, answer.equilibrium
        found = values(model, equilibrium, answer.orbit if self._moving else None) | _across(equilibrium.displacement)
        if lacking := next((name for name in self.observed.values if name not in found), None):
            raise SceneError.at(
                lacking, None, f"[{MEASURED[lacking]}] is no number that this scene has: its motion has too little of it"
            )
        return found

    def notes(self) -> tuple[str, ...]:
        """What the measured numbers are taken for, where their names may mean another thing to who measured."""
        model, words = self._answers[0].model, definitions(self._answers[0].model, self._answers[0].equilibrium)
        names = ["largest_ball_load", *(["kyy"] if model.scene.supports.tilt != "locked" else [])]
        return tuple(f"{name} is taken as {words[name]}" for name in names if name in self.observed.values)

    @property
    def _moving(self) -> bool:
        return any(name in _MOTION for name in self.observed.values)

    def _gradient(self, answer: Gradients, path: str) -> Gradient:
        """By one key; the orbit is left out where no quantity needs it."""
        if self._moving:
            return answer.by_path(path)
        try:
            return Gradient(static_gradient(answer.model, answer.equilibrium, key_of(answer.model.scene, path)), None)
        except NoDerivative as why:
            raise SceneError.at(path, None, str(why)) from None

    def _derivatives(self, answer: Gradients, gradient: Gradient) -> dict[str, float]:
        model: Model = answer.model
        equilibrium: Equilibrium = answer.equilibrium
        return derivatives(model, equilibrium, gradient) | _across(gradient.statics.displacement)

    def _weighted(self, one: dict[str, np.ndarray], less: dict[str, np.ndarray] | None = None) -> np.ndarray:
        weights = self.observed.weights
        return np.concatenate([(one[name] - (less[name] if less else 0.0)) / weights[name] for name in self.observed.values])


def _across(displacement: np.ndarray) -> dict[str, float]:
    return {name: float(displacement[place]) for name, place in _PLACES.items()}
