"""Motions at their edges: steps around the stable limit, orbits at it, and energy over a million steps, in impacts, deep
penetrations and chatter, which conserves too well.
"""

from functools import partial
from math import ceil, pi, sqrt
from typing import Any

import attrs
import numpy as np

from raceway import ConvergenceError
from raceway.extend import (
    SAFETY, Integrator, Motion, Record, Schedule, System, Tables, at_time, energy_balance, from_orbit, impact_system,
    integrate, solve_equilibrium, steady_orbit, surrogate,
)  # fmt: skip
from raceway_checks.stability.catalogue import UNDAMPED
from raceway_checks.stability.study import Limit, Rows
from raceway_checks.stability.systems import Bench, Still, energy_of_contacts, inverted

_BLOCKS = 20
#: Heights of the fall that chatter is looked for at, over the approach at rest.
_HEIGHTS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
#: Departure of the contact force from the load, over it, of a mass at rest.
_AT_REST = 1e-3
#: Every so many steps are recorded: no divisor of a million's blocks that a period could meet.
_STRIDE = 10
#: Parts of the predicted limit.
_FACTORS = (0.5, 0.9, 0.98, 1.02, 1.1)
_STEPS, _TURNS = 400, 50
#: Perturbation over the axial approach: small enough to be linear, far above the tolerance of implicit steps (1e-9).
_SMALL = 1e-6
#: Growth of a bounded motion, and of one that grows.
_BOUNDED, _GROWING = 20.0, 1e3
_SWINGS = "at 0.98 of the limit a bounded motion reaches 1 / sqrt(1 - 0.98^2) = 5 times its start, and modes add up"
_GROWS = "1.49 a step at 1.02 of the limit; a nonlinear contact stops the growth where it opens"


