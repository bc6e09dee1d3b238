"""JSON schema (draft 2020-12) of a scene file, from the same declarations that check it.

Editors use it for completion and for underlining mistakes.  It knows types, units, ranges, words and the options of every
installed plug-in; rules between keys (balls that fit the pitch circle) are the loader's alone.
"""

from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

import attrs

from raceway.framework.loading import named
from raceway.framework.loading.registry import Registry, default_registry
from raceway.scene.bearing import materials
from raceway.scene.catalogue import catalogue
from raceway.scene.structure import table_of_list
from raceway.scene.tables import PLUGIN_TABLES as PLUGIN_TABLES
from raceway.scene.tables import TABLES, AutoIntegrator, quantities_table
from raceway.scene.units import PATTERN
from raceway.storage.tables import Tables

_TYPES = {float: "number", int: "integer", str: "string", bool: "boolean"}
_LIMITS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


def scene_schema(registry: Registry | None = None) -> Tables:
    """The schema of everything that this installation accepts, third-party plug-ins included."""
    registry = registry or default_registry()
    tables: Tables = {"title": {"type": "string", "minLength": 1, "description": "for people and folder names"}}
    for name, cls in TABLES.items():
        if name not in PLUGIN_TABLES:
            tables[name] = _table_schema(cls)
    # Geometry is required unless a preset gives it.
    bearing = tables["bearing"]
    bearing["anyOf"] = [{"required": ["preset"]}, {"required": bearing.pop("required")}]
    bearing["properties"]["preset"]["enum"] = list(catalogue())
    for part in ("rings", "balls"):
        bearing["properties"][part]["properties"]["material"]["enum"] = list(materials())
    for name, (kind, default) in PLUGIN_TABLES.items():
        tables[name] = _plugin_table(name, kind, default, registry)
    for name, place in registry.mapping("raceway_tables").items():
        tables[name] = _table_schema(named(place))
    tables["quantities"] = _table_schema(quantities_table(registry))
    words = 'by how much numbers may differ: "load.axial" = "±10 %", class = "P4" (ISO 492, ABEC), balls = "G5" (ISO 3290)'
    tables["tolerances"] = {"type": "object", "description": words}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Raceway scene",
        "description": 'SI units; a key that is not SI base says so in its name (_rpm, _deg).  Text with a unit is converted: "1 kN".',
        "type": "object",
        "properties": tables,
        "required": ["bearing"],
        "additionalProperties": False,
    }


def _table_schema(cls: type) -> Tables:
    fields = keys(cls)
    return {
        "type": "object",
        "properties": {field.name: key_schema(field) for field in fields},
        "required": [field.name for field in fields if field.default is attrs.NOTHING],
        "additionalProperties": False,
    }


def _plugin_table(name: str, kind: str, default: str | None, registry: Registry) -> Tables:
    """One branch for each installed plug-in, told apart by ``kind``."""
    hidden_names = registry.shadowed()
    usable = {e.name: e.plugin for e in registry.of_kind(kind) if (e.kind, e.name) not in hidden_names}
    if default == AutoIntegrator.name:
        usable = {default: AutoIntegrator, **usable}
    branches = []
    for word, plugin in usable.items():
        branch = _table_schema(plugin)
        core = _table_schema(TABLES[name])["properties"] if name in TABLES else {}
        words = {"const": word, "description": (plugin.__doc__ or "").strip().partition("\n")[0]}
        branch["properties"] = {**core, **branch["properties"], "kind": words}
        if word != default:
            branch["required"].insert(0, "kind")
        branches.append({"title": f"{name}: {word}", **branch})
    schema: Tables = {"type": "object"}
    if not branches:
        return {**schema, "not": {}, "description": f"no {kind.replace('_', ' ')} is installed"}
    kinds: Tables = {"enum": list(usable), **({} if default is None else {"default": default})}
    return {**schema, "properties": {"kind": kinds}, "oneOf": branches}


def keys(cls: type) -> list[Any]:
    """The attrs fields of a class that a user can write, with resolved types."""
    attrs.resolve_types(cls)
    return [field for field in attrs.fields(cls) if "plugin" not in field.metadata and field.init]


def key_schema(field: Any) -> Tables:
    """The schema of one key: type, range or words, default, help and unit."""
    if attrs.has(field.type):
        return {**_table_schema(field.type), "description": field.metadata.get("help", "")}
    facts = dict(getattr(field.validator, "facts", {}))
    words, pattern = facts.pop("words", None), facts.pop("pattern", None)
    members = get_args(field.type) if get_origin(field.type) in (Union, UnionType) else [field.type]
    kinds = [k for k in members if k is not NoneType and (words is None or k is not str)]
    limits = {key: facts[key] for key in _LIMITS if key in facts}
    unit, text = field.metadata.get("unit", ""), field.metadata.get("help", "")
    forms = [form for kind in kinds for form in _forms(kind, limits, bool(unit))]
    if words is not None:
        forms.append({"enum": words})
    if pattern is not None:
        forms.append({"type": "string", "pattern": pattern})
    schema: Tables = forms[0] if len(forms) == 1 else {"anyOf": forms}
    if "enum" in facts:
        schema["enum"] = facts["enum"]
    schema["description"] = f"{text} [{unit}]" if unit else text
    if field.default is not attrs.NOTHING and field.default is not None and not isinstance(field.default, attrs.Factory):  # type: ignore[arg-type]
        schema["default"] = list(field.default) if isinstance(field.default, tuple) else field.default
    return schema


def _forms(kind: Any, limits: dict[str, float], with_unit: bool) -> list[Tables]:
    """What a value may look like; one that is measured may be text with a unit, whose limits the loader alone checks."""
    if (table := table_of_list(kind)) is not None:
        return [{"type": "array", "items": _table_schema(table)}]
    if get_origin(kind) is tuple:
        items = get_args(kind)
        inner = _forms(items[0], {}, with_unit)
        array: Tables = {"type": "array", "items": inner[0] if len(inner) == 1 else {"anyOf": inner}}
        return [array if items[-1] is Ellipsis else {**array, "minItems": len(items), "maxItems": len(items)}]
    if attrs.has(kind):  # a material, or its name alone
        return [_table_schema(kind), {"type": "string", "enum": list(materials())}]
    if kind not in _TYPES:
        return [{}]
    form = {"type": _TYPES[kind], **(limits if kind in (float, int) else {})}
    return [form, {"type": "string", "pattern": PATTERN}] if with_unit and kind is float else [form]
