"""Parts that every screen is made of: sections, tables, numbers with units."""

import csv
import io
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import takewhile
from typing import Literal, TypeVar

import attrs
from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, Group, RenderableType
from rich.markup import escape
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Column, Table
from rich.text import Text

from raceway.framework.shown import number as number
from raceway.framework.shown import number_within as number_within
from raceway.framework.shown import tilt_words as tilt_words

#: A blank that no line ends at, while a text is wrapped.
_FIXED = "\N{NO-BREAK SPACE}"
_UNIT = r"(?:N/µm|N s/m|N m|N|mm|µm|m|µrad|rad|deg|r/min|MPa|GPa|kg|k?Hz|MiB|mJ|s|%)(?![\w/])"
#: A number and its unit, thousands of a number, a sign and its number, both sides of an equation, a product.
_TOGETHER = re.compile(
    rf"(?<=\d) (?={_UNIT}|\d\d\d\b)|(?<=\+-) (?=\d)|(?<=\w) (?== )|(?<==) (?=\S)|(?<=\d) (?=x \d)|(?<=\d x) (?=\d)"
)


def fixed(text: str) -> str:
    """The text with blanks that stay where a line must not end."""
    return re.sub(r"N s/m|N m\b", lambda unit: unit[0].replace(" ", _FIXED), _TOGETHER.sub(_FIXED, text))


def lines_of(text: str, width: int) -> list[str]:
    """The text in lines of at most ``width`` signs; a single word is broken only where it is longer than a line."""
    lines: list[str] = []
    for line in text.splitlines():
        parts = textwrap.wrap(fixed(line), max(width, 1), break_on_hyphens=False) or [""]
        lines += [piece.replace(_FIXED, " ") for piece in parts]
    return lines


@attrs.frozen
class Words:
    """A text on the screen, wrapped to the room that it is given.

    style : colour and weight, in rich's words;  indent : blanks before every line
    """

    text: str
    style: str = ""
    indent: int = 0

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        for line in lines_of(self.text, options.max_width - self.indent):
            yield Text(" " * self.indent + line, style=self.style)

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        words = fixed(self.text).split() or [""]
        longest = max(map(len, re.split(r"[ \n]", fixed(self.text)) or words))
        widest = max(map(len, self.text.splitlines()), default=0)
        return Measurement(min(longest, options.max_width), min(widest, options.max_width))


Row = tuple[str, str, str]

T = TypeVar("T")

#: Widths of the first two columns of a section: the rest of 80 is left to the remark.
_QUANTITY, _VALUE = 22, 16
#: Signs of a line.
WIDTH = 80


def sections(rows: Iterable[Row]) -> RenderableType:
    """Quantity, value, remark; a row without a value is a heading with its remark, or a remark alone where it has no quantity."""
    parts: list[RenderableType] = []
    table = _section_grid()
    for quantity, value, remark in rows:
        if value:
            table.add_row(Words(quantity), escape(value), Words(remark, "dim"))
            continue
        if quantity:
            parts.append(Words(quantity, "bold"))
        if remark:
            parts.append(Words(remark, "dim", indent=2))
        table = _section_grid()
        parts.append(Padding(table, (0, 0, 0, 2)))
    return Group(*parts)


def _section_grid() -> Table:
    return Table.grid(Column(width=_QUANTITY), Column(justify="right", min_width=_VALUE, no_wrap=True), "", padding=(0, 2))


def height(rows: list[Row]) -> int:
    """Lines of the rows on a terminal."""
    lines = [len(lines_of(remark, room)) for (_, _, remark), room in zip(rows, rooms(rows), strict=True)]
    return sum(max(count, 1) if value else count + bool(name) for count, (name, value, _) in zip(lines, rows, strict=True))


def rooms(rows: list[Row]) -> list[int]:
    """Signs that the values of each row's section leave to its remark."""
    wide, left = 0, list[int]()
    for k, (_, value, _) in enumerate(rows):
        if not value:
            wide = max([_VALUE, *(len(row[1]) for row in takewhile(lambda row: row[1], rows[k + 1 :]))])
        left.append(WIDTH - 2 - (_QUANTITY + 4 + wide if value else 0))
    return left


def in_a_line(text: str, width: int) -> str:
    """The start of a text that fits so many signs, up to where a part of a sentence or a word ends, of a number with its unit."""
    if len(text) <= width:
        return text
    start = lines_of(text, width - 2)[0]
    end = max((mark.start() for mark in re.finditer(r"[.:;,] ", f"{start} ")), default=0)
    start = start[:end] if end >= width // 2 else start
    if start.count("(") > start.count(")"):
        start = start[: start.rindex("(")].rstrip()
    return f"{start} …"


def micro(text: str) -> str:
    """A text with the sign of micrometres that screens have, where what it comes from is written in ASCII."""
    return re.sub(r"\bum\b", "µm", text)


def file_lines(files: Sequence[str]) -> list[RenderableType]:
    """The files' names, each unbroken on its line, so that it can be copied."""
    return [Text(f"written: {name}", no_wrap=True, overflow="ignore") for name in files]


