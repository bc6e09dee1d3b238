"""What stays out of memory until it is needed."""

import json
import resource

import pytest

from checks.validation.command_line import ARTICLE, python

LOOK = """
import json, sys
try:
    {code}
except SystemExit as end:
    assert (end.code or 0) == {status}, end.code
sys.stderr.write("\\n" + json.dumps(sorted({{name.partition(".")[0] for name in sys.modules}} | {{"numba.cuda"}} & set(sys.modules))))
"""
PICTURES = {"meshio", "gmsh", "pyvista", "matplotlib"}
HEAVY = PICTURES | {"numba", "scipy"}
MAIN = "from raceway.cli.main import main; main({!r})"
#: Code, and what it loads not.
CASES = {
    "import": ("import raceway as rw; dir(rw)", HEAVY | {"numpy", "pandas", "xarray", "pluggy", "attrs", "click", "rich"}),
    "names": ("import raceway; raceway.load_scene; raceway.RacewayError", HEAVY),
    "scene": (f"import raceway as rw; rw.Scene.from_toml({ARTICLE!r}).with_(load={{'axial': '1 kN'}}); rw.positive", HEAVY),
    "check and plan of a scene": (f"import raceway as rw; rw.check({ARTICLE!r}); rw.plan({ARTICLE!r})", HEAVY),
    "help": (MAIN.format(["--help"]), HEAVY | {"numpy", "rich", "cattrs"}),
    "help of a command": (MAIN.format(["run", "--help"]), HEAVY),
    "run": (f"import tempfile; {MAIN.format(['run', ARTICLE, '--out'])[:-2]}, tempfile.mkdtemp()])", PICTURES | {"numba.cuda"}),
} | {word: (MAIN.format([word, *scene]), HEAVY) for word, *scene in (
    ("check", ARTICLE), ("plan", ARTICLE), ("dev", "plugins",), ("dev", "schema",), ("dev", "cache",),
)}  # fmt: skip
#: Mistakes in a study are told before the compiler is loaded.
#: Others are near them: the check and the plan, a mistake.
NEAR = ("scene", "check", "plan", "help of a command", "dev")
MISTAKES = {
    "precision": MAIN.format(["precision", ARTICLE, "--vary", "no.key=1,2"]),
    "stability": MAIN.format(["stability", "--only", "no such case"]),
}


def loaded(code: str, status: int = 0) -> set[str]:
    """Packages in memory of a process that has executed ``code``."""
    found = python("-c", LOOK.format(code=code, status=status))
    assert found.returncode == 0, found.stderr
    return set(json.loads(found.stderr.splitlines()[-1]))


@pytest.mark.parametrize(
    ("code", "without"),
    [pytest.param(*case, id=name, marks=[pytest.mark.slow] * (name in NEAR)) for name, case in CASES.items()],
)
def test_packages_stay_out(code, without):
    packages = loaded(code)
    assert "raceway" in packages and not packages & without


@pytest.mark.parametrize("code", MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_in_a_study_is_told_before_the_compiler_is_loaded(code):
    assert not loaded(code, status=2) & HEAVY


def seconds(*words):
    """Processor time of a process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert python(*words).returncode == 0
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@pytest.mark.parametrize(
    ("words", "limit"), [(("-c", "import raceway"), 0.7), (("-m", "raceway", "--help"), 1.5)], ids=["import", "help"]
)
def test_the_import_and_the_help_take_no_longer_than_a_library_that_they_leave_out(words, limit):
    """Over the import of numpy, a tenth of a second: a quarter and two thirds; numba or scipy alone would add three of it."""
    ratios = [seconds(*words) / seconds("-c", "import numpy") for _ in range(4)]
    assert min(ratios) <= limit  # what others do on the machine meets both
