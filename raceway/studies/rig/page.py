"""Figures, page and table of a rig's study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Group, RenderableType

from raceway import __version__
from raceway.out.page import Page
from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.plugins.pictures import new_figure, save_figure
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.fit.picture import figures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.studies.rig.study import RigStudy


_COLOURS = ("#0b5fa5", "#c8501e", "#2a8f5b", "#8a4fa3")
_KINDS = {"none": "#2a8f5b", "correction": "#c8501e", "noise": "#0b5fa5", "window": "#8a4fa3", "run-out": "#b58a00", "model": "#555f6b"}  # fmt: skip
#: Errors below this are drawn at the edge.
_LEAST_PERCENT = 1e-4


def procedures(study: RigStudy) -> Figure:
    """True K over speed, and what each correction makes of it."""
    figure = new_figure(9.2, 3.8)
    loads = list(dict.fromkeys(point.axial for point in study.points))
    for panel, axial in zip(np.atleast_1d(figure.subplots(1, len(loads), sharey=True)), loads, strict=True):
        points = [point for point in study.points if point.axial == axial]
        speeds = [30.0 / np.pi * point.state.speed for point in points]
        panel.plot(speeds, [1e-6 * p.state.stiffness for p in points], color="#1c2733", marker="o", label="true")
        found = [1e-6 * p.found.state.stiffness for p in points]
        panel.plot(speeds, found, color=_COLOURS[2], marker="x", markersize=9, linestyle="", label="beam inverted")
        for place, style in ((0, "--"), (3, ":"), (5, "-.")):
            name = points[0].readings[place].correction
            values = [1e-6 * p.readings[place].stiffness for p in points]
            label = {"none": "no correction"}.get(name, name)
            panel.plot(speeds, values, color=_COLOURS[1], linestyle=style, marker=".", label=label)
        panel.set_title(f"{axial:g} N axial", fontsize=11)
        panel.set_xlabel("speed [r/min]")
        panel.set_xticks(speeds)
        panel.grid(color="#d8dee4", linewidth=0.7)
    # One scale for all panels, and set when all are drawn: a limit that is set holds, whatever comes after it.
    figure.axes[0].set_ylim(bottom=0.0)
    figure.axes[0].set_ylabel("K [N/µm]")
    figure.legend(
        *figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9
    )
    return figure


def causes(study: RigStudy) -> Figure:
    """Error of K by one cause at a time: a dot for each speed and load, on a logarithmic scale."""
    names = list(dict.fromkeys((cause.kind, cause.what) for point in study.points for cause in point.causes))
    figure = new_figure(9.2, 0.34 * len(names) + 1.1)
    axes: Axes = figure.subplots()
    for row, (kind, what) in enumerate(reversed(names)):
        errors = [100.0 * abs(c.error) for p in study.points for c in p.causes if (c.kind, c.what) == (kind, what)]
        sizes = np.maximum(errors, _LEAST_PERCENT)
        axes.plot(sizes, np.full(len(sizes), row), "o", color=_KINDS[kind], markersize=5, alpha=0.75)
    words = [fill(f"{kind}: {what}" if kind != "none" else what, 46) for kind, what in reversed(names)]
    axes.set_yticks(range(len(names)), words, fontsize=8)
    axes.set_xscale("log")
    largest = 100.0 * max(abs(cause.error) for point in study.points for cause in point.causes)
    axes.set_xlim(0.8 * _LEAST_PERCENT, max(200.0, 1.5 * largest))
    for limit in (1.0, 3.0):
        axes.axvline(limit, color="#1c2733", linewidth=0.8, linestyle="--")
        axes.annotate(
            f"{limit:g} %", (limit, 1.0), (0, 2), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", va="bottom", fontsize=8,
        )  # fmt: skip
    axes.set_xlabel("error of K by this cause alone [%]")
    axes.grid(color="#d8dee4", linewidth=0.7)
    axes.set_axisbelow(True)
    return figure


#: Corrections of the article's kind that the screen shows; all of them are in rig.json.
_SHOWN = {"as printed": "printed", "simply supported beam, amplified bow and force": "derived"}


def rig_screen(study: ReadTables, files: Sequence[str]) -> RenderableType:
    """A line for each speed and load: the true bearing, the article's procedure, the beam inverted."""
    rows = [_point(row) for row in study["rows"]]
    worst = study["worst"]
    speeds = ", ".join(f"{value:.0f} r/min on {name}" for name, value in study["critical_speed_rpm"].items())
    parts: list[RenderableType] = [
        Words(study["title"], "bold"),
        Words(f"first critical speed {speeds}", "dim"),
        rows_table(rows),
        Words(
            "x: the bearing's own motion; printed, derived: K by such a correction over the true K; found: by the inverted beam"
        ),
        Words(
            f"inverted beam: at most {100 * worst['clean']:.2g} % off without noise, {100 * worst['disturbed']:.2g} % with all"
        ),
        rows_table(_causes(study["worst_by_cause"]), "Largest error of K by one cause at a time"),
    ]
    parts += [
        Words(f"failed: {one['speed_rpm']:.0f} r/min, {one['axial_n']:.0f} N: {one['reason']}", "red")
        for one in study["failed"]
    ]
    return Group(*parts, *written(files))


