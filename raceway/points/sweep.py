"""One scene at many points, for Python and the command line alike: ``raceway.sweep``."""

from __future__ import annotations

import json
import reprlib
import tempfile
import time
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import attrs
import numpy as np

from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import COLUMNS, ENDS, KYY_TILTS_FOLLOW, MODEL_BOUND
from raceway.core.threads import usable_cores
from raceway.errors import PluginError, RacewayError, SceneError
from raceway.framework.contracts import Batch, Executor, Lost
from raceway.framework.doors import PATH, PATHS, TEXTS, Reader, door, member, reader
from raceway.framework.loading.registry import Registry, registry_with
from raceway.framework.options import at_least
from raceway.framework.shown import duration
from raceway.pipeline.simulate import OnProgress
from raceway.points.axes import Design, grid, listed_points, sampled
from raceway.points.base import Base
from raceway.points.column_quantities import MOVING, QUANTITIES, Columns, stated_columns
from raceway.points.dataset import DOF, SweepStore, all_failed, block_edges, dataset, open_store, values_of
from raceway.points.engine import Work, answers, differences, identity, registry_of, worker
from raceway.points.function import BLOCK, Function, PointStatus, refuse_bytes
from raceway.points.store import Row, exists, written
from raceway.points.workload import Workload, of_columns, run_times, survey
from raceway.scene.keys import continuous_keys
from raceway.scene.scene import Scene, SceneSource, scene_from_dict
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import xarray

#: Predicted time [s] of runs beyond which a sweep has to be forced.
_LIMIT_S = 86_400.0
#: A run in both files [bytes].
_RUN_BYTES = 5000.0
#: Parts of a block that threads share: it takes less than a second on one core.
_SHARED = 4


@attrs.frozen
class Point:
    """Callable on ``(number, point)``; the row of a run, whose content is ``{"values", "warnings"}``."""

    tables: ReadTables  # of the scene
    further: tuple[str, ...] = ()  # names of ``ENDS`` that are asked for

    def __call__(self, task: tuple[int, Tables], registry: Registry) -> Row:
        from raceway.pipeline.run import run

        number, point = task
        wall, cpu = time.perf_counter(), time.process_time()
        state, reason, content, cost = "failed", "", Tables(), Tables()
        try:
            result = run(Base(self.tables, registry).scene_at(point), registry)
            infinite = [name for name, value in result.quantities.items() if np.isposinf(value).all()]
            ends = {name: ENDS[name].of(result) for name in self.further}
            values = values_of(result) | {name: value for name, value in ends.items() if value is not None}
            content = {"values": values, "unlimited": infinite, "warnings": list(result.warnings)}
            cost = {name: result.cost[name] for name in ("compile_s", "steps", "newton_iterations")}
            state = "done"
        except RacewayError as error:
            reason = str(error)
        except Exception as error:  # a fault of the program or of a plug-in costs its point, not the sweep
            reason = f"unexpected {type(error).__name__}: {error or 'no message'}"
        cost |= {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu, "worker": worker()}
        return Row(number, state, reason, content, cost)


@attrs.frozen
class _Block:
    """Callable on ``(first, columns)``, the number of the first point and the columns of the keys; the row of these points.

    A row's content are the columns of quantities and ``status``, its reason is those of the points, by their numbers, as JSON.
    """

    tables: Tables  # of the scene at the first point of the sweep
    outputs: tuple[str, ...]  # names of quantities

    def __call__(self, task: tuple[int, Columns], registry: Registry) -> Row:
        first, columns = task
        wall, cpu = time.perf_counter(), time.process_time()
        function = Function(scene_from_dict(self.tables, registry), tuple(columns), self.outputs, threads=usable_cores())
        answer = function.with_reasons(columns, function.looped(columns))
        texts = answer.pop("reason")
        reasons = {first + int(k): texts[k] for k in np.flatnonzero(texts != "")}
        times = {"wall_s": time.perf_counter() - wall, "cpu_s": time.process_time() - cpu, "worker": worker()}
        return _block_row(first, answer, reasons, times)


