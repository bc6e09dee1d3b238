"""Makes a scene of plain tables: presets, plug-ins' options; all mistakes at once, each with its path."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import Mistake, PluginError, SceneError
from raceway.framework.loading import named, names_in
from raceway.framework.loading.registry import Registry
from raceway.framework.options import nearest
from raceway.scene.bearing import with_material
from raceway.scene.catalogue import preset, preset_of
from raceway.scene.designation import GEOMETRY
from raceway.scene.lubricant import lubricant_mistakes
from raceway.scene.structure import structure, table_without_units
from raceway.scene.tables import (
    OPTIONAL_TABLES,
    PLUGIN_TABLES,
    SWAPPED_TABLES,
    TABLES,
    AutoIntegrator,
    SceneTables,
    quantities_table,
)
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from packaging.specifiers import SpecifierSet


def check_requirements(table: Mapping[str, object], registry: Registry, mistakes: list[Mistake]) -> None:
    """Append a mistake for every requirement that is missing, too old, or not a requirement at all.

    table : name -> version specifier such as ">=1.2, <2"; "" for any version
    """
    if not table:
        return
    from packaging.specifiers import InvalidSpecifier, SpecifierSet
    from packaging.utils import canonicalize_name

    from raceway import __version__

    #: Normalised name -> (distribution, version), for distributions, entry points and plug-ins' names.
    distributions: dict[str, tuple[str, str]] = {}
    for entry in registry.all():
        sources = () if entry.distribution == "raceway" else (entry.source, entry.distribution)
        for name in (entry.name, *sources):
            distributions.setdefault(canonicalize_name(name), (entry.distribution, entry.version))
    distributions["raceway"] = ("raceway", __version__)
    for name, specifier in table.items():
        path = f"requires.{name}"
        if not isinstance(specifier, str):
            mistakes.append(Mistake(path, specifier, 'must be a string such as ">=1.2", or "" for any version'))
            continue
        try:
            versions = SpecifierSet(specifier)
        except InvalidSpecifier:
            rule = 'is not a version specifier; write for instance ">=1.2" or ">=1.2, <2"'
            mistakes.append(Mistake(path, specifier, rule))
            continue
        why = _unmet(name, specifier, versions, distributions, registry)
        if why:
            mistakes.append(Mistake(path, specifier, why))


def _unmet(
    name: str, specifier: str, versions: SpecifierSet, distributions: dict[str, tuple[str, str]], registry: Registry
) -> str:
    """Fault of one requirement, and the way out; empty when it is met."""
    from packaging.utils import canonicalize_name
    from packaging.version import InvalidVersion, Version

    key = canonicalize_name(name)
    full = f"{name}{specifier}"
    command = f"pip install '{full}'" if specifier else f"pip install {name}"
    if key not in distributions:
        for fault in registry.faults:
            if key in {canonicalize_name(word.strip("()")) for word in fault.source.split()}:
                return f"is installed, but could not be loaded: {fault.reason}"
        disabled, only = (set(map(canonicalize_name, names_in(v))) for v in ("RACEWAY_DISABLE", "RACEWAY_PLUGINS"))
        if key in disabled or (only and key not in only):
            variable = "RACEWAY_DISABLE" if key in disabled else "RACEWAY_PLUGINS"
            return f"is not loaded: the environment variable {variable} leaves it out"
        # A hint only for what is nearly the same: many distributions begin with the same word.
        close = difflib.get_close_matches(key, list(distributions), n=1, cutoff=0.85)
        like = f" (did you mean '{close[0]}'?)" if close else ""
        return f"is required by this scene and not installed{like}. Install it: {command}"
    distribution, version = distributions[key]
    try:
        fits = not specifier or versions.contains(Version(version), prereleases=True)
    except InvalidVersion:
        return f"'{distribution}' has no version that can be compared ('{version}')"
    if not fits:
        upgrade = f"pip install --upgrade '{distribution}{specifier}'"
        return f"this scene requires {specifier}, installed is {distribution} {version}. Install a fitting one: {upgrade}"
    return ""


def _with_preset(table: Tables, mistakes: list[Mistake]) -> Tables:
    table = _with_rows(table, mistakes)
    if type(name := table.get("preset")) is int:  # 6205 without quotes
        name, table = str(name), {**table, "preset": str(name)}
    if name is None:
        return _with_materials(table, {}, mistakes)
    try:
        values = preset(name, table.get("maker"))
    except SceneError as error:
        mistakes += error.mistakes
        return {**_PLACEHOLDER, **table, "preset": None}
    whole = {**values, **table}
    if "radial_clearance" in table and "contact_angle_deg" not in table:
        whole["contact_angle_deg"] = 0.0
    if "contact_angle_deg" in table and "radial_clearance" not in table:
        whole.pop("radial_clearance", None)
    return _with_materials(whole, values, mistakes)


def _with_materials(table: Tables, preset: Tables, mistakes: list[Mistake], name: str = "bearing") -> Tables:
    """The table [bearing] or [mounting] with the numbers of named materials, and those of the preset below what the user says."""
    whole = dict(table)
    for part in ("rings", "balls", "shaft_material", "housing_material"):
        body = table.get(part)
        body = {"material": body} if isinstance(body, str) and name == "mounting" else body
        if isinstance(body, dict):
            try:
                whole[part] = with_material(body, f"{name}.{part}", preset.get(part, {}))
            except SceneError as error:
                mistakes += error.mistakes
                whole[part] = {**preset.get(part, {}), **body, "material": None}
    return whole


def _with_rows(table: Tables, mistakes: list[Mistake]) -> Tables:
    """The [bearing] table whose rows have the numbers of their presets; without a bearing of its own it is the first row's."""
    rows = table.get("row")
    if not isinstance(rows, list | tuple):
        return table
    rows_whole = []
    for k, row in enumerate(rows):
        name = row.get("preset") if isinstance(row, dict) else None
        if name is not None:
            try:
                values = preset(name, table.get("maker"))
            except SceneError as error:
                mistakes += [
                    attrs.evolve(mistake, path=mistake.path.replace("bearing.preset", f"bearing.row[{k}].preset"))
                    for mistake in error.mistakes
                ]
                row = {key: value for key, value in row.items() if key != "preset"}
            else:
                row = {**{key: value for key, value in values.items() if key in GEOMETRY}, **row}
        rows_whole.append(row)
    first = rows_whole[0] if rows_whole else None
    if isinstance(first, dict) and "preset" in first and not table.keys() & {"preset", "ball_diameter"}:
        table = {**table, "preset": first["preset"]}
    return {**table, "row": rows_whole}


