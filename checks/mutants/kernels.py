"""Compiled kernels of the sources without a fault, for the trial of a fault that does not touch them.

The cache has a folder for each state of the core's sources, and a fault is another state: all would be compiled anew, which takes
longer than the tests.  What a kernel was compiled from is its file and what that imports; the rest is carried over, also to another place.
"""

import ast
import hashlib
from functools import cache
from pathlib import Path

from checks.mutants.faults import ROOT, Fault


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
def _sources() -> list[Path]:
    return [path for name in ("raceway", "packages", "tests", "checks") for path in (ROOT / name).rglob("*.py")]


@cache
def _imported() -> dict[Path, set[str]]:
    """The modules, and names taken from modules, that each file of the sources imports."""
    found: dict[Path, set[str]] = {}
    places = _places()
    for path in _sources():
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


@cache
def touched(file: str) -> set[Path]:
    """A file of the sources and all that import it, also through others."""
    found: set[Path] = set()
    more = {ROOT / file}
    while more:
        found |= more
        names = {_module(path) for path in more}
        more = {path for path, imported in _imported().items() if names & imported} - found
    return found


def folder_of(sources: Path) -> str:
    """numba's folder for the kernels of a folder of sources: another for each place."""
    return f"{sources.name}_{hashlib.sha1(str(sources).encode()).hexdigest()}"


def kept(places: dict[Path, Path], fault: Fault | None = None) -> list[tuple[str, str]]:
    """Kernels that a fault leaves as they are: the folder of their sources, and each file.

    places : roots of equal sources, and the folder of the kernels of each
    """
    stale = touched(fault.file) if fault else set()
    found = {}
    for sources in {path.parent for path in _sources()}:
        part = sources.relative_to(ROOT)
        for place, folder in places.items():
            for path in (folder / folder_of(place / part)).glob("*.nb[ic]"):
                if sources / f"{path.name.partition('.')[0]}.py" not in stale:
                    found[part, path.name] = str(part), str(path)
    return list(found.values())


def carry_over(kernels: list[tuple[str, str]]) -> None:
    """Link files of kernels into this process's cache; of faulty sources, whose key is part of the digest that every file needs."""
    from raceway.storage.kernel_cache import _DIGEST, _digest, current_folder, make

    make(current_folder())
    for part, old in kernels:
        new = current_folder() / folder_of(Path.cwd() / part) / Path(old).name
        new.parent.mkdir(exist_ok=True)
        if not new.exists():
            new.symlink_to(old)
            new.with_name(new.name + _DIGEST).write_text(_digest(new), encoding="ascii")