def many_steps(rows: Rows, bench: Bench, integrator: str, steps: int, factor: float, amplitude: float) -> None:
    """Undamped free motion; the trend of the energy's block means over the motion's energy."""
    at = bench.over(UNDAMPED).still()
    opens = amplitude > 1.0
    # Steps of an implicit method are solved as far as rounding allows: 1e-9 of the load a step adds up to 1e-5 of a small motion's
    # energy in a million steps.  Where contacts open, rounding ends some iterations above so small a tolerance.
    method = bench.method(integrator, None if opens else 1e-12)
    loses = method.dissipative or at.dissipative
    schedule = Schedule(factor * at.limit, steps // _BLOCKS, _BLOCKS, _STRIDE)
    record = integrate(method, at.system, at.displaced(at.direction(amplitude)), schedule)
    really = bool((record.contact_force <= 0.0).any())
    if really != opens:
        raise ConvergenceError("contacts open or stay closed, unlike what this case is for: change its amplitude")
    slope, worst = _trend(at, record)
    if opens:
        bound, why = 1e-3, "where contacts open the force is not smooth, and the near energy is conserved to some order only"
    elif loses:
        bound, why = 1e-6, "a dissipative method or law may lose energy, not gain it"
    else:
        bound, why = 1e-6, "a symplectic method conserves a near energy: its blocks' means stay, less rounding"
    words = "trend of the energy's block means over the motion's energy"
    note = "contacts open" if really else "all contacts stay closed"
    value = (slope if loses else abs(slope), worst)
    rows.check(words, value, why, Limit.at_most(bound), at={"steps": steps, "step/limit": factor}, note=note)


def _trend(at: Still, record: Record) -> tuple[float, float]:
    """Slope of the block means over the whole run, and the largest departure of one, over the motion's energy."""
    balance = energy_balance(at.system, record)
    energy = balance.kinetic + balance.stored
    motionless = at.displaced(np.zeros(5))
    resting = attrs.evolve(
        record, **{name: getattr(record, name)[:2] for name in ("time", "velocity", "force")},
        displacement=np.tile(motionless.q, (2, 1)), gap=np.tile(at.equilibrium.gap, (2, 1)),
        contact_force=np.tile(at.equilibrium.contact_force, (2, 1)), ball=np.tile(motionless.ball, (2, 1, 1)),
    )  # fmt: skip
    size = energy[0] - energy_balance(at.system, resting).stored[0]
    blocks = energy.reshape(_BLOCKS, -1)
    # Whole swings do not fit a block: a window that fades out keeps their remainder out of the mean.
    window = np.hanning(blocks.shape[1])
    means = blocks @ window / window.sum()
    slope = float(np.polyfit(np.arange(_BLOCKS), means, 1)[0]) * _BLOCKS
    return slope / size, float(np.abs(means - means[0]).max() / size)


def _mass_at(position: float, speed: float = 0.0, acceleration: float = 0.0) -> Motion:
    """The motion of one mass on one contact, along x."""
    x = np.eye(5)[0]
    return Motion(position * x, speed * x, acceleration * x, np.zeros((1, 2)), np.zeros((1, 2)))


def impact(rows: Rows, bench: Bench, integrator: str, speed: float, steps: int) -> None:
    """A mass meets a contact: its greatest force and the speed that it leaves with.

    What is expected follows from the energy that the law stores; of a law that loses some, from the differential equation with
    the law's own force, solved by scipy.
    """
    at = bench.still()
    law, params, mass = at.system.law, at.system.law_params[:1], 2.0
    pair, memory = np.ascontiguousarray(np.repeat(params, 2, axis=0)), np.zeros((2, 0))
    depth = inverted(lambda d: float(energy_of_contacts(law, pair, memory, np.full(2, -d))[0]), 0.5 * mass * speed**2, 1.0)
    system, method = impact_system(mass, law, params), bench.method(integrator)
    force, rebound = _force(system, depth), speed
    if at.dissipative:
        # Greatest force [N] and speed of the rebound [m/s] of a law that depends on the rate
        from scipy.integrate import solve_ivp

        def leaves(_: float, y: np.ndarray) -> float:
            return float(y[0])

        leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
        # The unit of length is the depth, so that both unknowns are of the size of 1.
        span = 10.0 * pi * depth / speed
        solution = solve_ivp(
            lambda _, y: [y[1] * speed / depth, -_force(system, y[0] * depth, y[1] * speed) / (mass * speed)], (0.0, span), [0.0, 1.0],
            events=leaves, rtol=1e-9, atol=1e-12, max_step=0.01 * depth / speed,
        )  # fmt: skip
        force = max(_force(system, x * depth, v * speed) for x, v in solution.y.T)
        rebound = -float(solution.y[1, -1]) * speed
    dt = pi * depth / speed / steps
    record = integrate(method, system, _mass_at(-0.4 * dt * speed, speed), Schedule(dt, 2 * steps, 1))
    departure = -float(record.velocity[-1, 0])
    energy = (departure / rebound) ** 2 - 1.0
    setting = {"speed [m/s]": speed, "steps a contact": steps}
    why = "one step lies up to a hundredth of the contact's time from the peak"
    rows.check("greatest force [N]", (float(record.contact_force.max()), energy), why, Limit.equal(force, 0.02), at=setting)
    within, why = 0.01, "the energy varies by the square of the phase a step; what is left of it when the contact opens"
    if method.dissipative:
        within, why = 0.1, "a dissipative method takes part of an impact that few steps resolve"
    rows.check("speed of the rebound [m/s]", (departure, energy), why, Limit.equal(rebound, within), at=setting)


def _force(system: System, approach: float, rate: float = 0.0) -> float:
    """Contact force and damper [N] of one mass."""
    x = np.eye(5)[0]
    return float(system.evaluate(approach * x, rate * x, ball=np.zeros((1, 2))).force[0])


def deep_penetration(rows: Rows, bench: Bench, integrator: str, depth: float) -> None:
    """The ring released far inside the balls: it flies out, and no energy is made; by a law that loses none, none is lost."""
    at = bench.over(UNDAMPED).still()
    start = at.displaced(np.array([depth, 0.3 * depth, 0.0, 0.0, 0.0]))
    first = at.system.evaluate(start.q, ball=start.ball)
    step = 0.05 * at.system.damped_time_step(first.stiffness, first.damping)
    record = integrate(bench.method(integrator), at.system, start, Schedule(step, 1000, 10))
    balance = energy_balance(at.system, record)
    drift, words = balance.drift, "largest change of energy over the motion's"
    if at.dissipative:
        energy = balance.kinetic + balance.stored - balance.work
        drift, words = float((energy - energy[0]).max() / np.abs(energy).max()), "largest gain of energy over the motion's"
    why = "the energy of so coarse a motion varies by (w dt)^2 / 4 = 0.3 % where smooth, more where contacts open"
    rows.check(words, (drift, drift), why, Limit.at_most(0.03), at={"depth [m]": depth, "step/limit there": 0.05})


def settled_from_afar(rows: Rows, bench: Bench, guesses: list[float]) -> None:
    """The equilibrium found from first guesses deep inside the balls and far outside them."""
    at = bench.still()
    x = float(at.equilibrium.displacement[0])
    words, why = "axial displacement [m]", "one equilibrium, solved to a residual of 1e-11"

    def axial(guess: float) -> float:
        return float(at.system.solve_equilibrium(np.array([guess, 0.2 * guess, 0.0, 0.0, 0.0]))[0][0])

    for guess in guesses:
        rows.check(words, partial(axial, guess), why, Limit.equal(x, 1e-8), at={"first guess [m]": guess})


def chatter(rows: Rows, bench: Bench, integrator: str, options: Tables, step: float, chatters: bool) -> None:
    """A mass on a damper falls on a contact that is far stiffer than the steps can follow; in truth it comes to rest.

    Newmark's average acceleration keeps all of what a step cannot follow: the contact opens and closes every other step for
    ever, from some heights of the fall.  Whether it does so at all depends on the law, and is expected of the same steps solved
    by bisection with the law's own force (``_trapezoids``).  Generalised-alpha with a small radius at infinity forgets it in
    some steps, and so do steps that are fine enough.
    """
    ring = bench.still().system
    load, mass = 100.0, 2.0
    law, params = ring.law, 1e3 * ring.law_params[:1]
    # The stiffness at rest, hence the period, is the law's own slope there.
    at_rest = impact_system(mass, law, params, load=load)
    q, _, _ = at_rest.solve_equilibrium(np.zeros(5))
    k = float(at_rest.evaluate(q, ball=np.zeros((1, 2))).stiffness[0, 0])
    system = impact_system(mass, law, params, load=load, damping=2.0 * 0.2 * sqrt(k * mass))
    dt = step * 2.0 * pi * sqrt(mass / k)
    plain: Any = bench.method(integrator)
    method, falls = attrs.evolve(plain, **options), []
    for height in _HEIGHTS:
        start = _mass_at(-height * q[0], 0.0, load / mass)
        late = integrate(method, system, start, Schedule(dt, 400, 1)).contact_force[-100:, 0]
        falls.append((_unrest(late, load), 100.0 * float((late <= 0.0).mean()), height))
    worst, open_gap, height = max(falls)
    note = f"most after a fall from {height:g} times the approach at rest: open in {open_gap:.0f} % of these steps"
    words = "contact force less the load over the load, rms of steps 301 to 400, largest of eight falls"
    setting, limit, why = {**options, "step/period": step}, Limit.at_most(_AT_REST), "at rest by then"
    if chatters:
        alone = max(_unrest(_trapezoids(system, mass, load, h * q[0], dt), load) for h in _HEIGHTS)
        why = "at rest by then, as the same steps by bisection are with this law"
        if alone > _AT_REST:
            limit = Limit.at_least(0.1)
            why = "the known fault of average acceleration: the same steps by bisection show it with this law"
    rows.check(words, worst, why, limit, setting, note)


def _unrest(late: np.ndarray, load: float) -> float:
    return float(np.sqrt(np.mean((late / load - 1.0) ** 2)))


def _trapezoids(system: System, mass: float, load: float, gap: float, dt: float) -> np.ndarray:
    """Contact forces (100,) [N] of steps 301 to 400 of average acceleration, from a fall, each step solved by bisection."""
    from scipy.optimize import brentq

    damper = float(system.damping[0, 0])
    x, rate, a, forces = -gap, 0.0, load / mass, []
    for _ in range(400):

        def imbalance(new: float, x: float = x, rate: float = rate, a: float = a) -> float:
            then = rate + 0.5 * dt * (a + new)
            return mass * new + damper * then + _force(system, x + dt * rate + 0.25 * dt**2 * (a + new), then) - load

        # Without any contact the step is linear, and its answer is the largest there is.
        highest = (load - damper * (rate + 0.5 * dt * a)) / (mass + 0.5 * dt * damper)
        lowest = highest - 1.0
        while imbalance(lowest) > 0.0:
            lowest = highest - 2.0 * (highest - lowest)
        new = float(brentq(imbalance, lowest, highest, xtol=1e-12, rtol=1e-14)) if imbalance(highest) > 0.0 else highest
        x, rate, a = x + dt * rate + 0.25 * dt**2 * (a + new), rate + 0.5 * dt * (a + new), new
        forces.append(_force(system, x, rate))
    return np.array(forces[-100:])


def linear(rows: Rows, bench: Bench, integrator: str) -> None:
    """An undamped oscillator, its contact out of reach."""
    ring = surrogate(bench.model().system)
    system = impact_system(2.0, ring.law, ring.law_params[:1], clearance=1.0, stiffness=2e8)
    limit = system.critical_time_step(np.zeros((5, 5)))
    _around_the_limit(rows, bench.method(integrator), system, _mass_at(1e-6, 0.0, -1e2), np.zeros(5), limit)


def small_motions(rows: Rows, bench: Bench, integrator: str) -> None:
    """A bearing moved by a millionth of its approach from its equilibrium."""
    at = bench.over(UNDAMPED).still()
    start = at.displaced(at.direction(_SMALL))
    _around_the_limit(rows, bench.method(integrator), at.system, start, at.equilibrium.displacement, at.limit)


def _around_the_limit(
    rows: Rows, method: Integrator, system: System, start: Motion, still: np.ndarray, limit: float
) -> None:
    weight = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
    size = float(np.abs((start.q - still) * weight).max())

    def growth(factor: float) -> float:
        """Largest displacement over the first; of a motion that was stopped, where it was stopped."""
        try:
            displacement = integrate(method, system, start, Schedule(factor * limit, _STEPS, 1)).displacement
        except ConvergenceError as stop:  # grown until the balls find no place, or beyond a metre
            displacement = stop.state["q"]
        return float(np.abs((displacement - still) * weight).max() / size)

    words = f"largest over first displacement, {_STEPS} steps"
    for factor in _FACTORS:
        stable = method.implicit or factor < 1.0
        why, limit_of_growth = (_SWINGS, Limit.at_most(_BOUNDED)) if stable else (_GROWS, Limit.at_least(_GROWING))
        rows.check(words, growth(factor), why, limit_of_growth, at={"step/limit": factor})
    if not method.implicit:
        low, high = 0.5, 2.0
        while high - low > 1e-3:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if growth(middle) < _BOUNDED else (low, middle)
        why = "the limit is exact for linear motions; bisected to 1e-3"
        rows.check("stable limit [s]", low * limit, why, Limit.equal(limit, 0.02))


def orbit_at_the_safe_limit(rows: Rows, bench: Bench, integrator: str) -> None:
    """A large orbit with the steps that a run takes by itself, at most ``SAFETY`` of its limit, is followed for 50 turns."""
    model = bench.over(UNDAMPED).changed({"integrator.kind": integrator}).model()
    excitation, system = model.excitation, surrogate(model.system)
    if excitation is None or excitation.period_s is None:
        return  # of a user's scene: without a period there is no orbit
    period = excitation.period_s
    orbit = steady_orbit(system, period, solve_equilibrium(model).displacement, samples=129)
    limit = min(system.damped_time_step(k, c) for k, c in zip(orbit.stiffness, orbit.damping, strict=True))
    steps = ceil(period / (SAFETY * limit))
    states = [system.evaluate(q, ball=ball) for q, ball in zip(orbit.displacement, orbit.ball, strict=True)]
    opens = bool((np.array([now.contact_force for now in states]) <= 0.0).any())
    schedule = Schedule(period / steps, steps, _TURNS)
    record = integrate(model.problem.integrator.method, system, from_orbit(system, orbit, schedule.dt), schedule)
    true = np.array([at_time(orbit.displacement, period, t) for t in record.time[-steps:]])
    size = np.abs(orbit.displacement - orbit.displacement.mean(axis=0)).max(axis=0)[1:3].max()
    away = float(np.abs(record.displacement[-steps:, 1:3] - true[:, 1:3]).max() / size)
    why = "an unstable motion leaves its orbit by many times its size; steps so long cost a stable one percents"
    words = "distance from the orbit in turn 50 over its size"
    rows.check(words, away, why, Limit.at_most(0.5), at={"contacts open": opens, "steps a turn": steps})
