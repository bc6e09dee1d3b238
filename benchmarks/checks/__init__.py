"""Checks of robustness that take minutes: ``python -m benchmarks.checks [NAME...]`` prints their rows; CONTRIBUTING keeps a number of each.

fuzz                  scenes that nobody would write, made from the schema, and calls with wrong arguments
damage                stores and caches that were damaged
signals               commands that are asked to end, or killed
dask                  workers that are killed, unfit or silent
pages                 pages in a real browser
extremes              what runs at the edges say of errors that are not estimated, or larger than Z
"""

from __future__ import annotations

from pkgutil import iter_modules


def names() -> list[str]:
    """Names of all checks."""
    return sorted(module.name for module in iter_modules(__path__) if not module.name.startswith("_"))
