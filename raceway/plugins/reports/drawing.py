"""What is drawn of one run, each on axes that are handed in: orbit, spectrum, ball loads."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from raceway.framework.higher_types import Result, Simulation

_USED, _OTHER, _STATIC = "#0b5fa5", "#b9c4cf", "#c8501e"
_MICRO = 1e6


def _motion(result: Result) -> Simulation:
    if result.simulation is None:
        raise ValueError("the scene is static: no motion was recorded")
    return result.simulation


def draw_orbit(axes: Axes, result: Result) -> None:
    """Path of the inner ring's reference point in the radial plane."""
    motion = _motion(result)
    whole, used = motion.whole, motion.record
    turns = round(len(used.time) * used.schedule.stride / used.schedule.steps_per_turn)
    if len(whole.time) > len(used.time):
        label = f"all {_turns(whole.schedule.turns)}"
        axes.plot(*(_MICRO * whole.displacement[:, 1:3].T), color=_OTHER, linewidth=0.8, label=label)
    label = f"{'last ' if len(whole.time) > len(used.time) else ''}{_turns(turns)}, used"
    axes.plot(*(_MICRO * used.displacement[:, 1:3].T), color=_USED, linewidth=1.4, label=label)
    axes.plot(
        *(_MICRO * result.equilibrium.displacement[1:3]), "+", color=_STATIC, markersize=11, label="static equilibrium"
    )
    axes.set_aspect("equal", adjustable="datalim")
    _finish(axes, f"Orbit of the inner ring\n{_subtitle(result)}", "displacement y [µm]", "displacement z [µm]")


def draw_spectrum(axes: Axes, result: Result) -> None:
    """Amplitude of the displacement against multiples of the excitation's frequency."""
    import numpy as np

    record, found = _motion(result).record, result.identification
    frequency = result.model.excitation.frequency_hz if found is None else found.frequency_hz
    motion = record.displacement[:, 1:3] - record.displacement[:, 1:3].mean(axis=0)
    lines = 2.0 * np.abs(np.fft.rfft(motion, axis=0)) / len(motion) * _MICRO
    order = np.fft.rfftfreq(len(motion), record.time[1] - record.time[0]) / frequency
    shown = (order > 0.0) & (order <= 10.05)
    peak = max(lines[shown].max(), 1e-12)
    dense = order[1] < 0.2
    apart, width = (0.4 * order[1], 1.0) if dense else (0.06, 2.0)
    for lane, (name, colour) in enumerate((("y", _USED), ("z", _STATIC))):
        # Beside each other, since both directions of a turning force have the same line.
        place = order[shown] + (lane - 0.5) * apart
        tops = np.maximum(lines[shown, lane], peak * 1e-9)
        axes.vlines(place, peak * 1e-9, tops, color=colour, linewidth=width, label=f"displacement {name}")
    largest = lines[shown].max(axis=1)
    one = int(np.argmin(np.abs(order[shown] - 1.0)))
    axes.annotate(
        f"1x: {largest[one]:.4g} µm at {frequency:.4g} Hz",
        (1.0, largest[one]),
        xytext=(12, 2),
        textcoords="offset points",
        fontsize=10,
    )
    axes.set_yscale("log")
    axes.set_xlim(0.0, 10.4)
    axes.set_ylim(peak * 1e-9, peak * 10.0)
    axes.set_xticks(range(11))
    _finish(
        axes,
        f"Spectrum of the displacement, mean removed\n{_subtitle(result)}",
        "frequency / frequency of the excitation [-]",
        "amplitude [µm]",
    )


def draw_ball_loads(axes: Any, result: Result) -> None:
    """Inner contact load of each ball on polar axes: static, and its range over the recorded turns."""
    import numpy as np

    azimuth, row = result.model.azimuth, result.model.basis.row
    count = result.model.geometry.ball_count
    z = len(azimuth)
    static = result.equilibrium.contact_force[:z]
    top = max(static.max(), 1e-12) * 1.2
    if result.simulation is not None:
        loads = result.simulation.record.contact_force[:, :z]
        low, high = loads.min(axis=0), loads.max(axis=0)
        axes.vlines(azimuth, low, high, color=_USED, linewidth=6.0, alpha=0.45, label="range over the orbit")
        top = max(top, high.max() * 1.2)
    for one in range(row[-1] + 1):
        balls = np.flatnonzero(row == one)
        closed = np.append(balls, balls[0])
        words = "static" if z == count else f"static, row {one + 1}"
        axes.plot(
            azimuth[closed],
            static[closed],
            ("o-", "s--", "^-.", "v:")[one % 4],
            color=_STATIC,
            linewidth=1.6,
            markersize=5,
            label=words,
        )
    for k in range(count):
        axes.text(azimuth[k], top * 0.94, str(k), ha="center", va="center", fontsize=9, color="#5a6570")
    axes.set_ylim(0.0, top)
    axes.set_rlabel_position(90.0 + 180.0 / max(count, 1))
    axes.set_xticks(np.radians(np.arange(0, 360, 30)))
    axes.set_xticklabels(["0° (+y)", "30°", "60°", "90° (+z)", *(f"{a}°" for a in range(120, 360, 30))])
    axes.tick_params(labelsize=10, pad=6)
    axes.set_title(
        f"Ball loads on the inner race [N] by azimuth; grey: ball number\n{_subtitle(result)}", fontsize=12, pad=14
    )
    axes.grid(color="#d8dee4", linewidth=0.7)


def _turns(count: int) -> str:
    return f"{count} turn{'' if count == 1 else 's'}"


def _subtitle(result: Result) -> str:
    """The title, and what was changed of the scene, in lines that fit."""
    return "\n".join(part for line in result.title.splitlines() for part in wrap(line, 64))


def _finish(axes: Axes, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=12)
    axes.set_xlabel(x, fontsize=11)
    axes.set_ylabel(y, fontsize=11)
    axes.tick_params(labelsize=10)
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)
