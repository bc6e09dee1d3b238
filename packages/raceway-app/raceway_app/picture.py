"""What the application shows of a scene: the screen of its run, the bearing, curves over speed and load."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TypeAlias

import attrs
import numpy as np
from raceway_rotor.export import export_ross
from raceway_view.bodies import BearingSolids, Snapshot
from raceway_view.page import BALL_COLUMNS, ball_cells, rings_data, state_data
from raceway_view.view import at_rest as at_rest

from raceway import Function, PointStatus, Quantity, RacewayError, Result, Scene, SceneError, function, run, sweep
from raceway.extend import (
    KNOWN, C, K, Tables, as_given, continuous_keys, default_registry, leaves, named, plugin_quantities, screen,
)  # fmt: skip

#: Relative tolerance of the orbits of curves, and of curves at few points, far below what is seen; points that are computed at once.
_TOLERANCE, _ROUGH, _AT_ONCE = 1e-6, 1e-4, 24
_MULTIPLIER = Quantity("largest_multiplier", "1", "of the orbit: above 1 it is unstable", label="Floquet multiplier")
#: Panels over speed and over load: title, and names of the curves in it, those of a motion first.
_PANELS = {
    "stiffness": (K.name, "kyy_tilts_follow", "kyy"),
    "damping": (C.name,),
    "Floquet multiplier": ("largest_multiplier",),
    "axial displacement": ("x",),
    "ball load": ("peak_ball_load", "largest_ball_load"),
    "pressure p0": ("p0",),
    "temperature": ("temperature_inner_k", "temperature_outer_k"),
    "axial force of rows": ("ball_load",),
    "reference life L10r": ("l10r_hours",),
}
_OF_MOTIONS = (K.name, C.name, "largest_multiplier", "peak_ball_load")
#: Panels of which all curves are drawn; of others the first that the scene has.
_TOGETHER = ("temperature",)
_OVER_LOAD = ("stiffness", "ball load", "pressure p0", "reference life L10r")
#: Facets are few, so that browsers without a graphics card draw them in a tenth of a second.
_ORBIT_POINTS, _FACETS = 181, 60


@attrs.frozen
class Axis:
    """What curves run over: ``count`` points from ``low`` to ``high`` of a key, in the key's unit; ``present``: the scene's own number."""

    key: str
    label: str
    low: float
    high: float
    count: int
    present: float

    def numbers(self) -> np.ndarray:
        """(count,) values, the scene's own among them where it lies inside."""
        values = np.linspace(self.low, self.high, self.count)
        if self.low < self.present < self.high:
            values[1 + int(np.argmin(abs(values[1:-1] - self.present)))] = self.present
        return values


def axes_of(scene: Scene, ranges: Mapping[str, tuple[float, float]]) -> dict[str, Axis]:
    """Speed and axial load over ``ranges``, widened to the scene's own, else from a twentieth to twice of that; only what the scene has."""
    axes: dict[str, Axis] = {}
    present = {key.path: key.value for key in continuous_keys(scene)}
    for name, key, label, count in (
        ("speed", "excitation.speed_rpm", "speed [r/min]", 60),
        ("speed", "kinematics.spin_speed_rpm", "speed [r/min]", 60),
        ("load", "load.axial", "axial load [N]", 31),
    ):
        if name not in axes and present.get(key):
            now = float(present[key])
            ends = list(ranges.get(name, (0.05 * now, 2.0 * now)))
            if not min(ends) <= now <= max(ends):
                ends += [0.9 * now, 1.1 * now]
            axes[name] = Axis(key, label, float(f"{min(ends):.3g}"), float(f"{max(ends):.3g}"), count, now)
    return axes


def result_picture(result: Result, state: Snapshot) -> Tables:
    """The screen of a run, ball by ball, and the orbit; ``state``: of the bearing at rest.

    Dict of title, bearing, warnings, rows (quantity, value, remark), left_out, columns and balls (of the inner and the outer race), polar
        (azimuth [deg], load inner, load outer [N]), orbit ((n, 2) [um], or None), intervals (of quantities: value, low, high, relative)
    """
    content = result.content
    parts, balls = screen(content), content["equilibrium"]["balls"]
    polar = [[ball["azimuth_deg"], ball["load_inner_n"], ball["load_outer_n"]] for ball in balls]
    return {
        "title": parts.title, "bearing": parts.bearing, "warnings": parts.warnings, "left_out": parts.left_out,
        "rows": [list(row) for row in parts.rows if row[0] != "wall time"], "columns": BALL_COLUMNS,
        "balls": {race: ball_cells(state, race == "inner") for race in ("inner", "outer")}, "polar": polar, "orbit": _orbit(result),
        "intervals": {name: part for name, part in (content["uncertainty"] or {}).items() if isinstance(part, dict)},
    }  # fmt: skip


