"""``raceway follow``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click
from rich.console import Group, RenderableType

from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_matplotlib,
    on_scene,
    out_option,
    plugin_files,
    record,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import SceneError
from raceway.framework.registry import registry_with
from raceway.out.table import rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables

#: Special points and peaks that are shown at most; all are in the file.
_SHOWN = 24


def follow_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """What was followed, the special points and peaks, the stretches of unstable orbits, how it ends."""
    rows, labels = content["rows"], content["labels"]
    ends = [row["parameter"] for row in (rows[0], rows[-1])]
    head = f"{len(rows)} steady orbits over {content['key']}, {ends[0]:.6g} to {ends[1]:.6g}"
    parts: list[RenderableType] = [Words(head, "bold"), Words(content["title"], "dim")]
    told = [_line("begins", rows[0]), *(_line(x["kind"], x) for x in labels[:_SHOWN]), _line("ends", rows[-1])]
    parts.append(rows_table(told))
    if len(labels) > _SHOWN:
        parts.append(Words(f"{len(labels) - _SHOWN} more special points and peaks are in the file", "dim"))
    for one, two in content["unstable"]:
        parts.append(Words(f"unstable from {one:.6g} to {two:.6g} along the branch"))
    for k, other in enumerate(content["doubled"], 1):
        ends = [row["parameter"] for row in (other["rows"][0], other["rows"][-1])]
        parts.append(Words(f"branch {k} of twice the period: {len(other['rows'])} orbits, {ends[0]:.6g} to {ends[1]:.6g}"))
    for one in (x for branch in (content, *content["doubled"]) for x in branch["instead"]):
        parts.append(Words(f"beside the unstable orbit at {one['parameter']:.6g}: {one['words']}"))
    parts += [Words(text) for text in content["notes"]]
    if content["end"]:
        parts.append(Words(content["end"], "bold"))
    return Group(*parts, *written(files))


def _line(what: str, row: ReadTables) -> dict[str, str]:
    return {
        "": what,
        "value": f"{row['parameter']:.7g}",
        "K\nN/µm": f"{1e-6 * row['stiffness']:.4g}",
        "C\nN s/m": f"{row['damping']:.4g}",
        "1x\nµm": f"{1e6 * row['amplitude']:.4g}",
        "all harmonics\nµm": f"{1e6 * row['swing']:.4g}",
        "lag\ndeg": f"{row['phase_deg']:.4g}",
        "growth\na turn": f"{row['multiplier']:.4g}",
        "open\nballs": f"{row['lost']}" if row["lost"] else "",
    }


class FollowOptions(NamedTuple):
    """What ``raceway follow`` is given."""

    scene: Path
    over: str
    points: int
    aim: float
    doubled: bool
    turns: int
    changes: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="K as a curve over speed or any continuous key: folds, stability, special points.")
@on_scene
@click.option(
    "--over", required=True, metavar="A.B=FIRST:LAST", help="Continuous key that the steady orbit is followed over."
)
@click.option("--points", type=click.IntRange(2, 100_000), default=1000, show_default=True, help="Orbits at most.")
@click.option(
    "--aim", type=click.FloatRange(1e-6, 0.1), default=1e-3, show_default=True, metavar="PART",
    help="Deviation from the tangent over the orbit's size that steps are chosen for.",
)  # fmt: skip
@click.option("--doubled", is_flag=True, help="Follow the branches of twice the period at period doublings, too.")
@click.option(
    "--turns", type=click.IntRange(0, 1_000_000), default=0, show_default=True, metavar="N",
    help="Integrate so many turns from beside the most unstable orbit of each unstable stretch: what happens instead.",
)  # fmt: skip
@out_option(f"{RESULTS}/TITLE-follow")
@click.option("--pictures/--no-pictures", default=True, help="Draw amplitude and K over the key as PNG (default).")
@plugin_files
@common
@record(FollowOptions)
def follow(given: FollowOptions) -> int:
    """Follow the steady orbit of a scene from the first value of a key to the last, through folds: K, C, amplitude, phase and
    stability of each orbit, with folds, period doublings, Neimark-Sacker points and peaks located.

    Writes follow.json, follow.csv and follow.png. The scene's integrator and identifier are ignored. Stopped by Ctrl-C, it writes
    the orbits so far, and where to go on.

    \b
    Example:
      raceway follow examples/b7206.toml --over excitation.speed_rpm=500:30000
      raceway follow examples/b7206.toml --over load.axial=2000:100 \\
          --set supports.tilt=free
    """
    registry = registry_with(given.plugins)
    tables, mistakes = changed_tables(given.scene, given.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    folder = writable(given.out or RESULTS / f"{slug(str(tables['title']))}-follow")
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    with show_progress() as progress:
        from raceway.points.follow import FollowInterrupt
        from raceway.points.follow import follow as follow_scene

        stopped = None
        try:
            curve = follow_scene(
                tables, given.over, points=given.points, aim=given.aim, doubled=given.doubled, turns=given.turns, plugins=given.plugins, progress=progress,
            )  # fmt: skip
        except FollowInterrupt as stop:
            if not stop.partial.rows:
                raise
            curve, stopped = stop.partial, stop  # what there is of the curve is written and shown first
    content, files = curve.to_dict(), list[str]()
    failed = attempt(lambda: curve.write(folder, pictures and stopped is None), files)

    show(content, given.as_json, failed, lambda: follow_screen(content, files))
    if stopped is not None:
        raise stopped
    return 0
