"""A scene file's text as plain tables, and plain Python values of whatever a user hands in."""

import copy
import difflib
import os
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from raceway.errors import RacewayError, SceneError
from raceway.storage.files import size_of, why_unreadable
from raceway.storage.tables import Tables

#: What makes a string the text of a scene rather than the name of a file.
_SIGNS_OF_TOML = ("\n", "=", "[")
#: Tables in tables and lists in lists; keys of scenes go five deep.
_DEEPEST = 32


def tidy(value: object, depth: int = 0) -> Any:
    """Plain Python values of a tree: numbers of numpy, tuples and paths become what a TOML file holds, quantities text.

    SceneError: A tree deeper than any scene, or what no file could hold.
    """
    if depth > _DEEPEST:
        raise SceneError.at(
            "scene", None, f"has lists or tables that are nested more than {_DEEPEST} deep: no key of a scene is"
        )
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
