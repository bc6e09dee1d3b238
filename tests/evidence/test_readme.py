"""Numbers of the README.

The 4 and 8 % of its screen are rows of ``published``; the screen itself is held by tests/test_documents.py.
"""

import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest

import raceway as rw

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
#: Processor time of a shared machine differs by as much.
BUSY = 2.0


def block(name):
    return re.search(rf"<!-- {name} -->\n```\w*\n(.*?)```", README, re.DOTALL)[1]


def processor_seconds(*words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "raceway", *words], cwd=ROOT, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@pytest.mark.night
def test_a_run_takes_about_a_second(claim, tmp_path):
    words = ("run", "examples/minimal.toml", "--out", str(tmp_path / "out"))
    processor_seconds(*words)
    least = min(processor_seconds(*words) for _ in range(3))
    quantity = "`raceway run examples/minimal.toml`, kernels compiled: least processor time of three"
    source = "'about a second', on a shared machine twice that"
    claim(quantity, least, at_most=BUSY, unit="s", basis="regression", source=source)


@pytest.mark.night
@pytest.mark.parametrize(("bodies", "limit"), [("rigid", 0.01), ("condensed", 0.5)])
def test_a_static_answer(claim, bodies, limit):
    """README: milliseconds; milliseconds to tenths of a second.  The first load is not counted: set-up."""
    tables = {"bearing": {"preset": "B7206C"}, "bodies": {"kind": bodies}}
    costs = [rw.run({**tables, "load": {"axial": axial}}).to_dict()["cost"] for axial in (1000.0, 900.0, 800.0, 700.0)]
    least = min(cost["solve_s"] for cost in costs[1:])
    quantity = f"equilibrium of {bodies} bodies, B7206C, 900 to 700 N: least solve time"
    claim(quantity, least, at_most=BUSY * limit, unit="s", basis="regression", source="twice the sentence's order")


def test_lines(claim):
    scene = [line for line in block("scene").splitlines() if line.strip()]
    claim("lines of README's scene", len(scene), at_most=10, basis="regression", source="'a scene of ten lines'")
    code = block("example").split("import raceway as rw\n")[1]
    lines = 2 + sum(bool(line.strip()) for line in code.splitlines())
    source = "'ten lines of Python'"
    claim("lines of README's Python, from import to plot", lines, at_most=10, basis="regression", source=source)
    tutorials = len(list((ROOT / "docs" / "tutorials").glob("*.md")))
    claim("tutorials", tutorials, at_least=4, at_most=4, basis="regression", source="'four tutorials'")
