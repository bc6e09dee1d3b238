"""Conserved quantities: energy over a million steps, impacts, deep penetrations; and chatter, which conserves too well."""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.core.contact.damping import stored_energy
from raceway.core.ring.energy import energy_balance
from raceway.core.ring.kernels.impact import impact_system
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Motion, Record, Schedule
from raceway.errors import ConvergenceError
from raceway.framework.registry import Registry
from raceway.studies.stability.case import AtLeast, AtMost, Case, Measured, Near, Row, judged
from raceway.studies.stability.systems import UNDAMPED, Still, scene_at, still

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.framework.contracts import ContactLaw, Integrator

_BLOCKS = 20
#: Heights of the fall that chatter is looked for at, over the approach at rest.
_HEIGHTS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
#: Departure of the contact force from the load, over it, of a mass at rest.
_AT_REST = 1e-3
#: Every so many steps are recorded: no divisor of a million's blocks that a period could meet.
_STRIDE = 10
_NOTHING_OPENS = AtMost(1e-6, "a symplectic method conserves a near energy: its blocks' means stay, less rounding")
_NEVER_GROWS = AtMost(1e-6, "a dissipative method or law may lose energy, not gain it")
_LIFTS_OFF = AtMost(1e-3, "where contacts open the force is not smooth, and the near energy is kept to some order only")


