"""One self-contained HTML page: words, tables and figures in one file that opens without a network and runs no script.

page = Page("Title", "what it is about")
page.section("Results")
page.text("One paragraph; `code` stands between backticks.")
page.table(["speed [r/min]", "k [N/um]"], [[12000, "163.0"]], caption="Tilt locked")
page.figures([(figure, "what is seen, for those who cannot see it", "caption")])
page.write(folder / "page.html")
"""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: How a word of a verdict is coloured.
_TONES = ("good", "bad", "partly", "failed")
_NUMBER = re.compile(r"[-+−]?\d[\d\s.,]*(e[-+]?\d+)?\s?%?|[-–]|")
#: Cells longer than this are sentences, which need some width to be read [letters].
_SENTENCE = 40


@attrs.frozen
class Cell:
    """A table's cell with a colour, which its words must say, too; ``more``: further words without colour."""

    text: str
    tone: str = attrs.field(default="", validator=attrs.validators.in_(("", *_TONES)))
    more: str = ""


class Page:
    """A page, put together from top to bottom.

    title : also of the browser's window; its second line, what was changed of a scene, goes before the subtitle;  subtitle : a line below it;  footer : where the page comes from
    """

    def __init__(self, title: str, subtitle: str = "", footer: str = "") -> None:
        self.title, *more = title.splitlines()
        self.subtitle, self.footer = "\n".join([*more, *subtitle.splitlines()]), footer
        self._blocks: list[str] = []
        self._sections: list[tuple[str, str]] = []

    def section(self, heading: str) -> None:
        """A new part, which the line of links at the top leads to."""
        anchor = f"s{len(self._sections) + 1}"
        self._sections.append((anchor, heading))
        self._blocks.append(f'<h2 id="{anchor}">{_inline(heading)}</h2>')

    def heading(self, text: str) -> None:
        """A smaller heading within a section."""
        self._blocks.append(f"<h3>{_inline(text)}</h3>")

    def text(self, *paragraphs: str, kind: str = "") -> None:
        """Paragraphs; ``kind`` "lead" for the first of a page, "note" for a caution."""
        mark = f' class="{escape(kind)}"' if kind else ""
        self._blocks += [f"<p{mark}>{_inline(words)}</p>" for words in paragraphs]

    def listing(self, items: Iterable[str]) -> None:
        """A list of points."""
        self._blocks.append("<ul>" + "".join(f"<li>{_inline(item)}</li>" for item in items) + "</ul>")

    def table(self, columns: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> None:
        """A table in a box of its own that scrolls where the screen is narrow; the first cell of a row names it.

        rows : cells are text, numbers (six digits are shown) or ``Cell``
        """
        body = [[cell if isinstance(cell, Cell) else Cell(_cell_text(cell)) for cell in row] for row in rows]
        columns = list(columns)
        right = [_numbers([row[k] for row in body]) for k in range(len(columns))]
        head = "".join(f'<th scope="col"{_class(number=right[k])}>{_inline(name)}</th>' for k, name in enumerate(columns))
        lines = []
        for row in body:
            cells = []
            for k, cell in enumerate(row):
                kind = _class(number=right[k], words=len(cell.text + cell.more) > _SENTENCE)
                cells.append(f"<td{kind}>{_in_tone(cell)}</td>" if k else f'<th scope="row"{kind}>{_in_tone(cell)}</th>')
            lines.append(f"<tr>{''.join(cells)}</tr>")
        title = f"<caption>{_inline(caption)}</caption>" if caption else ""
        label = escape(caption or columns[0], quote=True)
        self._blocks.append(
            f'<div class="scroll" tabindex="0" role="region" aria-label="{label}"><table>{title}'
            f"<thead><tr>{head}</tr></thead><tbody>{''.join(lines)}</tbody></table></div>"
        )

    def rows(self, rows: Sequence[Mapping[str, object]], caption: str = "") -> None:
        """A table of dictionaries with the same keys, which head its columns; nothing without a row."""
        if rows:
            self.table(list(rows[0]), [list(row.values()) for row in rows], caption)

    def card(self, heading: str, badge: Cell, parts: Iterable[tuple[str, str]]) -> None:
        """A box about one thing: what it is, a coloured word on it, and named paragraphs."""
        lines = "".join(f"<dt>{_inline(name)}</dt><dd>{_inline(words)}</dd>" for name, words in parts)
        text = f'<section class="card"><h3>{_inline(heading)}</h3><p class="badge">{_in_tone(badge)}</p><dl>{lines}</dl></section>'
        self._blocks.append(text)

    def figures(self, items: Iterable[tuple[Figure | bytes, str, str]], wide: bool = False) -> None:
        """Figures side by side as far as the screen is wide, or one below the other with ``wide``.

        items : (figure of matplotlib or bytes of a PNG or SVG file, what is seen, caption)
        """
        parts = []
        for picture, alternative, caption in items:
            uri = data_uri(picture if isinstance(picture, bytes) else svg(picture))
            words = f"<figcaption>{_inline(caption)}</figcaption>" if caption else ""
            parts.append(f'<figure><img alt="{escape(alternative, quote=True)}" src="{uri}">{words}</figure>')
        self._blocks.append(f'<div class="figures{" wide" if wide else ""}">{"".join(parts)}</div>')

    def markup(self, html: str) -> None:
        """A block that is HTML already, for what no other method makes; nothing is escaped."""
        self._blocks.append(html)

    def html(self) -> str:
        """The page."""
        style = files("raceway").joinpath("data/page.css").read_text(encoding="utf-8")
        links = "".join(f'<li><a href="#{anchor}">{_inline(heading)}</a></li>' for anchor, heading in self._sections)
        head = f"<h1>{_inline(self.title)}</h1>"
        below = "<br>".join(_inline(line) for line in self.subtitle.splitlines())
        head += f'<p class="subtitle">{below}</p>' if self.subtitle else ""
        head += f'<nav aria-label="Sections"><ul>{links}</ul></nav>' if len(self._sections) > 1 else ""
        end = f"<footer><p>{_inline(self.footer)}</p></footer>" if self.footer else ""
        # The empty icon keeps browsers from asking a server for one.
        return (
            '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<title>{escape(self.title)}</title>\n<link rel="icon" href="data:,">\n<style>\n{style}</style>\n</head>\n'
            f"<body>\n<header>{head}</header>\n<main>\n" + "\n".join(self._blocks) + f"\n</main>\n{end}</body>\n</html>\n"
        )

    def write(self, path: Path) -> Path:
        """Write the page, whole or not at all.

        RacewayError: A folder or disk that cannot be written.
        """
        return write_whole(self.html().encode(), path)


def svg(figure: Figure) -> bytes:
    """A figure as SVG, the same bytes for the same figure; letters are drawn as paths, so that no font is needed."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    memory = io.BytesIO()
    with rc_context({"svg.fonttype": "path", "svg.hashsalt": "raceway"}):
        FigureCanvasSVG(figure).print_svg(memory, metadata={"Date": None})
    return memory.getvalue()


def data_uri(content: bytes) -> str:
    """A PNG or SVG file as a data URI."""
    kind = "image/png" if content.startswith(b"\x89PNG") else "image/svg+xml"
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _inline(words: str) -> str:
    """Escaped text; what stands between backticks is code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(words, quote=False))


def _numbers(column: Sequence[Cell]) -> bool:
    """Whether a column stands to the right: half of its cells, or more, are numbers and none is a sentence."""
    count = sum(bool(_NUMBER.fullmatch(cell.text.strip())) and bool(cell.text.strip()) for cell in column)
    return count > 0 and 2 * count >= len(column) and all(len(cell.text) <= _SENTENCE // 2 for cell in column)


def _in_tone(cell: Cell) -> str:
    words = _inline(cell.text)
    words = f'<span class="tone {cell.tone}">{words}</span>' if cell.tone else words
    return f"{words} {_inline(cell.more)}" if cell.more else words


def _cell_text(value: object) -> str:
    if value is None:
        return "–"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _class(**classes: bool) -> str:
    names = " ".join(name for name, present in classes.items() if present)
    return f' class="{names}"' if names else ""
