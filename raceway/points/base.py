"""A scene that points change: its tables at a point, and the values of axes in the units of its keys."""

from __future__ import annotations

import attrs

from raceway.errors import PluginError, SceneError
from raceway.framework.loading.registry import Registry
from raceway.points.axes import Axis, Design, Vary, parse_axes, shown
from raceway.scene.inputs import value_at, with_value
from raceway.scene.reading import numbers_only, options_class
from raceway.scene.scene import Scene, SceneSource, plain_tables, scene_from_dict
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.scene.units import is_quantity
from raceway.scene.unused import without_inherited
from raceway.storage.tables import ReadTables, Tables


def tables_at(tables: ReadTables, point: ReadTables, registry: Registry, notes: list[str] | None = None) -> Tables:
    """The scene's tables at one point; what is left out with a change of kind is said in ``notes``, once each.

    Keys of the scene that the point takes their effect from are left out without a word.
    """
    scene_tables = dict(tables)
    # Kinds first: what another axis sets must not be taken for an option of the old kind.
    for key, value in sorted(point.items(), key=lambda item: not item[0].endswith(".kind")):
        name, _, last = key.rpartition(".")
        if last == "kind" and name in PLUGIN_TABLES and isinstance(value, str):
            for option in _strange_options(scene_tables, name, value, registry):
                value_before = scene_tables[name][option]
                scene_tables[name] = {k: v for k, v in scene_tables[name].items() if k != option}
                note = f"{name}.{option} = {shown(value_before)} is omitted for kind '{value}', which lacks it"
                if notes is not None and note not in notes:
                    notes.append(note)
        scene_tables = with_value(scene_tables, key, value)
    return without_inherited(tables, scene_tables, point, registry)


def numbers_at(tables: ReadTables, point: ReadTables, registry: Registry) -> Tables:
    """A point whose values with a unit as text are numbers in the unit of their key."""
    texts = [key for key, value in point.items() if isinstance(value, str) and is_quantity(value)]
    if not texts:
        return dict(point)
    numbers = numbers_only(tables_at(tables, point, registry), registry)
    return {**point, **{key: value_at(numbers, key) for key in texts}}


def _strange_options(tables: ReadTables, name: str, kind: str, registry: Registry) -> list[str]:
    """Options in a table that its present kind knows and the new kind does not; typing mistakes are not among them."""
    table = tables.get(name)
    role, default = PLUGIN_TABLES[name]
    if not isinstance(table, dict):
        return []
    words = (str(table.get("kind", default)), kind)
    try:
        old, new = ({field.name for field in attrs.fields(options_class(role, word, registry))} for word in words)
    except PluginError:
        return []  # the scene's own check names the unknown kind
    core = {field.name for field in attrs.fields(TABLES[name])} if name in TABLES else set()
    return [option for option in table if option in old - new - core]


@attrs.frozen
class Base:
    """A scene's tables, at whose keys points give other values; ``registry`` has the plug-ins that it and they name."""

    tables: ReadTables
    registry: Registry

    @classmethod
    def of(cls, scene: SceneSource, registry: Registry) -> Base:
        return cls(plain_tables(scene, registry=registry), registry)

    def tables_at(self, point: ReadTables, notes: list[str] | None = None) -> Tables:
        return tables_at(self.tables, point, self.registry, notes)

    def scene_at(self, point: ReadTables, notes: list[str] | None = None) -> Scene:
        """The scene at a point.

        SceneError: Mistakes in its tables.
        """
        return scene_from_dict(self.tables_at(point, notes), self.registry)

    def in_units(self, design: Design) -> Design:
        """A design with all values as numbers in the units of their keys."""
        if all(axis.numeric for axis in design.axes):
            return design
        if design.listed:
            return Design.of_points([numbers_at(self.tables, point, self.registry) for point in design.points()])
        axes = []
        for axis in design.axes:
            points = [{axis.key: value} for value in axis.values]
            values = (numbers_at(self.tables, point, self.registry)[axis.key] for point in points)
            axes.append(axis if axis.numeric else Axis(axis.key, tuple(values)))
        return Design(tuple(axes))


def axes_of(definitions: Vary, tables: ReadTables, registry: Registry) -> tuple[Axis, ...]:
    """``parse_axes`` with values in the units of the scene's keys."""
    return Base(tables, registry).in_units(Design(parse_axes(definitions))).axes


def refuse_mistakes(tables: ReadTables, axes: tuple[Axis, ...], registry: Registry) -> str:
    """Check the first point whole, and each further value as far as it concerns an axis; the scene's title."""
    first = {axis.key: axis.values[0] for axis in axes}
    base = Base(tables, registry)
    title = base.scene_at(first).title
    keys = {axis.key for axis in axes}
    mistakes = []
    for axis in axes:
        for value in axis.values[1:]:
            try:
                base.scene_at({**first, axis.key: value})
            except SceneError as error:
                # What two axes refuse together may run at other points: such a point is kept as refused.
                mistakes += [m for m in error.mistakes if m.path in keys]
    if mistakes:
        raise SceneError(mistakes)
    return title
