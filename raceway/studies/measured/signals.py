"""Columns of a measured record, in SI: from a CSV file, a mapping of arrays, a data frame or a labelled data set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.storage.number_table import NumberTable, read_numbers
from raceway.studies.measured.heads import columns_of

#: Samples that say anything.
_LEAST = 32


@attrs.frozen(eq=False)
class Signals:
    """A record as it was read.

    Attributes
    ----------
    source : its file, or "signals"
    columns : quantity -> samples (n,): time [s], y, z [m], key (any unit), speed [rad/s], force, force_y, force_z [N]
    where : what messages about its heads begin with
    """

    source: str
    columns: dict[str, np.ndarray]
    where: str = ""

    def told(self) -> str:
        """What it holds, in words."""
        time = self.columns["time"]
        others = [f"{name}{_spread(name, values)}" for name, values in self.columns.items() if name != "time"]
        return f"{len(time)} samples over {time[-1] - time[0]:.4g} s of {', '.join(others) or 'nothing but time'}"


def _spread(name: str, values: np.ndarray) -> str:
    """Half the range of a displacement or force."""
    half = 0.5 * float(np.ptp(values))
    if name in ("y", "z"):
        return f" (+- {1e6 * half:.4g} µm)"
    return f" (+- {half:.4g} N)" if name.startswith("force") else ""


def signals_of(given: Any, columns: Mapping[str, str] | None = None) -> Signals:
    """The record in whatever it is given.

    Parameters
    ----------
    given : path of a CSV file; mapping of heads to arrays (n,); ``pandas.DataFrame``; ``xarray.Dataset``, whose variables may
        have their units as attribute
    columns : head -> name, for heads that say too little; see ``heads.COLUMNS``

    Raises
    ------
    SceneError
        What is wrong with it, with line and column.
    """
    if isinstance(given, str | Path):
        return read_signals(Path(given), columns)
    if hasattr(given, "data_vars"):
        arrays = {_head(name, given[name].attrs.get("units")): given[name].values for name in given.variables}
    elif isinstance(given, Mapping):
        arrays = {str(name): values for name, values in given.items()}
    elif hasattr(given, "columns") and hasattr(given, "to_numpy"):
        arrays = {str(name): given[name].to_numpy() for name in given.columns}
    else:
        raise SceneError.at(
            "signals",
            type(given).__name__,
            "must be a CSV file's path, a mapping of arrays, a pandas.DataFrame or an xarray.Dataset",
        )
    return _from_arrays(arrays, columns)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """What is wrong with a CSV file, as a ``SceneError`` of its path."""
    try:
        yield
    except FileNotFoundError:
        near = sorted(p.name for p in path.parent.glob("*.csv")) if path.parent.is_dir() else []
        raise SceneError.at(str(path), None, f"no such file{nearest(path.name, near)}") from None
    except OSError as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why.strerror or why}") from None
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None


def read_signals(path: Path, columns: Mapping[str, str] | None = None) -> Signals:
    """The record in a CSV file.

    Raises
    ------
    SceneError
        What is wrong with the file, with the line.
    """
    with reading(path):
        table = read_numbers(path, lambda heads: _needed(heads, columns, "line 1: "))
        return _from_table(table, str(path), columns, "line 1: ")


def _from_arrays(arrays: Mapping[str, Any], columns: Mapping[str, str] | None) -> Signals:
    try:
        _needed(list(arrays), columns, "")
        found = {head: _numbers(head, values) for head, values in arrays.items()}
        sizes = {head: len(values) for head, values in found.items()}
        if len(set(sizes.values())) > 1:
            raise ValueError(f"the columns differ in length: {', '.join(f'{head} {size}' for head, size in sizes.items())}")
        values = np.column_stack(list(found.values()))
        return _from_table(NumberTable(list(found), values, np.arange(len(values)), "sample"), "signals", columns, "")
    except ValueError as why:
        raise SceneError.at("signals", None, str(why)) from None


def _numbers(head: str, given: Any) -> np.ndarray:
    try:
        values = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"column '{head}' holds something that is no number") from None
    if values.ndim != 1:
        raise ValueError(f"column '{head}' has the shape {values.shape}: one number a sample is needed, (n,)")
    if not np.isfinite(values).all():
        raise ValueError(f"column '{head}': sample {int(np.argmin(np.isfinite(values)))} is missing: cut the record there")
    return values


def _needed(heads: list[str], columns: Mapping[str, str] | None, where: str) -> dict[str, tuple[int, float]]:
    """``columns_of`` with a time and something beside it."""
    found = columns_of(heads, columns, where)
    if "time" not in found or len(found) < 2:
        needed = "no column for time" if "time" not in found else "time alone is no record"
        raise ValueError(f"{where}{needed}; needed: time, y and z, for instance time_s,y_um,z_um,key")
    return found


def _from_table(table: NumberTable, source: str, columns: Mapping[str, str] | None, where: str) -> Signals:
    places = _needed(table.header, columns, where)
    if len(table.values) < _LEAST:
        raise ValueError(f"{len(table.values)} samples; at least {_LEAST} are needed")
    found = {name: table.values[:, place] * factor for name, (place, factor) in places.items()}
    table.refuse_uneven(found["time"])
    return Signals(source, found, where)


def _head(name: object, unit: object) -> str:
    """Of a labelled variable: its unit stands in its attributes, or in its name."""
    return str(name) if unit is None or str(unit) in ("", "1") else f"{name} [{unit}]"
