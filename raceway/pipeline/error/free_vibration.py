"""Z of a recorded motion less what its free vibration does to it.

Notes
-----
What has not died out of a transient is a free vibration, beside the lines of the excitation.  Its leakage into the 1x line
falls with 1 / turns for a plain mean over whole turns and with 1 / turns^3 under Hann's window, so that the difference of
both is the leakage of the plain one.

Over a single turn of period T a free vibration f'' = -n^2 f leaves (2 / T) [f' + j w f] / (w^2 - n^2) in the 1x line, the
bracket being what the turn does not close by.

A free vibration within two lines of 1x, of 1 / turns each, is not told from it by the window: the response beats, and both
halves of the turns have different lines under it.

A free vibration that goes on shifts the secant stiffness itself.  A force k r (1 + c |r|^2) with a forced circle a and a
free vibration of mean square b^2 answers at 1x with k (1 + c (a^2 + 2 b^2)) (no other term of |r|^2 r has this frequency):
with s = 2 b^2 / a^2 the free vibration makes s / (1 + s) of the difference between this secant stiffness and the tangent.

References
----------
Harris, Proc. IEEE 66 (1978), 51 (windows); Nayfeh, Mook, Nonlinear Oscillations (1979), section 4.3 (cubic terms).
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.signals.identification import fourier_line, stiffness, without_drift
from raceway.core.stepping.record import Record
from raceway.pipeline.simulate import Simulation
from raceway.plugins.identifiers.tangent import Tangent
from raceway.plugins.identifiers.whole_turns import whole_turns

#: Free vibrations below this share of the 1x power shift nothing that can be seen.
_LEAST_FREE = 1e-10


@attrs.frozen
class Clean:
    """Z without leakage [N/m]; what the free vibration shifts it by, still in it [N/m]; how both were found.

    Attributes
    ----------
    halves : distance of Z of both halves of the turns [N/m]; None below four turns, whose halves are too short for the window
    """

    value: complex
    lasting: complex
    how: str
    halves: float | None = None


def without_free_vibration(model: Model, equilibrium: Equilibrium, simulation: Simulation) -> Clean | None:
    """Z of the turns that are used, by Hann's window; of a single turn by what does not close; None where neither can be."""
    if model.excitation.period_s is None:
        return None
    record, whole = whole_turns(simulation.record), simulation.whole
    per_turn = whole.schedule.steps_per_turn // whole.schedule.stride
    if len(record.time) >= 2 * per_turn:
        frequency, samples = model.excitation.frequency_hz, len(record.time)
        value, half = _windowed(record, slice(None), frequency), samples // per_turn // 2 * per_turn
        ends = (slice(half), slice(samples - half, None))
        parts = [_windowed(record, one, frequency) for one in ends] if half >= 2 * per_turn else []
        how = "free vibration: its leakage, a plain against Hann's window over all turns that are used, and its shift of Z"
        return Clean(value, _lasting(model, equilibrium, record, value), how, abs(parts[0] - parts[1]) if parts else None)
    if len(whole.time) <= per_turn or not model.scene.integrator.method.inertial:
        return None
    value = _closed(model, equilibrium, whole, per_turn)
    return Clean(value, 0j, "free vibration that does not close the turn, in the natural modes of the equilibrium")


def _windowed(record: Record, part: slice, frequency_hz: float) -> complex:
    """Z [N/m] of some whole turns under Hann's window."""
    lines = hann_line(record.time[part], np.hstack([record.force, record.displacement])[part], frequency_hz)
    return stiffness(lines[:5], lines[5:])


def _closed(model: Model, equilibrium: Equilibrium, whole: Record, per_turn: int) -> complex:
    """Z of the last turn less what its free vibration leaves in the 1x line."""
    from scipy.linalg import eigh

    system, w = model.system, 2.0 * np.pi * model.excitation.frequency_hz
    chosen = np.flatnonzero(system.free > 0.0)
    tangent = 0.5 * (equilibrium.stiffness_rows_held + equilibrium.stiffness_rows_held.T)
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
