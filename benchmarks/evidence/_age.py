"""Which reports are older than the code that they measure.

A report carries a digest of the areas that it measures, of its own module, and of what that imports from ``benchmarks``,
``validation`` and ``tests``.  What counts are definitions and statements, wherever they stand in those areas: comments,
docstrings, line breaks, imports and the names of modules are no part of it.  A report whose digest is not that of the code is out
of date: it is made again or, where that costs too much for now, stands with date and reason in ``docs/reports/older.toml``.
"""

from __future__ import annotations

import ast
import datetime
import hashlib
import json
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks.evidence._areas import AREAS, MEASURES

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "raceway"
LISTED = ROOT / "docs" / "reports" / "older.toml"
#: Folders beside the package whose modules a report may be made with.
FOLDERS = ("benchmarks", "validation", "tests")
#: What every report is made with: no part of what a report measures.
_RUNNER = {Path(__file__).with_name(name) for name in ("__init__.py", "_files.py", "_kept.py")}
#: A module of the package in a text, as Python or a path names it.
_MODULE = re.compile(r"\braceway([./][a-z_][a-z_0-9]*)+(\.py\b)?")
_PLACES = {place: area for area, places in AREAS.items() for place in places.split()}


def digest(name: str) -> str:
    """Digest of the code that a report measures, 16 hexadecimal digits.

    Raises
    ------
    KeyError
        A report for which ``_areas.MEASURES`` names no areas.
    """
    pieces = sorted(piece for path in measured(name) for piece in _pieces(path))
    return hashlib.sha256("\n".join(pieces).encode()).hexdigest()[:16]


def measured(name: str) -> list[Path]:
    """The files that a report measures."""
    found = _imported(Path(__file__).with_name(f"{name}.py"))
    for word in MEASURES[name].split():
        if "/" in word:
            place = ROOT / word
            found |= set(place.rglob("*.py")) if place.is_dir() else {place}
        else:
            found |= {path for path in package_files() if area(path) == word}
    return sorted(found)


@cache
def package_files() -> list[Path]:
    """The package's sources and data."""
    return sorted(path for path in PACKAGE.rglob("*") if path.is_file() and "__pycache__" not in path.parts)


def area(path: Path) -> str | None:
    """The area of a file of the package; None where no place of ``_areas.AREAS`` holds it."""
    inside = path.relative_to(PACKAGE)
    places = (inside.with_suffix(""), *inside.parents)
    return next((_PLACES[place.as_posix()] for place in places if place.as_posix() in _PLACES), None)


def out_of_date(reports: dict[str, dict[str, Any]]) -> list[str]:
    """Names of the reports that were made with other code than this."""
    return [name for name, data in reports.items() if data["digest"] != digest(name)]


def listed() -> dict[str, str]:
    """Reports that are known to be older than the code, with the date of the entry and the reason."""
    return tomllib.loads(LISTED.read_text(encoding="utf-8"))


def put_on_list(names: list[str], reason: str) -> None:
    """List reports as known to be older than the code."""
    today = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d")
    _write(listed() | dict.fromkeys(names, f"{today}: {reason}"))


def take_off_list(names: list[str]) -> None:
    """Take reports that were made again off the list."""
    _write({name: reason for name, reason in listed().items() if name not in names})


def _write(entries: dict[str, str]) -> None:
    head = (
        "# Reports that are older than the code they measure, with date and reason: python -m benchmarks.evidence --older\n"
    )
    lines = [f"{name} = {json.dumps(entries[name], ensure_ascii=False)}\n" for name in sorted(entries)]
    LISTED.write_text(head + "".join(lines), encoding="utf-8")


@cache
def _pieces(path: Path) -> tuple[str, ...]:
    """What counts of a file: the statements of a source as Python writes them, without docstrings and imports; other files whole."""
    text = path.read_text(encoding="utf-8")
    pieces = [text] if path.suffix != ".py" else map(ast.unparse, _Bare().visit(ast.parse(text)).body)
    return tuple(_MODULE.sub("raceway", piece) for piece in pieces)


class _Bare(ast.NodeTransformer):
    """Takes out docstrings and imports."""

    def visit_Import(self, node: ast.Import) -> None:
        return None

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        return None

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        words = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if words else node


@cache
def _imported(path: Path) -> frozenset[Path]:
    """A module with all that it imports of ``FOLDERS``, directly or not."""
    found: set[Path] = set()
    waiting = [path]
    while waiting:
        path = waiting.pop()
        if path in found or path in _RUNNER:
            continue
        found.add(path)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in FOLDERS:
                base = ROOT.joinpath(*node.module.split("."))
                candidates = [
                    base.with_suffix(".py"),
                    *(base / f"{alias.name}.py" for alias in node.names),
                    base / "__init__.py",
                ]
                waiting += [candidate for candidate in candidates if candidate.is_file()]
    return frozenset(found)
