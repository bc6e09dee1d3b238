"""How the code is built: ``python -m checks.structure [--gate]`` prints what a newcomer must read, borders, circles, fragments, names.

``--gate``, called by ``make lint``: the measures that are held alone, exit code 1 where one is passed.
"""

import argparse
import ast
import json
import os
import re
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from checks.robustness import Row, below

ROOT = Path(__file__).resolve().parents[1]
#: What one reads to follow a scene to its K: path of files below raceway/, as regular expressions.  CONTRIBUTING says how much.
MUST_READ = re.compile(
    r"\w+\.py|framework/\w+\.py|scene/(?!catalogue|designation).*|(planning|bodies|integrators|contact_laws)/.*"
    r"|plugins/(excitations/.*|identifiers\.py|bodies/rigid\.py)|core/(\w+\.py|ring/\w+\.py|(contact|time)/.*|periodic/(?!branch|special).*)"
    r"|core/ring/kernels/(layout|rigid_\w+|tangential|__init__)\.py"
    r"|pipeline/(?!gradient|warm).*"
)
_IRREGULAR = {
    "found", "made", "kept", "told", "given", "taken", "held", "shown", "drawn", "known", "said", "seen", "done", "met",
    "built", "chosen", "written", "sent", "lost", "sought", "thought", "brought", "caught", "meant", "felt", "dealt",
    "driven", "broken", "spoken", "worn", "torn", "begun", "fed", "grown", "hidden", "laid", "led", "lent", "lit", "paid",
    "rid", "ridden", "risen", "shut", "slid", "spent", "stood", "struck", "sunk", "swung", "thrown", "understood", "won",
    "come", "gone", "become", "forgotten", "frozen", "bent", "hung",
}  # fmt: skip
_NOUNS = {"speed", "seed", "need", "feed", "shed"}
#: What plug-ins import, beside ``raceway`` itself.
_DOORS = {"raceway.extend", "raceway.testing", "raceway.ross"}
EXAMPLES = {"raceway_hunt_crossley"}
_BRANCH = re.compile(r"(?:bodies|integrator|identifier|contact|excitation)\.(?:name|kind) ?(?:==|!=|in|not in) ?[\(\"\']")
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_SMALLEST = """
import contextlib, io, json, sys
sys.argv = ["raceway", "run", "examples/minimal.toml", "--out", sys.argv[1]]
from raceway.cli.main import main
with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
    main()
print(json.dumps([module.__file__ for name, module in sys.modules.items() if name.startswith("raceway") and getattr(module, "__file__", None)]))
"""


@cache
def trees(*folders: str) -> dict[str, ast.Module]:
    """Path from the root -> syntax tree of every Python file below the folders."""
    files = (path for folder in folders for path in sorted(ROOT.glob(f"{folder}/**/*.py")))
    return {path.relative_to(ROOT).as_posix(): ast.parse(path.read_text(encoding="utf-8")) for path in files}


@cache
def product() -> dict[str, ast.Module]:
    return {name: tree for name, tree in trees("raceway", "packages").items() if "/tests/" not in name}


def tests() -> dict[str, ast.Module]:
    return trees("tests", "checks", "packages/*/tests")


def third_parties() -> dict[str, ast.Module]:
    """Examples, and the templates of new plug-ins with any name in the places that are filled in."""
    templates = (ROOT / "raceway/data/templates").glob("*/*.py.txt")
    return trees("examples") | {
        path.relative_to(ROOT).as_posix(): ast.parse(re.sub(r"\$\{\w+\}", "name", path.read_text(encoding="utf-8")))
        for path in templates
    }


def lines(names: Iterator[str] | list[str] | dict[str, ast.Module]) -> int:
    return sum((ROOT / name).read_text(encoding="utf-8").count("\n") for name in names)


def functions() -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    for name, tree in product().items():
        yield from ((name, node) for node in ast.walk(tree) if isinstance(node, _FUNCTIONS))


def used_once() -> list[str]:
    """Functions whose name occurs once beside their definition."""
    uses: Counter[str] = Counter()
    for tree in product().values():
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                uses[node.id] += 1
            elif isinstance(node, ast.Attribute):
                uses[node.attr] += 1
            elif isinstance(node, ast.Import | ast.ImportFrom):
                uses.update(alias.name.split(".")[-1] for alias in node.names)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < 60:
                uses[node.value] += 1
    return [f"{path}: {f.name}" for path, f in functions() if uses[f.name] == 1 and not f.name.startswith("__")]