def csv_text(rows: Sequence[Mapping[str, object]]) -> str:
    """A table as CSV, with every key of any row as a column."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(dict.fromkeys(key for row in rows for key in row)), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def grouped(bodies: Mapping[str, T]) -> list[tuple[str, T]]:
    """Bodies with what is said of them; balls of which the same is said share a line, ``balls (12)``."""
    rows: list[tuple[str, T]] = []
    balls: list[tuple[T, int]] = []
    for name, value in bodies.items():
        if not name.startswith("ball"):
            rows.append((name, value))
            continue
        at = next((i for i, (value_of_line, _) in enumerate(balls) if value_of_line == value), None)
        if at is None:
            balls.append((value, 1))
        else:
            balls[at] = value, balls[at][1] + 1
    return rows + [(f"balls ({count})", value) for value, count in balls]


_NUMBER = re.compile(r"[+\-−]?\d[\d.]*(e[+-]?\d+)?([ \u202f]%)?[*~]*")
#: Words of a cell or head up to which a column is not made narrower by breaking lines; blanks between columns.
_WHOLE, _BETWEEN = 14, 2
#: Head of the column that tells which rows belong together where one table is too wide.
_PLACE = "#"


def rows_table(rows: Sequence[Mapping[str, object]], title: str = "") -> RenderableType:
    """A table of dictionaries with the same keys; underscores become blanks, numbers are aligned.

    Columns that hold the same in all of several rows are said in one line above, and below what dashes stand for: words that a column
    of numbers would repeat.  What is wider than the screen goes on in a second table, whose rows have the first one's numbers.
    """
    keys = list(dict.fromkeys(key for row in rows for key in row))
    cells = {key: [_cell(row.get(key)) for row in rows] for key in keys}
    same = [key for key in keys if len(rows) > 1 and len(set(cells[key])) == 1]
    states = dict[str, list[str]]()  # sign and words -> heads
    for key in (key for key in keys if key not in same and any(map(_NUMBER.fullmatch, cells[key]))):
        words = Counter(cell for cell in cells[key] if cell and not _NUMBER.fullmatch(cell) and set(cell) != {"-"})
        repeated = [word for word, count in words.most_common() if count > 1]
        signs = {word: "-" * place for place, word in enumerate(repeated, 1 + ("-" in cells[key]))}
        cells[key] = [signs.get(cell, cell) for cell in cells[key]]
        for word, sign in signs.items():
            states.setdefault(f"{sign}: {word}", []).append(" ".join(_head(key).split()))
    columns = tuple(_Column(_head(key), tuple(cells[key])) for key in keys if key not in same)
    constants = ", ".join(f"{' '.join(_head(key).split())} {cells[key][0]}" for key in same if cells[key][0])
    below = "; ".join(f"{words} ({', '.join(heads)})" for words, heads in states.items())
    return _Rows(columns, title, f"same in all rows: {constants}" if constants else "", below)


@attrs.frozen
class _Column:
    """Head and cells, as text."""

    head: str
    cells: tuple[str, ...]

    @property
    def numeric(self) -> bool:
        return all(_NUMBER.fullmatch(cell) or set(cell) <= {"-", "–"} for cell in self.cells)

    @property
    def whole(self) -> bool:
        """Whether no cell is broken into lines: numbers and short texts."""
        return self.numeric or max(map(len, self.cells), default=0) <= _WHOLE

    @property
    def most(self) -> int:
        """Signs on one line."""
        return max(len(line) for text in (self.head, *self.cells) for line in text.splitlines() or [""])

    @property
    def least(self) -> int:
        """Signs that it needs, with its head and long texts in lines of one word each."""
        texts = (self.head, *(() if self.whole else self.cells))
        words = [word for text in texts for word in re.split(r"[ \n]", fixed(text))]
        return max(map(len, (*words, *(self.cells if self.whole else ()))))


@attrs.frozen
class _Rows:
    """Tables that stand below each other where one would be too wide."""

    columns: tuple[_Column, ...]
    title: str
    told: str
    below: str

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[RenderableType]:
        if self.title:
            yield Text(self.title, style="italic")
        if self.told:
            yield Words(self.told, "dim")
        for columns in self._blocks(options.max_width):
            table = Table(header_style="bold", box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
            room, fixed = options.max_width + _BETWEEN, list[_Column]()
            if sum(column.most + _BETWEEN for column in columns) > room:
                # Whole columns, and those that need more than an equal share of the rest, which rich does not know.
                for column in sorted(columns, key=lambda each: (not each.whole, -each.least)):
                    if column.whole or (column.least + _BETWEEN) * (len(columns) - len(fixed)) > room:
                        fixed.append(column)
                        room -= column.least + _BETWEEN
            for column in columns:
                side: Literal["left", "right"] = "right" if column.numeric else "left"
                width = column.least if column in fixed else None
                table.add_column(Words(column.head, "bold"), justify=side, width=width, min_width=column.least)
            for cells in zip(*(column.cells for column in columns), strict=True):
                table.add_row(*map(Words, cells))
            yield table
        if self.below:
            yield Words(self.below, "dim")

    def _blocks(self, width: int) -> list[list[_Column]]:
        """Columns in tables that fit; from the second on, and in the first then, rows are numbered."""
        blocks = _packed(self.columns, width)
        if len(blocks) == 1:
            return blocks
        count = len(self.columns[0].cells)
        numbers = _Column(_PLACE, tuple(str(row + 1) for row in range(count)))
        return [[numbers, *block] for block in _packed(self.columns, width - numbers.least - _BETWEEN)]


def _packed(columns: Sequence[_Column], width: int) -> list[list[_Column]]:
    blocks: list[list[_Column]] = [[]]
    for column in columns:
        if blocks[-1] and sum(member.least + _BETWEEN for member in (*blocks[-1], column)) > width + _BETWEEN:
            blocks.append([])
        blocks[-1].append(column)
    return blocks


def _head(key: str) -> str:
    return key if "." in key else key.replace("_rpm", " r/min").replace("_", " ")


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return number(value) if isinstance(value, float) else "-" if value is None else str(value)
