"""Every test is in a tier that some command runs: quick, night, release, or under ROSS."""

import re
import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TEST = re.compile(r"^ *def test_", re.MULTILINE)


def test_marks_are_the_tiers():
    ours = {line.partition(":")[0] for line in _options()["markers"]}
    assert ours == {"slow", "docs", "night", "release", "ross", "needs(name, ...)"}, (
        "a new mark needs a tier: see the Makefile and here"
    )
    make = (ROOT / "Makefile").read_text(encoding="utf-8")
    # Quick and night leave out what the next tiers run; ROSS has a line of its own.
    for line in (
        '-m "not slow and not docs and not night and not release and not ross"', '-m "not release and not ross"', "-m ross ",
        "python -m checks.night",
    ):  # fmt: skip
        assert line in make, line


def test_no_test_lies_where_pytest_does_not_look():
    """Conformance suites are collected through subclasses, and templates by the tests of the scaffold."""
    tracked = subprocess.run(
        ["git", "ls-files", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    paths = [Path(path) for path in tracked if not path.startswith(("raceway/", "examples/"))]
    outside = [
        path.as_posix()
        for path in paths
        if TEST.search((ROOT / path).read_text(encoding="utf-8"))
        and f" {path.as_posix()}\n" not in (ROOT / "Makefile").read_text(encoding="utf-8")  # by a target of its own
        and not (path.name.startswith("test_") and any(path.is_relative_to(folder) for folder in _options()["testpaths"]))
    ]
    assert not outside


def test_make_ross_names_each_file_of_its_tier():
    make = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.search(r"-m ross (.*)", make)[1].split())
    marked = {
        path.relative_to(ROOT).as_posix()
        for folder in _options()["testpaths"]
        for path in (ROOT / folder).rglob("test_*.py")
        if re.search(r"^(@|pytestmark = )pytest\.mark\.ross$", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert marked == named


def _options() -> dict:
    with (ROOT / "pyproject.toml").open("rb") as file:
        return tomllib.load(file)["tool"]["pytest"]["ini_options"]