def _point(row: ReadTables) -> dict[str, str]:
    true, found = row["true"], row["identified"]
    ratios = {one["correction"]: one["over_true"] for one in row["printed"]}
    return {
        "r/min": f"{row['speed_rpm']:.0f}",
        "axial N": f"{row['axial_n']:.0f}",
        "x µm": f"{1e6 * true['deflection_m']:.2f}",
        "sensor µm": f"{1e6 * true['sensor_m']:.2f}",
        "K N/µm": f"{1e-6 * true['equivalent_stiffness']:.2f}",
        **{words: f"{ratios[name]:.3f}" for name, words in _SHOWN.items()},
        "found %": f"{100 * found['error']:+.3f}",
        "+- %": f"{100 * found['relative_uncertainty']:.2f}",
    }


def _causes(causes: Sequence[ReadTables]) -> list[dict[str, str]]:
    return [{"cause": one["kind"], "what": one["what"], "error %": f"{100 * one['error']:+.3g}"} for one in causes]


def write_page(study: RigStudy, folder: Path) -> list[Path]:
    """rig.html and its figures as PNG.

    Raises
    ------
    RacewayError
        matplotlib is missing, or a folder that cannot be written.
    """
    first = study.points[0].found
    drawn = {
        "procedures": procedures(study),
        **figures(first),
        "error-split": causes(study),
    }
    files = [save_figure(figure, folder / f"{name}.png", 110) for name, figure in drawn.items()]
    return [page(study, drawn).write(folder / "rig.html"), *files]


_ASSUMED = [
    "Both bearings carry the same load and are mirror images about the disc; supports are rigid, coupling and weight are left out.",
    "The shaft is a Timoshenko beam with rotary inertia and gyroscopic moments; the disc is rigid and does not stiffen it beyond `hub_diameter`.",
    "The bearing is the scene's, nonlinear: force and moment of the shaft act on it in a run of its own, until shaft and "
    "bearing move alike. Motion at other orders than 1x is left out of the signals.",
    "The inversion takes the bearing's tilt under the identified force from the scene; its deflection is the signal's.",
]


def page(study: RigStudy, drawn: dict[str, Figure]) -> Page:
    """Words, tables and figures."""
    content = study.to_dict()
    worst, rows, own = content["worst"], content["rows"], study.rig
    out = Page(
        f"What a sensor beside a bearing tells of it: {study.title}", _rig_words(study), f"Raceway {__version__}, study rig"
    )
    out.section("Result")
    out.text(
        f"Inverting the beam finds K within {100 * worst['clean']:.2g} % from clean signals, and within "
        f"{100 * worst['disturbed']:.2g} % with noise of {own.signals.noise_db:g} dB, {1e6 * own.signals.drift:g} µm of drift and "
        f"{1e6 * own.signals.run_out:g} µm of run-out, less what a slow roll shows.",
        kind="lead",
    )
    out.table(*_truth(rows), caption="The tested bearing in the rig, and K as it is identified; uncertainty at 95 %")
    out.figures(
        [(drawn["procedures"], "K over speed for each axial load, true and by each procedure", "K by each procedure")]
    )
    for one in study.failed:
        out.text(f"Failed: {one['speed_rpm']:.0f} r/min, {one['axial_n']:.0f} N: {one['reason']}", kind="note")
    out.section("The article's procedure")
    out.text(
        "Detrend, denoise, whole-turn Fourier transform, F = m e w²/2, less the shaft's deflection as printed, "
        "m e w² a (3 L² - 16 a²) / (192 E I), over 1 - r². The run-out stays in, as the article subtracts none. A simply supported "
        "beam bends by m e w² a (3 L² - 4 a²) / (48 E I), which is the printed formula for an L of twice the span; the bearing's "
        "force is amplified, too, because the bow moves the disc outwards.",
    )
    out.table(*_printed(rows), caption="K over the true K, by the correction for the shaft")
    _signals(out, study, drawn)
    out.section("What is assumed")
    out.listing(_ASSUMED)
    return out


