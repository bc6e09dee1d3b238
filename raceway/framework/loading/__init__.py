"""How plug-ins are found, loaded and tried; here the commands and public names that are installed beside ``raceway``.

registry   plug-ins by kind and name
sources    this project's packages, entry points, one-off files
probe      compiled kernel of a plug-in by its declared signature, and trial calls of it before a run
"""

from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Any

from raceway.framework.loading.sources import available, missing_package, named, packages


def listed_commands() -> Iterator[tuple[str, str, str]]:
    """Heading, name and summary of each command that is installed beside ``raceway``'s own; those of third parties alone are imported."""
    for package, has in packages().items():
        if available(package):
            parted = ((name, text.partition(": ")) for name, text in has["commands"].items() if text)
            yield from ((heading, name, summary) for name, (heading, _, summary) in parted)
    if any(getattr(point.dist, "name", "") not in packages() for point in entry_points(group="raceway")):
        from raceway.framework.loading.registry import default_registry

        own = {name for has in packages().values() for name in has["commands"]}
        for heading, commands in default_registry().mapping("raceway_commands").items():
            yield from ((heading, about.name, about.summary) for about in commands if about.name not in own)


def public_names() -> list[str]:
    """Names that installed packages add to ``import raceway``."""
    there = [has for package, has in packages().items() if available(package)]
    return [name for has in there for name in has["names"] if "." not in name]


def further_name(name: str) -> Any:
    """What an installed package, of this project or a third party's, offers under a public name.

    AttributeError: None does; of a name of this project's packages: how to install it.
    """
    for package, has in packages().items():
        if name in has["names"]:
            if not available(package):
                raise AttributeError(f"raceway.{name} is {missing_package(name, 'names')}")
            return named(f"{has['names'][name]}:{name.rpartition('.')[2]}")
    from raceway.framework.loading.registry import default_registry

    if (module := default_registry().mapping("raceway_names").get(name)) is None:
        raise AttributeError(f"module 'raceway' has no attribute '{name}'")
    return named(f"{module}:{name}")
