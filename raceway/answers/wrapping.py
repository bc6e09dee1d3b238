"""Text that fits a screen: lines end between words, never inside a number or between a number and its unit."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING

import attrs
from rich.measure import Measurement
from rich.text import Text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions

#: A blank that no line ends at, while a text is wrapped.
_FIXED = "\N{NO-BREAK SPACE}"
_UNIT = r"(?:N/µm|N s/m|N m|N|mm|µm|m|µrad|rad|deg|r/min|MPa|GPa|kg|k?Hz|MiB|mJ|s|%)(?![\w/])"
#: A number and its unit, a sign and its number, both sides of an equation, a product.
_TOGETHER = re.compile(
    rf"(?<=\d) (?={_UNIT})|(?<=\+-) (?=\d)|(?<=\w) (?== )|(?<==) (?=\S)|(?<=\d) (?=x \d)|(?<=\d x) (?=\d)"
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

    Attributes
    ----------
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
