"""``raceway band``, with its table.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.frame import (
    RESULTS,
    attempt,
    common,
    has_matplotlib,
    keeping,
    load,
    on_scene,
    out_folder,
    plugin_files,
    processes_at_a_time,
    record,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.framework.registry import registry_with
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from rich.console import RenderableType


class BandOptions(NamedTuple):
    """What ``raceway band`` is given."""

    scene: Path
    changes: tuple[str, ...]
    tolerances: tuple[str, ...]
    size: int
    seed: int
    processes: int
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="The range of an answer over the tolerances of its scene.")
@on_scene
@click.option(
    "--tolerance", "tolerances", multiple=True, metavar="A.B=TEXT", help="'±10 %', '±1 deg', '+2 µm -1 µm', class=P4, balls=G5; repeat for more [the scene's tolerances]."
)  # fmt: skip
@click.option(
    "--count", "size", type=int, default=512, show_default=True, help="n, a power of 2: (d + 2) n samples for d tolerances."
)
@click.option("--seed", type=int, default=1, show_default=True, help="Of the samples.")
@processes_at_a_time
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write histograms and bars as PNG (default).")
@plugin_files
@common
@record(BandOptions)
def band(given: BandOptions) -> int:
    """95 % band of K, displacement and ball loads over tolerances, and the Sobol indices that say which of them causes it.

    Writes band.json and band.png. Numbers are taken evenly from their ranges. Finished samples are kept in DIR/band-rows.jsonl and reused.

    \b
    Example:
      raceway band examples/minimal.toml --tolerance load.axial="±10 %" \\
          --tolerance bearing.contact_angle_deg="±1 deg"
    """
    registry = registry_with(given.plugins)
    loaded = load(given.scene, given.changes, registry)
    tell_faults(registry)
    folder = writable(given.out or RESULTS / f"{slug(loaded.title)}-band")
    kept = folder / "band-rows.jsonl"
    with keeping("samples", kept), show_progress() as progress:
        from raceway.studies.band.front import band as compute

        found = compute(
            loaded, given.tolerances, count=given.size, seed=given.seed, processes=given.processes, kept=kept, progress=progress,
            plugins=given.plugins,
        )  # fmt: skip
    content = found.to_dict()
    files: list[str] = []
    failed = attempt(lambda: [found.save(folder)], files)
    if failed is None and given.pictures and has_matplotlib():
        failed = attempt(lambda: [found.picture(folder)], files)
    show(content, given.as_json, failed, lambda: _screen(content, files))
    return 0


def _screen(content: ReadTables, files: list[str]) -> RenderableType:
    """A line a quantity; below it the samples that have no answer."""
    from rich.console import Group
    from rich.text import Text

    from raceway.framework.shown import read_in
    from raceway.out.table import rows_table

    keys = [one["key"] for one in content["tolerances"]]
    rows = []
    for name, one in content["quantities"].items():
        (value, unit), (low, _), (high, _) = (read_in(one[end], one["unit"]) for end in ("value", "low", "high"))
        row = {"quantity": f"{name.replace('_', ' ')} [{unit}]", "nominal": f"{value:.5g}"}
        row |= {"2.5 %": f"{low:.5g}", "97.5 %": f"{high:.5g}"}
        for k, key in enumerate(keys):
            row[f"total index, {key}"] = "" if one["total"] is None else f"{one['total'][k]:.3f}"
        rows.append(row)
    lines = []
    for one in content["tolerances"]:
        (low, unit), (high, _) = (read_in(one[end], one["unit"]) for end in ("low", "high"))
        lines.append(f"{one['key']}: {low:.6g} to {high:.6g} {unit}".rstrip())
    lines += [f"{name.replace('_', ' ')}: {one['definition']}" for name, one in content["quantities"].items()]
    lines.append(f"{content['samples']} samples")
    if content["lost"]:
        lines.append(f"{content['lost']} have no answer, so that no indices are told: {content['why_lost']}")
    lines += [f"warning: {text}" for text in content["remarks"]]
    lines += [f"written: {', '.join(files)}"] if files else []
    return Group(rows_table(rows, content["title"]), *(Text(line) for line in lines))
