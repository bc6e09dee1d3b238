"""A scene file's text as plain tables, plain Python values of whatever a user hands in, and changes at dotted keys."""

import copy
import difflib
import os
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.scene.tables import TABLES, told
from raceway.storage.files import size_of, why_unreadable
from raceway.storage.tables import ReadTables, Tables

#: What makes a string the text of a scene rather than the name of a file.
_SIGNS_OF_TOML = ("\n", "=", "[")
#: Tables in tables and lists in lists; keys of scenes go five deep.
_DEEPEST = 32


def tidy(value: object, depth: int = 0) -> Any:
    """Plain Python values of a tree: numbers of numpy, tuples and paths become what a TOML file holds, quantities text.

    SceneError: A tree deeper than any scene, or what no file could hold.
    """
    if depth > _DEEPEST:
        raise SceneError.at("scene", None, f"has lists or tables nested more than {_DEEPEST} deep: no key of a scene is")
    try:
        if isinstance(value, Mapping):
            return {str(key): tidy(inner, depth + 1) for key, inner in value.items()}
        if isinstance(value, list | tuple | range):
            return [tidy(inner, depth + 1) for inner in value]
        if isinstance(value, os.PathLike):
            return os.fsdecode(value)
        if hasattr(value, "magnitude") and hasattr(value, "to_base_units"):
            # A quantity of pint is a number with its unit in text, or several; a number where it has no unit.
            from raceway.scene.units import unit_of

            quantity: Any = value
            unit = f"{quantity.units:~C}"
            try:
                unit_of(unit)
            except ValueError:  # a unit that only pint knows
                quantity = quantity.to_base_units()
                unit = f"{quantity.units:~C}"
            numbers = tidy(quantity.magnitude)
            if not unit:
                return numbers
            return [f"{number!r} {unit}" for number in numbers] if isinstance(numbers, list) else f"{numbers!r} {unit}"
        # numpy's arrays and numbers, data arrays of xarray through their values
        return value.tolist() if hasattr(value, "tolist") else copy.deepcopy(value)
    except RacewayError:
        raise
    except Exception:  # whatever a foreign object makes of being asked
        kind = type(value).__name__
        raise SceneError.at("scene", value, f"holds text, numbers, lists and tables, no {kind}") from None


def is_text(source: str) -> bool:
    """Whether a string is the text of a scene: it names no file, and has what TOML has."""
    if not any(sign in source for sign in _SIGNS_OF_TOML):
        return not source.strip()
    return not os.path.exists(source)  # nor is what is longer than a name can be


#: Bytes of a scene file at most.
_LONGEST = 2**24

#: Likeness of two files' names from which one is taken for a slip of the other.
_NEAR = 0.6


