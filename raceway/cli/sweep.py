"""``raceway sweep``: a sweep kept in a store with its files, and pictures of a store."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import ClassVar, NamedTuple

import attrs

from raceway.answers.answer import Answer, Interrupted, Part
from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import ERROR, KYY, KYY_TILTS_FOLLOW, STIFFNESS, Z_REAL, K
from raceway.answers.table import Words, file_lines, micro
from raceway.cli.frame import RESULTS, require_matplotlib
from raceway.cli.interrupt import answered
from raceway.errors import RacewayError, SceneError, extra
from raceway.framework.contracts import Executor
from raceway.framework.loading.registry import registry_with
from raceway.framework.shown import Fact
from raceway.points.axes import Design, design_file, grid, point_words, sampled, shown
from raceway.points.dataset import NOT_CHECKED, TABLE, all_failed, blank, open_store, points_of, write_csv, write_netcdf
from raceway.points.store import POINTS, exists
from raceway.points.sweep import Sweep
from raceway.scene.scene import plain_tables
from raceway.storage.files import slug, writable
from raceway.storage.tables import ReadTables, Tables

#: Points of a sweep that a screen shows one by one, and reasons of points that failed.
_MOST_ROWS, _MOST_REASONS = 30, 5
#: Numbers in a warning, which differ from point to point.
_NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")


@attrs.frozen(eq=False, repr=False, slots=False)
class _Swept(Answer):
    """What a store holds, and files that were written; ``fault`` is why points or files are missing."""

    stem: ClassVar[str] = "sweep"
    store: Path
    files: list[str]
    fault: RacewayError | None = None

    def failure(self) -> RacewayError | None:
        return self.fault

    def to_dict(self) -> Tables:
        """All points, without what changes from one sweep to the next: no costs, no names of machines."""
        with open_store(self.store) as store:
            return {
                "title": store.title,
                "store": str(self.store),
                "axes": [] if store.design.listed else [axis.to_dict() for axis in store.design.axes],
                "states": store.status(),
                "rows": [
                    {name: row[name] for name in ("point", "status", "values")}
                    | {name: row[name] for name in ("reason", "warnings") if row[name]}
                    for row in store.rows()
                ],
            }

    def _facts(self) -> tuple[str, list[Fact]]:
        with open_store(self.store) as store:
            return store.title, [(state, str(count), "points") for state, count in store.status().items()]

    def report(self) -> Iterator[Part]:
        """How many points are in each state, the first of them with their stiffness, why points failed, and what they warn of."""
        with open_store(self.store) as store:
            title, states, points = store.title, store.status(), points_of(store)
        rows = [_row(row) for row in islice(points.rows(), _MOST_ROWS)]
        # Warning without its numbers -> count, its words and the point that has it first.
        warnings_of = dict[str, tuple[int, str, int]]()
        for number, texts in points.warnings.items():
            for text in texts:
                count, first, where = warnings_of.get(key := _NUMBER.sub("#", text), (0, text, number))
                warnings_of[key] = count + 1, first, where
        total = states["total"]
        counts = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "waiting") if states[name])
        yield Words(title, "bold")
        yield rows
        if total > len(rows):
            yield Words(f"and {total - len(rows)} more points in {self.store}", "dim")
        yield f"{total} points: {counts}"
        if states["computed"]:
            yield f"{states['computed']} computed in a compiled loop. {NOT_CHECKED}"
        for number, reason in islice(points.reasons.items(), _MOST_REASONS):
            yield f"failed: {point_words(points.design.point(number))}: {micro(reason.splitlines()[0])}"
        for count, text, where in warnings_of.values():
            words = "points warn" if count > 1 else "point warns"
            yield f"{count} {words}: {micro(text)} (first at {point_words(points.design.point(where))})"
        yield from file_lines(self.files)


def _row(row: ReadTables) -> dict[str, str]:
    values = row["values"]
    last = [key.rpartition(".")[2] for key in row["point"]]
    short = {key: name if last.count(name) == 1 else key for key, name in zip(row["point"], last, strict=True)}
    text = {short[key]: shown(value) for key, value in row["point"].items()}
    tangent = values.get(STIFFNESS.name)
    numbers = {K.symbol: values.get(K.name), "Re Z": values.get(Z_REAL.name)}
    numbers[KYY.symbol] = None if tangent is None else tangent[1][1]
    if KYY_TILTS_FOLLOW.name in values:
        numbers[KYY_TILTS_FOLLOW.label] = values[KYY_TILTS_FOLLOW.name]
    none = "" if row["status"] == "done" else row["status"]
    text |= {f"{name} {K.read_unit}": none if value is None else f"{K.read(value):.3f}" for name, value in numbers.items()}
    error = values.get(ERROR.name)
    return {**text, "error %": none if error is None else f"{100.0 * error:.2g}"}


@attrs.frozen(eq=False, repr=False, slots=False)
class _Drawn(Answer):
    """A picture of a store: what is drawn over what, and how many points are missing."""

    stem: ClassVar[str] = "picture"
    content: Tables

    def to_dict(self) -> Tables:
        return self.content

    def report(self) -> Iterator[Part]:
        """What was drawn, in sentences."""
        content = self.content
        axes = [content["x"], *(key for key in (content["y"], content["panels"]) if key)]
        yield f"{content['value']} over {', '.join(axes)} ({content['kind']})"
        if content["unfinished"]:
            yield "without result: " + ", ".join(f"{count} {state}" for state, count in content["unfinished"].items())
        yield from file_lines(content["files"])


class _Choice(NamedTuple):
    """What is drawn of a store, as far as it was said."""

    value: str | None
    kind: str | None
    x: str | None
    y: str | None
    at: tuple[str, ...]
    file: str | Path | None

    @property
    def asked(self) -> bool:
        return any(part for part in self)

    def foresee(self, design: Design, scene: ReadTables) -> None:
        """Refuse, before anything is computed, a picture that this sweep cannot give."""
        from raceway.points.plot import layout
        from raceway.points.selection import parse_at, select

        layout(select(blank(design, scene), parse_at(self.at)), self.value, self.kind, self.x, self.y)

    def draw(self, store: Path) -> Tables:
        """The picture, written; what it shows."""
        from raceway.points.plot import layout
        from raceway.points.selection import selection_of

        selection = selection_of(store, self.at)
        panel = layout(selection, self.value, self.kind, self.x, self.y)
        name = slug(panel.name.replace(":", "-").replace(",", "-"))
        file = store / f"{name}-{panel.kind}.png" if self.file is None else Path(self.file)
        writable(file.parent)
        return {
            "store": str(store),
            "value": panel.name,
            "units": panel.data.attrs.get("units"),
            **{part: getattr(panel, part) for part in ("kind", "x", "y", "panels")},
            "fixed": selection.fixed,
            "unfinished": selection.unfinished,
            "files": [str(panel.write(file))],
        }


def sweep(
    source: str | Path,
    axes: Iterable[str] = (),
    points: str | Path | None = None,
    design: str | Path | None = None,
    ranges: Iterable[str] = (),
    seed: int = 0,
    quantities: Iterable[str] = (),
    settings: Iterable[str] = (),
    executor: str = "serial",
    workers: int | None = None,
    scheduler: str | None = None,
    store: str | Path | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    force: bool = False,
    csv: bool = False,
    value: str | None = None,
    x: str | None = None,
    y: str | None = None,
    at: Iterable[str] = (),
    kind: str | None = None,
    picture: str | Path | None = None,
    plan: bool = False,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Answer:
    """Compute a scene at the points of a grid or a list, store every point, draw one quantity.

    STORE holds points.sqlite, written as points finish, and results.nc, an xarray data set; --resume continues an interrupted
    sweep. A STORE in place of SCENE is drawn: a third axis becomes panels, further ones need --at.

    Parameters
    ----------
    source : a scene, or a store
    axes : axis: x,y,z or start:stop:count; all combinations
    points : points, .csv, .json or .toml
    design : sobol:N or lhs:N points in ranges, or a file of a grid
    ranges : low:high of a key, for such a design
    seed : of its random numbers
    quantities : ends of intervals, too: K_low, K_high, kyy_low, kyy_high
    settings : change a key of the scene
    executor : by name: serial, processes, dask, or a plug-in
    workers : processes of these; None: 2
    scheduler : running dask scheduler, tcp://HOST:8786
    store : folder; None: raceway-out/TITLE-sweep
    resume : go on with a store: compute what is not finished
    retry_failed : with a store that is there: failed points again, too
    force : also runs that take longer than a day
    csv : write STORE/results.csv, too
    value : draw this quantity, e.g. K, p0 or stiffness:y,y
    x : of the picture, axis to the right; None: the speed, or the longest one
    y : second axis; in curves what the colours stand for
    at : choose a value of an axis
    kind : of the picture; None: map where both axes have more than 8 values, else curves
    picture : a .png, .svg or .pdf of K or --plot; None: STORE/NAME-KIND.png
    plan : print how many points, how long, how much memory and disk, and stop
    """
    from raceway.points.sweep import executor_of, prepare, workload

    scene, choice = Path(source), _Choice(value, kind, x, y, tuple(at), picture)
    if (is_store := exists(scene)) or choice.asked:
        require_matplotlib("leave out --plot: --json and --csv have the values")
    if picture is not None:
        writable(Path(picture).parent)
    if is_store:
        return _Drawn(choice.draw(scene))
    if not (axes or points or design or scene.is_file()):
        rule = f"holds no sweep: raceway sweep SCENE --grid key=start:stop:count --out {source} makes it"
        raise SceneError.at("STORE", source, rule)
    registry, points_swept = registry_with(plugins), _design(tuple(axes), points, design, tuple(ranges), seed)
    pool = executor_of(executor, {"workers": workers, "scheduler": scheduler}, registry)
    tables = plain_tables(scene, *settings, registry=registry)
    folder = writable(RESULTS / f"{slug(str(tables['title']))}-sweep" if store is None else Path(store))
    if (resume or retry_failed) and not exists(folder):
        warnings.warn(f"`{folder}` holds no sweep to resume: a new one is started", stacklevel=2)
    task = prepare(tables, points_swept, folder, plugins, resume or retry_failed or plan, quantities)
    return workload(task, pool) if plan else _answer(task, pool, force, retry_failed, scheduler, csv, choice, progress)


def _answer(
    task: Sweep, pool: Executor, force: bool, retry_failed: bool, scheduler: str | None, csv: bool, choice: _Choice,
    progress: ShowProgress,
) -> Answer:  # fmt: skip
    """What the store holds once the points are computed, and its files; Interrupted after Ctrl-C."""
    from raceway.points.sweep import fill_store, refuse_large

    refuse_large(task, pool, force)
    if choice.asked:
        choice.foresee(task.design, task.facts["scene"])
    stop: BaseException | None = None  # what ended the sweep before its last point
    try:
        with telling(progress, remaining=True) as report:
            if scheduler:
                report(f"waiting for {scheduler}", 0, 0)
            fill_store(task, pool, retry_failed, report).close()
    except (KeyboardInterrupt, RacewayError) as why:
        if not (task.store / POINTS).is_file():
            raise
        stop = why
        if isinstance(why, KeyboardInterrupt):
            answered()
    with open_store(task.store) as store:
        states, missing = store.status(), all_failed(store)
        libraries = [name for name in ("h5netcdf", "h5py") if find_spec(name) is None]
        if libraries:
            words = f"no results.nc: it needs {', '.join(libraries)}; {extra('sweep')}; points.sqlite holds everything"
            warnings.warn(words, stacklevel=2)
        steps: list[Callable[[], object]] = [] if libraries else [lambda: write_netcdf(store)]
        steps += [lambda: write_csv(store, task.store / TABLE)] if csv else []
        if choice.asked and stop is None and missing is None:
            steps.append(lambda: choice.draw(task.store)["files"][0])
        answer = _Swept(task.store, *_files(steps, task.store))
    if isinstance(stop, RacewayError) or answer.fault is None:
        answer = attrs.evolve(answer, fault=stop if isinstance(stop, RacewayError) else missing)
    if isinstance(stop, KeyboardInterrupt):
        words = f"{states['done']} of {states['total']} points are done; the same command with --resume continues{' and draws' if choice.asked else ''}"
        warnings.warn(words, stacklevel=2)
        raise Interrupted(answer) from stop
    return answer


def _files(steps: Iterable[Callable[[], object]], folder: Path) -> tuple[list[str], RacewayError | None]:
    """Names of files that were written, up to the first that could not be, and why."""
    files = [str(folder / POINTS)]
    try:
        files += (str(write()) for write in steps)
    except RacewayError as why:
        return files, why
    return files, None


def _design(
    axes: tuple[str, ...], points: str | Path | None, design: str | Path | None, ranges: tuple[str, ...], seed: int
) -> Design:
    options = {"--grid": axes, "--list": points, "--design": design}
    if len(names := [name for name, value in options.items() if value]) > 1:
        raise SceneError.at(" and ".join(names), None, "contradict each other: give one of them")
    if ranges or (design is not None and not Path(design).suffix):
        return sampled(ranges, str(design or ""), seed)
    file = points or design
    return grid(axes) if file is None else design_file(Path(file))
