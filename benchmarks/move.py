"""``python -m benchmarks.move OLD.py NEW.py ...``: modules moved, or merged where two go to one, and all references rewritten.

References are imports, dotted names in strings and documents, and paths.  A plan is a JSON file of ``{"move": {old: new}, "merge":
{old: new}}`` (``--plan``).  In a merged file a module follows those that it imports; names that two of them define are refused.
What a program cannot decide is printed: names of modules in strings of their own, and aliases of names that come together.
"""

from __future__ import annotations

import argparse
import ast
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import attrs

#: Kinds of files in which references are rewritten.
TEXTS = (".py", ".toml", ".md", ".json", ".cfg", ".yml", ".tmpl", ".txt", "")


def dotted(path: str) -> str:
    """``raceway/core/jit.py`` -> ``raceway.core.jit``; of a package's ``__init__.py``, the package."""
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


@attrs.frozen
class Part:
    """A module as the pieces that a merge puts together."""

    name: str
    docstring: str
    imports: list[str]
    body: str
    defines: frozenset[str]
    needs: frozenset[str]

    @classmethod
    def read(cls, name: str, text: str) -> Part:
        tree, lines = ast.parse(text), text.splitlines(keepends=True)
        docstring, imports, taken = "", [], set[int]()
        for k, node in enumerate(tree.body):
            of_docstring = k == 0 and isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            if of_docstring or isinstance(node, ast.Import | ast.ImportFrom):
                piece = "".join(lines[node.lineno - 1 : node.end_lineno])
                taken |= set(range(node.lineno - 1, node.end_lineno or node.lineno))
                if of_docstring:
                    docstring = piece
                else:
                    imports.append(piece)
        body = "".join(line for k, line in enumerate(lines) if k not in taken).strip("\n") + "\n"
        needs = {node.module or "" for node in tree.body if isinstance(node, ast.ImportFrom)}
        return cls(name, docstring, imports, body, frozenset(defined(tree)), frozenset(needs))


