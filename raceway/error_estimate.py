"""The table ``error`` of a result: relative errors of Z, each with how it was estimated.

Notes
-----
A method of order p leaves an error c dt^p.  A second run with n' instead of n steps a turn gives c, so that the error of
the run itself is (Z - Z') / ((n / n')^p - 1); it costs n' / n of the run.

What has not died out of a transient is a free vibration, beside the lines of the excitation.  Its leakage into the 1x line
falls with 1 / turns for a plain mean over whole turns and with 1 / turns^3 under Hann's window, so that the difference of
both is the leakage of the plain one.  Step errors are taken from windowed lines: leakage has no order.

Over a single turn of period T a free vibration f'' = -n^2 f leaves (2 / T) [f' + j w f] / (w^2 - n^2) in the 1x line, the
bracket being what the turn does not close by.

A free vibration that goes on shifts the secant stiffness itself.  A force k r (1 + c |r|^2) with a forced circle a and a
free vibration of mean square b^2 answers at 1x with k (1 + c (a^2 + 2 b^2)) (no other term of |r|^2 r has this frequency):
with s = 2 b^2 / a^2 the free vibration makes s / (1 + s) of the difference between this secant stiffness and the tangent.

References
----------
Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (2nd ed., 1993), section II.4 (step halving);
Harris, Proc. IEEE 66 (1978), 51 (windows); Nayfeh, Mook, Nonlinear Oscillations (1979), section 4.3 (cubic terms).
"""

from __future__ import annotations

from math import ceil
from typing import Any

import attrs
import numpy as np

from raceway.core.identification import Identification, fourier_line, stiffness, without_drift
from raceway.core.record import Record
from raceway.core.system import TOLERANCE
from raceway.errors import ConvergenceError
from raceway.model import Model
from raceway.plugins.identifiers.tangent import Tangent
from raceway.plugins.identifiers.whole_turns import whole_turns
from raceway.simulate import Simulation, simulate
from raceway.statics import Equilibrium

#: Least steps a turn (of ``integrator.steps_per_turn``), and how close the second run may come to the stable limit.
_LEAST_STEPS = 8
_MOST_OF_LIMIT = 0.95
#: A second run whose step differs by less than this tells nothing.
_LEAST_RATIO = 1.1
#: Free vibrations below this share of the 1x power shift nothing that can be seen.
_LEAST_FREE = 1e-10

_NAMES = ("total", "time_step", "transient", "mesh", "contact", "identification")


@attrs.frozen
class Part:
    """One contribution: ``size`` relative to |Z|, its complex ``shift`` of Z where that is known, and how it was found."""

    size: float | None
    how: str
    shift: complex | None = None


def no_error(how: str) -> dict[str, Any]:
    """The table without numbers, and one reason."""
    return {**dict.fromkeys(_NAMES), "how": dict.fromkeys(_NAMES, how)}


def error_table(
    model: Model, equilibrium: Equilibrium, motions: list[tuple[Model, Simulation]], found: Identification
) -> dict[str, Any]:
    """The table ``error``.

    Parameters
    ----------
    motions : model and motion of each speed; empty where the identifier needs no motion
    """
    table = no_error("")
    how: dict[str, str] = table["how"]
    how["mesh"] = "rigid bodies have no mesh"
    how["contact"] = "the law is taken as exact: its own model error is not estimated"
    if not motions:
        how |= dict.fromkeys(("transient", "identification"), "no motion is recorded")
        parts = {"time_step": Part(TOLERANCE, "no time step; residual that the equilibrium is solved to")}
    else:
        parts = {
            "time_step": _time_step(model, equilibrium, motions, found.dynamic_stiffness),
            "transient": _transient(model, equilibrium, motions[-1][1], found),
            "identification": _identification(model, found),
        }
    for name, part in parts.items():
        table[name], how[name] = part.size, part.how
    table["total"] = _total(parts)
    how["total"] = "time step and transient with their phases, at least half the larger; plus identification"
    return table


