"""``raceway stability``: stiff and extreme cases, each with an expectation, over all laws and transient integrators."""

from __future__ import annotations

import hashlib
import json
import time
import traceback
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.engine import Item, local, processor_time, work_through
from raceway.studies.many.row_store import RowStore, program_key
from raceway.studies.stability.case import FAILED, Case, Row, Rows, short
from raceway.studies.stability.catalogue import catalogue

if TYPE_CHECKING:
    from raceway.pipeline.simulate import OnProgress

PROCESSES = 2
#: A case that takes longer has hung [s].  The longest takes 20 s, and compiling for the first time on busy cores some minutes.
PATIENCE_S = 900.0


@attrs.frozen
class Stability:
    """Rows of a catalogue.

    Attributes
    ----------
    cases : how many were run or taken from what is kept;  reused : how many of them were kept
    left_out : how many were not asked for
    seconds, cpu_s : wall time; processor time of all processes, compiling too
    fault : why rows could not be kept, or None
    """

    title: str
    rows: tuple[Row, ...]
    cases: int
    left_out: int
    reused: int
    seconds: float
    cpu_s: float
    processes: int
    fault: RacewayError | None = None

    @property
    def failed(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.verdict == FAILED)

    def to_dict(self) -> Tables:
        names = ("title", "cases", "left_out", "reused", "seconds", "cpu_s", "processes")
        plain = {name: getattr(self, name) for name in names}
        return {**plain, "failed": len(self.failed), "rows": [attrs.asdict(row) for row in self.rows]}

    def write(self, folder: Path) -> list[Path]:
        """stability.json and stability.md.

        Raises
        ------
        RacewayError
            A folder or disk that cannot be written.
        """
        from raceway.studies.stability.picture import write

        return write(self.to_dict(), folder)


def stability(
    tables: ReadTables | None = None,
    only: str | None = None,
    every: bool = False,
    processes: int = PROCESSES,
    store: Path | None = None,
    registry: Registry | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> Stability:
    """Run the catalogue.

    Parameters
    ----------
    tables : plain tables of a scene that is put through the cases that suit any scene; the whole catalogue when None
    only : part of the names of the cases that are run;  every : all cases; without either the quick ones
    processes : how many work at a time; 0 works in this process, without guard against a hang
    store : file that finished cases are kept in and taken from
    plugins : one-off plug-in files, which each process loads
    on_progress : called as ``on_progress(what, done, total)`` after each case; an exception stops the study

    Raises
    ------
    SceneError
        A name that no case has, or a scene that cannot be put through the catalogue.
    """
    begun, cpu = time.monotonic(), processor_time()
    registry = registry or default_registry()
    known = catalogue(registry, tables)
    cases = [case for case in known if (case.quick or every if only is None else only in case.name)]
    if not cases:
        names = list(dict.fromkeys(case.name for case in known))
        raise SceneError.at("--only", only, f"no case is called so{nearest(only or '', names)}; cases: {'; '.join(names)}")
    kept = RowStore(store)
    rows, reused = measured(cases, processes, registry, plugins, kept, on_progress)
    title = "Stiff and extreme cases" if tables is None else f"Stiff and extreme cases of {tables.get('title', 'the scene')}"
    taken = time.monotonic() - begun, processor_time() - cpu
    return Stability(title, tuple(rows), len(cases), len(known) - len(cases), reused, *taken, processes, kept.fault)


def measured(
    cases: Sequence[Case],
    processes: int,
    registry: Registry,
    plugins: Sequence[Path] = (),
    store: RowStore | None = None,
    on_progress: OnProgress | None = None,
    patience: float = PATIENCE_S,
) -> tuple[list[Row], int]:
    """Rows of all cases, and how many cases were kept from before; none can stop the others by hanging or dying.

    Parameters
    ----------
    processes : how many work at a time; 0 works in this process, without guard against a hang
    patience : time after which a case of another process is given up [s]
    """
    program = program_key(registry)
    items = [Item(_key(case, program), case.name, case) for case in cases]
    executor = local(registry, processes, **({"patience": patience} if processes else {}))
    done, reused = work_through(
        _plain, items, store or RowStore(None), executor, registry, plugins, on_progress,
        lambda item, reason: {"rows": [attrs.asdict(Rows(item.name, item.given.setting).lost(reason))]},
    )  # fmt: skip
    return [Row(**row) for each in done for row in each["rows"]], reused


def _key(case: Case, program: str) -> str:
    text = json.dumps([attrs.asdict(case), program], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _plain(case: Case, registry: Registry) -> Tables:
    return {"rows": [attrs.asdict(row) for row in rows_of(case, registry)]}


def rows_of(case: Case, registry: Registry) -> list[Row]:
    """The rows of a case; whatever its code raises becomes a failed row."""
    rows, (module, _, function) = Rows(case.name, case.setting), case.measure.partition(":")
    try:
        place = module if "." in module else f"raceway.studies.stability.{module}"
        getattr(import_module(place), function)(rows, registry, **case.arguments)
    except Exception as why:  # a traceback is what no case may end in: it is the finding
        last = traceback.extract_tb(why.__traceback__)[-1]
        rows.lost(f"{type(why).__name__} in {Path(last.filename).name}, line {last.lineno}: {short(why)}")
    return rows.written
