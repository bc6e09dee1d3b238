"""Packages that are installed and whose system libraries are not: one line that installs them, exit code 2."""

import re

import pytest

from raceway.plugins.system_libraries import DEBIAN
from tests.hidden_libraries import hide
from validation.command_line import EXAMPLES, raceway

ROOT = EXAMPLES.parent


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


@pytest.mark.parametrize("words", [("view",), ("mesh", "--picture", "--set", "mesh.element_size=3e-3")])
def test_pictures_without_libraries_are_refused_before_anything_is_computed(words, bare, tmp_path):
    command, *rest = words
    done = raceway(command, str(EXAMPLES / "b7206_elastic_coarse.toml"), *rest, "--out", str(tmp_path / "out"), **bare)
    told(done, "pyvista")
    assert not (tmp_path / "out").exists()


def test_the_mesher_gmsh_without_libraries(bare, tmp_path):
    scene = tmp_path / "scene.toml"
    ring = ROOT / "raceway/data/meshes/ring.brep"
    scene.write_text(
        f'[bearing]\npreset = "B7206C"\n[mesh]\nkind = "gmsh"\ninner_ring = "{ring}"\nscale = 1e-3\nelement_size = 2e-3\n'
    )
    told(raceway("mesh", str(scene), "--out", str(tmp_path / "out"), **bare), "gmsh")


def test_the_makefile_installs_what_the_messages_name():
    line = re.search(r"^APT_PACKAGES := (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)[1].split()
    assert {name for names in DEBIAN.values() for name in names} <= set(line)
