"""What packages and plug-ins build with, beside the names of ``raceway``: answers, scenes, points, pictures and the numerics below.

The stub ``extend.pyi`` lists the names and the modules that define them, where their docstrings are; they are imported when they are
first used.  A package imports ``raceway`` and ``raceway.extend`` alone.

Examples
--------
>>> from raceway.extend import equilibrium_table, number
>>> number(233.894)
'233.9'
"""

import ast
from importlib import import_module
from pathlib import Path

from raceway.core.deferred import DeferredKernel

_STUB = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
_PLACES = {a.name: f"raceway.{node.module}" for node in _STUB.body if isinstance(node, ast.ImportFrom) for a in node.names}

__all__ = sorted(_PLACES)


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module 'raceway.extend' has no attribute '{name}'")
    found = getattr(import_module(_PLACES[name]), name)
    return found() if isinstance(found, DeferredKernel) else found
