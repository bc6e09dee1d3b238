"""Tables of numbers from text files: a heading and finite numbers below it, read in parts of some megabytes.

Commas, semicolons, tabs or blanks stand between the columns; where it is no comma, a comma in a number is its decimal sign.
"""

from __future__ import annotations

import csv
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import attrs

from raceway.storage.files import size_of
from raceway.storage.headings import Heading, heading_of, is_numeral

if TYPE_CHECKING:
    import numpy as np

#: Bytes of the largest file.  A number of ten digits takes 8 bytes in memory, and readers make two to three copies.
LARGEST = 2**29
#: Characters that are parsed at once, and of a wrong line that are shown.
_PART, _SHOWN = 2**22, 60
#: Longest interval that is bridged, over the usual one.
_GAP = 5.0
#: Size from which a number is a sign that there is none: 9.9e37 and more in files of instruments (SCPI 1999, volume 1, 7.2.1.4).
NONE = 9.9e37
_NO_TABLE = "cannot be read: it is not a text file of comma-separated values"


@attrs.frozen(eq=False)
class NumberTable:
    """``header``: the columns' names; ``values`` (n, k); ``lines`` (n,): the number of each row's line in the file.

    ``word``: what the number of a row counts, for messages;  ``notes``: what was left out or assumed.
    """

    header: list[str]
    values: np.ndarray
    lines: np.ndarray
    word: str = "line"
    notes: tuple[str, ...] = ()

    def refuse_uneven(self, time: np.ndarray) -> None:
        """``ValueError`` where the times (n,) [s] of the rows do not grow, or leave a gap."""
        import numpy as np

        steps = np.diff(time)
        usual = float(np.median(steps))
        for row in np.flatnonzero((steps <= 0.0) | (steps > _GAP * usual))[:1]:
            line, before, after = self.lines[row + 1], time[row], time[row + 1]
            if after <= before:
                raise ValueError(f"{self.word} {line}: time must grow, {after:g} s follows {before:g} s")
            gap = f"a gap of {after - before:.3g} s where samples are usually {usual:.3g} s apart"
            raise ValueError(f"{self.word} {line}: {gap}: cut the record there")


def read_numbers(path: Path, judge: Callable[[list[str]], object]) -> NumberTable:
    """The table of a file; empty lines are left out.

    judge : of the header, before the rows are read; it raises ``ValueError``

    ValueError: What is wrong with the file, with the line; the sentence follows the file's name.
    OSError: A file that cannot be opened.
    """
    import numpy as np

    size_of(path, LARGEST)
    encoding = _encoding(path)
    try:
        heading = heading_of(path, encoding)
        judge(heading.header)
        with open(path, encoding=encoding) as stream:
            for _ in range(heading.last):
                stream.readline()
            with open(
                path, "rb"
            ) as ends:  # at least as many as Python's text files have: each line ends in one or two of these signs
                most = 1 + sum(part.count(b"\n") + part.count(b"\r") for part in iter(lambda: ends.read(_PART), b""))
            width = len(heading.header) - heading.absent
            values, lines = np.empty((most, width)), np.empty(most, dtype=np.int64)
            count, marks = 0, ""
            for rows, numbers in _parts(stream, heading.last):
                rows = heading.picked(rows)
                if heading.sign != ",":
                    # Decimal commas become points; beside the file's own sign the other one says nothing.
                    for text, number in zip(rows, numbers, strict=True):
                        marks += "".join(mark for mark in ",." if mark in text and mark not in marks)
                        if len(marks) > 1:
                            begin = text.strip()[:_SHOWN]
                            why = f"line {number}: commas and points in the file's numbers ({begin}): write one decimal sign only"
                            raise ValueError(why)
                    rows, marks = [text.replace(",", ".") for text in rows] if marks == "," else rows, marks
                end = count + len(rows)
                sign = heading.sign if heading.fields is None else "\t"
                values[count:end], lines[count:end] = _values(rows, numbers, width, sign), numbers
                count = end
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(_NO_TABLE) from None
    return NumberTable(heading.header, heading.with_times(values[:count]), lines[:count], "line", heading.notes)


def read_heading(path: Path) -> Heading:
    """The heading of a file, as ``read_numbers`` reads it.

    ValueError, OSError: As ``read_numbers``.
    """
    size_of(path, LARGEST)
    try:
        return heading_of(path, _encoding(path))
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(_NO_TABLE) from None


def _encoding(path: Path) -> str:
    """UTF-8, or what a mark says, unless its first part is text in Windows' Western letters alone: a unit's micro sign is written so."""
    with open(path, "rb") as stream:
        first = stream.read(_SHOWN * 2**10)
    if first[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    try:
        getincrementaldecoder("utf-8-sig")().decode(first)  # a letter may be cut in two at the end
    except UnicodeDecodeError:
        text = first.decode("cp1252", errors="replace")
        if "\ufffd" not in text and "".join(text.split()).isprintable():
            return "cp1252"
    return "utf-8-sig"


def _parts(stream: TextIO, line: int) -> Iterator[tuple[list[str], np.ndarray]]:
    """Rows below line ``line`` and the numbers of their lines, part by part."""
    import numpy as np

    while lines := stream.readlines(_PART):
        numbers = np.arange(line + 1, line + 1 + len(lines))
        line += len(lines)
        texts = [text for text in lines if text.strip()]
        if len(texts) < len(lines):
            numbers = numbers[[bool(text.strip()) for text in lines]]
        if texts:
            yield texts, numbers


def _values(rows: list[str], numbers: np.ndarray, width: int, sign: str) -> np.ndarray:
    """(n, width) of lines of text; numpy's reader does not say which line it stumbles over."""
    import numpy as np

    try:
        values = np.loadtxt(rows, delimiter=sign, comments=None, quotechar='"', ndmin=2)
        if values.shape == (len(rows), width) and (np.abs(values) < NONE).all():
            return values
    except ValueError:
        pass
    table = []
    for text, number in zip(rows, numbers, strict=True):
        words, begin = next(csv.reader([text], delimiter=sign)), text.strip()[:_SHOWN]
        if len(words) != width or not all(map(is_numeral, words)):
            raise ValueError(f"line {number}: {width} numbers are needed, found {begin!r}")
        table.append([float(word) for word in words])
        if not all(abs(value) < NONE for value in table[-1]):
            raise ValueError(f"line {number}: a sample is missing ({begin}): cut the record there")
    return np.array(table)
