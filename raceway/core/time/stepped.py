"""The loop for systems that are stepped from Python; equations in ``raceway.core.time``."""

from collections import deque

import numpy as np

from raceway.core.record import State, SteppedSystem, finish, predict
from raceway.core.recorder import BOUND, Recorder
from raceway.errors import ConvergenceError, StabilityError

#: alpha_m, alpha_f, beta, gamma.
Numbers = tuple[float, float, float, float]
NEWTON_LIMIT = 40
HALVINGS = 8
#: Iterations after which a step that does not shrink the residual is shortened too: contacts may change to and fro.
PATIENCE = 10
#: A force that is none [N]: a motion that has died out is not resolved further.
NOTHING = 1e-30
#: Where explicit steps may have become too long.
CLOSED = "where contacts have closed or stiffened"


def implicit(system: SteppedSystem, recorder: Recorder, numbers: Numbers, tolerance: float) -> None:
    """Take all steps of the recorder's schedule."""
    before: deque[np.ndarray] = deque(maxlen=3)
    constant, excitation = system.external(0.0, 0.0), 0.0
    for step in range(1, recorder.schedule.steps + 1):
        before.append(recorder.state.u)
        start = 3.0 * (before[2] - before[1]) + before[0] if system.smooth and len(before) == 3 else None
        outer = recorder.load(recorder.time_of(step))
        excitation = max(excitation, system.measure(outer - constant))
        state = _implicit_step(recorder, recorder.time_of(step), outer, excitation, numbers, tolerance, start)
        recorder.accept(state, outer=outer)


def _implicit_step(
    recorder: Recorder, t: float, outer: np.ndarray, excitation: float, numbers: Numbers, tolerance: float,
    start: np.ndarray | None,
) -> State:  # fmt: skip
    """The state at time t, one step on.

    outer : (size,) outer forces at t;  excitation : largest so far [N]
    start : where Newton's method begins; None: at constant acceleration
    """
    am, af, beta, gamma = numbers
    system, before, dt = recorder.system, recorder.state, recorder.schedule.dt
    net_force_before = -system.mass_times(before.a) if before.net_force is None else before.net_force
    to_a, to_v = 1.0 / (beta * dt * dt), gamma / (beta * dt)
    prediction = before.u + dt * before.v + dt * dt * (0.5 - beta) * before.a
    u = before.u + dt * before.v + 0.5 * dt * dt * before.a if start is None else start
    load = system.measure(outer)
    history: list[float] = []
    norm_before, halvings, du = np.inf, 0, np.zeros_like(u)
    for _ in range(NEWTON_LIMIT):
        a = (u - prediction) * to_a
        v = before.v + dt * ((1.0 - gamma) * before.a + gamma * a)
        recorder.evaluations += 1
        try:
            net_force = system.internal(t, dt, u, v) - outer
        except ConvergenceError as why:
            raise recorder.stalled(history, str(why)) from why
        inertia = system.mass_times((1.0 - am) * a + am * before.a)
        residual = inertia + (1.0 - af) * net_force + af * net_force_before
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
            return State(u, v, a, net_force)
        if norm > (2.0 if len(history) < PATIENCE else 0.999) * norm_before and halvings < HALVINGS:
            halvings += 1
            du *= 0.5
            u = u - du
            continue
        halvings, norm_before = 0, norm
        du = system.solve(1.0 - af, (1.0 - af) * to_v, (1.0 - am) * to_a, -residual)
        u = u + du
    raise recorder.stalled(history)


def central_difference(system: SteppedSystem, recorder: Recorder, device: str = "cpu") -> None:
    """Take all steps of the recorder's schedule; ``device``: see ``SteppedSystem``.

    StabilityError: A step above the stable limit, with the limit: of the start, or of a later state whose contacts have closed or
        stiffened; or a motion that grows without bound.
    """
    start, schedule = recorder.state, recorder.schedule
    system.internal(recorder.time_of(0), schedule.dt, start.u, start.v)
    limit = system.stable_step()
    system.rollback()
    compare(limit, system, recorder, "")
    ahead, steps = system.explicit(schedule.dt, device), schedule.steps
    recorder.device = "cpu" if ahead is None else ahead.device
    while ahead is not None and recorder.done < steps:
        count = min(steps - recorder.done, schedule.stride - (schedule.first + recorder.done) % schedule.stride, ahead.most)
        recorder.evaluations += count
        recorder.accept_steps(count, *ahead.take(recorder, count))
    guess = np.empty(system.size)
    for step in range(recorder.done + 1, steps + 1):
        _explicit_step(system, recorder, recorder.time_of(step), guess)


def _explicit_step(system: SteppedSystem, recorder: Recorder, t: float, guess: np.ndarray) -> None:
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
        compare(system.stable_step(), system, recorder, f" at t = {t:.6g} s, {CLOSED}")
    # The constant damping acts on the velocity of the step's end, contacts that depend on the rate see the guess.
    outer = recorder.load(t)
    a = np.ascontiguousarray(system.accelerations(outer, internal, before.a, 0.5 * dt))
    if not all(threads.do_shares(size, lambda first, last: finish(first, last, dt, a, v))):
        raise recorder.unbounded()
    recorder.accept(State(u, v, a), outer=outer)


def compare(limit: float, system: SteppedSystem, recorder: Recorder, where: str) -> None:
    """StabilityError: steps of the recorder above the limit [s]."""
    schedule = recorder.schedule
    if schedule.dt >= limit:
        motion = system.motion(recorder.state)
        step = f"`integrator.steps_per_turn` = {schedule.steps_per_turn} makes a step of {schedule.dt:.4g} s"
        least = int(schedule.steps_per_turn * schedule.dt / (0.8 * limit)) + 1
        why = f"{step}, above the stable limit of central differences, {limit:.4g} s{where}. Use at least {least}."
        raise StabilityError(why, {"q": motion.q, "ball": motion.ball})


def quasi_static(system: SteppedSystem, recorder: Recorder, tolerance: float) -> None:
    """Take all steps of the recorder's schedule.

    Each step starts from the last two equilibria, extrapolated; ``State.v`` is not a velocity here but the change over
    the last step.
    """
    nothing = np.zeros(system.size)
    for step in range(1, recorder.schedule.steps + 1):
        before = recorder.state
        u, net_force = equilibrium(system, recorder, recorder.time_of(step), before.u + before.v, tolerance)
        recorder.accept(State(u, u - before.u, nothing, net_force), velocity=nothing)


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
            net_force = system.internal(t, 0.0, u, still) - outer
        except ConvergenceError as why:
            raise recorder.stalled(history, str(why)) from why
        norm = system.measure(net_force)
        history.append(norm)
        if not np.isfinite(norm) or np.abs(u).max() >= BOUND:
            raise recorder.unbounded()
        if norm <= tolerance * max(system.contacts()[2], load) + NOTHING:
            return u, net_force
        if norm > (1.5 if len(history) < PATIENCE else 0.999) * norm_before and halvings < HALVINGS:
            halvings += 1
            du *= 0.5
            u = u - du
            continue
        halvings, norm_before = 0, norm
        du = system.solve(1.0, 0.0, 0.0, -net_force)
        u = u + du
    raise recorder.stalled(history)
