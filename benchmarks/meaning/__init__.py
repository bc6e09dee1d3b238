"""Answers against what a reader takes them for: one module a subject, each with ``rows()``; report ``meaning`` shows them all.

``python -m benchmarks.meaning [NAME...]`` computes and prints the rows of the modules named, or of all.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from benchmarks.evidence import Row


def names() -> list[str]:
    """Names of all modules with rows."""
    return sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))


def rows_of(name: str) -> list[Row]:
    """The rows of one module, computed now."""
    return import_module(f"{__name__}.{name}").rows()
