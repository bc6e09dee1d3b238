"""The keys of a scene as fields of a form, from the schema."""

from __future__ import annotations

import re
from functools import cache

from raceway import Scene
from raceway.extend import Given, ReadTables, Tables, default_registry, leaves, parse_value, scene_schema, told

#: Tables that no run of one scene reads, or that are no numbers and words.
_WITHOUT = ("rig", "tolerances")
_UNIT = re.compile(r"^(.*?)\s*\[([^\]]+)\]$", re.DOTALL)


@cache
def _schema() -> Tables:
    return scene_schema(default_registry())


def groups(source: Given) -> list[Tables]:
    """Tables of a scene with the fields that its kinds have.

    Returns
    -------
    list of dict : name, and fields (path, label, unit, help, choices (words, or None), default (text))
    """
    tables, content = source.merged(), []
    for name, schema in _schema()["properties"].items():
        if name not in _WITHOUT:
            content.append({"name": name, "fields": _fields(name, schema, tables.get(name))})
    return content


def _fields(path: str, schema: ReadTables, values: object) -> list[Tables]:
    """Of a table, with those of the tables in it; a key alone is its own field."""
    table = values if isinstance(values, dict) else {}
    properties = dict(schema.get("properties", {}))
    if "oneOf" in schema:
        kind = table.get("kind", properties["kind"].get("default"))
        branch = next((b for b in schema["oneOf"] if b["properties"]["kind"].get("const") == kind), None)
        properties = {**properties, **({k: v for k, v in branch["properties"].items() if k != "kind"} if branch else {})}
    if not properties:
        return [_field(path, schema)]
    return [field for name, key in properties.items() for field in _fields(f"{path}.{name}", key, table.get(name))]


def _field(path: str, schema: ReadTables) -> Tables:
    text = str(schema.get("description", ""))
    words = _UNIT.match(text)
    forms = [schema, *schema.get("anyOf", ())]
    choices = [word for form in forms for word in form.get("enum", ())]
    if any(form.get("type") == "boolean" for form in forms):
        choices = ["true", "false"]
    open_ended = any(form.get("type") in ("number", "integer", "array", "object") for form in forms) or not choices
    return {
        "path": path, "label": path.partition(".")[2] or path, "unit": words[2] if words else "", "help": words[1] if words else text,
        "choices": None if open_ended else choices, "hints": choices if open_ended else [],
        "default": told(schema["default"]) if "default" in schema else "",
    }  # fmt: skip


def texts(source: Given, scene: Scene | None) -> tuple[dict[str, str], dict[str, str]]:
    """What is said of each key, and what holds for it, as texts by path; the latter is empty while the scene is refused."""
    input_texts = {path: told(value) for path, value in leaves(source.merged())}
    return input_texts, {} if scene is None else {path: told(value) for path, value in leaves(scene.to_dict())}


def value_of(text: str) -> object:
    """A value from what is typed into a field: as TOML, else as text; None takes the key out."""
    return parse_value(text.strip()) if text.strip() else None