#: Stands in for a preset that does not exist, so that the other keys of the table are still checked.
_PLACEHOLDER = {
    "ball_diameter": 0.01, "pitch_diameter": 0.05, "width": 0.015, "ball_count": 8, "conformity_inner": 0.52, "conformity_outer": 0.52,
}  # fmt: skip


def read_tables(tables: ReadTables, registry: Registry) -> tuple[str, Tables, SceneTables]:
    """Title, the known tables as they were said, and every key of them checked; parameters of ``scene_from_dict``.

    SceneError: With every mistake that was found.
    """
    mistakes: list[Mistake] = []
    title, content = _known_tables(tables, registry, mistakes)
    plain = numbers_only(content, registry)
    if "bearing" in plain:
        plain["bearing"] = _with_preset(plain["bearing"], mistakes)
    if "mounting" in plain:
        plain["mounting"] = _with_materials(plain["mounting"], {}, mistakes, "mounting")
    # What a preset says beside its bearing.
    bearing, classes, fits = plain.get("bearing", {}), plain.get("tolerances"), plain.get("mounting", {})
    entry = preset_of(bearing.get("preset"), bearing.get("maker"))
    for name, table in ({} if entry is None else entry.other_tables).items():
        own = plain.get(name, {})
        if isinstance(own, dict) and own.get("kind", table.get("kind")) == table.get("kind"):
            plain[name] = {**table, **own}
    acts = any(fits.get(key, 0.0) > 0.0 for key in ("shaft_interference", "housing_interference"))
    if entry is not None and entry.tolerance_class and isinstance(classes, dict) and acts:
        plain["tolerances"] = {"class": entry.tolerance_class, **classes}
    # [heat] begins with oil at the temperature of its inlet.
    heat, oil, at_inlet = plain.get("heat", {}), plain.get("lubricant", {}), plain
    if "oil_inlet_c" in heat and ("oil" in oil or "viscosity_40" in oil):
        at_inlet = {**plain, "lubricant": {**oil, "temperature_c": heat["oil_inlet_c"]}}
    parts: Tables = {}
    for name, cls in TABLES.items():
        if name in OPTIONAL_TABLES and name not in plain:
            parts[name] = None
        elif name not in PLUGIN_TABLES and (name != "bearing" or name in plain):
            parts[name] = _core_table(at_inlet.get(name, {}), cls, name, mistakes)
    if at_inlet is not plain:
        for k, mistake in enumerate(mistakes):  # the oil's temperature is that of the key that gives it
            if mistake.path == "lubricant" and mistake.message.startswith("`temperature_c` = "):
                mistakes[k] = Mistake("heat.oil_inlet_c", None, mistake.message.partition(" = ")[2])
    for name, (kind, default) in PLUGIN_TABLES.items():
        parts[name] = None
        if name in plain or name not in OPTIONAL_TABLES:
            parts[name] = _plugin_table(name, kind, default, plain.get(name, {}), registry, mistakes)
    for name, place in registry.mapping("raceway_tables").items():
        if name in plain:
            structure(plain[name], named(place), name, mistakes)
    parts["quantities"] = structure(plain.get("quantities", {}), quantities_table(registry), "quantities", mistakes)
    if not mistakes:
        mistakes += lubricant_mistakes(parts["contact"].law, parts["lubricant"])
    if mistakes:
        raise SceneError(mistakes)
    checked = SceneTables(source=plain, **parts)
    if "tolerances" in plain:
        from raceway.scene.tolerance import check_tolerances  # few scenes have any

        check_tolerances(checked)
    return title, content, checked


