"""``new_plugin`` writes packages that pass their own tests, and refuses names and folders that cannot be used."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from raceway import PluginError
from raceway.framework.contracts import KINDS
from raceway.testing.scaffold import new_plugin


@pytest.mark.parametrize("kind", KINDS)
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
    folders = [new_plugin(kind, f"fresh_{kind}", tmp_path) for kind in KINDS]
    root = str(Path(__file__).parents[1])
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([root, *map(str, folders)])}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--import-mode=importlib", "-rA"]
    done = subprocess.run([*command, str(tmp_path)], capture_output=True, text=True, env=env, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout
    for kind in KINDS:
        assert f"raceway-fresh-{kind.replace('_', '-')}/tests/test_plugin.py" in done.stdout


@pytest.mark.parametrize(
    ("kind", "name", "reason"),
    [
        ("law", "good", r"no kind of plug-in named 'law'.*contact_law, excitation"),
        ("contact_law", "Hertz 2", "a letter first; for instance 'hertz'"),
        ("contact_law", "2nd", "a letter first; for instance 'nd'"),
        ("contact_law", "", "a letter first$"),
        ("contact_law", "../evil", "for instance 'evil'"),
        ("contact_law", "a__b", "for instance 'a_b'"),
        ("contact_law", "x" * 41, "2 to 40"),
        ("contact_law", "class", "a word of Python"),
        ("contact_law", "hertz", "there is a contact law 'hertz' already, of raceway"),
    ],
)
def test_what_cannot_be_used_is_refused(tmp_path, kind, name, reason):
    with pytest.raises(PluginError, match=reason):
        new_plugin(kind, name, tmp_path)
    assert not list(tmp_path.iterdir())


def test_an_existing_folder_is_not_overwritten(tmp_path):
    folder = new_plugin("report", "again", tmp_path)
    (folder / "README.md").write_text("mine")
    with pytest.raises(PluginError, match="exists already and is not overwritten"):
        new_plugin("report", "again", tmp_path)
    assert (folder / "README.md").read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(PluginError, match="cannot be written"):
        new_plugin("report", "again", tmp_path / "file")