def _tomls_in(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.toml")) if folder.is_dir() else []


def read_toml(path: str | Path) -> Tables:
    """The tables of a TOML file.

    SceneError: A file that is missing, unreadable, empty or malformed, with the line.
    """
    path = Path(path)
    try:
        text = text_of(path)
    except FileNotFoundError:
        # By the name itself: what ends in .toml is alike to a third already.
        stems = {file.stem: file.name for file in _tomls_in(path.parent)}
        close = difflib.get_close_matches(path.stem, list(stems), n=1, cutoff=_NEAR)
        scenes = []
        for file in () if close else _tomls_in(path.parent):
            with suppress(OSError, ValueError):  # no text, no TOML
                scenes += [file.name] if "bearing" in tomllib.loads(file.read_text(encoding="utf-8")) else []
        hint = f" (did you mean '{stems[close[0]]}'?)" if close else ""
        hint += (
            f"; scenes there: {', '.join(scenes[:5])}{f' and {len(scenes) - 5} more' * (len(scenes) > 5)}" if scenes else ""
        )
        raise SceneError.at(str(path), None, f"no such file{hint}") from None
    except (OSError, UnicodeDecodeError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None
    return parse_toml(text, str(path))


def parse_toml(text: str, name: str) -> Tables:
    """The tables of a TOML text from ``name``; SceneError: one that is empty or malformed, with the line."""
    if not text.strip():
        raise SceneError.at(name, None, "is empty; a scene needs at least a [bearing] table (see examples/minimal.toml)")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as why:
        raise SceneError.at(name, None, f"is not valid TOML: {why}") from None
    except RecursionError:
        raise SceneError.at(name, None, "cannot be read: lists or tables are nested too deep") from None
    except ValueError:  # Python's limit for the digits of an integer
        raise SceneError.at(name, None, "cannot be read: a number has thousands of digits") from None


def text_of(path: Path, most: int = _LONGEST) -> str:
    """Text of a file of so many bytes at most, without a byte order mark.

    OSError, SceneError, UnicodeDecodeError: There is none, it is larger, or no UTF-8.
    """
    try:
        size_of(path, most)
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None
    return path.read_bytes().decode("utf-8-sig")


_ENTRY = re.compile(r"([^\[\]]+)\[(\d+)\]")
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def titled(tables: ReadTables, name: str, changes: Iterable[tuple[str, object]]) -> Tables:
    """The tables with a title that says what was changed, in its second line: the first one names the file.

    name : the title where the file has none;  changes : keys and values, the last of a key holds

    Keys are sorted: changes in another order make the same scene, and folders are named by the title.
    """
    title = tables.get("title", name)
    words = ", ".join(f"{key} = {told(value)}" for key, value in sorted(dict(changes).items()) if key != "title")
    if words and isinstance(title, str) and title.strip():
        title += (", " if "\n" in title else "\n") + words
    return {**tables, "title": title}


def parse_change(text: str) -> tuple[str, Any]:
    """``a.b=value`` as key and TOML value; what is not TOML is a string."""
    key, sign, value = text.partition("=")
    if not sign or not key.strip():
        raise SceneError.at(text, None, "must have the form table.key=value, for instance load.axial=400")
    return key.strip(), parse_value(value)


def parse_value(text: str) -> Any:
    try:
        return tomllib.loads(f"v = {text.strip()}")["v"]
    except (ValueError, RecursionError):  # no TOML, too deep, or thousands of digits: whatever it is meant for refuses it
        return text.strip()


def with_value(tables: ReadTables, key: str, value: object) -> Tables:
    """A copy of the tables with one value set at a dotted key; tables beside the key's are shared with the original."""
    result = dict(tables)
    *parents, last = key.split(".")
    table: Any = result
    for name in parents:
        inner = table.get(name, {})
        if not isinstance(inner, dict):
            raise SceneError.at(key, value, f"`{name}` is not a table")
        table[name] = dict(inner)
        table = table[name]
    if entry := _ENTRY.fullmatch(last):  # one number of several
        name, k = entry[1], int(entry[2])
        defaults = TABLES.get(parents[0]) if len(parents) == 1 else None
        field = attrs.fields_dict(defaults).get(name) if defaults is not None else None
        numbers = list(table.get(name, field.default if field is not None and isinstance(field.default, tuple) else ()))
        if k >= len(numbers):
            raise SceneError.at(key, value, f"is not there: {name} has {len(numbers)} numbers")
        last, value = name, [*numbers[:k], value, *numbers[k + 1 :]]
    table[last] = value
    return result


def value_at(tables: ReadTables, key: str) -> Any:
    """What stands at a dotted key, or None."""
    value: Any = tables
    for step in steps_of(key):
        if isinstance(step, int):
            value = value[step] if isinstance(value, list | tuple) and step < len(value) else None
        else:
            value = value.get(step) if isinstance(value, dict) else None
    return value


@lru_cache(maxsize=256)
def steps_of(path: str) -> tuple[str | int, ...]:
    """Names and places along a path: "load.radial[0]" is load, radial, 0."""
    return tuple(name or int(index) for name, index in _STEP.findall(path))


def without(tables: ReadTables, key: str) -> Tables:
    """A copy of the tables without what stands at a dotted key; what is not there may be missing."""
    name, _, path = key.partition(".")
    if not path:
        return {word: value for word, value in tables.items() if word != name}
    inner = tables.get(name)
    return {**tables, name: without(inner, path)} if isinstance(inner, dict) else dict(tables)


def leaves(table: ReadTables, before: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and values of a tree; an empty table is a value."""
    for name, value in table.items():
        if isinstance(value, dict) and value:
            yield from leaves(value, f"{before}{name}.")
        else:
            yield before + name, value
