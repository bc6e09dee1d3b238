"""The command ``raceway sweep``.  Part of ``raceway.cli.main``."""

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
    attempt,
    changed_tables,
    common,
    has_matplotlib,
    has_netcdf,
    keeping,
    load,
    on_scene,
    out_folder,
    out_option,
    plugin_files,
    processes_at_a_time,
    record,
    require_matplotlib,
    scene_file,
    set_keys,
    show,
    show_progress,
    slug,
    tell_faults,
)
from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.registry import registry_with
from raceway.out.quantities import ERROR, KYY, KYY_TILTS_FOLLOW, STIFFNESS, Z_REAL, K, read_in
from raceway.out.table import micro, rows_table, written
from raceway.out.wrapping import Words
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from rich.console import RenderableType

    from raceway.points.axes import Design
    from raceway.points.plot import Selection
    from raceway.points.store import Store
    from raceway.storage.tables import Tables


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
    from raceway.points.store import exists, open_store
    from raceway.points.sweep import executor_of, prepared_sweep
    from raceway.points.sweep import fill_store as study

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
    from raceway.points.dataset import TABLE, write_csv, write_netcdf
    from raceway.points.sweep import all_failed

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
    from raceway.points.axes import design_file, grid, point_list

    given = [name for name, value in (("--grid", axes), ("--list", listed), ("--design", design)) if value]
    if len(given) > 1:
        raise SceneError.at(" and ".join(given), None, "contradict each other: give one of them")
    if listed is not None:
        return point_list(listed)
    return design_file(design) if design is not None else grid(axes)


store_argument = click.argument("store", type=PATH)
#: Beginning of a line that names a file.
WRITTEN = "written: "
at_option = click.option("--at", multiple=True, metavar="KEY=VALUE", help="Choose a value of an axis; repeat for more.")


class PlotOptions(NamedTuple):
    """What ``raceway plot`` is given."""

    store: Path
    value: str | None
    x: str | None
    y: str | None
    at: tuple[str, ...]
    kind: str | None
    out: Path | None
    as_json: bool


