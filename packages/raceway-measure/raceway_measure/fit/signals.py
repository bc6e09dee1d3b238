"""Measured data, in SI: tables and records in CSV and .tdms files, mappings of arrays, data frames or labelled data sets.

``Signals`` are any record over time, ``Recording`` is that of a rig's two displacement sensors, from which a bearing can be identified.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import attrs
import numpy as np

from raceway import RacewayError, SceneError
from raceway.extend import (
    FINITE, LARGEST, NONE, TEXT, NumberTable, Reader, is_numeral, memory_for, nearest, read_heading, read_numbers, size_of,
    write_whole,
)  # fmt: skip
from raceway_measure.fit.column_headers import IGNORE, ORBIT, columns_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from pandas import DataFrame
    from xarray import Dataset

#: A CSV file's path, columns by their headers, or labelled columns.
Data: TypeAlias = "str | Path | Mapping[str, ArrayLike] | DataFrame | Dataset"
COLUMNS = Reader(
    "a mapping of column headers to names, text both",
    lambda v: {TEXT.read(head): TEXT.read(name) for head, name in v.items()},
)
RUN_OUT = Reader("two finite numbers", lambda v: (lambda a, b: (FINITE.read(a), FINITE.read(b)))(*v))
#: Fewest samples of a record.
_LEAST = 32
#: Share of all samples that may lie at one end of the range beyond those of a sine of the same resolution.
_AT_THE_END = 0.02


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Faults of a CSV file, as a ``SceneError`` of its path."""
    try:
        yield
    except FileNotFoundError:
        near = sorted(p.name for p in path.parent.glob("*.csv")) if path.parent.is_dir() else []
        raise SceneError.at(str(path), None, f"no such file{nearest(path.name, near)}") from None
    except OSError as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why.strerror or why}") from None
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None


@contextmanager
def faults_at(source: str) -> Iterator[None]:
    """Faults of a record, as a ``SceneError`` of its source; numerical failures as they are."""
    try:
        yield
    except RacewayError as why:
        if why.exit_code != 2 or isinstance(why, SceneError):
            raise
        raise SceneError.at(source, None, str(why)) from None


def headers_of(data: Data, name: str) -> list[str]:
    """Column headers of data, without the numbers of a file."""
    data = _in_memory(data)
    if not isinstance(data, str | Path):
        return list(_arrays(data, name))
    with _reading(Path(data)):
        return read_heading(Path(data)).header


def _in_memory(data: Data) -> Data:
    """Channels of a .tdms file, whose measurements are no text; other data as they are."""
    if not isinstance(data, str | Path) or Path(data).suffix.lower() != ".tdms":
        return data
    with _reading(Path(data)):
        return read_tdms(Path(data))


def table_of(
    data: Data, name: str, word: str, judge: Callable[[list[str]], object] = lambda headers: None
) -> tuple[NumberTable, str]:
    """Numbers below their column headers, and their source: a CSV file's path, or ``name``.

    data : path of a CSV file; mapping of headers to arrays (n,); ``pandas.DataFrame``; ``xarray.Dataset``, whose variables may
        have their units as attribute
    word : what a row is, for messages;  judge : of the headers, before the numbers are read; it raises ``ValueError``

    SceneError: The fault of a file or of arrays, with line or row and column.
    """
    name, data = str(data) if isinstance(data, str | Path) else name, _in_memory(data)
    if isinstance(data, str | Path):
        with _reading(Path(data)):
            return read_numbers(Path(data), judge), str(data)
    arrays = _arrays(data, name)
    words = {header: np.asarray(values).ravel() for header, values in arrays.items()}
    texts = [header for header, v in words.items() if len(v) and all(isinstance(w, str) and not is_numeral(w) for w in v)]
    arrays = {header: values for header, values in arrays.items() if header not in texts}
    try:
        judge(list(arrays))
        if not arrays:
            raise ValueError("is empty: column headers and numbers are needed")
        columns = {header: _file_numbers(header, values, word) for header, values in arrays.items()}
        sizes = {header: len(values) for header, values in columns.items()}
        if len(set(sizes.values())) > 1:
            raise ValueError(f"the columns differ in length: {', '.join(f'{h} {n}' for h, n in sizes.items())}")
    except ValueError as why:
        raise SceneError.at(name, None, str(why)) from None
    values = np.column_stack(list(columns.values()))
    notes = tuple(f"the text of '{header}' is left out" for header in texts)
    return NumberTable(list(columns), values, np.arange(len(values)), word, notes), name


def _arrays(data: Any, name: str) -> dict[str, ArrayLike]:
    if hasattr(data, "data_vars"):
        units = {variable: str(data[variable].attrs.get("units", "1")) for variable in data.variables}
        return {f"{key} [{unit}]" if unit not in ("", "1") else str(key): data[key].values for key, unit in units.items()}
    if isinstance(data, Mapping):
        return {str(header): values for header, values in data.items()}
    if hasattr(data, "columns") and hasattr(data, "to_numpy"):
        return {str(header): data[header].to_numpy() for header in data.columns}
    message = "must be a CSV file's path, a mapping of arrays, a pandas.DataFrame or an xarray.Dataset"
    raise SceneError.at(name, type(data).__name__, message)


