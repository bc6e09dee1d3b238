"""The command ``raceway sweep``.  Part of ``raceway.cli.main``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from raceway.cli.console import warn
from raceway.cli.frame import (
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_netcdf,
    out_option,
    plugin_files,
    record,
    scene_file,
    set_keys,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import registry_with
from raceway.storage.files import writable
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.studies.sweep import Design, Store


class SweepOptions(NamedTuple):
    """What ``raceway sweep`` is given."""

    scene: Path
    axes: tuple[str, ...]
    listed: Path | None
    design: Path | None
    changes: tuple[str, ...]
    executor: str
    workers: int | None
    scheduler: str | None
    out: Path | None
    resume: bool
    retry_failed: bool
    as_csv: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="One scene at thousands of points, kept in a store; parallel, resumable.")
@scene_file
@click.option("--grid", "axes", multiple=True, metavar="A.B=X,Y", help="Axis: x,y,z or start:stop:count; all combinations.")
@click.option("--list", "listed", type=click.Path(path_type=Path), metavar="FILE", help="Points: .csv, .json or .toml.")
@click.option("--design", type=click.Path(path_type=Path), metavar="FILE.toml", help="A table [grid], or tables [[points]].")
@set_keys
@click.option(
    "--executor", default="serial", show_default=True, metavar="NAME", help="serial, processes, joblib, dask, or a plug-in."
)
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Processes of these [2].")
@click.option("--scheduler", metavar="ADDRESS", help="A running dask scheduler, tcp://HOST:8786.")
@out_option(f"{RESULTS}/TITLE-sweep", metavar="STORE")
@click.option("--resume", is_flag=True, help="Go on with a store: compute what is not finished.")
@click.option("--retry-failed", is_flag=True, help="With a store that is there: failed points again, too.")
@click.option("--csv", "as_csv", is_flag=True, help="Write STORE/results.csv, too.")
@plugin_files
@common
@record(SweepOptions)
def sweep(given: SweepOptions) -> int:
    """Compute a scene at the points of a grid or a list, and keep every point in a store.

    STORE holds points.sqlite (states and values, written as points finish) and results.nc (an xarray data set). Ctrl-C, a
    kill or a full disk lose what was being computed; --resume goes on.

    \b
    Example:
      raceway sweep examples/b7206.toml \\
          --grid excitation.speed_rpm=10980:15000:9 --grid load.axial=400,1200
      raceway sweep examples/steady_orbit.toml --list points.csv \\
          --executor joblib --workers 4
    """
    from raceway.studies.sweep import open_store
    from raceway.studies.sweep import sweep as study
    from raceway.studies.sweep.front import executor_of, prepared_sweep
    from raceway.studies.sweep.store import exists

    registry = registry_with(given.plugins)
    points = _design(given.axes, given.listed, given.design)
    chosen = executor_of(given.executor, {"workers": given.workers, "scheduler": given.scheduler}, registry)
    tables, mistakes = changed_tables(given.scene, given.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    folder = writable(given.out or RESULTS / f"{slug(str(tables['title']))}-sweep")
    tell_faults(registry)
    resume = given.resume or given.retry_failed
    if resume and not exists(folder):
        warn(f"`{folder}` holds no sweep to go on with: it is begun anew", label="")
    prepared = prepared_sweep(tables, points, folder, resume, given.plugins)
    waiting = f"waiting for {given.scheduler}" if given.scheduler else None
    try:
        with show_progress(remaining=True, waiting=waiting) as progress:
            store = study(prepared, chosen, given.retry_failed, progress)
    except (KeyboardInterrupt, RacewayError) as why:
        if not (folder / "points.sqlite").is_file():
            raise
        with open_store(folder) as store:
            return _show(store, given.as_csv, given.as_json, why)
    with store:
        return _show(store, given.as_csv, given.as_json, None)


def _show(store: Store, as_csv: bool, as_json: bool, stopped: BaseException | None) -> int:
    """Write the data set, then the tables or JSON; then what stopped the sweep."""
    from raceway.studies.sweep.dataset import TABLE, write_csv, write_netcdf
    from raceway.studies.sweep.front import all_failed

    files = [str(store.path / "points.sqlite")]
    failed = attempt(lambda: [write_netcdf(store)], files) if has_netcdf() else None
    if as_csv and failed is None:
        failed = attempt(lambda: [write_csv(store, store.path / TABLE)], files)
    states = store.status()
    if isinstance(stopped, RacewayError):
        failed = stopped
    elif failed is None:
        failed = all_failed(store)
    content = {
        "title": store.title,
        "store": str(store.path),
        "axes": [axis.to_dict() for axis in store.axes],
        "states": states,
        "rows": [_row(row) for row in store.rows()] if as_json else [],
    }
    from raceway.studies.sweep.screen import sweep_screen

    show(content, as_json, failed, lambda: sweep_screen(content, store.rows(), files))
    if stopped is not None:
        warn(f"{states['done']} of {states['total']} points are done; the same command with --resume goes on", label="")
        raise stopped
    return 0


def _row(row: Tables) -> Tables:
    """What does not change from one sweep to the next: no costs, no names of machines."""
    kept = {"point": row["point"], "status": row["status"], "values": row["values"]}
    return kept | {name: row[name] for name in ("reason", "warnings") if row[name]}


def _design(axes: Sequence[str], listed: Path | None, design: Path | None) -> Design:
    from raceway.studies.sweep import design_file, grid, point_list

    given = [name for name, value in (("--grid", axes), ("--list", listed), ("--design", design)) if value]
    if len(given) > 1:
        raise SceneError.at(" and ".join(given), None, "contradict each other: give one of them")
    if listed is not None:
        return point_list(listed)
    return design_file(design) if design is not None else grid(axes)