@click.command(short_help="Draw a sweep: curves, maps, surfaces.")
@store_argument
@click.option("--value", metavar="NAME", help=f"Quantity, e.g. p0 or stiffness:y,y [{K.name}].")
@click.option("--x", metavar="KEY", help="Axis to the right [the speed, or the longest one].")
@click.option("--y", metavar="KEY", help="Second axis; in curves what the colours stand for.")
@at_option
@click.option(
    "--kind",
    type=click.Choice(["curves", "map", "surface"]),
    help="[map where both axes have more than 8 values, else curves]",
)
@click.option("--out", type=PATH, metavar="FILE", help="A .png or .svg [STORE/NAME-KIND.png].")
@common
@record(PlotOptions)
def plot(given: PlotOptions) -> int:
    """Draw one quantity of a sweep over the keys that were varied.

    One more axis becomes panels; what is left over has to be chosen with --at. Points without a result leave gaps, which
    the picture's second line counts.

    \b
    Example:
      raceway plot raceway-out/B7206C-sweep --value p0 \\
          --x excitation.speed_rpm --at load.axial=1000
    """
    require_matplotlib("read the values with raceway sweep --json or --csv")
    selection = selection_of(given.store, given.at)
    from raceway.points.plot import layout

    picture = layout(selection, given.value, given.kind, given.x, given.y)
    path = given.out or given.store / f"{slug(picture.name.replace(':', '-').replace(',', '-'))}-{picture.kind}.png"
    writable(path.parent)
    files: list[str] = []
    failed = attempt(lambda: [picture.write(path)], files)
    content = {
        "store": str(given.store),
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
    show(content, given.as_json, failed, lambda: told(plot_words(content)))
    return 0


def selection_of(store: Path, at: tuple[str, ...]) -> Selection:
    from raceway.points.plot import parse_at, select
    from raceway.points.store import open_store

    return select(open_store(store).to_xarray(), parse_at(at))


def head(selection: Selection) -> tuple[str, ...]:
    """Where the numbers come from, for the first lines of a file."""
    from raceway import __version__
    from raceway.points.axes import shown

    bearing = selection.value("bearing.preset", "")
    fixed = ", ".join(f"{key} = {shown(value)}" for key, value in selection.fixed.items())
    words = (f"Raceway {__version__}: {selection.title}", f"bearing {bearing}" if bearing else "", fixed)
    return tuple(word.replace("\n", "; ") for word in words if word)


def plot_words(content: Tables) -> list[str]:
    """What was drawn, in sentences."""
    axes = [content["x"], *(key for key in (content["y"], content["panels"]) if key)]
    lines = [f"{content['value']} over {', '.join(axes)} ({content['kind']})"]
    if content["unfinished"]:
        lines.append("without result: " + ", ".join(f"{count} {state}" for state, count in content["unfinished"].items()))
    return lines + [f"{WRITTEN}{name}" for name in content["files"]]


def told(lines: list[str], *tables: RenderableType) -> RenderableType:
    from rich.console import Group

    from raceway.out.table import written
    from raceway.out.wrapping import Words

    names = [line.removeprefix(WRITTEN) for line in lines if line.startswith(WRITTEN)]
    return Group(*tables, *(Words(line) for line in lines if not line.startswith(WRITTEN)), *written(names))


@click.command(short_help="One scene, some keys varied, everything else the same.")
@on_scene
@click.option("--vary", multiple=True, required=True, metavar="A.B=X,Y", help="Values x,y,z or a range start:stop:count.")
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write the curves as PNG (default).")
@plugin_files
@common
def compare(
    scene: Path,
    vary: tuple[str, ...],
    changes: tuple[str, ...],
    out: Path | None,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Vary some keys of a scene and say which of them causes what: main effects and interactions.

    Writes compare.json and compare.png. Finished runs are kept in DIR/compare-rows.jsonl and reused.

    \b
    Example:
      raceway compare examples/b7206.toml --set integrator.kind=periodic \\
          --vary excitation.kind=unidirectional,bidirectional \\
          --vary excitation.speed_rpm=10980:15000:5
    """
    registry = registry_with(plugins)
    tables, mistakes = changed_tables(scene, changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    title = str(tables["title"])
    folder = writable(out or RESULTS / f"{slug(title)}-compare")
    pictures = pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "compare-rows.jsonl"
    with show_progress() as progress:
        from raceway.pipeline.result import write_json
        from raceway.points.compare import StudyInterrupt
        from raceway.points.compare import compare as study

        stopped = None
        try:
            comparison = study(tables, vary, kept=kept, progress=progress)
        except StudyInterrupt as stop:
            if not stop.partial.rows:
                raise
            comparison, stopped = stop.partial, stop  # what is finished is shown and written first
    content = comparison.to_dict()
    files: list[str] = []
    failed = attempt(lambda: [write_json(content, folder / "compare.json")], files) or comparison.fault
    if pictures and failed is None and stopped is None:
        failed = attempt(lambda: comparison.picture(folder), files)

    show(content, as_json, failed, lambda: compare_screen(title, comparison.table(), comparison.short_words, files))
    with keeping("runs", kept):
        if stopped is not None:
            raise stopped
    return 0


class PrecisionOptions(NamedTuple):
    """What ``raceway precision`` is given."""

    scene: Path
    vary: tuple[str, ...]
    reference: tuple[str, ...]
    repeats: int
    limit: float
    changes: tuple[str, ...]
    out: Path | None
    pictures: bool
    plugins: tuple[Path, ...]
    as_json: bool


@click.command(short_help="Error against run time: which setting is good enough.")
@scene_file
@click.option("--vary", multiple=True, metavar="A.B=X,Y", help="Axis; all combinations are run. Without: a default design.")
@click.option("--reference", multiple=True, metavar="A.B=C", help="Key of the reference; found by itself without.")
@click.option("--repeats", type=click.IntRange(1, 1000), default=3, show_default=True, help="Runs of each setting.")
@click.option(
    "--limit", type=click.FloatRange(min=0.0, min_open=True), default=30.0, show_default=True, metavar="SECONDS",
    help="Leave out what is predicted to take longer.",
)  # fmt: skip
@set_keys
@out_option(f"{RESULTS}/TITLE-precision")
@click.option("--pictures/--no-pictures", default=True, help="Draw error against run time as PNG (default).")
@plugin_files
@common
@record(PrecisionOptions)
def precision(given: PrecisionOptions) -> int:
    """Run a scene with many settings and say what each costs and how far it is from a reference with a known bound.

    Writes precision.json, precision.md and precision.png. Finished rows are kept in DIR/precision-rows.jsonl and reused.

    \b
    Example:
      raceway precision examples/b7206.toml \\
          --vary integrator.kind=newmark,central_difference \\
          --vary integrator.steps_per_turn=45,90,180,360
    """
    registry = registry_with(given.plugins)
    tables, mistakes = changed_tables(given.scene, given.changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    folder = writable(given.out or RESULTS / f"{slug(str(tables['title']))}-precision")
    pictures = given.pictures and has_matplotlib()
    tell_faults(registry)
    kept = folder / "precision-rows.jsonl"
    with keeping("rows", kept), show_progress() as progress:
        from raceway.points.precision import precision as study

        found = study(
            tables,
            given.vary,
            reference=given.reference,
            repeats=given.repeats,
            limit_s=given.limit,
            kept=kept,
            progress=progress,
        )
    content, files = found.to_dict(), list[str]()
    failed = attempt(lambda: found.write(folder, pictures), files) or found.fault
    if failed is None:
        failed = verdict(content, found.converged, bool(given.reference))

    show(
        content,
        given.as_json,
        failed,
        lambda: precision_screen(content["title"], found.table(), content["words"], files),
    )
    return 0


def verdict(content: dict, converged: bool, given: bool) -> ConvergenceError | SceneError | None:
    """What makes a finished study worthless, after it has been shown."""
    rows = content["rows"]
    known = [row for row in rows if row["error"] is not None]
    if given and known and all(row["at_bound"] for row in known):
        message = "is not more accurate than the rows: make it finer, or leave it out and let the study find one"
        return SceneError.at("--reference", None, message)
    if not converged:
        reasons = [row["reason"] for row in rows if row["reason"]]
        why = f"; the first reason: {reasons[0]}" if reasons else ": all errors are above 1 %"
        return ConvergenceError(f"no setting converged{why}")
    return None


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
        from raceway.points.band import band as compute

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

    from raceway.out.quantities import read_in
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


@click.command(short_help="How much each number of a scene changes the answer.")
@on_scene
@click.option(
    "--by", "keys", multiple=True, metavar="A.B", help="Only this key; repeat for more [every number of the scene]."
)
@out_folder
@click.option("--pictures/--no-pictures", default=True, help="Write the bars as PNG (default).")
@plugin_files
@common
def sensitivities(
    scene: Path,
    changes: tuple[str, ...],
    keys: tuple[str, ...],
    out: Path | None,
    pictures: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """Derivatives of K, displacement and ball loads by every number of a scene, without solving it again.

    Writes sensitivities.json, sensitivities.csv and sensitivities.png. The motion is the steady orbit.

    \b
    Example:
      raceway sensitivities examples/b7206.toml
      raceway sensitivities examples/b7206.toml --by bearing.contact_angle_deg
    """
    registry = registry_with(plugins)
    loaded = load(scene, changes, registry)
    tell_faults(registry)
    folder = writable(out or RESULTS / f"{slug(loaded.title)}-sensitivities")
    with show_progress() as progress:
        from raceway.points.sensitivities import sensitivities as compute

        found = compute(loaded, keys, progress=progress)
    content = found.to_dict()
    files: list[str] = []
    failed = attempt(lambda: found.save(folder), files)
    if failed is None and pictures and has_matplotlib() and found.rows:
        failed = attempt(lambda: found.picture(folder), files)

    show(content, as_json, failed, lambda: sensitivities_screen(content, files))
    return 0


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
    counted = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "running", "waiting") if states[name])
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


def compare_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """The effects, the largest first, a line for each point, and the other words."""
    parts: list[RenderableType] = [Words(title, "bold"), *map(Words, words[:1]), rows_table(rows), *map(Words, words[1:])]
    parts.append(Words("all quantities, courses and inertia in words: compare.json", "dim"))
    return Group(*parts, *written(files))


def precision_screen(title: str, rows: Sequence[ReadTables], words: Sequence[str], files: Sequence[str]) -> RenderableType:
    """A line for each setting, and what they come to in words."""
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    parts: list[RenderableType] = [Words(title, "bold")]
    parts.append(rows_table([{name: row[name] for name in names} for row in rows]))
    parts.append(Words("* on the front; ~ known to the reference's bound only", "dim"))
    return Group(*parts, *map(Words, words), *written(files))


#: Influences below this part of the largest one are not shown, files have them.
_SHOWN = 1e-6


def sensitivities_screen(content: ReadTables, files: list[str]) -> RenderableType:
    """Keys in the order of their influence; below, what has none, what has no derivative, and the files."""
    from rich.console import Group
    from rich.text import Text

    quantities = content["quantities"]
    heads = []
    for name, one in quantities.items():
        value, unit = read_in(one["value"], one["unit"])
        heads.append(f"{name.replace('_', ' ')} {value:.5g} {unit}: {one['definition']}")
    rows = []
    for key in (one for one in content["keys"] if one["influence"]):
        row = {"key": key["key"], "value": f"{key['value']:.6g} {key['unit']}".strip()}
        for name in quantities:
            row[f"{name.replace('_', ' ')} [% per %]"] = _share(key, name)
        rows.append(row)
    lines = [f"warning: {text}" for text in content["warnings"]]
    lines += [f"cost: {_cost(content['cost'])}"]
    zero = [key["key"] for key in content["keys"] if not key["influence"]]
    lines += [f"0, so without a share; derivatives in the files: {', '.join(zero)}"] if zero else []
    rough: dict[str, list[str]] = {}
    for key in content["keys"]:
        if key["remark"]:
            rough.setdefault(key["remark"], []).append(key["key"])
    lines += [f"{', '.join(keys)}: {why}" for why, keys in rough.items()]
    if content["without_effect"]:
        lines.append(f"without effect: {', '.join(content['without_effect'])}")
    reasons: dict[str, list[str]] = {}
    for one in content["refused"]:
        reasons.setdefault(one["reason"], []).append(one["key"])
    lines += [f"no derivative by {', '.join(keys)}: {why}" for why, keys in reasons.items()]
    lines += [f"written: {', '.join(files)}"] if files else []
    title = "\n".join([content["title"], *heads])
    return Group(rows_table(rows, title), *(Text(line) for line in lines))


def _share(key: ReadTables, name: str) -> str:
    share = key["influence"].get(name)
    if share is None:
        return ""
    return "0" if abs(share) < _SHOWN else f"{share:+.3g}"


def _cost(cost: ReadTables) -> str:
    return f"{cost['gradients_s']:.2g} s beside {cost['run_s']:.2g} s of the run, {cost['models']} models built"
