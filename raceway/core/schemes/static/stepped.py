"""The loop for systems that are stepped from Python; equations in ``raceway.core.schemes.static``."""

from __future__ import annotations

import numpy as np

from raceway.core.schemes.one_step.stepped import HALVINGS, NEWTON_LIMIT, NOTHING, PATIENCE
from raceway.core.stepping.protocol import State, SteppedSystem
from raceway.core.stepping.recorder import BOUND, Recorder
from raceway.errors import ConvergenceError


def quasi_static(system: SteppedSystem, recorder: Recorder, tolerance: float) -> None:
    """Take all steps of the recorder's schedule.

    Notes
    -----
    Each step starts from the last two equilibria, extrapolated; ``State.v`` is not a velocity here but the change over
    the last step.
    """
    nothing = np.zeros(system.size)
    for step in range(1, recorder.schedule.steps + 1):
        before = recorder.state
        u, rest = equilibrium(system, recorder, recorder.time_of(step), before.u + before.v, tolerance)
        recorder.accept(State(u, u - before.u, nothing, rest), velocity=nothing)


def equilibrium(
    system: SteppedSystem, recorder: Recorder, t: float, u: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (size,) at which the forces at time t balance, and what is left of them: Newton with halved steps."""
    still, outer = np.zeros_like(u), recorder.load(t)
    load = system.measure(outer)
    history: list[float] = []
    norm_before, halvings, du = np.inf, 0, np.zeros_like(u)
    for _ in range(NEWTON_LIMIT):
        recorder.evaluations += 1
        try:
            rest = system.internal(t, 0.0, u, still) - outer
        except ConvergenceError as why:
            raise recorder.stalled(history, str(why)) from why
        norm = system.measure(rest)
        history.append(norm)
        if not np.isfinite(norm) or np.abs(u).max() >= BOUND:
            raise recorder.unbounded()
        if norm <= tolerance * max(system.contacts()[2], load) + NOTHING:
            return u, rest
        if norm > (1.5 if len(history) < PATIENCE else 0.999) * norm_before and halvings < HALVINGS:
            halvings += 1
            du *= 0.5
            u = u - du
            continue
        halvings, norm_before = 0, norm
        du = system.solve(1.0, 0.0, 0.0, -rest)
        u = u + du
    raise recorder.stalled(history)
