"""Reads a scene from TOML: presets, ``--set`` changes, plug-ins' options; all mistakes at once, each with its path."""

from __future__ import annotations

import copy
import difflib
import json
import tomllib
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import Mistake, PluginError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.scene.catalogue import preset
from raceway.scene.given import Given
from raceway.scene.materials import with_material
from raceway.scene.requires import check_requires
from raceway.scene.rig import Rig
from raceway.scene.sets import GEOMETRY
from raceway.scene.structure import structure, table_without_units
from raceway.scene.tables import TABLES, Scene
from raceway.scene.tolerance import check_tolerances
from raceway.storage.tables import ReadTables, Tables
from raceway.storage.user_files import size_of, why_unreadable

if TYPE_CHECKING:
    from collections.abc import Hashable

#: Tables whose ``kind`` names a plug-in: the plug-in's kind, and the kind where the table names none.
PLUGIN_TABLES = {
    "excitation": ("excitation", None),
    "bodies": ("bodies", "rigid"),
    "mesh": ("mesher", "structured"),
    "contact": ("contact_law", "hertz"),
    "integrator": ("integrator", "newmark"),
    "identifier": ("identifier", "fft_1x"),
}
#: Those of them that may be absent, which means something.
OPTIONAL_TABLES = ("excitation", "mesh")
#: Tables whose kinds are swapped most: keys of another kind stay without effect, which ``raceway.scene.unused`` tells.
SWAPPED_TABLES = ("bodies",)
#: Bytes of a scene file at most.
_LONGEST = 2**24
#: Likeness of two files' names from which one is taken for a slip of the other.
_NEAR = 0.6
#: Tables that a study reads beside the scene, which keeps them in ``source``.
STUDY_TABLES: dict[str, type] = {"rig": Rig}


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
    result = dict(tables)
    for name, table in tables.items():
        if isinstance(table, dict):
            classes = (TABLES.get(name), STUDY_TABLES.get(name), _plugin(name, tables, registry))
            for cls in (one for one in classes if one is not None):
                result[name] = table_without_units(result[name], cls)
    return result


def _plugin(name: str, tables: ReadTables, registry: Registry) -> type | None:
    """The class of the plug-in that a table names, if there is one."""
    table = tables.get(name)
    if name not in PLUGIN_TABLES or not isinstance(table, dict):
        return None
    kind, default = PLUGIN_TABLES[name]
    word = table.get("kind", default)
    if not isinstance(word, str) or word not in registry.names(kind) or (kind, word) in registry.shadowed():
        return None
    return registry.find(kind, word).plugin


def titled(tables: ReadTables, name: str, changes: Iterable[tuple[str, object]]) -> Tables:
    """The tables with a title that says what was changed, in its second line: the first one tells of the file.

    Parameters
    ----------
    name : the title where the file has none;  changes : keys and values, the last of a key holds

    Notes
    -----
    Keys are sorted: changes in another order make the same scene, and folders are named by the title.
    """
    title = tables.get("title", name)
    made = ", ".join(f"{key} = {told(value)}" for key, value in sorted(dict(changes).items()) if key != "title")
    if made and isinstance(title, str) and title.strip():
        title += (", " if "\n" in title else "\n") + made
    return {**tables, "title": title}


def told(value: object) -> str:
    """A value as it stands in a scene file, words without quotes; 400.0 is 400."""
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        value = int(value)
    return json.dumps(value, default=str)


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
    table[last] = value
    return result


def value_at(tables: ReadTables, key: str) -> Any:
    """What stands at a dotted key, or None."""
    found: Any = tables
    for name in key.split("."):
        found = found.get(name) if isinstance(found, dict) else None
    return found


def without(tables: ReadTables, key: str) -> Tables:
    """A copy of the tables without what stands at a dotted key; what is not there may be missing."""
    name, _, rest = key.partition(".")
    if not rest:
        return {word: value for word, value in tables.items() if word != name}
    inner = tables.get(name)
    return {**tables, name: without(inner, rest)} if isinstance(inner, dict) else dict(tables)


