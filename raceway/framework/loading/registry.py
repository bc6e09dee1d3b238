"""The plug-in manager: loads plug-ins one by one and finds them by kind and name.

A hook gives classes, or the places of classes by their names, which are imported when a name is asked for.  A plug-in that
cannot be loaded is remembered with its reason and takes nothing else down.  Two plug-ins of one kind and name shadow each
other: the name cannot be used until one of them goes.

Environment: ``RACEWAY_DISABLE`` (names of distributions or entry points to leave out, commas), ``RACEWAY_PLUGINS`` (the
exact set of third-party plug-ins to load), ``RACEWAY_TRACE`` (set: every hook call on standard error).
"""

import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import attrs
import pluggy

from raceway.errors import PluginError, RacewayError
from raceway.framework import hookspecs
from raceway.framework.contracts import KINDS, broken_duties
from raceway.framework.doors import reader
from raceway.framework.loading import available, missing_package, named, packages
from raceway.framework.loading.sources import attempted, chosen_entry_points, import_file, is_foreign_fault, owner, shown
from raceway.framework.options import nearest

_BUILT_IN = ("raceway.contact_laws", "raceway.integrators", "raceway.plugins")


@attrs.frozen
class Fault:
    """Why a plug-in, or a part of one, is not there."""

    source: str
    reason: str

    def __str__(self) -> str:
        return f"plug-in `{self.source}`: {self.reason}"


@attrs.frozen
class Entry:
    """One registered plug-in.

    Attributes
    ----------
    place : "module:Class"
    source : entry point, module or file
    """

    kind: str
    name: str
    place: str
    distribution: str
    version: str
    source: str = ""
    _given: type[Any] | None = attrs.field(default=None, repr=False)

    def __str__(self) -> str:
        return f"{self.kind.replace('_', ' ')} '{self.name}' of {self.distribution}"

    @property
    def title(self) -> str:
        """The name of the class."""
        return self.place.rpartition(":")[2]

    @property
    def label(self) -> str:
        """Who brings it, as faults say."""
        return _label(self.source, self.distribution)

    @property
    def fault(self) -> Fault | None:
        """Why the class cannot be used; it is imported to know."""
        return self._imported if self._given is None and isinstance(self._imported, Fault) else None

    @property
    def plugin(self) -> type[Any]:
        """The class, imported when it is first asked for.

        PluginError: A class that is not at its place, has another name, or breaks a duty of its kind.
        """
        found = self._imported if self._given is None else self._given
        if isinstance(found, Fault):
            raise PluginError(f"{found}. Name it in RACEWAY_DISABLE to run without it")
        return found

    @cached_property
    def _imported(self) -> type[Any] | Fault:
        """The class at the place, or why there is none."""
        kind = self.kind.replace("_", " ")
        plugin, why = attempted(lambda: named(self.place))
        if why:
            return Fault(self.label, f"{kind} '{self.name}' fails to import from `{self.place}`: {why}")
        reason = _fault_of(self.kind, plugin)
        if not reason and plugin.name != self.name:
            reason = f"{kind} `{self.place}` has the name '{plugin.name}', its hook says '{self.name}'"
        return Fault(self.label, reason) if reason else plugin

    def is_of(self, other: "Entry") -> bool:
        """Whether both are the same class."""
        if self._given is not None and other._given is not None:
            return self._given is other._given
        return self.place == other.place


