"""Every command and listing of README and docs is run in its order, or made by the program; every link leads somewhere."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

import raceway
from raceway import scene_from_dict
from raceway.cli.main import main
from raceway.scene.tables import TABLES
from tests.snippets import PAGES, ROOT, Listing, anchors, links, listings

_ENVIRONMENT = "makes a virtual environment"
_THREE = "three terminals; tests/test_dask.py does it"
#: Commands that no test runs, each with the reason.
NOT_RUN = {
    "make demo": _ENVIRONMENT, "make test": "runs this test", "make": "lists targets", "make test-all": "runs this test",
    "make lint": "continuous integration does it", "make docs": _ENVIRONMENT, "make ross": _ENVIRONMENT,
    "make evidence": "hours; makes the reports of this checkout",
    ".ci/other_pythons": _ENVIRONMENT,
    "python3 -m venv .venv": _ENVIRONMENT,
    ".venv/bin/pip install .": _ENVIRONMENT,
    ".venv/bin/raceway run examples/minimal.toml": "needs that environment; README shows its answer",
    "pip install '.[sweep]'": _ENVIRONMENT,
    "python -m venv .venv-ross && .venv-ross/bin/pip install -e '.[sweep]' -e './packages/raceway-rotor[ross]'": _ENVIRONMENT,
    "RACEWAY_ROSS_PYTHON=.venv-ross/bin/python .venv/bin/python -m pytest --evidence packages/raceway-rotor/tests/evidence/test_ross.py": "writes a report of this checkout",
    ".venv/bin/python -m checks.documents": "writes documents of this checkout; checks/tests compare them",
    ".venv/bin/python -m pytest --evidence FOLDER/evidence/test_NAME.py": "writes a report of this checkout",
    "raceway stability --all": "ten minutes; packages/raceway-checks/tests/evidence/test_stability.py does it",
    "raceway study article": "a quarter of an hour; its report does it",
    "raceway study article --bodies rigid --friction 0": "minutes; the same report",
    "raceway study article examples/b7206.toml --set rotor.mass=1.5 --axial 400,1000,2000 --bodies rigid --friction 0": "more than "
    "five minutes; packages/raceway-article/tests/test_article_command.py runs the study with options",
    "raceway study article --bodies elastic": "most of an hour and gigabytes; packages/raceway-article/tests/test_article_elastic.py runs it on a tiny mesh",
    "raceway study article --bodies elastic --set mesh.element_size=1.6e-3 --set mesh.nodes_per_semi_axis=2": "minutes; the same test",
    "dask scheduler --host 127.0.0.1": _THREE,
    "OMP_NUM_THREADS=1 dask worker tcp://127.0.0.1:8786 --nworkers 2 --nthreads 1": _THREE,
    "raceway sweep examples/b7206.toml --set integrator.kind=periodic --grid excitation.speed_rpm=10980:15000:41 "
    "--grid load.axial=400:2000:17 --executor dask --scheduler tcp://127.0.0.1:8786 --out raceway-out/map": _THREE,
    "cd raceway-power && pip install -e . && pytest": "tests/test_third_party.py does it",
    "python -m checks.against_calculix --scene checks/b7206_elastic_60k.toml --deck bearing.inp": "CalculiX takes an hour",
    "python -m checks.against_calculix": "a minute; tests/core/evidence/test_elastic.py does it",
    "raceway run checks/b7206_elastic_60k.toml": "a minute; tests/core/evidence/test_elastic.py does it",
}  # fmt: skip
#: Pages of more than some seconds; their commands run with the slow tests.
SLOW = {
    "CONTRIBUTING", "article", "cluster", "coefficients", "compare", "elastic", "fit", "identify", "map", "mesh",
    "nodal_contact", "plotting", "precision", "rig",
}  # fmt: skip
SLOW |= {"film", "fit", "follow", "measurements", "ross", "sensitivities", "stability", "sweep", "view", "warm_spindle"}
#: Pages of seconds: the site's job runs them, the quick tests have the others.
SITE = {"README", "catalogue", "elastic_dynamics", "fmu", "friction", "leaving_out", "periodic", "plugins", "points", "sets"}
#: Listings of Python in other hands: tests/test_docs.py; ROSS is in the environment of make docs, whose tutorial does the same.
ELSEWHERE = {"plugins": "", "ross": "ross"}
#: Languages of listings that nothing runs: text, and what the site reads.
SHOWN = {"text", "matlab", "modelica", "{toctree}", "{eval-rst}"}

LISTINGS = {page: listings(page) for page in PAGES}
ASKED = [command for found in LISTINGS.values() for listing in found for command in listing.commands()]


def runs(page: Path) -> bool:
    return any(listing.commands() or listing.language in ("python", "toml") for listing in LISTINGS[page])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder as the root of a checkout looks to the commands."""
    for name in ("examples", "checks"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(
            p, id=p.stem, marks=[pytest.mark.slow] * (p.stem in SLOW) + [pytest.mark.docs] * (p.stem in SLOW | SITE)
        )
        for p in PAGES
        if runs(p)
    ],
)
def test_commands_and_listings_run_in_their_order(page, folder):
    namespace = {}
    for listing in LISTINGS[page]:
        if listing.file:
            (folder / listing.file).write_text(listing.text, encoding="utf-8")
        elif listing.language == "toml":
            read(listing)
        elif listing.language == "python" and not elsewhere(listing):
            exec(compile(listing.text, f"{page.name}:{listing.line}", "exec"), namespace)
        for command in listing.commands():
            if command not in NOT_RUN:
                output = run(command)
                assert "has no effect" not in output, f"{page.name} shows a command that warns: {command}"


