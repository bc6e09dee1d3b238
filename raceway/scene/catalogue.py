"""Bearing presets, one TOML file each in ``raceway/data/bearings``, with the source of every number.

A file holds ``title`` and one table for each key of the scene's [bearing] table (``rings.young`` is
[rings.young]) with ``value``, ``source`` and, where no document states the number, ``inferred = true``.
"""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files

import attrs

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.storage.tables import Tables


@attrs.frozen
class Fact:
    """One number of a preset: key of the [bearing] table, value, where it comes from."""

    key: str
    value: object
    source: str
    inferred: bool


@attrs.frozen
class Preset:
    name: str
    title: str
    facts: tuple[Fact, ...]

    @property
    def table(self) -> Tables:
        """The [bearing] table that the preset stands for."""
        out: Tables = {}
        for fact in self.facts:
            table = out
            *parents, last = fact.key.split(".")
            for parent in parents:
                table = table.setdefault(parent, {})
            table[last] = fact.value
        return out


@cache
def catalogue() -> dict[str, Preset]:
    """All presets by name."""
    found = {}
    for file in sorted(files("raceway").joinpath("data/bearings").iterdir(), key=lambda f: f.name):
        if file.name.endswith(".toml"):
            content = tomllib.loads(file.read_text(encoding="utf-8"))
            name = file.name.removesuffix(".toml")
            found[name] = Preset(name, content.pop("title"), tuple(_facts(content, "")))
    return found


def _facts(tables: Tables, prefix: str) -> list[Fact]:
    facts: list[Fact] = []
    for key, table in tables.items():
        if "value" in table:
            facts.append(Fact(prefix + key, table["value"], table["source"], bool(table.get("inferred", False))))
        else:
            facts += _facts(table, f"{prefix}{key}.")
    return facts


def preset(name: object) -> Tables:
    """The [bearing] table of a preset.

    Raises
    ------
    SceneError
        Unknown name, with the nearest one.
    """
    known = catalogue()
    if not isinstance(name, str) or name not in known:
        raise SceneError.at("bearing.preset", name, f"no such preset{nearest(str(name), known)}; known: {', '.join(known)}")
    return {**known[name].table, "preset": name}
