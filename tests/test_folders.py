"""Folders of the repository know what they may know; every folder of the package says what is in it."""

import ast
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
