"""Packages of third parties: the examples install, conform and run; ``new_plugin`` writes packages that pass their own tests."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from checks.validation.command_line import invoke
from raceway.testing import SUITES

EXAMPLES = Path(__file__).parents[1] / "examples"
PACKAGES = {"third_party_law": "raceway-hunt-crossley", "third_party_excitation": "raceway-two-frequency"}


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder with the packages, installed without a network: their build backend is one of the dev extra."""
    target = tmp_path_factory.mktemp("site")
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation", "--target", str(target)]
    subprocess.run([*pip, *(str(EXAMPLES / name) for name in PACKAGES)], check=True, capture_output=True, text=True)
    return target


def python(installed, code, **environment):
    """What a fresh interpreter with the packages on its path prints, as JSON."""
    root = str(Path(__file__).parents[1])
    inherited = {k: v for k, v in os.environ.items() if not k.startswith("RACEWAY_") or k == "RACEWAY_CACHE_DIR"}
    env = {**inherited, "PYTHONPATH": os.pathsep.join([str(installed), root]), **environment}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=env, cwd=EXAMPLES, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


RUN = """
import json
from raceway import scene_from_dict
from raceway.pipeline.run import run
from raceway.scene.inputs import read_toml

law, force = read_toml("third_party_law/scene.toml"), read_toml("third_party_excitation/scene.toml")
scenes = {
    "law": law,
    "hertz": {**law, "contact": {"kind": "hertz"}},
    "restitution": {**law, "contact": {"kind": "hunt_crossley", "restitution": 0.8}},
    "excitation": force,
    "both": {**force, "contact": {"kind": "hunt_crossley"}},
}
answers = {}
for name, tables in scenes.items():
    result = run(scene_from_dict(tables)).to_dict()
    found = result["identification"]
    answers[name] = {
        "k": found["equivalent_stiffness"], "c": found["equivalent_damping"], "plugins": result["environment"]["plugins"],
    }
print(json.dumps(answers))
"""


def test_both_scenes_run_and_say_whose_plugins_they_used(installed):
    answers = python(installed, RUN)
    owners = {p["kind"]: (p["distribution"], p["version"]) for p in answers["both"]["plugins"]}
    assert owners["contact_law"] == ("raceway-hunt-crossley", "0.1.0")
    assert owners["excitation"] == ("raceway-two-frequency", "0.1.0")
    assert owners["integrator"][0] == "raceway"
    # At rest and deeper than the transition the law is Hertz, and its rate term is in quadrature: K moves by (w C / K)^2.
    assert answers["law"]["k"] == pytest.approx(answers["hertz"]["k"], rel=1e-4)
    assert answers["law"]["c"] > 10.0 * abs(answers["hertz"]["c"])
    assert answers["restitution"]["c"] > 0.0
    # The 2x force moves the 1x line through the contacts' curvature only.
    assert answers["excitation"]["k"] == pytest.approx(answers["hertz"]["k"], rel=0.05)
    assert answers["both"]["c"] > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("name", PACKAGES)
def test_their_own_tests_pass(installed, name):
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(EXAMPLES / name / "tests")]
    done = subprocess.run(words, env={**os.environ, "PYTHONPATH": str(installed)}, cwd=installed, text=True, stdout=subprocess.PIPE, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout


BLOCKED = """
import json
from raceway import load_scene, SceneError
from raceway.framework.loading.registry import default_registry
try:
    load_scene("third_party_law/scene.toml")
    told = ""
except SceneError as error:
    told = str(error)
print(json.dumps([told, default_registry().names("excitation")]))
"""


def test_a_blocked_package_is_missing_by_name(installed):
    told, excitations = python(installed, BLOCKED, RACEWAY_DISABLE="raceway-hunt-crossley")
    assert "`requires.raceway-hunt-crossley` = '>=0.1': is not loaded: the environment variable RACEWAY_DISABLE" in told
    assert "`contact.kind` = 'hunt_crossley': no contact law named 'hunt_crossley'" in told
    assert "two_frequency" in excitations


def test_a_scene_says_how_to_install_what_it_requires(tmp_path):
    told, _ = python(tmp_path, BLOCKED)
    assert "Install it: pip install 'raceway-hunt-crossley>=0.1'" in told


def new_plugin(kind, name, out):
    """The folder that the command writes, or what it says."""
    found = json.loads(invoke("dev", "new-plugin", kind, name, "--out", out, "--json").stdout)
    return Path(found["folder"]) if "folder" in found else found["errors"][0]["message"]


@pytest.mark.parametrize("kind", SUITES)
def test_a_new_package_has_every_part(tmp_path, kind):
    folder = new_plugin(kind, "my_new_one", tmp_path)
    assert folder == tmp_path / "raceway-my-new-one"
    written = {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}
    wanted = {"pyproject.toml", "README.md", "tests/test_plugin.py"}
    assert written >= wanted | {f"raceway_my_new_one/{name}.py" for name in ("__init__", "plugin")}
    project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["raceway"] == {"raceway-my-new-one": "raceway_my_new_one"}
    assert all("${" not in p.read_text() for p in folder.rglob("*") if p.is_file())


@pytest.mark.slow
def test_new_packages_pass_their_own_tests(tmp_path):
    """One process for all kinds, since each start of an interpreter with the kernels costs seconds."""
    folders = [new_plugin(kind, f"fresh_{kind}", tmp_path) for kind in SUITES]
    root = str(Path(__file__).parents[1])
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([root, *map(str, folders)])}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--import-mode=importlib", "-rA"]
    done = subprocess.run([*command, str(tmp_path)], capture_output=True, text=True, env=env, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout
    for kind in SUITES:
        assert f"raceway-fresh-{kind.replace('_', '-')}/tests/test_plugin.py" in done.stdout


@pytest.mark.parametrize(("kind", "name", "reason"), [
    ("law", "good", r"no kind of plug-in named 'law'.*contact_law, excitation"),
    ("contact_law", "Hertz 2", "a letter first; for instance 'hertz'"),
    ("contact_law", "2nd", "a letter first; for instance 'nd'"), ("contact_law", "", "a letter first$"),
    ("contact_law", "../evil", "for instance 'evil'"), ("contact_law", "a__b", "for instance 'a_b'"),
    ("contact_law", "x" * 41, "2 to 40"), ("contact_law", "class", "a word of Python"),
    ("contact_law", "hertz", "there is a contact law 'hertz' already, of raceway"),
])  # fmt: skip
def test_what_cannot_be_used_is_refused(tmp_path, kind, name, reason):
    assert re.search(reason, new_plugin(kind, name, tmp_path), re.MULTILINE)
    assert not list(tmp_path.iterdir())


def test_an_existing_folder_is_not_overwritten(tmp_path):
    folder = new_plugin("quantity", "again", tmp_path)
    (folder / "README.md").write_text("mine")
    assert "exists already and is not overwritten" in new_plugin("quantity", "again", tmp_path)
    assert (folder / "README.md").read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    assert "cannot be written" in new_plugin("quantity", "again", tmp_path / "file")
