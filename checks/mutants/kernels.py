"""Compiled kernels of the sources without a fault, for the trial of a fault that does not touch them.

The cache has a folder for each state of the core's sources, and a fault is another state: all would be compiled anew, which takes
longer than the tests.  A kernel is compiled from the names in its statement, those in the statements that make them, and so on; the
others are carried over, also to another place.
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
def _statements(path: Path) -> list[tuple[range, set[str], set[str]]]:
    """Lines of each statement of a file, the names that it makes, and those that it mentions, with their modules'."""
    module, source = _module(path), path.read_text(encoding="utf-8")
    tree, found = ast.parse(source), []
    origin: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            origin |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            origin |= {alias.asname: alias.name for alias in node.names if alias.asname}
    for top in tree.body:
        nodes = list(ast.walk(top))
        names = [node for node in nodes if isinstance(node, ast.Name)]
        mentioned = {origin.get(node.id, f"{module}.{node.id}") for node in names}
        for node in nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in origin:
                mentioned.add(f"{origin[node.value.id]}.{node.attr}")
        if isinstance(top, (ast.FunctionDef, ast.ClassDef)):
            made = {top.name}
        elif isinstance(top, (ast.Import, ast.ImportFrom)):
            made = {alias.asname or alias.name for alias in top.names}
            mentioned |= {origin[name] for name in made if name in origin}
        elif isinstance(top, (ast.Assign, ast.AnnAssign)):
            made = {node.id for node in names if isinstance(node.ctx, ast.Store)}
        else:  # a loop or a call, which registers what every function of the file may use
            made = {part.name for part in tree.body if isinstance(part, (ast.FunctionDef, ast.ClassDef))}
            made |= {node.id for node in nodes if isinstance(node, ast.Name)}
        first = min([top.lineno, *(node.lineno for node in getattr(top, "decorator_list", ()))])
        found.append((range(first, (top.end_lineno or first) + 1), {f"{module}.{name}" for name in made}, mentioned))
    return found


@cache
def _users() -> dict[str, set[str]]:
    """Names -> the names whose statements mention them."""
    found: dict[str, set[str]] = {}
    for name, place in _places().items():
        found.setdefault(f"{place}.{name.rpartition('.')[2]}", set()).add(name)
    for path in _sources():
        if path.is_relative_to(ROOT / "tests") and "@jit" not in path.read_text(encoding="utf-8"):
            continue  # a fifth of the time
        for _, made, mentioned in _statements(path):
            for name in mentioned:
                found.setdefault(name, set()).update(made)
    return found


def touched(fault: Fault) -> set[str]:
    """Names that the faulty statement makes and those made of them, also through others."""
    path, found = ROOT / fault.file, set[str]()
    start = path.read_text(encoding="utf-8").partition(fault.was)[0].count("\n") + 1
    lines = set(range(start, start + 1 + fault.was.strip("\n").count("\n")))
    more = {n for there, made, _ in (_statements(path) if path.suffix == ".py" else ()) if lines & set(there) for n in made}
    while more:
        found |= more
        more = set().union(*(_users().get(name, ()) for name in more)) - found
    return found


def folder_of(sources: Path) -> str:
    """numba's folder for the kernels of a folder of sources: another for each place."""
    return f"{sources.name}_{hashlib.sha1(str(sources).encode()).hexdigest()}"


def kept(places: dict[Path, Path], fault: Fault | None = None) -> list[tuple[str, str]]:
    """Kernels that a fault leaves as they are: the folder of their sources, and each file.

    places : roots of equal sources, and the folder of the kernels of each
    """
    stale = touched(fault) if fault else set()
    found = {}
    for sources in {path.parent for path in _sources()}:
        part = sources.relative_to(ROOT)
        for place, folder in places.items():
            for path in (folder / folder_of(place / part)).glob("*.nb[ic]"):
                stem, name = path.name.partition("-")[0].split(".")[:2]
                if f"{_module(sources / stem)}.{name}" not in stale:
                    found[part, path.name] = str(part), str(path)
    return list(found.values())


def carry_over(kernels: list[tuple[str, str]]) -> None:
    """Link files of kernels into this process's cache; of faulty sources, whose key is part of the digest that every file needs."""
    from raceway.storage.kernel_cache import DIGEST, current_folder, digest, make

    make(current_folder())
    for part, old in kernels:
        new = current_folder() / folder_of(Path.cwd() / part) / Path(old).name
        new.parent.mkdir(exist_ok=True)
        if not new.exists():
            new.symlink_to(old)
            new.with_name(new.name + DIGEST).write_text(digest(new), encoding="ascii")