def elsewhere(listing: Listing) -> bool:
    """Whether a listing is run elsewhere: every one of its page, or those with a word."""
    word = ELSEWHERE.get(listing.page.stem)
    return word is not None and (not word or re.search(rf"import {word}\b|needs {word.upper()}\b", listing.text) is not None)


def read(listing: Listing) -> None:
    """Part of a scene: its keys and values are right; of another file: it is TOML."""
    tables = tomllib.loads(listing.text)
    if set(tables) <= {*TABLES, "rig", "title"}:
        scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, **tables})


def run(command: str) -> str:
    """What a command prints, in a process of its own as a reader starts it; it must succeed."""
    words = shlex.split(command)
    name = Path(words[0]).name
    assert name in ("raceway", "python"), f"no test knows how to run {command!r}"
    started = [sys.executable, *(("-m", "raceway") if name == "raceway" else ()), *words[1:]]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONSAFEPATH": "1"}
    ended = subprocess.run(started, capture_output=True, text=True, env=variables, check=False)
    assert ended.returncode == 0, f"{command}\n{ended.stdout}{ended.stderr}"
    return ended.stdout + ended.stderr


def test_what_is_not_run_is_listed_and_the_list_holds_nothing_else():
    assert not [command for command in NOT_RUN if command not in ASKED]
    assert {page.stem for page in PAGES if runs(page)} >= SLOW | SITE


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_indented_blocks_are_commands_and_fenced_ones_say_their_language(page):
    for listing in LISTINGS[page]:
        assert listing.language in {"", "console", "python", "toml", *SHOWN} or listing.language.startswith(
            ("{include}", "{literalinclude}")
        )
        for command in listing.commands():
            first = command.split()[0].rpartition("=")[0] and command.split()[1] or command.split()[0]
            assert Path(first).name in {"raceway", "python", "python3", "pip", "make", "dask", "cd", "other_pythons"}, (
                f"{page.name}:{listing.line}: a command for a shell, or a block fenced as text? {command}"
            )


EVERY_PAGE = sorted({*PAGES, *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").glob("*/README.md")})
EVERY_PAGE = [page for page in EVERY_PAGE if "_build" not in page.parts]


def test_every_link_leads_to_a_file_and_a_heading():
    missing = []
    for page in EVERY_PAGE:
        for line, target in links(page):
            path, _, anchor = target.partition("#")
            file = (page.parent / path).resolve() if path else page
            if not file.exists() or (anchor and anchor not in anchors(file)):
                missing.append(f"{page.relative_to(ROOT)}:{line}: {target}")
    assert not missing


def test_every_picture_is_shown():
    shown = {(page.parent / target).resolve() for page in EVERY_PAGE for _, target in links(page)}
    pictures = {path for path in (ROOT / "docs" / "pictures").rglob("*") if path.suffix in (".png", ".svg", ".gif")}
    assert pictures and pictures <= shown


def test_the_reference_names_every_public_name_once():
    page = (ROOT / "docs" / "api" / "index.md").read_text(encoding="utf-8")
    named = [line.strip() for line in page.splitlines() if line.startswith("   ") and line.strip().isidentifier()]
    assert sorted(named) == sorted(set(named)) == sorted(raceway.__all__)


def test_the_citation_has_the_version_and_the_licence():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version: {raceway.__version__}\n" in citation and "license: MIT\n" in citation


@pytest.mark.parametrize(
    ("shell", "says"), [("bash", "complete -o"), ("zsh", "#compdef raceway"), ("fish", "complete --no-files")]
)
def test_the_shell_completes_as_the_page_of_commands_says(shell, says):
    page = (ROOT / "docs" / "command_line.md").read_text(encoding="utf-8")
    assert f"_RACEWAY_COMPLETE={shell}_source raceway" in page
    assert says in completion(f"{shell}_source")


def test_completion_knows_commands():
    assert "plain,plan\n" in completion("bash_complete", COMP_WORDS="raceway pl", COMP_CWORD="1")


@pytest.mark.parametrize(("begun", "completed"), [
    ("bearing.pres", {"bearing.preset"}),
    ("bearing.preset=B7206", {"bearing.preset=B7206C", "bearing.preset=B7206E"}),
    ("contact.kind=h", {"contact.kind=hertz"}), ("supports.tilt=", {"supports.tilt=locked", "supports.tilt=free"}),
    ("load.axail", set()),
])  # fmt: skip
def test_keys_and_their_words_are_completed(begun, completed):
    lines = completion("zsh_complete", COMP_WORDS=f"raceway run --set {begun}", COMP_CWORD="3").splitlines()
    assert completed <= set(lines) and all(line.startswith(begun) for line in lines[1::3])
    assert bool(completed) == any(lines)


def completion(instruction: str, **words: str) -> str:
    """What the program tells a shell."""
    return CliRunner().invoke(main, [], env={"_RACEWAY_COMPLETE": instruction, **words}).stdout
