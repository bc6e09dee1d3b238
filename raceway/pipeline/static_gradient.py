"""Derivatives of an equilibrium by a continuous key of the scene.

Notes
-----
All that an equilibrium and a motion depend on are arrays of a few numbers: geometry, law parameters, loads, masses.  Their
derivatives by the key come from models at neighbouring values, two of them, or four where building one solves for a preload or
for loads of contacts and leaves its tolerance in them.  By the chain rule these derivatives are all that a key is.

At the equilibrium r(q, p) = f(q, p) + K_s q - F(p) = 0 with the exact tangent T = dr/dq, the balls condensed.  Hence
dq/dp = -T^-1 dr/dp, dr/dp at fixed q along the derivatives of the model's arrays.  Stiffness, damping and forces of the contacts are
then differentiated along that line: dK/dp = d/dh K(q + h dq/dp, p + h).  Differences are central and of fourth order; their step moves
no gap and no stiffness by more than ``_MOVED`` of itself, so that the error stays below 1e-7 of the derivative.  Coordinates that are
held move with what holds them (``supports.axial`` = "displacement").
"""

from __future__ import annotations

from collections.abc import Mapping

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, model_of
from raceway.core.ring.kernels.layout import CAGE, FRICTION
from raceway.core.ring.ring import Evaluation
from raceway.core.ring.system import System, surrogate
from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.duties import renews
from raceway.planning.resolve import Problem, resolve
from raceway.scene.changes import Key, with_number

#: Steps at which a function is looked at, with their weights: (8 (f_1 - f_-1) - (f_2 - f_-2)) / 12 h, its error h^4 f^(5) / 30.
WEIGHTS = {-2: 1.0 / 12.0, -1: -8.0 / 12.0, 1: 8.0 / 12.0, 2: -1.0 / 12.0}
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
#: Part of a gap, and of the stiffness, that the outermost step may move; largest step over the number at the key.
_MOVED, _LARGEST = 0.004, 0.01
#: Part of the way to a knot of the tables of compliances that a step may go, four of which then stay on one side.
_KNOT = 0.25
#: A step over the number so small that rounding shows: a contact is about to open or to close.
_ROUGH = 1e-7
#: Gaps below this part of the deepest one count as closed contacts without load.
_TOUCHING = 1e-9
#: Differences of second and of fourth order of a smooth function differ by far less than this part of either, and rounding.
_BENT, _ROUNDING, _BENDS = 0.01, 1e-7, "the model has a kink there: to either side derivatives are others"
_AT_THE_EDGE = "a contact is about to open or to close there: derivatives beyond it are others"


class NoDerivative(Exception):  # noqa: N818  (an answer, stated in the table, no failure)
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
    def first_step(self) -> float:
        """A small first step, in the unit of the key."""
        return _FIRST * abs(self.key.value) or _FIRST_AT_0 * _least(self.key)

    @property
    def at_rest(self) -> bool:
        """Whether anything changes that forces at rest may depend on."""
        return bool(self.guess.any()) or any(name in self.slopes for name in _AT_REST)

    def moved(self, system: System, by: float) -> System:
        """The system with its arrays moved along by a change of the number."""
        return attrs.evolve(system, **{name: getattr(system, name) + by * slope for name, slope in self.slopes.items()})


def _direction_of(model: Model, key: Key) -> Direction:
    """Derivatives of a model's arrays by one key.

    Raises
    ------
    NoDerivative
        There is none, with the reason.
    """
    solves = model.problem.bearing.preloaded or renews(model.problem.contact.law)
    step, multiples = (_model_step(key, _FOUR), (-2, -1, 1, 2)) if solves else (_model_step(key, _TWO), (-1, 1))
    system, slopes, bends = surrogate(model.system), {}, False
    _problem(model, key, -step)  # a key at the end of its range is refused, whatever it does
    ahead = _model(model, key, step)
    if _same(model, ahead):
        return Direction(key, {}, np.zeros(5), 0.0, False, 1)
    models = {k: ahead if k == 1 else _model(model, key, k * step) for k in multiples}
    systems = {k: surrogate(neighbour.system) for k, neighbour in models.items()}
    for name in (*_AT_REST, *_IN_MOTION):
        middle = getattr(system, name)
        values = {k: getattr(neighbour, name) for k, neighbour in systems.items()}
        if all(np.array_equal(value, middle) for value in values.values()):
            continue
        if any(value.shape != middle.shape for value in values.values()):
            raise NoDerivative("switches a part of the model on or off, which is no small change")
        slopes[name] = _derivative(values, step)
        bends |= _bent(values, middle)
    guess = _derivative({k: neighbour.guess for k, neighbour in models.items()}, step)
    speed = float(_derivative({k: np.array(_speed(neighbour)) for k, neighbour in models.items()}, step))
    return Direction(key, slopes, guess, speed, bends, len(models))


