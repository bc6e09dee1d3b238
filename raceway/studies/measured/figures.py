"""Figures of a record: its first turns, its spectrum, and the orbits at the sensor and in the bearing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from raceway.plugins.pictures import new_figure, save_figure
from raceway.studies.measured.identify import Found

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_Y, _Z, _GREY, _GREEN = "#0b5fa5", "#c8501e", "#8793a0", "#2a8f5b"
_MICRO, _TURNS_SHOWN, _ORDERS_SHOWN = 1e6, 4, 6.0


def write_figures(found: Found, folder: Path) -> list[Path]:
    """signals.png, spectrum.png and orbits.png.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder that cannot be written.
    """
    drawn = {"signals": signals(found), "spectrum": spectrum(found), "orbits": orbits(found)}
    return [save_figure(figure, folder / f"{name}.png", 110) for name, figure in drawn.items()]


def signals(found: Found) -> Figure:
    """The first turns, and the whole record as its means over turns."""
    record, angle = found.turning.recording, found.turning.angle
    figure = new_figure(8.0, 4.4)
    first, whole = figure.subplots(2, 1, height_ratios=(3, 2))
    shown = angle < 2.0 * np.pi * _TURNS_SHOWN
    for name, values, colour in (("y", record.y, _Y), ("z", record.z, _Z)):
        first.plot(angle[shown] / (2.0 * np.pi), _MICRO * values[shown], color=colour, label=f"gap {name}", linewidth=1.2)
        turn = np.minimum((angle / (2.0 * np.pi)).astype(int), found.turning.turns - 1)
        counts = np.maximum(np.bincount(turn), 1)
        whole.plot(np.bincount(turn, record.time) / counts, _MICRO * np.bincount(turn, values) / counts, color=colour)
    _axis_labels(first, "turns", "gap [µm]")
    _axis_labels(whole, "time [s]", "mean of a turn [µm]")
    first.legend(loc="upper right", ncols=2, frameon=False)
    return figure


def spectrum(found: Found) -> Figure:
    """Amplitude of y + j z over orders, as a figure."""
    figure = new_figure(8.0, 3.4)
    draw_spectrum(found, figure.subplots())
    return figure


def draw_spectrum(found: Found, axes: Axes) -> None:
    """Amplitude of y + j z over orders, forward to the right and backward to the left."""
    record, angle, turns = found.turning.recording, found.turning.angle, found.turning.turns
    per_turn = 32
    grid = 2.0 * np.pi / per_turn * np.arange(per_turn * turns)
    plane = np.interp(grid, angle, record.y) + 1j * np.interp(grid, angle, record.z)
    lines = np.abs(np.fft.fft(plane - plane.mean())) / len(plane)
    order = np.fft.fftfreq(len(plane), 1.0 / per_turn)
    shown = np.flatnonzero(np.abs(order) <= _ORDERS_SHOWN)
    shown = shown[np.argsort(order[shown])]
    axes.semilogy(order[shown], _MICRO * np.maximum(lines[shown], 1e-14), color=_Y, linewidth=0.9)
    axes.set_xticks(range(-int(_ORDERS_SHOWN), int(_ORDERS_SHOWN) + 1))
    _axis_labels(axes, "order (positive: turning with the shaft)", "amplitude [µm]")


def orbits(found: Found) -> Figure:
    """The orbits, as a figure."""
    figure = new_figure(5.6, 5.4)
    draw_orbits(found, figure.subplots())
    figure.legend(loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return figure


def draw_orbits(found: Found, axes: Axes) -> None:
    """The track that the sensor sees, its 1x line with and without run-out, and the bearing's own motion."""
    record, state = found.turning.recording, found.state
    shown = slice(0, min(len(record.time), 1500))
    plane = record.plane - record.plane.mean()
    axes.plot(_MICRO * plane[shown].real, _MICRO * plane[shown].imag, color="#d3dae1", linewidth=0.5, label="as measured")
    circle = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    found_lines: list[tuple[str, complex, str, str | tuple[int, tuple[int, ...]]]] = [
        ("1x line", found.order.line, _GREY, "--"),
        ("less the run-out", state.sensor, _Y, "-"),
        ("shaft's bow", state.sensor - state.deflection, _Z, ":"),
        ("bearing", state.deflection, _GREEN, "-"),
    ]
    for name, line, colour, style in found_lines:
        curve = _MICRO * abs(line) * circle
        axes.plot(curve.real, curve.imag, color=colour, linestyle=style, label=f"{name}, {_MICRO * abs(line):.3g} µm")
    axes.set_aspect("equal")
    _axis_labels(axes, "y [µm]", "z [µm]")


def _axis_labels(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)
