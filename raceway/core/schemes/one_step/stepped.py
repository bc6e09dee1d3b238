"""The loop for systems that are stepped from Python; equations in ``raceway.core.schemes.one_step``."""

from __future__ import annotations

from collections import deque

import numpy as np

from raceway.core.stepping.protocol import State, SteppedSystem
from raceway.core.stepping.recorder import Recorder
from raceway.errors import ConvergenceError

#: alpha_m, alpha_f, beta, gamma.
Numbers = tuple[float, float, float, float]
NEWTON_LIMIT = 40
HALVINGS = 8
#: Iterations after which a step that does not shrink the residual is shortened too: contacts may change to and fro.
PATIENCE = 10
#: A force that is none [N]: a motion that has died out is not resolved further.
NOTHING = 1e-30


def implicit(system: SteppedSystem, recorder: Recorder, numbers: Numbers, tolerance: float) -> None:
    """Take all steps of the recorder's schedule."""
    before: deque[np.ndarray] = deque(maxlen=3)
    constant, excitation = system.external(0.0, 0.0), 0.0
    for step in range(1, recorder.schedule.steps + 1):
        before.append(recorder.state.u)
        start = 3.0 * (before[2] - before[1]) + before[0] if system.smooth and len(before) == 3 else None
        outer = recorder.load(recorder.time_of(step))
        excitation = max(excitation, system.measure(outer - constant))
        recorder.accept(
            _step(system, recorder, recorder.time_of(step), outer, excitation, numbers, tolerance, start), outer=outer
        )


def _step(
    system: SteppedSystem,
    recorder: Recorder,
    t: float,
    outer: np.ndarray,
    excitation: float,
    numbers: Numbers,
    tolerance: float,
    start: np.ndarray | None,
) -> State:
    """The state at time t, one step on.

    Parameters
    ----------
    outer : (size,) outer forces at t;  excitation : largest so far [N]
    start : where Newton's method begins; None: at constant acceleration
    """
    am, af, beta, gamma = numbers
    before, dt = recorder.state, recorder.schedule.dt
    rest_before = -system.mass_times(before.a) if before.rest is None else before.rest
    to_a, to_v = 1.0 / (beta * dt * dt), gamma / (beta * dt)
    predicted = before.u + dt * before.v + dt * dt * (0.5 - beta) * before.a
    u = before.u + dt * before.v + 0.5 * dt * dt * before.a if start is None else start
    load = system.measure(outer)
    history: list[float] = []
    norm_before, halvings, du = np.inf, 0, np.zeros_like(u)
    for _ in range(NEWTON_LIMIT):
        a = (u - predicted) * to_a
        v = before.v + dt * ((1.0 - gamma) * before.a + gamma * a)
        recorder.evaluations += 1
        try:
            rest = system.internal(t, dt, u, v) - outer
        except ConvergenceError as why:
            raise recorder.stalled(history, str(why)) from why
        inertia = system.mass_times((1.0 - am) * a + am * before.a)
        residual = inertia + (1.0 - af) * rest + af * rest_before
        norm = system.measure(residual)
        history.append(norm)
        if not np.isfinite(norm):
            raise recorder.unbounded()
        # Below the rounding of the inertia forces nothing can be asked.
        rounding = 1e-6 * to_a * system.measure(system.mass_times(np.abs(u)))
        moving = max(system.measure(inertia), rounding)
        largest = max(system.contacts()[2], load, moving)
        # As in the compiled loop: what no longer shrinks is rounding, and is measured by the largest force of all.
        if norm <= tolerance * max(excitation, moving) + NOTHING or 0.5 * norm_before < norm <= tolerance * largest:
            return State(u, v, a, rest)
        if norm > (2.0 if len(history) < PATIENCE else 0.999) * norm_before and halvings < HALVINGS:
            halvings += 1
            du *= 0.5
            u = u - du
            continue
        halvings, norm_before = 0, norm
        du = system.solve(1.0 - af, (1.0 - af) * to_v, (1.0 - am) * to_a, -residual)
        u = u + du
    raise recorder.stalled(history)
