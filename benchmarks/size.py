"""``python -m benchmarks.size [--tree FOLDER]``: size of the package, what its smallest run touches, how its folders depend on
each other.

``validation.size`` says how its numbers are counted.
"""

from __future__ import annotations

import argparse
import inspect
import json
import os
import subprocess
import sys
import threading
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

_HERE = Path(__file__).resolve().parents[1]
_SCENE = _HERE / "examples" / "minimal.toml"


def smallest_run() -> dict[str, int]:
    """Files and functions that the smallest run enters, modules that it imports and their lines; in a process of its own."""
    import raceway

    root, entered = Path(raceway.__file__).parent, set[CodeType]()

    def profile(frame: FrameType, event: str, argument: Any) -> None:
        if event == "call":
            entered.add(frame.f_code)

    threading.setprofile(profile)
    sys.setprofile(profile)
    raceway.run(_SCENE)
    sys.setprofile(None)
    # Bodies of modules and classes run when they are imported: no functions, and not optimised.
    ours = [code for code in entered if root in Path(code.co_filename).parents and code.co_flags & inspect.CO_OPTIMIZED]
    files = {Path(module.__file__) for module in list(sys.modules.values()) if getattr(module, "__file__", None)}
    imported = [path for path in files if root in path.parents]
    return {
        "files entered": len({code.co_filename for code in ours}),
        "functions entered": len(ours),
        "modules imported": len(imported),
        "lines of modules imported": sum(path.read_text(encoding="utf-8").count("\n") for path in imported),
    }


def arrows() -> dict[str, list[str]]:
    """Folder or module at the top of the package -> those that it imports, annotations apart; in a process of its own."""
    import grimp

    graph = grimp.build_graph("raceway", exclude_type_checking_imports=True, cache_dir=None)
    top = {module: (module.split(".") + [""])[1] for module in graph.modules}
    imported: dict[str, set[str]] = {name: set() for name in top.values() if name}
    for module, name in top.items():
        if name:
            imported[name] |= {top[other] for other in graph.find_modules_directly_imported_by(module)} - {name, ""}
    return {name: sorted(others) for name, others in sorted(imported.items())}


def circles(imported: dict[str, list[str]]) -> list[list[str]]:
    """Groups of folders that depend on each other."""
    reached = {name: set(others) for name, others in imported.items()}
    for middle in imported:
        for name in imported:
            if middle in reached[name]:
                reached[name] |= reached[middle]
    groups = {frozenset(other for other in reached[name] if name in reached[other]) for name in reached}
    return sorted(sorted(group) for group in groups if group)


def in_tree(tree: Path, what: str) -> Any:
    """What a function of this file returns in a new process that imports the package of a work tree."""
    words = [sys.executable, str(Path(__file__).resolve()), "--print", what]
    done = subprocess.run(words, cwd=tree, env={**os.environ, "PYTHONPATH": str(tree)}, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.size", description=__doc__.partition("\n\n")[0])
    parser.add_argument("--tree", type=Path, default=_HERE, metavar="FOLDER", help="another work tree")
    parser.add_argument("--print", choices=("smallest_run", "arrows"), help=argparse.SUPPRESS)
    options = parser.parse_args(words)
    if options.print:
        print(json.dumps(globals()[options.print]()))
        return 0
    from validation import size

    tree = options.tree.resolve()
    modules = size.sources(tree)
    measures = size.measures(modules)
    for name in ("package", *sorted(set(measures) - {"package"}, key=lambda name: -measures[name]["lines"])):
        _show(name, measures[name])
    in_tree(tree, "smallest_run")  # compiles and keeps the kernels
    _show("raceway.run('examples/minimal.toml')", in_tree(tree, "smallest_run"))
    imported = in_tree(tree, "arrows")
    groups = circles(imported)
    _show("imports between folders", {"arrows": sum(map(len, imported.values())), "circles": len(groups)})
    for group in groups:
        print(f"    {', '.join(group)}")
    return 0


def _show(name: str, numbers: dict[str, float]) -> None:
    print(f"{name:40}" + "  ".join(f"{number:g} {word.replace('_', ' ')}" for word, number in numbers.items()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
