"""Runs a sweep: from a design to a store whose points are all finished, by an executor."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import RacewayError
from raceway.framework.contracts import Batch, Lost
from raceway.pipeline.simulate import OnProgress
from raceway.planning.plan import make_plan
from raceway.planning.wall_time import START_S
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.engine import answers
from raceway.studies.many.identity import differences, identity
from raceway.studies.many.work import Work, registry_of
from raceway.studies.sweep.design import Design
from raceway.studies.sweep.store import Store, exists, open_store, written
from raceway.studies.sweep.survey import Survey, survey
from raceway.studies.sweep.work import Chain, unfinished_row

if TYPE_CHECKING:
    from raceway.framework.contracts import Executor

#: Points of a chain at most, and the time that a chain should take [s]: it is what a killed worker loses.
_LONGEST, _CHAIN_S = 16, 1.0
#: Chains at least in a sweep: otherwise some of many workers have nothing to do.
_CHAINS = 16


@attrs.frozen
class Sweep:
    """A sweep that was looked over: what is computed, where it goes, and what is there already.

    Attributes
    ----------
    length : of chains [points]
    """

    tables: Tables
    design: Design
    store: Path
    plugins: tuple[str, ...]
    survey: Survey
    facts: Tables
    length: int


def prepare(tables: ReadTables, design: Design, store: Path, plugins: tuple[Path, ...] = (), resume: bool = False) -> Sweep:
    """Look over a sweep; nothing is computed or written.

    Parameters
    ----------
    tables : plain tables of a TOML scene;  plugins : one-off plug-in files
    resume : go on with a store that is there

    Raises
    ------
    SceneError
        Mistakes in the scene or in the values that are swept.
    RacewayError
        A store that is there already and is not to be gone on with, or that belongs to another scene, sweep or version.
    """
    files = tuple(str(file.resolve()) for file in plugins)
    registry = registry_of(files)
    found = survey(tables, design, registry)
    facts = {
        "scene": found.scene.to_dict(),
        "design": design.to_dict(),
        "identity": identity(registry, found.used),
        "files": found.files,
    }
    if any(key.rpartition(".")[2] == "kind" for key in design.keys):
        facts["tables"] = dict(tables)  # options of kinds that the first point does not have
    if exists(store):
        with open_store(store) as there:
            _refuse_other(there, facts, store)
            if not resume:
                states = there.status()
                raise RacewayError(
                    f"`{store}` holds this sweep already, {states['done']} of {states['total']} points done: go on with "
                    "--resume, or choose another folder with --out. Nothing is overwritten."
                )
    elif (store / "results.nc").exists():
        raise RacewayError(f"`{store}` holds a results.nc that is not of a sweep: choose another folder with --out.")
    return Sweep(dict(tables), design, store, files, found, facts, _chain_length(found, design))


def _chain_length(found: Survey, design: Design) -> int:
    """From the design and the predicted time of a point alone, so that a sweep that is resumed computes the same chains."""
    scene = found.scene
    try:
        plan = make_plan(scene)
        seconds = plan.predicted_work_s - plan.predicted_once_s - START_S
    except RacewayError:
        return 1
    by_time = int(_CHAIN_S / max(seconds, 1e-3))
    return max(1, min(_LONGEST, by_time, design.size // _CHAINS))


def sweep(prepared: Sweep, executor: Executor, retry_failed: bool = False, on_progress: OnProgress | None = None) -> Store:
    """Compute what is not finished; the store, open to be read.

    Parameters
    ----------
    executor : follows ``raceway.framework.contracts.Executor``
    on_progress : called as ``on_progress(what, done, total)``; an exception stops the sweep

    Raises
    ------
    PluginError
        An executor that cannot work, or a worker that is not fit for it.
    RacewayError
        A disk that takes no more.  Whatever is raised, Ctrl-C too: what is finished is kept.
    """
    design = prepared.design
    wanted = prepared.facts["identity"]
    work = Work(Chain(prepared.tables, wanted["program"]), prepared.plugins, wanted)
    with written(prepared.store, prepared.facts) as store:
        store.wait_again(["running", *(["failed"] if retry_failed else [])])
        lost = store.repair()
        if lost:
            warnings.warn(f"{len(lost)} rows of the store are damaged: their points are computed again", stacklevel=2)
        waiting = store.numbers("waiting")
        done, total = design.size - len(waiting), design.size
        chains = [chain for chain in design.chains(prepared.length) if not waiting.isdisjoint(chain)] if waiting else []

        def batches() -> Iterator[Batch]:
            for number, chain in enumerate(chains):
                left = [n for n in chain if n in waiting]
                store.mark(left, "running")
                # Each begins from the one before it: those before the last that waits are computed too, for the same bits.
                yield number, [[(n, design.point(n)) for n in chain[: chain.index(left[-1]) + 1]]]

        try:
            with closing(answers(executor, work, batches())) as found:
                for number, answer in found:
                    if isinstance(answer, Lost):
                        rows = [unfinished_row(n, answer.reason) for n in chains[number] if n in waiting]
                    else:
                        rows = [row for row in answer[0] if row["number"] in waiting]
                    store.put(rows)
                    done += len(rows)
                    if on_progress is not None:
                        on_progress("points", done, total)
        finally:
            with suppress(RacewayError):  # a full disk was reported already; the next sweep does it
                store.wait_again(["running"])
    return open_store(prepared.store)


def _refuse_other(there: Store, facts: ReadTables, store: Path) -> None:
    """A store that holds something else is named and left alone."""
    reasons = _changed(there.scene, facts["scene"]) or _changed(there.facts.get("tables", {}), facts.get("tables", {}))
    what = "another scene"
    if not reasons:
        what, reasons = "another sweep", there.design.differences(Design.from_dict(facts["design"]))
    if not reasons and there.facts["files"] != facts["files"]:
        what, reasons = "another content of the files that the scene names", sorted({*there.facts["files"], *facts["files"]})
    if not reasons:
        what, reasons = "another version", differences(there.facts["identity"], facts["identity"])
    if reasons:
        told = "; ".join(reasons[:5]) + ("; ..." if len(reasons) > 5 else "")
        raise RacewayError(
            f"`{store}` holds results of {what} ({told}). It is not overwritten: choose another folder with --out."
        )


def _changed(old: object, new: object, place: str = "") -> list[str]:
    """``key: old, now new`` for every leaf of two trees of tables that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        keys = [*old, *(key for key in new if key not in old)]
        return [w for key in keys for w in _changed(old.get(key), new.get(key), f"{place}.{key}" if place else key)]
    return [] if old == new else [f"{place}: {old!r} there, {new!r} here"]
