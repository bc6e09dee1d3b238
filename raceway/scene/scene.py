"""The scene: what the user said, as a frozen tree of attrs objects, validated, SI."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import attrs

from raceway.errors import SceneError
from raceway.framework.doors import PATH, TEXTS, door, reader
from raceway.framework.loading.registry import REGISTRY, Registry, default_registry, registry_with
from raceway.framework.shown import Fact, Shown
from raceway.scene.inputs import (
    is_text,
    leaves,
    parse_change,
    parse_toml,
    read_toml,
    tidy,
    titled,
    value_at,
    with_value,
    without,
)
from raceway.scene.reading import numbers_only, read_tables, with_paths
from raceway.scene.tables import TABLES, AutoIntegrator, SceneTables, plain_table, told
from raceway.scene.unused import without_inherited
from raceway.storage.tables import ReadTables, Tables

#: A change: ``"load.axial=400"``, ``{"load.axial": 400}`` or ``{"load": {"axial": 400}}``.
Change = str | Mapping[str, object]


@attrs.frozen
class Given:
    """What the user said of a scene.

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

        SceneError: A change that is none, or that goes through a value as if it were a table.
        """
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
        tables = numbers_only(self.merged(), registry)
        values = [(key, None if value is None else value_at(tables, key)) for key, value in self.changes]
        tables = self._placed(tables, registry)
        if self.changes:
            base = self._placed(numbers_only(self.tables, registry), registry)
            tables = without_inherited(base, tables, [key for key, _ in self.changes], registry)
        return titled(tables, self.name, values)

    def scene(self, registry: Registry) -> Scene:
        """The scene, every key checked.

        SceneError: With every mistake that was found.
        """
        return attrs.evolve(scene_from_dict(self.plain(registry), registry), given=self)

    def _placed(self, tables: ReadTables, registry: Registry) -> Tables:
        """A copy with files that start at the folder."""
        return copy.deepcopy(dict(tables)) if self.folder is None else with_paths(tables, self.folder, registry)

    def merged(self) -> Tables:
        """The tables with all changes, as they were said."""
        tables = self.tables
        for key, value in self.changes:
            tables = without(tables, key) if value is None else with_value(tables, key, value)
        return tables


@attrs.frozen(repr=False)
class Scene(SceneTables, Shown):
    """One scene: what is computed, in SI units, every key checked.

    Attributes
    ----------
    title : str, says in its second line what was changed since it was read
    bearing, supports, rotor, load, contact, kinematics, mounting, integrator, identifier : tables of the scene file
    lubricant, heat : their tables, or None
    excitation, bodies, mesh : plug-ins with their options; excitation and mesh may be None
    quantities : an attribute for each plug-in of quantities, with its options
    source : the tree of plain tables it was made from, presets resolved
    given : what the user said, presets not resolved, from which ``with_`` goes on

    Examples
    --------
    >>> import raceway as rw
    >>> scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> scene.load.axial  # [N]
    1000.0
    >>> scene
    untitled
      bearing  preset = B7206C
      load     axial = 1000
    """

    title: str
    given: Given | None = attrs.field(default=None, repr=False, eq=False)

    @classmethod
    def from_toml(cls, source: str | os.PathLike[str]) -> Scene:
        """Read a scene from a TOML file, or from TOML text.

        Parameters
        ----------
        source : path of a file (str or Path), or the text itself

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> rw.Scene.from_toml('bearing.preset = "B7206C"').bearing.ball_count
        12
        """
        return as_scene(source)

    @classmethod
    def from_dict(cls, tables: ReadTables) -> Scene:
        """Read a scene from a dict of tables, as a TOML file would give them.

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "supports": {"tilt": "free"}}).supports.tilt
        'free'
        """
        return as_scene(tables)

    def with_(self, **tables: object) -> Scene:
        """This scene with some keys changed; the plug-ins of this process are known.

        Parameters
        ----------
        tables : by name, each a dict that is merged into the table; None takes a table or key out

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
        >>> scene.with_(load={"axial": 400.0}, supports={"tilt": "free"}).load.axial
        400.0
        """
        return as_scene(self, tables)

    def _facts(self) -> tuple[str, list[Fact]]:
        """What was said, a table a row; defaults and a preset's numbers are left out."""
        rows: list[Fact] = []
        for name, table in as_given(self).merged().items():
            if isinstance(table, dict):
                keys = [f"{key} = {told(value)}" for key, value in leaves(table)]
                rows.append((name, "", ", ".join(keys) or "defaults"))
        return self.title, rows

    def to_dict(self) -> Tables:
        """Every key of the scene file with its value, defaults too; loads again as the same scene."""
        tables: Tables = {"title": self.title}
        for name in TABLES:
            part = getattr(self, name)
            if part is not None:
                tables[name] = plain_table(part)
        if self.integrator.kind == AutoIntegrator.name:  # defaults that are written out would ask for a transient
            keys = ("kind", *self.source.get("integrator", ()))
            tables["integrator"] = {key: value for key, value in tables["integrator"].items() if key in keys}
        for name in ("bodies", "excitation", "mesh"):
            plugin = getattr(self, name)
            if plugin is not None:
                tables[name] = {"kind": plugin.name, **plain_table(plugin)}
        plugins = [getattr(self.quantities, field.name) for field in attrs.fields(type(self.quantities))]
        if options := {plugin.name: plain_table(plugin) for plugin in plugins if plugin != type(plugin)()}:
            tables["quantities"] = options
        return tables


#: What a user hands in as a scene: the scene, its path, its TOML text or its tables.
SceneSource: TypeAlias = "Scene | str | os.PathLike[str] | Mapping[str, object]"
SCENE = reader("a Scene, as raceway.load_scene reads it", Scene)


@door
def scene_from_dict(
    tables: Annotated[ReadTables, reader("a mapping, such as a dict", Mapping)],
    registry: Annotated[Registry | None, REGISTRY] = None,
) -> Scene:
    """A scene from plain tables, as a TOML file would give them.

    Parameters
    ----------
    tables : by name, values in the keys' units or as text with one
    registry : plug-ins that the scene may use; None: those of this process

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
    title, content, checked = read_tables(tables, registry or default_registry())
    parts = {table.name: getattr(checked, table.name) for table in attrs.fields(SceneTables)}
    return Scene(title=title, given=Given(content), **parts)


def as_given(source: object) -> Given:
    """What a user hands in as a scene.

    source : Scene, path (str or Path), TOML text, or dict of tables

    SceneError: Something else; a file that is missing, unreadable or no TOML.
    """
    if isinstance(source, Scene):
        return source.given if source.given is not None else Given(copy.deepcopy(source.source))
    if isinstance(source, Mapping):
        return Given(tidy(source))
    if isinstance(source, str) and is_text(source):
        return Given(tidy(parse_toml(source, "scene")))
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
    registry = registry_with(plugins)
    return source if isinstance(source, Scene) and not changes else as_given(source).changed(*changes).scene(registry)


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

    SceneError: A source that is no scene, or a change that cannot be made.
    """
    return as_given(source).changed(*changes).plain(registry)


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
