"""A record of a rig's sensors, as a CSV file.

The first line names the columns: a quantity and its unit, ``time_s``, ``y_um``, ``z_um``, and ``key`` (the voltage of a once-
per-turn probe, in any unit) or ``speed_rpm``, or both.
"""

from __future__ import annotations

import math
from pathlib import Path

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.storage.files import write_whole
from raceway.storage.number_table import NumberTable, read_numbers

_UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "y": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "z": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
    "speed": {"rpm": math.pi / 30.0, "hz": 2.0 * math.pi, "rad_s": 1.0},
}
#: Columns by name: quantity and factor to SI.
COLUMNS = {f"{name}_{unit}": (name, factor) for name, units in _UNITS.items() for unit, factor in units.items()}
COLUMNS["key"] = ("key", 1.0)
_LEAST = 32
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
    """A record from its file.

    Raises
    ------
    SceneError
        What is wrong with the file, with the line.
    """
    table = _table(path)
    names = _names(table.header)
    if len(table.values) < _LEAST:
        raise _wrong(path, f"{len(table.values)} samples; at least {_LEAST} are needed")
    columns = {name: table.values[:, place] * factor for place, (name, factor) in enumerate(names)}
    try:
        table.refuse_uneven(columns["time"])
    except ValueError as why:
        raise _wrong(path, str(why)) from None
    for name in ("y", "z"):
        _refuse_clipped(path, name, columns[name])
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


def _wrong(path: Path, message: str) -> SceneError:
    return SceneError.at(str(path), None, message)


def _table(path: Path) -> NumberTable:
    """The file's table; ``SceneError`` says what is wrong with it."""
    try:
        return read_numbers(path, _names)
    except FileNotFoundError:
        near = sorted(p.name for p in path.parent.glob("*.csv")) if path.parent.is_dir() else []
        raise _wrong(path, f"no such file{nearest(path.name, near)}") from None
    except OSError as why:
        raise _wrong(path, f"cannot be read: {why.strerror or why}") from None
    except ValueError as why:
        raise _wrong(path, str(why)) from None


def _names(header: list[str]) -> list[tuple[str, float]]:
    """Quantity and factor of each column; ``ValueError`` for columns that are unknown or missing."""
    header = [word.lower() for word in header]
    example = "for instance time_s,y_um,z_um,key"
    if all(_is_number(word) for word in header):
        raise ValueError(f"line 1 must name the columns, {example}")
    for word in header:
        if word not in COLUMNS:
            hint = nearest(word, COLUMNS) if len(word) < 30 else ""
            raise ValueError(f"line 1: unknown column {word[:40]!r}{hint}; known: {', '.join(COLUMNS)} ({example})")
    names = [COLUMNS[word] for word in header]
    given = [name for name, _ in names]
    if twice := sorted({name for name in given if given.count(name) > 1}):
        raise ValueError(f"line 1: {', '.join(twice)} stands there twice")
    if missing := [name for name in ("time", "y", "z") if name not in given]:
        raise ValueError(f"line 1: no column for {', '.join(missing)}; needed: time, y and z, {example}")
    if not {"key", "speed"} & set(given):
        raise ValueError("line 1: no speed: a column `key` (once-per-turn probe) or `speed_rpm` is needed")
    return names


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _refuse_clipped(path: Path, name: str, signal: np.ndarray) -> None:
    """A signal that stays at the end of its range was cut off there: its 1x line is that of another motion.

    Notes
    -----
    A sine of amplitude A in steps of q stays arccos(1 - q / A) / pi of its time within the last step at each end.
    """
    values = np.unique(signal)
    if len(values) < 3:
        return
    amplitude, step = 0.5 * (values[-1] - values[0]), float(np.diff(values).min())
    usual = math.acos(max(1.0 - step / amplitude, -1.0)) / math.pi
    for word, end in (("top", values[-1]), ("bottom", values[0])):
        there = float((signal == end).mean())
        if there > 2.0 * usual + _AT_THE_END:
            text = f"{100.0 * there:.2g} % of all samples of {name} lie at the {word} of its range, {1e6 * end:.6g} um: the signal is cut off"
            raise _wrong(path, f"{text} there. Take a larger range of the sensor or of its amplifier, and record again")
