"""Size of the package by its sources.

public_names counts functions and classes at the top of modules without a leading underscore, public_constants what is assigned there.
vague_percent counts bindings: names that are assigned (also by ``for``, ``with`` and in comprehensions) and parameters of functions,
``self``, ``cls`` and ``_`` apart; ``VAGUE`` lists pronouns and participles, which name no quantity and no thing.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

import attrs

ROOT = Path(__file__).resolve().parents[1]
VAGUE = frozenset({
    "found", "one", "own", "given", "told", "tells", "known", "whole", "rest", "kept", "place", "that", "there", "said", "asked", "wanted",
    "chosen", "some", "other", "others", "many", "such", "what", "which", "this", "those", "done", "made", "taken", "seen", "left", "like",
})  # fmt: skip
#: A function that no screen shows in full [lines]; one that nobody calls without a look at its head [arguments].
_LONG, _MANY = 60, 7
_HIDDEN = ("self", "cls", "_")

Function = ast.FunctionDef | ast.AsyncFunctionDef
#: Part of the package -> measure -> number.
Measures = dict[str, dict[str, float]]


@attrs.frozen
class Source:
    """A module: its path below the package's folder, text and syntax tree."""

    path: Path
    text: str
    tree: ast.Module

    @property
    def lines(self) -> int:
        return self.text.count("\n")

    @property
    def folder(self) -> str:
        """Folder at the top of the package; empty for a module beside them."""
        return self.path.parts[0] if len(self.path.parts) > 1 else ""

    @property
    def docstrings(self) -> list[str]:
        """Of the module, its classes and functions."""
        nodes = [node for node in ast.walk(self.tree) if isinstance(node, ast.Module | ast.ClassDef | Function)]
        return [text for node in nodes if (text := ast.get_docstring(node, clean=False))]

    @property
    def words(self) -> set[str]:
        """Names in the code, of the module itself too, and words of strings that are no docstrings."""
        words, documents = set(self.path.with_suffix("").parts), set(self.docstrings)
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                words |= set() if node.value in documents else set(re.findall(r"\w+", node.value))
            else:
                names = [getattr(node, field, None) for field in ("id", "attr", "arg", "name")]
                words |= {word for name in names if isinstance(name, str) for word in name.split(".")}
        return words


def sources(tree: Path = ROOT) -> list[Source]:
    """All modules of ``raceway`` in a work tree."""
    paths, root = sorted((tree / "raceway").rglob("*.py")), tree / "raceway"
    texts = [(path.relative_to(root), path.read_text(encoding="utf-8")) for path in paths]
    return [Source(path, text, ast.parse(text)) for path, text in texts]


def measures(modules: list[Source]) -> Measures:
    """The numbers of the package and, the first four of them, of each folder at its top."""
    nodes = [node for module in modules for node in ast.walk(module.tree)]
    functions = [node for node in nodes if isinstance(node, Function)]
    top = [node for module in modules for node in module.tree.body]
    package = {
        **_numbers(modules),
        "public_constants": sum(not name.startswith("_") for node in top for name in _assigned(node)),
        "functions_over_60_lines": sum((node.end_lineno or 0) - node.lineno >= _LONG for node in functions),
        "functions_over_7_arguments": sum(_arguments(node) > _MANY for node in functions),
        "any": sum(isinstance(node, ast.Name) and node.id == "Any" for node in nodes),
        "files_with_equivalent_stiffness": sum("equivalent_stiffness" in module.text for module in modules),
    }
    folders = {
        name or "beside the folders": _numbers([module for module in modules if module.folder == name])
        for name in sorted({module.folder for module in modules})
    }
    return {"package": package, **folders}


def _numbers(modules: list[Source]) -> dict[str, float]:
    """Lines, files, public names and percent of vague names of some modules."""
    names = (name for module in modules for node in ast.walk(module.tree) if (name := _bound(node)) and name not in _HIDDEN)
    bound, top = Counter(names), [node for module in modules for node in module.tree.body]
    return {
        "lines": sum(module.lines for module in modules),
        "files": len(modules),
        "public_names": sum(isinstance(node, ast.ClassDef | Function) and not node.name.startswith("_") for node in top),
        "vague_percent": round(100.0 * sum(bound[name] for name in VAGUE) / max(bound.total(), 1), 2),
    }


def _bound(node: ast.AST) -> str:
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        return node.id
    return node.arg if isinstance(node, ast.arg) else ""


def _assigned(node: ast.stmt) -> list[str]:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return [name for target in targets for part in ast.walk(target) if (name := _bound(part))]


def _arguments(node: Function) -> int:
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    return sum(argument.arg not in _HIDDEN for argument in arguments)
