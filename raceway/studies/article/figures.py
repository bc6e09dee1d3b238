"""Figures 9 to 12 of the article from this program's numbers, and what decides their shape.

A figure is a few panels.  On the page each panel stands alone, so that it stays readable on a narrow screen; its PNG file
has all of them side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.errors import Status
from raceway.plugins.pictures import new_figure
from raceway.storage.tables import Tables
from raceway.studies.article import runs
from raceway.studies.article.design import (
    AMPLITUDES,
    CLAIMED,
    DIRECTIONS,
    FRICTION_WORDS,
    FRICTIONS,
    ROTATING,
    TILT_WORDS,
    TILTS,
    Curves,
    Setting,
)
from raceway.studies.article.rules import LEVEL
from raceway.studies.article.runs import hardening

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.studies.article.study import Article


_WIDTH, _HEIGHT = 4.7, 3.8
GRID = "#d8dee4"


@attrs.frozen
class Panel:
    """One pair of axes: how it is drawn, what is seen, and a caption; ``solid`` for three axes."""

    draw: Callable[[Axes], None]
    alternative: str
    caption: str
    solid: bool = False

    def figure(self) -> Figure:
        figure = new_figure(_WIDTH, _HEIGHT)
        self.draw(_axes(figure, 111, self.solid))
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
        figure = new_figure(_WIDTH * columns, _HEIGHT * rows + 0.4)
        for place, panel in enumerate(self.panels, start=1):
            panel.draw(_axes(figure, (rows, columns, place), panel.solid))
        figure.suptitle(self.title, fontsize=13)
        return figure


def _axes(figure: Figure, place: int | tuple[int, int, int], solid: bool) -> Any:
    words: Tables = {"projection": "3d"} if solid else {}
    return figure.add_subplot(*place, **words) if isinstance(place, tuple) else figure.add_subplot(place, **words)


def finish(axes: Axes, title: str, x: str, y: str, legend: int = 0) -> None:
    axes.set_title(title, fontsize=11)
    axes.set_xlabel(x, fontsize=10)
    axes.set_ylabel(y, fontsize=10)
    axes.tick_params(labelsize=9)
    axes.grid(color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.ticklabel_format(useOffset=False)
    if legend:
        axes.legend(fontsize=8.5, frameon=False, ncols=legend, loc="upper center", bbox_to_anchor=(0.5, -0.17))


def ends(values: np.ndarray) -> str:
    return f"{values[0]:.4g} to {values[-1]:.4g}" if np.isfinite(values[[0, -1]]).all() else "not computed to the end"


def cut(axes: Axes, lines: list[np.ndarray]) -> None:
    """Limits by the steady motions: an unstable one far away must not flatten them."""
    values = np.concatenate(lines)
    values = values[np.isfinite(values)]
    if values.size:
        low, high = values.min(), values.max()
        room = 0.07 * max(high - low, 0.01 * abs(high))
        axes.set_ylim(low - room, high + room)


def colours(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["viridis"](x) for x in np.linspace(0.0, 0.72, count)]


def end_labels(axes: Axes, x: float, labels: list[tuple[float, str, Any]]) -> None:
    """Names at the right ends of curves, pushed apart where they would cover each other."""
    known = sorted((label for label in labels if np.isfinite(label[0])), key=lambda label: label[0])
    low, high = axes.get_ylim()
    gap = 0.062 * (high - low)
    places: list[float] = []
    for y, *_ in known:
        places.append(max(y, places[-1] + gap) if places else y)
    top = high + 0.5 * gap
    for k in reversed(range(len(places))):  # what was pushed out at the top pushes back
        places[k] = top = min(places[k], top - gap)
    for place, (_, text, colour) in zip(places, known, strict=True):
        axes.annotate(text, (x, place), xytext=(5, 0), textcoords="offset points", fontsize=8.5, color=colour, va="center",
                      annotation_clip=False)  # fmt: skip


_STAR, _SPEED, _LOAD, _STIFFNESS = "k* = K / K(w_min) [-]", "w* [-]", "axial load [N]", "K [10⁶ N/m]"
_PAIRS = {
    (DIRECTIONS[1], AMPLITUDES[1]): ("#c8501e", "-", 2.4, "rotating, m e w²"),
    (DIRECTIONS[0], AMPLITUDES[0]): ("#0b5fa5", "-", 2.4, "unidirectional, constant"),
    (DIRECTIONS[1], AMPLITUDES[0]): ("#c8501e", ":", 1.6, "rotating, constant"),
    (DIRECTIONS[0], AMPLITUDES[1]): ("#0b5fa5", ":", 1.6, "unidirectional, m e w²"),
}


def drawings(study: Article) -> list[Picture]:
    """All figures in the order of the page: 9 to 12 for each kind of bodies, then what they have in common."""
    curves = study.curves
    found = []
    for kind in curves.design.bodies:
        made = [
            *_excitations(curves, kind),
            *_curves_of(curves, kind, 10, "speed at several axial loads", _over_speed),
            *_curves_of(curves, kind, 11, "axial load", _over_load),
            *_surfaces(curves, kind),
        ]
        found += [attrs.evolve(one, name=named(one.name, curves.design.bodies, kind)) for one in made]
    if len(curves.design.frictions) > 1:
        found.append(_friction(curves))
    found.append(_tilt_stiffness(study))
    if len(curves.design.bodies) > 1:
        found.append(_bodies(curves))
    return found


def named(figure: str, bodies: Sequence[str], kind: str) -> str:
    """The name of a figure: that of the first kind of bodies has nothing added."""
    return figure if kind == bodies[0] else f"{figure}-{kind}"


def _some(values: Sequence[float], count: int = 5) -> list[int]:
    """Places of at most ``count`` of the values, evenly spread, both ends among them."""
    return sorted({round(k) for k in np.linspace(0, len(values) - 1, min(count, len(values)))})


def _excitations(curves: Curves, kind: str) -> list[Picture]:
    """Figure 9: both excitations over speed, and the mixed pairs, as far as they are run, that change one thing only."""
    load = curves.design.own_load
    w = np.array(curves.design.relative_speeds)
    parts = (
        ("figure-9", "Figure 9: k*, both excitations", "K", True, "k* (k = K)"),
        ("figure-9-newton-per-metre", "Figure 9 in N/m: K, both excitations", "K", False, "K [10⁶ N/m]"),
        ("figure-9-with-inertia", "Figure 9 for k = |Z|, which holds the inertia", "|Z|", True, "k* (k = |Z|)"),
    )
    found = []
    for name, title, measure, star, label in parts:
        panels = []
        for tilt in TILTS:
            settings = {pair: Setting(*pair, tilt, True, kind) for pair in _PAIRS}
            lines = {pair: setting for pair, setting in settings.items() if (setting, load) in curves.rows}
            panels.append(_excitation_panel(curves, w, lines, load, measure, star, label))
        found.append(Picture(name, f"{title}, {load:g} N, {kind} bodies", tuple(panels)))
    return found


def _excitation_panel(
    curves: Curves, w: np.ndarray, lines: dict[tuple[str, str], Setting], load: float, measure: str, star: bool, label: str
) -> Panel:  # fmt: skip
    tilt = TILT_WORDS[next(iter(lines.values())).tilt]

    def taken(setting: Setting, values: np.ndarray) -> np.ndarray:
        return np.asarray(values / curves.values(setting, load, measure)[0] if star else values / 1e6)

    light = {pair: attrs.evolve(lines[pair], inertia=False) for pair in CLAIMED}

    def draw(axes: Axes) -> None:
        for pair, setting in light.items():
            steady = taken(setting, curves.values(setting, load, measure))
            known = np.isfinite(steady)
            axes.plot(w[known], steady[known], "--", color=_PAIRS[pair][0], linewidth=1.1)
        for pair, setting in lines.items():
            colour, style, width, name = _PAIRS[pair]
            steady = taken(setting, curves.values(setting, load, measure))
            known = np.isfinite(steady)
            axes.plot(w[known], steady[known], style, marker="o", markersize=3, color=colour, linewidth=width, label=name)
        cut(axes, [taken(s, curves.values(s, load, measure)) for s in (*lines.values(), *light.values())])
        for pair, setting in lines.items():
            crosses = np.clip(taken(setting, curves.unstable(setting, load, measure)), *axes.get_ylim())
            axes.plot(w, crosses, "x", color=_PAIRS[pair][0], markersize=6, zorder=1, clip_on=False)
        finish(axes, f"{tilt}, {load:g} N", _SPEED, label, legend=2)

    words = "; ".join(f"{_PAIRS[pair][3]}: {ends(taken(s, curves.values(s, load, measure)))}" for pair, s in lines.items())
    alternative = f"{label} over w* from 0 to 1, {tilt}: {words}"
    bad = [curves.unstable(setting, load, measure) for setting in lines.values()]
    caption = "Dashed: the same with weightless balls."
    if np.isfinite(bad).any():
        caption += " Crosses: unstable motions, which a ring does not stay on; at the edge where they lie outside."
    gaps = {
        f"{row['speed_rpm']:g}" for s in lines.values() for row in curves.rows[s, load] if row["status"] == Status.UNSTEADY
    }
    if gaps:
        caption += f" No steady motion is found at {', '.join(sorted(gaps))} r/min; what a ring does there stands in the last table."
    return Panel(draw, alternative, caption)


def _curves_of(curves: Curves, kind: str, number: int, over: str, panel: Callable[..., Panel]) -> list[Picture]:
    """Figure 10 or 11: k* and K in N/m along one axis, a panel for each tilt boundary; dashed without ball inertia."""
    return [
        Picture(
            f"figure-{number}{name}",
            f"Figure {number}{title} over {over}, rotating force m e w², {kind} bodies",
            tuple(panel(curves, kind, tilt, star) for tilt in TILTS),
        )
        for name, title, star in (("", ": k*", True), ("-newton-per-metre", " in N/m: K", False))
    ]


def _over_speed(curves: Curves, kind: str, tilt: str, star: bool) -> Panel:
    w, places = np.array(curves.design.relative_speeds), _some(curves.design.loads)
    names = [f"{load:g} N" for load in curves.design.loads]
    k, light = _with_and_without_inertia(curves, kind, tilt, star)
    label = _STAR if star else _STIFFNESS

    def draw(axes: Axes) -> None:
        ends = []
        for place, colour in zip(places, colours(len(places)), strict=True):
            axes.plot(w, k[place], "-", color=colour, linewidth=2.0)
            axes.plot(w, light[place], "--", color=colour, linewidth=1.1)
            ends.append((float(k[place][-1]), names[place], colour))
        if star:
            axes.axhline(1.0, color="#8794a0", linewidth=0.8)
        axes.set_xlim(0.0, 1.2)
        axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0])
        finish(axes, TILT_WORDS[tilt], _SPEED, label)
        end_labels(axes, 1.0, ends)

    words = "; ".join(f"{names[place]}: {ends(k[place])}" for place in places)
    return Panel(draw, f"{label} over w*, {TILT_WORDS[tilt]}, with ball inertia: {words}", "Dashed: weightless balls.")


def _over_load(curves: Curves, kind: str, tilt: str, star: bool) -> Panel:
    loads, places = np.array(curves.design.loads), _some(curves.design.speeds)
    names = [f"w* = {w:.2g}" for w in curves.design.relative_speeds]
    k, light = _with_and_without_inertia(curves, kind, tilt, star)
    label = _STAR if star else _STIFFNESS

    def draw(axes: Axes) -> None:
        for place, colour in zip(places, colours(len(places)), strict=True):
            axes.plot(loads, light[:, place], "--", color=colour, linewidth=1.1)
            axes.plot(loads, k[:, place], "-o", markersize=3, color=colour, linewidth=1.9, label=names[place])
        finish(axes, TILT_WORDS[tilt], _LOAD, label, legend=3)

    words = "; ".join(f"{names[place]}: {ends(k[:, place])}" for place in places)
    return Panel(draw, f"{label} over the axial load, {TILT_WORDS[tilt]}: {words}", "Dashed: weightless balls.")


def _with_and_without_inertia(curves: Curves, kind: str, tilt: str, star: bool) -> list[np.ndarray]:
    return [_surface(curves, Setting(**ROTATING, tilt=tilt, inertia=i, bodies=kind), star) for i in (True, False)]


def _surface(curves: Curves, setting: Setting, star: bool) -> np.ndarray:
    """(loads, speeds) k* or k [10^6 N/m]."""
    values = curves.surface(setting)[0]
    return np.asarray(values / values[:, :1] if star else values / 1e6)


def _surfaces(curves: Curves, kind: str) -> list[Picture]:
    """Figure 12: k* over speed and axial load, as a map; K in N/m as a surface."""
    found = []
    for inertia, name, title in (
        (True, "figure-12", "ball inertia"),
        (False, "figure-12-weightless-balls", "weightless balls"),
    ):
        panels = tuple(_map(curves, Setting(**ROTATING, tilt=tilt, inertia=inertia, bodies=kind)) for tilt in TILTS)
        found.append(Picture(name, f"Figure 12: k* over speed and axial load, {title}, {kind} bodies", panels))
    panels = tuple(_solid(curves, Setting(**ROTATING, tilt=tilt, inertia=True, bodies=kind)) for tilt in TILTS)
    found.append(Picture("figure-12-newton-per-metre", f"Figure 12 in N/m: K, {kind} bodies", panels))
    return found


def _map(curves: Curves, setting: Setting) -> Panel:
    w, loads = np.array(curves.design.relative_speeds), np.array(curves.design.loads)
    star = _surface(curves, setting, True)
    known = np.isfinite(star)

    def draw(axes: Axes) -> None:
        finish(axes, TILT_WORDS[setting.tilt], _SPEED, _LOAD)
        axes.grid(False)
        if not known.any():
            axes.text(0.5, 0.5, "no number", transform=axes.transAxes, ha="center")
            return
        size = max(float(np.abs(star[known] - 1.0).max()), 1e-6)
        shown = np.ma.masked_invalid(star)
        axes.contourf(w, loads, shown, levels=np.linspace(1.0 - size, 1.0 + size, 41), cmap="RdBu_r", alpha=0.9)
        if size > LEVEL:
            lines = axes.contour(w, loads, shown, levels=6, colors="#1b2733", linewidths=0.7)
            axes.clabel(lines, fontsize=8.5, fmt=lambda value: f"{value:.4g}")

    words = f"Map of k* over w* and axial load, {TILT_WORDS[setting.tilt]}: {_range(star)}; red rises, blue falls"
    return Panel(draw, words, f"k*: {_range(star)}. Red: stiffer than at w* = 0; blue: softer.")


def _range(values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    return f"{known.min():.3f} to {known.max():.3f}" if known.size else "no number"


def _solid(curves: Curves, setting: Setting) -> Panel:
    w, loads = np.meshgrid(curves.design.relative_speeds, curves.design.loads)
    k, light = (_surface(curves, attrs.evolve(setting, inertia=i), False) for i in (True, False))

    def draw(axes: Any) -> None:
        if np.isfinite(k).all():
            axes.plot_surface(w, loads, k, cmap="viridis", edgecolor="#1b273355", linewidth=0.4, antialiased=True)
        else:
            axes.scatter(*(part[np.isfinite(k)] for part in (w, loads, k)), color="#0b5fa5", s=8)
        if np.isfinite(light).all():
            axes.plot_wireframe(w, loads, light, color="#c8501e", linewidth=0.6)
        axes.set_title(TILT_WORDS[setting.tilt], fontsize=11)
        axes.set_xlabel(_SPEED, fontsize=9)
        axes.set_ylabel(_LOAD, fontsize=9)
        axes.set_zlabel(_STIFFNESS, fontsize=9)
        axes.tick_params(labelsize=8)
        axes.set_xticks([0.0, 0.5, 1.0])
        axes.set_yticks([loads.min(), 0.5 * (loads.min() + loads.max()), loads.max()])
        axes.locator_params(axis="z", nbins=5)
        axes.view_init(24, -128)
        axes.set_box_aspect(None, zoom=0.92)

    words = f"Surface of K over w* and axial load, {TILT_WORDS[setting.tilt]}: {_range(k)} 10⁶ N/m; with weightless balls {_range(light)}"
    return Panel(draw, words, "Red wires: weightless balls.", solid=True)


def _friction(curves: Curves) -> Picture:
    """k* over speed without friction, and with it on balls that stand and that orbit, at the lightest and heaviest load."""
    panels = tuple(_friction_panel(curves, tilt) for tilt in TILTS)
    title = f"What friction does: k* over speed, rotating force m e w², coefficient {curves.design.friction:g}"
    return Picture("friction", title, panels)


def _friction_panel(curves: Curves, tilt: str) -> Panel:
    loads = (curves.design.loads[-1], curves.design.loads[0])
    lines = {
        (friction, load): Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid", friction=friction)
        for load in loads
        for friction in curves.design.frictions
    }
    colours = dict(zip(FRICTIONS, ("#55636f", "#c8501e", "#0b5fa5"), strict=True))

    def draw(axes: Axes) -> None:
        for (friction, load), setting in lines.items():
            w, star = np.array(curves.design.relative_speeds_of(setting)), curves.normalised(setting, load)
            known = np.isfinite(star)
            style, name = ("-", FRICTION_WORDS[friction]) if load == loads[0] else ("--", None)
            axes.plot(
                w[known], star[known], style, marker="o", markersize=3, color=colours[friction], linewidth=1.7, label=name
            )
        axes.axhline(1.0, color="#8794a0", linewidth=0.8)
        finish(axes, TILT_WORDS[tilt], _SPEED, _STAR, legend=1)

    words = "; ".join(
        f"{load:g} N, {FRICTION_WORDS[friction]}: {ends(curves.normalised(setting, load))}"
        for (friction, load), setting in lines.items()
    )
    caption = f"Solid: {loads[0]:g} N. Dashed: {loads[1]:g} N."
    return Panel(draw, f"k* over w* from 0 to 1, {TILT_WORDS[tilt]}: {words}", caption)


def _tilt_stiffness(study: Article) -> Picture:
    """k*(1) over the tilt stiffness: what decides whether the bearing hardens."""
    lines = {load: hardening(rows) for load, rows in study.scan.items()}
    shaft = study.curves.design.shaft

    def draw(axes: Axes) -> None:
        for (load, ratio), colour in zip(lines.items(), colours(len(lines)), strict=True):
            axes.semilogx(runs.STIFFNESSES, ratio, "-o", markersize=3, color=colour, linewidth=2.0, label=f"{load:g} N")
        axes.axhline(1.0, color="#8794a0", linewidth=0.8)
        axes.axvline(shaft, color="#8794a0", linewidth=0.8, linestyle="--")
        axes.annotate("shaft", (shaft, 0.02), xycoords=("data", "axes fraction"), xytext=(4, 0), textcoords="offset points",
                      fontsize=9, color="#55636f")  # fmt: skip
        axes.set_title("Hardening (above 1) or softening", fontsize=11)
        axes.set_xlabel("tilt stiffness of the shaft [N m/rad]", fontsize=10)
        axes.set_ylabel("k* at w* = 1", fontsize=10)
        axes.tick_params(labelsize=9)
        axes.grid(color=GRID, linewidth=0.7)
        axes.legend(fontsize=9, frameon=False)

    words = "; ".join(f"{load:g} N: {ends(ratio)}" for load, ratio in lines.items())
    panel = Panel(draw, f"k* at the highest speed over the tilt stiffness, from next to free to next to locked: {words}", "")
    return Picture("tilt-stiffness", "What decides the trend: the tilt stiffness of the shaft", (panel,))


def _bodies(curves: Curves) -> Picture:
    """Rigid and condensed bodies: the trend, and how much stiffer the one is than the other."""
    panels = [_both_bodies(curves, tilt, star) for star in (True, False) for tilt in TILTS]
    return Picture("bodies", "Rigid and condensed bodies, rotating force m e w², ball inertia", tuple(panels))


def _both_bodies(curves: Curves, tilt: str, star: bool) -> Panel:
    w, places = np.array(curves.design.relative_speeds), _some(curves.design.loads, 3)
    first, second = (
        _surface(curves, Setting(**ROTATING, tilt=tilt, inertia=True, bodies=kind), star) for kind in curves.design.bodies
    )
    names = curves.design.bodies
    lines = {f", {names[0]}": first, f", {names[1]}": second} if star else {"": second / first}
    label = _STAR if star else f"K {names[1]} / K {names[0]} [-]"

    def draw(axes: Axes) -> None:
        for (name, values), style in zip(lines.items(), ("--" if star else "-", "-"), strict=False):
            for k, colour in zip(places, colours(len(places)), strict=True):
                axes.plot(w, values[k], style, color=colour, linewidth=1.7, label=f"{curves.design.loads[k]:g} N{name}")
        finish(axes, TILT_WORDS[tilt], _SPEED, label, legend=2 if star else 3)

    words = "; ".join(f"{curves.design.loads[k]:g} N{name}: {ends(v[k])}" for name, v in lines.items() for k in places)
    return Panel(draw, f"{label} over w*, {TILT_WORDS[tilt]}: {words}", "")
