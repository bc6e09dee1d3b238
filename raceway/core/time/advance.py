"""Steps of a compiled ring, in chunks, and what a run that ends early leaves."""

from contextlib import suppress
from typing import Any

import numpy as np

from raceway.core.jit import Kernel
from raceway.core.record import Motion, OnChunk, Record, Schedule, check_start
from raceway.core.recorder import unbounded
from raceway.core.ring.system import System
from raceway.core.signatures import Outer, Recording, State, Steps
from raceway.core.time import compiled
from raceway.errors import ConvergenceError, RacewayError

#: Steps after which progress is reported.
_CHUNK = 20_000


def advance(
    loop: Kernel,
    system: System,
    start: Motion,
    schedule: Schedule,
    coefficients: np.ndarray,
    on_chunk: OnChunk | None = None,
) -> Record:
    """Take all steps of a schedule.

    loop : kernel with the signature ``raceway.core.signatures.LOOP``;  coefficients : (k,) the method's own numbers

    ConvergenceError, StabilityError: With the reason, the time and the last good motion in ``state``.
    """
    check_start(system, start)
    z = system.ball_count
    rows = np.zeros((schedule.steps // schedule.stride, 16))
    probes = np.zeros((len(rows), 2 + system.ball_columns // 2, 2 * z))
    counters = np.zeros(compiled.COUNTERS)
    motion = np.zeros((4, 5))
    motion[0], motion[1], motion[2] = start.q, start.v, start.a
    motion[3] = -system.mass @ start.a if start.net_force is None else start.net_force
    ball, before, memory = start.ball.copy(), start.ball_before.copy(), system.law_state.copy()
    if start.memory is not None:
        memory[:] = start.memory
    state, recording = State(motion, ball, before, memory), Recording(schedule.stride, rows, probes, counters)
    step, last = schedule.first, schedule.first + schedule.steps
    # A speed that changes is another one in every step, which ends at its time.
    longest = _CHUNK if system.spin is None else 1
    while step < last:
        count = min(longest, last - step)
        now = system.at_speed((step + count) * schedule.dt)
        outer, steps = Outer(now.force, now.force_params, schedule.ramp), Steps(schedule.dt, step, count)
        count_taken = loop(now.compiled_forces, now.linear, outer, coefficients, steps, state, recording)
        step += count_taken
        if count_taken < count:
            raise _failure(system, schedule, step, motion, ball, counters, loop is compiled.central_difference)
        if on_chunk is not None and (longest == _CHUNK or step == last or step % _CHUNK == 0):
            try:
                on_chunk(step - schedule.first, schedule.steps)
            except RacewayError as why:
                why.state = {**_state(schedule, step, motion, ball), **why.state}
                raise
    final = Motion(motion[0].copy(), motion[1].copy(), motion[2].copy(), ball, before, motion[3].copy(), memory)
    return _record(recording, schedule, final)


def _record(recording: Recording, schedule: Schedule, final: Motion) -> Record:
    counters = recording.counters
    count = int(counters[compiled.ROWS])
    rows, probes = recording.rows[:count], recording.probes[:count]
    return Record(
        time=rows[:, 0],
        displacement=rows[:, 1:6],
        velocity=rows[:, 6:11],
        force=rows[:, 11:16],
        gap=probes[:, 0],
        contact_force=probes[:, 1],
        ball=probes[:, 2:].reshape(count, *final.ball.shape),
        final=final,
        schedule=schedule,
        counts={
            "steps": schedule.steps,
            "evaluations": int(counters[compiled.EVALUATIONS]),
            "max_penetration_m": float(counters[compiled.PENETRATION]),
            "peak_contact_force_n": float(counters[compiled.CONTACT_FORCE]),
        },
    )


def _state(schedule: Schedule, step: int, motion: np.ndarray, ball: np.ndarray) -> dict[str, Any]:
    """What a run that ends early leaves, by name."""
    q, v, a = motion[:3].copy()
    return {"t": step * schedule.dt, "q": q, "v": v, "a": a, "ball": ball.copy()}


def _failure(
    system: System, schedule: Schedule, step: int, motion: np.ndarray, ball: np.ndarray, counters: np.ndarray, explicit: bool
) -> ConvergenceError:
    when, state = schedule.when(step - schedule.first), _state(schedule, step, motion, ball)
    reason, limit = counters[compiled.REASON], 0.0
    if np.isfinite(motion).all() and (reason == compiled.UNBOUNDED or explicit):
        with suppress(ConvergenceError):
            now = system.evaluate(motion[0])
            limit = system.damped_time_step(now.stiffness, now.damping)
    # Balls lose their equilibrium where explicit steps beyond their limit have thrown the ring.
    if reason == compiled.UNBOUNDED or 0.0 < limit < schedule.dt:
        return unbounded(schedule, when, limit, state)
    if reason == compiled.BALLS:
        return ConvergenceError(f"the balls have no equilibrium between the races {when}", state)
    residual = counters[compiled.RESIDUAL]
    remainder = f"residual {residual:.3g} N" if np.isfinite(residual) else "forces beyond all numbers"
    words = f"the iteration of a step did not converge {when}, {remainder}. Use more `integrator.steps_per_turn`."
    return ConvergenceError(words, state)