def _file_numbers(header: str, array: ArrayLike, word: str) -> np.ndarray:
    try:
        values = np.atleast_1d(np.asarray(array, dtype=float))
    except (OverflowError, TypeError, ValueError):
        raise ValueError(f"column '{header}' contains a value that is not a number") from None
    if values.ndim != 1:
        raise ValueError(f"column '{header}' has the shape {values.shape}: one number per {word} is needed, (n,)")
    if not (there := np.abs(values) < NONE).all():
        row = int(np.argmin(there))
        raise ValueError(f"column '{header}': {word} {row} is missing (no finite number): cut the data there")
    return values


@attrs.frozen(eq=False)
class Signals:
    """A record as it was read."""

    source: str  # its file, or "signals"
    #: quantity -> samples (n,): time [s], y, z [m], key (any unit), speed [rad/s], force, force_y, force_z [N], velocity
    #: [m/s], acceleration [m/s2]
    columns: dict[str, np.ndarray]
    where: str = ""  # prefix of messages about its column headers
    notes: tuple[str, ...] = ()  # what was left out or assumed

    def __str__(self) -> str:
        """Samples, duration and columns, in words."""
        time = self.columns["time"]
        signals = []
        for name, half in {k: 0.5 * float(np.ptp(v)) for k, v in self.columns.items() if k != "time"}.items():
            uncertainty = f" (+- {1e6 * half:.4g} µm)" if name in ("y", "z") else ""
            signals.append(name + (f" (+- {half:.4g} N)" if name.startswith("force") else uncertainty))
        return f"{len(time)} samples over {time[-1] - time[0]:.4g} s of {', '.join(signals) or 'nothing but time'}"


def signals_of(
    data: Data, columns: Mapping[str, str] | None = None, required: Mapping[str, str] = ORBIT, where: str = ""
) -> Signals:
    """The record in data of any form that ``table_of`` takes.

    columns : header -> name in ``column_headers.COLUMNS``, for headers that are not understood; "ignore" leaves a column out
    required : quantities that the record must have, and their words;  where : prefix of messages about arrays from a file

    SceneError: The fault, with line and column.
    """
    path, notes = data if isinstance(data, str | Path) else "", ""
    data = _in_memory(data)
    if isinstance(data, str | Path):
        with _reading(Path(data)):
            heading = read_heading(Path(data))
        where, notes = f"line {heading.line}: ", "".join(f"; {note}" for note in heading.notes)

    def columns_in(headers: list[str]) -> dict[str, tuple[int, float]]:
        try:
            return columns_of(headers, columns, where, required)
        except ValueError as why:
            raise ValueError(f"{why}{notes}") from None

    table, source = table_of(data, str(path) or "signals", "sample", columns_in)
    if len(table.values) < _LEAST:
        raise SceneError.at(source, None, f"{len(table.values)} samples; at least {_LEAST} are needed")
    quantities = {name: table.values[:, k] * factor for name, (k, factor) in columns_in(table.header).items()}
    try:
        for name, values in quantities.items():
            for row in table.lines[~(np.abs(values) < NONE)][:1]:
                raise ValueError(f"{table.word} {row}: {name} is no number that a sensor gives")
        table.refuse_uneven(quantities["time"])
    except ValueError as why:
        raise SceneError.at(source, None, str(why)) from None
    return Signals(source, quantities, where, table.notes)


@attrs.frozen(eq=False)
class Recording:
    """Samples (n,): time [s], gaps along y and z [m], voltage of the keyphasor, speed [rad/s]; the last two may be None."""

    time: np.ndarray
    y: np.ndarray
    z: np.ndarray
    key: np.ndarray | None = None
    speed: np.ndarray | None = None

    @property
    def plane(self) -> np.ndarray:
        """y + j z (n,)."""
        return self.y + 1j * self.z

    def part(self, samples: np.ndarray) -> Recording:
        """Some of the samples."""
        key, speed = (None if v is None else v[samples] for v in (self.key, self.speed))
        return Recording(self.time[samples], self.y[samples], self.z[samples], key, speed)