def participles() -> tuple[int, int, Counter[str]]:
    """Names that are one participle, and all names, by their occurrences where they are bound."""
    names: Counter[str] = Counter()
    for tree in product().values():
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                names[node.id] += 1
            elif isinstance(node, ast.arg):
                names[node.arg] += 1
            elif isinstance(node, (*_FUNCTIONS, ast.ClassDef)):
                names[node.name] += 1
    for word in ("self", "cls", "_"):
        del names[word]
    single = Counter({name: n for name, n in names.items() if _is_participle(name.strip("_"))})
    return single.total(), names.total(), single


def _is_participle(word: str) -> bool:
    regular = word.endswith("ed") and len(word) > 3 and word not in _NOUNS
    return word.islower() and "_" not in word and (regular or word in _IRREGULAR)


def meanings() -> list[str]:
    """Top-level names of functions and classes that more than three files define."""
    places: defaultdict[str, set[str]] = defaultdict(set)
    for path, tree in product().items():
        for node in tree.body:
            if isinstance(node, (*_FUNCTIONS, ast.ClassDef)):
                places[node.name].add(path)
    duties = {"compute", "build", "run", "main", "plugin"}  # a plug-in's or a command's own word for the same thing
    hooks = ("raceway_", "__")
    return sorted(
        f"{name} {len(at)}"
        for name, at in places.items()
        if len(at) > 3 and name not in duties and not name.startswith(hooks)
    )


def imports(path: str, tree: ast.Module) -> Iterator[str]:
    """Files of the product that a file imports, those for annotations and within functions too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                yield from _file_of(f"{node.module}.{alias.name}") or _file_of(node.module)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                yield from _file_of(alias.name)


def _file_of(module: str) -> list[str]:
    head, _, rest = module.partition(".")
    folder = head if head == "raceway" else f"packages/{head.replace('_', '-')}/{head}"
    for name in (f"{folder}/{rest.replace('.', '/')}.py", f"{folder}/{rest.replace('.', '/')}/__init__.py"):
        if rest and name in product():
            return [name]
    return []


def circles() -> list[list[str]]:
    """Files that import each other, directly or through others."""
    files = list(product())
    place = {name: i for i, name in enumerate(files)}
    arrows = {(place[name], place[b]) for name, tree in product().items() for b in imports(name, tree) if b != name}
    ends = np.array(sorted(arrows)).T
    count, label = connected_components(
        coo_array((np.ones(ends.shape[1]), tuple(ends)), shape=(len(files),) * 2), connection="strong"
    )
    groups: list[list[str]] = [[] for _ in range(count)]
    for name, group in zip(files, label, strict=True):
        groups[group].append(name)
    return [group for group in groups if len(group) > 1]


def climbs() -> list[str]:
    """Imports that run against the order of the folders of raceway/, those for annotations too."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    layers = next(c["layers"] for c in settings["tool"]["importlinter"]["contracts"] if c["name"] == "Imports run one way")
    floor = {folder.strip(): -level for level, names in enumerate(layers) for folder in names.split("|")}
    arrows = set()
    for name, tree in trees("raceway").items():
        for other in imports(name, tree):
            a, b = (path.split("/")[1].removesuffix(".py") for path in (name, other))
            if a != b and a in floor and b in floor and floor[b] >= floor[a]:
                arrows.add(f"{a} -> {b}")
    return sorted(arrows)


def foreign(files: dict[str, ast.Module]) -> tuple[set[str], list[str]]:
    """Modules below ``raceway`` that files import beside ``raceway.extend``, ``raceway.testing`` and ``raceway.errors``; private names."""
    modules, private = set(), []
    for path, tree in files.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and re.match(r"raceway[._]", node.module or ""):
                modules.add(node.module or "")
                private += [f"{path}: {a.name}" for a in node.names if a.name.startswith("_") and a.name != "__version__"]
    return modules, private