def defined(tree: ast.Module) -> Iterator[str]:
    """Names that a module binds at its top level, imports apart."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        for target in getattr(node, "targets", [getattr(node, "target", None)]):
            yield from (part.id for part in ast.walk(target) if isinstance(part, ast.Name)) if target else ()


def merged(parts: list[Part]) -> str:
    """One module of several; the first gives the docstring.

    Raises
    ------
    ValueError
        Two define one name, or import each other.
    """
    owner: dict[str, str] = {}
    for part in parts:
        for name in sorted(part.defines):
            if owner.setdefault(name, part.name) != part.name:
                raise ValueError(f"{owner[name]} and {part.name} both define `{name}`: rename one first")
    by_name = {part.name: part for part in parts}
    order = TopologicalSorter({part.name: part.needs & by_name.keys() - {part.name} for part in parts}).static_order()
    bodies = [by_name[name].body for name in order]
    imports = [line for part in parts for line in part.imports]
    future = [line for line in imports if "__future__" in line][:1]
    rest = [line for line in imports if "__future__" not in line]
    return "\n".join([parts[0].docstring, *future, "".join(dict.fromkeys(rest)), *bodies])


@attrs.frozen
class References:
    """Rewrites references by a table of dotted names; ``modules`` are all that exist."""

    names: dict[str, str]
    modules: frozenset[str]

    def rewritten(self, text: str, python: bool) -> str:
        if python:
            text = self._parents(text)

        def new(match: re.Match[str]) -> str:
            # The longest module that the name begins with: a package is not what lies in it.
            words = match[0].split(".")
            for k in range(len(words), 0, -1):
                if (module := ".".join(words[:k])) in self.modules:
                    return ".".join([self.names.get(module, module), *words[k:]])
            return match[0]

        roots = "|".join(sorted({re.escape(name.partition(".")[0]) for name in self.names}))
        text = re.sub(rf"(?<![\w./])(?:{roots})(?:\.[A-Za-z_]\w*)+", new, text)
        for old, now in self.names.items():
            text = re.sub(rf"(?<![\w.-]){re.escape(old.replace('.', '/'))}\.py\b", now.replace(".", "/") + ".py", text)
        return text

    def _parents(self, text: str) -> str:
        """``from package import module``: another package, or another name of the module."""
        lines = text.splitlines(keepends=True)
        for node in reversed([node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]):
            moved = [alias for alias in node.names if f"{node.module}.{alias.name}" in self.names]
            if not moved:
                continue
            indent = lines[node.lineno - 1][: node.col_offset]
            stay = [ast.unparse(alias) for alias in node.names if alias not in moved]
            new = [f"{indent}from {node.module} import {', '.join(stay)}\n"] if stay else []
            for alias in moved:
                parent, _, name = self.names[f"{node.module}.{alias.name}"].rpartition(".")
                shown = alias.asname or alias.name
                new.append(f"{indent}from {parent} import {name}{'' if shown == name else f' as {shown}'}\n")
            lines[node.lineno - 1 : node.end_lineno] = new
        return "".join(lines)


def within(text: str, module: str) -> str:
    """Without the imports of a module from itself, which a merge leaves."""
    lines, tree = text.splitlines(keepends=True), ast.parse(text)
    for node in reversed([node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module == module]):
        renamed = [f"{alias.asname} = {alias.name}" for alias in node.names if alias.asname not in (None, alias.name)]
        if renamed:
            print(f"{module}: look at the aliases of names that came together: {', '.join(renamed)}")
        lines[node.lineno - 1 : node.end_lineno] = [
            f"{lines[node.lineno - 1][: node.col_offset]}{line}\n" for line in renamed
        ]
    return "".join(lines)


def move(root: Path, moves: dict[str, str]) -> None:
    """Move and merge files below ``root``, a git repository, and rewrite all tracked files.

    Raises
    ------
    ValueError
        A name would be defined twice; nothing is changed then.
    """
    tracked = _git(root, "ls-files").splitlines()
    modules = frozenset(dotted(path) for path in tracked if path.endswith(".py"))
    targets: dict[str, list[str]] = {}
    for old, new in moves.items():
        targets.setdefault(new, [new] if new in tracked and new not in moves else []).append(old)
    texts = {}
    for new, sources in targets.items():
        parts = [Part.read(dotted(path), (root / path).read_text(encoding="utf-8")) for path in sources]
        texts[new] = merged(parts) if len(parts) > 1 else (root / sources[0]).read_text(encoding="utf-8")
    references = References({dotted(old): dotted(new) for old, new in moves.items()}, modules)
    for new, sources in targets.items():
        (root / new).parent.mkdir(parents=True, exist_ok=True)
        if new != sources[0]:
            _git(root, "mv", "-f", sources[0], new)
        for old in sources[1:]:
            _git(root, "rm", "-q", "-f", "--cached", old)
            (root / old).unlink()
        (root / new).write_text(texts[new], encoding="utf-8")
        _git(root, "add", new)
    for path in _git(root, "ls-files").splitlines():
        file = root / path
        if file.suffix in TEXTS and file.is_file():
            text = file.read_text(encoding="utf-8")
            now = references.rewritten(text, file.suffix == ".py")
            if path in targets:
                now = within(now, dotted(path))
            if now != text:
                file.write_text(now, encoding="utf-8")
            if file.suffix == ".py" and file.parent.as_posix() in {(root / old).parent.as_posix() for old in moves}:
                for old in moves:
                    if (root / old).parent == file.parent and f'"{Path(old).stem}"' in now:
                        print(f'{path}: look at the string "{Path(old).stem}"')


def _git(root: Path, *words: str) -> str:
    return subprocess.run(["git", *words], cwd=root, check=True, capture_output=True, text=True).stdout


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.move", description=(__doc__ or "").partition("\n\n")[2])
    parser.add_argument("paths", nargs="*", help="old and new path of a module, by turns")
    parser.add_argument("--plan", type=Path, help='a JSON file of {"move": {old: new}, "merge": {old: new}}')
    options = parser.parse_args(words)
    moves = dict(zip(options.paths[::2], options.paths[1::2], strict=True))
    if options.plan:
        plan = json.loads(options.plan.read_text(encoding="utf-8"))
        moves |= plan.get("move", {}) | plan.get("merge", {})
    root = Path(__file__).resolve().parents[1]
    try:
        move(root, moves)
    except ValueError as why:
        print(why, file=sys.stderr)
        return 2
    subprocess.run([sys.executable, "-m", "ruff", "check", "-q", "--fix", "--select", "I", "."], cwd=root, check=False)
    subprocess.run([sys.executable, "-m", "ruff", "format", "-q", "."], cwd=root, check=False)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