def recording_of(signals: Signals) -> Recording:
    """The record that a bearing in a rig is identified from.

    SceneError: Signals from which K and C cannot be identified: what they are, why, and the remedy.
    """
    columns, fault = signals.columns, ""
    if any(name.startswith("force") for name in columns):
        fault = (
            f"was read ({signals}), but what excites the rig of the scene is its unbalance. A linear model's K, C and mass from force and "
            "displacement: raceway fit FILE.csv --free K,C. For the rig give a record of both displacements and the keyphasor under the unbalance "
            f'(a force that is recorded beside them is left out with --map "HEADER={IGNORE}")'
        )
    elif missing := [name for name in ("y", "z") if name not in columns]:
        fault = (
            f"no column for {', '.join(missing)}. It was read ({signals}), but K and C of a bearing in a rig are identified from "
            "its orbit: record y and z together, or name the column that holds the other axis with --map"
        )
    elif not {"key", "speed"} & set(columns):
        fault = f"{signals.where}no speed: a column `key` (once-per-turn probe) or `speed_rpm` is needed; it was read ({signals})"
    fault = fault or _clipping("y", columns["y"]) or _clipping("z", columns["z"])
    if fault:
        raise SceneError.at(signals.source, None, fault)
    return Recording(columns["time"], columns["y"], columns["z"], columns.get("key"), columns.get("speed"))


def _clipping(name: str, signal: np.ndarray) -> str:
    """Fault of a signal that stays at the end of its range: cut off there, its 1x component is that of another motion.

    A sine of amplitude A in steps of q stays arccos(1 - q / A) / pi of its time within the last step at each end.  A signal
    without noise that keeps step with its samples has few values, each as often as another.
    """
    values, counts = np.unique(signal, return_counts=True)
    if len(values) < 3:
        return ""
    amplitude, step = 0.5 * (values[-1] - values[0]), float(np.diff(values).min())
    usual = math.acos(max(1.0 - step / amplitude, -1.0)) / math.pi
    usual = max(usual, float(np.median(counts)) / len(signal))
    for word, end in (("top", values[-1]), ("bottom", values[0])):
        share = float((signal == end).mean())
        if share > 2.0 * usual + _AT_THE_END:
            fault = f"{100.0 * share:.2g} % of all samples of {name} lie at the {word} of its range, {1e6 * end:.6g} µm"
            return f"{fault}: the signal is clipped. Record again with a larger range of sensor or amplifier"
    return ""


def write_recording(recording: Recording, path: Path) -> Path:
    """Write a record as CSV: seconds, micrometres, the probe's voltage, r/min; RacewayError where it cannot be written."""
    columns = {
        "time_s": (recording.time, "%.9g"),
        "y_um": (recording.y * 1e6, "%.7g"),
        "z_um": (recording.z * 1e6, "%.7g"),
        "key": (recording.key, "%.6g"),
        "speed_rpm": (None if recording.speed is None else recording.speed * 30.0 / math.pi, "%.9g"),
    }
    present = {header: (values, form) for header, (values, form) in columns.items() if values is not None}
    row = ",".join(form for _, form in present.values())
    lines = [",".join(present), *(row % numbers for numbers in zip(*(v for v, _ in present.values()), strict=True))]
    return write_whole(("\n".join(lines) + "\n").encode(), path)


def read_tdms(path: Path) -> dict[str, np.ndarray]:
    """Header with unit -> numbers (n,), or text, times first, of the file's one group of channels.

    The clock is that of NI's waveform properties, wf_increment [s] and wf_start_offset [s]; channels whose clocks or lengths differ
    are refused.  A file without the properties has a channel of times.

    ValueError: The channel's fault and remedy.
    """
    from nptdms import TdmsFile

    try:
        with memory_for(size_of(path, LARGEST)):
            file = TdmsFile.read(path)
    except OSError:
        raise
    except Exception as why:  # nptdms raises whatever its parsers stumble over
        raise ValueError(f"cannot be read: it is no .tdms file, or damaged ({why})") from None
    last = (file.file_status.channel_statuses or {}).items()
    if incomplete := ", ".join(f"{name} {n}" for name, block in last if (n := block.expected_length - block.read_length)):
        raise ValueError(f"is cut off, samples are missing: {incomplete}. Copy it again, or export those that are there")
    channels = [channel for group in file.groups() for channel in group.channels()]
    if not channels:
        raise ValueError("has no channels: save the signals, too")
    columns: dict[str, np.ndarray] = {}
    steps, starts = ([c.properties.get(f"wf_{name}", 0.0) for c in channels] for name in ("increment", "start_offset"))
    clocks = {channel.name: (len(channel), *clock) for channel, *clock in zip(channels, steps, starts, strict=True)}
    if len(clocks) < len(channels):
        raise ValueError("two groups have channels of one name: save one measurement in a file")
    if len(set(clocks.values())) > 1:
        listing = "; ".join(
            f"{name} {count} samples every {step:g} s from {start:g} s" for name, (count, step, start) in clocks.items()
        )
        raise ValueError(f"channels differ in length or clock: {listing}. Save the channels of one task with one rate")
    count, step, start = next(iter(clocks.values()))
    if step > 0.0:
        columns["time (s)"] = start + step * np.arange(count)
    for channel in channels:
        unit = str(channel.properties.get("unit_string", channel.properties.get("NI_UnitDescription", ""))).strip()
        columns[f"{channel.name} ({unit})" if unit else channel.name] = np.asarray(channel[:])
    return columns
