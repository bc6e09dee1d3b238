"""Commands: what they print, write and return."""

from __future__ import annotations

import errno
import io
import json
import os
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import attrs
import click
import pytest

from raceway.cli import main
from raceway.commands.inputs import slug
from validation.command_line import ARTICLE, EXAMPLES, MINIMAL, install, invoke, law, python, raceway

HERE = click.Context(main)
COMMANDS = {name: main.get_command(HERE, name) for name in main.list_commands(HERE)}
GROUPS = {
    name: list(one.list_commands(click.Context(one))) for name, one in COMMANDS.items() if isinstance(one, click.Group)
}
#: What a person can run: the sub-commands of a group, not the group.
RUNNABLE = [name for name in COMMANDS if name not in GROUPS] + [
    f"{name} {sub}" for name, subs in GROUPS.items() for sub in subs
]


@pytest.mark.parametrize("command", RUNNABLE)
def test_help_teaches_with_an_example(command):
    found = invoke(*command.split(), "--help")
    assert found.exit_code == 0
    assert f"raceway {command}" in found.stdout.split("Example:")[1]
    assert "--json" in found.stdout
    assert "--debug" in found.stdout
    assert "--verbose" in found.stdout


@pytest.mark.parametrize("command", [*RUNNABLE, "study", ""])
def test_help_fits_80_columns(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert max(map(len, invoke(*command.split(), "--help").stdout.splitlines())) <= 80


@pytest.mark.parametrize("group", [[], ["study"]])
def test_a_group_without_a_command_shows_its_help(group):
    found = invoke(*group)
    assert found.exit_code == 2 and found.stdout == ""
    assert found.stderr == invoke(*group, "--help").stdout


def test_a_hint_stands_on_a_line_of_its_own():
    found = invoke("run")
    assert found.exit_code == 2
    assert found.stderr.splitlines() == [
        "error: Missing argument 'SCENE'.",
        "  try `raceway run --help`, which has an example",
    ]


def test_verbose_leaves_standard_output_to_json(tmp_path):
    found = invoke("run", MINIMAL, "--out", tmp_path, "--json", "-v")
    assert json.loads(found.stdout)["title"] == "minimal"
    told = found.stderr
    for words in (
        "plan: 27 degrees of freedom",
        "kept: centrifugal force of the balls",
        "newmark, 4320 steps",
        "run finished in",
    ):
        assert words in told
    quiet = invoke("run", MINIMAL, "--out", tmp_path, "--json")
    assert quiet.stderr == ""
    from raceway.framework.registry import default_registry

    assert not default_registry().manager.has_plugin("raceway -v")


def test_verbose_tells_of_a_run_that_fails(tmp_path):
    found = invoke("run", MINIMAL, "--set", "load.axial=0", "--out", tmp_path, "-v")
    assert found.exit_code != 0
    assert "run failed: " in found.stderr and "error: " in found.stderr


def test_help_and_version():
    found = invoke("--help")
    assert found.exit_code == 0
    assert all(command in found.stdout for command in COMMANDS)
    assert "Exit codes" in found.stdout
    from raceway import __version__

    assert __version__ in invoke("--version").stdout
    assert {"run", "plan", "check", "compare", "verify", "plugins", "schema", "cache"} <= set(COMMANDS)


def test_the_list_of_commands_says_what_each_says_itself():
    listed = dict(
        line.split(maxsplit=1) for line in invoke("--help").stdout.split("Commands:\n")[1].splitlines() if line[2] != " "
    )
    assert list(listed) == list(COMMANDS)
    for name, one in COMMANDS.items():
        assert one.name == name
        assert one.short_help.startswith(listed[name])


@pytest.fixture(scope="module")
def article(tmp_path_factory):
    """The main job, once: its output and its folder."""
    folder = tmp_path_factory.mktemp("article")
    return invoke("run", ARTICLE, "--out", folder, "--pictures"), folder


def test_run_says_everything_and_writes_the_result(article):
    found, folder = article
    assert found.exit_code == 0, found.stderr
    text = " ".join(found.stdout.split())
    for words in (
        "B7206C, 1 kN axial", "12 balls of 9.525 mm on 46 mm", "all balls, each", "tangent kxx",
        "tangent kyy", "Z real", "Z imaginary", "|Z|", "equivalent stiffness K", "equivalent damping C", "phase lag",
        "orbit", "tilt locked", "secant: 1x force over 1x displacement", "time step", "second run, half as many steps",
        "compiling, apart", "energy drift",
        "left out: tilts (supports.tilt is locked)", f"written: {folder}/result.json",
    ):  # fmt: skip
        assert words in text, words
    result = json.loads((folder / "result.json").read_text())
    k = result["identification"]["equivalent_stiffness"]
    assert f"{1e-6 * k:.5g} N/µm" in text
    assert found.stderr == ""


def test_pictures_are_whole_png_files(article):
    _, folder = article
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["ball-loads.png", "orbit.png", "result.json", "spectrum.png"]
    for path in folder.glob("*.png"):
        content = path.read_bytes()
        assert content.startswith(b"\x89PNG")
        assert content.endswith(b"IEND\xaeB`\x82")


def test_pictures_leave_matplotlib_as_it_was(tmp_path):
    code = f"""
import matplotlib, sys
before = str(matplotlib.rcParams.copy())
from raceway import load_scene
from raceway.framework.registry import default_registry
from raceway.pipeline.run import run
report = default_registry().find("report", "pictures").plugin(dots_per_inch=40)
static = run(load_scene({MINIMAL!r}, ['identifier.kind="tangent"']))
assert [p.name for p in report.write(static, {str(tmp_path)!r})] == ["ball-loads.png"]
assert str(matplotlib.rcParams.copy()) == before
assert "matplotlib.pyplot" not in sys.modules
"""
    found = python("-c", code, DISPLAY="")
    assert found.returncode == 0, found.stderr


def test_pictures_without_matplotlib_name_the_extra(monkeypatch, tmp_path):
    monkeypatch.setattr("raceway.commands.inputs.find_spec", lambda name: None if name == "matplotlib" else find_spec(name))
    found = invoke("run", ARTICLE, "--pictures", "--out", tmp_path)
    assert found.exit_code == 2
    assert "pip install '.[pictures]'" in found.stderr
    assert list(tmp_path.iterdir()) == []


def test_json_is_the_file(tmp_path):
    found = invoke("run", MINIMAL, "--out", tmp_path, "--json")
    assert found.exit_code == 0
    content = json.loads(found.stdout)
    assert content == json.loads((tmp_path / "result.json").read_text())
    assert {"equilibrium", "identification", "error", "cost", "stability", "environment", "plan", "scene"} <= set(content)


def test_a_static_scene_has_no_dynamic_stiffness(tmp_path):
    scene = tmp_path / "static.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n')
    found = invoke("run", scene, "--out", tmp_path / "out", "--set", "supports.tilt=free")
    assert found.exit_code == 0
    assert "static scene" in found.stdout
    assert "kyy tilts follow" in found.stdout
    assert json.loads((tmp_path / "out" / "result.json").read_text())["identification"] is None


def test_the_default_folder_is_the_title_made_safe(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = invoke("run", MINIMAL, "--set", "title=../a b/c", "--set", "identifier.kind=tangent")
    assert found.exit_code == 0
    assert (tmp_path / "raceway-out" / "a-b-c-identifier.kind=tangent" / "result.json").exists()
    assert slug("../..") == "scene"
    names = {slug("x" * 80 + end) for end in ("", "a", "b", "a" * 300)}
    assert len(names) == 4 and all(name.startswith("x" * 80) and len(name) <= 89 for name in names)


def test_a_broken_plug_in_of_a_stranger_does_not_reach_standard_output(tmp_path):
    install(tmp_path, "broken", "raise SystemExit(3)")
    found = raceway("check", MINIMAL, "--json", PYTHONPATH=tmp_path)
    assert found.returncode == 0
    assert json.loads(found.stdout) == {"errors": []}
    assert "fails to import: SystemExit: 3" in found.stderr


def test_plan():
    content = json.loads(invoke("plan", ARTICLE, "--json").stdout)
    assert {"kept", "left_out", "dofs", "time_step_s", "predicted_wall_s"} <= set(content)
    text = invoke("plan", ARTICLE, "--set", "supports.tilt=free").stdout
    for words in ("Kept", "Left out", "supports.tilt lets the ring tilt", "degrees of freedom", "time step", "wall time"):
        assert words in text


def test_check():
    assert json.loads(invoke("check", ARTICLE, "--json").stdout) == {"errors": []}
    assert "no mistakes" in invoke("check", ARTICLE).stdout


def test_plugins():
    content = json.loads(invoke("plugins", "--json").stdout)
    assert content["errors"] == []
    newmark = next(p for p in content["plugins"] if p["name"] == "newmark")
    assert newmark["kind"] == "integrator"
    assert newmark["distribution"] == "raceway"
    gamma = next(option for option in newmark["options"] if option["name"] == "gamma")
    assert gamma["default"] == 0.5
    assert set(gamma) == {"name", "unit", "default", "rule", "help"}
    text = invoke("plugins").stdout
    assert all(plugin["name"] in text for plugin in content["plugins"])


def test_a_third_partys_law_is_listed(tmp_path):
    install(tmp_path, "stranger", law("stranger_law"))
    found = raceway("plugins", PYTHONPATH=tmp_path)
    assert found.returncode == 0
    assert "stranger_law  stranger 1.0" in found.stdout


def test_schema_is_json():
    assert json.loads(invoke("schema").stdout)["$schema"].endswith("2020-12/schema")


def test_cache_is_seen_and_cleared(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    empty = json.loads(invoke("cache", "--json").stdout)
    assert empty["folders"] == []
    for name, size in ((empty["current"], 100), ("older", 7)):
        folder = tmp_path / "kernels" / name / "core"
        folder.mkdir(parents=True)
        (folder / "kernel.1.nbc").write_bytes(b"x" * size)
        (folder / "kernel.nbi").write_bytes(b"x")
    found = json.loads(invoke("cache", "--json").stdout)
    assert [(f["current"], f["kernels"], f["bytes"]) for f in found["folders"]] == [(True, 1, 101), (False, 1, 8)]
    assert "current" in invoke("cache").stdout
    cleared = json.loads(invoke("cache", "--clear", "--json").stdout)
    assert cleared["folders"] == []
    assert not (tmp_path / "kernels").exists()
    assert "the next run compiles" in invoke("cache").stdout


def test_the_light_key_is_the_one_that_kernels_are_kept_under():
    from raceway.core.jit import kernel_folder
    from raceway.storage.cache_folder import current_folder

    folder = kernel_folder()
    assert folder is None or folder.path == current_folder()


def test_compare_writes_table_words_and_picture(tmp_path):
    words = ("--vary", "excitation.kind=unidirectional,bidirectional", "--vary", "supports.tilt=locked,free")
    found = invoke("compare", ARTICLE, *words, "--out", tmp_path)
    assert found.exit_code == 0, found.stderr
    assert "bidirectional" in found.stdout
    assert list(tmp_path.glob("*.png"))
    content = json.loads((tmp_path / "compare.json").read_text())
    assert {"axes", "rows", "effects"} <= set(content)
    assert len(content["rows"]) == 4


def test_verify_passes_and_prints_its_rows():
    found = invoke("verify", "--only", "seed-unbalance", "--json")
    content = json.loads(found.stdout)
    assert found.exit_code == 0
    assert all(row["ok"] for row in content["rows"])
    assert "within their tolerance" in invoke("verify", "--only", "seed-unbalance").stdout


def test_verify_fails_with_code_1(monkeypatch):
    from raceway.studies.verify import study as module

    true = module.verify

    def off(*given, **named):
        done = true(*given, **named)
        return attrs.evolve(done, rows=tuple(attrs.evolve(row, ok=False) for row in done.rows))

    monkeypatch.setattr(module, "verify", off)
    found = invoke("verify", "--only", "seed-unbalance")
    assert found.exit_code == 1
    assert "0 of" in found.stdout


def test_a_folder_that_is_a_file_is_refused_before_anything_is_computed(tmp_path):
    (tmp_path / "file").write_text("")
    found = invoke("run", MINIMAL, "--out", tmp_path / "file" / "deeper")
    assert found.exit_code == 2
    assert found.stdout == ""
    assert "is a file. Choose another with --out" in found.stderr


def test_a_folder_without_permission(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *given: False)
    found = invoke("run", MINIMAL, "--out", tmp_path)
    assert found.exit_code == 2
    assert "no permission" in found.stderr


def full(*_given, **_named):
    """What writing does on a full disk."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("as_json", [False, True])
def test_a_full_disk_costs_the_file_but_not_the_answer(tmp_path, monkeypatch, as_json):
    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    found = invoke("run", MINIMAL, "--set", "identifier.kind=tangent", "--out", tmp_path, *(["--json"] if as_json else []))
    assert found.exit_code == 2
    assert list(tmp_path.iterdir()) == []
    if as_json:
        content = json.loads(found.stdout)
        assert content["identification"]["equivalent_stiffness"] > 0.0
        assert "No space left on device" in content["errors"][0]["message"]
    else:
        assert "equivalent stiffness K" in found.stdout
        assert "No space left on device" in found.stderr


def test_a_full_disk_while_the_last_good_state_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    found = invoke("run", MINIMAL, "--set", "load.axial=0", "--out", tmp_path)
    assert found.exit_code == 1, "the failure of the numbers is what counts"
    assert "nothing loads the bearing" in found.stderr
    assert "the last good state is lost" in found.stderr
    assert "No space left on device" in found.stderr


def test_an_interruption_while_a_file_is_written_leaves_nothing(tmp_path, monkeypatch):
    def stop(self, _content):
        self.touch()
        raise KeyboardInterrupt

    monkeypatch.setattr("pathlib.Path.write_bytes", stop)
    found = invoke("run", MINIMAL, "--set", "identifier.kind=tangent", "--out", tmp_path)
    assert found.exit_code == 130
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_home_and_a_cache_that_cannot_be_written(tmp_path):
    """The table is there all the same; `tangent` compiles the fewest kernels."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    found = raceway(
        "run", MINIMAL, "--set", "identifier.kind=tangent", "--set", "kinematics.ball_inertia=false",
        "--out", tmp_path / "out",
        HOME=blocked / "home", XDG_CACHE_HOME=blocked / "cache", RACEWAY_CACHE_DIR="",
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    assert "equivalent stiffness K" in found.stdout
    assert found.stderr.count("warning: compiled kernels cannot be kept") == 1
    assert "not kept: the cache cannot be written" in " ".join(found.stdout.split())
    assert "RACEWAY_CACHE_DIR" in found.stderr
    assert "Traceback" not in found.stderr


def test_an_installation_that_is_read_only_is_not_written_to(article):
    """Compiled kernels go to the user's cache folder alone, never beside the sources as numba does by itself."""
    import raceway as package

    assert article[0].exit_code == 0
    kernels = [path for path in Path(package.__file__).parent.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert kernels == []


def test_ctrl_c_ends_with_130_and_one_line(tmp_path):
    words = [
        sys.executable,
        "-m",
        "raceway",
        "run",
        MINIMAL,
        "--set",
        "integrator.turns=100",
        "--set",
        "integrator.steps_per_turn=3600000",
        "--out",
        str(tmp_path / "out"),
    ]

    def listen() -> None:  # a background job of a shell has its children ignore the signal
        signal.signal(signal.SIGINT, signal.default_int_handler)

    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, preexec_fn=listen, **streams) as process:
        time.sleep(2.5)  # past the imports, inside the 360 million steps
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    # While a compiled module is being imported (a busy machine gets no further in that time) Python ends by the signal
    # itself after the same message; a shell reports both as 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert out == ""
    assert err.strip() == "stopped by Ctrl-C; no file is left half-written"
    assert not (tmp_path / "out").exists()


def test_a_reader_that_goes_away_is_no_error():
    command = f"{sys.executable} -m raceway schema | head -n 1"
    found = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert found.stdout == "{\n"
    assert found.stderr == ""


def test_progress_is_drawn_on_a_terminal_after_a_second_and_never_elsewhere():
    from rich.console import Console

    from raceway.commands.progress import ProgressBar

    terminal, file = Console(file=io.StringIO(), force_terminal=True, width=80), Console(file=io.StringIO())
    for console, patience in ((terminal, 0.01), (file, 0.01)):
        with ProgressBar("compiling kernels (first run only)", console, patience) as bar:
            time.sleep(0.15)
            bar("newmark, 4320 steps", 2000, 4320)
            time.sleep(0.15)
    drawn = terminal.file.getvalue()
    assert "compiling kernels (first run only)" in drawn
    assert "newmark, 4320 steps" in drawn
    assert file.file.getvalue() == ""
    quick = Console(file=io.StringIO(), force_terminal=True)
    with ProgressBar("starting", quick) as bar:
        bar("newmark", 1, 2)
    assert "newmark" not in quick.file.getvalue()


def test_a_bar_inside_a_bar_says_what_it_does_in_the_outer_one():
    from rich.console import Console

    from raceway.commands.progress import ProgressBar

    file = Console(file=io.StringIO(), force_terminal=True, width=80)
    with ProgressBar("outside", file, 0.01) as bar:
        time.sleep(0.1)
        with ProgressBar("inside", patience=0.01) as inner:
            inner("inside, a half", 1, 2)
            time.sleep(0.15)
        bar("outside again", 1, 1)
        time.sleep(0.15)
    drawn = file.file.getvalue()
    assert drawn.index("outside") < drawn.index("inside, a half") < drawn.index("outside again")


STUDIES = {
    "map": (["study", "map"], "raceway.studies.map.study.study_map", "map-rows.jsonl"),
    "article": (["study", "article"], "raceway.studies.article.study.article", "article-rows.jsonl"),
    "rig": (["study", "rig", str(EXAMPLES / "test_rig.toml")], "raceway.studies.rig.study.study", "rig-rows.jsonl"),
    "stability": (["stability"], "raceway.studies.stability.study.stability", "stability-rows.jsonl"),
    "precision": (["precision", MINIMAL], "raceway.studies.precision.front.study", "precision-rows.jsonl"),
}


@pytest.mark.parametrize("study", STUDIES)
def test_a_study_that_is_stopped_ends_its_bar_before_it_says_so(study, tmp_path, monkeypatch):
    from raceway.commands import frame
    from raceway.commands.progress import ProgressBar

    words, name, kept = STUDIES[study]
    bars = []

    def stopped(*_given, **_named):
        assert ProgressBar._shown is not None
        (tmp_path / kept).write_text("")
        raise KeyboardInterrupt

    monkeypatch.setattr(name, stopped)
    monkeypatch.setattr(frame, "warn", lambda text, **_: bars.append((text, ProgressBar._shown)))
    assert invoke(*words, "--out", tmp_path).exit_code == 130
    ((text, shown),) = bars
    assert "goes on from there" in text and shown is None


def test_examples_are_short():
    lines = [line for line in Path(MINIMAL).read_text().splitlines() if line.strip()]
    assert len(lines) <= 10
