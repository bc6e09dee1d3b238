"""The code on the pages is run: files are written out, plug-ins in them and in examples checked, other code executed in order."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from checks.validation.command_line import invoke
from raceway import scene_from_dict
from raceway.extend import Registry, read_toml, run, scene_schema
from raceway.testing import check

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "plugins.md"
EXAMPLES = ROOT / "examples" / "plugins"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
FILES = {match.group(1): text for _, text in BLOCKS if (match := re.match(r"# (\S+\.(?:py|toml))\n", text))}
FILES |= {path.name: path.read_text(encoding="utf-8") for path in EXAMPLES.glob("*.py")}
#: Each runs in a scene in test_every_kind.py, or in the tests below.
DEAR = [
    f"{n}.py" for n in ["trapezoidal", "power_law", "radial_balls", "pressure_ratio", "damped", "pulse", "three_harmonics"]
]
PLUGINS = [name for name, text in FILES.items() if re.search(r"@(rw\.)?hookimpl", text)]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Every file of the page and the examples, written out."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_page_has_what_the_tests_look_for():
    assert {"power_law.py", "scene.toml", "test_power.py", "watcher.py"} <= set(FILES)
    assert {language for language, _ in BLOCKS} <= {"python", "toml", "console", "text"}


def test_a_law_written_from_the_page_is_short_conforms_and_runs_in_a_scene(folder):
    lines = [line for line in FILES["power_law.py"].splitlines() if line.strip()]
    assert len(lines) < 40
    registry = Registry(third_party=False)
    (entry,) = registry.load_file(folder / "power_law.py")
    conformity = check(entry)
    assert conformity.conforms, [row for row in conformity.rows if not row.good]
    tables = read_toml(folder / "scene.toml")
    power = run(scene_from_dict(tables, registry), registry)
    hertz = run(scene_from_dict({**tables, "contact": {"kind": "hertz"}}, registry), registry)
    same = run(scene_from_dict({**tables, "contact": {"kind": "power", "exponent": 1.5}}, registry), registry)
    assert power.to_dict()["environment"]["plugins"][0]["distribution"] == "power_law.py"
    # With n = 1.5 it is Hertz, to the rounding of its factor and the steps' tolerance of 1e-9.
    z = hertz.identification.dynamic_stiffness
    assert abs(same.identification.dynamic_stiffness - z) < 1e-7 * abs(z)
    # Calibrated at the static load a force that grows as delta^1.2 has about 1.2 / 1.5 of the stiffness across the races.
    assert 0.75 < power.identification.equivalent_stiffness / hertz.identification.equivalent_stiffness < 0.95


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in DEAR)) for name in PLUGINS])
def test_every_plugin_on_the_page_conforms(folder, name):
    registry = Registry(third_party=False)
    for entry in registry.load_file(folder / name):
        conformity = check(entry)
        assert conformity.conforms, [row for row in conformity.rows if not row.good]


def test_every_example_is_on_a_page():
    pages = PAGE.read_text(encoding="utf-8") + (ROOT / "docs" / "plugin_kinds.md").read_text(encoding="utf-8")
    assert all(f"examples/plugins/{path.name}" in pages for path in EXAMPLES.glob("*.py"))


def test_the_other_blocks_run_in_order(folder, capsys):
    namespace = {}
    for language, text in BLOCKS:
        if language == "python" and not re.match(r"# \S+\.py\n", text):
            exec(compile(text, "plugins.md", "exec"), namespace)
    told = capsys.readouterr().out
    assert "N/m" in told and "passed" in told


@pytest.mark.slow
def test_the_test_file_on_the_page_passes(folder):
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_power.py"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    assert done.returncode == 0, done.stdout


def test_the_watcher_sees_a_run(folder):
    registry = Registry(third_party=False)
    registry.load_file(folder / "watcher.py")
    tables = {**read_toml(folder / "scene.toml"), "contact": {"kind": "hertz"}}
    run(scene_from_dict(tables, registry), registry)
    (watcher,) = [p for p in registry.manager.get_plugins() if hasattr(p, "seen")]
    assert watcher.seen[0] == "plan" and watcher.seen[-1] == "finished" and "chunk" in watcher.seen


def test_the_page_for_assistants_runs_and_knows_the_commands(monkeypatch, tmp_path):
    page = (ROOT / "docs" / "skill.md").read_text(encoding="utf-8")
    assert len(page.splitlines()) <= 300
    monkeypatch.chdir(ROOT)
    names: dict[str, object] = {}
    for block in re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        exec(block, names)
    for command in re.findall(r"^\| `raceway (\w+) ", page, re.MULTILINE):
        assert invoke(command, "--help").exit_code == 0, command
    keys = re.findall(r"^\| `(\w+\.\w+)`", page, re.MULTILINE)
    properties = scene_schema()["properties"]
    for table, key in (path.split(".") for path in keys):
        assert key in str(properties[table]), f"{table}.{key}"
