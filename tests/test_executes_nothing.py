"""A scene that was downloaded is data: checking it executes nothing that it names, starts no process and writes no file."""

import json
import re
from pathlib import Path

import pytest

from checks.validation.command_line import EXAMPLES, invoke, python
from checks.validation.scenes import built_in
from checks.validation.solids import write
from raceway import load_scene

Gmsh = built_in("mesher", "gmsh")

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
#: Every way out of Python that an audit hook sees; commands start after it is set, one after another, their exit codes are printed.
WATCHED = """
import json, os, sys
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
from raceway.cli.main import main
for words in json.loads(sys.argv[1]):
    sys.argv = ["raceway", *words]
    code = 0
    try:
        main()
    except SystemExit as end:
        code = end.code or 0
    print("code", code, file=sys.stderr)
"""


def watched(*commands, **environment):
    """Exit codes of commands in one process, and what it did beside."""
    found = python("-c", WATCHED, json.dumps([list(map(str, words)) for words in commands]), **environment)
    assert found.returncode == 0, found.stderr
    return [int(code) for code in re.findall(r"^code (\d)$", found.stderr, re.MULTILINE)], found.stderr


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
    (tmp_path / "part.geo").write_text(trap(tmp_path, "geo"))
    (tmp_path / "part.geo.opt").write_text(trap(tmp_path, "geo.opt"))
    for suffix in (".step", ".brep", ".geo"):
        (tmp_path / f"{suffix[1:]}.toml").write_text(SCENE.format(file=f"part{suffix}"))
    return tmp_path


@pytest.mark.needs("gmsh")
def test_check_and_plan_execute_nothing(traps):
    before = sorted(traps.iterdir())
    environment = {"PYTHONDONTWRITEBYTECODE": 1, "RACEWAY_CACHE_DIR": traps / "cache"}
    commands = [(command, traps / f"{kind}.toml") for kind in ("step", "brep", "geo") for command in ("check", "plan")]
    codes, told = watched(*commands, cwd=traps, **environment)
    assert codes == [0, 0, 0, 0, 2, 2] and "WATCHED" not in told
    assert sorted(traps.iterdir()) == before


def test_the_watch_sees_a_process_and_a_file(tmp_path):
    """The test above can fail: the same watch sees what a run does."""
    codes, told = watched(("run", EXAMPLES / "minimal.toml", "--out", tmp_path / "out"), cwd=tmp_path)
    assert codes == [0] and "WATCHED os.mkdir" in told and "WATCHED open" in told


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize("suffix", [".step", ".brep"])
def test_meshing_reads_no_options_beside_a_file(traps, suffix):
    mesh = Gmsh(inner_ring=str(traps / f"part{suffix}"), scale=1e-3, element_size=2e-3).mesh(BEARING)["inner_ring"]
    assert mesh.volume() == pytest.approx(480e-9, rel=1e-9)
    assert not list(traps.glob("PWNED*"))


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize("command", [("run",), ("view", "--mesh")])
def test_a_script_is_refused(traps, command):
    refused = invoke(*command, traps / "geo.toml", "--out", traps / "out")
    assert refused.exit_code == 2 and "reads .step, .stp, .brep, not '.geo'" in refused.stderr
    assert not list(traps.glob("PWNED*"))
