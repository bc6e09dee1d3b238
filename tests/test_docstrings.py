"""Docstrings of the package name what is there."""

from __future__ import annotations

import builtins
import re

import pytest

import raceway
from validation.size import ROOT, sources

MODULES = sources()
WORDS = {module.path.as_posix(): module.words for module in MODULES}
#: In a docstring: ``word``, ``module.name``.
NAME = re.compile(r"``([A-Za-z_]\w*(?:\.\w+)*)``")
#: Of other programs, columns of tables, meshes that users name.
FOREIGN = {"nohup", "Dw_mm", "ball_0"}
#: A line of a package's docstring, ``name, name  words``, or what follows in it: ``;  name: words``.
ENTRY = re.compile(r"^((?:\w+, )*\w+)(?=  +\S)|;  ((?:\w+, )*\w+):", re.MULTILINE)


def missing(name: str) -> bool:
    """Whether ``raceway.module.thing`` does not exist."""
    parts = name.split(".")[1:]
    for count in range(len(parts), -1, -1):
        for path in ("/".join(parts[:count]) + ".py", "/".join([*parts[:count], "__init__.py"])):
            if path in WORDS:
                return not set(parts[count:]) <= {*WORDS[path], *(raceway.__all__ if count == 0 else ())}
    return True


def test_names_in_docstrings_are_there():
    known = set().union(*WORDS.values(), dir(builtins), raceway.__all__, FOREIGN)
    names = [
        (module.path.as_posix(), name) for module in MODULES for text in module.docstrings for name in NAME.findall(text)
    ]
    assert len(names) > 1000
    gone = [
        (path, name)
        for path, name in names
        if (missing(name) if name.startswith("raceway.") else not set(name.split(".")) <= known)
    ]
    assert gone == []


@pytest.mark.parametrize(
    "module", [module for module in MODULES if module.path.name == "__init__.py"], ids=lambda module: str(module.path)
)
def test_a_package_lists_no_module_that_is_gone(module):
    listed = {name for heads in ENTRY.findall(module.docstrings[0]) for name in "".join(heads).split(", ")}
    present = {entry.stem for entry in (ROOT / "raceway" / module.path).parent.iterdir()} | set(raceway.__all__)
    assert listed - present == set()
