"""Headings of measured files: where the table of numbers begins, and what the text above it says of names, units and times.

The table is where several lines have numbers in the same places.  Above it stand its column headers, a line of units, and what an
instrument says of itself.  No maker's format is known here.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from itertools import groupby, islice, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import attrs

if TYPE_CHECKING:
    import numpy as np

#: Lines within which a table begins, and characters of one that are looked at; rows that are several; signs before a comment.
_LINES, _LONGEST, _SEVERAL, _MARKS = 500, 2**16, 3, "#;%!* \t"
#: Words of a line of units; others stand there in brackets.
_UNITS = {
    "s", "sec", "second", "seconds", "ms", "us", "µs", "ns", "ps", "v", "volt", "volts", "mv", "uv", "µv", "kv", "a", "ma", "ampere", "n", "kn",
    "newton", "newtons", "m", "mm", "um", "µm", "nm", "micron", "microns", "g", "m/s", "mm/s", "m/s2", "m/s^2", "m/s²", "hz", "rpm", "°c", "-",
    "sequence",
}  # fmt: skip
#: Names of times without a unit, and any name with one; what stands before the units of channels.
_TIME = re.compile(r"(?i)(?:time|zeit|temps|t|x-axis|x_value)$|.*[\[(\s_](?P<unit>[mnuµ]?s|sec|seconds?)[\])_]*$")
_LABEL = re.compile(r"(?i)(?!h|x).*unit")
#: Rate or interval of samples, in the text above a table.
_CLOCK = re.compile(
    r"(?:(?:sampl\w*?|abtast)[ _]?(?P<rate>rate|frequen\w*)|(?:sampl\w*|abtast)[ _]?(?:interval\w*|period)|delta_x|increment)\W+"
    r"(?P<size>\d+[.,]?\d*(?:e[-+]?\d+)?|[.,]\d+(?:e[-+]?\d+)?)\s?(?P<unit>[mnuµkg])?(?:hz|sa?/s|s)?(?![a-z])"
)
_Rank: TypeAlias = tuple[bool, bool, float, int]
_PARTS = {None: 1.0, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9, "k": 1e3, "g": 1e9}


@attrs.frozen
class Heading:
    """Column headers of a file, with their units in brackets where a line beside them states these."""

    header: list[str]
    #: line, last : numbers of the line of headers, or of the first row without one, and of the last line above the numbers
    line: int
    last: int
    sign: str  # between the columns, " " for blanks
    fields: tuple[int, ...] | None = None  # of a row that hold numbers, None: all
    most: int = 0  # fields of a row
    notes: tuple[str, ...] = ()  # sentences on what was left out or assumed
    interval: float | None = None  # of samples [s] that the first column counts or, with ``absent``, that have no times
    absent: bool = False
    clock: int | None = None  # column of rounded times

    def picked(self, rows: list[str]) -> list[str]:
        """Rows of text without the fields that hold no numbers, tabs between the others; one with more fields than all as it is."""
        if self.fields is None:
            return rows
        split = ([*_line_fields(text, self.sign), *[""] * self.most] for text in rows)
        choice = (("\t".join([words[k] for k in self.fields]), any(words[self.most :])) for words in split)
        return [text if more else part for text, (part, more) in zip(rows, choice, strict=True)]

    def with_times(self, values: np.ndarray) -> np.ndarray:
        """Rows (n, k) with times [s] of the clock in the first column: of counted samples, or of times that were rounded."""
        import numpy as np

        if self.interval is not None:
            counts = np.arange(len(values)) if self.absent else values[:, 0] - values[:1, 0]
            return np.column_stack([self.interval * counts, values if self.absent else values[:, 1:]])
        if self.clock is not None:
            values[:, self.clock] = evened(values[:, self.clock])
        return values


def evened(times: np.ndarray) -> np.ndarray:
    """Times (n,) of a clock that were rounded, even again; others as they are."""
    import numpy as np

    if len(times) < 3:
        return times
    even, steps = np.linspace(times[0], times[-1], len(times)), np.diff(times)
    return even if np.abs(times - even).max() <= np.ptp(steps) < np.median(steps) else times


def heading_of(path: Path, encoding: str) -> Heading:
    """The heading of a text file: that of its table, or its first line where it has none.

    ValueError: An empty file, or one whose samples have no common clock: line, rule and remedy.
    """
    with open(path, encoding=encoding) as stream:
        lines = [text[:_LONGEST] for text in islice(stream, _LINES)]
    full = [k for k, text in enumerate(lines) if text.strip()]
    if not full:
        raise ValueError("is empty: a header line and samples are needed")
    tables = [max(_runs(lines, full, sign)) for sign in "\t;, "]
    rank, first, fields = max(
        tables, key=lambda table: table[0][:3]
    )  # the first of equal ones: blanks stand beside commas, too
    sign = "\t;, "[tables.index((rank, first, fields))]
    if not fields:
        sign = next((sign for sign in "\t;" if sign in lines[full[0]].strip()), ",")
        return Heading(_line_fields(lines[full[0]], sign), full[0] + 1, full[0] + 1, sign)
    begin = full.index(first)
    rows = [_line_fields(lines[k], sign) for k in full[begin : begin + rank[3]]]
    for k in reversed(full[:begin]):  # rows without a sample, or with a number amid their text
        numbers = _numeric_fields(words := _line_fields(lines[k], sign), sign)
        if fields[0] not in numbers and len(numbers) < max(sum(map(bool, words)), 1):
            break
        first = k
    above, most = [k for k in full if k < first], max(map(len, rows))
    names, units, line = _names(lines, above, sign, fields, most)
    texts = [k for k in range(most) if k not in fields and any(words[k : k + 1] > [""] for words in rows)]
    notes = tuple(f"the text of '{_name(names, units, k)}' is left out" for k in texts)
    if line is not None and any(bare := names[most:]):
        notes = (*notes, f"no numbers stand under '{', '.join(filter(None, bare))}' of line {line + 1}")
    choice = None if sign != " " and fields == tuple(range(most)) else fields
    header = [_name(names, units, k) for k in fields]
    heading = Heading(header, (first if line is None else line) + 1, first, sign, choice, most, notes)
    beside = [f"{name};{unit}" for name, unit in list(zip(names, units, strict=False))[fields[-1] + 1 :]]
    text = "\n".join([lines[k] for k in above if k != line] + beside)
    first_column = [float(words[fields[0]].replace(",", ".")) for words in rows]
    return _with_clock(heading, text.replace(",", ";") if sign == "," else text, first_column)


def _runs(lines: Sequence[str], full: Sequence[int], sign: str) -> list[tuple[_Rank, int, tuple[int, ...]]]:
    """Consecutive lines with numbers in the same fields: what makes a table of them, the first line, the fields.

    Columns, several rows, words that are numbers, many rows.
    """
    runs = []
    for fields, group in groupby(full, key=lambda k: _numeric_fields(_line_fields(lines[k], sign), sign)):
        among = list(group)
        share = len(fields) / max(sum(map(bool, _line_fields(lines[among[0]], sign))), 1)
        runs.append(((len(fields) > 1, len(among) >= _SEVERAL, share, len(among)), among[0], fields))
    return runs


def _names(
    lines: Sequence[str], above: Sequence[int], sign: str, fields: tuple[int, ...], most: int
) -> tuple[list[str], list[str], int | None]:
    """Names and units by field of a row, from the lines above it, and the index of the line of names."""
    units: list[str] = []
    for k in above:  # a line that names its units as such, those of the channels, perhaps with that of time
        words = _line_fields(lines[k].strip(_MARKS), sign)
        if _LABEL.match(words[0]) and any(map(_is_unit, words[1:])):
            units = words[1:] if len(words) > fields[-1] + 1 and words[-1] else ["", *words[1:]]
    for k in reversed(above):
        words = _line_fields(lines[k].strip(_MARKS), sign)
        if len(words) == most + 1 and _TIME.match(words[1]):  # what the line names stands before it
            del words[0]
        here = [words[field] if field < len(words) else "" for field in fields]
        if _LABEL.match(words[0]):
            continue
        if 2 * sum(map(_is_unit, here)) > max(sum(map(bool, here)), 1):
            units = words if k == above[-1] else units
            continue
        numbers = [word for word in here if is_numeral(word) or not re.search(r"[^\W\d_]", word)]
        with_counts = units and lines[k].strip()[0] not in _MARKS and all(word.isdigit() for word in numbers)
        if (not numbers or with_counts) and here[0] not in numbers:
            return words, units, k
    return ["" if _is_unit(word) else word for word in units], units, None


def _is_unit(word: str) -> bool:
    return word.lower() in _UNITS or bool(re.fullmatch(r"\(.*\)|\[.*\]", word))


def _name(names: Sequence[str], units: Sequence[str], field: int) -> str:
    """A column's header; by its number where no name stands above it, or that of another."""
    name, unit = (words[field] if field < len(words) else "" for words in (names, units))
    if not name or names.index(name) < field and not _TIME.match(name):
        name = f"{name or 'column'} {field + 1}"
    return f"{name} ({unit.strip('()[]')})" if _is_unit(unit) and unit != "-" else name


