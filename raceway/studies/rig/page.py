"""The rig's study as figures and page."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from raceway import __version__
from raceway.out.page import Page
from raceway.out.picture import label_axes, new_figure, save_figure
from raceway.storage.tables import Tables
from raceway.studies.fit.picture import figures
from raceway.studies.rig.study import failure_words, point_name, point_row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.studies.rig.study import RigStudy


_COLOURS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3")
_KINDS = {"none": "#2a8f5b", "correction": "#c8501e", "noise": "#0b5fa5", "window": "#8a4fa3", "run-out": "#b58a00", "model": "#555f6b"}  # fmt: skip
#: Errors below this are drawn at the edge.
_LEAST_PERCENT = 1e-4


def _procedures(study: RigStudy) -> Figure:
    """True K over speed, and what each correction makes of it."""
    figure = new_figure(9.2, 3.8)
    loads = list(dict.fromkeys(point.axial for point in study.points))
    for panel, axial in zip(np.atleast_1d(figure.subplots(1, len(loads), sharey=True)), loads, strict=True):
        points = [point for point in study.points if point.axial == axial]
        speeds = [30.0 / np.pi * point.state.speed for point in points]
        panel.plot(speeds, [1e-6 * p.state.stiffness for p in points], color="#1c2733", marker="o", label="true")
        inverted = [1e-6 * p.identified.state.stiffness for p in points]
        panel.plot(speeds, inverted, color=_COLOURS[2], marker="x", markersize=9, linestyle="", label="beam inverted")
        for k, style in ((0, "--"), (3, ":"), (5, "-.")):
            name = points[0].readings[k].correction
            values = [1e-6 * p.readings[k].stiffness for p in points]
            label = {"none": "no correction"}.get(name, name)
            panel.plot(speeds, values, color=_COLOURS[1], linestyle=style, marker=".", label=label)
        label_axes(panel, f"{axial:g} N axial", "speed [r/min]", "", 10.0)
        panel.set_xticks(speeds)
    # One scale for all panels, and set when all are drawn: a limit that is set holds, whatever comes after it.
    figure.axes[0].set_ylim(bottom=0.0)
    figure.axes[0].set_ylabel("K [N/µm]")
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9
    )
    return figure


def _causes(study: RigStudy) -> Figure:
    """Error of K by one cause at a time: a dot for each speed and load, on a logarithmic scale."""
    names = list(dict.fromkeys((cause.kind, cause.what) for point in study.points for cause in point.causes))
    figure = new_figure(9.2, 0.34 * len(names) + 1.1)
    axes: Axes = figure.subplots()
    for row, name in enumerate(reversed(names)):
        errors = [100.0 * abs(c.error) for p in study.points for c in p.causes if (c.kind, c.what) == name]
        sizes = np.maximum(errors, _LEAST_PERCENT)
        axes.plot(sizes, np.full(len(sizes), row), "o", color=_KINDS[name[0]], markersize=5, alpha=0.75)
    words = [fill(f"{kind}: {text}" if kind != "none" else text, 46) for kind, text in reversed(names)]
    axes.set_yticks(range(len(names)), words)
    axes.set_xscale("log")
    largest = 100.0 * max(abs(cause.error) for point in study.points for cause in point.causes)
    axes.set_xlim(0.8 * _LEAST_PERCENT, max(200.0, 1.5 * largest))
    for limit in (1.0, 3.0):
        axes.axvline(limit, color="#1c2733", linewidth=0.8, linestyle="--")
        axes.annotate(
            f"{limit:g} %", (limit, 1.0), (0, 2), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", va="bottom", fontsize=8,
        )  # fmt: skip
    label_axes(axes, "", "error of K by this cause alone [%]", "", 9.0)
    return figure


def write_page(study: RigStudy, folder: Path) -> list[Path]:
    """rig.html and its figures as PNG.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder that cannot be written.
    """
    record = figures(study.points[0].identified)
    drawn = {"procedures": _procedures(study), **record, "error-split": _causes(study)}
    files = [save_figure(figure, folder / f"{name}.png", 110) for name, figure in drawn.items()]
    return [_page(study, drawn).write(folder / "rig.html"), *files]


_ASSUMED = [
    "Both bearings carry the same load and are mirror images about the disc; supports are rigid, coupling and weight are left out.",
    "The shaft is a Timoshenko beam with rotary inertia and gyroscopic moments; the disc is rigid and does not stiffen it beyond `hub_diameter`.",
    "The bearing is the scene's, nonlinear: force and moment of the shaft act on it in a run of its own, until shaft and "
    "bearing move alike. Motion at other orders than 1x is left out of the signals.",
    "The inversion takes the bearing's tilt under the identified force from the scene; its deflection is the signal's.",
]


def _page(study: RigStudy, drawn: dict[str, Figure]) -> Page:
    """Words, tables and figures."""
    content, rig, signals = study.to_dict(), study.rig, study.rig.signals
    worst, rows = content["worst"], content["rows"]
    words = (
        f"Shaft {1e3 * rig.shaft_length:g} mm long, {1e3 * rig.shaft_diameter:g} mm thick, disc of {rig.disc_mass:.3g} kg, bearings "
        f"{1e3 * rig.span:g} mm apart, {1e3 * rig.unbalance_mass:g} g at {1e3 * rig.unbalance_radius:g} mm; sensor "
        f"{1e3 * rig.sensor_distance:g} mm {rig.sensor_side} the tested bearing"
    )
    out = Page(
        f"Identification of a bearing from a sensor beside it: {study.title}", words, f"Raceway {__version__}, study rig"
    )
    out.section("Result")
    out.text(
        f"Inversion of the beam identifies K within {100 * worst['clean']:.2g} % from clean signals, and within "
        f"{100 * worst['disturbed']:.2g} % with noise of {signals.noise_db:g} dB, {1e6 * signals.drift:g} µm of drift and "
        f"{1e6 * signals.run_out:g} µm of run-out, less what a slow roll shows.",
        kind="lead",
    )
    out.rows(
        list(map(point_row, rows)), "The tested bearing in the rig, and K as it is identified; ±: its uncertainty at 95 %"
    )
    alternative = "K over speed for each axial load, true and by each procedure"
    out.figures([(drawn["procedures"], alternative, "K by each procedure")])
    for point in study.failed:
        out.text(f"Failed: {failure_words(point)}", kind="note")
    out.section("The article's procedure")
    out.text(
        "Detrend, denoise, whole-turn Fourier transform, F = m e w²/2, less the shaft's deflection as printed, "
        "m e w² a (3 L² - 16 a²) / (192 E I), over 1 - r². The run-out stays in, as the article subtracts none. A simply supported "
        "beam bends by m e w² a (3 L² - 4 a²) / (48 E I), which is the printed formula for an L of twice the span; the bearing's "
        "force is amplified, too, because the bow moves the disc outwards.",
    )
    names = [point_name(row) for row in rows]
    ratios = zip(*(row["printed"] for row in rows), strict=True)
    lines = [[readings[0]["correction"], *(f"{reading['over_true']:.3f}" for reading in readings)] for readings in ratios]
    out.table(["correction", *names], lines, "K over the true K, by the correction for the shaft")
    _signals(out, rows, drawn, study.points[0].name)
    out.section("What is assumed")
    out.listing(_ASSUMED)
    return out


def _signals(out: Page, rows: list[Tables], drawn: dict[str, Figure], point: str) -> None:
    """Signals, spectrum and orbits of a point; the error by its causes."""
    out.section("Signals")
    out.figures([
        (drawn["signals"], "gaps along y and z over four turns, and their drift", f"The sensor at {point}"),
        (drawn["spectrum"], "amplitude over orders, one peak at 1x forward", "Spectrum over orders"),
        (drawn["orbits"], "orbits as circles: sensor, bow, bearing", "Orbits: most of what the sensor sees is the shaft's bow"),
    ])  # fmt: skip
    out.section("Where the error comes from")
    out.text("One cause at a time is switched on, all others off. Dashed: 1 % and 3 %; a dot for each speed and load.")
    alternative = "dots of error for each cause on a logarithmic scale"
    out.figures([(drawn["error-split"], alternative, "Error of K by its causes")], wide=True)
    causes_of_points = zip(*(row["split"] for row in rows), strict=True)
    lines = [
        [f"{cause[0]['kind']}: {cause[0]['what']}", *(f"{100 * row['error']:.3g}" for row in cause)]
        for cause in causes_of_points
    ]
    out.table(["cause", *map(point_name, rows)], lines, "Error of K [%] by one cause at a time")
