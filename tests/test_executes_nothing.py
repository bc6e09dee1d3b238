"""A scene that was downloaded is data: checking it executes nothing that it names, starts no process and writes no file."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import numpy as np
import pytest

from raceway import load_scene
from raceway.errors import MeshError
from raceway.plugins.meshers import _geo
from raceway.plugins.meshers.gmsh import Gmsh
from raceway.storage import trust
from tests.mesh.solids import RING_SCRIPT, write
from validation.command_line import EXAMPLES, invoke, python, raceway

BEARING = load_scene(EXAMPLES / "minimal.toml").bearing
SCENE = """
[bearing]
preset = "B7206C"
[load]
axial = 1000.0
[bodies]
kind = "elastic"
[mesh]
kind = "gmsh"
inner_ring = "{file}"
scale = 1e-3
element_size = 2e-3
"""
#: Every way out of Python that an audit hook sees; the commands themselves start after it is set.
WATCHED = """
import os, sys
def watch(event, arguments):
    if event in ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.forkpty", "os.startfile", "pty.spawn",
                 "os.mkdir", "os.rename", "os.remove", "os.link", "os.symlink", "os.truncate", "shutil.move", "sqlite3.connect",
                 "socket.connect", "tempfile.mkstemp", "tempfile.mkdtemp"):
        print("WATCHED", event, arguments, file=sys.stderr)
    if event == "open" and isinstance(arguments[2], int):
        writes = arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if writes and arguments[0] != os.devnull:
            print("WATCHED", event, arguments, file=sys.stderr)
sys.addaudithook(watch)
sys.argv = ["raceway", *sys.argv[1:]]
from raceway.__main__ import main
main()
"""


def trap(folder: Path, word: str) -> str:
    """A command of Gmsh's language that leaves a file."""
    return f'SystemCall "id > {folder}/PWNED-{word}";\n'


@pytest.fixture
def traps(tmp_path):
    """Scenes beside files that would execute something, by the ending of what they mesh."""
    for suffix in (".step", ".brep"):
        write(tmp_path / f"part{suffix}", "box")
        for name in (f"part{suffix}.opt", "part.opt"):
            (tmp_path / name).write_text(trap(tmp_path, f"opt{suffix}"))
    (tmp_path / "part.geo").write_text(trap(tmp_path, "geo") + RING_SCRIPT)
    (tmp_path / "part.geo.opt").write_text(trap(tmp_path, "geo.opt"))
    for suffix in (".step", ".brep", ".geo"):
        (tmp_path / f"{suffix[1:]}.toml").write_text(SCENE.format(file=f"part{suffix}"))
    return tmp_path


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize("command", ["check", "plan"])
@pytest.mark.parametrize("kind", ["step", "brep", "geo"])
def test_check_and_plan_execute_nothing(traps, command, kind):
    before = sorted(traps.iterdir())
    environment = {"PYTHONDONTWRITEBYTECODE": 1, "RACEWAY_CACHE_DIR": traps / "cache"}
    found = python("-c", WATCHED, command, traps / f"{kind}.toml", cwd=traps, **environment)
    assert found.returncode == 0, found.stderr
    assert "WATCHED" not in found.stderr
    assert sorted(traps.iterdir()) == before


def test_the_watch_sees_a_process_and_a_file(tmp_path):
    """The test above can fail: the same watch sees what a run does."""
    found = python("-c", WATCHED, "run", EXAMPLES / "minimal.toml", "--out", tmp_path / "out", cwd=tmp_path)
    assert found.returncode == 0, found.stderr
    assert "WATCHED os.mkdir" in found.stderr and "WATCHED open" in found.stderr


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize("suffix", [".step", ".brep"])
def test_meshing_reads_no_options_beside_a_file(traps, suffix):
    mesh = Gmsh(inner_ring=str(traps / f"part{suffix}"), scale=1e-3, element_size=2e-3).mesh(BEARING)["inner_ring"]
    assert mesh.volume() == pytest.approx(480e-9, rel=1e-9)
    assert not list(traps.glob("PWNED*"))


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize("command", ["run", "mesh"])
def test_a_script_is_executed_on_an_explicit_word_only(traps, command):
    refused = invoke(command, traps / "geo.toml", "--out", traps / "out")
    assert refused.exit_code == 2
    assert "`mesh.inner_ring`" in refused.stderr and f"--execute {traps / 'part.geo'}" in refused.stderr
    other = invoke(command, traps / "geo.toml", "--out", traps / "out", "--execute", traps / "other.geo")
    assert other.exit_code == 2
    assert not list(traps.glob("PWNED*"))


