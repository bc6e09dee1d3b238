"""The plug-in manager: loads plug-ins one by one and finds them by kind and name.

A plug-in that cannot be loaded is remembered with its reason and takes nothing else down.  Two plug-ins of one kind and
name shadow each other: the name cannot be used until one of them goes.

Environment: ``RACEWAY_DISABLE`` (names of distributions or entry points to leave out, commas), ``RACEWAY_PLUGINS`` (the
exact set of third-party plug-ins to load), ``RACEWAY_TRACE`` (set: every hook call on standard error).
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any

import attrs
import pluggy

from raceway import hookspecs
from raceway.contracts import KINDS, broken_duties
from raceway.errors import PluginError
from raceway.options import nearest

BUILT_IN = ("raceway.contact_laws", "raceway.integrators", "raceway.plugins")


@attrs.frozen
class Entry:
    """One registered class."""

    kind: str
    name: str
    plugin: type
    distribution: str
    version: str


@attrs.frozen
class Fault:
    """Why a plug-in, or a part of one, is not there."""

    source: str
    reason: str

    def __str__(self) -> str:
        return f"plug-in `{self.source}`: {self.reason}"


class Registry:
    """Plug-ins of all kinds.

    Parameters
    ----------
    third_party : whether to load what is installed under the entry point group "raceway"
    """

    def __init__(self, third_party: bool = True) -> None:
        self.manager = pluggy.PluginManager("raceway")
        self.manager.add_hookspecs(hookspecs)
        if os.environ.get("RACEWAY_TRACE"):
            self.manager.trace.root.setwriter(_trace)
            self.manager.enable_tracing()
        self.entries: dict[tuple[str, str], list[Entry]] = {}
        self.faults: list[Fault] = []
        for module in BUILT_IN:
            self._register(import_module(module), module, "raceway", _version())
        if third_party:
            for point in _chosen_entry_points():
                self._load(point)

    @property
    def hook(self) -> Any:
        return self.manager.hook

    def add(self, plugin: Any, source: str = "one-off", distribution: str = "", version: str = "") -> None:
        """Register a module or object with hook implementations; a fault is kept, not raised."""
        self._register(plugin, source, distribution or source, version)

    def find(self, kind: str, name: str) -> Entry:
        """The plug-in of a kind and name.

        Raises
        ------
        PluginError
            Unknown name (with the nearest one), or a name that two plug-ins claim.
        """
        found = self.entries.get((kind, name), [])
        if len(found) == 1:
            return found[0]
        if found:
            owners = " and ".join(f"`{e.plugin.__qualname__}` of {e.distribution}" for e in found)
            raise PluginError(
                f"two plug-ins claim the name '{name}' as {kind.replace('_', ' ')}: {owners}. Remove one, or name it in "
                "RACEWAY_DISABLE."
            )
        names = self.names(kind)
        message = (
            f"no {kind.replace('_', ' ')} named '{name}'{nearest(name, names)}; installed: {', '.join(names) or 'none'}"
        )
        if self.faults:
            message += ". Not loaded: " + "; ".join(str(f) for f in self.faults)
        raise PluginError(message)

    def names(self, kind: str) -> list[str]:
        return sorted(name for k, name in self.entries if k == kind)

    def all(self) -> Iterator[Entry]:
        """Every entry, shadowed ones too, by kind and name."""
        for key in sorted(self.entries):
            yield from self.entries[key]

    def shadowed(self) -> list[tuple[str, str]]:
        """(kind, name) that more than one plug-in claims."""
        return [key for key, found in sorted(self.entries.items()) if len(found) > 1]

    def _load(self, point: EntryPoint) -> None:
        distribution = point.dist.name if point.dist else point.name
        version = point.dist.version if point.dist else ""
        try:
            plugin = point.load()
        except (Exception, SystemExit) as why:  # whatever a third party's import raises: it is reported by name
            self.faults.append(Fault(f"{point.name} ({distribution})", f"fails to import: {type(why).__name__}: {why}"))
            return
        self._register(plugin, point.name, distribution, version)

    def _register(self, plugin: Any, source: str, distribution: str, version: str) -> None:
        label = source if source == distribution else f"{source} ({distribution})"
        try:
            self.manager.register(plugin, name=label)
            self.manager.check_pending()
        except (pluggy.PluginValidationError, ValueError) as why:
            if self.manager.get_plugin(label) is plugin:
                self.manager.unregister(name=label)
            self.faults.append(Fault(label, f"does not fit the hooks: {why}"))
            return
        for kind, (hook_name, _) in KINDS.items():
            others = [p for p in self.manager.get_plugins() if p is not plugin]
            try:
                lists = self.manager.subset_hook_caller(hook_name, others)()
            except Exception as why:  # a third party's own code
                self.faults.append(Fault(label, f"`{hook_name}` raises {type(why).__name__}: {why}"))
                continue
            for found in (c for one in lists for c in (one or [])):
                self._add(Entry(kind, getattr(found, "name", "?"), found, distribution, version), label)

    def _add(self, entry: Entry, label: str) -> None:
        faults = broken_duties(entry.kind, entry.plugin)
        if faults:
            what = getattr(entry.plugin, "__qualname__", repr(entry.plugin))
            self.faults.append(Fault(label, f"{entry.kind.replace('_', ' ')} `{what}` " + ", ".join(faults)))
            return
        same = self.entries.setdefault((entry.kind, entry.name), [])
        if all(e.plugin is not entry.plugin for e in same):
            same.append(entry)


def _chosen_entry_points() -> list[EntryPoint]:
    points = sorted(entry_points(group="raceway"), key=lambda p: (p.name, p.dist.name if p.dist else ""))
    exact = os.environ.get("RACEWAY_PLUGINS")
    if exact is not None:
        wanted = _names(exact)
        points = [p for p in points if wanted & {p.name, p.dist.name if p.dist else ""}]
    blocked = _names(os.environ.get("RACEWAY_DISABLE", ""))
    return [p for p in points if not blocked & {p.name, p.dist.name if p.dist else ""}]


def _names(text: str) -> set[str]:
    return {word.strip() for word in text.split(",") if word.strip()}


def _version() -> str:
    from raceway import __version__

    return __version__


def _trace(text: str) -> None:
    os.write(2, text.encode())


@cache
def default_registry() -> Registry:
    """The plug-ins of this process: built-ins and whatever is installed."""
    return Registry()
