"""The catalogue of bearings: ``raceway.catalogue``, and the answers of the command."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos
from pathlib import Path
from typing import TYPE_CHECKING, cast

import attrs
import numpy as np

from raceway import Answer, MeshError, Preset, SceneError, door, scene_from_dict
from raceway.extend import (
    Bearing, Fact, Part, Registry, Row, Tables, Words, ball_pass, file_lines, found_by, geometry_of, materials, new_figure,
    no_preset, number, ring_shape, save_figure, sections,
)  # fmt: skip

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK, _RACE, _BALL, _MARK = "#1c2733", "#d5dde5", "#f4f6f8", "#c8501e"
_MM = 1e3
#: Points along a groove.
_POINTS = 60


def section_drawing(name: str, bearing: Bearing) -> Figure:
    """The figure: left the bearing, right one ball."""
    try:
        rings = [ring_outline(bearing, inner) for inner in (True, False)]
    except MeshError as why:
        raise SceneError.at("bearing", name, f"cannot be drawn: {why}") from None
    figure = new_figure(9.0, 5.2)
    full, close = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    for axes in (full, close):
        for outline in rings:
            for sign in (1.0, -1.0) if axes is full else (1.0,):
                axes.fill(_MM * outline[:, 0], sign * _MM * outline[:, 1], facecolor=_RACE, edgecolor=_INK, lw=0.9)
        axes.set_aspect("equal")
        axes.axis("off")
    # Both halves of the section with bore, outer and pitch diameter, and width.
    b = bearing
    bore, outer, width = b.bore or 0.0, b.outer_diameter or 0.0, b.width or 0.0
    for sign in (1.0, -1.0):
        _ball(full, b, sign)
    half, step = 0.5 * _MM * width, 0.09 * _MM * outer
    full.plot([-half - step, half + step], [0.0, 0.0], color=_INK, lw=0.8, ls="-.")
    for k, (value, word) in enumerate(((bore, "d"), (b.pitch_diameter, "$d_m$"), (outer, "D")), 1):
        x, r = half + k * step, 0.5 * _MM * value
        full.annotate("", (x, -r), (x, r), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8})
        for sign in (1.0, -1.0):
            full.plot([0.0 if word == "$d_m$" else half, x], [sign * r] * 2, color=_INK, lw=0.4)
        full.text(x, 0.2 * _MM * bore, f"{word} {_MM * value:.5g}", fontsize=8, rotation=90, va="center", ha="right")
    top = 0.5 * _MM * outer + 0.5 * step
    full.annotate("", (-half, top), (half, top), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8})
    full.text(0.0, top, f"B {_MM * width:.5g}", fontsize=8, ha="center", va="bottom")
    # One ball with its diameter, the line of contact and the grooves.
    _ball(close, b)
    r, radius = 0.5 * _MM * b.pitch_diameter, 0.5 * _MM * b.ball_diameter
    # A positive axial load seats the inner ring along +x: its contact lies at -x below the ball.
    along = np.array([np.sin(b.contact_angle), np.cos(b.contact_angle)])
    ends = np.array([0.0, r]) + np.outer([-1.45, 1.45], along) * radius
    close.plot(*ends.T, color=_MARK, lw=1.0, ls="-.")
    close.plot([0.0, 0.0], [r - 1.45 * radius, r + 1.45 * radius], color=_INK, lw=0.6, ls="-.")
    close.annotate(
        "", (-radius, r), (radius, r), arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    )
    close.text(0.0, r, f"{_MM * b.ball_diameter:.5g}", fontsize=9, ha="center", va="bottom")
    words = (
        f"{b.ball_count} balls of {_MM * b.ball_diameter:.5g}\ncontact angle {np.degrees(b.contact_angle):.4g} deg\n"
        f"grooves {b.conformity_inner:.4g} D inner, {b.conformity_outer:.4g} D outer"
    )
    close.text(0.5, -0.02, words, transform=close.transAxes, fontsize=9, ha="center", va="top", color=_INK)
    close.text(ends[1, 0], ends[1, 1], f" {np.degrees(b.contact_angle):.4g} deg", fontsize=9, color=_MARK)
    figure.suptitle(f"{name}, dimensions in mm")
    return figure


def ring_outline(b: Bearing, inner: bool) -> np.ndarray:
    """Places (n, 2) [m] along the outline of a ring, axial and radial, with its groove and shoulders."""
    shape = ring_shape(b, inner)
    side = 0.5 * shape.width
    reach = np.sqrt(max(shape.groove**2 - (shape.land - shape.centre_r) ** 2, 0.0))
    x = np.linspace(max(shape.centre_x - reach, -side), min(shape.centre_x + reach, side), _POINTS)
    bottom = np.sqrt(shape.groove**2 - np.clip((x - shape.centre_x) ** 2, 0.0, shape.groove**2))
    r = shape.centre_r - bottom if inner else shape.centre_r + bottom
    corners = [(-side, shape.seat), (-side, shape.land)]
    return np.array([*corners, *zip(x, r, strict=True), (side, shape.land), (side, shape.seat)])


def _ball(axes: Axes, b: Bearing, sign: float = 1.0) -> None:
    from matplotlib.patches import Circle

    centre = 0.0, sign * 0.5 * _MM * b.pitch_diameter
    axes.add_patch(Circle(centre, 0.5 * _MM * b.ball_diameter, facecolor=_BALL, edgecolor=_INK, lw=0.9))


_LENGTHS = {
    "bore": "bore d",
    "outer_diameter": "outer diameter D",
    "width": "width B",
    "ball_diameter": "ball diameter",
    "pitch_diameter": "pitch diameter d_m",
}


@door
def catalogue(pattern: str = "*") -> tuple[Preset, ...]:
    """Bearings of the catalogue, which ``preset`` of a scene's [bearing] takes by name.

    Parameters
    ----------
    pattern : as in a shell (``"70*C"``), or a part of the name; in any case

    Returns
    -------
    tuple of Preset
        Each with ``name``, ``title``, ``table`` (the [bearing] table), ``facts`` (value, source, scatter) and ``stiffness_error``

    Raises
    ------
    SceneError
        None has such a name; the nearest five.

    Examples
    --------
    >>> import raceway as rw
    >>> [preset.name for preset in rw.catalogue("7014*")]
    ['7014C', '7014A5', '7014A', '7014UC', '7014UAD']
    >>> rw.catalogue("7014C")[0].table["ball_count"]
    20
    """
    presets = tuple(found_by(pattern))
    if not presets:
        raise SceneError.at("pattern", pattern, no_preset(pattern))
    return presets


@attrs.frozen(repr=False)
class _Listing(Answer):
    """Bearings or materials.  ``title``: what they are;  ``content``: the tables;  ``parts``: what a terminal shows."""

    title: str
    content: Tables
    parts: Sequence[Part]

    def to_dict(self) -> Tables:
        return self.content

    def report(self) -> Sequence[Part]:
        return self.parts

    def _facts(self) -> tuple[str, list[Fact]]:
        return self.title, []


def look_up(pattern: str = "*", picture: str | Path | None = None, materials: bool = False) -> _Listing:
    """List bearings whose name matches PATTERN; for a single one print all numbers with source, uncertainty and ball-pass frequencies.

    Parameters
    ----------
    pattern : shell pattern, or part of the name
    picture : draw the section of a single match, to scale
    materials : list the materials of rings and balls
    """
    if materials:
        return _materials()
    presets = catalogue(pattern)
    if len(presets) == 1:
        return _entry(presets[0], None if picture is None else Path(picture))
    if picture is not None:
        raise SceneError.at("picture", str(picture), f"draws one bearing, '{pattern}' finds {len(presets)}")
    keys = "bore", "outer_diameter", "width", "contact_angle_deg", "ball_count", "ball_diameter", "pitch_diameter"
    rows: list[Tables] = [
        {"name": preset.name, **{key: preset.table.get(key) for key in keys}}
        | {name: getattr(preset, name) for name in ("stiffness_error", "radial_stiffness_error")}
        for preset in presets
    ]
    lines = [
        {
            "name": row["name"],
            **{word: _mm(row[key]) for word, key in (("d mm", "bore"), ("D mm", "outer_diameter"), ("B mm", "width"))},
            "angle deg": "-" if row["contact_angle_deg"] is None else f"{row['contact_angle_deg']:g}",
            "Z": str(row["ball_count"]),
            **{word: _mm(row[key]) for word, key in (("ball mm", "ball_diameter"), ("d_m mm", "pitch_diameter"))},
        }
        for row in rows
    ]
    hint = f'{len(rows)} bearings; raceway catalogue NAME shows one; preset = "NAME" in a scene takes it'
    return _Listing(hint, {"bearings": rows}, [lines, Words(hint, "dim")])


def _mm(metres: float | None) -> str:
    return "-" if metres is None else f"{1e3 * metres:.5g}"


def _entry(preset: Preset, picture: Path | None) -> _Listing:
    """One bearing: numbers with source and scatter, ball-pass frequencies at the free contact angle, what is inferred."""
    scene = scene_from_dict({"title": preset.name, "bearing": {"preset": preset.name}}, Registry(third_party=False))
    b, rows = scene.bearing, list[Row]([("Dimensions", "", "")])
    passes = ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, cos(b.contact_angle))
    geometry = geometry_of({"preset": preset.name}, {})
    sources: dict[str, list[str]] = {}
    for fact in preset.facts:
        value = cast(float, fact.value)
        name = _LENGTHS.get(fact.key, fact.key.replace("_", " ").replace(".", ", "))
        text = number(1e3 * value, "mm") if fact.key in _LENGTHS else f"{value:.6g}"
        if fact.key.endswith(".young"):
            text = number(1e-9 * value, "GPa")
        scatter = "" if fact.scatter is None or fact.key == "ball_count" else f", +- {100.0 * fact.scatter:.2g} %"
        rows.append((name, text, f"inferred{scatter}" if fact.inferred else "stated"))
        sources.setdefault(fact.source, []).append(name)
    cage = f"{passes['ftf']:.4g}, {passes['bsf']:.4g}"
    races = f"{passes['bpfo']:.4g}, {passes['bpfi']:.4g}"
    rows += [
        (f"Ball pass at {b.contact_angle_deg:.4g} deg, times the shaft's speed", "", ""),
        ("cage FTF, ball BSF", cage, "at the free contact angle; a result has it loaded"),
        ("passes BPFO, BPFI", races, "a place of the outer, of the inner race"),
    ]
    parts: list[Part] = [Words(preset.title, "bold"), sections(rows)]
    if preset.printed:
        errors = [f"{key.replace('_error', '').replace('_', ' ')} {100.0 * e:+.2f} %" for key, e in preset.printed.items()]
        parts.append(f"against what the maker prints: {', '.join(errors)}")
    if geometry:
        parts.append(geometry["words"])
    content: Tables = {
        "name": preset.name,
        "title": preset.title,
        "bearing": preset.table,
        "facts": [attrs.asdict(fact) for fact in preset.facts],
        "printed": preset.printed,
        "geometry": geometry,
        "ball_pass": {"contact_angle_deg": b.contact_angle_deg, **passes},
        "files": [] if picture is None else [str(save_figure(section_drawing(preset.name, b), picture))],
    }
    parts += [Words(f"{', '.join(names)}: {source}", "dim") for source, names in sources.items()]
    return _Listing(preset.title, content, [*parts, *file_lines(content["files"])])


def _materials() -> _Listing:
    """The materials of rings and balls, in SI units, with their sources."""
    lines = [
        {
            "name": material.name,
            "E GPa": f"{1e-9 * material.young:g}",
            "nu": f"{material.poisson:g}",
            "density kg/m3": f"{material.density:g}",
            "expansion 1e-6/K": f"{1e6 * material.thermal_expansion:g}",
            "what": material.title,
        }
        for material in materials().values()
    ]
    sources = [Words(f"{material.name}: {material.source}", "dim") for material in materials().values()]
    return _Listing("Materials", {"materials": list(map(attrs.asdict, materials().values()))}, [lines, *sources])
