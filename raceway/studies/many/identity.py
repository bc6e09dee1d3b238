"""Identity of a sweep's numbers beside its scenes: the program and the plug-ins, by version and by content."""

from __future__ import annotations

import platform
from collections.abc import Iterable
from importlib.metadata import version

from raceway import __version__
from raceway.framework.registry import Registry
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.row_store import program_key


def plugins_of(scene: Scene) -> list[tuple[str, str]]:
    """(kind, name) of every plug-in that a scene uses."""
    found = [
        ("contact_law", scene.contact.kind),
        ("integrator", scene.integrator.kind),
        ("identifier", scene.identifier.kind),
    ]
    found += [("excitation", scene.excitation.name)] if scene.excitation is not None else []
    return found + ([("mesher", scene.mesh.name)] if scene.mesh is not None else [])


def identity(registry: Registry, used: Iterable[tuple[str, str]]) -> Tables:
    """Versions, hash of all sources, and those of the used (kind, name) that this process has, as plain values."""
    there = sorted(pair for pair in used if len(registry.entries.get(pair, [])) == 1)
    entries = [registry.find(*pair) for pair in there]
    return {
        "raceway": __version__,
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "numba": version("numba"),
        "scipy": version("scipy"),
        "program": program_key(registry, there),
        "plugins": {f"{e.kind}:{e.name}": f"{e.distribution} {e.version}" for e in entries},
    }


def used_by(wanted: ReadTables) -> list[tuple[str, str]]:
    """(kind, name) of the plug-ins of an identity."""
    return [(kind, name) for kind, _, name in (text.partition(":") for text in wanted["plugins"])]


def differences(wanted: ReadTables, there: ReadTables) -> list[str]:
    """In words what is there instead of what is wanted; empty where nothing differs."""
    words = []
    for text, owner in wanted["plugins"].items():
        kind, _, name = text.partition(":")
        plugin, has = f"{kind.replace('_', ' ')} '{name}'", there["plugins"].get(text)
        if has is None:
            words.append(f"{plugin} of {owner} is missing")
        elif has != owner:
            words.append(f"{plugin} is of {has} instead of {owner}")
    for name in ("raceway", "python", "numpy", "numba", "scipy"):
        if wanted[name] != there[name]:
            words.append(f"{name} {there[name]} instead of {wanted[name]}")
    if not words and wanted["program"] != there["program"]:
        words.append("the sources of raceway or of a plug-in differ, under the same version")
    return words
