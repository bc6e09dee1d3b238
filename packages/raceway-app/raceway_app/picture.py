"""What the application shows of a scene: the screen of its run, the bearing, curves over speed and load."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

import attrs
import numpy as np
from raceway_rotor.export import export_ross
from raceway_view.bodies import BearingSolids, Snapshot
from raceway_view.page import BALL_COLUMNS, ball_cells, rings_data, state_data
from raceway_view.view import at_rest as at_rest

from raceway import Function, PointStatus, Quantity, RacewayError, Result, Scene, SceneError, function, run, sweep
from raceway.extend import KNOWN, C, K, Tables, as_given, continuous_keys, default_registry, named, plugin_quantities, screen

#: Relative tolerance of the orbits of curves, far below what is seen.
_TOLERANCE = 1e-6
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
_ORBIT_POINTS = 181
#: Few, so that browsers without a graphics card draw them in a tenth of a second.
_FACETS = 60


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

    Returns
    -------
    dict : title, bearing, warnings, rows (quantity, value, remark), left_out, columns and balls (of the inner and the outer race), polar
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
    """The bearing in three dimensions, as ``view.js`` draws it; ``rings``: with the shapes that loads do not change.

    Raises
    ------
    SceneError
        Rows of different bearings.
    """
    bearing = BearingSolids.of(result)
    return {**(rings_data(bearing, _FACETS) if rings else {}), **state_data(bearing, state)}


def curves(result: Result, axes: Mapping[str, Axis], wait: Callable[[str], None] = lambda _name: None) -> list[Tables]:
    """Curves of the scene of a result, of its steady orbits over speed and load, by the compiled loop.

    Parameters
    ----------
    wait : called with the name of an axis before it is computed; an exception stops

    Returns
    -------
    list of dict : panel, axis, label, x, unit, lines (name, label, y with None where the loop has no answer), present (x, or None),
        missing (x without answer), why (no curves at all), key
    """
    steady = result.model.scene.to_dict() | {"integrator": {"kind": "periodic"}}
    scene, panels = (
        as_given(steady).scene(default_registry()) if result.model.scene.excitation else result.model.scene,
        list[Tables](),
    )
    plugin_values = {name: quantity for name, (_, quantity) in plugin_quantities(default_registry()).items()}
    quantities = KNOWN | named(_MULTIPLIER) | plugin_values
    for name, axis in axes.items():
        wait(name)
        titles = {
            title: [curve for curve in names if _has(result, curve)][: None if title in _TOGETHER else 1]
            for title, names in _PANELS.items()
            if name == "speed" or title in _OVER_LOAD
        }
        try:
            outputs = [curve for names in titles.values() for curve in names]
            outputs += ["contact_angle"] if "ball_load" in outputs else []
            compiled: Function = function(scene, [axis.key], outputs, tolerance=_TOLERANCE)
            if compiled.why_slow:
                raise RacewayError(f"no curves: {compiled.why_slow}; `raceway sweep` computes them point by point")
            points = {axis.key: axis.numbers()}
            columns = compiled.looped(points)
            reasons = compiled.with_reasons(points, columns)["reason"]
            answer: Tables = {**columns, "points": axis.numbers(), "reason": reasons, "rows": len(scene.bearing.rows)}
        except RacewayError as why:
            if str(why) not in [panel["why"] for panel in panels]:
                nothing = {"panel": "", "why": str(why), "missing": [], "lines": []}
                panels.append({"axis": name, "label": axis.label, "key": axis.key, **nothing})
            continue
        panels += [_panel(name, axis, t, names, answer, quantities) for t, names in titles.items() if names]
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


def _panel(
    name: str, axis: Axis, title: str, names: list[str], answer: Tables, quantities: Mapping[str, Quantity]
) -> Tables:
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
    """Pictures of the run ("png") or the coefficients over speed for ROSS ("ross").

    Returns
    -------
    list of str : the files

    Raises
    ------
    RacewayError
        What the run, or the sweep over speed, raises; a folder that cannot be written.
    """
    if kind == "png":
        return [str(picture) for picture in run(scene, progress=progress).picture(path)]
    axis = axes_of(scene, {}).get("speed")
    if axis is None:
        raise SceneError.at("excitation.speed_rpm", None, "is needed: ROSS reads coefficients over speed")
    export_ross(sweep(scene, {axis.key: f"{axis.low}:{axis.high}:21"}, progress=progress), path)
    return [str(path)]
