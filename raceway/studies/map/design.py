"""Axes of the map, its start, and the definitions of its numbers."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from math import pi

import attrs

from raceway.errors import Mistake, SceneError
from raceway.framework.registry import Registry
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.axes import Axis, is_number, parse_axes
from raceway.studies.many.points import tables_at

AXIAL, SPEED, TILT, ANGLE = "load.axial", "excitation.speed_rpm", "supports.tilt", "bearing.contact_angle_deg"
#: The axes in the order of the rows, with their default values.
AXES: dict[str, tuple[float | str, ...]] = {
    ANGLE: (15.0, 25.0, 40.0),
    TILT: ("locked", "free"),
    AXIAL: (50.0, 100.0, 200.0, 400.0, 700.0, 1000.0, 2000.0, 4000.0, 7000.0, 10000.0),
    SPEED: (
        1000.0, 2500.0, 5000.0, 7500.0, 10000.0, 12500.0, 15000.0, 17500.0, 20000.0, 25000.0, 30000.0, 35000.0, 40000.0,
        45000.0, 50000.0, 55000.0, 60000.0,
    ),
}  # fmt: skip
#: How each method turns the ring: keys of the table [integrator].
METHODS: dict[str, Tables] = {
    # 72 samples: six a pitch of 12 balls; the 1x line is the mean over the pitches.
    "quasi_static": {"kind": "quasi_static", "turns": 1, "steps_per_turn": 72},
    "periodic": {"kind": "periodic", "turns": 1, "steps_per_turn": 360},
}
MOST_POINTS = 20_000


@attrs.frozen(eq=False)
class Design:
    """A map that can be run.

    Attributes
    ----------
    tables : the scene that all points share;  axes : key -> values, in the order of the rows;  method : of ``METHODS``
    """

    tables: Tables
    axes: dict[str, tuple[float | str, ...]]
    method: str

    def points(self) -> list[Tables]:
        """Every point, speeds innermost."""
        return [dict(zip(self.axes, values, strict=True)) for values in itertools.product(*self.axes.values())]

    def scene(self, point: ReadTables, registry: Registry) -> Scene:
        """The scene at a point."""
        return scene_from_dict(tables_at(self.tables, point, registry), registry)


def design(tables: ReadTables, vary: Iterable[str], method: str, registry: Registry) -> Design:
    """A design whose scenes and axes have been looked at.

    Parameters
    ----------
    vary : axes ``KEY=a,b,c`` or ``KEY=start:stop:count`` in place of the default ones

    Raises
    ------
    SceneError
        Every mistake in the axes, or the scene's own; a scene without an excitation.
    """
    tables = {**tables, "integrator": dict(METHODS[method])}
    bearing = dict(tables.get("bearing", {}))
    # The angle is an axis: a clearance that would set it has no place.
    bearing.pop("radial_clearance", None)
    tables["bearing"] = bearing
    given = {axis.key: axis for axis in parse_axes(vary)} if list(vary) else {}
    mistakes = [
        Mistake(
            key, None, f"is no axis of the map; axes: {', '.join(AXES)}. Change it for the whole map with --set {key}=..."
        )
        for key in given
        if key not in AXES
    ]
    mistakes += [m for axis in given.values() if axis.key in AXES for m in _wrong(axis)]
    if mistakes:
        raise SceneError(mistakes)
    axes = {key: given[key].values if key in given else values for key, values in AXES.items()}
    axes[SPEED] = tuple(sorted(axes[SPEED]))
    axes[AXIAL] = tuple(sorted(axes[AXIAL]))
    count = 1
    for values in axes.values():
        count *= len(values)
    if count > MOST_POINTS:
        raise SceneError.at("--vary", count, f"points are more than {MOST_POINTS}: give fewer values")
    found = Design(tables, axes, method)
    for key, values in axes.items():  # each value once, so that a mistake is told before anything is run
        for value in values:
            found.scene({**{k: v[0] for k, v in axes.items()}, key: value}, registry)
    if found.scene(found.points()[0], registry).excitation is None:
        raise SceneError.at(
            "excitation", None, "is required: the map is about a stiffness under a turning or swinging force"
        )
    return found


def _wrong(axis: Axis) -> list[Mistake]:
    """What no map can be drawn over."""
    if axis.key == TILT:
        return []
    if not axis.numeric:
        return [Mistake(axis.key, list(axis.values), "must be numbers")]
    low = [v for v in axis.values if is_number(v) and v <= 0.0]
    if axis.key in (SPEED, AXIAL) and low:
        return [Mistake(axis.key, low[0], "must be greater than 0: the map looks at logarithms of it")]
    if axis.key == SPEED and len(axis.values) < 2:
        return [
            Mistake(axis.key, list(axis.values), "needs two speeds or more: the first is what the others are held against")
        ]
    return []


def amplitude_words(scene: Scene) -> str:
    """The force that a map is made under, in words."""
    part = scene.excitation
    law = getattr(part, "amplitude", None)
    if law == "unbalance":
        return (
            f"{part.name}, unbalance {part.unbalance:.4g} kg m x share {part.load_share:.3g}: the force grows with the square of "
            f"the speed, {part.load_share * part.unbalance * (1e3 * pi) ** 2:.4g} N at 30 000 r/min"
        )
    if law == "constant":
        return f"{part.name}, constant {part.amplitude_n:.4g} N at every speed"
    return f"{part.name}, {part.amplitude_n:.4g} N at {getattr(part, 'speed_rpm', 0.0):.6g} r/min"