def _same(model: Model, neighbour: Model) -> bool:
    """Whether nothing differs, to the last bit."""
    systems = surrogate(model.system), surrogate(neighbour.system)
    arrays = all(np.array_equal(*(getattr(system, name) for system in systems)) for name in (*_AT_REST, *_IN_MOTION))
    return arrays and np.array_equal(model.guess, neighbour.guess) and _speed(model) == _speed(neighbour)


def _speed(model: Model) -> float:
    """Of the excitation [rad/s]; 0 where it has none of its own."""
    period = None if model.excitation is None else model.excitation.period_s
    return 0.0 if period is None else 2.0 * np.pi / float(period)


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


def _problem(model: Model, key: Key, step: float) -> Problem:
    """The problem with another number at the key."""
    try:
        problem = resolve(with_number(model.scene, key.path, key.value + step))
    except ValueError as why:
        if key.value == 0.0:
            raise NoDerivative("is 0, the end of its range: it switches a part on, which is no small change") from None
        raise NoDerivative(f"is at the end of its range: {why}") from None
    if not model.problem.body_kind.same_bodies(problem):
        raise NoDerivative(
            "changes the meshes of the bodies: the difference of two meshes is their error, no derivative. "
            "bodies.kind = 'rigid' has one"
        )
    return problem


def _model(model: Model, key: Key, step: float) -> Model:
    """The model at another number; the plan stays."""
    problem = _problem(model, key, step)
    try:
        return model_of(problem, model.plan)
    except RacewayError as why:
        raise NoDerivative(f"no model can be built at {key.value + step:.6g}: {why}") from None


@attrs.frozen(eq=False)
class StaticGradient:
    """Derivatives of an equilibrium, each by the number at one key.

    Attributes
    ----------
    direction : of the model's arrays;  step : of the differences, in the unit of the key; 0 where it changes nothing at rest
    displacement : (5,) [m, rad];  stiffness, damping : (5, 5) of the contacts;  contact_force : (2 Z,) inner races first [N]
    remark : why they may not be smooth; empty where they are
    """

    direction: Direction
    step: float
    displacement: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    contact_force: np.ndarray
    remark: str

    @property
    def key(self) -> Key:
        """By which."""
        return self.direction.key

    @property
    def models(self) -> int:
        """Models that were built."""
        return self.direction.built


@attrs.frozen(eq=False)
class _State:
    """One state of a model: residual of the balance (5,) with its tangent (5, 5), and what a result tells of the contacts."""

    residual: np.ndarray
    tangent: np.ndarray
    contacts: Evaluation

    def same(self, state: _State) -> bool:
        """Whether nothing differs, to the last bit."""
        pairs = [(self.residual, state.residual), (self.tangent, state.tangent)]
        names = ("stiffness", "damping", "contact_force", "gap")
        pairs += [(getattr(self.contacts, name), getattr(state.contacts, name)) for name in names]
        return all(np.array_equal(*pair) for pair in pairs)


def static_gradient(model: Model, equilibrium: Equilibrium, key: Key) -> StaticGradient:
    """Derivatives of an equilibrium by one key.

    Raises
    ------
    NoDerivative
        There is none, with the reason.
    """
    direction = _direction_of(model, key)
    try:
        return _gradient(model, direction, equilibrium)
    except ConvergenceError as why:
        raise NoDerivative(f"the neighbouring states have no balance: {why}") from None


def _gradient(model: Model, direction: Direction, equilibrium: Equilibrium) -> StaticGradient:
    system, q, ball = surrogate(model.system), equilibrium.displacement, equilibrium.ball
    base = _state(system, q, ball)
    step, remark = _difference_step(system, direction, equilibrium, base) if direction.at_rest else (0.0, "")
    if step == 0.0:
        zeros = np.zeros(5), np.zeros((5, 5)), np.zeros((5, 5)), np.zeros(len(base.contacts.contact_force))
        return StaticGradient(direction, 0.0, *zeros, "")
    systems = {k: direction.moved(system, k * step) for k in WEIGHTS}
    residual = derivative({k: _state(neighbour, q, ball).residual for k, neighbour in systems.items()}, step)
    moved = _moved(system, base.tangent, residual, direction.guess)
    displaced = {k: q + k * step * moved for k in WEIGHTS}
    states = {k: _state(neighbour, displaced[k], ball).contacts for k, neighbour in systems.items()}
    loaded = base.contacts.contact_force > 0.0
    if any(((state.contact_force > 0.0) != loaded).any() for state in states.values()):
        remark = _AT_THE_EDGE
    stiffness, damping = {}, {}
    for k, state in states.items():
        still = systems[k].without(CAGE)
        held = still.stiffness_at(displaced[k], state), still.damping_at(displaced[k], state)
        stiffness[k], damping[k] = still.rows_following(displaced[k], state, *held)
    slope = derivative(stiffness, step)
    rounding = _ROUNDING * np.abs(stiffness[1]).max() / step
    bent = np.abs((stiffness[1] - stiffness[-1]) / (2.0 * step) - slope).max()
    if not remark and (direction.bends or bent > _BENT * np.abs(slope).max() + rounding):
        remark = _BENDS
    force = derivative({k: state.contact_force for k, state in states.items()}, step)
    return StaticGradient(direction, step, moved, slope, derivative(damping, step), force, remark)


