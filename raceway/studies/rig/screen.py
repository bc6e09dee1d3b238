"""Tables of a rig's study and of identified signals.  Prints nothing by itself."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, number, rows_table, sections, written
from raceway.storage.tables import ReadTables

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


def identify_screen(found: ReadTables, files: Sequence[str]) -> RenderableType:
    """Signals, line, bearing, K and C."""
    signals, line, run_out, bearing = found["signals"], found["line"], found["run_out"], found["bearing"]
    known, speed = found["identification"], signals["speed_rpm"]
    z = known["dynamic_stiffness"]
    angle = "" if line["angle_deg"] is None else f"{line['angle_deg']:.2f} deg from the mark"
    uncertain = f"+- {number(1e-6 * known['equivalent_stiffness_error'], 'N/µm', 2)} at 95 %"
    rows = [
        ("Signals", "", f"{signals['samples']} samples, {signals['turns']} turns, angle from {signals['angle_from']}"),
        ("speed", number(speed["mean"], "r/min", 6), f"{speed['lowest']:.1f} to {speed['highest']:.1f} r/min"),
        ("1x line, forward", number(1e6 * line["forward_m"], "µm"), angle),
        ("1x line, backward", number(1e6 * line["backward_m"], "µm", 3), f"fit leaves {100 * line['residual']:.2g} %"),
        ("run-out", number(1e6 * run_out["amplitude_m"], "µm", 4), run_out["how"]),
        ("Bearing", "", "what the inverted beam makes of it"),
        ("deflection", number(1e6 * bearing["deflection_m"], "µm"), f"of {1e6 * bearing['sensor_m']:.4g} µm at the sensor"),
        ("force, moment", number(bearing["force_n"], "N"), f"{bearing['moment_nm']:.4g} N m, slope {bearing['slope_rad']:.3g} rad"),
        (f"Dynamic stiffness at {known['speed_rpm']:.0f} r/min", "", known["definition"]),
        ("|Z|", number(1e-6 * z["abs"], "N/µm"), "force over deflection"),
        ("K", number(1e-6 * known["equivalent_stiffness"], "N/µm"), f"{uncertain}; Re Z + m w^2, m = {known['mass_used_kg']:.4g} kg"),
    ]  # fmt: skip
    if known["equivalent_damping"] is not None:
        wide = known["equivalent_damping_error"]
        resolved = abs(known["equivalent_damping"]) > wide
        value = number(known["equivalent_damping"], "N s/m", 4) if resolved else "not resolved"
        rows.append(
            ("C", value, f"+- {wide:.2g} N s/m at 95 %" if resolved else f"below its uncertainty of {wide:.2g} N s/m")
        )
    rows.append(
        ("K of the scene's bearing", number(1e-6 * known["scene_stiffness"], "N/µm"), "under the same force and moment")
    )
    locked = known["tilt_locked"]
    wide = f"+- {number(1e-6 * locked['equivalent_stiffness_error'], 'N/µm', 2)} at 95 %"
    rows.append(("K, tilt locked", number(1e-6 * locked["equivalent_stiffness"], "N/µm"), f"{wide}; {locked['definition']}"))
    rows.append(("Relative change of K if", "", "what is taken as known were otherwise"))
    rows += [(one["change"], f"{100 * one['stiffness']:+.2f} %", "") for one in found["sensitivities"]]
    parts: list[RenderableType] = [Words(found["title"], "bold"), sections(rows)]
    parts += [Words(f"warning: {text}", "yellow") for text in found["warnings"]]
    return Group(*parts, *written(files))
