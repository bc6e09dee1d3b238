"""Columns of a measured record, in SI: from a CSV file, a mapping of arrays, a data frame or a labelled data set."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.storage.files import write_whole
from raceway.storage.number_table import NumberTable, read_heads, read_numbers
from raceway.studies.fit.column_headers import IGNORE, columns_of, quantity_of

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


#: Samples that may lie at one end of the range beyond those of a sine of the same resolution, of all.
_AT_THE_END = 0.02


@attrs.frozen(eq=False)
class Recording:
    """Samples (n,): time [s], gaps along y and z [m], voltage of the mark's probe, speed [rad/s]; the last two may be None."""

    time: np.ndarray
    y: np.ndarray
    z: np.ndarray
    key: np.ndarray | None = None
    speed: np.ndarray | None = None

    @property
    def plane(self) -> np.ndarray:
        """y + j z (n,)."""
        return self.y + 1j * self.z

    def part(self, chosen: np.ndarray) -> Recording:
        """Some of the samples."""
        key, speed = (None if v is None else v[chosen] for v in (self.key, self.speed))
        return Recording(self.time[chosen], self.y[chosen], self.z[chosen], key, speed)


def read_recording(path: Path) -> Recording:
    """A record from its CSV file.

    Raises
    ------
    SceneError
        What is wrong with the file, with the line.
    """
    return recording_of(read_signals(path))


def recording_of(signals: Signals) -> Recording:
    """The record that a bearing in a rig is identified from.

    Raises
    ------
    SceneError
        Signals that were read well and that K and C cannot be identified from: what they are, why, and what to do.
    """
    columns, source = signals.columns, signals.source
    force = [name for name in columns if name.startswith("force")]
    if force:
        raise SceneError.at(
            source, None,
            f"was read ({signals.told()}), but what excites the rig of the scene is its unbalance. A linear model's K, C and mass from force and "
            "displacement: raceway fit FILE.csv --free K,C. For the rig give a record of both displacements and the mark under the unbalance "
            f'(a force that is recorded beside them is left out with --map "HEAD={IGNORE}")',
        )  # fmt: skip
    if missing := [name for name in ("y", "z") if name not in columns]:
        raise SceneError.at(
            source, None,
            f"no column for {', '.join(missing)}. It was read ({signals.told()}), but K and C of a bearing in a rig are identified from "
            "its orbit: record y and z together, or name the column that holds the other axis with --map",
        )  # fmt: skip
    if not {"key", "speed"} & set(columns):
        raise SceneError.at(
            source, None,
            f"{signals.where}no speed: a column `key` (once-per-turn probe) or `speed_rpm` is needed; it was read ({signals.told()})",
        )  # fmt: skip
    for name in ("y", "z"):
        _refuse_clipped(source, name, columns[name])
    return Recording(columns["time"], columns["y"], columns["z"], columns.get("key"), columns.get("speed"))


def write_recording(recording: Recording, path: Path) -> Path:
    """Write a record as CSV: seconds, micrometres, the probe's voltage, r/min.

    Raises
    ------
    RacewayError
        A folder that cannot be written.
    """
    known = {
        "time_s": (recording.time, "%.9g"),
        "y_um": (recording.y * 1e6, "%.7g"),
        "z_um": (recording.z * 1e6, "%.7g"),
        "key": (recording.key, "%.6g"),
        "speed_rpm": (None if recording.speed is None else recording.speed * 30.0 / math.pi, "%.9g"),
    }
    there = {name: (values, form) for name, (values, form) in known.items() if values is not None}
    lines = [",".join(there)]
    form = ",".join(form for _, form in there.values())
    lines += [form % row for row in zip(*(values for values, _ in there.values()), strict=True)]
    return write_whole(("\n".join(lines) + "\n").encode(), path)


def _refuse_clipped(source: str, name: str, signal: np.ndarray) -> None:
    """A signal that stays at the end of its range was cut off there: its 1x line is that of another motion.

    Notes
    -----
    A sine of amplitude A in steps of q stays arccos(1 - q / A) / pi of its time within the last step at each end.  A signal
    without noise that keeps step with its samples has few values, each as often as another.
    """
    values, counts = np.unique(signal, return_counts=True)
    if len(values) < 3:
        return
    amplitude, step = 0.5 * (values[-1] - values[0]), float(np.diff(values).min())
    usual = math.acos(max(1.0 - step / amplitude, -1.0)) / math.pi
    usual = max(usual, float(np.median(counts)) / len(signal))
    for word, end in (("top", values[-1]), ("bottom", values[0])):
        there = float((signal == end).mean())
        if there > 2.0 * usual + _AT_THE_END:
            text = f"{100.0 * there:.2g} % of all samples of {name} lie at the {word} of its range, {1e6 * end:.6g} µm: the signal is cut off"
            raise SceneError.at(
                source, None, f"{text} there. Take a larger range of the sensor or of its amplifier, and record again"
            )


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
