"""Pictures of a map of k(speed): its change and its exponent over speed and axial load, and the curves themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.plugins.reports.pictures import new_figure
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

AXIAL, SPEED, TILT, ANGLE = "load.axial", "excitation.speed_rpm", "supports.tilt", "bearing.contact_angle_deg"
_INK = "#20262c"
#: Colours of k / k0 reach from one over this to this.
_MOST = 8.0
_RATIOS = (0.25, 0.5, 0.7, 0.9, 0.98, 1.02, 1.1, 1.5, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
#: Lines on the maps: key of a curve, how it looks, what it says.
_LINES: tuple[tuple[str, Tables, str], ...] = (
    ("contact_lost_from_rpm", {"color": _INK, "linestyle": "-"}, "balls lose contact from here on"),
    ("unseats_from_rpm", {"color": _INK, "linestyle": ":"}, "the bearing unseats from here on"),
    ("edge_from_rpm", {"color": "#7a1fa2", "linestyle": (0, (5, 2))}, "ellipse over the groove's edge from here on"),
)


def can_map(content: Tables) -> bool:
    """Whether there is an area to colour."""
    return all(len(content["axes"][key]) > 1 for key in (AXIAL, SPEED))


def at_angle(content: Tables, angle: float) -> Tables:
    """The same map with one contact angle, whose pictures are narrow enough for a telephone."""
    return {**content, "axes": {**content["axes"], ANGLE: [angle]}}


def _panels(axes: Tables, **shared: Any) -> tuple[Figure, np.ndarray, bool]:
    """A figure with a panel for each tilt and contact angle, and whether it is narrow."""
    tilts, angles = len(axes[TILT]), len(axes[ANGLE])
    narrow = angles == 1
    figure = new_figure(4.8, 2.1 + 2.7 * tilts) if narrow else new_figure(2.0 + 3.9 * angles, 1.6 + 3.2 * tilts)
    return figure, figure.subplots(tilts, angles, squeeze=False, sharex=True, **shared), narrow


def _bar(figure: Figure, shown: Any, panels: np.ndarray, label: str, narrow: bool) -> Colorbar:
    place = {"location": "bottom", "shrink": 0.95, "aspect": 35} if narrow else {"shrink": 0.85}
    return figure.colorbar(shown, ax=panels, extend="both", label=label, **place)


def change_map(content: Tables) -> Figure:
    """k(w) / k(w0), blue softer, red stiffer; a panel for each tilt and contact angle."""
    from matplotlib.colors import LogNorm

    look = {"cmap": "RdBu_r", "norm": LogNorm(1.0 / _MOST, _MOST)}
    figure, shown, panels, narrow = _maps(content, "change", lambda change: 1.0 + change, look, _RATIOS)
    bar = _bar(figure, shown, panels, "k(w) / k(w0)", narrow)
    ticks = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
    bar.set_ticks(list(ticks), labels=[f"{tick:g}" for tick in ticks])
    bar.minorticks_off()
    first = f"{min(content['axes'][SPEED]):,.0f}".replace(",", " ")
    figure.suptitle(f"k(w) over its value at {first} r/min: red hardens, blue softens", fontsize=11 if narrow else 13)
    return figure


def exponent_map(content: Tables) -> Figure:
    """The local exponent d ln k / d ln w, with the places of its largest value and of saturation."""
    from matplotlib.colors import Normalize

    look = {"cmap": "RdBu_r", "norm": Normalize(-2.0, 2.0)}
    figure, shown, panels, narrow = _maps(
        content, "exponent", lambda value: value, look, (-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5)
    )
    _bar(figure, shown, panels, "exponent d ln k / d ln w", narrow)
    figure.suptitle("local exponent of k(w): red hardens, blue softens", fontsize=11 if narrow else 13)
    return figure


def _maps(
    content: Tables, quantity: str, change: Callable[[np.ndarray], np.ndarray], look: Tables, levels: tuple[float, ...]
) -> Any:
    """The figure, what its colours belong to, its panels, and whether it is narrow."""
    axes = content["axes"]
    tilts, angles = axes[TILT], axes[ANGLE]
    figure, panels, narrow = _panels(axes, sharey=True)
    shown: Any = None
    for (row, tilt), (column, angle) in [(t, a) for t in enumerate(tilts) for a in enumerate(angles)]:
        panel, values = panels[row, column], np.full((len(axes[AXIAL]), len(axes[SPEED])), np.nan)
        failed = []
        for one in content["rows"]:
            point = one["point"]
            if point[TILT] != tilt or point[ANGLE] != angle:
                continue
            place = axes[AXIAL].index(point[AXIAL]), axes[SPEED].index(point[SPEED])
            if one[quantity] is not None:
                values[place] = change(one[quantity])
            if one["status"] != "completed":
                failed.append((1e-3 * point[SPEED], point[AXIAL]))
        speed, axial = 1e-3 * np.array(axes[SPEED]), np.array(axes[AXIAL])
        whole = bool(np.isfinite(values).all())
        # Round a point without number there are cells; halves of them between loads are halves on the axis' own scale.
        at = (speed, axial) if whole else (_edges(speed), np.exp(_edges(np.log(axial))))
        shading = "gouraud" if whole else "flat"
        shown = panel.pcolormesh(*at, np.ma.masked_invalid(values), rasterized=True, shading=shading, **look)
        _contours(panel, speed, axial, values, levels)
        _boundaries(panel, [c for c in content["curves"] if c["tilt"] == tilt and c["contact_angle_deg"] == angle], quantity)
        if failed:
            panel.plot(*np.array(failed).T, "x", color="#b3261e", markersize=6)
        panel.set_yscale("log")
        panel.set_ylim(float(at[1][0]), float(at[1][-1]))
        panel.set_title(f"{angle:g} deg, tilt {_tilt(tilt)}", fontsize=11)
        if row == len(tilts) - 1:
            panel.set_xlabel("speed [1000 r/min]")
        if column == 0:
            panel.set_ylabel("axial load [N]")
    _legend(figure, quantity, any(one["status"] != "completed" for one in content["rows"]), narrow)
    return figure, shown, panels, narrow


def _edges(places: np.ndarray) -> np.ndarray:
    """Edges (n + 1,) of cells round ascending places (n,), n at least 2."""
    half = 0.5 * np.diff(places)
    return np.concatenate([places[:1] - half[:1], places[:-1] + half, places[-1:] + half[-1:]])


def _contours(panel: Axes, speed: np.ndarray, axial: np.ndarray, values: np.ndarray, levels: tuple[float, ...]) -> None:
    inside = [level for level in levels if np.nanmin(values, initial=np.inf) < level < np.nanmax(values, initial=-np.inf)]
    if inside and min(values.shape) > 1:
        lines = panel.contour(speed, axial, np.ma.masked_invalid(values), levels=inside, colors="#55606b", linewidths=0.6)
        panel.clabel(lines, fmt="%g", fontsize=8)


def _boundaries(panel: Axes, curves: list[Tables], quantity: str) -> None:
    from matplotlib.patheffects import Normal, Stroke

    curves = sorted(curves, key=lambda curve: curve["axial"])
    halo = [Stroke(linewidth=3.6, foreground="white"), Normal()]  # so that a line is seen on any colour
    for key, look, _ in _LINES:
        at = [
            (1e-3 * curve[key], curve["axial"]) if curve[key] is not None else (np.nan, curve["axial"]) for curve in curves
        ]
        panel.plot(*np.array(at).T, linewidth=1.8, path_effects=halo, **look)
    if quantity == "exponent":
        for key, mark in (("steepest_at_rpm", "^"), ("saturates_at_rpm", "s")):
            at = [(1e-3 * curve[key], curve["axial"]) for curve in curves if curve[key] is not None]
            if at:
                panel.plot(*np.array(at).T, mark, color="#0b6b3a", markerfacecolor="white", markersize=5.5, linestyle="")


def _legend(figure: Figure, quantity: str, failed: bool, narrow: bool) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], linewidth=1.8, label=words, **look) for _, look, words in _LINES]
    mark: Tables = {"color": "#0b6b3a", "markerfacecolor": "white", "linestyle": ""}
    if quantity == "exponent":
        handles.append(Line2D([], [], marker="^", label="largest exponent", **mark))
        handles.append(Line2D([], [], marker="s", label="saturated", **mark))
    if failed:
        handles.append(Line2D([], [], marker="x", color="#b3261e", linestyle="", label="no number"))
    figure.legend(handles=handles, loc="outside lower center", ncols=1 if narrow else 3, frameon=False, fontsize=10)


def curves_figure(content: Tables) -> Figure:
    """k over speed, a line for each axial load; dashed: small signals; open marks: contact is lost."""
    import matplotlib

    axes = content["axes"]
    figure, panels, narrow = _panels(axes, sharey="row")
    tones = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.92, len(axes[AXIAL])))
    for row, tilt in enumerate(axes[TILT]):
        for column, angle in enumerate(axes[ANGLE]):
            panel = panels[row, column]
            for axial, tone in zip(axes[AXIAL], tones, strict=True):
                rows = [
                    one for one in content["rows"]
                    if (one["point"][TILT], one["point"][ANGLE], one["point"][AXIAL]) == (tilt, angle, axial)
                    and one["status"] == "completed" and one["stiffness"] > 0.0
                ]  # fmt: skip
                speed = [1e-3 * one["point"][SPEED] for one in rows]
                label = f"{axial:g} N" if row == column == 0 else None
                panel.plot(speed, [1e-6 * one["stiffness"] for one in rows], color=tone, linewidth=1.5, label=label)
                panel.plot(speed, [1e-6 * one["small_signal"] for one in rows], "--", color=tone, linewidth=0.8)
                lost = [(1e-3 * one["point"][SPEED], 1e-6 * one["stiffness"]) for one in rows if one["lost"]]
                if lost:
                    panel.plot(*np.array(lost).T, "o", color=tone, markerfacecolor="white", markersize=3.5)
            panel.set_yscale("log")
            panel.set_title(f"{angle:g} deg, tilt {_tilt(tilt)}", fontsize=11)
            panel.grid(True, which="both", color="#e3e7eb", linewidth=0.6)
            panel.spines[["top", "right"]].set_visible(False)
            if row == len(axes[TILT]) - 1:
                panel.set_xlabel("speed [1000 r/min]")
            if column == 0:
                panel.set_ylabel("k [N/µm]")
    place: Tables = {"loc": "outside lower center", "ncols": 4} if narrow else {"loc": "outside right center"}
    figure.legend(frameon=False, fontsize=10, title="axial load", **place)
    words = "small signals at rest: dashed; open marks: balls lose contact"
    figure.suptitle(words if narrow else f"k(w): lines; {words}", fontsize=10.5 if narrow else 13)
    return figure


def _tilt(value: object) -> str:
    return str(value) if isinstance(value, str) else f"{value:g} N m/rad"
