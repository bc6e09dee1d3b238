"""The command ``raceway sweep``, which draws, too.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click
from rich.console import Group, RenderableType

from raceway.cli.console import warn
from raceway.cli.frame import (
    PATH,
    RESULTS,
    at_option,
    attempt,
    changed_tables,
    common,
    has_netcdf,
    out_option,
    plugin_files,
    record,
    require_matplotlib,
    set_keys,
    show,
    show_progress,
    tell_faults,
)
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import registry_with
from raceway.out.quantities import ERROR, KYY, KYY_TILTS_FOLLOW, STIFFNESS, Z_REAL, K
from raceway.out.table import micro, rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.files import slug, writable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.points.axes import Design
    from raceway.points.dataset import SweepStore
    from raceway.points.plot import Layout, Selection
    from raceway.storage.tables import Tables


class SweepOptions(NamedTuple):
    """Of ``raceway sweep``."""

    scene: Path
    value: str | None
    x: str | None
    y: str | None
    at: tuple[str, ...]
    kind: str | None
    picture: Path | None
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
@click.argument("scene", metavar="SCENE|STORE", type=PATH)
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
@click.option("--plot", "value", metavar="NAME", help="Draw this quantity, e.g. K, p0 or stiffness:y,y.")
@click.option("--x", metavar="KEY", help="Of the picture, axis to the right [the speed, or the longest one].")
@click.option("--y", metavar="KEY", help="Second axis; in curves what the colours stand for.")
@at_option
@click.option(
    "--kind",
    type=click.Choice(["curves", "map", "surface"]),
    help="[map where both axes have more than 8 values, else curves]",
)
@click.option("--picture", type=PATH, metavar="FILE", help="A .png or .svg [STORE/NAME-KIND.png].")
@plugin_files
@common
@record(SweepOptions)
def sweep(options: SweepOptions) -> int:
    """Compute a scene at the points of a grid or a list, and keep every point in a store; draw one quantity of them.

    STORE holds points.sqlite (states and values, written as points finish) and results.nc (an xarray data set). Ctrl-C, a
    kill or a full disk lose what was being computed; --resume goes on. A finished STORE in place of SCENE is drawn: one more
    axis becomes panels, what is left over is chosen with --at, and points without a result leave gaps, which are counted.

    \b
    Example:
      raceway sweep examples/b7206.toml --plot K \\
          --grid excitation.speed_rpm=10980:15000:9 --grid load.axial=400,1200
      raceway sweep raceway-out/B7206C-sweep --plot p0 --at load.axial=1200
      raceway sweep examples/steady_orbit.toml --list points.csv \\
          --executor joblib --workers 4
    """
    from raceway.points.dataset import open_store
    from raceway.points.store import exists
    from raceway.points.sweep import executor_of, fill_store, prepared_sweep

    drawn = options.value is not None or exists(options.scene)
    if drawn:
        require_matplotlib("leave out --plot: --json and --csv have the values")
    if options.picture is not None:
        writable(options.picture.parent)
    if exists(options.scene):
        return _plot(options.scene, options)
    registry = registry_with(options.plugins)
    points = _design(options.axes, options.listed, options.design)
    executor = executor_of(options.executor, {"workers": options.workers, "scheduler": options.scheduler}, registry)
    tables, mistakes = changed_tables(options.scene, options.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    folder = writable(options.out or RESULTS / f"{slug(str(tables['title']))}-sweep")
    tell_faults(registry)
    resume = options.resume or options.retry_failed
    if resume and not exists(folder):
        warn(f"`{folder}` holds no sweep to go on with: it is begun anew", label="")
    prepared = prepared_sweep(tables, points, folder, resume, options.plugins)
    waiting = f"waiting for {options.scheduler}" if options.scheduler else None
    try:
        with show_progress(remaining=True, waiting=waiting) as progress:
            store = fill_store(prepared, executor, options.retry_failed, progress)
    except (KeyboardInterrupt, RacewayError) as why:
        if not (folder / "points.sqlite").is_file():
            raise
        with open_store(folder) as store:
            return _show(store, options, why)
    with store:
        return _show(store, options, None)


def _show(store: SweepStore, options: SweepOptions, stopped: BaseException | None) -> int:
    """Write the data set and the picture, then the tables or JSON; then what stopped the sweep."""
    from raceway.points.dataset import TABLE, write_csv, write_netcdf
    from raceway.points.sweep import all_failed

    files = [str(store.path / "points.sqlite")]
    failed = attempt(lambda: [write_netcdf(store)], files) if has_netcdf() else None
    if options.as_csv and failed is None:
        failed = attempt(lambda: [write_csv(store, store.path / TABLE)], files)
    states = store.status()
    if isinstance(stopped, RacewayError):
        failed = stopped
    elif failed is None:
        failed = all_failed(store)
    if options.value is not None and failed is None and stopped is None:
        picture, _ = _picture(store.path, options)
        failed = attempt(lambda: [picture.write(_picture_file(store.path, options, picture))], files)
    content = {
        "title": store.title,
        "store": str(store.path),
        "axes": [axis.to_dict() for axis in store.design.axes],
        "states": states,
        "rows": [_row(row) for row in store.rows()] if options.as_json else [],
    }

    show(content, options.as_json, failed, lambda: sweep_screen(content, store.rows(), files))
    if stopped is not None:
        warn(f"{states['done']} of {states['total']} points are done; the same command with --resume goes on", label="")
        raise stopped
    return 0


def _picture(store: Path, options: SweepOptions) -> tuple[Layout, Selection]:
    from raceway.points.plot import layout, selection_of

    selection = selection_of(store, options.at)
    return layout(selection, options.value, options.kind, options.x, options.y), selection


def _picture_file(store: Path, options: SweepOptions, picture: Layout) -> Path:
    name = slug(picture.name.replace(":", "-").replace(",", "-"))
    file = options.picture or store / f"{name}-{picture.kind}.png"
    writable(file.parent)
    return file


def _plot(store: Path, options: SweepOptions) -> int:
    """Draw one quantity of a finished sweep."""
    picture, selection = _picture(store, options)
    file, files = _picture_file(store, options, picture), list[str]()
    failed = attempt(lambda: [picture.write(file)], files)
    content = {
        "store": str(store),
        "value": picture.name,
        "units": picture.data.attrs.get("units"),
        "kind": picture.kind,
        "x": picture.x,
        "y": picture.y,
        "panels": picture.panels,
        "fixed": selection.fixed,
        "unfinished": selection.unfinished,
        "files": files,
    }
    show(content, options.as_json, failed, lambda: sentences(plot_words(content)))
    return 0


def _row(row: Tables) -> Tables:
    """What does not change from one sweep to the next: no costs, no names of machines."""
    kept = {"point": row["point"], "status": row["status"], "values": row["values"]}
    return kept | {name: row[name] for name in ("reason", "warnings") if row[name]}


def _design(axes: Sequence[str], listed: Path | None, design: Path | None) -> Design:
    from raceway.points.axes import design_file, grid, point_list

    given = [name for name, value in (("--grid", axes), ("--list", listed), ("--design", design)) if value]
    if len(given) > 1:
        raise SceneError.at(" and ".join(given), None, "contradict each other: give one of them")
    if listed is not None:
        return point_list(listed)
    return design_file(design) if design is not None else grid(axes)


#: Beginning of a line that names a file.
WRITTEN = "written: "


def plot_words(content: Tables) -> list[str]:
    """What was drawn, in sentences."""
    axes = [content["x"], *(key for key in (content["y"], content["panels"]) if key)]
    lines = [f"{content['value']} over {', '.join(axes)} ({content['kind']})"]
    if content["unfinished"]:
        lines.append("without result: " + ", ".join(f"{count} {state}" for state, count in content["unfinished"].items()))
    return lines + [f"{WRITTEN}{name}" for name in content["files"]]


def sentences(lines: list[str], *tables: RenderableType) -> RenderableType:
    from rich.console import Group

    from raceway.out.table import written
    from raceway.out.wrapping import Words

    names = [line.removeprefix(WRITTEN) for line in lines if line.startswith(WRITTEN)]
    return Group(*tables, *(Words(line) for line in lines if not line.startswith(WRITTEN)), *written(names))


#: Points of a sweep that a screen shows one by one.
_MOST_ROWS, _MOST_REASONS = 30, 5
#: Numbers in a warning, which differ from point to point.
_NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")


def sweep_screen(content: ReadTables, rows: Iterable[ReadTables], files: Sequence[str]) -> RenderableType:
    """How many points are in each state, the first of them with their stiffness, why points failed, and what they warn of."""
    from raceway.points.axes import point_words

    shown: list[dict[str, str]] = []
    reasons: list[str] = []
    told: dict[
        str, tuple[int, str, Tables]
    ] = {}  # warning without its numbers -> count, its words and the point that has it first
    for row in rows:
        for text in row["warnings"]:
            count, first, point = told.get(key := _NUMBER.sub("#", text), (0, text, row["point"]))
            told[key] = count + 1, first, point
        if len(shown) < _MOST_ROWS:
            shown.append(_sweep_row(row))
        if row["status"] == "failed" and len(reasons) < _MOST_REASONS:
            reasons.append(f"{point_words(row['point'])}: {row['reason'].splitlines()[0]}")
    states, total = content["states"], content["states"]["total"]
    counted = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "waiting") if states[name])
    parts: list[RenderableType] = [Words(content["title"], "bold"), rows_table(shown)]
    if total > len(shown):
        parts.append(Words(f"and {total - len(shown)} more points in {content['store']}", "dim"))
    parts.append(Words(f"{total} points: {counted}"))
    parts += [Words(f"failed: {micro(reason)}") for reason in reasons]
    for count, text, point in told.values():
        parts.append(
            Words(f"{count} point{'s warn' if count > 1 else ' warns'}: {micro(text)} (first at {point_words(point)})")
        )
    return Group(*parts, *written(files))


def _sweep_row(row: ReadTables) -> dict[str, str]:
    from raceway.points.axes import shown

    values = row["values"]
    last = [key.rpartition(".")[2] for key in row["point"]]
    short = {key: name if last.count(name) == 1 else key for key, name in zip(row["point"], last, strict=True)}
    text = {short[key]: shown(value) for key, value in row["point"].items()}
    tangent = values.get(STIFFNESS.name)
    numbers = {
        K.symbol: values.get(K.name),
        "Re Z": values.get(Z_REAL.name),
        KYY.symbol: None if tangent is None else tangent[1][1],
    }
    if KYY_TILTS_FOLLOW.name in values:
        numbers[KYY_TILTS_FOLLOW.label] = values[KYY_TILTS_FOLLOW.name]
    text |= {f"{name} {K.read_unit}": "" if value is None else f"{K.read(value):.3f}" for name, value in numbers.items()}
    error = values.get(ERROR.name)
    return {**text, "error %": "" if error is None else f"{100.0 * error:.2g}", "status": row["status"]}