def beside_their_own() -> set[str]:
    """Modules of raceway that tests and checks import: beside raceway.core in its tests, and a package's modules in its tests."""
    modules = set()
    for path, tree in tests().items():
        own = "raceway.core" if path.startswith("tests/core/") else path.split("/")[1].replace("-", "_")
        modules |= {name for name in foreign({path: tree})[0] - EXAMPLES if not f"{name}.".startswith(f"{own}.")}
    return modules


def smallest_run() -> list[str]:
    """Files of raceway and its packages that ``raceway run examples/minimal.toml`` imports."""
    with TemporaryDirectory() as folder:
        words = [sys.executable, "-c", _SMALLEST, folder]
        own = os.pathsep.join(map(str, (ROOT, *ROOT.glob("packages/*"))))  # before those that another clone installed
        done = subprocess.run(
            words, cwd=ROOT, env=os.environ | {"PYTHONPATH": own}, stdout=subprocess.PIPE, check=True, text=True
        )
    return [Path(name).relative_to(ROOT).as_posix() for name in json.loads(done.stdout.splitlines()[-1])]


def held() -> list[Row]:
    """Measures that lint holds."""
    single, names, words = participles()
    once = used_once()
    long = [f"{path}: {f.name}" for path, f in functions() if (f.end_lineno or 0) - f.lineno >= 80]
    packages = {path: tree for path, tree in product().items() if path.startswith("packages/")}
    deep = {module for module in foreign(packages)[0] if module.startswith("raceway.") and module != "raceway.extend"}
    beside = {module for module in foreign(third_parties())[0] if module.startswith("raceway.")} - _DOORS
    branches = [path for path in trees("raceway") if _BRANCH.search((ROOT / path).read_text(encoding="utf-8"))]
    rings, up, meant = circles(), climbs(), meanings()
    return [
        below("functions whose name occurs once beside their definition", len(once), 600),
        below("names that are one participle [%]", round(100.0 * single / names, 2), 2.0, ", ".join(w for w, _ in words.most_common(8))),
        below("functions over 80 lines", len(long), 0, "; ".join(long)),
        below("modules of raceway that packages import beside raceway.extend", len(deep), 0, ", ".join(sorted(deep))),
        below("modules of raceway that examples and templates import beside its doors", len(beside), 0, ", ".join(sorted(beside))),
        below("branches on the name of a plug-in in raceway/", len(branches), 0, ", ".join(branches)),
        below("circles of files, annotations counted", len(rings), 0, "; ".join(" ".join(ring) for ring in rings)),
        below("folders' imports that run back up, annotations counted", len(up), 0, "; ".join(up)),
        below("top-level names with more than three meanings", len(meant), 0, ", ".join(meant)),
    ]  # fmt: skip


def aims() -> list[Row]:
    """Measures that are printed beside their aims."""
    raceway, small = trees("raceway"), smallest_run()
    must = [name for name in raceway if MUST_READ.fullmatch(name.removeprefix("raceway/"))]
    _, private = foreign(tests())
    return [
        below("raceway/: lines", lines(raceway), 60_000), below("raceway/: files", len(raceway), 265),
        below("files over 400 lines", sum(lines([name]) > 400 for name in product()), 0),
        below("lines that the smallest run imports", lines(small), 16_000, f"{len(small)} files"),
        below("lines that a newcomer must read", lines(must), 25_000, f"{len(must)} files"),
        below("raceway and packages: lines", lines(product()), 79_000),
        below("tests and checks: lines", lines(tests()), 48_000),
        below("modules of raceway that tests and checks import, beside their own", len(beside_their_own()), 80),
        below("private names that tests and checks import", len(private), 0),
    ]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m checks.structure", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--gate", action="store_true", help="the measures that are held, alone")
    parser.add_argument("--list", choices=["once", "participles", "circles"], help="what is counted, by name")
    arguments = parser.parse_args()
    if arguments.list:
        listed = {
            "once": used_once,
            "participles": lambda: [f"{w} {n}" for w, n in participles()[2].most_common()], "circles": circles,
        }  # fmt: skip
        print(*listed[arguments.list](), sep="\n")
        return 0
    gate = held()
    for entry in gate if arguments.gate else [*gate, *aims()]:
        print(f"{'yes' if entry.ok else 'NO':4}{entry.quantity}: {entry.value} ({entry.limit}) {entry.note}")
    return 0 if all(entry.ok for entry in gate) else 1


if __name__ == "__main__":
    sys.exit(main())
