"""``raceway stability``: stiff and extreme cases, each with an expectation, over all laws and transient integrators.

``catalogue`` is the list of cases, ``case`` says what an expectation is, ``workers`` runs the
cases in processes of their own; ``limits``, ``energy``, ``scenes``, ``surface`` and ``elements`` measure.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.engine import processor_time
from raceway.studies.many.row_store import RowStore
from raceway.studies.stability.case import FAILED, Row
from raceway.studies.stability.catalogue import catalogue
from raceway.studies.stability.workers import measure

if TYPE_CHECKING:
    from raceway.pipeline.simulate import OnProgress

PROCESSES = 2


@attrs.frozen
class Stability:
    """Rows of a whole catalogue.

    Attributes
    ----------
    cases : how many were run or taken from what is kept;  reused : how many of them were kept
    seconds, cpu_s : wall time; processor time of all processes, compiling too
    fault : why rows could not be kept, or None
    """

    title: str
    rows: tuple[Row, ...]
    cases: int
    reused: int
    seconds: float
    cpu_s: float
    processes: int
    fault: RacewayError | None = None

    @property
    def failed(self) -> tuple[Row, ...]:
        return tuple(row for row in self.rows if row.verdict == FAILED)

    def to_dict(self) -> Tables:
        return {
            "title": self.title,
            "cases": self.cases,
            "reused": self.reused,
            "seconds": self.seconds,
            "cpu_s": self.cpu_s,
            "processes": self.processes,
            "failed": len(self.failed),
            "rows": [attrs.asdict(row) for row in self.rows],
        }

    def write(self, folder: Path) -> list[Path]:
        """stability.json and stability.md.

        Raises
        ------
        RacewayError
            A folder or disk that cannot be written.
        """
        from raceway.studies.stability.picture import StabilityReport

        return StabilityReport().write(self.to_dict(), folder)


def stability(
    tables: ReadTables | None = None,
    only: str | None = None,
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
    only : part of the names of the cases that are run; all when None
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
    cases = catalogue(registry, tables)
    if only is not None:
        names = list(dict.fromkeys(case.name for case in cases))
        cases = tuple(case for case in cases if only in case.name)
        if not cases:
            raise SceneError.at("--only", only, f"no case is called so{nearest(only, names)}; cases: {'; '.join(names)}")
    kept = RowStore(store)
    found, reused = measure(cases, processes, registry, plugins, kept, on_progress)
    title = "Stiff and extreme cases" if tables is None else f"Stiff and extreme cases of {tables.get('title', 'the scene')}"
    in_order = tuple(row for rows in found for row in rows)
    taken = time.monotonic() - begun, processor_time() - cpu
    return Stability(title, in_order, len(cases), reused, *taken, processes, kept.fault)
