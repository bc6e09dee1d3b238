"""Writes the package of a new plug-in, which passes its own tests at once.

The templates are package data, ``data/templates/KIND``; a file package_x.py.txt becomes x.py in the package's
folder, tests_x.py.txt a file in tests, the rest stands at the top.
"""

from __future__ import annotations

import keyword
import re
from importlib.resources import files
from pathlib import Path
from string import Template

from raceway import __version__
from raceway.errors import PluginError
from raceway.framework.contracts import KINDS
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry

_NAME = re.compile(r"[a-z][a-z0-9_]{1,39}")


def new_plugin(kind: str, name: str, folder: str | Path = ".", registry: Registry | None = None) -> Path:
    """Write a package ``folder/raceway-NAME`` with one plug-in.

    Parameters
    ----------
    kind : of ``raceway.framework.contracts.KINDS``
    name : the word that a scene will write as ``kind``
    folder : where the package's own folder is made

    Returns
    -------
    Path : the package's folder

    Raises
    ------
    PluginError
        An unknown kind, a name that cannot be used, or a folder that exists; nothing is written then.
    """
    kind = kind.replace("-", "_")
    if kind not in KINDS:
        raise PluginError(f"no kind of plug-in named '{kind}'{nearest(kind, KINDS)}; kinds: {', '.join(KINDS)}")
    if not _NAME.fullmatch(name) or name.endswith("_") or "__" in name:
        fitting = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_0123456789")[:40]
        hint = f"; for instance '{fitting}'" if _NAME.fullmatch(fitting) else ""
        rule = "2 to 40 lower-case letters, digits and single underscores, a letter first"
        raise PluginError(f"'{name}' cannot be a plug-in's name: {rule}{hint}")
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        raise PluginError(f"'{name}' cannot be a plug-in's name: it is a word of Python")
    for entry in (registry or default_registry()).entries.get((kind, name), []):
        raise PluginError(
            f"there is a {kind.replace('_', ' ')} '{name}' already, of {entry.distribution}: choose another name"
        )
    words = {
        "kind": kind,
        "name": name,
        "module": f"raceway_{name}",
        "distribution": f"raceway-{name.strip('_').replace('_', '-')}",
        "cls": "".join(part.capitalize() for part in name.split("_")),
        "title": f"{'An' if kind[0] in 'aeiou' else 'A'} {kind.replace('_', ' ')} '{name}'",
        "hook": KINDS[kind][0],
        "version": ".".join(__version__.split(".")[:2]),
    }
    target = Path(folder) / words["distribution"]
    if target.exists():
        raise PluginError(f"`{target}` exists already and is not overwritten: choose another name or --out DIR")
    contents = {}
    for part in ("common", kind):
        for source in sorted(files("raceway").joinpath("data", "templates", part).iterdir(), key=lambda f: f.name):
            file = source.name.removesuffix(".txt")
            if file.startswith("package_"):
                file = f"{words['module']}/{file.removeprefix('package_')}"
            elif file.startswith("tests_"):
                file = f"tests/{file.removeprefix('tests_')}"
            contents[file] = Template(source.read_text(encoding="utf-8")).substitute(words)
    try:
        for path, text in contents.items():
            (target / path).parent.mkdir(parents=True, exist_ok=True)
            (target / path).write_text(text, encoding="utf-8")
    except OSError as why:
        raise PluginError(f"`{target}` cannot be written: {why.strerror or why}") from why
    return target
