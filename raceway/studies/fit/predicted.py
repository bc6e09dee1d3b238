"""The scene's answers beside a table of measurements, with their derivatives by the free keys."""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.errors import SceneError
from raceway.pipeline.gradient import Gradient, Gradients, definitions, derivatives, values
from raceway.pipeline.settle import settle
from raceway.pipeline.static_gradient import NoDerivative, static_gradient
from raceway.planning.plan import make_plan
from raceway.scene.continuous import key_of, with_number
from raceway.scene.scene import Scene
from raceway.studies.fit.free import Free
from raceway.studies.fit.observed import MEASURED, Observed
from raceway.studies.fit.uncertain import uncertain

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
