"""The page of a rig's study, and its figures as PNG."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from raceway import __version__
from raceway.plugins.pictures import save_figure
from raceway.storage.tables import Tables
from raceway.studies.fit.picture import orbits, signals, spectrum
from raceway.studies.many.page import Page
from raceway.studies.rig.figures import causes, procedures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from raceway.studies.rig.study import RigStudy


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
        "signals": signals(first),
        "spectrum": spectrum(first),
        "orbits": orbits(first),
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
