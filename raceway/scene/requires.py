"""The table ``[requires]`` of a scene: plug-ins that it needs, with their versions.

::

    [requires]
    raceway-hunt-crossley = ">=0.1"     # a distribution, an entry point, or a plug-in by its name
    raceway = ">=0.1"                   # this package itself
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from raceway.errors import Mistake

if TYPE_CHECKING:
    from packaging.specifiers import SpecifierSet

    from raceway.framework.registry import Registry


def check_requires(table: object, registry: Registry, mistakes: list[Mistake]) -> None:
    """Append a mistake for every requirement that is missing, too old, or not a requirement at all.

    Parameters
    ----------
    table : name -> version specifier such as ">=1.2, <2"; "" for any version
    """
    if not table:
        return
    from packaging.specifiers import InvalidSpecifier, SpecifierSet

    if not isinstance(table, Mapping):
        mistakes.append(Mistake("requires", table, 'must be a table of names and versions: [requires] and NAME = ">=1.2"'))
        return
    installed = _installed(registry)
    for name, specifier in table.items():
        path = f"requires.{name}"
        if not isinstance(specifier, str):
            mistakes.append(Mistake(path, specifier, 'must be a string such as ">=1.2", or "" for any version'))
            continue
        try:
            wanted = SpecifierSet(specifier)
        except InvalidSpecifier:
            mistakes.append(
                Mistake(path, specifier, 'is not a version specifier; write for instance ">=1.2" or ">=1.2, <2"')
            )
            continue
        why = _unmet(name, specifier, wanted, installed, registry)
        if why:
            mistakes.append(Mistake(path, specifier, why))


def _installed(registry: Registry) -> dict[str, tuple[str, str]]:
    """Normalised name -> (distribution, version), for distributions, entry points and plug-ins' names."""
    from packaging.utils import canonicalize_name

    from raceway import __version__

    found: dict[str, tuple[str, str]] = {}
    for entry in registry.all():
        sources = () if entry.distribution == "raceway" else (entry.source, entry.distribution)
        for name in (entry.name, *sources):
            found.setdefault(canonicalize_name(name), (entry.distribution, entry.version))
    found["raceway"] = ("raceway", __version__)
    return found


def _like(name: str, installed: Iterable[str]) -> str:
    """A hint only for what is nearly the same: many distributions begin with the same word."""
    close = difflib.get_close_matches(name, list(installed), n=1, cutoff=0.85)
    return f" (did you mean '{close[0]}'?)" if close else ""


def _unmet(
    name: str, specifier: str, wanted: SpecifierSet, installed: dict[str, tuple[str, str]], registry: Registry
) -> str:
    """Fault of one requirement, and the way out; empty when it is met."""
    from packaging.utils import canonicalize_name
    from packaging.version import InvalidVersion, Version

    key = canonicalize_name(name)
    full = f"{name}{specifier}"
    command = f"pip install '{full}'" if specifier else f"pip install {name}"
    if key not in installed:
        for fault in registry.faults:
            if key in {canonicalize_name(word.strip("()")) for word in fault.source.split()}:
                return f"is installed, but could not be loaded: {fault.reason}"
        for variable in ("RACEWAY_DISABLE", "RACEWAY_PLUGINS"):
            words = {canonicalize_name(w.strip()) for w in os.environ.get(variable, "").split(",") if w.strip()}
            if (variable == "RACEWAY_DISABLE" and key in words) or (
                variable == "RACEWAY_PLUGINS" and words and key not in words
            ):
                return f"is not loaded: the environment variable {variable} leaves it out"
        return f"is required by this scene and not installed{_like(key, installed)}. Install it: {command}"
    distribution, version = installed[key]
    try:
        met = not specifier or wanted.contains(Version(version), prereleases=True)
    except InvalidVersion:
        return f"'{distribution}' has no version that can be compared ('{version}')"
    if not met:
        upgrade = f"pip install --upgrade '{distribution}{specifier}'"
        return f"this scene requires {specifier}, installed is {distribution} {version}. Install a fitting one: {upgrade}"
    return ""
