"""System libraries: tests that need them, and commands that name what installs them."""

import re
from pathlib import Path

import pytest
from raceway_meshing import gmsh
from raceway_view import system_libraries

from checks.validation.command_line import EXAMPLES, python, raceway
from checks.validation.system_libraries import NEEDS, install_line
from tests.hidden_libraries import hide

ROOT = EXAMPLES.parent
DEBIAN = {"gmsh": gmsh.DEBIAN, "pyvista": system_libraries.DEBIAN}
FILE = "import pytest\n\n" + "\n\n".join(f'@pytest.mark.needs("{name}")\ndef test_{name}():\n    pass\n' for name in NEEDS)


def collected(folder: Path, **environment):
    """What pytest says of a test for each need, in an environment."""
    path = folder / "test_each_need.py"
    path.write_text(FILE)
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "checks.validation.system_libraries", "-c"]
    return python(*words, ROOT / "pyproject.toml", path, cwd=ROOT, **{"CI": "", "RACEWAY_TEST_ALL": ""} | environment)


def test_on_a_bare_machine_they_are_skipped_with_one_closing_line(tmp_path):
    done = collected(tmp_path, **hide(tmp_path))
    assert done.returncode == 0, done.stdout
    assert re.search(rf"^{len(NEEDS)} skipped", done.stdout, re.MULTILINE)
    (line,) = [line for line in done.stdout.splitlines() if "NOT TESTED" in line]
    assert f"{len(NEEDS)} tests were skipped" in line and line.endswith(install_line())
    assert all(f"{called} (1)" in line for called, _ in NEEDS.values())


@pytest.mark.parametrize("variable", [{"CI": "true"}, pytest.param({"RACEWAY_TEST_ALL": "1"}, marks=pytest.mark.slow)])
def test_where_everything_is_tested_a_missing_library_is_a_failure(tmp_path, variable):
    done = collected(tmp_path, **hide(tmp_path), **variable)
    assert done.returncode == 1
    assert re.search(rf"^{len(NEEDS)} (failed|errors)", done.stdout, re.MULTILINE), done.stdout
    assert install_line() in done.stdout and "NOT TESTED" not in done.stdout


@pytest.mark.needs("gmsh", "pyvista", "browser", "ccx")
@pytest.mark.slow
def test_with_all_libraries_nothing_is_skipped(tmp_path):
    done = collected(tmp_path)
    assert done.returncode == 0 and f"{len(NEEDS)} passed" in done.stdout and "NOT TESTED" not in done.stdout


@pytest.fixture
def bare(tmp_path):
    """The environment of a machine without libraries for drawing."""
    return hide(tmp_path)


def told(done, package):
    """The error of a command that ended with code 2 and one message that installs what ``package`` lacks."""
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert f"{package} is installed but lacks system libraries" in " ".join(done.stderr.split())
    assert f"apt-get install -y --no-install-recommends {' '.join(DEBIAN[package])}" in " ".join(done.stderr.split())
    assert "pip install" not in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "words",
    [("view",), pytest.param(("view", "--mesh", "--picture", "--set", "mesh.element_size=3e-3"), marks=pytest.mark.slow)],
)
def test_pictures_without_libraries_are_refused_before_anything_is_computed(words, bare, tmp_path):
    command, *rest = words
    done = raceway(command, str(EXAMPLES / "b7206_elastic_coarse.toml"), *rest, "--out", str(tmp_path / "out"), **bare)
    told(done, "pyvista")
    assert not (tmp_path / "out").exists()


def test_the_mesher_gmsh_without_libraries(bare, tmp_path):
    scene = tmp_path / "scene.toml"
    ring = ROOT / "packages/raceway-meshing/raceway_meshing/data/meshes/ring.brep"
    scene.write_text(
        f'[bearing]\npreset = "B7206C"\n[mesh]\nkind = "gmsh"\ninner_ring = "{ring}"\nscale = 1e-3\nelement_size = 2e-3\n'
    )
    told(raceway("view", "--mesh", str(scene), "--out", str(tmp_path / "out"), **bare), "gmsh")


def test_the_makefile_installs_what_the_messages_name():
    line = re.search(r"^APT_PACKAGES := (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)[1].split()
    assert {name for names in DEBIAN.values() for name in names} <= set(line)