def _total(parts: dict[str, Part]) -> float | None:
    """Errors whose phases are known may cancel; half the larger is kept, because each is known to that only."""
    known = [part for part in parts.values() if part.size is not None]
    if not known:
        return None
    sizes = [part.size or 0.0 for part in known if part.shift is None]
    shifts = [part.shift for part in known if part.shift is not None]
    together = max(abs(sum(shifts)), *(0.5 * abs(shift) for shift in shifts)) if shifts else 0.0
    return float(together + sum(sizes))


def _identification(model: Model, found: Identification) -> Part:
    if found.window is None:
        return Part(None, f"identifier '{model.scene.identifier.kind}' gives no estimate")
    return Part(found.window, "Fourier line against least squares")


def _time_step(model: Model, equilibrium: Equilibrium, motions: list[tuple[Model, Simulation]], value: complex) -> Part:
    """By a second run with other steps."""
    method, first = model.scene.integrator.method, motions[-1][1]
    if getattr(method, "steady", False):
        return Part(first.whole.counts.get("error"), "the method's own estimate, of the displacement over its amplitude")
    if not method.inertial:
        return Part(getattr(method, "tolerance", None), "no time step; residual that each equilibrium is solved to")
    steps = first.whole.schedule.steps_per_turn
    limits = [one.critical_time_step for _, one in motions if one.critical_time_step is not None]
    explicit = not method.implicit and bool(limits)
    bound = first.whole.schedule.dt * steps / (_MOST_OF_LIMIT * min(limits)) if explicit else 0.0
    other = other_steps(steps, bound)
    if other is None:
        return Part(None, "no second run: larger steps would exceed the stable limit")
    try:
        again = [simulate(one, _at(one, model, equilibrium), steps_per_turn=other, orbit=m.orbit) for one, m in motions]
    except ConvergenceError as why:
        return Part(None, f"the run with {other} steps a turn failed: {why}")
    fine, coarse = (_steady(one.record, model) for one in (first, again[-1]))
    if fine is None or coarse is None or len(motions) > 1:
        fine = value
        coarse = model.scene.identifier.method.identify([a.record for a in again], equilibrium, model).dynamic_stiffness
    shift = (fine - coarse) / ((steps / other) ** method.order - 1.0) / abs(value)
    if not np.isfinite(abs(shift)):
        return Part(None, f"the run with {other} steps a turn gives no dynamic stiffness")
    words = "half as many steps" if 2 * other == steps else f"{other} instead of {steps} steps a turn"
    return Part(float(abs(shift)), f"run with {words}, order {method.order}", -shift)


def _at(one: Model, model: Model, equilibrium: Equilibrium) -> Equilibrium:
    """The equilibrium that belongs to the model of one speed."""
    from raceway.statics import settle

    return equilibrium if one is model else settle(one)


