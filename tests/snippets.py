"""Listings and commands of the documents, as a reader copies them."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import attrs
from markdown_it import MarkdownIt

ROOT = Path(__file__).resolve().parents[1]
#: Written by hand.  Reports are made from their JSON files, and those carry the commands that made them.
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
_COMMENT = re.compile(r"\s+# .*$")


@attrs.frozen
class Listing:
    """A block of code: fenced with a language, or indented ("")."""

    page: Path
    line: int
    language: str
    text: str

    @property
    def file(self) -> str | None:
        """The name of the file that the block is, from its first line."""
        found = re.compile(r"# (\S+\.(?:py|toml|csv))\n").match(self.text)
        return found[1] if found else None

    def commands(self) -> list[str]:
        """The command lines of a block for a shell, without prompts and comments, continued lines joined."""
        if self.language not in ("", "console"):
            return []
        lines = (_COMMENT.sub("", line.removeprefix("$ ")) for line in self.text.replace("\\\n", " ").splitlines())
        return [" ".join(shlex.split(line, posix=False)) for line in lines if line.strip()]


def listings(page: Path) -> list[Listing]:
    """Every block of code of a page that is written by hand, in its order."""
    text = re.sub(
        r"(<!-- (?:evidence:\w+|screen) -->\n)(.*?)(<!-- /(?:evidence|screen) -->)",
        lambda match: match[1] + "\n" * match[2].count("\n") + match[3],  # without their content, with as many lines
        page.read_text("utf-8"),
        flags=re.DOTALL,
    )
    found = []
    for token in MarkdownIt().parse(text):
        if token.type in ("fence", "code_block") and token.map is not None:
            found.append(Listing(page, token.map[0] + 1, token.info.strip(), token.content))
    return found


def links(page: Path) -> Iterator[tuple[int, str]]:
    """(line, target) of every link and picture of a page that stays inside the repository."""
    for token in MarkdownIt().enable("table").parse(page.read_text(encoding="utf-8")):
        for child in token.children or []:
            target = child.attrGet("href") or child.attrGet("src")
            if target and not re.match(r"[a-z]+:", str(target)):
                yield (token.map or [0])[0] + 1, str(target)


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub and the site name them."""
    tokens = MarkdownIt().parse(page.read_text(encoding="utf-8"))
    titles = [after.content for before, after in zip(tokens, tokens[1:], strict=False) if before.type == "heading_open"]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
