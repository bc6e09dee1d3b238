"""What the shell completes after --set and other options that take keys of a scene: keys, and the words that a key takes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import click

    from raceway.storage.tables import ReadTables

#: Arguments of fronts that take keys of a scene.
OF_KEYS = ("changes", "keys", "vary", "axes", "free", "at", "ranges", "tolerances")


def scene_keys(context: click.Context, option: click.Parameter, incomplete: str) -> list[str]:
    """Keys that begin so, or after "key=" the values that begin so."""
    from raceway.framework.registry import default_registry
    from raceway.scene.schema import scene_schema

    key, equals, value = incomplete.partition("=")
    # Path of each key -> words that it takes, of all plug-ins that have the key.
    words: dict[str, dict[str, None]] = {}
    for path, word in _walk(scene_schema(default_registry()), ""):
        words.setdefault(path, {}).update({word: None} if word else {})
    if equals:
        return [f"{key}={word}" for word in words.get(key, {}) if word.startswith(value)]
    return sorted(path for path in words if path.startswith(key))


def _walk(schema: ReadTables, path: str) -> Iterator[tuple[str, str]]:
    forms = [schema, *schema.get("oneOf", ()), *schema.get("anyOf", ())]
    if path and not any("properties" in form for form in forms):
        yield path, ""
    for form in forms:
        boolean = ["true", "false"] if form.get("type") == "boolean" else []
        yield from (
            (path, str(word)) for word in [*form.get("enum", boolean), *([form["const"]] if "const" in form else [])]
        )
        for name, below in form.get("properties", {}).items():
            yield from _walk(below, f"{path}.{name}" if path else name)
