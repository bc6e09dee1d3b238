"""The scene: what the user said, as a frozen tree of attrs objects, validated, SI."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import attrs

from raceway.framework.doors import reader
from raceway.framework.shown import Fact, Shown
from raceway.scene.bearing import Bearing
from raceway.scene.heat import Heat
from raceway.scene.inputs import Given
from raceway.scene.lubricant import Lubricant
from raceway.scene.tables import (
    TABLES,
    AutoIntegrator,
    Contact,
    Identifying,
    Integration,
    Kinematics,
    Load,
    Mounting,
    Rotor,
    Supports,
    told,
)
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import os


@attrs.frozen(repr=False)
class SceneTables:
    """Tables of a scene file, and plug-ins with their options; excitation, mesh, lubricant and heat may be None."""

    bearing: Bearing
    supports: Supports
    rotor: Rotor
    load: Load
    excitation: Any
    bodies: Any
    mesh: Any
    contact: Contact
    lubricant: Lubricant | None
    heat: Heat | None
    kinematics: Kinematics
    mounting: Mounting
    integrator: Integration
    identifier: Identifying
    quantities: Any


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
    source: Tables = attrs.field(repr=False, eq=False)
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
        from raceway.scene.inputs import as_scene

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
        from raceway.scene.inputs import as_scene

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
        from raceway.scene.inputs import as_scene

        return as_scene(self, tables)

    def _facts(self) -> tuple[str, list[Fact]]:
        """What was said, a table a row; defaults and a preset's numbers are left out."""
        from raceway.scene.inputs import as_given, leaves

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
                tables[name] = _plain_table(part)
        if self.integrator.kind == AutoIntegrator.name:  # defaults that are written out would ask for a transient
            keys = ("kind", *self.source.get("integrator", ()))
            tables["integrator"] = {key: value for key, value in tables["integrator"].items() if key in keys}
        for name in ("bodies", "excitation", "mesh"):
            plugin = getattr(self, name)
            if plugin is not None:
                tables[name] = {"kind": plugin.name, **_plain_table(plugin)}
        plugins = [getattr(self.quantities, field.name) for field in attrs.fields(type(self.quantities))]
        if options := {plugin.name: _plain_table(plugin) for plugin in plugins if plugin != type(plugin)()}:
            tables["quantities"] = options
        return tables


def _plain_table(part: attrs.AttrsInstance) -> Tables:
    out: Tables = {}
    cls: type = type(part)
    for name, plugin in _keys(cls):
        value = getattr(part, name)
        if plugin:
            out.update(_plain_table(value))
        elif isinstance(value, float | str):
            out[name] = value
        elif attrs.has(type(value)):
            out[name] = _plain_table(value)
        elif value is not None and value != ():
            out[name] = _lists(value)
    return out


@cache
def _keys(cls: type) -> tuple[tuple[str, bool], ...]:
    """Names of a table's keys, and whether it is the slot of a plug-in."""
    return tuple((field.name, "plugin" in field.metadata) for field in attrs.fields(cls))


def _lists(value: Any) -> object:
    if isinstance(value, tuple):
        return [_lists(part) for part in value]
    return _plain_table(value) if attrs.has(type(value)) else value


SCENE = reader("a Scene, as raceway.load_scene reads it", Scene)
