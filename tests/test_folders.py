"""Folders of the repository know what they may know; every folder of the package says what is in it."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: Folder -> those beside it that its modules may import.
MAY_IMPORT = {
    "raceway": set(),
    "validation": {"raceway"},
    "tests": {"raceway", "validation"},
    "benchmarks": {"raceway", "validation"},
}


def imported(path):
    """First words of the modules that a file imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.split(".")[0]
        elif isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_tests_and_benchmarks_do_not_import_each_other(folder):
    forbidden = set(MAY_IMPORT) - MAY_IMPORT[folder] - {folder}
    files = sorted((ROOT / folder).rglob("*.py"))
    assert files
    assert [(str(path.relative_to(ROOT)), word) for path in files for word in imported(path) if word in forbidden] == []


PACKAGES = sorted((ROOT / "raceway").rglob("__init__.py"))


@pytest.mark.parametrize("path", PACKAGES, ids=lambda path: path.parent.relative_to(ROOT).as_posix())
def test_a_package_says_what_is_in_it(path):
    listed: set[str] = set()
    for line in (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").splitlines():
        # `name, name  words;  name: words`
        heads = re.findall(r"^\s*((?:\w+, )*\w+),?(?=  |$)|;  ((?:\w+, )*\w+):", line)
        listed |= {name for head in heads for name in "".join(head).split(", ")}
    modules = {entry.stem for entry in path.parent.glob("*.py")}
    folders = {entry.name for entry in path.parent.iterdir() if entry.is_dir() and any(entry.rglob("*.*"))}
    entries = {name for name in modules | folders if not name.startswith("_")}
    assert entries - listed == set(), "one line each in the docstring"