def other_steps(steps: int, least: float = 0.0) -> int | None:
    """Steps a turn of the second run: half, or as few as the stable limit leaves; None when that tells nothing.

    Parameters
    ----------
    least : steps a turn that the stable limit asks for; 0 for an implicit method
    """
    fewer = max(steps // 2, _LEAST_STEPS, ceil(least))
    if steps >= _LEAST_RATIO * fewer:
        return fewer
    return None if least else ceil(1.5 * steps)


def _transient(model: Model, equilibrium: Equilibrium, simulation: Simulation, found: Identification) -> Part:
    method, value = model.scene.integrator.method, found.dynamic_stiffness
    if getattr(method, "steady", False):
        return Part(0.0, "one turn of the steady motion: nothing dies out")
    if not method.inertial and model.plan.turns == 1:
        return Part(0.0, "one turn of equilibria: nothing dies out")
    steady = _steady(simulation.record, model)
    if steady is None or "speeds" in model.scene.identifier.method.needs:
        return _without_window(model, equilibrium, simulation, found)
    shift = (value - steady + _lasting(model, equilibrium, simulation.record, steady)) / abs(value)
    how = "free vibration: its leakage, a plain against Hann's window over all turns that are used, and its shift of Z"
    return Part(float(abs(shift)), how, shift)


def _without_window(model: Model, equilibrium: Equilibrium, simulation: Simulation, found: Identification) -> Part:
    """Where less than two turns of one frequency are used."""
    if found.spread is not None:
        return Part(found.spread, "largest deviation of a single turn from all turns that are used")
    whole = simulation.whole
    per_turn = whole.schedule.steps_per_turn // whole.schedule.stride
    if model.excitation.period_s is None or len(whole.time) <= per_turn or not model.scene.integrator.method.inertial:
        return Part(None, f"identifier '{model.scene.identifier.kind}' gives no estimate of a single turn")
    clean = _closed(model, equilibrium, simulation, per_turn)
    shift = (found.dynamic_stiffness - clean) / abs(found.dynamic_stiffness)
    how = "free vibration that does not close the turn, in the natural modes of the equilibrium"
    return Part(float(abs(shift)), how, shift)


def _closed(model: Model, equilibrium: Equilibrium, simulation: Simulation, per_turn: int) -> complex:
    """Z of the last turn less what its free vibration leaves in the 1x line."""
    from scipy.linalg import eigh

    system, whole, w = model.system, simulation.whole, 2.0 * np.pi * model.excitation.frequency_hz
    chosen = np.flatnonzero(system.free > 0.0)
    tangent = 0.5 * (equilibrium.stiffness + equilibrium.stiffness.T)
    squares, modes = eigh(system.reduced(tangent + system.stiffness), system.reduced(system.mass))
    jump, slope = (
        modes.T @ system.reduced(system.mass) @ (signal[-1] - signal[-1 - per_turn])[chosen]
        for signal in (whole.displacement, whole.velocity)
    )
    turn = slice(-per_turn, None)
    line = fourier_line(whole.time[turn], whole.displacement[turn], w / (2.0 * np.pi))
    seam = np.exp(-1j * w * whole.time[-1])
    line[chosen] -= w / np.pi * seam * modes @ ((slope + 1j * w * jump) / (w**2 - squares))
    return stiffness(fourier_line(whole.time[turn], whole.force[turn], w / (2.0 * np.pi)), line)


def _steady(record: Record, model: Model) -> complex | None:
    """Z of Hann-windowed lines; None without two whole turns of one frequency."""
    frequency = model.excitation.frequency_hz
    if model.excitation.period_s is None:
        return None
    record = whole_turns(record)
    turns = round(len(record.time) * record.schedule.stride / record.schedule.steps_per_turn)
    if turns < 2:
        return None
    lines = hann_line(record.time, np.hstack([record.force, record.displacement]), frequency)
    return stiffness(lines[:5], lines[5:])


def hann_line(time: np.ndarray, signal: np.ndarray, frequency_hz: float) -> np.ndarray:
    """1x phasor (k,) of a signal (n, k) under Hann's window over two or more whole turns.

    Notes
    -----
    The window's spectrum ends two lines from its middle: mean and harmonics of a periodic signal leak nothing.
    """
    window = 1.0 - np.cos(2.0 * np.pi * (np.arange(len(time)) + 0.5) / len(time))
    kernel = window * np.exp(-2j * np.pi * frequency_hz * time)
    return 2.0 * (kernel[:, None] * without_drift(time, signal, frequency_hz)).mean(axis=0)


def _lasting(model: Model, equilibrium: Equilibrium, record: Record, value: complex) -> complex:
    """Shift of Z [N/m] by the free vibration."""
    record = whole_turns(record)
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    turns = len(record.time) // per_turn
    by_turn = record.displacement[: turns * per_turn, :3].reshape(turns, per_turn, 3)
    periodic = by_turn.mean(axis=0)
    # The mean over the turns keeps 1 / turns of a free vibration's power.
    free = float(((by_turn - periodic) ** 2).sum(axis=2).mean()) * turns / (turns - 1)
    forced = float(((periodic - periodic.mean(axis=0)) ** 2).sum(axis=1).mean())
    if forced == 0.0 or free < _LEAST_FREE * forced:
        return 0j
    tangent = Tangent().identify([], equilibrium, model).dynamic_stiffness
    share = 2.0 * free / forced
    return share / (1.0 + share) * (value - tangent)