def _orbit(result: Result) -> list[list[float]] | None:
    """Path of the last turn across the shaft [um]."""
    if result.simulation is None:
        return None
    record = result.simulation.record
    turn = max(record.schedule.steps_per_turn // record.schedule.stride, 1)
    path = 1e6 * record.displacement[-turn - 1 :, 1:3]
    samples = np.unique(np.linspace(0, len(path) - 1, _ORBIT_POINTS).astype(int))
    return [[float(f"{x:.5g}") for x in point] for point in path[samples]]


def bodies_picture(result: Result, state: Snapshot, rings: bool) -> Tables:
    """The bearing as ``view.js`` draws it, ``rings``: with the shapes that loads do not change; SceneError: rows of different bearings."""
    bearing = BearingSolids.of(result)
    return {**(rings_data(bearing, _FACETS) if rings else {}), **state_data(bearing, state)}


Titles: TypeAlias = dict[str, list[str]]
Form: TypeAlias = tuple[tuple[tuple[str, str | None], ...], dict[str, float]]
Parts: TypeAlias = tuple["Scene", Form, Titles, dict[str, Axis]]


def form(scene: Scene) -> Form:
    """What scenes share that differ by numbers alone, and these numbers."""
    keys = [(key, value) for key, value in leaves(scene.to_dict()) if key != "title"]
    numbers = {key: value for key, value in keys if isinstance(value, float)}
    return tuple((key, None if key in numbers else repr(value)) for key, value in keys), numbers


def titles_of(result: Result) -> Titles:
    """Panels of curves that a scene has: title, and names of the curves in it."""
    known = {title: [name for name in names if _has(result, name)] for title, names in _PANELS.items()}
    return {title: names if title in _TOGETHER else names[:1] for title, names in known.items() if names}


class Curves:
    """Curves of scenes that differ by numbers: of steady orbits over speed and load, by the compiled loop; what numbers leave as it is, is built once."""

    def __init__(self) -> None:
        self._built: dict[bool, tuple[object, dict[str, float], Function]] = {}  # of few points: what it holds for, numbers
        #: axis -> points of the curves before, which have no answer
        self._lost: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def _function(self, scene: Scene, of: Form, keys: list[str], outputs: list[str], few: bool) -> Function:
        """Over ``keys`` and the numbers that have changed since it was built."""
        kind, numbers = (of[0], keys, outputs), of[1]
        before, old, compiled = self._built.get(few, (None, {}, None))
        moved = [key for key, value in numbers.items() if before == kind and value != old[key] and key not in keys]
        if compiled is None or before != kind or not set(moved) <= set(compiled.inputs):
            tables = scene.to_dict() | ({"integrator": {"kind": "periodic"}} if scene.excitation else {})
            steady, tolerance, compiled = as_given(tables).scene(default_registry()), _ROUGH if few else _TOLERANCE, None
            with suppress(SceneError):
                compiled = function(steady, [*keys, *moved], outputs, tolerance=tolerance)
            if compiled is None or compiled.why_slow:
                compiled = function(steady, keys, outputs, tolerance=tolerance)
            self._built[few] = kind, numbers, compiled
        return compiled

    def draw(self, parts: Parts, go_on: Callable[[], None], few: bool = False) -> list[Tables]:
        """Dicts of panel, axis, label, x, unit, lines (name, label, y, None without answer), present, missing (x), why (no curves), key.

        parts : scene, its ``form``, ``titles_of`` a result like it, axes;  go_on : called between blocks of points; may raise
        few : a quarter of the points, without those that lay in gaps of the curves before
        """
        scene, of, titles, axes = parts
        if not axes:
            return []
        axes = {name: attrs.evolve(axis, count=axis.count // (4 if few else 1)) for name, axis in axes.items()}
        of_plugins = {name: quantity for name, (_, quantity) in plugin_quantities(default_registry()).items()}
        quantities = KNOWN | named(_MULTIPLIER) | of_plugins
        outputs = [curve for names in titles.values() for curve in names]
        outputs += ["contact_angle"] if "ball_load" in outputs else []
        x = {name: axis.numbers() for name, axis in axes.items()}
        ends = np.cumsum([len(own) for own in x.values()])
        places = dict(zip(x, np.split(np.arange(ends[-1]), ends), strict=False))
        lost = np.zeros(ends[-1], bool)
        for name, (before, gaps) in self._lost.items() if few and x.keys() == self._lost.keys() else ():
            lost[places[name]] = gaps[np.abs(x[name][:, None] - before).argmin(axis=1)]
        lost &= not lost.all()
        try:
            compiled = self._function(scene, of, [axis.key for axis in axes.values()], outputs, few)
            if compiled.why_slow:
                raise RacewayError(f"no curves: {compiled.why_slow}; `raceway sweep` computes them point by point")
            points = {key: np.full(len(lost), of[1][key]) for key in compiled.inputs}
            for name, axis in axes.items():
                points[axis.key][places[name]] = x[name]
            answer: Tables = {}
            for rows in np.array_split(np.flatnonzero(~lost), -(-int((~lost).sum()) // _AT_ONCE)):
                go_on()
                block = {key: column[rows] for key, column in points.items()}
                for name, column in compiled.with_reasons(block, compiled.looped(block)).items():
                    fill = {"status": PointStatus.FAILED, "reason": ""}.get(name, np.nan)
                    answer.setdefault(name, np.full((len(lost), *column.shape[1:]), fill, dtype=column.dtype))[rows] = column
        except RacewayError as refused:
            nothing = {"panel": "", "why": str(refused), "missing": [], "lines": []}
            return [{"axis": name, "label": axis.label, "key": axis.key, **nothing} for name, axis in [*axes.items()][:1]]
        panels: list[Tables] = []
        self._lost.clear()
        for name, axis in axes.items():
            part: Tables = {key: column[places[name]] for key, column in answer.items()}
            part |= {"points": x[name], "rows": len(scene.bearing.rows)}
            self._lost[name] = x[name], part["status"] != PointStatus.COMPUTED
            of_axis = {title: names for title, names in titles.items() if name == "speed" or title in _OVER_LOAD}
            panels += [panel(name, axis, title, names, part, quantities) for title, names in of_axis.items()]
        return panels


def _has(result: Result, name: str) -> bool:
    scene, problem = result.model.scene, result.model.problem
    if name == C.name and result.equivalent_damping is not None:  # the screen says that it is not resolved
        return abs(result.equivalent_damping) > (result.equivalent_damping_error or 0.0)
    if name in _OF_MOTIONS:
        return scene.excitation is not None
    if name == "ball_load":
        # With gyroscopic moments traction takes part of a row's force.
        return len(scene.bearing.rows) > 1 and problem.kinematics.gyroscopic == "none"
    return scene.supports.tilt == "free" if name == "kyy_tilts_follow" else name in KNOWN or name in result.quantities


def panel(name: str, axis: Axis, title: str, names: list[str], answer: Tables, quantities: Mapping[str, Quantity]) -> Tables:
    valid = answer["status"] == PointStatus.COMPUTED
    lines: list[Tables] = []
    for curve, label, values in _curve_columns(names, answer, quantities):
        quantity = quantities[curve]
        zero = 273.15 if quantity.unit == "K" else 0.0
        y = [float(quantity.read(v)) - zero if ok and np.isfinite(v) else None for v, ok in zip(values, valid, strict=True)]
        lines.append({"name": curve, "label": label, "y": y})
    return {
        "panel": title, "axis": name, "label": axis.label, "x": answer["points"].tolist(), "unit": quantities[names[0]].read_unit.replace("K", "°C"),
        "lines": lines, "present": axis.present, "missing": answer["points"][~valid].tolist(), "why": next(filter(None, answer["reason"]), ""), "key": axis.key,
    }  # fmt: skip


def _curve_columns(
    names: Iterable[str], answer: Tables, quantities: Mapping[str, Quantity]
) -> Iterator[tuple[str, str, np.ndarray]]:
    """Name, label and values (n,) of each curve; of ball loads the axial force of each row, sum of Q sin(alpha) at the outer races."""
    for name in names:
        if name != "ball_load":
            yield name, quantities[name].label.removesuffix(" k"), answer[name]
            continue
        axial = answer[name] * np.sin(np.radians(answer["contact_angle"]))
        for k, part in enumerate(np.split(np.nan_to_num(axial[:, 1]), answer["rows"], axis=1)):
            yield name, f"row {k + 1}", abs(part.sum(axis=1))


def write_file(kind: str, scene: Scene, path: Path, progress: Callable[[str, int, int], None]) -> list[str]:
    """Pictures of the run ("png") or the coefficients over speed for ROSS ("ross"): the files; RacewayError: theirs, or of the folder."""
    if kind == "png":
        return [str(picture) for picture in run(scene, progress=progress).picture(path)]
    axis = axes_of(scene, {}).get("speed")
    if axis is None:
        raise SceneError.at("excitation.speed_rpm", None, "is needed: ROSS reads coefficients over speed")
    export_ross(sweep(scene, {axis.key: f"{axis.low}:{axis.high}:21"}, progress=progress), path)
    return [str(path)]
