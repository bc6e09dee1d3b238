"""How plug-ins are found, loaded and tried; here this project's packages beside ``raceway``, and what each adds.

registry   plug-ins by kind and name
sources    entry points and one-off files
probe      compiled kernel of a plug-in by its declared signature, and trial calls of it before a run

What packages add is in data/packages.json, which they are made into: none is imported until a name is used, so that ``import raceway``
and ``dir(raceway)`` stay light.
"""

import json
import os
from functools import cache
from importlib import import_module
from importlib.resources import files
from importlib.util import find_spec
from typing import Any, cast


@cache
def packages() -> dict[str, dict[str, Any]]:
    """Distribution -> its "names" with their modules, "commands" with heading and summary, "plugins" as "kind:name", others it "needs"."""
    text = files("raceway").joinpath("data/packages.json").read_text(encoding="utf-8")
    return cast("dict[str, dict[str, Any]]", json.loads(text))


def names_in(variable: str) -> set[str]:
    """Names of distributions and entry points that an environment variable lists."""
    return {name for word in os.environ.get(variable, "").split(",") if (name := word.strip())}


def available(package: str) -> bool:
    """Whether one of the packages is installed and not disabled."""
    disabled = names_in("RACEWAY_DISABLE") & {package, package.removeprefix("raceway-")}
    return not disabled and find_spec(package.replace("-", "_")) is not None


def missing_package(word: str, part: str) -> str:
    """Which of the packages that are not there has a word in a part, and how to get it; "" where none has."""
    from raceway.errors import extra

    package = next((package for package, has in packages().items() if word in has[part] and not available(package)), "")
    if package and find_spec(package.replace("-", "_")):
        return f"in {package}, which RACEWAY_DISABLE leaves out"
    return package and f"in {package}: {extra(*packages()[package]['needs'], package)}"


def named(place: str) -> Any:
    """What "module:name" says, imported."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def public_names() -> list[str]:
    """Names that installed packages add to ``import raceway``."""
    there = [has for package, has in packages().items() if available(package)]
    return [name for has in there for name in has["names"] if "." not in name]
