"""A scene as the user gave it: a file, TOML text, a dict of tables or a Scene, and the changes made since.

Every door of the package reads scenes here, the command line too.
"""

from __future__ import annotations

import copy
import difflib
import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.framework.doors import PATH, TEXTS, door
from raceway.framework.registry import REGISTRY, Registry, default_registry, registry_with
from raceway.scene.units import unit_of
from raceway.storage.files import size_of, why_unreadable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.scene.scene import Scene

#: What a user hands in as a scene: the scene, its path, its TOML text or its tables.
SceneSource: TypeAlias = "Scene | str | os.PathLike[str] | Mapping[str, object]"
#: A change: ``"load.axial=400"``, ``{"load.axial": 400}`` or ``{"load": {"axial": 400}}``.
Change = str | Mapping[str, object]
#: What makes a string the text of a scene rather than the name of a file.
_SIGNS_OF_TOML = ("\n", "=", "[")
#: Tables in tables and lists in lists; keys of scenes go five deep.
_DEEPEST = 32


@attrs.frozen
class Given:
    """What the user said of a scene.

    Attributes
    ----------
    tables : as they were written, presets not resolved
    name : the title where the tables have none
    folder : where relative names of files start; None: at the working folder
    changes : (key, value) in the order in which they were made; None takes the key or the table out
    """

    tables: Tables
    name: str = "untitled"
    folder: Path | None = None
    changes: tuple[tuple[str, object], ...] = ()

    def changed(self, *changes: object) -> Given:
        """With further changes, each a ``Change``.

        Raises
        ------
        SceneError
            A change that is none, or that goes through a value as if it were a table.
        """
        from raceway.scene.changes import parse_change

        key_values: list[tuple[str, object]] = []
        for change in changes:
            if isinstance(change, str):
                key_values.append(parse_change(change))
            elif isinstance(change, Mapping):
                key_values += leaves(tidy(change))
            else:
                rule = 'must be text such as "load.axial=400", or a mapping such as {"load.axial": 400}'
                raise SceneError.at("change", change, rule)
        answer = attrs.evolve(self, changes=(*self.changes, *key_values))
        answer.merged()
        return answer

    def plain(self, registry: Registry) -> Tables:
        """The tables with all changes, numbers in the keys' units, the title that states it, and files that start at the folder.

        Keys that the changes take their effect from are left out.
        """
        from raceway.scene.changes import titled, value_at
        from raceway.scene.reading import numbers_only
        from raceway.scene.unused import without_inherited

        tables = numbers_only(self.merged(), registry)
        values = [(key, None if value is None else value_at(tables, key)) for key, value in self.changes]
        tables = self._placed(tables, registry)
        if self.changes:
            base = self._placed(numbers_only(self.tables, registry), registry)
            tables = without_inherited(base, tables, [key for key, _ in self.changes], registry)
        return titled(tables, self.name, values)

    def scene(self, registry: Registry) -> Scene:
        """The scene, every key checked.

        Raises
        ------
        SceneError
            With every mistake that was found.
        """
        from raceway.scene.reading import scene_from_dict

        return attrs.evolve(scene_from_dict(self.plain(registry), registry), given=self)

    def _placed(self, tables: ReadTables, registry: Registry) -> Tables:
        """A copy with files that start at the folder."""
        from raceway.scene.reading import with_paths

        return copy.deepcopy(dict(tables)) if self.folder is None else with_paths(tables, self.folder, registry)

    def merged(self) -> Tables:
        """The tables with all changes, as they were said."""
        from raceway.scene.changes import with_value, without

        tables = self.tables
        for key, value in self.changes:
            tables = without(tables, key) if value is None else with_value(tables, key, value)
        return tables


def as_given(source: object) -> Given:
    """What a user hands in as a scene.

    Parameters
    ----------
    source : Scene, path (str or Path), TOML text, or dict of tables

    Raises
    ------
    SceneError
        Something else; a file that is missing, unreadable or no TOML.
    """
    from raceway.scene.scene import Scene

    if isinstance(source, Scene):
        return source.given if source.given is not None else Given(copy.deepcopy(source.source))
    if isinstance(source, Mapping):
        return Given(tidy(source))
    if isinstance(source, str) and _is_text(source):
        return Given(tidy(_parse_toml(source, "scene")))
    if isinstance(source, str | os.PathLike):
        path = Path(tidy(source))
        if isinstance(source, str) and not path.suffix and not os.path.exists(path):
            raise SceneError.at("scene", source, "is neither a file nor the TOML text of a scene")
        if os.path.isdir(path):
            inside = sorted(str(p) for p in path.glob("*.toml"))
            hint = f"; scenes in it: {', '.join(inside[:5])}" if inside else " without a scene (*.toml) in it"
            raise SceneError.at(str(path), None, f"is a folder{hint}")
        return Given(tidy(read_toml(path)), path.stem, path.parent)
    rule = f"must be a file, TOML text, a dict of tables or a Scene, not {type(source).__name__}"
    raise SceneError.at("scene", None, rule)


