"""Headings of measured files: column headers below an instrument's preamble, their units, the sample interval.

A file begins with its column headers, or as one of ``_FORMATS``; a line of units may follow the headers in each.

References
----------
Tektronix, LabVIEW, Keysight, Rigol, PicoScope: the sources are in tests/validation/instrument_files.py.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

if TYPE_CHECKING:
    import numpy as np

#: Lines within which an instrument's column headers begin, and characters of one that are looked at.
_LINES, _LONGEST = 200, 2**16
#: Units in a line of their own, and how they are written here.
_UNITS = {"second": "s", "seconds": "s", "volt": "V", "volts": "V", "ampere": "A", "sequence": "s"}
_UNITS |= {
    unit.lower(): unit
    for unit in ("s", "ms", "us", "µs", "ns", "ps", "V", "mV", "uV", "µV", "kV", "A", "mA", "N", "m", "mm", "um", "µm", "g")
}
_TIMES = {"time", "zeit", "x-axis", "x_value", "x"}


@attrs.frozen
class _Format:
    """A maker's files.

    first, header : patterns of the first line and of the line of column headers
    units : tag of the preamble's line of units; "": they stand below the headers
    start, interval : tags of the first time and of the interval [s]
    fault : why such a file is refused
    """

    maker: str
    first: str
    header: str = ""
    units: str = ""
    start: str = ""
    interval: str = ""
    fault: str = ""


_FORMATS = (
    _Format("Tektronix", r"#?(Model|Firmware Version|Waveform Type),", r"#?TIME,", "Vertical Units"),
    _Format(
        "Tektronix", r"Record Length,[^,]*,.*,",
        fault="a file of one channel and its settings, as written by TDS oscilloscopes: force and displacement are needed. "
        "Join the channels in one file with a line of column headers, time_s,CH1,CH2",
    ),
    _Format("LabVIEW", r"LabVIEW Measurement", r"X_Value", "Y_Unit_Label", "X0", "Delta_X"),
    _Format("Keysight", r"x-axis,", r"x-axis,"),
    _Format("Rigol", r"X,.*Start,Increment", r"X,", start="Start", interval="Increment"),
)  # fmt: skip


@attrs.frozen
class Heading:
    """Column headers of a file, with their units in brackets where a line beside them states these.

    line, last : numbers of the header line and of the last line above the numbers
    sign : between the columns;  maker : of the instrument, or ""
    start, interval : of the time [s], whose column counts samples or, with ``absent``, is none; None: the column has times
    """

    header: list[str]
    line: int
    last: int
    sign: str
    maker: str = ""
    start: float = 0.0
    interval: float | None = None
    absent: bool = False

    @property
    def width(self) -> int:
        """Columns of numbers in a row of the file."""
        return len(self.header) - self.absent

    def with_times(self, values: np.ndarray) -> np.ndarray:
        """Rows (n, k) with times [s] of the clock in the first column: of counted samples, or of times that were rounded."""
        import numpy as np

        if self.interval is not None:
            counts = np.arange(len(values)) if self.absent else values[:, 0]
            times = self.start + self.interval * counts
            return np.column_stack([times, values if self.absent else values[:, 1:]])
        if self.maker and self.header[0].lower().startswith("time") and len(values) > 2:
            even, steps = np.linspace(values[0, 0], values[-1, 0], len(values)), np.diff(values[:, 0])
            if np.abs(values[:, 0] - even).max() <= np.ptp(steps) < np.median(steps):
                values[:, 0] = even
        return values


def heading_of(path: Path, encoding: str) -> Heading:
    """The heading of a text file.

    Raises
    ------
    ValueError
        An empty file, or an instrument's without what its format promises: line, rule and remedy.
    """
    with open(path, encoding=encoding) as stream:
        lines = [text[:_LONGEST] for text in islice(stream, _LINES)]
    filled = [k for k, text in enumerate(lines) if text.strip()]
    if not filled:
        raise ValueError("is empty: a header line and samples are needed")
    first = filled[0]
    form = next((form for form in _FORMATS if re.match(form.first, lines[first], re.IGNORECASE)), _Format("", "", ""))
    if form.fault:
        raise ValueError(f"line {first + 1}: {form.fault}")
    at = next((k for k in filled if re.match(form.header, lines[k])), None)
    if at is None:
        raise ValueError(
            f"line {first + 1} begins a file of {form.maker}, whose column headers begin with {form.header.lstrip('#?')!r}: no line of the "
            f"first {_LINES} does. Export the waveforms of all channels again, or put the line time_s,CH1,CH2 above the numbers"
        )
    sign = _sign(lines[at])
    names = _words(lines[at], sign)
    tags = {words[0].lstrip("#"): words[1:] for k in filled if k < at and (words := _words(lines[k], _sign(lines[k])))}
    below = next((k for k in filled if k > at), at)
    units = _words(lines[below], sign)
    if form.interval in names:  # beside the columns, its number in the line of units
        end = names.index(form.start)
        tags |= {form.start: units[end:], form.interval: units[end + 1 :]}
        names, units = names[:end], units[:end]
    last = at
    if form.units:
        units = ["s", *tags.get(form.units, [])]
    elif below > at and any(units) and all(not unit or unit.strip("()[]").lower() in _UNITS for unit in units):
        last = below
    else:
        units = []
    if not (form.maker or units):
        return Heading(names, at + 1, at + 1, sign)
    return _with_units(form, Heading(names, at + 1, last + 1, sign, form.maker or "other"), units, tags)


def _with_units(form: _Format, heading: Heading, units: Sequence[str], tags: dict[str, list[str]]) -> Heading:
    """The heading of an instrument's file: units beside its names, times by its clock."""
    names = [name.lstrip("#") for name in heading.header]
    while names and names[-1] in ("", "Comment"):
        names.pop()
    names = [match[1] if (match := re.fullmatch(r"X\((\w+)\)", name)) else name for name in names]
    if names.count("X_Value") > 1 or tags.get("X_Columns", [""])[0] == "Multi":
        raise ValueError(
            f"line {heading.line}: each channel has its own times: save one column of times (X value columns: one only)"
        )
    if (kind := tags.get("X_Dimension", ["Time"])[0]) != "Time":
        raise ValueError(f"X_Dimension is {kind}: a record over time is needed. Save the signals instead")
    counted = bool(form.interval) and (units[:1] == ["Sequence"] or tags.get("X_Columns", [""])[0] == "No")
    header = []
    for k, name in enumerate(names):
        unit = units[k].strip("()[]") if k < len(units) else ""
        unit = "s" if counted and k == 0 else _UNITS.get(unit.lower(), unit)
        name = "time" if k == 0 and name.lower() in _TIMES else name
        header.append(f"{name} ({unit})" if unit else name)
    heading = attrs.evolve(heading, header=header)
    if not counted:
        return heading
    try:
        start, interval = (float(tags[tag][0].replace(",", ".")) for tag in (form.start, form.interval))
    except (KeyError, IndexError, ValueError):
        start, interval = 0.0, 0.0
    if not interval > 0.0:
        raise ValueError(
            f"line {heading.line}: no sample interval ({form.interval}) in the file's heading: save the times, too"
        )
    return attrs.evolve(heading, start=start, interval=interval, absent=form.maker == "LabVIEW")


def _words(text: str, sign: str) -> list[str]:
    return [word.strip() for word in next(csv.reader([text.rstrip("\r\n")], delimiter=sign), [])]


def _sign(header: str) -> str:
    """Tab, semicolon or comma, the first of them that stands outside quotes."""
    bare = "".join(header.split('"')[::2])
    return next((sign for sign in "\t;" if sign in bare.strip()), ",")