def _known_tables(tables: ReadTables, registry: Registry, mistakes: list[Mistake]) -> tuple[str, Tables]:
    """Title, and a copy of the known tables."""
    names = [*dict.fromkeys((*TABLES, *PLUGIN_TABLES)), *registry.mapping("raceway_tables")]
    names += "quantities", "tolerances", "requires", "title"
    for name in tables:
        if name not in names:
            mistakes.append(Mistake(name, None, f"unknown table{nearest(name, names)}; known: {', '.join(names)}"))
    title = tables.get("title", "untitled")
    if not isinstance(title, str) or not title.strip():
        mistakes.append(Mistake("title", title, "must be a string that is not empty"))
        title = "untitled"
    plain = {name: copy.deepcopy(tables[name]) for name in names if name in tables}
    for name in list(plain):
        if name != "title" and not isinstance(plain[name], dict):
            mistakes.append(Mistake(name, plain[name], f"must be a table: write [{name}] and keys below it"))
            plain[name] = {}
    check_requirements(plain.get("requires", {}), registry, mistakes)
    if "bearing" not in plain and not any(nearest(name, ["bearing"]) for name in tables if name not in names):
        mistakes.append(Mistake("bearing", None, 'is required: for instance [bearing] with preset = "B7206C"'))
    return title, plain


