"""The picture of a fit: data beside the fit with its band, residuals below, the confidence region of two numbers to the right."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.plugins.pictures import new_figure, save_figure
from raceway.storage.tables import ReadTables
from raceway.studies.fit.identification import Found

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_DATA, _FIT, _REGION = "#17202b", "#0b5fa5", "#c8501e"
#: Factor and unit of quantities in pictures; columns of panels at most, errors of residuals that are marked.
_UNITS = {"N/m": (1e-6, "N/µm"), "m": (1e6, "µm")}
_MOST, _MARKED = 4, 2.0


def draw(content: ReadTables) -> Figure:
    """Two rows of panels, a column a quantity, and the region of the first two free numbers."""
    series = content["series"][:_MOST]
    columns = len(series) + 1
    figure = new_figure(1.2 + 3.6 * columns, 5.2)
    panels: Any = figure.subplots(2, columns, squeeze=False, height_ratios=(3, 1.4))
    for k, one in enumerate(series):
        _data(panels[0][k], one)
        _residuals(panels[1][k], one)
    _region(panels[0][-1], content)
    _words(panels[1][-1], content)
    figure.suptitle("\n".join(line for text in content["title"].splitlines() for line in wrap(text, 90)), fontsize=11)
    return figure


def _data(panel: Axes, one: ReadTables) -> None:
    factor, unit = _UNITS.get(one["unit"], (1.0, one["unit"]))
    x, fitted, band, measured = (np.array(one[name]) for name in ("x", "fitted", "band", "measured"))
    order, error = np.argsort(x), factor * np.array(one["error"])
    panel.fill_between(
        x[order], factor * (fitted - band)[order], factor * (fitted + band)[order], color=_FIT, alpha=0.22, linewidth=0
    )
    panel.plot(x[order], factor * fitted[order], color=_FIT, label="fit, with its 95 %")
    few = len(x) <= 200
    panel.errorbar(
        x, factor * measured, 1.96 * error if few else None, fmt="o" if few else ".", ms=4 if few else 1, color=_DATA, elinewidth=0.8, label="data",
    )  # fmt: skip
    panel.set_ylabel(f"{one['name']} [{unit}]" if unit else one["name"])
    panel.legend(frameon=False, fontsize=8)


def _residuals(panel: Axes, one: ReadTables) -> None:
    x, error = np.array(one["x"]), np.array(one["error"])
    left = (np.array(one["measured"]) - np.array(one["fitted"])) / np.where(error > 0.0, error, 1.0)
    panel.axhline(0.0, color="#8793a0", linewidth=0.8)
    for sign in (-_MARKED, _MARKED):
        panel.axhline(sign, color="#8793a0", linewidth=0.8, linestyle=":")
    panel.plot(x, left, "o" if len(x) <= 200 else ".", ms=4 if len(x) <= 200 else 1, color=_DATA)
    panel.set_xlabel(f"{one['over']} [{one['over_unit']}]" if one["over_unit"] else one["over"])
    panel.set_ylabel("residual over\nstandard error")


def _region(panel: Axes, content: ReadTables) -> None:
    """The ellipse of two numbers at 95 %; of one number its interval."""
    known = [k for k, one in enumerate(content["free"]) if one["determined"]][:2]
    panel.set_title("confidence region, 95 %", fontsize=10)
    if not known:
        panel.text(
            0.5,
            0.5,
            "the data determine\nno number by itself",
            ha="center",
            va="center",
            transform=panel.transAxes,
            fontsize=9,
        )
        panel.set_axis_off()
        return
    free = [content["free"][k] for k in known]
    if len(known) == 1:
        (one,) = free
        panel.errorbar([one["value"]], [0.0], xerr=[one["error"]], fmt="o", color=_REGION, capsize=4)
        panel.set_yticks([])
        panel.set_ylim(-0.4, 1.1)
    else:
        covariance = np.array(content["covariance"])[np.ix_(known, known)]
        size = np.sqrt(5.991)  # chi squared of two numbers at 95 %
        s, vectors = np.linalg.eigh(covariance / np.outer(*2 * (np.sqrt(np.diag(covariance)),)))
        circle = np.linspace(0.0, 2.0 * np.pi, 181)
        path = vectors @ (np.sqrt(np.maximum(s, 0.0))[:, None] * size * np.array([np.cos(circle), np.sin(circle)]))
        path = path * np.sqrt(np.diag(covariance))[:, None] + np.array([[one["value"]] for one in free])
        panel.plot(path[0], path[1], color=_REGION)
        panel.plot([free[0]["value"]], [free[1]["value"]], "o", ms=4, color=_REGION)
        panel.set_ylabel(_label(free[1]), fontsize=9)
    panel.set_xlabel(_label(free[0]), fontsize=9)


def _words(panel: Axes, content: ReadTables) -> None:
    panel.set_axis_off()
    lines = []
    for one in content["free"][:4]:
        half = f"± {one['error']:.2g}" if one["determined"] else "not determined"
        lines.append(f"{one['key']}\n  {one['value']:.6g} {half} {one['unit']}".rstrip())
    panel.text(0.0, 0.9, "\n".join(lines), va="top", transform=panel.transAxes, fontsize=8)


def _label(one: ReadTables) -> str:
    return f"{one['key']} [{one['unit']}]" if one["unit"] else str(one["key"])


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
