"""How the arrays of a model change with a continuous key of its scene.

Notes
-----
All that an equilibrium and a motion depend on are arrays of a few numbers: geometry, law parameters, loads, masses.  Their
derivatives by the key come from models at neighbouring values, two of them, or four where building one solves for a preload or
for loads of contacts and leaves its tolerance in them.  By the chain rule these derivatives are all that a key is.
"""

from __future__ import annotations

from functools import cached_property

import attrs
import numpy as np

from raceway.bodies.model import Model, build_model
from raceway.core.ring.surrogate import surrogate
from raceway.core.ring.system import System
from raceway.errors import RacewayError
from raceway.framework.duties import renews, same_bodies
from raceway.pipeline.gradient.differences import derivative
from raceway.scene.continuous import Key, with_number
from raceway.scene.scene import Scene

#: Least step of neighbouring models by unit, unless that is much of the number: arrays resolve it, and it changes a bearing little.
_LEAST = {"m": 1e-7, "N": 0.1, "N m": 1e-4, "deg": 1e-2, "r/min": 1.0, "K": 0.1, "kg": 1e-4, "s": 1e-7, "N s/m": 0.1}
_ELSE = 1e-7
#: Step over the number, of two models and of four; errors of the arrays are its square, and its fourth power.
_TWO, _FOUR = 5e-6, 5e-4
#: What the least step may be of the number; first try of a step along a direction, over the number, and over the least step at 0.
_MUCH, _FIRST, _FIRST_AT_0 = 1e-3, 1e-6, 0.01
#: Arrays whose second difference is a larger part of the first than this have a kink; differences that are rounding.
_KINK, _ARRAY_ROUNDING = 0.02, 1e-12
#: Arrays of a system that forces at rest depend on, and those that only a motion does.
_AT_REST, _IN_MOTION = ("scalars", "table", "stiffness", "load", "law_params"), ("mass", "damping", "force_params")


class NoDerivative(Exception):  # noqa: N818  (an answer, told in the table, no failure)
    """Why a quantity has no derivative by a key, in one sentence."""


@attrs.frozen(eq=False)
class Direction:
    """Derivatives of a model's arrays by the number at a key.

    Attributes
    ----------
    key : by which;  slopes : name of an array of the system -> its derivative, without those that do not change
    guess : (5,) of the first guess, with a held axial displacement;  speed : of the excitation's [rad/s]
    bends : whether arrays have a kink there;  built : models that were built
    """

    key: Key
    slopes: dict[str, np.ndarray]
    guess: np.ndarray
    speed: float
    bends: bool
    built: int

    @property
    def tried(self) -> float:
        """A small first step, in the unit of the key."""
        return _FIRST * abs(self.key.value) or _FIRST_AT_0 * _least(self.key)

    @property
    def at_rest(self) -> bool:
        """Whether anything changes that forces at rest may depend on."""
        return bool(self.guess.any()) or any(name in self.slopes for name in _AT_REST)

    @cached_property
    def nothing(self) -> bool:
        """Whether nothing changes at all."""
        return not self.slopes and not self.guess.any() and self.speed == 0.0

    def moved(self, system: System, by: float) -> System:
        """The system with its arrays moved along by a change of the number."""
        return attrs.evolve(system, **{name: getattr(system, name) + by * slope for name, slope in self.slopes.items()})


def direction_of(model: Model, key: Key) -> Direction:
    """Derivatives of a model's arrays by one key.

    Raises
    ------
    NoDerivative
        There is none, with the reason.
    """
    solved = model.scene.bearing.preloaded or renews(model.scene.contact.law)
    step, near = (_model_step(key, _FOUR), (-2, -1, 1, 2)) if solved else (_model_step(key, _TWO), (-1, 1))
    here, slopes, bends = surrogate(model.system), {}, False
    _scene(model, key, -step)  # a key at the end of its range is refused, whatever it does
    ahead = _model(model, key, step)
    if _same(model, ahead):
        return Direction(key, {}, np.zeros(5), 0.0, False, 1)
    models = {k: ahead if k == 1 else _model(model, key, k * step) for k in near}
    systems = {k: surrogate(one.system) for k, one in models.items()}
    for name in (*_AT_REST, *_IN_MOTION):
        values = {k: getattr(one, name) for k, one in systems.items()}
        middle = getattr(here, name)
        if all(np.array_equal(one, middle) for one in values.values()):
            continue
        if any(one.shape != middle.shape for one in values.values()):
            raise NoDerivative("switches a part of the model on or off, which is no small change")
        slopes[name] = _derivative(values, step)
        bends |= _bent(values, middle)
    guess = _derivative({k: one.guess for k, one in models.items()}, step)
    speed = 0.0
    if model.excitation is not None and model.excitation.period_s is not None:
        speed = float(_derivative({k: np.array(speed_of(one)) for k, one in models.items()}, step))
    return Direction(key, slopes, guess, speed, bends, len(models))


def _same(model: Model, other: Model) -> bool:
    """Whether nothing differs, to the last bit."""
    here, there = surrogate(model.system), surrogate(other.system)
    arrays = all(np.array_equal(getattr(here, name), getattr(there, name)) for name in (*_AT_REST, *_IN_MOTION))
    moves = model.excitation is not None and model.excitation.period_s is not None
    return arrays and np.array_equal(model.guess, other.guess) and not (moves and speed_of(model) != speed_of(other))


def speed_of(model: Model) -> float:
    """Of the excitation [rad/s]."""
    return 2.0 * np.pi / float(model.excitation.period_s)


def _derivative(values: dict[int, np.ndarray], step: float) -> np.ndarray:
    if 2 in values:
        return derivative(values, step)
    return (values[1] - values[-1]) / (2.0 * step)


def _bent(values: dict[int, np.ndarray], middle: np.ndarray) -> bool:
    """Whether one side differs from the other; a number whose both sides differ alike has a turning point."""
    first, second = np.abs(values[1] - values[-1]), np.abs(values[1] + values[-1] - 2.0 * middle)
    rounding = _ARRAY_ROUNDING * np.abs(middle).max(initial=0.0)
    return bool(((second > _KINK * first + rounding) & (first > 0.1 * second)).any())


def _model_step(key: Key, relative: float) -> float:
    """Of the models, in the unit of the key."""
    size = abs(key.value)
    return max(relative * size, min(_least(key), _MUCH * size)) if size else _least(key)


def _least(key: Key) -> float:
    return _LEAST.get(key.unit, _ELSE)


def _scene(model: Model, key: Key, step: float) -> Scene:
    """The scene with another number at the key."""
    try:
        scene = with_number(model.scene, key.path, key.value + step)
    except ValueError as why:
        if key.value == 0.0:
            raise NoDerivative("is 0, the end of its range: it switches a part on, which is no small change") from None
        raise NoDerivative(f"is at the end of its range: {why}") from None
    if not same_bodies(model.scene, scene):
        raise NoDerivative(
            "changes the meshes of the bodies: the difference of two meshes is their error, no derivative. "
            "bodies.kind = 'rigid' has one"
        )
    return scene


def _model(model: Model, key: Key, step: float) -> Model:
    """The model at another number; the plan stays."""
    scene = _scene(model, key, step)
    try:
        return build_model(scene, model.plan)
    except RacewayError as why:
        raise NoDerivative(f"no model can be built at {key.value + step:.6g}: {why}") from None