def as_scene(source: SceneSource, *changes: Change, plugins: Iterable[str | Path] = ()) -> Scene:
    """A scene of whatever a user hands in as one.

    Parameters
    ----------
    source : Scene, path (str or Path), TOML text, or dict of tables
    changes : as ``Given.changed`` takes them
    plugins : files of one-off plug-ins that are loaded before

    Raises
    ------
    SceneError
        With every mistake that was found.
    PluginError
        A plug-in file that is missing, fails to import or adds nothing.
    """
    from raceway.scene.scene import Scene

    registry = registry_with(plugins)
    if isinstance(source, Scene) and not changes:
        return source
    return as_given(source).changed(*changes).scene(registry)


def evolve(scene: Any, *changes: Change) -> Scene:
    """A scene with some keys changed, as ``--set`` does on the command line.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    changes : str or mapping
        ``"load.axial=400"`` with the value as TOML, or ``{"load.axial": 400}``; None takes a key or a table out

    Returns
    -------
    Scene : whose title says in its second line what was changed

    Raises
    ------
    SceneError
        With every mistake of the scene and its changes.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = rw.evolve({"bearing": {"preset": "B7206C"}}, "load.axial=400", {"supports.tilt": "free"})
    >>> scene.load.axial, scene.supports.tilt
    (400.0, 'free')
    """
    return as_scene(scene, *changes)


def plain_tables(source: object, *changes: Change, registry: Registry) -> Tables:
    """The tables of a scene, its title among them, for what makes many scenes of one; not checked.

    Raises
    ------
    SceneError
        A source that is no scene, or a change that cannot be made.
    """
    return as_given(source).changed(*changes).plain(registry)


def tidy(value: object, depth: int = 0) -> Any:
    """Plain Python values of a tree: numbers of numpy, tuples and paths become what a TOML file holds, quantities text.

    Raises
    ------
    SceneError
        A tree deeper than any scene, or what no file could hold.
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
        if hasattr(value, "tolist"):  # numpy's arrays and numbers, data arrays of xarray through their values
            return value.tolist()
        return copy.deepcopy(value)
    except RacewayError:
        raise
    except Exception:  # whatever a foreign object makes of being asked
        kind = type(value).__name__
        raise SceneError.at("scene", value, f"holds text, numbers, lists and tables, no {kind}") from None


def leaves(table: ReadTables, before: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and values of a tree; an empty table is a value."""
    for name, value in table.items():
        if isinstance(value, dict) and value:
            yield from leaves(value, f"{before}{name}.")
        else:
            yield before + name, value


def _is_text(source: str) -> bool:
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

    Raises
    ------
    SceneError
        A file that is missing, unreadable, empty or malformed, with the line.
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
        hint += f"; scenes there: {', '.join(scenes[:5])}" if scenes else ""
        raise SceneError.at(str(path), None, f"no such file{hint}") from None
    except (OSError, UnicodeDecodeError) as why:
        raise SceneError.at(str(path), None, f"cannot be read: {why_unreadable(why)}") from None
    return _parse_toml(text, str(path))


def _parse_toml(text: str, name: str) -> Tables:
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


def text_of(path: Path, most: int = _LONGEST) -> str:
    """Text of a file of so many bytes at most, without a byte order mark.

    Raises
    ------
    OSError, SceneError, UnicodeDecodeError
        There is none, it is larger, or no UTF-8.
    """
    try:
        size_of(path, most)
    except ValueError as why:
        raise SceneError.at(str(path), None, str(why)) from None
    return path.read_bytes().decode("utf-8-sig")


@door
def load_scene(
    path: Annotated[str | Path, PATH],
    changes: Annotated[Iterable[str], TEXTS] = (),
    registry: Annotated[Registry | None, REGISTRY] = None,
) -> Scene:
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
    user_input = Given(read_toml(path), Path(path).stem, Path(path).parent).changed(*changes)
    return user_input.scene(registry or default_registry())
