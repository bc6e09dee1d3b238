"""Derivatives of an equilibrium by a continuous key.

Notes
-----
At the equilibrium r(q, p) = f(q, p) + K_s q - F(p) = 0 with the exact tangent T = dr/dq, the balls condensed.  Hence
dq/dp = -T^-1 dr/dp, dr/dp at fixed q along the derivatives of the model's arrays (``variation``).  Stiffness, damping and forces of the contacts are then differentiated along that line:
dK/dp = d/dh K(q + h dq/dp, p + h).  Differences are central and of fourth order; their step moves no gap and no
stiffness by more than ``_MOVED`` of itself, so that the error stays below 1e-7 of the derivative.  Coordinates that are held move with what
holds them (``supports.axial`` = "displacement").
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.ring.kernels.layout import CAGE, FRICTION
from raceway.core.ring.ring import Evaluation
from raceway.core.ring.surrogate import surrogate
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError
from raceway.pipeline.gradient.differences import WEIGHTS, derivative
from raceway.pipeline.gradient.variation import Direction, NoDerivative, direction_of
from raceway.scene.continuous import Key

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

    def same(self, other: _State) -> bool:
        """Whether nothing differs, to the last bit."""
        pairs = [(self.residual, other.residual), (self.tangent, other.tangent)]
        names = ("stiffness", "damping", "contact_force", "gap")
        pairs += [(getattr(self.contacts, name), getattr(other.contacts, name)) for name in names]
        return all(np.array_equal(one, two) for one, two in pairs)


def static_gradient(model: Model, equilibrium: Equilibrium, key: Key) -> StaticGradient:
    """Derivatives of an equilibrium by one key.

    Raises
    ------
    NoDerivative
        There is none, with the reason.
    """
    direction = direction_of(model, key)
    try:
        return _gradient(model, direction, equilibrium)
    except ConvergenceError as why:
        raise NoDerivative(f"the neighbouring states have no balance: {why}") from None


def _gradient(model: Model, direction: Direction, equilibrium: Equilibrium) -> StaticGradient:
    system, q, ball = surrogate(model.system), equilibrium.displacement, equilibrium.ball
    here = _state(system, q, ball)
    step, remark = _difference_step(system, direction, equilibrium, here) if direction.at_rest else (0.0, "")
    if step == 0.0:
        size = len(here.contacts.contact_force)
        nothing = np.zeros(5), np.zeros((5, 5)), np.zeros((5, 5)), np.zeros(size)
        return StaticGradient(direction, 0.0, *nothing, "")
    systems = {k: direction.moved(system, k * step) for k in WEIGHTS}
    residual = derivative({k: _state(one, q, ball).residual for k, one in systems.items()}, step)
    moved = _moved(system, here.tangent, residual, direction.guess)
    states = {k: _state(one, q + k * step * moved, ball).contacts for k, one in systems.items()}
    loaded = here.contacts.contact_force > 0.0
    if any(((one.contact_force > 0.0) != loaded).any() for one in states.values()):
        remark = _AT_THE_EDGE
    stiffness, damping = {}, {}
    for k, one in states.items():
        still, place = systems[k].without(CAGE), q + k * step * moved
        held = still.stiffness_at(place, one), still.damping_at(place, one)
        stiffness[k], damping[k] = still.rows_following(place, one, *held)
    slope = derivative(stiffness, step)
    rounding = _ROUNDING * np.abs(stiffness[1]).max() / step
    bent = np.abs((stiffness[1] - stiffness[-1]) / (2.0 * step) - slope).max()
    if not remark and (direction.bends or bent > _BENT * np.abs(slope).max() + rounding):
        remark = _BENDS
    force = derivative({k: one.contact_force for k, one in states.items()}, step)
    return StaticGradient(direction, step, moved, slope, derivative(damping, step), force, remark)


def _state(system: System, q: np.ndarray, ball: np.ndarray) -> _State:
    """As ``raceway.pipeline.settle`` evaluates it: the balance without friction, then slips at which no contact sticks."""
    balanced = system.without(CAGE, FRICTION)
    now = balanced.evaluate(q, ball=ball)
    residual = now.force + system.stiffness @ q - system.load
    tangent = balanced.stiffness_at(q, now) + system.stiffness
    if not system.conservative:
        place = now.ball.copy()
        place[:, 2:4] = system.stress_free_slip(q, place)
        now = system.without(CAGE).evaluate(q, ball=place)
    return _State(residual, tangent, now)


def _moved(system: System, tangent: np.ndarray, residual: np.ndarray, held: np.ndarray) -> np.ndarray:
    """dq/dp (5,) from dr/dp at fixed q, and from that of the coordinates that are held."""
    free = system.free > 0.0
    found = np.where(free, 0.0, held)
    found[free] = np.linalg.solve(tangent[np.ix_(free, free)], -(residual + tangent @ found)[free])
    return found


def _difference_step(system: System, direction: Direction, equilibrium: Equilibrium, here: _State) -> tuple[float, str]:
    """Step of the differences, and a remark where no step is smooth; 0 where the key changes nothing of the statics at all."""
    q, ball, tried, value = equilibrium.displacement, equilibrium.ball, direction.tried, direction.key.value
    one = direction.moved(system, tried)
    still = _state(one, q, ball)
    moved = _moved(system, here.tangent, (still.residual - here.residual) / tried, direction.guess)
    if not direction.guess.any() and still.same(here):
        return 0.0, ""
    along = _state(one, q + tried * moved, ball)
    gap = here.contacts.gap
    room = np.maximum(np.abs(gap), _TOUCHING * np.abs(gap).max())
    rates = [np.abs(each.contacts.gap - gap) / tried for each in (still, along)]
    fastest = max(
        float((np.maximum(*rates) / room).max()), *(_change(here, each, system.arm) / tried for each in (still, along))
    )
    largest = _LARGEST * abs(value) if value else 1e3 * tried
    # Two steps to either side.
    step = min(largest, 0.5 * _MOVED / fastest) if fastest > 0.0 else largest
    least = _ROUGH * largest / _LARGEST
    if step < least:
        return least, _AT_THE_EDGE
    place, next_place = system.table_places(q, here.contacts.ball), one.table_places(q + tried * moved, along.contacts.ball)
    room = _KNOT * _to_a_knot(place, next_place, here.contacts.contact_force) * tried
    return min(step, max(room, 10.0 * least)), ""


def _to_a_knot(here: np.ndarray, there: np.ndarray, force: np.ndarray) -> float:
    """The least distance of a loaded contact to a knot of its tables over the way from here to there, both (Z,) or (0,)."""
    moves = (force[: len(here)] > 0.0) & (there != here)
    left = np.abs(here - np.round(here))[moves] / np.abs(there - here)[moves]
    return float(left.min(initial=np.inf))


def _change(one: _State, two: _State, arm: float) -> float:
    """Largest change of the contacts' stiffness over its largest entry, moments made forces."""
    scale = np.outer(*2 * (np.array([1.0, 1.0, 1.0, 1.0 / arm, 1.0 / arm]),))
    before, after = (scale * state.contacts.stiffness for state in (one, two))
    return float(np.abs(after - before).max() / np.abs(before).max())
