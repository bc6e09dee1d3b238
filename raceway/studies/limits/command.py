"""``raceway study limits``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from raceway.cli.frame import common, load, on_scene, plugin_files, show, show_progress, tell_faults
from raceway.framework.registry import registry_with
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from rich.console import RenderableType


@click.command("limits", short_help="Axial loads at which a set's rows lift off, and those that its contacts carry.")
@on_scene
@click.option(
    "--pressure", type=float, default=4.2e9, show_default=True, help="Peak pressure [Pa] that limits loads: ISO 76's."
)
@plugin_files
@common
def study_limits(scene: Path, changes: tuple[str, ...], pressure: float, plugins: tuple[Path, ...], as_json: bool) -> int:
    """Axial loads, along +x and -x, at which rows of the set in SCENE lift off, contact ellipses reach the groove's edge, and
    peak pressures a limit. Preload, speed, fits and temperatures are the scene's, its loads are left out.

    \b
    Example:
      raceway study limits examples/set_tbt.toml --set bearing.preload=400
    """
    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    tell_faults(registry)
    with show_progress():
        from raceway.studies.limits.study import axial_limits, limits_table

        content = limits_table(loaded, axial_limits(loaded, pressure, registry), pressure)
    show(content, as_json, None, lambda: _screen(content))
    return 0


def _screen(content: ReadTables) -> RenderableType:
    """A line for each direction."""
    from raceway.out.table import rows_table

    rows = []
    for one in content["limits"]:
        row = {"load along": one["direction"]}
        for key, words in (
            ("lift_off", "lift-off"),
            ("edge", "groove's edge"),
            ("pressure", f"{1e-6 * content['pressure_pa']:g} MPa"),
        ):
            load, place = one[key]["load_n"], one[key]["row"]
            row[f"{words} [N]"] = "never" if load is None else f"{load:.5g}"
            row[f"{words}, row"] = "" if place is None else str(place)
        row["lift-off / preload"] = "" if one["over_preload"] is None else f"{one['over_preload']:.4g}"
        row["limiting [N]"] = "none" if one["limiting_n"] is None else f"{one['limiting_n']:.5g}"
        rows.append(row)
    signs = "".join(one["direction"] for one in content["rows"])
    return rows_table(
        rows, f"{content['title']}\nrows {signs}, preload {content['preload_n']:g} N of the {content['preload_of']}"
    )
