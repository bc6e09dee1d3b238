"""The package as a user installs it: names, extras, data files; folders of the repository: what they import, what they list."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import distribution, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import raceway

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_one_version_everywhere():
    assert PROJECT["version"] == raceway.__version__ == distribution("raceway").version
    assert f"## {raceway.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_all_holds_every_extra_but_ross_and_docs():
    extras = PROJECT["optional-dependencies"]
    named = re.search(r"\[(.*)\]", extras["all"][0])
    assert named is not None
    assert set(named[1].split(",")) == set(extras) - {"all", "ross", "docs"}


def test_the_base_installation_draws_and_meshes_nothing():
    base = [line for line in requires("raceway") or [] if "extra ==" not in line]
    heavy = {"matplotlib", "pyvista", "gmsh", "meshio", "xarray", "dask", "pyamg", "trame"}
    assert not {re.split(r"[<>=!~ \[;]", line)[0].lower() for line in base} & heavy


def test_every_version_of_the_constraints_is_one_that_the_project_allows():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = {}
    for line in lines:
        if not line.startswith("#"):
            found = re.fullmatch(r"([a-z0-9-]+)==([0-9][\w.]*)( ; .*)?", line)
            assert found, f"not NAME==VERSION: {line}"
            pins[found[1]] = found[2]
    extras = PROJECT["optional-dependencies"]
    asked = [Requirement(text) for name in extras if name != "ross" for text in (*PROJECT["dependencies"], *extras[name])]
    for requirement in asked:
        if requirement.name != "raceway":
            assert requirement.specifier.contains(pins[canonicalize_name(requirement.name)]), requirement


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Names of the files of a wheel built from this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return zipfile.ZipFile(next(folder.glob("*.whl"))).namelist()


def test_the_wheel_holds_code_data_and_licence(wheel):
    here = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "raceway").rglob("*")
        if path.suffix in (".py", ".toml", ".json", ".css", ".js", ".html")
    }
    assert here <= set(wheel)
    assert any(name.endswith("licenses/LICENSE") for name in wheel)
    assert not [name for name in wheel if name.startswith(("tests/", "benchmarks/", "validation/", "docs/"))]


def test_the_readme_scene_runs():
    scene = tomllib.loads((ROOT / "README.md").read_text(encoding="utf-8").partition("```toml\n")[2].partition("```")[0])
    assert scene == tomllib.loads((ROOT / "examples" / "minimal.toml").read_text(encoding="utf-8"))
    raceway.scene_from_dict(scene)


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