def scene_from_dict(
    tables: ReadTables, registry: Registry | None = None, known_parts: dict[Hashable, Any] | None = None
) -> Scene:
    """A scene from plain tables, as a TOML file would give them.

    Parameters
    ----------
    tables : by name, values in the keys' units or as text with one
    registry : plug-ins that the scene may use; None: those of this process
    known_parts : of scenes that were read before with the same registry, by the tables they stood in; the parts that this
        scene shares with them are taken from there, and its own are added

    Raises
    ------
    SceneError
        With every mistake that was found.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}}).load.axial  # [N]
    400.0
    """
    registry = registry or default_registry()
    mistakes: list[Mistake] = []
    title, said = _known_tables(tables, registry, mistakes)
    plain = numbers_only(said, registry)
    if "bearing" in plain:
        plain["bearing"] = _with_preset(plain["bearing"], mistakes)
    parts: Tables = {}
    known_parts = {} if known_parts is None else known_parts

    def read(name: str, table: object, make: Callable[[], object]) -> Any:
        mark, before = (name, repr(table)), len(mistakes)  # not the table itself: 1, 1.0 and true are equal, and not alike
        if mark in known_parts:
            return known_parts[mark]
        part = make()
        if len(mistakes) == before:
            known_parts[mark] = part
        return part

    for name, cls in TABLES.items():
        if name in PLUGIN_TABLES or (name == "bearing" and name not in plain):
            continue
        table = plain.get(name, {})
        parts[name] = read(name, table, partial(structure, table, cls, name, mistakes))
    for name, (kind, default) in PLUGIN_TABLES.items():
        parts[name] = None
        if name in plain or name not in OPTIONAL_TABLES:
            table = plain.get(name, {})
            parts[name] = read(name, table, partial(_plugin_table, name, kind, default, table, registry, mistakes))
    for name, cls in STUDY_TABLES.items():
        if name in plain:
            structure(plain[name], cls, name, mistakes)
    if mistakes:
        raise SceneError(mistakes)
    scene = Scene(title=title, source=plain, given=Given(said), **parts)
    if faults := check_tolerances(scene):
        raise SceneError(faults)
    return scene


def _known_tables(tables: ReadTables, registry: Registry, mistakes: list[Mistake]) -> tuple[str, Tables]:
    """Title, and a copy of the known tables."""
    known = [*dict.fromkeys((*TABLES, *PLUGIN_TABLES)), *STUDY_TABLES, "tolerances", "requires", "title"]
    for name in tables:
        if name not in known:
            mistakes.append(Mistake(name, None, f"unknown table{nearest(name, known)}; known: {', '.join(known)}"))
    title = tables.get("title", "untitled")
    if not isinstance(title, str) or not title.strip():
        mistakes.append(Mistake("title", title, "must be a string that is not empty"))
        title = "untitled"
    plain = {name: copy.deepcopy(tables[name]) for name in known if name in tables}
    for name in list(plain):
        if name != "title" and not isinstance(plain[name], dict):
            mistakes.append(Mistake(name, plain[name], f"must be a table: write [{name}] and keys below it"))
            plain[name] = {}
    check_requires(plain.get("requires", {}), registry, mistakes)
    if "bearing" not in plain:
        mistakes.append(Mistake("bearing", None, 'is required: for instance [bearing] with preset = "B7206C"'))
    return title, plain


def rig_of(scene: Scene) -> Rig:
    """The table ``[rig]`` of a scene.

    Raises
    ------
    SceneError
        There is none.
    """
    if "rig" not in scene.source:
        raise SceneError.at(
            "rig", None, "is required: a table [rig] with shaft, disc and sensor (see examples/test_rig.toml)"
        )
    mistakes: list[Mistake] = []
    rig = structure(scene.source["rig"], Rig, "rig", mistakes)
    if rig is None:
        raise SceneError(mistakes)
    return rig