def _plugin_table(
    name: str, kind: str, default: str | None, table: Tables, registry: Registry, mistakes: list[Mistake]
) -> Any:
    """The plug-in's options, or the core's table with the plug-in in its last attribute."""
    word = table.get("kind", default)
    names = registry.names(kind)
    if word is None:
        mistakes.append(Mistake(f"{name}.kind", None, f"is required: one of {', '.join(names) or '(none installed)'}"))
        return None
    if not isinstance(word, str):
        mistakes.append(Mistake(f"{name}.kind", word, f"must be a string: one of {', '.join(names)}"))
        return None
    core = TABLES.get(name)
    core_keys = [] if core is None else [f.name for f in attrs.fields(core) if "plugin" not in f.metadata]
    shared = {key: value for key, value in table.items() if key in core_keys}
    try:
        plugin = options_class(kind, word, registry)
    except PluginError as error:
        mistakes.append(Mistake(f"{name}.kind", word, str(error)))
        if core is not None:
            structure({k: v for k, v in shared.items() if k != "kind"}, core, name, mistakes)
        return None
    options = {key: value for key, value in table.items() if key not in core_keys and key != "kind"}
    keys = [*core_keys, *(a.name for a in attrs.fields(plugin))]
    if name in SWAPPED_TABLES and not set(options) <= set(keys):
        elsewhere = {a.name for e in registry.of_kind(kind) for a in attrs.fields(e.plugin)}
        options = {key: value for key, value in options.items() if key in keys or key not in elsewhere}
    for key in [k for k in options if k not in keys]:
        rule = f"unknown key{nearest(key, keys)}; known for kind '{word}': {', '.join(k for k in keys if k != 'kind')}"
        holders = [e.name for e in registry.of_kind(kind) if key in attrs.fields_dict(e.plugin)]
        if plugin is AutoIntegrator and holders:
            rule = f"belongs to a method, which kind 'auto' chooses: say kind = {' or '.join(map(repr, holders))} with it"
        elif holders:
            rule += f"; kind {' and '.join(map(repr, holders))} has it"
        mistakes.append(Mistake(f"{name}.{key}", options.pop(key), rule))
    method = structure(options, plugin, name, mistakes)
    if core is None:
        return method
    frame: Any = _core_table({**shared, "kind": word}, core, name, mistakes)
    slot = next(f.name for f in attrs.fields(core) if "plugin" in f.metadata)
    return None if frame is None or method is None else attrs.evolve(frame, **{slot: method})


#: The core's tables by what stands in them; those of plug-ins may be made of files, which change.
_READ: dict[tuple[type, str], Any] = {}
_MOST_READ = 1024


def _core_table(table: object, cls: type, name: str, mistakes: list[Mistake]) -> Any:
    """As ``structure``, once for the same content."""
    try:
        content = cls, repr(table)
    except Exception:  # of an integer of 5000 digits, of which the rules say it better
        return structure(table, cls, name, mistakes)
    part: Any = _READ.get(content) or structure(table, cls, name, mistakes)
    if part is not None:
        if len(_READ) >= _MOST_READ:
            _READ.clear()
        _READ[content] = part
    return part


def options_class(kind: str, word: str, registry: Registry) -> type:
    """The class of options of a table's ``kind``; PluginError where no plug-in has this name."""
    return AutoIntegrator if (kind, word) == ("integrator", AutoIntegrator.name) else registry.find(kind, word).plugin


def with_paths(tables: ReadTables, folder: Path, registry: Registry) -> Tables:
    """A copy of the tables in which the plug-ins' options that name files start at the scene file's folder."""
    result = copy.deepcopy(dict(tables))
    for name in PLUGIN_TABLES:
        plugin = _plugin(name, tables, registry)
        for field in () if plugin is None else attrs.fields(plugin):
            value = result[name].get(field.name)
            if field.metadata.get("path") and isinstance(value, str) and not Path(value).is_absolute():
                result[name][field.name] = str(folder / value)
    return result


def numbers_only(tables: ReadTables, registry: Registry) -> Tables:
    """A copy of the tables in which numbers that are text with a unit are numbers in the keys' own units."""
    result, places = dict(tables), registry.mapping("raceway_tables")
    for name, table in tables.items():
        if isinstance(table, dict):
            quantities = quantities_table(registry) if name == "quantities" else None
            study = named(places[name]) if name in places else None
            for cls in filter(None, (TABLES.get(name), study, quantities, _plugin(name, tables, registry))):
                result[name] = table_without_units(result[name], cls)
    return result


def _plugin(name: str, tables: ReadTables, registry: Registry) -> type | None:
    """The class of the plug-in that a table names, if there is one."""
    table = tables.get(name)
    if name not in PLUGIN_TABLES or not isinstance(table, dict):
        return None
    kind, default = PLUGIN_TABLES[name]
    word = table.get("kind", default)
    try:
        return options_class(kind, word, registry) if isinstance(word, str) else None
    except PluginError:
        return None
