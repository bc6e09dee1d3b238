"""Reads the TOML file of a scene."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry, default_registry
from raceway.scene.given import Given
from raceway.storage.tables import Tables
from raceway.storage.user_files import size_of, why_unreadable

if TYPE_CHECKING:
    from raceway.scene.given import Given
from raceway.scene.scene import Scene

#: Bytes of a scene file at most.
_LONGEST = 2**24


#: Likeness of two files' names from which one is taken for a slip of the other.
_NEAR = 0.6


def _tomls_in(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.toml")) if folder.is_dir() else []


def _scenes_in(folder: Path) -> list[str]:
    """Names of the TOML files in a folder that have a bearing in them."""
    found = []
    for path in _tomls_in(folder):
        try:
            if "bearing" in tomllib.loads(path.read_text(encoding="utf-8")):
                found.append(path.name)
        except (OSError, ValueError):  # no text, no TOML
            continue
    return found


def read_toml(path: str | Path) -> Tables:
    """The tables of a TOML file.

    Raises
    ------
    SceneError
        A file that is missing, unreadable, empty or malformed, with the line.
    """
    path = Path(path)
    try:
        text = _text(path)
    except FileNotFoundError:
        # By the name itself: what ends in .toml is alike to a third already.
        stems = {one.stem: one.name for one in _tomls_in(path.parent)}
        close = difflib.get_close_matches(path.stem, list(stems), n=1, cutoff=_NEAR)
        scenes = [] if close else _scenes_in(path.parent)
        hint = f" (did you mean '{stems[close[0]]}'?)" if close else ""
        hint += f"; scenes there: {', '.join(scenes[:5])}" if scenes else ""
        raise SceneError.at(str(path), None, f"no such file{hint}") from None
    except (OSError, UnicodeDecodeError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None
    return parse_toml(text, str(path))


def parse_toml(text: str, name: str) -> Tables:
    """The tables of a TOML text; ``name`` says in messages where it came from.

    Raises
    ------
    SceneError
        A text that is empty or malformed, with the line.
    """
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


def _text(path: Path) -> str:
    """Text of a scene; a byte order mark is left out.  ``OSError``, ``SceneError`` or ``UnicodeDecodeError`` where there is none."""
    try:
        size_of(path, _LONGEST)
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None
    return path.read_bytes().decode("utf-8-sig")


@door
def load_scene(path: str | Path, changes: Iterable[str] = (), registry: Registry | None = None) -> Scene:
    """A scene from a file, with ``key.path=value`` changes.

    Parameters
    ----------
    path : of a TOML file
    changes : such as ``"load.axial=400"``, values in the keys' units or as text with one
    registry : plug-ins that the scene may use; None: those of this process

    Raises
    ------
    SceneError
        With every mistake that was found.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.load_scene("examples/b7206.toml", ["load.axial=0.4 kN"]).load.axial
    400.0
    """
    given = Given(read_toml(path), Path(path).stem, Path(path).parent).changed(*changes)
    return given.scene(registry or default_registry())