def _block_row(first: int, answer: Columns, reasons: dict[int, str], times: ReadTables) -> Row:
    """The row of finished columns, with the number of points of each status."""
    status = answer["status"]
    counts = {how.name: int((status == how).sum()) for how in PointStatus}
    return Row(f"{first}:{first + len(status)}", "done", json.dumps(reasons), answer, {**counts, **times})


def _column_function(base: Base, scene: Scene, design: Design) -> Function | None:
    """All columns of a sweep as a function of its keys; None where points need runs of their own.

    scene : at the first point
    """
    keys = {key.path for key in continuous_keys(scene)}
    if not all(axis.numeric and axis.key in keys for axis in design.axes):
        return None
    of_plugins = stated_columns(scene, base.registry)
    moving, tilts = scene.excitation is not None, scene.supports.tilt != "locked"
    outputs = [name for name in COLUMNS if name in QUANTITIES and (moving or name not in MOVING)]
    left_out = [] if tilts else [KYY_TILTS_FOLLOW.name]
    if any(key.startswith("bearing.") for key in design.keys):  # rings grow by their own sections, each solved for alone
        left_out.append(MODEL_BOUND.name)
    outputs = [name for name in (*outputs, *of_plugins) if name not in left_out]
    function = Function(scene, design.keys, tuple(outputs), threads=usable_cores())
    # What bodies that deform are off by is known to runs alone.
    quick = not function.why_slow and function.contacts_alone
    return function if quick and _alone(function, base, design) else None


def _alone(function: Function, base: Base, design: Design) -> bool:
    """Whether the numbers of a point change nothing else in the scene, looked at where each is least and largest."""
    for axis in design.axes:
        for number in (int(axis.column.argmin()), int(axis.column.argmax())):
            point = {**design.point(0), axis.key: axis.values[number]}
            try:
                if base.scene_at(point).to_dict() != function.scene_at(point).to_dict():
                    return False
            except SceneError:  # seen where all numbers of a point are known
                continue
    return True


@attrs.frozen
class Sweep:
    """A sweep that was looked over: what is computed, where it goes, and what is there already."""

    base: Base
    design: Design
    store: Path
    plugins: tuple[str, ...]
    facts: Tables
    function: Function | None  # that computes blocks of points; None where each point is a run
    further: tuple[str, ...] = ()  # names of ``ENDS`` that are asked for


def prepare(
    scene: SceneSource,
    axes: Axes,
    store: Path,
    plugins: Iterable[str | Path] = (),
    resume: bool = False,
    quantities: Iterable[str] = (),
) -> Sweep:
    """Look over a sweep; nothing is computed or written.  Options that a change of kind leaves out are warned of.

    plugins : one-off plug-in files;  resume : go on with a store that is there;  quantities : further ones, of ``ENDS``

    SceneError: Mistakes in the scene or in the values that are swept.
    RacewayError: A store that is there already and is not to be gone on with, or that belongs to another scene, sweep or version.
    """
    files, further = tuple(str(Path(file).resolve()) for file in plugins), tuple(quantities)
    for name in further:
        member("quantities", name, ENDS)
    base = Base.of(scene, registry_of(files))
    swept = axes if isinstance(axes, Design) else grid(axes) if isinstance(axes, Mapping) else listed_points(axes)
    design = base.in_units(swept)
    try:
        overview = survey(base, design)
    except SceneError as error:
        # Who asks for a motion at speed 0 is told how a stiffness from 0 r/min is had.
        more = (f". {_FROM_ZERO}" if each.path == SPEED and each.value == 0 else "" for each in error.mistakes)
        mistakes = [attrs.evolve(m, message=m.message + words) for m, words in zip(error.mistakes, more, strict=True)]
        raise SceneError(mistakes) from None
    for note in overview.notes:
        warnings.warn(note, stacklevel=2)
    # Intervals are known to runs alone.
    function = None if files or further else _column_function(base, overview.scene, design)
    stated = stated_columns(overview.scene, base.registry) | {name: ENDS[name] for name in further}
    facts = {
        "scene": overview.scene.to_dict(),
        "given": base.tables_at(design.point(0)),
        "design": design.to_dict(),
        "block": 0 if function is None else _SHARED * BLOCK[function.moving],
        "quantities": {name: each.labels for name, each in stated.items()},
        "identity": identity(base.registry, overview.used),
        "files": overview.files,
    }
    if any(key.rpartition(".")[2] == "kind" for key in design.keys):
        facts["tables"] = dict(base.tables)  # options of kinds that the first point does not have
    if exists(store):
        with open_store(store) as present:
            _refuse_other(present, facts, store)
            if not resume:
                states = present.status()
                raise RacewayError(
                    f"`{store}` holds this sweep already, {states['done']} of {states['total']} points done: go on with "
                    "--resume, or choose another folder with --out. Nothing is overwritten."
                )
    elif (store / "results.nc").exists():
        raise RacewayError(f"`{store}` holds a results.nc that is not of a sweep: choose another folder with --out.")
    return Sweep(base, design, store, files, facts, function, further)


