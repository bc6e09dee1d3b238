"""Figures: of a fit data, curve with its band, residuals and confidence region; of a rig's record turns, spectrum and orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.extend import ReadTables, axis_label, new_figure, read_in, wrapped
from raceway_measure.fit.shaft_angle import Rotation
from raceway_measure.fit.synchronous import Synchronous
from raceway_rotor.shaft import State

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BLUE, _RED, _GREEN, _GREY, _BLACK = "#0b5fa5", "#c8501e", "#2a8f5b", "#8793a0", "#17202b"
#: Columns of panels at most, standard errors of residuals that are marked, and points beyond which they are dots.
_MOST, _MARKED, _DENSE = 4, 2.0, 200
_MICRO, _TURNS_SHOWN, _ORDERS_SHOWN = 1e6, 4, 6.0


def draw_fit(content: ReadTables) -> Figure:
    """Two rows of panels, a column per quantity, and the region of the first two free numbers."""
    series = content["series"][:_MOST]
    columns = len(series) + 1
    figure = new_figure(1.0 + 2.9 * columns, 5.2)
    panels = figure.subplots(2, columns, squeeze=False, height_ratios=(3, 1.4))
    for k, quantity in enumerate(series):
        # Data and fit, and residuals below them
        panel = panels[0][k]
        below = panels[1][k]
        factor, unit = read_in(1.0, quantity["unit"])
        x, fit, band, data, error = (np.array(quantity[name]) for name in ("x", "fitted", "band", "measured", "error"))
        order, few = np.argsort(x), len(x) <= _DENSE
        low, high = factor * (fit - band)[order], factor * (fit + band)[order]
        panel.fill_between(x[order], low, high, color=_BLUE, alpha=0.22, linewidth=0)
        panel.plot(x[order], factor * fit[order], color=_BLUE, label="fit, with its 95 %")
        fmt, size, bars = ("o", 4, 1.96 * factor * error) if few else (".", 1, None)
        panel.errorbar(x, factor * data, bars, fmt=fmt, ms=size, color=_BLACK, elinewidth=0.8, label="data")
        panel.set_ylabel(axis_label(quantity["name"], unit))
        panel.legend(frameon=False, fontsize=8)
        for level, style in ((0.0, "-"), (-_MARKED, ":"), (_MARKED, ":")):
            below.axhline(level, color=_GREY, linewidth=0.8, linestyle=style)
        below.plot(x, (data - fit) / np.where(error > 0.0, error, 1.0), fmt, ms=size, color=_BLACK)
        below.set_xlabel(axis_label(quantity["over"], quantity["over_unit"]))
        below.set_ylabel("residual over\nstandard error")
    # The ellipse of two numbers at 95 %; of one number its interval
    panel = panels[0][-1]
    known_numbers = [k for k, number in enumerate(content["free"]) if number["determined"]][:2]
    panel.set_title("confidence region, 95 %", fontsize=10)
    if not known_numbers:
        words = "the data determine\nno number by itself"
        panel.text(0.5, 0.5, words, ha="center", va="center", transform=panel.transAxes, fontsize=9)
        panel.set_axis_off()
    else:
        free = [content["free"][k] for k in known_numbers]
        if len(free) == 1:
            panel.errorbar([free[0]["value"]], [0.0], xerr=[free[0]["error"]], fmt="o", color=_RED, capsize=4)
            panel.set_yticks([])
            panel.set_ylim(-0.4, 1.1)
        else:
            covariance = np.array(content["covariance"])[np.ix_(known_numbers, known_numbers)]
            errors = np.sqrt(np.diag(covariance))
            size = np.sqrt(5.991)  # chi squared of two numbers at 95 %
            s, vectors = np.linalg.eigh(covariance / np.outer(errors, errors))
            circle = np.linspace(0.0, 2.0 * np.pi, 181)
            path = vectors @ (np.sqrt(np.maximum(s, 0.0))[:, None] * size * np.array([np.cos(circle), np.sin(circle)]))
            path = path * errors[:, None] + np.array([[number["value"]] for number in free])
            panel.plot(path[0], path[1], color=_RED)
            panel.plot([free[0]["value"]], [free[1]["value"]], "o", ms=4, color=_RED)
            panel.set_ylabel(axis_label(free[1]["key"], free[1]["unit"]), fontsize=9)
        panel.set_xlabel(axis_label(free[0]["key"], free[0]["unit"]), fontsize=9)
    panels[1][-1].set_axis_off()
    lines = []
    for number in content["free"][:4]:
        half = f"± {number['error']:.2g}" if number["determined"] else "not determined"
        lines.append(f"{number['key']}\n  {number['value']:.6g} {half} {number['unit']}".rstrip())
    panels[1][-1].text(0.0, 0.9, "\n".join(lines), va="top", transform=panels[1][-1].transAxes, fontsize=8)
    figure.suptitle(wrapped(content["title"]), fontsize=11)
    return figure


def figures(rotation: Rotation, component: Synchronous, state: State) -> dict[str, Figure]:
    """Figures "signals", "spectrum" and "orbits" of a record; RacewayError without matplotlib."""
    drawings = {"signals": new_figure(8.0, 4.4), "spectrum": new_figure(8.0, 3.4), "orbits": new_figure(5.6, 5.4)}
    first, means = drawings["signals"].subplots(
        2, 1, height_ratios=(3, 2)
    )  # the first turns; the full record as its means over turns
    record = rotation.recording
    early = rotation.angle < 2.0 * np.pi * _TURNS_SHOWN
    turns, time = rotation.angle[early] / (2.0 * np.pi), rotation.means(record.time)
    for name, values, colour in (("y", record.y, _BLUE), ("z", record.z, _RED)):
        first.plot(turns, _MICRO * values[early], color=colour, label=f"gap {name}", linewidth=1.2)
        means.plot(time, _MICRO * rotation.means(values), color=colour)
    _finish(first, "turns", "gap [µm]")
    _finish(means, "time [s]", "mean of a turn [µm]")
    first.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    draw_spectrum(rotation, drawings["spectrum"].subplots())
    draw_orbits(rotation, component, state, drawings["orbits"].subplots())
    drawings["orbits"].legend(loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return drawings


def draw_spectrum(rotation: Rotation, axes: Axes) -> None:
    """Amplitude of y + j z over orders, forward to the right and backward to the left."""
    record, angle = rotation.recording, rotation.angle
    per_turn = 32
    grid = 2.0 * np.pi / per_turn * np.arange(per_turn * rotation.turns)
    plane = np.interp(grid, angle, record.y) + 1j * np.interp(grid, angle, record.z)
    amplitudes = np.abs(np.fft.fft(plane - plane.mean())) / len(plane)
    order = np.fft.fftfreq(len(plane), 1.0 / per_turn)
    visible = np.flatnonzero(np.abs(order) <= _ORDERS_SHOWN)
    visible = visible[np.argsort(order[visible])]
    axes.semilogy(order[visible], _MICRO * np.maximum(amplitudes[visible], 1e-14), color=_BLUE, linewidth=0.9)
    axes.set_xticks(range(-int(_ORDERS_SHOWN), int(_ORDERS_SHOWN) + 1))
    _finish(axes, "order, positive: forward", "amplitude [µm]")


def draw_orbits(rotation: Rotation, component: Synchronous, state: State, axes: Axes) -> None:
    """The orbit at the sensor, its 1x component with and without run-out, and the motion of the bearing itself."""
    record = rotation.recording
    plane = _MICRO * (record.plane - record.plane.mean())[:1500]
    axes.plot(plane.real, plane.imag, color="#d3dae1", linewidth=0.5, label="as measured")
    circle = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    circles: list[tuple[str, complex, str, str]] = [
        ("1x", component.forward, _GREY, "--"),
        ("less the run-out", state.sensor, _BLUE, "-"),
        ("shaft's bow", state.sensor - state.deflection, _RED, ":"),
        ("bearing", state.deflection, _GREEN, "-"),
    ]
    for name, amplitude, colour, style in circles:
        curve = _MICRO * abs(amplitude) * circle
        axes.plot(curve.real, curve.imag, color=colour, linestyle=style, label=f"{name}, {_MICRO * abs(amplitude):.3g} µm")
    axes.set_aspect("equal")
    _finish(axes, "y [µm]", "z [µm]")


def _finish(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)
