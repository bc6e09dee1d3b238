"""``raceway study map``.  Part of ``raceway.cli``."""

from __future__ import annotations

from importlib.resources import as_file, files
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.commands.frame import (
    RESULTS,
    attempt,
    common,
    keeping,
    out_folder,
    plugin_files,
    processes_at_a_time,
    record,
    scene_if_any,
    set_keys,
    show,
    show_progress,
)
from raceway.commands.inputs import changed_tables, has_matplotlib, slug, tell_faults
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.errors import Mistake
    from raceway.framework.registry import Registry


class MapOptions(NamedTuple):
    """What ``raceway study map`` is given."""

    scene: Path | None
    changes: tuple[str, ...]
    vary: tuple[str, ...]
    method: str
    processes: int
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command("map", short_help="Hardening or softening of k(speed) over axial load, tilt and contact angle.")
@scene_if_any
@set_keys
@click.option(
    "--vary", multiple=True, metavar="A.B=X,Y",
    help="Values of an axis: load.axial, excitation.speed_rpm, supports.tilt, bearing.contact_angle_deg.",
)  # fmt: skip
@click.option(
    "--method", type=click.Choice(["quasi_static", "periodic"]), default="quasi_static", show_default=True,
    help="Equilibria under the force as given, or the steady orbit with inertia (ten times slower).",
)  # fmt: skip
@processes_at_a_time
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write map.html and its pictures (default).")
@plugin_files
@common
@record(MapOptions)
def study_map(given: MapOptions) -> int:
    """Map where k(speed) hardens or softens, where balls lose contact, where the groove's edge is reached, where hardening
    saturates. Without SCENE: the article's B7206C under the rig's unbalance, half of it on this bearing.

    Writes map.json, map.csv and map.html. Finished points are kept in DIR/map-rows.jsonl and reused. The table [integrator]
    of a scene is replaced by the method's.

    \b
    Example:
      raceway study map
      raceway study map --vary load.axial=100,1000 \\
          --set excitation.amplitude=constant --set excitation.force=100
    """
    from raceway.studies.map.design import design

    registry = registry_with(given.plugins)
    tables, mistakes = _start(given.scene, given.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    planned = design(tables, given.vary, given.method, registry)
    folder = writable(given.out or RESULTS / f"{slug(str(tables['title']))}-map")
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "map-rows.jsonl"
    with keeping("points", kept), show_progress() as progress:
        from raceway.studies.map.page import write_data, write_pictures
        from raceway.studies.map.study import study_map as study

        found = study(planned, given.processes, kept, registry, given.plugins, progress)
        progress("writing", 0, 0)
        written: list[str] = []
        failed = attempt(lambda: write_data(found, folder), written)
        if pictures and failed is None:
            failed = attempt(lambda: write_pictures(found, folder), written)
    content = {**found.to_dict(), "files": written}
    failed = failed or found.fault
    if failed is None and not any(row["status"] == "completed" for row in found.rows):
        failed = ConvergenceError(f"no point of the map gave a number; the first reason: {found.rows[0]['reason']}")
    show(content, given.as_json, failed, lambda: _screen(content))
    return 0


def _start(scene: Path | None, changes: tuple[str, ...], registry: Registry) -> tuple[Tables, list[Mistake]]:
    """Tables of the scene, or of the map's own, with the changes."""
    if scene is not None:
        return changed_tables(scene, changes, registry)
    with as_file(files("raceway").joinpath("data/map.toml")) as path:
        return changed_tables(path, changes, registry)


def _screen(content: Tables) -> RenderableType:
    from rich.console import Group

    from raceway.commands.screen import Words, rows_table, written

    heads = {"contact lost": "contact_lost_from_rpm", "edge": "edge_from_rpm", "saturates": "saturates_at_rpm"}
    rows = []
    for curve in content["curves"]:
        first, last = curve["first_stiffness"], curve["last_change"]
        rows.append(
            {
                "angle": f"{curve['contact_angle_deg']:g}",
                "tilt": str(curve["tilt"]),
                "axial N": f"{curve['axial']:g}",
                "k0 N/µm": "" if first is None else f"{1e-6 * first:.4g}",
                "k/k0 at the end": "" if last is None else f"{1.0 + last:.3g}",
                **{head: "" if curve[key] is None else f"{curve[key]:.0f}" for head, key in heads.items()},
                "trend": curve["trend"],
            }
        )
    head = f"{content['title']}\n{content['amplitude']}; speeds in r/min"
    return Group(Words(head, "bold"), rows_table(rows), *map(Words, content["words"]), *written(content["files"]))