def refuse_large(task: Sweep, executor: Executor, force: bool) -> None:
    """Refuse points whose results fill the memory, or whose runs would take longer than a day unless they are forced.

    RacewayError: With bytes or the predicted time.
    """
    refuse_bytes(task.design.size, sum(map(_entry_count, COLUMNS)), "give fewer points at a time")
    if task.function is None and not force:
        work = workload(task, executor, planned=1)
        if work.seconds > _LIMIT_S:
            why = f"{work.runs + work.refused} runs would take about {duration(work.seconds)}: give fewer points or more workers, or force them"
            raise RacewayError(why)


def workload(task: Sweep, executor: Executor, planned: int = 100) -> Workload:
    """What is not finished yet: its size, and its time as that of so many planned points; nothing is computed."""
    design, function, present = task.design, task.function, 0
    if exists(task.store):
        with open_store(task.store) as store:
            present = design.size - store.status()["waiting"]
    title, left = str(task.facts["scene"]["title"]), design.size - present
    if function is None:
        seconds, refusals = run_times(left, lambda n: task.base.scene_at(design.point(n)), planned)
        return Workload(
            title, design.size, seconds / getattr(executor, "workers", 1), runs=left - refusals, refused=refusals, stored=present,
            disk_bytes=_RUN_BYTES * design.size, why_runs="an axis, the scene or a quantity that no compiled loop takes",
        )  # fmt: skip
    return of_columns(title, function, design.size, present, len(design.keys) + sum(map(_entry_count, function.outputs)))


def _entry_count(name: str) -> int:
    """Entries of a quantity at a point."""
    return len(DOF) ** len(COLUMNS[name].dims) if name in COLUMNS else 1


def fill_store(
    task: Sweep, executor: Executor, retry_failed: bool = False, on_progress: OnProgress | None = None
) -> SweepStore:
    """Compute what is not finished; the store, open to be read.

    executor : follows ``raceway.framework.contracts.Executor``
    on_progress : called as ``on_progress(what, done, total)``; an exception stops the sweep

    PluginError: An executor that cannot work, or a worker that is not fit for it.
    RacewayError: A disk that takes no more.  Whatever is raised, Ctrl-C too: finished points are stored.
    """
    design, length = task.design, int(task.facts["block"])
    edges = block_edges(design.size, length)
    with written(task.store, task.facts, edges or range(design.size)) as store:
        if retry_failed:
            store.wait(store.keys("failed"))
        waiting = store.keys("waiting")

        def advance(count: int) -> int:
            if on_progress is not None:
                on_progress("points", count, design.size)
            return count

        if task.function is not None:
            blocks = [ends for key, ends in edges.items() if key in waiting]
            count = design.size - sum(last - first for first, last in blocks)
            batches = ((k, [(first, design.columns(first, last))]) for k, (first, last) in enumerate(blocks))
            for k, answer in _rows(executor, task, _Block(task.facts["given"], task.function.outputs), batches):
                first, last = blocks[k]
                leftover = {"status": np.full(last - first, PointStatus.FAILED)}  # with its worker: to runs
                store.put([_block_row(first, leftover, {}, {}) if isinstance(answer, Lost) else answer])
                count = advance(count + last - first)
            # What the loop has left and no run has finished.
            complete, numbers = store.keys("done") | store.keys("failed"), list[int]()
            for key, (first, _) in edges.items():
                row = store.get(key)
                if row.state == "done" and row.cost[PointStatus.FAILED.name]:
                    numbers += (first + np.flatnonzero(row.content["status"] == PointStatus.FAILED)).tolist()
            numbers = [number for number in numbers if number not in complete]
        else:
            numbers = [number for number in range(design.size) if number in waiting]
        count = design.size - len(numbers)
        batches = ((n, [(n, design.point(n))]) for n in numbers)
        for n, answer in _rows(executor, task, Point(task.base.tables, task.further), batches):
            store.put([Row(n, "failed", answer.reason, {}, {}) if isinstance(answer, Lost) else answer])
            count = advance(count + 1)
    return open_store(task.store)