class Registry:
    """Plug-ins of all kinds.

    Parameters
    ----------
    third_party : whether to load what others have installed under the entry point group "raceway"
    """

    def __init__(self, third_party: bool = True) -> None:
        self.manager = pluggy.PluginManager("raceway")
        self.manager.add_hookspecs(hookspecs)
        if os.environ.get("RACEWAY_TRACE"):
            self.manager.trace.root.setwriter(lambda text: os.write(2, text.encode()))
            self.manager.enable_tracing()
        self.entries: dict[tuple[str, str], list[Entry]] = {}
        self.faults: list[Fault] = []
        from raceway import __version__

        self._kinds: dict[str, tuple[str, tuple[str, ...]]] = KINDS
        for module in _BUILT_IN:
            self._register(import_module(module), module, "raceway", __version__)
        points, missing = chosen_entry_points(third_party)
        self.faults += [Fault(name, "named in RACEWAY_PLUGINS, but not installed") for name in missing]
        for point in points:
            distribution, version = owner(point)
            plugin, why = attempted(point.load)
            if why:
                self.faults.append(Fault(f"{point.name} ({distribution})", f"fails to import: {why}"))
            else:
                self._register(plugin, point.name, distribution, version)

    @property
    def hook(self) -> Any:
        return self.manager.hook

    def add(self, plugin: object, source: str = "", distribution: str = "", version: str = "") -> None:
        """Register a module or object with hook implementations; a fault is recorded, not raised."""
        source = source or str(getattr(plugin, "__name__", type(plugin).__qualname__))
        self._register(plugin, source, distribution or source, version)

    def load_file(self, path: str | Path) -> list[Entry]:
        """What a Python file with hook implementations adds, for this registry only; its ``version`` is a hash of the file.

        PluginError: A file that is missing, fails to import, or adds nothing; the registry is as it was before.
        """
        path = Path(path)
        module, version = import_file(path)
        if self.manager.is_registered(module):
            return [e for e in self.all() if e.source == str(path)]
        before = len(self.faults)
        self._register(module, str(path), path.name, version)
        faults, self.faults = self.faults[before:], self.faults[:before]
        added = [e for e in self.all() if e.source == str(path)]
        hooks = (self.manager.get_hookcallers(module) or []) if self.manager.is_registered(module) else []
        if not faults and not hooks:
            example = "@hookimpl def raceway_contact_laws(): return [MyLaw]"
            faults = [Fault(str(path), f"has no hook: write for instance {example}")]
        if faults:
            if self.manager.is_registered(module):
                self.manager.unregister(module)
            self._forget(added)
            raise PluginError("; ".join(str(fault) for fault in faults))
        return added

    def notify(self, hook: str, **arguments: object) -> None:
        """Call a life-cycle hook of every plug-in, in the order of registration.

        PluginError: A plug-in's hook raised; the message names it.  A ``RacewayError`` of its own passes through as it is.
        """
        names = {id(plugin): name for name, plugin in self.manager.list_name_plugin()}
        for implementation in getattr(self.manager.hook, hook).get_hookimpls():
            excluded = [p for p in self.manager.get_plugins() if p is not implementation.plugin]
            try:
                self.manager.subset_hook_caller(hook, excluded)(**arguments)
            except (RacewayError, KeyboardInterrupt):
                raise
            except BaseException as why:  # a third party's own code
                words = f"`{hook}` raises {type(why).__name__}: {why}. Name it in RACEWAY_DISABLE to run without it."
                raise PluginError(f"plug-in `{names[id(implementation.plugin)]}`: {words}") from why

    def mapping(self, hook: str) -> dict[str, Any]:
        """What all plug-ins answer to a hook of mappings; tuples of one key follow each other.  A plug-in that raises has a fault."""
        merged: dict[str, Any] = {}
        for implementation in getattr(self.manager.hook, hook).get_hookimpls():
            answer, why = attempted(lambda: dict(implementation.function()))  # noqa: B023  called at once
            fault = Fault(implementation.plugin_name, f"`{hook}` raises {why}")
            self.faults += [fault] if why and fault not in self.faults else []
            for key, value in (answer or {}).items():
                merged[key] = merged.get(key, ()) + value if isinstance(value, tuple) else value
        return merged

    def find_any(self, text: str) -> Entry:
        """The plug-in that ``[KIND:]NAME`` means.

        PluginError: An unknown kind or name, a name that several kinds have, or one that two plug-ins claim; lists the choices.
        """
        kind, colon, name = text.rpartition(":")
        if colon:
            kind = kind.strip().replace("-", "_").replace(" ", "_")
            if kind not in self._kinds:
                known = ", ".join(self._kinds)
                raise PluginError(f"no kind of plug-in named '{kind}'{nearest(kind, self._kinds)}; kinds: {known}")
            return self.find(kind, name.strip())
        kinds = [k for k in self._kinds if (k, name) in self.entries]
        if len(kinds) == 1:
            return self.find(kinds[0], name)
        if kinds:
            raise PluginError(f"'{name}' is ambiguous; write {' or '.join(f'{k}:{name}' for k in kinds)}")
        installed = ", ".join(f"{k}:{n}" for k, n in sorted(self.entries))
        raise self._unknown("plug-in", name, sorted({n for _, n in self.entries}), installed)

    def find(self, kind: str, name: str) -> Entry:
        """The plug-in of a kind and name, imported.

        PluginError: Unknown name (with the nearest one), or a name that two plug-ins claim.
        """
        entries = self.entries.get((kind, name), [])
        if len(entries) == 1 and not self._drop_broken(entries[0]):
            return entries[0]
        if len(entries) > 1:
            owners = " and ".join(f"`{e.title}` of {e.distribution}" for e in entries)
            remedy = "Rename or remove one: leave its --plugin file out, or name its distribution in RACEWAY_DISABLE."
            raise PluginError(f"two plug-ins claim the name '{name}' as {kind.replace('_', ' ')}: {owners}. {remedy}")
        names = self.names(kind)
        if missing := missing_package(f"{kind}:{name}", "plugins"):
            raise PluginError(f"{kind.replace('_', ' ')} '{name}' is {missing}")
        raise self._unknown(kind.replace("_", " "), name, names, ", ".join(names) or "none")

    def _unknown(self, kind: str, name: str, names: list[str], installed: str) -> PluginError:
        faults = "; ".join(map(str, self.faults))
        known = f"{installed}. Not loaded: {faults}" if faults else installed
        return PluginError(f"no {kind} named '{name}'{nearest(name, names)}; installed: {known}")

    def format_of(self, path: str | Path) -> Entry:
        """The format of a file, by the ending of its name; the longest ending that fits.

        PluginError: No format has the ending (lists those that there are), or two have it.
        """
        name = Path(path).name.lower()
        readers = [entry for entry in self.of_kind("format") if hasattr(entry.plugin, "read")]
        endings = [(ending, entry) for entry in readers for ending in entry.plugin.suffixes]
        fitting = [(ending, entry) for ending, entry in endings if name.endswith(ending)]
        if not fitting:
            suffixes = ", ".join(sorted({ending for ending, _ in endings}))
            raise PluginError(f"'{path}': no format has the ending '{Path(path).suffix.lower()}'; there are {suffixes}")
        ending, owner = max(fitting, key=lambda pair: len(pair[0]))
        owners = [str(entry) for suffix, entry in fitting if suffix == ending]
        if len(owners) > 1:
            raise PluginError(f"'{path}': {' and '.join(owners)} both claim the ending '{ending}'. Remove one.")
        return owner

    def names(self, kind: str) -> list[str]:
        return sorted(name for k, name in self.entries if k == kind)

    def all(self) -> Iterator[Entry]:
        """Every entry, shadowed ones too, by kind and name; no class is imported."""
        for key in sorted(self.entries):
            yield from self.entries[key]

    def of_kind(self, *kinds: str) -> list[Entry]:
        """Entries of some kinds, shadowed ones too, by kind and name, their classes imported; one that breaks is a fault, and gone."""
        fitting = [entry for key in sorted(self.entries) if key[0] in kinds for entry in self.entries[key]]
        return [entry for entry in fitting if not self._drop_broken(entry)]

    def _drop_broken(self, entry: Entry) -> bool:
        """Whether the class of an entry cannot be used, which is then remembered as if it had been imported at once."""
        if entry.fault is None:
            return False
        self.faults.append(entry.fault)
        self._forget([entry])
        return True

    def _forget(self, entries: list[Entry]) -> None:
        for entry in entries:
            same = self.entries[entry.kind, entry.name]
            same.remove(entry)
            if not same:
                del self.entries[entry.kind, entry.name]

    def shadowed(self) -> list[tuple[str, str]]:
        """(kind, name) that more than one plug-in claims."""
        return [key for key, entries in sorted(self.entries.items()) if len(entries) > 1]

    def _register(self, plugin: object, source: str, distribution: str, version: str) -> None:
        label = _label(source, distribution)
        try:
            hash(plugin)  # pluggy keeps plug-ins in sets
            self.manager.register(plugin, name=label)
            self.manager.check_pending()
        except TypeError as why:
            self.faults.append(Fault(label, f"cannot be registered: {why}; name a module, or an object that can be hashed"))
            return
        except BaseException as why:  # pluggy refuses its hooks, or looking at it runs code of its own
            if not is_foreign_fault(why):
                raise
            if self.manager.get_plugin(label) is plugin:
                self.manager.unregister(name=label)
            by_contract = isinstance(why, pluggy.PluginValidationError | ValueError)
            reason = str(why) if by_contract else f"looking at it raises {type(why).__name__}: {why}"
            self.faults.append(Fault(label, f"does not fit the hooks: {reason}"))
            return
        for kind, (hook_name, _) in self._kinds.items():
            earlier = [p for p in self.manager.get_plugins() if p is not plugin]
            lists, failure = attempted(self.manager.subset_hook_caller(hook_name, earlier))
            if failure:
                self.faults.append(Fault(label, f"`{hook_name}` raises {failure}"))
            for given in lists or ():
                if not isinstance(given, list | tuple | Mapping):
                    wanted = 'a list of classes or a mapping of names to "module:Class"'
                    reason = f"returns {shown(given)}, which is not {wanted}"
                    self.faults.append(Fault(label, f"`{hook_name}` {reason}"))
                elif isinstance(given, Mapping):
                    for name, place in given.items():
                        if isinstance(name, str) and isinstance(place, str) and all(place.partition(":")):
                            self._enter(Entry(kind, name, place, distribution, version, source))
                        else:
                            reason = f'maps {shown(name)} to {shown(place)}: a name, then "module:Class"'
                            self.faults.append(Fault(label, f"`{hook_name}` {reason}"))
                else:
                    for cls in given:
                        if reason := _fault_of(kind, cls):
                            self.faults.append(Fault(label, reason))
                        else:
                            place = f"{cls.__module__}:{cls.__qualname__}"
                            self._enter(Entry(kind, cls.name, place, distribution, version, source, cls))

    def _enter(self, entry: Entry) -> None:
        same = self.entries.setdefault((entry.kind, entry.name), [])
        if not any(entry.is_of(other) for other in same):
            same.append(entry)


