"""The cases of the catalogue through the engine: none of them can stop the others by hanging or dying."""

from __future__ import annotations

import hashlib
import json
import traceback
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.framework.registry import Registry
from raceway.storage.tables import Tables
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, program_key
from raceway.studies.stability.case import Case, Row, lost, short

if TYPE_CHECKING:
    from raceway.pipeline.simulate import OnProgress

#: A case that takes longer has hung [s].  The longest takes 20 s, and compiling for the first time on busy cores some minutes.
PATIENCE_S = 900.0


def measure(
    cases: Sequence[Case],
    processes: int,
    registry: Registry,
    plugins: Sequence[Path] = (),
    store: RowStore | None = None,
    on_progress: OnProgress | None = None,
    patience: float = PATIENCE_S,
) -> tuple[list[list[Row]], int]:
    """Rows of each case, and how many cases were kept from before; the heaviest are begun first.

    Parameters
    ----------
    processes : how many work at a time; 0 works in this process, without guard against a hang
    patience : time after which a case of another process is given up [s]
    """
    program = program_key(registry)
    order = sorted(range(len(cases)), key=lambda place: -cases[place].weight)
    items = [Item(_key(cases[place], program), cases[place].name, cases[place]) for place in order]
    executor = local(registry, processes, **({"patience": patience} if processes else {}))
    done, reused = work_through(
        _plain, items, store or RowStore(None), executor, registry, plugins, on_progress,
        lambda item, reason: {"rows": [attrs.asdict(lost(item.given, reason))]},
    )  # fmt: skip
    rows = dict(zip(order, done, strict=True))
    return [[Row(**row) for row in rows[place]["rows"]] for place in range(len(cases))], reused


def _key(case: Case, program: str) -> str:
    text = json.dumps([attrs.asdict(case), program], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _plain(case: Case, registry: Registry) -> Tables:
    return {"rows": [attrs.asdict(row) for row in rows_of(case, registry)]}


def rows_of(case: Case, registry: Registry) -> list[Row]:
    """The rows of a case; whatever its code raises becomes a failed row."""
    module, _, function = case.measure.partition(":")
    try:
        place = module if "." in module else f"raceway.studies.stability.{module}"
        rows: list[Row] = getattr(import_module(place), function)(case, registry)
    except Exception as why:  # a traceback is what no case may end in: it is the finding
        last = traceback.extract_tb(why.__traceback__)[-1]
        return [lost(case, f"{type(why).__name__} in {Path(last.filename).name}, line {last.lineno}: {short(why)}")]
    return rows
