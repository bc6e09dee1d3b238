"""Inputs of commands: scenes, result folders, plug-ins.  Part of ``raceway.cli``."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.commands.console import warn
from raceway.errors import Mistake, RacewayError, SceneError, extra
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.framework.registry import Registry
    from raceway.scene.given import Given
    from raceway.scene.scene import Scene


def slug(title: str) -> str:
    """A folder's name from a title: letters, digits, dots and dashes, at most 80, then what the second line says was changed.

    Notes
    -----
    Accents are left out.  A title with letters of another script, or more of them, ends in a hash of it.  Other changes make another name: where
    letters of them are lost, or more than 100, a hash of all stands at the end.
    """
    first, _, changes = title.partition("\n")
    latin = unicodedata.normalize("NFKD", first)
    text = re.sub(r"[^A-Za-z0-9._]+", "-", "".join(s for s in latin if not unicodedata.combining(s))).strip("-._")
    name = text[:80].strip("-._") or "scene"
    if len(text) > 80 or any(sign.isalnum() and not sign.isascii() for sign in latin):  # titles stay apart
        name += f"-{hashlib.sha256(first.encode()).hexdigest()[:8]}"
    plain = changes.replace(" = ", "=").replace(", ", ",")
    told = re.sub(r"[^A-Za-z0-9._=,+-]+", "-", plain)
    if told != plain or len(told) > 100:
        told = f"{told[:100]}-{hashlib.sha256(plain.encode()).hexdigest()[:8]}"
    return f"{name}-{told}" if told else name


def faults(registry: Registry) -> list[str]:
    """Plug-ins that could not be loaded, and names that two of them claim; a sentence each."""
    found = [str(fault) for fault in registry.faults]
    for kind, name in registry.shadowed():
        owners = " and ".join(f"{e.plugin.__qualname__} of {e.distribution}" for e in registry.entries[kind, name])
        found.append(
            f"{kind.replace('_', ' ')} '{name}' is claimed by two plug-ins: {owners}. Remove one, or name it in "
            "RACEWAY_DISABLE"
        )
    return found


def tell_faults(registry: Registry) -> None:
    """Plug-ins that the scene does not use are no reason to stop."""
    for text in faults(registry):
        warn(f"{text} (not used here)")


def changed_tables(scene: Path, changes: tuple[str, ...], registry: Registry) -> tuple[Tables, list[Mistake]]:
    """The scene's tables with the changes, and the changes that cannot be made; files start at the scene's folder."""
    given, mistakes = _changed(scene, changes)
    return given.plain(registry), mistakes


def load(scene: Path, changes: tuple[str, ...], registry: Registry) -> Scene:
    """A scene from its file and the changes.

    Raises
    ------
    SceneError
        With the mistakes of both.
    """
    given, mistakes = _changed(scene, changes)
    try:
        loaded = given.scene(registry)
    except SceneError as error:
        raise SceneError([*mistakes, *error.mistakes]) from None
    if mistakes:
        raise SceneError(mistakes)
    return loaded


def _changed(scene: Path, changes: tuple[str, ...]) -> tuple[Given, list[Mistake]]:
    from raceway.scene.given import as_given

    given = as_given(scene)
    mistakes: list[Mistake] = []
    for change in changes:
        try:
            given = given.changed(change)
        except SceneError as error:
            mistakes += [Mistake(f"--set {m.path}", m.value, m.message) for m in error.mistakes]
    return given, mistakes


def require_matplotlib(otherwise: str) -> None:
    if find_spec("matplotlib") is None:
        raise RacewayError(f"pictures need matplotlib: {extra('pictures')}, or {otherwise}.")


def has_netcdf() -> bool:
    """Whether labelled results can be written; says what is missing."""
    missing = [name for name in ("h5netcdf", "h5py") if find_spec(name) is None]
    if missing:
        warn(f"no results.nc: it needs {', '.join(missing)}; {extra('sweep')}; points.sqlite holds everything")
    return not missing


def has_matplotlib() -> bool:
    """Whether pictures can be drawn; says what is missing where they are no more than the default."""
    there = find_spec("matplotlib") is not None
    if not there:
        warn(f"no picture: it needs matplotlib, {extra('pictures')}")
    return there


def columns_by_head(texts: tuple[str, ...]) -> dict[str, str]:
    """Head -> name from ``HEAD=NAME``; a head may have an equals sign, a name has none."""
    found = {}
    for text in texts:
        head, sign, name = text.rpartition("=")
        if not sign or not head.strip() or not name.strip():
            raise SceneError.at("--map", text, 'must have the form "HEAD=NAME", for instance "X [µm]=y_um"')
        found[head.strip()] = name.strip()
    return found