@pytest.mark.needs("gmsh")
def test_a_script_that_is_allowed_is_meshed_in_a_child(traps):
    allowed = ["--execute", traps / "part.geo", "--set", "mesh.method=as_written"]
    done = raceway("mesh", traps / "geo.toml", "--out", traps / "out", *allowed, "--json")
    assert done.returncode == 0, done.stderr
    assert (traps / "PWNED-geo").is_file(), "the script was executed"
    body = json.loads(done.stdout)["bodies"]["inner_ring"]
    assert body["elements"] == 4 * 2 * 8


@pytest.mark.needs("gmsh")
def test_named_surfaces_of_a_script_come_back_from_the_child(tmp_path):
    (tmp_path / "ring.geo").write_text(RING_SCRIPT)
    path = str(tmp_path / "ring.geo")
    trust.allow(path)
    ring = Gmsh(inner_ring=path, method="as_written", scale=1e-3).mesh(BEARING)["inner_ring"]
    # Chords of 8 layers of 90 degrees: 2 r sin(pi / 32) each.
    assert ring.facet_areas("bore").sum() == pytest.approx(8e-3 * 8 * 2 * 15e-3 * np.sin(np.pi / 32), rel=1e-12)
    assert len(ring.nodes("outside")) == 5 * 9


@pytest.mark.needs("gmsh")
def test_a_script_gives_the_same_mesh_as_its_solid(tmp_path):
    (tmp_path / "box.geo").write_text('SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 10, 8, 6};\n')
    path = str(tmp_path / "box.geo")
    trust.allow(path)
    script = Gmsh(inner_ring=path, scale=1e-3, element_size=2e-3).mesh(BEARING)["inner_ring"]
    solid = Gmsh(inner_ring=write(tmp_path / "box.brep", "box"), scale=1e-3, element_size=2e-3).mesh(BEARING)["inner_ring"]
    assert np.array_equal(script.cells, solid.cells)
    assert np.allclose(script.points, solid.points, atol=1e-15)


@pytest.mark.needs("gmsh")
def test_a_script_that_does_not_end_is_stopped_with_all_it_started(tmp_path, monkeypatch):
    monkeypatch.setattr(_geo, "LIMIT_S", 3.0)
    (tmp_path / "endless.geo").write_text(f'SystemCall "echo $$ > {tmp_path}/pid; exec sleep 1000";\n')
    path = str(tmp_path / "endless.geo")
    trust.allow(path)
    with pytest.raises(MeshError, match="'endless.geo' was stopped: it had not ended after 3 s"):
        Gmsh(inner_ring=path).mesh(BEARING)
    pid = int((tmp_path / "pid").read_text())
    for _ in range(50):
        if not Path(f"/proc/{pid}").exists():
            break
        time.sleep(0.1)
    else:
        os.kill(pid, 9)
        pytest.fail("the process that the script started still lives")


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Nonsense = = 3;", "cannot be meshed"),
        ("Point(1) = {0, 0, 0};", "holds no solid"),
        (
            'SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1, 1, 1};\nTransfinite Curve {1:12} = 400;\n'
            "Transfinite Surface {1:6};\nRecombine Surface {1:6};\nTransfinite Volume {1};\n",
            r"`mesh.method` = 'as_written': would give about 6.35e\+07 elements",
        ),
    ],
)
def test_what_a_script_makes_is_refused_in_one_message(tmp_path, text, words):
    (tmp_path / "part.geo").write_text(text)
    path = str(tmp_path / "part.geo")
    trust.allow(path)
    with pytest.raises(MeshError, match=words):
        Gmsh(inner_ring=path, method="as_written").mesh(BEARING)