def million_steps(case: Case, registry: Registry) -> list[Row]:
    """Undamped free motion; the trend of the energy's block means over the motion's energy."""
    a = case.arguments
    found = still(scene_at(a["tables"], {**UNDAMPED, **a.get("changes", {})}, registry))
    method: Integrator = registry.find("integrator", a["integrator"]).plugin()
    opens, loses = a["amplitude"] > 1.0, method.dissipative or found.dissipative
    options: dict[str, float] = {}
    if not opens:  # where contacts open, rounding ends some iterations above so small a tolerance
        method, options = _sharp(method)
    setting = {"integrator": a["integrator"], **options, **a["shown"], "steps": a["steps"], "step/limit": a["factor"]}
    note: list[str] = []

    def trend() -> Measured:
        record = integrate(method,
            found.system, found.displaced(found.direction(a["amplitude"])), Schedule(a["factor"] * found.limit, a["steps"] // _BLOCKS, _BLOCKS, _STRIDE)
        )  # fmt: skip
        really = bool((record.contact_force <= 0.0).any())
        note.append("contacts open" if really else "all contacts stay closed")
        if really != opens:
            raise ConvergenceError("contacts open or stay closed, unlike what this case is for: change its amplitude")
        slope, worst = _trend(found, record)
        return slope if loses else abs(slope), worst

    expected = _LIFTS_OFF if opens else _NEVER_GROWS if loses else _NOTHING_OPENS
    row = judged(case.name, setting, "trend of the energy's block means over the motion's energy", expected, 0.0, trend)
    return [attrs.evolve(row, note="; ".join([*note, row.note]).strip("; "))]


def _sharp(method: Any) -> tuple[Integrator, dict[str, float]]:
    """An implicit method with steps solved as far as rounding allows: 1e-9 of the load a step adds up to 1e-5 of a small
    motion's energy in a million steps."""
    if "tolerance" not in {field.name for field in attrs.fields(type(method))}:
        return method, {}
    return attrs.evolve(method, tolerance=1e-12), {"tolerance": 1e-12}


def _trend(found: Still, record: Record) -> tuple[float, float]:
    """Slope of the block means over the whole run, and the largest departure of one, over the motion's energy."""
    balance = energy_balance(found.system, record)
    energy = balance.kinetic + balance.stored
    rest = found.displaced(np.zeros(5))
    at_rest = attrs.evolve(
        record, **{name: getattr(record, name)[:2] for name in ("time", "velocity", "force")},
        displacement=np.tile(rest.q, (2, 1)), gap=np.tile(found.equilibrium.gap, (2, 1)),
        contact_force=np.tile(found.equilibrium.contact_force, (2, 1)), ball=np.tile(rest.ball, (2, 1, 1)),
    )  # fmt: skip
    size = energy[0] - energy_balance(found.system, at_rest).stored[0]
    blocks = energy.reshape(_BLOCKS, -1)
    # Whole swings do not fit a block: a window that fades out keeps their remainder out of the mean.
    window = np.hanning(blocks.shape[1])
    means = blocks @ window / window.sum()
    slope = float(np.polyfit(np.arange(_BLOCKS), means, 1)[0]) * _BLOCKS
    return slope / size, float(np.abs(means - means[0]).max() / size)


def impact(case: Case, registry: Registry) -> list[Row]:
    """A mass meets a contact: its greatest force and the speed that it leaves with.

    Notes
    -----
    What is expected follows from the energy that the law stores; of a law that loses some, from the differential equation with
    the law's own force, solved by scipy.
    """
    a = case.arguments
    found = still(scene_at(a["tables"], a["changes"], registry))
    law, params = found.system.law, found.system.law_params[:1]
    mass, speed = 2.0, a["speed"]
    depth = _depth(law, params, 0.5 * mass * speed**2)
    system = impact_system(mass, law, params)
    force = float(system.evaluate(np.array([depth, 0.0, 0.0, 0.0, 0.0]), ball=np.zeros((1, 2))).force[0])
    rebound = speed
    if found.dissipative:
        force, rebound = _solved_impact(system, mass, speed, depth)
    method: Integrator = registry.find("integrator", a["integrator"]).plugin()
    dt = pi * depth / speed / a["steps"]
    balls = np.zeros((1, 2))
    first = Motion(
        np.array([-0.4 * dt * speed, 0, 0, 0, 0]), np.array([speed, 0, 0, 0, 0.0]), np.zeros(5), balls, balls.copy()
    )
    setting = {"integrator": a["integrator"], **a["shown"], "speed [m/s]": speed, "steps a contact": a["steps"]}
    record = integrate(method, system, first, Schedule(dt, 2 * a["steps"], 1))
    left = -float(record.velocity[-1, 0])
    energy = (left / rebound) ** 2 - 1.0
    close = Near(0.02, "one step lies up to a hundredth of the contact's time from the peak")
    bound = Near(0.01, "the energy swings by the square of the phase a step; what is left of it when the contact opens")
    if method.dissipative:
        bound = Near(0.1, "a dissipative method takes part of an impact that few steps resolve")
    return [
        judged(case.name, setting, "greatest force [N]", close, force, lambda: (float(record.contact_force.max()), energy)),
        judged(case.name, setting, "speed of the rebound [m/s]", bound, rebound, lambda: (left, energy)),
    ]


def _solved_impact(system: System, mass: float, speed: float, depth: float) -> tuple[float, float]:
    """Greatest force [N] and speed of the rebound [m/s] of a law that depends on the rate; ``depth``: without its loss [m]."""
    from scipy.integrate import solve_ivp

    def force(x: float, v: float) -> float:
        q, rate = np.zeros(5), np.zeros(5)
        q[0], rate[0] = x, v
        return float(system.evaluate(q, rate, ball=np.zeros((1, 2))).force[0])

    def leaves(_: float, y: np.ndarray) -> float:
        return float(y[0])

    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    # The unit of length is the depth, so that both unknowns are of the size of 1.
    span = 10.0 * pi * depth / speed
    solution = solve_ivp(
        lambda _, y: [y[1] * speed / depth, -force(y[0] * depth, y[1] * speed) / (mass * speed)], (0.0, span), [0.0, 1.0],
        events=leaves, rtol=1e-9, atol=1e-12, max_step=0.01 * depth / speed,
    )  # fmt: skip
    largest = max(force(x * depth, v * speed) for x, v in solution.y.T)
    return largest, -float(solution.y[1, -1]) * speed


def _depth(law: ContactLaw, params: np.ndarray, energy: float) -> float:
    """Approach at which a contact has stored an energy [m], by bisection."""
    low, high = 0.0, 1.0
    two, stored = np.ascontiguousarray(np.repeat(params, 2, axis=0)), np.empty(2)
    memory = np.zeros((2, 0))
    for _ in range(200):
        middle = 0.5 * (low + high)
        stored_energy(law, two, memory, memory.copy(), np.full(2, -middle), np.empty((6, 2)), stored)
        low, high = (middle, high) if stored[0] < energy else (low, middle)
    return high


def deep_penetration(case: Case, registry: Registry) -> list[Row]:
    """The ring let go far inside the balls: it flies out, and no energy is made; by a law that loses none, none is lost."""
    a = case.arguments
    found = still(scene_at(a["tables"], UNDAMPED | a["changes"], registry))
    method: Integrator = registry.find("integrator", a["integrator"]).plugin()
    start = found.displaced(np.array([a["depth"], 0.3 * a["depth"], 0.0, 0.0, 0.0]))
    there = found.system.evaluate(start.q, ball=start.ball)
    limit = found.system.damped_time_step(there.stiffness, there.damping)
    setting = {"integrator": a["integrator"], **a["shown"], "depth [m]": a["depth"], "step/limit there": 0.05}

    def drift() -> Measured:
        record = integrate(method, found.system, start, Schedule(0.05 * limit, 1000, 10))
        balance = energy_balance(found.system, record)
        if not found.dissipative:
            return balance.drift, balance.drift
        energy = balance.kinetic + balance.stored - balance.work
        rise = float((energy - energy[0]).max() / np.abs(energy).max())
        return rise, rise

    words = "largest gain of energy over the motion's" if found.dissipative else "largest change of energy over the motion's"
    bound = AtMost(
        0.03, "the energy of so coarse a motion swings by (w dt)^2 / 4 = 0.3 % where smooth, more where contacts open"
    )
    return [judged(case.name, setting, words, bound, 0.0, drift)]


def settled_from_afar(case: Case, registry: Registry) -> list[Row]:
    """The equilibrium found from first guesses deep inside the balls and far outside them."""
    a = case.arguments
    found = still(scene_at(a["tables"], a["changes"], registry))
    rows = []
    for guess in a["guesses"]:

        def settle(x: float = guess) -> Measured:
            q, _, _ = found.system.settle(np.array([x, 0.2 * x, 0.0, 0.0, 0.0]))
            return float(q[0]), None

        near = Near(1e-8, "one equilibrium, solved to a residual of 1e-11")
        setting = {**a["shown"], "first guess [m]": guess}
        x = float(found.equilibrium.displacement[0])
        rows.append(judged(case.name, setting, "axial displacement [m]", near, x, settle))
    return rows


def chatter(case: Case, registry: Registry) -> list[Row]:
    """A mass on a damper falls on a contact that is far stiffer than the steps can follow; in truth it comes to rest.

    Notes
    -----
    Newmark's average acceleration keeps all of what a step cannot follow: the contact opens and closes every other step for
    ever, from some heights of the fall.  Whether it does so at all depends on the law, and is expected of the same steps solved
    by bisection with the law's own force (``_trapezoids``).  Generalised-alpha with a small radius at infinity forgets it in
    some steps, and so do steps that are fine enough.
    """
    a = case.arguments
    found = still(scene_at(a["tables"], a["changes"], registry))
    load, mass = 100.0, 2.0
    law, params = found.system.law, 1e3 * found.system.law_params[:1]
    # The stiffness at rest, hence the period, is the law's own slope there.
    at_rest = impact_system(mass, law, params, load=load)
    q, _, _ = at_rest.settle(np.zeros(5))
    k = float(at_rest.evaluate(q, ball=np.zeros((1, 2))).stiffness[0, 0])
    system = impact_system(mass, law, params, load=load, damping=2.0 * 0.2 * sqrt(k * mass))
    period = 2.0 * pi * sqrt(mass / k)
    method: Integrator = attrs.evolve(registry.find("integrator", a["integrator"]).plugin(), **a["options"])
    setting = {"integrator": a["integrator"], **a["options"], **a["shown"], "step/period": a["step"]}
    note: list[str] = []

    def rest_of(late: np.ndarray) -> float:
        return float(np.sqrt(np.mean((late / load - 1.0) ** 2)))

    def unrest() -> Measured:
        found = []
        for height in _HEIGHTS:
            record = integrate(method, system, _falling(load / mass, height * q[0]), Schedule(a["step"] * period, 400, 1))
            late = record.contact_force[-100:, 0]
            found.append((rest_of(late), 100.0 * float((late <= 0.0).mean()), height))
        worst, opened, height = max(found)
        note.append(f"most after a fall from {height:g} times the approach at rest: open in {opened:.0f} % of these steps")
        return worst, None

    expected: AtLeast | AtMost = AtMost(_AT_REST, "at rest by then")
    if a["chatters"]:
        alone = max(rest_of(_trapezoids(system, mass, load, h * q[0], a["step"] * period)) for h in _HEIGHTS)
        if alone > _AT_REST:
            expected = AtLeast(
                0.1, "the known fault of average acceleration: the same steps by bisection show it with this law"
            )
        else:
            expected = AtMost(_AT_REST, "at rest by then, as the same steps by bisection are with this law")
    quantity = "contact force less the load over the load, rms of steps 301 to 400, largest of eight falls"
    row = judged(case.name, setting, quantity, expected, 0.0, unrest)
    return [attrs.evolve(row, note="; ".join([*note, row.note]).strip("; "))]


def _trapezoids(system: System, mass: float, load: float, gap: float, dt: float) -> np.ndarray:
    """Contact forces (100,) [N] of steps 301 to 400 of average acceleration, from a fall, each step solved by bisection."""
    from scipy.optimize import brentq

    q, v = np.zeros(5), np.zeros(5)
    damper, balls = float(system.damping[0, 0]), np.zeros((1, 2))

    def force(x: float, rate: float) -> float:
        q[0], v[0] = x, rate
        return float(system.evaluate(q, v, ball=balls).force[0])

    x, rate, a, found = -gap, 0.0, load / mass, []
    for _ in range(400):

        def unbalanced(new: float, x: float = x, rate: float = rate, a: float = a) -> float:
            then = rate + 0.5 * dt * (a + new)
            return mass * new + damper * then + force(x + dt * rate + 0.25 * dt**2 * (a + new), then) - load

        # Without any contact the step is linear, and its answer is the largest there is.
        highest = (load - damper * (rate + 0.5 * dt * a)) / (mass + 0.5 * dt * damper)
        lowest = highest - 1.0
        while unbalanced(lowest) > 0.0:
            lowest = highest - 2.0 * (highest - lowest)
        new = float(brentq(unbalanced, lowest, highest, xtol=1e-12, rtol=1e-14)) if unbalanced(highest) > 0.0 else highest
        x, rate, a = x + dt * rate + 0.25 * dt**2 * (a + new), rate + 0.5 * dt * (a + new), new
        found.append(force(x, rate))
    return np.array(found[-100:])


def _falling(acceleration: float, gap: float) -> Motion:
    balls = np.zeros((1, 2))
    return Motion(np.array([-gap, 0, 0, 0, 0.0]), np.zeros(5), np.array([acceleration, 0, 0, 0, 0.0]), balls, balls.copy())
