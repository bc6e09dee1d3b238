"""Where plug-ins come from: entry points of installed distributions, and one-off files."""

from __future__ import annotations

import hashlib
import os
import sys
import warnings
from importlib.metadata import EntryPoint, entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from traceback import extract_tb
from typing import Any

from raceway.errors import PluginError
from raceway.options import nearest


def chosen_entry_points() -> tuple[list[EntryPoint], list[str]]:
    """The entry points to load, and the names in RACEWAY_PLUGINS that nothing installed has."""
    points = sorted(entry_points(group="raceway"), key=lambda p: (p.name, p.dist.name if p.dist else ""))
    missing: list[str] = []
    exact = os.environ.get("RACEWAY_PLUGINS")
    if exact is not None:
        wanted = _names(exact)
        missing = sorted(wanted - {name for p in points for name in _called(p)})
        points = [p for p in points if wanted & _called(p)]
    blocked = _names(os.environ.get("RACEWAY_DISABLE", ""))
    known = sorted({name for p in entry_points(group="raceway") for name in _called(p)})
    for name in sorted(blocked - set(known)):
        told = f"installed: {', '.join(known)}" if known else "no plug-in is installed"
        warnings.warn(f"RACEWAY_DISABLE names '{name}', which nothing is called{nearest(name, known)}; {told}", stacklevel=2)
    return [p for p in points if not blocked & _called(p)], missing


def _called(point: EntryPoint) -> set[str]:
    """What an entry point may be called: its own name and its distribution's."""
    return {point.name, point.dist.name} if point.dist else {point.name}


def import_file(path: Path) -> tuple[Any, str]:
    """The module of a plug-in file, and a hash of the file; one module for each content.

    Raises
    ------
    PluginError
        A file that is missing or fails to import.
    """
    try:
        content = path.read_bytes()
    except OSError as why:
        raise PluginError(f"plug-in file `{path}`: {why.strerror or why}") from None
    if path.suffix != ".py":
        raise PluginError(f"plug-in file `{path}`: must be a Python file (.py)")
    version = hashlib.sha256(content).hexdigest()[:12]
    name = f"raceway_file_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]}_{version}"
    if name in sys.modules:
        return sys.modules[name], version
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"plug-in file `{path}`: cannot be imported")
    module = module_from_spec(spec)
    sys.modules[name] = module  # attrs looks types up in the module by its name
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as why:  # whatever the file's own code raises
        del sys.modules[name]
        line = next((f", line {f.lineno}" for f in reversed(extract_tb(why.__traceback__)) if f.filename == str(path)), "")
        raise PluginError(f"plug-in file `{path}`{line}: {type(why).__name__}: {why}") from why
    return module, version


def _names(text: str) -> set[str]:
    return {word.strip() for word in text.split(",") if word.strip()}