def _label(source: str, distribution: str) -> str:
    return source if source == distribution else f"{source} ({distribution})"


def _fault_of(kind: str, plugin: Any) -> str:
    """Duties that a class breaks, in words; empty where it breaks none."""

    def look() -> tuple[list[str], str]:
        getattr(plugin, "name", "")
        return broken_duties(kind, plugin), getattr(plugin, "__qualname__", None) or shown(plugin)

    words, (found, why) = kind.replace("_", " "), attempted(look)
    if why:  # an attribute of a metaclass, or a name, that raises
        return f"looking at {words} {shown(plugin)} raises {why}"
    faults, title = found
    return f"{words} `{title}` {', '.join(faults)}" if faults else ""


REGISTRY = reader("a registry of plug-ins", Registry)


@cache
def default_registry() -> Registry:
    """The plug-ins of this process: built-ins and whatever is installed."""
    return Registry()


def registry_with(files: Iterable[str | Path]) -> Registry:
    """The plug-ins of this process and those of one-off files, which it keeps.

    PluginError: A file that is missing, fails to import or adds nothing.
    """
    registry = default_registry()
    for file in files:
        registry.load_file(file)
    return registry


def further_name(name: str) -> Any:
    """What an installed package, of this project or a third party's, offers under a public name.

    AttributeError: None does; of a name of this project's packages: how to install it.
    """
    for package, has in packages().items():
        if name in has["names"]:
            if not available(package):
                raise AttributeError(f"raceway.{name} is {missing_package(name, 'names')}")
            return named(f"{has['names'][name]}:{name.rpartition('.')[2]}")
    if (module := default_registry().mapping("raceway_names").get(name)) is None:
        raise AttributeError(f"module 'raceway' has no attribute '{name}'")
    return named(f"{module}:{name}")
