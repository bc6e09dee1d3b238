"""Compiled kernels of the sources without a fault, for the trial of a fault that does not touch them.

The cache has a folder for each state of the core's sources, and a fault is another state: all would be compiled anew, which takes
longer than the tests.  What a kernel was compiled from is its file and what that imports; the rest is carried over.
"""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

from checks.mutants.faults import ROOT

#: Run in the faulty sources, whose key is part of the digest that every file of a kernel needs: links beside new digests.
_CARRY = """
import os, sys
from pathlib import Path
from raceway.storage.kernel_cache import current_folder, make
from raceway.storage.kernel_cache import _DIGEST, _digest
folder = current_folder()
make(folder)
for line in sys.stdin.read().splitlines():
    old = Path(line)
    new = folder / old.parent.name / old.name
    new.parent.mkdir(exist_ok=True)
    if not new.exists():
        os.link(old, new)
        new.with_name(new.name + _DIGEST).write_text(_digest(new), encoding="ascii")
"""


def _module(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _places() -> dict[str, str]:
    """Names that ``raceway`` and ``raceway.extend`` hand out -> the modules that define them."""
    found = {}
    for door, stub in (("raceway", "names"), ("raceway.extend", "extend")):
        for node in ast.parse((ROOT / "raceway" / f"{stub}.pyi").read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                found |= {f"{door}.{alias.name}": f"raceway.{node.module}" for alias in node.names}
    return found


@cache
def _imported() -> dict[Path, set[str]]:
    """The modules, and names taken from modules, that each file of the sources imports."""
    found: dict[Path, set[str]] = {}
    places = _places()
    for path in [path for name in ("raceway", "packages", "tests", "checks") for path in (ROOT / name).rglob("*.py")]:
        names = found.setdefault(path, set())
        more: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
        while more:  # statements alone, a fifth of all nodes
            node = more.pop()
            more += [one for part in ("body", "orelse", "handlers", "finalbody") for one in getattr(node, part, ())]
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                names.add(node.module)
                names.update(f"{node.module}.{alias.name}" for alias in node.names)
        names |= {places[name] for name in names if name in places}
    return found


def touched(file: str) -> set[Path]:
    """A file of the sources and all that import it, also through others."""
    found: set[Path] = set()
    more = {ROOT / file}
    while more:
        found |= more
        names = {_module(path) for path in more}
        more = {path for path, imported in _imported().items() if names & imported} - found
    return found


def carry_over(good: Path, place: Path, file: str, environment: dict[str, str]) -> None:
    """Link the kernels in ``good`` that a fault in ``file`` leaves as they are into the cache of the faulty sources at ``place``."""
    stale = {(path.parent.name, path.stem) for path in touched(file)}
    kept = [
        path
        for path in sorted(good.glob("kernels/*/*/*.nb[ic]"))
        if (path.parent.name.rpartition("_")[0], path.name.partition(".")[0]) not in stale
    ]
    subprocess.run(
        [sys.executable, "-c", _CARRY], cwd=place, env=environment, input="\n".join(map(str, kept)), text=True, check=True
    )