def _rows(
    executor: Executor, task: Sweep, function: Point | _Block, batches: Iterable[Batch]
) -> Iterator[tuple[int, Row | Lost]]:
    """Number and row of each batch of one task."""
    work = Work(function, task.plugins, task.facts["identity"])
    with closing(answers(executor, work, batches)) as results:
        for number, answer in results:
            yield number, answer if isinstance(answer, Lost) else answer[0]


def _refuse_other(present: SweepStore, facts: ReadTables, store: Path) -> None:
    """A store that holds something else is named and left alone."""
    tables = (present.facts.get("tables", {}), facts.get("tables", {}))
    reasons = _tree_changes(present.scene, facts["scene"]) or _tree_changes(*tables)
    difference = "another scene"
    if not reasons:
        difference, reasons = "another sweep", _tree_changes(present.facts["design"], facts["design"])
    if not reasons:
        difference, reasons = "other quantities", sorted(present.facts["quantities"].keys() ^ facts["quantities"].keys())
    if not reasons and present.facts["files"] != facts["files"]:
        difference, reasons = ("changed files of the scene", sorted({*present.facts["files"], *facts["files"]}))
    if not reasons:
        difference, reasons = "another version", differences(present.facts["identity"], facts["identity"])
    if reasons:
        words = "; ".join(reasons[:5]) + ("; ..." if len(reasons) > 5 else "")
        why = f"`{store}` holds results of {difference} ({words}). It is not overwritten: choose another folder with --out."
        raise RacewayError(why)


