"""Length and language of what people read: Markdown, help of commands, sentences of the package."""

import ast
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

from checks.robustness import Row, below

ROOT = Path(__file__).parents[2]
#: Pages whose length follows from the program or from measurements.
_NOT_FOR_USERS = ("CHANGELOG.md", "CONTRIBUTING.md", "docs/command_line.md", "docs/scene.md", "docs/glossary.md")
#: Terms of the field stand in CONTRIBUTING.md "Words".  Names of parameters and attributes are none: ``kept : folder``, ``fact.scatter``.
PRIVATE = re.compile(
    r"""\b(is|are|be|been|being)\ told\b | \btells?\b | \bsettles?d?\b | (?<!\.)\bscatter\b(?!\ plot|\ :|\)) | \ba\ line\ a\ (point|row|run)\b
    | \benergy\ a\ cycle\b | \bheld\ against\b | \bhangs?\ on\b | \blets?\ go\b | \bhas\ no\ say\b | \bcounts?\ for\ nothing\b
    | \bthree\ doors\b | \bby\ the\ door\b | \bseats\ the\ bearing\b | \bunseats?\b | \bin\ doubt\b | \btakes?\ along\b
    | \bfate\b | \bdetours?\b | \bswings?\b | \b1x\ lines?\b | \bspectral\ lines?\b | \bbeside\ an\ unstable\b | (?<!`)\bkept\b(?!`|\ :|,\ left_out|\.$) | \bthe\ whole\b
    """,
    re.VERBOSE | re.IGNORECASE,
)


def _markdown() -> dict[str, str]:
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return {name: (ROOT / name).read_text(encoding="utf-8") for name in listed}


def _sentences(path: Path) -> Iterator[tuple[int, str]]:
    """Texts of a module that people may read: every string of several words, docstrings of private things apart."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    private = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Module)
        and isinstance(node.body[0], ast.Expr)
        and (isinstance(node, ast.Module) or node.name.startswith("_"))
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value and id(node) not in private:
            yield node.lineno, node.value


def private_terms() -> list[str]:
    """Each place with a term, as file:line term."""
    found = []
    for name, text in _markdown().items():
        if not name.startswith("CHANGELOG"):
            lines = enumerate(text.splitlines(), 1)
            found += [f"{name}:{number} {match[0]}" for number, line in lines for match in PRIVATE.finditer(line)]
    for path in [*sorted((ROOT / "raceway").rglob("*.py")), *sorted(ROOT.glob("packages/*/raceway_*/**/*.py"))]:
        name = path.relative_to(ROOT).as_posix()
        found += [f"{name}:{number} {match[0]}" for number, text in _sentences(path) for match in PRIVATE.finditer(text)]
    return found


def rows() -> Iterator[Row]:
    """Words of Markdown, of the README, of the longest page for users; private terms."""
    pages = {name: len(text.split()) for name, text in _markdown().items()}
    users = {name: words for name, words in pages.items() if not name.startswith(_NOT_FOR_USERS)}
    longest = max(users, key=users.__getitem__)
    long = ", ".join(f"{name} {words}" for name, words in sorted(users.items(), key=lambda page: -page[1]) if words > 1500)
    yield below("words of Markdown", sum(pages.values()), 55000)
    yield below("words of the README", pages["README.md"], 800)
    yield below("words of the longest page for users", users[longest], 1500, long)
    terms = private_terms()
    yield below("private terms in documents, help and sentences", len(terms), 0, "; ".join(terms[:20]))
