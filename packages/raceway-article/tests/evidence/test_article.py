"""The article's study: claims, cost and trends.

Verdicts and tables are the study's own output, in its page and its JSON; docs/article_runs.md tells them.
"""

import json
import os
import re
import resource
import shutil
import subprocess
import sys
from typing import Any

import attrs
import pytest
from raceway_article.design import (
    FRICTION_ERROR,
    FRICTION_STEPS,
    FRICTION_TURNS,
    FRICTIONS,
    ROTATING,
    Setting,
    article_tables,
    design,
)
from raceway_article.rules import KINDS

from checks.validation.command_line import EXAMPLES
from raceway import scene_from_dict
from raceway.extend import default_registry, run

pytestmark = pytest.mark.release

PICTURES = EXAMPLES.parent / "docs" / "pictures" / "article"
FIGURES = ("figure-9", "figure-10", "figure-11", "figure-12", "tilt-stiffness", "friction")
#: Typed one after the other, each in the folder of those before, which costs nothing twice: words, and the limit [s] of all so far.
STUDIES = {
    "rigid bodies without friction": (("--bodies", "rigid", "--friction", "0"), 120.0),
    "rigid bodies, with friction": (("--bodies", "rigid"), 240.0),
    "rigid and condensed bodies, with friction": ((), 300.0),
}
SLOW = "some 2700 motions that do not repeat themselves are integrated; cheaper points are work ahead"
#: Tilt, axial load [N], speed [r/min] of the runs with friction that are repeated with twice the turns of twice the steps.
REPEATED = (
    ("free", 2000.0, 10980.0), ("free", 2000.0, 15000.0), ("locked", 2000.0, 15000.0), ("free", 400.0, 12990.0),
    ("shaft", 1200.0, 12990.0),
)  # fmt: skip
_FETCHES = re.compile(r"https?://|url\(|@import|<script|srcset")


@attrs.frozen
class Study:
    """What the command printed, its page, and the processor time of its first process and of half its two workers [s]."""

    content: dict[str, Any]
    page: str
    seconds: float


@pytest.fixture(scope="module")
def studies(tmp_path_factory, request):
    """All three, from no compiled kernel and no stored curve."""
    place = tmp_path_factory.mktemp("article")
    made = {name: _study(place, words) for name, (words, _) in STUDIES.items()}
    if request.config.option.evidence:
        for name in FIGURES:
            shutil.copy(place / "study" / f"{name}.png", PICTURES)
    return made


def _study(place, words):
    folder = place / "study"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-m", "raceway", "study", "article", *words, "--out", str(folder), "--json"],
        capture_output=True, text=True, env={**os.environ, "RACEWAY_CACHE_DIR": str(place / "cache")}, check=True,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    content = json.loads(done.stdout)
    workers = content["cost"]["cpu_s"] - content["cost"]["own_cpu_s"]
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Study(content, (folder / "article.html").read_text(encoding="utf-8"), used - 0.5 * workers)


def test_cost_from_cold(claim, studies):
    total = 0.0
    for name, (_, limit) in STUDIES.items():
        total += studies[name].seconds
        claim(
            f"cold start to page, {name}: CPU time of the first process and half of two others", total, unit="s",
            at_most=limit, basis="regression", source=f"{studies[name].content['runs']} motions", machine=True, misses=SLOW,
        )  # fmt: skip


def test_trends_of_an_independent_solver(claim, studies):
    content = studies["rigid and condensed bodies, with friction"].content
    trends = content["quasi_static"]
    assert len(trends) == 12 and all(one["holds"] for one in trends)
    claim(
        "k(10 980 r/min) and k* to 15 000 r/min, tilt locked and free, 400, 1000, 2000 N, with and without ball inertia: largest deviation",
        max(one["off_in_last_digits"] for one in trends), unit="last printed digits", at_most=0.5, basis="other program",
        source="an independent quasi-static solver, its printed digits",
    )  # fmt: skip
    rows = content["static"]
    for what, rule, limit, why in (
        ("peak pressures in four load cases against exact Hertz", False, 0.0242, "the article's own deviation"),
        ("peak pressure at 2000 N, 4 points per semi-axis against 6", True, 0.01, "half the article's deviation"),
    ):
        errors = [row["error"] for row in rows if row["quantity"].startswith("mesh independence") == rule]
        assert errors
        claim(f"{what}: largest relative error", max(errors), at_most=limit, basis="closed form", source=why)


def test_verdicts_are_those_of_the_documents(studies):
    verdicts = studies["rigid and condensed bodies, with friction"].content["verdicts"]
    words = {
        "without friction": "N", "friction on balls that stand": "S", "friction on balls that orbit": "O",
        "|Z|": r"\|Z\|",
    }  # fmt: skip
    text = "\n".join(f"| {one['number']} | {one['region']} |" for one in verdicts if one["region"])
    for word, sign in words.items():
        text = text.replace(word, sign)
    pages = [(EXAMPLES.parent / "docs" / name).read_text(encoding="utf-8") for name in ("article_runs.md", "article.md")]
    assert text in pages[0]
    short = {one["number"]: KINDS[one["kind"]][2] for one in verdicts}
    told = re.findall(r"^\| (\d[a-e]?) \| (?:[^|\\]|\\.)* \| (\w+) \| ?(\w*) ?\|", pages[1], re.M)
    assert all(
        k == short.get(n, short.get(f"{n}a")) and (not z or z == short.get(f"{n} |Z|", short.get(f"{n}b")))
        for n, k, z in told
    )
    assert len(told) == 16


def test_page_stands_alone(claim, studies):
    page = studies["rigid and condensed bodies, with friction"].page
    fetched = _FETCHES.findall(re.sub(r'src="data:[^"]*"', "", page))
    pictures = re.findall(r'<img alt="([^"]*)" src="data:', page)
    assert len(pictures) == 70 and all(pictures)
    size = len(page.encode()) / 1e6
    claim("size of the page", size, unit="MB", at_most=5.0, basis="regression", source="what mail takes")
    claim("what the page fetches or runs", len(fetched), at_most=0, basis="regression", source="it opens without a network")


def test_error_of_runs_with_friction(claim):
    registry, made = default_registry(), design(article_tables())
    changes = []
    for friction in FRICTIONS[1:]:
        for tilt, load, speed in REPEATED:
            setting = Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid", friction=friction)
            tables = made.point(setting, load, speed, registry)
            twice = {"turns": 2 * FRICTION_TURNS, "steps_per_turn": 2 * FRICTION_STEPS}
            finer = {**tables, "integrator": {**tables["integrator"], **twice}}
            k = [
                run(scene_from_dict(one, registry), registry).identification.equivalent_stiffness for one in (tables, finer)
            ]
            changes.append(abs(k[1] / k[0] - 1.0))
    claim(
        f"largest change of K with friction by twice the turns of twice the steps, {len(changes)} points", max(changes),
        at_most=FRICTION_ERROR, basis="own other method", source="what the verdicts take for the error of K with friction",
        misses="one point of ten: friction on balls that stand at 2000 N converges slowly",
    )  # fmt: skip