def _tree_changes(old: object, new: object, path: str = "") -> list[str]:
    """``key: old, now new`` for every leaf of two trees of tables that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        keys = [*old, *(key for key in new if key not in old)]
        return [w for key in keys for w in _tree_changes(old.get(key), new.get(key), f"{path}.{key}" if path else key)]
    return [] if old == new else [f"{path}: {reprlib.repr(old)} there, {reprlib.repr(new)} here"]


SPEED = "excitation.speed_rpm"
_FROM_ZERO = (
    "A force that turns has a speed; K(n) from 0 r/min is the tangent, swept over the speed of the ring: raceway sweep SCENE "
    "--set identifier.kind=tangent --grid kinematics.spin_speed_rpm=0:20000:21 --out STORE, then for rotor programs raceway export "
    "STORE --from tangent --ross bearing.toml"
)
#: Values of the axes by key, or a list of points.
Axes = Mapping[str, object] | Iterable[Mapping[str, object]] | Design
_AXES = Reader("a mapping of keys to values, or a list of points", lambda v: dict(v) if hasattr(v, "keys") else list(v))
_EXECUTOR = reader("text or an executor", lambda v: isinstance(v, str) or hasattr(v, "compute"))


@door
def sweep(
    scene: SceneSource,
    axes: Annotated[Axes, _AXES],
    *,
    executor: Annotated[str | Executor, _EXECUTOR] = "serial",
    workers: Annotated[int | None, at_least(1)] = None,
    store: Annotated[str | Path | None, PATH] = None,
    resume: bool = False,
    retry_failed: bool = False,
    design: str | None = None,
    seed: Annotated[int, at_least(0)] = 0,
    quantities: Annotated[Iterable[str], TEXTS] = (),
    force: bool = False,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> xarray.Dataset:
    """Compute a scene at every point of a grid, a list or a random design.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    axes : key of the scene -> its values (array (n,), list, or the text "start:stop:count"), all combinations of which are computed;
        or a list of points, each key -> value; with ``design`` key -> range (low, high)
    executor : "serial", "processes", "dask" or a plug-in's name, or an executor
    workers : processes of these, by default 2
    store : folder of all finished points; None: a temporary one, removed when the results are loaded
    resume : go on with a store that is there: compute what is not finished;  retry_failed : failed points again, too
    design : "sobol:N", of a power of 2, or "lhs:N": N points that fill the ranges;  seed : of its random numbers
    quantities : "K_low", "K_high", "kyy_low", "kyy_high" [N/m]: ends of the intervals of K and kyy, of which each point is a run
    force : also where runs are predicted to take longer than a day
    plugins : files of one-off plug-ins, which the workers load, too
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    xarray.Dataset
        ``equivalent_stiffness`` [N/m], ``equivalent_damping`` [N s/m], ``stiffness`` (..., 5, 5), ``p0`` [Pa] and others over the
        keys of ``axes``, units in their ``attrs``; ``status`` says how a point was computed: "computed" in a compiled loop, which
        does not look at the stability of orbits nor warn, "run" by itself, or "refused" and "failed", whose values are NaN

    Raises
    ------
    SceneError, PluginError
        A mistake in the scene or in a value of an axis, an executor that is not known or cannot work; nothing has been computed.
    ConvergenceError
        Every point failed.
    RacewayError
        A store that cannot be written, or that holds another sweep; more points than the memory holds, or than a day is long.

    Notes
    -----
    Workers of "dask" import the program that calls: outside notebooks it keeps what it does below ``if __name__ == "__main__":``.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sweep({"bearing": {"preset": "B7206C"}}, {"load.axial": [400.0, 1000.0]})
    >>> (1e-6 * found.stiffness.sel(dof="y", dof2="y")).round(1).values.tolist()  # kyy [N/um]
    [183.4, 238.2]
    """
    with tempfile.TemporaryDirectory(prefix="raceway-sweep-") as temporary, telling(progress, remaining=True) as report:
        folder = Path(temporary) / "sweep" if store is None else writable(Path(store))
        worker_pool = executor_of(executor, {"workers": workers}, registry_with(plugins))
        if design is not None:
            if not isinstance(axes, Mapping):
                raise SceneError.at("axes", None, f"must be ranges, key -> (low, high), for the design {design}")
            axes = sampled(axes, design, seed)
        task = prepare(scene, axes, folder, plugins, resume or retry_failed, quantities)
        refuse_large(task, worker_pool, force)
        with fill_store(task, worker_pool, retry_failed, report) as results:
            if (fault := all_failed(results)) is not None:
                raise fault
            return dataset(results, registry_with(plugins))


def executor_of(name: str | Executor, options_given: ReadTables, registry: Registry) -> Executor:
    """An executor by its name, with the options that are given and that it has.

    PluginError: A name that is not known, or an option that it does not have.
    """
    options: Tables = {key: value for key, value in options_given.items() if value is not None}
    if not isinstance(name, str):
        if options:
            raise PluginError(f"{', '.join(options)}: an executor object already has its options")
        return name
    plugin = registry.find("executor", name).plugin
    option_names = {field.name for field in attrs.fields(plugin)}
    for key in options:
        if key not in option_names:
            raise PluginError(f"executor '{name}' has no --{key}: leave it out, or choose another --executor")
    try:
        return plugin(**options)
    except ValueError as why:
        raise PluginError(f"executor '{name}': {why}") from None