def _signals(out: Page, study: RigStudy, drawn: dict[str, Figure]) -> None:
    """Signals, spectrum and orbits; the error by its causes."""
    out.section("Signals")
    out.figures(
        [
            (
                drawn["signals"],
                "gaps along y and z over four turns, and their drift",
                f"The sensor at {study.points[0].name}",
            ),
            (drawn["spectrum"], "amplitude over orders, one peak at 1x forward", "Spectrum over orders"),
            (
                drawn["orbits"],
                "orbits as circles: sensor, bow, bearing",
                "Orbits: most of what the sensor sees is the shaft's bow",
            ),
        ]
    )
    out.section("Where the error comes from")
    out.text("One cause at a time is switched on, all others off. Dashed: 1 % and 3 %; a dot for each speed and load.")
    out.figures(
        [(drawn["error-split"], "dots of error for each cause on a logarithmic scale", "Error of K by its causes")],
        wide=True,
    )
    out.table(*_split(study.to_dict()["rows"]), caption="Error of K [%] by one cause at a time")


def _rig_words(study: RigStudy) -> str:
    rig = study.rig
    return (
        f"Shaft {1e3 * rig.shaft_length:g} mm long, {1e3 * rig.shaft_diameter:g} mm thick, disc of {rig.disc_mass:.3g} kg, bearings "
        f"{1e3 * rig.span:g} mm apart, {1e3 * rig.unbalance_mass:g} g at {1e3 * rig.unbalance_radius:g} mm; sensor "
        f"{1e3 * rig.sensor_distance:g} mm {rig.sensor_side} the tested bearing"
    )


def _name(row: Tables) -> str:
    return f"{row['speed_rpm']:.0f}\u00a0r/min, {row['axial_n']:.0f}\u00a0N"  # no line ends between number and unit


def _truth(rows: list[Tables]) -> tuple[list[str], list[list[str]]]:
    columns = ["point", "force [N]", "over m e w²/2", "bearing [µm]", "sensor [µm]", "true K [N/µm]", "identified", "uncertainty", "off [%]"]  # fmt: skip
    lines = []
    for row in rows:
        true, found = row["true"], row["identified"]["identification"]
        values = [true["force_n"], true["force_over_half_unbalance"], 1e6 * true["deflection_m"], 1e6 * true["sensor_m"]]
        k = [true["equivalent_stiffness"], found["equivalent_stiffness"], found["equivalent_stiffness_error"]]
        cells = [f"{value:.4g}" for value in values] + [f"{1e-6 * value:.3f}" for value in k]
        lines.append([_name(row), *cells, f"{100 * row['identified']['error']:.3f}"])
    return columns, lines


def _printed(rows: list[Tables]) -> tuple[list[str], list[list[str]]]:
    names = [one["correction"] for one in rows[0]["printed"]]
    lines = [
        [name, *(f"{one['over_true']:.3f}" for row in rows for one in row["printed"] if one["correction"] == name)]
        for name in names
    ]
    return ["correction", *(_name(row) for row in rows)], lines


def _split(rows: list[Tables]) -> tuple[list[str], list[list[str]]]:
    lines = []
    for place, cause in enumerate(rows[0]["split"]):
        errors = [f"{100 * row['split'][place]['error']:.3g}" for row in rows]
        lines.append([f"{cause['kind']}: {cause['what']}", *errors])
    return ["cause", *(_name(row) for row in rows)], lines