def _with_preset(table: Tables, mistakes: list[Mistake]) -> Tables:
    table = _with_rows(table, mistakes)
    name = table.get("preset")
    if name is None:
        return _with_materials(table, {}, mistakes)
    try:
        values = preset(name)
    except SceneError as error:
        mistakes += error.mistakes
        return {**_PLACEHOLDER, **table, "preset": None}
    merged = {**values, **table}
    if "radial_clearance" in table and "contact_angle_deg" not in table:
        merged["contact_angle_deg"] = 0.0
    if "contact_angle_deg" in table and "radial_clearance" not in table:
        merged.pop("radial_clearance", None)
    return _with_materials(merged, values, mistakes)


def _with_materials(table: Tables, preset: Tables, mistakes: list[Mistake]) -> Tables:
    """The table [bearing] with the numbers of named materials, and those of the preset below what the user says."""
    made = dict(table)
    for part in ("rings", "balls"):
        if isinstance(table.get(part), dict):
            try:
                made[part] = with_material(table[part], f"bearing.{part}", preset.get(part, {}))
            except SceneError as error:
                mistakes += error.mistakes
                made[part] = {**preset.get(part, {}), **table[part], "material": None}
    return made


def _with_rows(table: Tables, mistakes: list[Mistake]) -> Tables:
    """The [bearing] table whose rows have the numbers of their presets; without a bearing of its own it is the first row's."""
    rows = table.get("row")
    if not isinstance(rows, list | tuple):
        return table
    found = []
    for k, row in enumerate(rows):
        name = row.get("preset") if isinstance(row, dict) else None
        if name is not None:
            try:
                values = preset(name)
            except SceneError as error:
                mistakes += [Mistake(f"bearing.row[{k}].preset", one.value, one.message) for one in error.mistakes]
                row = {key: value for key, value in row.items() if key != "preset"}
            else:
                row = {**{key: value for key, value in values.items() if key in GEOMETRY}, **row}
        found.append(row)
    if (
        rows
        and "preset" not in table
        and "ball_diameter" not in table
        and isinstance(found[0], dict)
        and "preset" in found[0]
    ):
        table = {**table, "preset": found[0]["preset"]}
    return {**table, "row": found}


#: Stands in for a preset that does not exist, so that the other keys of the table are still checked.
_PLACEHOLDER = {
    "ball_diameter": 0.01,
    "pitch_diameter": 0.05,
    "width": 0.015,
    "ball_count": 8,
    "conformity_inner": 0.52,
    "conformity_outer": 0.52,
}


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
    own = [] if core is None else [f.name for f in attrs.fields(core) if "plugin" not in f.metadata]
    shared = {key: value for key, value in table.items() if key in own}
    try:
        plugin = registry.find(kind, word).plugin
    except PluginError as error:
        mistakes.append(Mistake(f"{name}.kind", word, str(error)))
        if core is not None:
            structure({k: v for k, v in shared.items() if k != "kind"}, core, name, mistakes)
        return None
    options = {key: value for key, value in table.items() if key not in own and key != "kind"}
    known = [*own, *(a.name for a in attrs.fields(plugin))]
    if name in SWAPPED_TABLES:
        others = {a.name for e in registry.all() if e.kind == kind for a in attrs.fields(e.plugin)}
        options = {key: value for key, value in options.items() if key in known or key not in others}
    for key in [k for k in options if k not in known]:
        rule = f"unknown key{nearest(key, known)}; known for kind '{word}': {', '.join(k for k in known if k != 'kind')}"
        mistakes.append(Mistake(f"{name}.{key}", options.pop(key), rule))
    method = structure(options, plugin, name, mistakes)
    if core is None:
        return method
    frame: Any = structure({**shared, "kind": word}, core, name, mistakes)
    slot = next(f.name for f in attrs.fields(core) if "plugin" in f.metadata)
    return None if frame is None or method is None else attrs.evolve(frame, **{slot: method})