def _state(system: System, q: np.ndarray, ball: np.ndarray) -> _State:
    """As ``raceway.pipeline.equilibrium`` evaluates it: the balance without friction, then slips at which no contact sticks."""
    balanced = system.without(CAGE, FRICTION)
    contacts = balanced.evaluate(q, ball=ball)
    residual = contacts.force + system.stiffness @ q - system.load
    tangent = balanced.stiffness_at(q, contacts) + system.stiffness
    if not system.conservative:
        free_of_stress = contacts.ball.copy()
        free_of_stress[:, 2:4] = system.stress_free_slip(q, free_of_stress)
        contacts = system.without(CAGE).evaluate(q, ball=free_of_stress)
    return _State(residual, tangent, contacts)


def _moved(system: System, tangent: np.ndarray, residual: np.ndarray, held: np.ndarray) -> np.ndarray:
    """dq/dp (5,) from dr/dp at fixed q, and from that of the coordinates that are held."""
    free = system.free > 0.0
    slope = np.where(free, 0.0, held)
    slope[free] = np.linalg.solve(tangent[np.ix_(free, free)], -(residual + tangent @ slope)[free])
    return slope


def _difference_step(system: System, direction: Direction, equilibrium: Equilibrium, base: _State) -> tuple[float, str]:
    """Step of the differences, and a remark where no step is smooth; 0 where the key changes nothing of the statics at all."""
    q, ball, first, value = equilibrium.displacement, equilibrium.ball, direction.first_step, direction.key.value
    neighbour = direction.moved(system, first)
    still = _state(neighbour, q, ball)
    moved = _moved(system, base.tangent, (still.residual - base.residual) / first, direction.guess)
    if not direction.guess.any() and still.same(base):
        return 0.0, ""
    along = _state(neighbour, q + first * moved, ball)
    gap = base.contacts.gap
    room = np.maximum(np.abs(gap), _TOUCHING * np.abs(gap).max())
    rates = [np.abs(state.contacts.gap - gap) / first for state in (still, along)]
    changes = (_change(base, state, system.arm) / first for state in (still, along))
    fastest = max(float((np.maximum(*rates) / room).max()), *changes)
    largest = _LARGEST * abs(value) if value else 1e3 * first
    # Two steps to either side.
    step = min(largest, 0.5 * _MOVED / fastest) if fastest > 0.0 else largest
    least = _ROUGH * largest / _LARGEST
    if step < least:
        return least, _AT_THE_EDGE
    begin, end = system.table_places(q, base.contacts.ball), neighbour.table_places(q + first * moved, along.contacts.ball)
    room = _KNOT * _to_a_knot(begin, end, base.contacts.contact_force) * first
    return min(step, max(room, 10.0 * least)), ""


def _to_a_knot(begin: np.ndarray, end: np.ndarray, force: np.ndarray) -> float:
    """The least distance of a loaded contact to a knot of its tables over the way from begin to end, both (Z,) or (0,)."""
    moves = (force[: len(begin)] > 0.0) & (end != begin)
    shares = np.abs(begin - np.round(begin))[moves] / np.abs(end - begin)[moves]
    return float(shares.min(initial=np.inf))


def _change(base: _State, state: _State, arm: float) -> float:
    """Largest change of the contacts' stiffness over its largest entry, moments made forces."""
    scale = np.outer(*2 * (np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm]),))
    before, after = (scale * state.contacts.stiffness for state in (base, state))
    return float(np.abs(after - before).max() / np.abs(before).max())


def derivative(values: Mapping[int, np.ndarray], step: float) -> np.ndarray:
    """Derivative of arrays that are given at multiples -2, -1, 1, 2 of a step."""
    # In pairs, so that what does not change gives exactly nothing.
    inner, outer = (values[k] - values[-k] for k in (1, 2))
    slope: np.ndarray = (WEIGHTS[1] * inner + WEIGHTS[2] * outer) / step
    return slope
