"""This project's packages beside ``raceway``: what each adds, from data/packages.json, which they are made into."""

from __future__ import annotations

import json
from functools import cache
from importlib import import_module
from importlib.resources import files
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
