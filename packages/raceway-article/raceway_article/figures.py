"""Figures 9 to 12 of the article from this program's numbers, and what decides their shape.

A figure is a few panels.  On the page each panel stands alone, so that it stays readable on a narrow screen; its PNG file
has all of them side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import attrs
import numpy as np

from raceway.extend import Line, Plot, Status, Tables, label_axes, name_ends, new_figure, wrapped
from raceway_article.design import (
    AMPLITUDES, CLAIMED, DIRECTIONS, FRICTION_WORDS, ROTATING, STIFFNESSES, TILT_WORDS, TILTS, Curve, Curves, Setting, hardening,
)  # fmt: skip
from raceway_article.rules import LEVEL

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_Colour: TypeAlias = str | tuple[float, float, float, float]
_WIDTH, _HEIGHT, _NARROW = 4.7, 3.4, 3.2
_REFERENCE, _LIGHT = "#8794a0", "weightless balls"
_STAR, _SPEED, _LOAD, _STIFFNESS = "k* = K / K(w_min) [-]", "w* [-]", "axial load [N]", "K [10⁶ N/m]"
#: Direction and amplitude law -> colour, style, width [pt] and name of a line.
_PAIRS = {
    (DIRECTIONS[1], AMPLITUDES[1]): ("#e0803c", "-", 2.4, "rotating, m e w²"),
    (DIRECTIONS[0], AMPLITUDES[0]): ("#0b4f8a", "-", 2.4, "unidirectional, constant"),
    (DIRECTIONS[1], AMPLITUDES[0]): ("#e0803c", ":", 1.6, "rotating, constant"),
    (DIRECTIONS[0], AMPLITUDES[1]): ("#0b4f8a", ":", 1.6, "unidirectional, m e w²"),
}
_FRICTION_COLOURS = dict(zip(FRICTION_WORDS, ("#8d99a6", "#e0803c", "#0b4f8a"), strict=True))


@attrs.frozen
class Panel:
    """One pair of axes: how it is drawn, what is seen, and a caption; ``solid`` for three axes."""

    draw: Callable[[Axes], None]
    alternative: str
    caption: str
    solid: bool = False

    def figure(self) -> Figure:
        figure = new_figure(_WIDTH, _HEIGHT)
        self.draw(figure.add_subplot(projection="3d" if self.solid else None))
        return figure


@attrs.frozen
class Picture:
    """A figure of several panels, three in a row."""

    name: str
    title: str
    panels: tuple[Panel, ...]

    def figure(self) -> Figure:
        rows = -(-len(self.panels) // 3)
        columns = min(3, len(self.panels))
        figure, handles = new_figure(_NARROW * columns if columns > 1 else _WIDTH, _HEIGHT * rows + 0.8), dict[str, Any]()
        for number, panel in enumerate(self.panels, start=1):
            panel.draw(axes := figure.add_subplot(rows, columns, number, projection="3d" if panel.solid else None))
            if legend := axes.get_legend():
                handles |= zip([text.get_text() for text in legend.texts], legend.legend_handles, strict=True)
                legend.remove()
        if handles:  # once for all panels
            abreast = min(len(handles), 3)
            figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=abreast, frameon=False)
        figure.suptitle(wrapped(self.title, int(8.2 * figure.get_figwidth())), fontsize=12)
        return figure


def finish(axes: Axes, title: str, x: str, y: str, legend: int = 0) -> None:
    """Title, labels and grid; a legend of so many columns below."""
    label_axes(axes, title, x, y, 10.0)
    if legend:
        axes.legend(fontsize=8.5, frameon=False, ncols=legend, loc="upper center", bbox_to_anchor=(0.5, -0.17))


def _line(
    x: np.ndarray, y: np.ndarray, style: str, colour: _Colour, width: float, label: str = "", marked: bool = True
) -> Line:
    """A line with a dot at each point where it is ``marked``."""
    look = {"color": colour, "linestyle": style, "linewidth": width, "markersize": 3.0, "markerfacecolor": colour}
    return Line(x, y, label, style={**look, "marker": "o" if marked else ""})


def _panel(
    lines: Sequence[Line], labels: tuple[str, str, str], legend: int, words: str, caption: str = "", more: Callable[[Axes], None] | None = None
) -> Panel:  # fmt: skip
    """Lines over one axis.

    labels : title, x and y;  words : what is seen;  more : draws what is no line
    """

    def draw(axes: Axes) -> None:
        title, x, y = labels
        Plot(tuple(lines), x, y, title, more=more).draw(axes)
        finish(axes, *labels, legend=legend)

    return Panel(draw, words, caption)


def _ends(curves_by_name: Mapping[str, np.ndarray]) -> str:
    """First and last value of each, in words."""
    return "; ".join(
        f"{name}: {f'{values[0]:.4g} to {values[-1]:.4g}' if np.isfinite(values[[0, -1]]).all() else 'not computed to the end'}"
        for name, values in curves_by_name.items()
    )


def _colours(count: int) -> list[_Colour]:
    from matplotlib import colormaps

    return [colormaps["viridis"](x) for x in np.linspace(0.0, 0.72, count)]


def drawings(curves: Curves, scan: Mapping[float, list[Tables]]) -> list[Picture]:
    """All figures in the order of the page: 9 to 12 for each kind of bodies, then what they have in common."""
    bodies, pictures = curves.design.bodies, []
    for kind in bodies:
        for name, title, measure, star, label in (
            ("figure-9", "Figure 9: k*, both excitations", "K", True, "k* (k = K)"),
            ("figure-9-newton-per-metre", "Figure 9 in N/m: K, both excitations", "K", False, _STIFFNESS),
            ("figure-9-with-inertia", "Figure 9 for k = |Z|, which holds the inertia", "|Z|", True, "k* (k = |Z|)"),
        ):
            title = f"{title}, {curves.design.scene_load:g} N, {kind} bodies"
            pictures.append(Picture(named(name, bodies, kind), title, tuple(_excitations(curves, kind, tilt, measure, star, label) for tilt in TILTS)))  # fmt: skip
        for number, along, panel in ((10, "speed at several axial loads", _over_speed), (11, "axial load", _over_load)):
            for ending, unit, star in (("", ": k*", True), ("-newton-per-metre", " in N/m: K", False)):
                title = f"Figure {number}{unit} over {along}, rotating force m e w², {kind} bodies"
                panels = tuple(panel(curves, kind, tilt, star) for tilt in TILTS)
                pictures.append(Picture(named(f"figure-{number}{ending}", bodies, kind), title, panels))
        for name, title, draw, inertia in (
            ("figure-12", f"Figure 12: k* over speed and axial load, ball inertia, {kind} bodies", _map, True),
            ("figure-12-weightless-balls", f"Figure 12: k* over speed and axial load, weightless balls, {kind} bodies", _map, False),
            ("figure-12-newton-per-metre", f"Figure 12 in N/m: K, {kind} bodies", _solid, True),
        ):  # fmt: skip
            settings = [Setting(**ROTATING, tilt=tilt, inertia=inertia, bodies=kind) for tilt in TILTS]
            pictures.append(Picture(named(name, bodies, kind), title, tuple(draw(curves, setting) for setting in settings)))
    if len(curves.design.frictions) > 1:
        title = f"What friction does: k* over speed, rotating force m e w², coefficient {curves.design.friction:g}"
        pictures.append(Picture("friction", title, tuple(_friction(curves, tilt) for tilt in TILTS)))
    pictures.append(_tilt_stiffness({f"{load:g} N": hardening(rows) for load, rows in scan.items()}, curves.design.shaft))
    if len(bodies) > 1:
        panels = tuple(_both_bodies(curves, tilt, star) for star in (True, False) for tilt in TILTS)
        pictures.append(Picture("bodies", "Rigid and condensed bodies, rotating force m e w², ball inertia", panels))
    return pictures


def named(figure: str, bodies: Sequence[str], kind: str) -> str:
    """The name of a figure: that of the first kind of bodies has nothing added."""
    return figure if kind == bodies[0] else f"{figure}-{kind}"


def _few_of(values: Sequence[float], count: int = 5) -> list[int]:
    """Indices of at most ``count`` of the values, evenly spread, both ends among them."""
    return sorted({round(k) for k in np.linspace(0, len(values) - 1, min(count, len(values)))})


def _excitations(curves: Curves, kind: str, tilt: str, measure: str, star: bool, label: str) -> Panel:
    """Figure 9: both excitations over speed, and the mixed pairs, as far as they are run, that change one thing only."""
    load, w = curves.design.scene_load, np.array(curves.design.relative(curves.design.speeds))
    settings = {pair: Setting(*pair, tilt, True, kind) for pair in _PAIRS}
    run = {pair: curves.curve(setting, load) for pair, setting in settings.items() if (setting, load) in curves.rows}
    light = {pair: curves.curve(attrs.evolve(settings[pair], inertia=False), load) for pair in CLAIMED}

    def k(curve: Curve, status: str = "completed") -> np.ndarray:
        return np.asarray(curve.values(measure, status) / (curve.values(measure)[0] if star else 1e6))

    def bridged(curve: Curve, style: str, colour: _Colour, width: float, label: str = "", marked: bool = True) -> Line:
        """Straight over points without a number."""
        known = np.isfinite(y := k(curve))
        return _line(w[known], y[known], style, colour, width, label, marked)

    lines = [bridged(k, "--", _PAIRS[pair][0], 1.1, f"{_PAIRS[pair][3]}, {_LIGHT}", False) for pair, k in light.items()]
    lines += [bridged(curve, style, colour, width, name)
              for curve, (colour, style, width, name) in ((curve, _PAIRS[pair]) for pair, curve in run.items())]  # fmt: skip
    # A ring does not stay on an unstable motion; limits are those of the others.
    lines += [
        attrs.evolve(_line(w, np.full(len(w), np.nan), "", _PAIRS[pair][0], 1.0), doubt=k(curve, "unstable"))
        for pair, curve in run.items()
    ]

    caption = ""
    if any(np.isfinite(curve.values(measure, "unstable")).any() for curve in run.values()):
        caption = "Crosses: unstable motions, which a ring does not stay on; at the edge where they lie outside."
    gaps = {f"{row['speed_rpm']:g}" for curve in run.values() for row in curve.rows if row["status"] == Status.UNSTEADY}
    if gaps:
        caption += f" No steady motion is found at {', '.join(sorted(gaps))} r/min; what a ring does there stands in the last table."
    other = {f"{row['speed_rpm']:g}" for curve in run.values() for row in curve.rows if row.get("found") == "from rest"}
    if other:
        at = ", ".join(sorted(other, key=float))
        caption += f" At {at} r/min stands the motion that a ring reaches from rest: where its branch is another, K jumps."
    words = f"{label} over w* from 0 to 1, {TILT_WORDS[tilt]}: {_ends({_PAIRS[pair][3]: k(curve) for pair, curve in run.items()})}"
    return _panel(lines, (f"{TILT_WORDS[tilt]}, {load:g} N", _SPEED, label), 2, words, caption)


def _over_speed(curves: Curves, kind: str, tilt: str, star: bool) -> Panel:
    """Figure 10: at several axial loads; dashed without ball inertia."""
    w, rows = np.array(curves.design.relative(curves.design.speeds)), _few_of(curves.design.loads)
    k, light = _with_and_without_inertia(curves, kind, tilt, star)
    label, lines, names = _STAR if star else _STIFFNESS, list[Line](), dict[str, np.ndarray]()
    for row, colour in zip(rows, _colours(len(rows)), strict=True):
        lines.append(_line(w, k[row], "-", colour, 2.0, marked=False))
        lines.append(_line(w, light[row], "--", colour, 1.1, "" if names else _LIGHT, False))
        names[f"{curves.design.loads[row]:g} N"] = k[row]

    def ends(axes: Axes) -> None:
        if star:
            _reference(axes)
        axes.set_xlim(0.0, 1.2)
        axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0])
        marks = [(float(line.y[-1]), name, line.style["color"]) for name, line in zip(names, lines[::2], strict=True)]
        name_ends(axes, marks, 0.062)

    words = f"{label} over w*, {TILT_WORDS[tilt]}, with ball inertia: {_ends(names)}"
    return _panel(lines, (TILT_WORDS[tilt], _SPEED, label), 1, words, more=ends)


def _over_load(curves: Curves, kind: str, tilt: str, star: bool) -> Panel:
    """Figure 11: at several speeds; dashed without ball inertia."""
    loads, columns = np.array(curves.design.loads), _few_of(curves.design.speeds)
    k, light = _with_and_without_inertia(curves, kind, tilt, star)
    label, lines, names = _STAR if star else _STIFFNESS, list[Line](), dict[str, np.ndarray]()
    for column, colour in zip(columns, _colours(len(columns)), strict=True):
        name = f"w* = {curves.design.relative(curves.design.speeds)[column]:.2g}"
        lines.append(_line(loads, light[:, column], "--", colour, 1.1, "" if names else _LIGHT, False))
        lines.append(_line(loads, k[:, column], "-", colour, 1.9, name))
        names[name] = k[:, column]
    words = f"{label} over the axial load, {TILT_WORDS[tilt]}: {_ends(names)}"
    return _panel(lines, (TILT_WORDS[tilt], _LOAD, label), 3, words)


def _with_and_without_inertia(curves: Curves, kind: str, tilt: str, star: bool) -> list[np.ndarray]:
    return [_surface(curves, Setting(**ROTATING, tilt=tilt, inertia=on, bodies=kind), star) for on in (True, False)]


def _surface(curves: Curves, setting: Setting, star: bool) -> np.ndarray:
    """(loads, speeds) k* or k [10^6 N/m]."""
    values = curves.surface(setting).values()
    return np.asarray(values / values[:, :1] if star else values / 1e6)


def _map(curves: Curves, setting: Setting) -> Panel:
    """Figure 12: k* over speed and axial load."""
    w, loads = np.array(curves.design.relative(curves.design.speeds)), np.array(curves.design.loads)
    star = _surface(curves, setting, True)
    finite = star[np.isfinite(star)]

    def draw(axes: Axes) -> None:
        finish(axes, TILT_WORDS[setting.tilt], _SPEED, _LOAD)
        axes.grid(False)
        if not finite.size:
            axes.text(0.5, 0.5, "no number", transform=axes.transAxes, ha="center")
            return
        size = max(float(np.abs(finite - 1.0).max()), 1e-6)
        masked = np.ma.masked_invalid(star)
        axes.contourf(w, loads, masked, levels=np.linspace(1.0 - size, 1.0 + size, 41), cmap="RdBu_r", alpha=0.9)
        if size > LEVEL:
            lines = axes.contour(w, loads, masked, levels=6, colors="#1b2733", linewidths=0.7)
            axes.clabel(lines, fontsize=8.5, fmt=lambda value: f"{value:.4g}")

    words = f"Map of k* over w* and axial load, {TILT_WORDS[setting.tilt]}: {_range(star)}; red rises, blue falls"
    return Panel(draw, words, f"k*: {_range(star)}. Red: stiffer than at w* = 0; blue: softer.")


def _range(values: np.ndarray) -> str:
    finite = values[np.isfinite(values)]
    return f"{finite.min():.3f} to {finite.max():.3f}" if finite.size else "no number"


def _solid(curves: Curves, setting: Setting) -> Panel:
    """Figure 12 in N/m: K over speed and axial load, a surface."""
    w, loads = np.meshgrid(curves.design.relative(curves.design.speeds), curves.design.loads)
    k, light = (_surface(curves, attrs.evolve(setting, inertia=inertia), False) for inertia in (True, False))

    def draw(axes: Any) -> None:
        if np.isfinite(k).all():
            axes.plot_surface(w, loads, k, cmap="viridis", edgecolor="#1b273355", linewidth=0.4, antialiased=True)
        else:
            axes.scatter(*(part[np.isfinite(k)] for part in (w, loads, k)), color="#0b5fa5", s=8)
        if np.isfinite(light).all():
            axes.plot_wireframe(w, loads, light, color="#c8501e", linewidth=0.6)
        axes.set_title(TILT_WORDS[setting.tilt], fontsize=11)
        axes.set(xlabel=_SPEED, ylabel=_LOAD, zlabel=_STIFFNESS)
        axes.tick_params(labelsize=8)
        axes.set(xticks=[0.0, 0.5, 1.0], yticks=[loads.min(), 0.5 * (loads.min() + loads.max()), loads.max()])
        axes.locator_params(axis="z", nbins=5)
        axes.view_init(24, -128)
        axes.set_box_aspect(None, zoom=0.92)

    words = f"Surface of K over w* and axial load, {TILT_WORDS[setting.tilt]}: {_range(k)} 10⁶ N/m; with weightless balls {_range(light)}"
    return Panel(draw, words, "Red wires: weightless balls.", solid=True)


def _friction(curves: Curves, tilt: str) -> Panel:
    """k* over speed without friction, and with it on balls that stand and that orbit, at the heaviest and the lightest load."""
    design, lines, names = curves.design, list[Line](), dict[str, np.ndarray]()
    for load, style in ((design.loads[-1], "-"), (design.loads[0], "--")):
        for friction in design.frictions:
            setting = Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid", friction=friction)
            star, w = curves.curve(setting, load).normalised(), np.array(design.relative(design.speeds_of(setting)))
            known, name = np.isfinite(star), f"{load:g} N, {FRICTION_WORDS[friction]}"
            lines.append(_line(w[known], star[known], style, _FRICTION_COLOURS[friction], 1.7, name))
            names[name] = star
    words = f"k* over w* from 0 to 1, {TILT_WORDS[tilt]}: {_ends(names)}"
    return _panel(lines, (TILT_WORDS[tilt], _SPEED, _STAR), 1, words, more=_reference)


def _reference(axes: Axes) -> None:
    axes.axhline(1.0, color=_REFERENCE, linewidth=0.8)


def _tilt_stiffness(ratios: Mapping[str, np.ndarray], shaft: float) -> Picture:
    """k*(1) over the tilt stiffness, which decides whether the bearing hardens."""

    def more(axes: Axes) -> None:
        axes.set_xscale("log")
        _reference(axes)
        axes.axvline(shaft, color=_REFERENCE, linewidth=0.8, linestyle="--")
        axes.annotate("shaft", (shaft, 0.02), xycoords=("data", "axes fraction"), xytext=(4, 0), textcoords="offset points",
                      fontsize=9, color="#55636f")  # fmt: skip

    colours = zip(ratios.items(), _colours(len(ratios)), strict=True)
    lines = [_line(np.array(STIFFNESSES), ratio, "-", colour, 2.0, name) for (name, ratio), colour in colours]
    labels = "Hardening (above 1) or softening", "tilt stiffness of the shaft [N m/rad]", "k* at w* = 1"
    words = f"k* at the highest speed over the tilt stiffness, from next to free to next to locked: {_ends(ratios)}"
    panel = _panel(lines, labels, 3, words, more=more)
    return Picture("tilt-stiffness", "What decides the trend: the tilt stiffness of the shaft", (panel,))


def _both_bodies(curves: Curves, tilt: str, star: bool) -> Panel:
    """Rigid and condensed bodies: the trend, or how much stiffer the former are than the latter."""
    design, names = curves.design, curves.design.bodies
    w, rows = np.array(design.relative(design.speeds)), _few_of(design.loads, 3)
    first, second = (_surface(curves, Setting(**ROTATING, tilt=tilt, inertia=True, bodies=kind), star) for kind in names)
    surfaces = {f", {names[0]}": first, f", {names[1]}": second} if star else {"": second / first}
    label = _STAR if star else f"K {names[1]} / K {names[0]} [-]"
    lines = [
        _line(w, values[row], style, colour, 1.7, f"{design.loads[row]:g} N{name}", marked=False)
        for (name, values), style in zip(surfaces.items(), ("--" if star else "-", "-"), strict=False)
        for row, colour in zip(rows, _colours(len(rows)), strict=True)
    ]
    words = f"{label} over w*, {TILT_WORDS[tilt]}: {_ends({str(line.label): line.y for line in lines})}"
    return _panel(lines, (TILT_WORDS[tilt], _SPEED, label), 2 if star else 3, words)