def _with_clock(heading: Heading, preamble: str, begin: Sequence[float]) -> Heading:
    """The heading with its times: of its first column, or by the interval or rate that the text above the table states."""
    header, notes = heading.header, heading.notes
    times = [k for k, name in enumerate(header) if _TIME.match(name)]
    if len({header[k] for k in times}) < len(times):
        raise ValueError(f"line {heading.line}: each channel has its own times: save one column of times for all channels")
    if (dimension := re.search(r"(?m)^X_Dimension\W+(?!Time)(\w+)", preamble)) is not None:
        raise ValueError(f"X_Dimension is {dimension[1]}: a record over time is needed. Save the signals instead")
    clock = _CLOCK.search(preamble.lower())
    if times and preamble:
        name = header[times[0]]
        if not _TIME.sub(r"\g<unit>", name):
            header = [*header[: times[0]], "time (s)", *header[times[0] + 1 :]]
            notes = (*notes, f"'{name}' is read as seconds: no unit stands beside it")
        return attrs.evolve(heading, header=header, clock=times[0], notes=notes)
    size = float(clock["size"].replace(",", ".")) if clock and not times else 0.0
    if clock is None or not size:
        return heading
    interval = (
        1.0 / size / {"m": 1e6}.get(clock["unit"], _PARTS[clock["unit"]]) if clock["rate"] else size * _PARTS[clock["unit"]]
    )
    apart = [after - before for before, after in pairwise(begin)]
    if apart and all(abs(step - interval) < 0.5 * interval for step in apart):
        note = f"'{header[0]}' grows by the sampling interval: read as time in seconds"
        return attrs.evolve(heading, header=["time (s)", *header[1:]], clock=0, notes=(*notes, note))
    absent = not apart or any(step != 1.0 for step in apart)
    note = f"times are those of the interval of {interval:.6g} s that the file states above its table"
    header = ["time (s)", *header[not absent :]]
    return attrs.evolve(heading, header=header, interval=interval, absent=absent, notes=(*notes, note))


def _numeric_fields(words: Sequence[str], sign: str) -> tuple[int, ...]:
    """Indices of the words that are numbers; a comma is a decimal sign where none stands between columns."""
    return tuple(k for k, word in enumerate(words) if is_numeral(word if sign == "," else word.replace(",", ".")))


def is_numeral(word: str) -> bool:
    """Whether Python reads a number in a word."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def _line_fields(text: str, sign: str) -> list[str]:
    """Fields of a line, at least one; between blanks a unit in brackets belongs to the name before it."""
    if sign == " ":
        text = re.sub(r"(?<=\w) (?=[\[(])", "", " ".join(text.split()))
    words = next(csv.reader([text.strip("\r\n")], delimiter=sign, skipinitialspace=True), [])
    return [word.strip() for word in words] or [""]
