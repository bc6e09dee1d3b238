"""The command line in tests: in this process, or as a user starts it, with plug-ins that look installed."""

import json
import os
import subprocess
import sys
from pathlib import Path
from textwrap import dedent
from typing import Any

from click.testing import CliRunner, Result

from raceway.cli.main import main

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
#: Bearings of the catalogue with a file of their own.
PRESETS = EXAMPLES.parent / "raceway" / "data" / "bearings"
ARTICLE, MINIMAL = str(EXAMPLES / "b7206.toml"), str(EXAMPLES / "minimal.toml")
#: A mesh of a second.
COARSE = ("--set", "mesh.kind=structured", "--set", "mesh.element_size=2e-3", "--set", "mesh.nodes_per_semi_axis=1")
#: A study of the article far from resonances, so that a run takes milliseconds.
SMALL_ARTICLE = (
    *("--bodies", "rigid", "--speeds", "11000,13000,15000", "--axial", "1600,1800,2000"),
    *("--friction", "0", "--processes", "0", "--no-pictures"),
)


#: After which a process is taken as hung [s]: none is judged by it, and one that compiles on a busy machine takes minutes.
PATIENCE_S = 600.0


def invoke(*words: Any) -> Result:
    """A command in this process; nothing but an exit may leave it."""
    found = CliRunner().invoke(main, [str(word) for word in words])
    assert found.exception is None or isinstance(found.exception, SystemExit), found.exception
    assert "Traceback" not in found.output
    return found


def raceway(*words: Any, cwd: Any = None, **environment: Any) -> subprocess.CompletedProcess[str]:
    """A command in a process of its own."""
    return python("-m", "raceway", *words, cwd=cwd, **environment)


#: Commands one after another, in one process.
_SEVERAL = """
import json, sys
from click.testing import CliRunner
from raceway.cli.main import main
found = [CliRunner().invoke(main, words) for words in json.loads(sys.argv[1])]
print(json.dumps([[one.exit_code, one.stdout, one.stderr] for one in found]))
"""


def several(commands: list[list[str]], **environment: Any) -> list[tuple[int, str, str]]:
    """Exit code, output and errors of each of several commands in a process of their own, whose start takes as long as many."""
    done = python("-c", _SEVERAL, json.dumps(commands), **environment)
    assert done.returncode == 0, done.stderr
    return [(code, out, err) for code, out, err in json.loads(done.stdout)]


def python(*words: Any, cwd: Any = None, **environment: Any) -> subprocess.CompletedProcess[str]:
    """A Python process; keywords become environment variables."""
    variables = {**os.environ, **found_on(environment.get("PYTHONPATH", "")), **{k: str(v) for k, v in environment.items()}}
    command = [sys.executable, *(str(word) for word in words)]
    return subprocess.run(command, capture_output=True, text=True, env=variables, cwd=cwd, timeout=PATIENCE_S, check=False)


def found_on(path: object) -> dict[str, str]:
    """Environment in which the plug-ins of the distributions on a path are loaded, and no others."""
    folders = [Path(folder) for folder in str(path).split(os.pathsep) if folder]
    return {"RACEWAY_PLUGINS": ",".join(info.name.partition("-")[0] for f in folders for info in f.glob("*.dist-info"))}


def install(folder: Path, name: str, code: str, entry: str | None = None) -> Path:
    """A folder for PYTHONPATH with a module and the metadata of an installed distribution around it."""
    (folder / f"{name}.py").write_text(dedent(code), encoding="utf-8")
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[raceway]\n{entry or name} = {name}\n", encoding="utf-8")
    return folder


LAW = '''
from typing import ClassVar

import attrs

from raceway import hookimpl


@attrs.frozen
class Law:
    """A law of a test."""

    name: ClassVar[str] = "{name}"
    discretisations: ClassVar[frozenset[str]] = frozenset({{"resultant"}})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False

    def build(self, pairs):
        return pairs.hertz_factor[:, None].copy()

    def kernel(self):
{kernel}


@hookimpl
def raceway_contact_laws():
    return [Law]
'''


def law(name: str, kernel: str = "return None") -> str:
    """Source of a contact law with the body of its ``kernel()``."""
    body = "\n".join(f"        {line}" for line in dedent(kernel).strip().splitlines())
    return LAW.format(name=name, kernel=body)
