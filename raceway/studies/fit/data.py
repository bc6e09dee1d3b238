"""What measured data hold, by their heads: a table of quantities, or a record over time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.storage.number_table import NumberTable, read_numbers
from raceway.studies.measured.heads import quantity_of


def over_time(data: Any, columns: Mapping[str, str] | None) -> bool:
    """Whether the data have a column of time.

    Raises
    ------
    SceneError
        A file that cannot be read.
    """
    if hasattr(data, "data_vars"):
        return True
    heads = read(data, heads_only=True)[0].header
    return any(quantity_of((columns or {}).get(head, head)) == "time" for head in heads)


def read(data: Any, heads_only: bool = False) -> tuple[NumberTable, str]:
    """Numbers below their heads, and their source: a CSV file's path, or "data".

    Raises
    ------
    SceneError
        What is wrong with them, with the line.
    """
    if isinstance(data, str | Path):
        return _from_file(Path(data), heads_only), str(data)
    if hasattr(data, "columns") and hasattr(data, "to_numpy"):
        data = {str(name): data[name].to_numpy() for name in data.columns}
    if not isinstance(data, Mapping):
        raise SceneError.at(
            "data", type(data).__name__, "must be a CSV file's path, a mapping of arrays or a pandas.DataFrame"
        )
    return _from_arrays({str(head): values for head, values in data.items()}), "data"


class _Read(Exception):  # noqa: N818
    """The heads of a file are known."""


def _from_file(path: Path, heads_only: bool) -> NumberTable:
    seen: list[str] = []

    def judge(heads: list[str]) -> None:
        seen.extend(heads)
        if heads_only:
            raise _Read

    try:
        return read_numbers(path, judge)
    except _Read:
        return NumberTable(seen, np.empty((0, len(seen))), np.empty(0, dtype=int))
    except FileNotFoundError:
        near = sorted(p.name for p in path.parent.glob("*.csv")) if path.parent.is_dir() else []
        raise SceneError.at(str(path), None, f"no such file{nearest(path.name, near)}") from None
    except OSError as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why.strerror or why}") from None
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None


def _from_arrays(given: Mapping[str, Any]) -> NumberTable:
    if not given:
        raise SceneError.at("data", None, "is empty: heads and numbers are needed")
    found = {}
    for head, values in given.items():
        try:
            found[head] = np.atleast_1d(np.asarray(values, dtype=float))
        except (TypeError, ValueError):
            raise SceneError.at("data", None, f"column '{head}' holds something that is no number") from None
        if found[head].ndim != 1 or not np.isfinite(found[head]).all():
            raise SceneError.at("data", None, f"column '{head}' must hold one finite number a measurement")
    if len({len(values) for values in found.values()}) > 1:
        sizes = ", ".join(f"{head} {len(values)}" for head, values in found.items())
        raise SceneError.at("data", None, f"the columns differ in length: {sizes}")
    values = np.column_stack(list(found.values()))
    return NumberTable(list(found), values, np.arange(len(values)), "measurement")
