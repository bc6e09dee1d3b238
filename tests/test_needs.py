"""Tests that need system libraries: skipped loudly where they are missing, failures in continuous integration."""

import re
from pathlib import Path

import pytest

from tests.hidden_libraries import hide
from validation.command_line import EXAMPLES, python
from validation.system_libraries import NEEDS, install_line

ROOT = EXAMPLES.parent
FILE = "import pytest\n\n" + "\n\n".join(f'@pytest.mark.needs("{name}")\ndef test_{name}():\n    pass\n' for name in NEEDS)


def collected(folder: Path, **environment):
    """What pytest says of a test for each need, in an environment."""
    path = folder / "test_each_need.py"
    path.write_text(FILE)
    words = (
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "validation.system_libraries",
        "-c",
        ROOT / "pyproject.toml",
    )
    return python(*words, path, cwd=ROOT, **{"CI": "", "RACEWAY_TEST_ALL": ""} | environment)


def test_on_a_bare_machine_they_are_skipped_with_one_closing_line(tmp_path):
    done = collected(tmp_path, **hide(tmp_path))
    assert done.returncode == 0, done.stdout
    assert re.search(rf"^{len(NEEDS)} skipped", done.stdout, re.MULTILINE)
    (line,) = [line for line in done.stdout.splitlines() if "NOT TESTED" in line]
    assert f"{len(NEEDS)} tests were skipped" in line and line.endswith(install_line())
    assert all(f"{called} (1)" in line for called, _ in NEEDS.values())


@pytest.mark.parametrize("variable", [{"CI": "true"}, {"RACEWAY_TEST_ALL": "1"}])
def test_where_everything_is_tested_a_missing_library_is_a_failure(tmp_path, variable):
    done = collected(tmp_path, **hide(tmp_path), **variable)
    assert done.returncode == 1
    assert re.search(rf"^{len(NEEDS)} (failed|errors)", done.stdout, re.MULTILINE), done.stdout
    assert install_line() in done.stdout and "NOT TESTED" not in done.stdout


def test_programs_that_are_there_are_used(tmp_path):
    programs = hide(tmp_path)["PATH"]
    for name in ("chromium", "chromedriver", "ccx"):
        (Path(programs) / name).write_text("#!/bin/sh\n")
        (Path(programs) / name).chmod(0o755)
    done = collected(tmp_path, **hide(tmp_path))
    assert "2 passed, 2 skipped" in done.stdout and "NOT TESTED: 2 tests" in done.stdout


@pytest.mark.needs("gmsh", "pyvista", "browser", "ccx")
def test_with_all_libraries_nothing_is_skipped(tmp_path):
    done = collected(tmp_path)
    assert done.returncode == 0 and f"{len(NEEDS)} passed" in done.stdout and "NOT TESTED" not in done.stdout
