"""The loop for systems that are stepped from Python, without matrices; equations in ``raceway.core.schemes.explicit``."""

from __future__ import annotations

import numpy as np

from raceway.core.stepping.protocol import State, SteppedSystem
from raceway.core.stepping.recorder import Recorder
from raceway.core.stepping.vectors import finish, predict
from raceway.errors import ConvergenceError, StabilityError


def central_difference(system: SteppedSystem, recorder: Recorder) -> None:
    """Take all steps of the recorder's schedule.

    Raises
    ------
    StabilityError
        A step above the stable limit, with the limit: of the start, or of a later state whose contacts have closed or
        stiffened; or a motion that grows without bound.
    """
    _refuse_long_step(system, recorder)
    guess = np.empty(system.size)
    for step in range(1, recorder.schedule.steps + 1):
        _step(system, recorder, recorder.time_of(step), guess)


def _step(system: SteppedSystem, recorder: Recorder, t: float, guess: np.ndarray) -> None:
    """The step that ends at time t; ``guess`` (size,) is work space."""
    dt, size, threads, before = recorder.schedule.dt, system.size, system.threads, recorder.state
    start = [np.ascontiguousarray(values) for values in (before.u, before.v, before.a)]
    u, v = np.empty(size), np.empty(size)  # v is that at half the step, until ``finish``
    threads.do_shares(size, lambda first, last: predict(first, last, dt, *start, v, u, guess))
    recorder.evaluations += 1
    try:
        internal = system.internal(t, dt, u, guess)
    except ConvergenceError as why:
        raise recorder.stalled([], str(why)) from why
    if system.stiffened():
        _compare(system.stable_step(), system, recorder, f" at t = {t:.6g} s, where contacts have closed or stiffened")
    # The constant damping acts on the velocity of the step's end, contacts that depend on the rate see the guess.
    outer = recorder.load(t)
    a = np.ascontiguousarray(system.accelerations(outer, internal, before.a, 0.5 * dt))
    if not all(threads.do_shares(size, lambda first, last: finish(first, last, dt, a, v))):
        raise recorder.unbounded()
    recorder.accept(State(u, v, a), outer=outer)


def _refuse_long_step(system: SteppedSystem, recorder: Recorder) -> None:
    start, schedule = recorder.state, recorder.schedule
    system.internal(recorder.time_of(0), schedule.dt, start.u, start.v)
    limit = system.stable_step()
    system.rollback()
    _compare(limit, system, recorder, "")


def _compare(limit: float, system: SteppedSystem, recorder: Recorder, where: str) -> None:
    schedule = recorder.schedule
    if schedule.dt >= limit:
        motion = system.motion(recorder.state)
        raise StabilityError(
            f"`integrator.steps_per_turn` = {schedule.steps_per_turn} makes a step of {schedule.dt:.4g} s, above the stable "
            f"limit of central differences, {limit:.4g} s{where}. Take at least "
            f"{int(schedule.steps_per_turn * schedule.dt / (0.8 * limit)) + 1}.",
            {"q": motion.q, "ball": motion.ball},
        )
