"""Equilibrium of elastic bodies in contact: Newton's method on the active set, with a line search and load steps."""

from collections.abc import Callable
from typing import Protocol, TypeVar

import attrs
import numpy as np

from raceway.core.fem.elastic.contact import Contact
from raceway.errors import ConvergenceError

T = TypeVar("T")


class StaticSystem(Protocol):
    """What an equilibrium needs of elastic bodies: ``raceway.core.fem.elastic.bearing.ElasticSystem``."""

    load: np.ndarray
    on_residual: Callable[[float], None] | None

    @property
    def contact(self) -> Contact | None: ...
    @property
    def smooth(self) -> bool: ...
    @property
    def linear_iterations(self) -> int: ...
    def undeformed(self, y: np.ndarray) -> bool: ...
    def locate(self, y: np.ndarray) -> bool: ...
    def static_internal(self, y: np.ndarray, share: float = 0.0) -> np.ndarray: ...
    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float = ...) -> np.ndarray: ...
    def force_scale(self) -> float: ...
    def measure(self, r: np.ndarray) -> float: ...


#: Trials of one search, and the slope of the potential over that at its start at which it ends.
_TRIALS, _FLAT = 12, 0.9


def searched(slope: float, at: Callable[[float], tuple[T, float, bool]]) -> T:
    """The state at the part of a step that the search ends with.

    slope : of the potential at the step's start, downwards: step . unbalanced forces
    at : function of the part of the step -> the state there, its slope, and whether its forces balance well enough

    -phi'(s) = step . rest falls from one side of the minimum to the other by as much as points that close are stiffer than the
    bodies.  The minimum is bracketed between the longest part s that falls short of it and the shortest one beyond: a part that is
    only cut, and never lengthened, stops short of where points close, in this iteration and in all that follow.
    """
    part, short, beyond, at_short, at_beyond = 1.0, 0.0, np.inf, slope, 0.0
    for _ in range(_TRIALS):
        state, now, enough = at(part)
        if abs(now) <= _FLAT * abs(slope) or enough or now > 0.0 and np.isinf(beyond):
            break
        if now > 0.0:
            short, at_short = part, now
        else:
            beyond, at_beyond = part, now
        # The secant, but well inside: one end may stay for long where the slope bends.
        part = short + (beyond - short) * min(max(at_short / (at_short - at_beyond), 0.1), 0.9)
    return state


#: Iterations of one load step, smallest part of the load.
NEWTON_LIMIT, _SMALLEST_PART = 40, 1.0 / 16.0
#: Residual over the forces that balance, and the linear solves' share of it: early ones need not be exact.
TOLERANCE, FIRST, LOOSE, TIGHT = 1e-6, 1e-2, 1e-1, 1e-4


@attrs.frozen(eq=False)
class StaticSolution:
    """An equilibrium."""

    y: np.ndarray  # (size,) unknowns
    iterations: int  # of Newton
    linear_iterations: int  # of all linear solves
    residuals: list[float]  # relative residuals, in order


def solve_equilibrium(system: StaticSystem, guess: np.ndarray, tolerance: float = TOLERANCE) -> StaticSolution:
    """The state at which contact forces and elasticity balance ``system.load``, near a guess (size,).

    ConvergenceError: Nothing found; ``state`` holds the last good state ``y``, the part of the load that it carries, and ``residuals``.
    """
    load = system.load.copy()
    history: list[float] = []
    # Points of an overlap that nothing has deformed yet: see ``Contact.evaluate``.  From an equilibrium the same choice would leave
    # balls on two points, and no curvature to hold them across the grooves: the tangent is then singular.
    share = 0.5 if system.undeformed(guess) else 0.0
    good, part, step, count, before = guess.copy(), 0.0, 1.0, 0, system.linear_iterations
    try:
        while True:
            goal = min(1.0, part + step)
            system.load = goal * load
            try:
                y, used = _newton(system, good, tolerance, history, share if part == 0.0 else 0.0)
            except ConvergenceError as why:
                step *= 0.5
                if step < _SMALLEST_PART:
                    raise ConvergenceError(
                        f"no equilibrium: {why} Last good state: {100 * part:.3g} % of the load, {len(history)} iterations in all. "
                        "Take a softer penalty (`contact.stiffness`), a finer mesh at the contacts, or a smaller load.",
                        {"y": good, "load_part": part, "residuals": history},
                    ) from why
                continue
            good, part, count = y, goal, count + used
            if goal >= 1.0:
                try:
                    if system.contact is not None:
                        system.contact.refuse()
                except ConvergenceError as why:
                    raise ConvergenceError(str(why), {"y": y, "load_part": 1.0, "residuals": history}) from why
                return StaticSolution(y, count, system.linear_iterations - before, history)
    finally:
        system.load = load


def _newton(
    system: StaticSystem, guess: np.ndarray, tolerance: float, history: list[float], share: float
) -> tuple[np.ndarray, int]:
    y = guess.copy()
    system.locate(y)
    residual = system.load - system.static_internal(y, share)
    forcing, previous = FIRST, np.inf
    for iteration in range(NEWTON_LIMIT):
        scale = system.force_scale()
        size = system.measure(residual)
        relative = size / scale if scale > 0.0 else np.inf
        history.append(float(relative))
        if system.on_residual is not None:
            system.on_residual(float(relative))
        if not np.isfinite(size):
            raise ConvergenceError("forces are not finite.")
        if relative <= tolerance and (iteration > 0 or share == 0.0):
            return y, iteration
        if iteration > 0:
            forcing = min(LOOSE, max(TIGHT, 0.3 * size / previous, 0.3 * tolerance / relative))
        previous = size
        if system.smooth:
            y = y + system.solve(1.0, 0.0, 0.0, residual)
            system.locate(y)
            residual = system.load - system.static_internal(y)
            continue
        step = system.solve(1.0, 0.0, 0.0, residual, tolerance=forcing)
        y, residual = _along(system, y, step, residual, tolerance * scale)
        if system.locate(y):
            residual = system.load - system.static_internal(y)
    raise ConvergenceError(f"Newton's residual stands at {history[-1]:.1e} of the load after {NEWTON_LIMIT} iterations.")


def _along(
    system: StaticSystem, y: np.ndarray, step: np.ndarray, residual: np.ndarray, enough: float
) -> tuple[np.ndarray, np.ndarray]:
    """State along a step (size,), and the residual there."""

    def at(part: float) -> tuple[tuple[np.ndarray, np.ndarray], float, bool]:
        trial = y + part * step
        remaining = system.load - system.static_internal(trial)
        return (trial, remaining), float(step @ remaining), bool(system.measure(remaining) <= enough)

    return searched(float(step @ residual), at)
