"""This project's packages beside ``raceway``: what each adds, from data/packages.json, which they are made into.

Nothing is imported until a name is used, so that ``import raceway`` and ``dir(raceway)`` stay light.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from typing import Any


@cache
def packages() -> dict[str, dict[str, dict[str, str]]]:
    """Distribution -> its "names" with their modules, its "commands" with heading and summary, its "plugins" as "kind:name"."""
    text = files("raceway").joinpath("data/packages.json").read_text(encoding="utf-8")
    content: dict[str, dict[str, dict[str, str]]] = json.loads(text)
    return content


def missing_package(word: str, part: str) -> str:
    """Which of the packages has a word in a part, and how to install it; "" where none has."""
    from raceway.errors import extra

    package = next((package for package, has in packages().items() if word in has[part]), "")
    return package and f"in {package}: {extra(package)}"


def named(place: str) -> Any:
    """What "module:name" says, imported."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def listed_commands() -> Iterator[tuple[str, str, str]]:
    """Heading, name and summary of each command that is installed beside ``raceway``'s own; those of third parties alone are imported."""
    for package, has in packages().items():
        if find_spec(package.replace("-", "_")):
            parted = ((name, text.partition(": ")) for name, text in has["commands"].items() if text)
            yield from ((heading, name, summary) for name, (heading, _, summary) in parted)
    from importlib.metadata import entry_points

    if any(getattr(point.dist, "name", "") not in packages() for point in entry_points(group="raceway")):
        from raceway.framework.registry import installed

        own = {name for has in packages().values() for name in has["commands"]}
        for heading, commands in installed().mapping("raceway_commands").items():
            yield from ((heading, about.name, about.summary) for about in commands if about.name not in own)


def public_names() -> list[str]:
    """Names that installed packages add to ``import raceway``."""
    there = [has for package, has in packages().items() if find_spec(package.replace("-", "_"))]
    return [name for has in there for name in has["names"] if "." not in name]


def further_name(name: str) -> Any:
    """What an installed package, of this project or a third party's, offers under a public name.

    Raises
    ------
    AttributeError
        None does; of a name of this project's packages: how to install it.
    """
    for package, has in packages().items():
        if name in has["names"]:
            if find_spec(package.replace("-", "_")) is None:
                raise AttributeError(f"raceway.{name} is {missing_package(name, 'names')}")
            return named(f"{has['names'][name]}:{name.rpartition('.')[2]}")
    from raceway.framework.registry import installed

    if (module := installed().mapping("raceway_names").get(name)) is None:
        raise AttributeError(f"module 'raceway' has no attribute '{name}'")
    return named(f"{module}:{name}")
