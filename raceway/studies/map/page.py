"""Files of a map: map.json, map.csv, pictures, and map.html with all of it."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.pipeline.result import without_nan, write_json
from raceway.plugins.reports.pictures import save_figure
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables
from raceway.studies.many.page import Page
from raceway.studies.map.design import AXES
from raceway.studies.map.picture import at_angle, can_map, change_map, curves_figure, exponent_map
from raceway.studies.map.study import Map

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure

_ROW = (
    "status", "reason", "stiffness", "change", "exponent", "error", "small_signal", "force", "lost", "unseats", "reach_inner",
    "reach_outer", "largest_load", "largest_pressure", "axial_displacement",
)  # fmt: skip
_UNITS = {
    "stiffness": "N/m", "small_signal": "N/m", "force": "N", "largest_load": "N", "largest_pressure": "Pa",
    "axial_displacement": "m", "load.axial": "N", "excitation.speed_rpm": "r/min", "bearing.contact_angle_deg": "deg",
}  # fmt: skip

#: What names a row of the tables of curves.
_OF_A_CURVE = ("contact angle [deg]", "tilt", "axial load [N]")


def write_data(found: Map, folder: Path) -> list[Path]:
    """Write map.json and map.csv."""
    content = without_nan(found.to_dict())
    return [write_json(content, folder / "map.json"), write_whole(_csv(content).encode(), folder / "map.csv")]


def write_pictures(found: Map, folder: Path) -> list[Path]:
    """Write map.html, and its figures as PNG files."""
    content = without_nan(found.to_dict())
    paths = [save_figure(draw(content), folder / name, 110) for name, (draw, _) in _drawn(content).items()]
    return [*paths, _page(content).write(folder / "map.html")]


def _drawn(content: Tables) -> dict[str, tuple[Callable[[Tables], Figure], str]]:
    """File -> what draws it, and what is seen on it."""
    curves: dict[str, tuple[Callable[[Tables], Figure], str]] = {
        "map-curves.png": (curves_figure, "k over speed for each axial load")
    }
    if not can_map(content):
        return curves
    return {
        "map-change.png": (change_map, "k over its value at the lowest speed, by speed and axial load"),
        "map-exponent.png": (exponent_map, "local exponent of k over speed, by speed and axial load"),
        **curves,
    }


def _csv(content: Tables) -> str:
    """A line for each point; units stand in the head."""
    memory = io.StringIO()
    lines = csv.writer(memory, lineterminator="\n")
    lines.writerow([f"{name} [{_UNITS[name]}]" if name in _UNITS else name for name in (*AXES, *_ROW)])
    for row in content["rows"]:
        lines.writerow([*(row["point"][key] for key in AXES), *(row.get(name) for name in _ROW)])
    return memory.getvalue()


def _page(content: Tables) -> Page:
    page = Page(
        f"Hardening or softening: {content['title']}",
        f"k(speed) over axial load, tilt and contact angle; {content['amplitude']}",
        "Made by `raceway study map`; opens without a network. Numbers: `map.json`, `map.csv`.",
    )
    page.section("In words")
    page.listing(content["words"])
    page.section("Maps")
    for draw, seen in _drawn(content).values():
        page.heading(seen)
        angles = content["axes"]["bearing.contact_angle_deg"]
        page.figures([(draw(at_angle(content, angle)), f"{seen}, {angle:g} deg", f"{angle:g} deg") for angle in angles])
    page.section("What the numbers are")
    page.listing(f"{name.replace('_', ' ')}: {text}" for name, text in content["definitions"].items())
    page.section("Every curve")
    page.table(
        [
            *_OF_A_CURVE,
            "trend",
            "k at the lowest speed [N/µm]",
            "change at the highest [%]",
            "least [%]",
            "largest [%]",
            "small signals [%]",
            "failed",
        ],
        [_trend(curve) for curve in content["curves"]],
        caption="k over speed; changes are relative to the lowest speed",
    )
    page.table(
        [
            *_OF_A_CURVE, "largest exponent", "at [r/min]", "last exponent", "saturates [r/min]", "contact lost from [r/min]",
            "unseats from [r/min]", "groove's edge from [r/min]",
        ],
        [_limits(curve) for curve in content["curves"]],
        caption="Exponents of k over speed, and the speeds from which a curve does so; a dash: not within these speeds",
    )  # fmt: skip
    page.section("Points without a number")
    failed = [row for row in content["rows"] if row["status"] != "completed"]
    if failed:
        page.table([*AXES, "status", "reason"], [[*row["point"].values(), row["status"], row["reason"]] for row in failed])
    else:
        page.text(f"None: all {len(content['rows'])} points gave a number.")
    return page


def _trend(curve: Tables) -> list[str | None]:
    percent = (curve[f"{name}_change"] for name in ("last", "least", "largest", "small_signal"))
    changes = [None if value is None else f"{100.0 * value:+.3g}" for value in percent]
    return [*_curve(curve), curve["trend"], _plain(curve["first_stiffness"], "{:.4g}", 1e-6), *changes, str(curve["failed"])]


def _limits(curve: Tables) -> list[str | None]:
    speeds = (curve[f"{name}_rpm"] for name in ("saturates_at", "contact_lost_from", "unseats_from", "edge_from"))
    exponents = [_plain(curve["steepest_exponent"], "{:.2f}"), _plain(curve["steepest_at_rpm"], "{:.0f}")]
    return [*_curve(curve), *exponents, _plain(curve["last_exponent"], "{:.2f}"), *(_plain(v, "{:.0f}") for v in speeds)]


def _curve(curve: Tables) -> list[str | None]:
    return [_plain(curve["contact_angle_deg"]), str(curve["tilt"]), _plain(curve["axial"], "{:.5g}")]


def _plain(value: float | None, form: str = "{:.4g}", factor: float = 1.0) -> str | None:
    return None if value is None else form.format(factor * value)
