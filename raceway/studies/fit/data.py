"""What measured data hold, by their heads: a table of quantities, or a record over time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from raceway.errors import SceneError
from raceway.storage.number_table import NumberTable, read_heads, read_numbers
from raceway.studies.measured.heads import quantity_of
from raceway.studies.measured.signals import reading


def over_time(data: Any, columns: Mapping[str, str] | None) -> bool:
    """Whether the data have a column of time.

    Raises
    ------
    SceneError
        A file that cannot be read.
    """
    if hasattr(data, "data_vars"):
        return True
    heads = _heads(Path(data)) if isinstance(data, str | Path) else read_table(data)[0].header
    return any(quantity_of((columns or {}).get(head, head)) == "time" for head in heads)


def read_table(data: Any) -> tuple[NumberTable, str]:
    """Numbers below their heads, and their source: a CSV file's path, or "data".

    Raises
    ------
    SceneError
        What is wrong with them, with the line.
    """
    if isinstance(data, str | Path):
        path = Path(data)
        with reading(path):
            return read_numbers(path, lambda heads: None), str(data)
    if hasattr(data, "columns") and hasattr(data, "to_numpy"):
        data = {str(name): data[name].to_numpy() for name in data.columns}
    if not isinstance(data, Mapping):
        raise SceneError.at(
            "data", type(data).__name__, "must be a CSV file's path, a mapping of arrays or a pandas.DataFrame"
        )
    return _table_of_arrays({str(head): values for head, values in data.items()}), "data"


def _heads(path: Path) -> list[str]:
    with reading(path):
        return read_heads(path)


def _table_of_arrays(given: Mapping[str, Any]) -> NumberTable:
    if not given:
        raise SceneError.at("data", None, "is empty: heads and numbers are needed")
    found = {}
    for head, values in given.items():
        try:
            found[head] = np.atleast_1d(np.asarray(values, dtype=float))
        except (OverflowError, TypeError, ValueError):
            raise SceneError.at("data", None, f"column '{head}' holds something that is no number") from None
        if found[head].ndim != 1 or not np.isfinite(found[head]).all():
            raise SceneError.at("data", None, f"column '{head}' must hold one finite number a measurement")
    if len({len(values) for values in found.values()}) > 1:
        sizes = ", ".join(f"{head} {len(values)}" for head, values in found.items())
        raise SceneError.at("data", None, f"the columns differ in length: {sizes}")
    values = np.column_stack(list(found.values()))
    return NumberTable(list(found), values, np.arange(len(values)), "measurement")
