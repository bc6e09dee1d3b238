"""The page of ``raceway view``: the bearing to turn about with WebGL, its balls as a table, and the pictures.

The page carries everything and asks for nothing.  pyvista's own export to HTML is not used: it wants a server's packages
besides pyvista, and its scene carries no numbers.
"""

import base64
import json
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.resources import files
from string import Template

import numpy as np

from raceway.extend import Page, Tables, data_uri
from raceway_view.bodies import BearingSolids, Solid, Snapshot, Surface, ball, joined
from raceway_view.pictures import LOADS, PRESSURES

#: Points of a shape: WebGL 1 counts them in 16 bits.  Contact ellipses that go into one.
_MOST, _TOGETHER = 65535, 100
#: Pictures with more columns than this are never shown narrower than the text on them can be read [px].
_WIDE = 1000

BALL_COLUMNS = [
    "ball", "azimuth [deg]", "load [N]", "contact angle [deg]", "peak pressure [MPa]",
    "a, across [mm]", "b, rolling [mm]",
]  # fmt: skip


def view_page(bearing: BearingSolids, state: Snapshot, words: Tables, pictures: Sequence[tuple[bytes, str, str]]) -> Page:
    """The page.

    words : title, subtitle, when (which state is shown), lead (a paragraph), notes (sentences), quantities (name, value, remark)
    pictures : (bytes of a PNG file, what is seen, caption)
    """
    page = Page(words["title"], words["subtitle"], "Made by `raceway view`; opens without a network.")
    page.section("The bearing")
    page.text(words["lead"], f"Shown {words['when']}.", kind="lead")
    for note in words["notes"]:
        page.text(note, kind="note")
    data = {**rings_data(bearing), **state_data(bearing, state)}
    parts = {
        "bars": "".join(data.pop("bars")),
        "data": json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
        "script": files("raceway_view").joinpath("data/view.js").read_text(encoding="utf-8"),
        "label": escape(f"The bearing in three dimensions, {len(state.azimuth)} balls", quote=True),
    }
    page.markup(Template((files("raceway_view") / "data/view_stage.html").read_text(encoding="utf-8")).substitute(parts))
    page.section("Balls")
    for inner in (True, False):
        race = "inner" if inner else "outer"
        caption = f"Contacts with the {race} race {words['when']}; a and b are the semi-axes"
        page.table(BALL_COLUMNS, ball_cells(state, inner), caption)
    if words["quantities"]:
        page.section("Life, friction and other quantities")
        page.table(("quantity", "value", "remark"), words["quantities"])
    page.section("Pictures")
    for content, alternative, caption in pictures:  # a narrow screen shows them large enough to be read, and swipes over
        label, below = escape(alternative, quote=True), escape(caption, quote=False)
        wide = " wide" if content.startswith(b"\x89PNG") and int.from_bytes(content[16:20], "big") > _WIDE else ""
        page.markup(
            f'<figure class="picture"><div class="scroll swipe{wide}" tabindex="0" role="region" aria-label="{label}">'
            f'<img alt="{label}" src="{data_uri(content)}"></div><figcaption>{below}</figcaption></figure>'
        )
    return page


def rings_data(bearing: BearingSolids, facets: int = 120) -> Tables:
    """Shapes that loads do not change, and the parts that they draw, for ``view.js``; ``facets`` round a ring, a quarter round a ball."""
    from matplotlib.colors import to_rgb

    rings = bearing.rings(facets=facets)
    shapes = {f"ring {k}": _packing(part.surface) for k, part in enumerate(rings)}
    parts = [_part(part, f"ring {k}", np.zeros(3), list(to_rgb(part.colour or "white"))) for k, part in enumerate(rings)]
    shapes["ball"] = _packing(ball(bearing.diameter, facets // 6, facets // 4))
    return {"fixed_shapes": shapes, "fixed_parts": parts}


def state_data(bearing: BearingSolids, state: Snapshot) -> Tables:
    """Balls by their loads, forces, contact ellipses by their pressures and labels, for ``view.js``."""
    # Largest load on an inner race [N], and largest pressure [MPa].
    top, peak = max(float(state.load[: len(state.azimuth)].max()), 1e-12), max(1e-6 * float(state.peak.max()), 1e-12)
    centres, tips = bearing.centres(state), bearing.tips(state, top)
    shapes: Tables = {}
    tones = [_short(_tone(LOADS, state.load[k] / top)) for k in range(len(centres))]
    parts = [
        {"name": f"ball {k}", "shape": "ball", "at": _short(centre), "colour": tones[k], "opacity": 1.0}
        for k, centre in enumerate(centres)
    ]
    for k, part in enumerate(bearing.arrows(state, top)):
        shapes[f"arrow {k}"] = _packing(part.surface)
        parts.append(_part(part, f"arrow {k}", np.zeros(3), _tone(LOADS, (part.load or 0.0) / top)))
    patches = bearing.patches(state)
    for k in range(0, len(patches), _TOGETHER):
        together = joined([part.surface for part in patches[k : k + _TOGETHER]])
        shapes[f"patches {k}"] = _packing(together, _tone(PRESSURES, np.asarray(together.values) / peak))
        parts.append(_part(Solid("contacts", together), f"patches {k}", np.zeros(3), np.ones(3)))
    balls = [
        {"at": _short(centre), "text": f"Ball {k} at {np.degrees(state.azimuth[k]) % 360.0:.4g}°: {_ball_words(state, k)}"}
        for k, centre in enumerate(centres)
    ]
    labels = [{"at": _short(tip), "text": f"{k}: {state.load[k]:.3g} N"} for k, tip in enumerate(tips)]
    reach = 1.03 * max(float(np.abs(tips).max()), 0.5 * bearing.outer_diameter)
    return {
        "shapes": shapes, "parts": parts, "balls": balls, "labels": labels, "reach": reach, "radius": 0.5 * bearing.diameter,
        "bars": [_bar("ball load, inner race", "N", LOADS, top), _bar("contact pressure", "MPa", PRESSURES, peak)],
    }  # fmt: skip


def _part(part: Solid, shape: str, at: np.ndarray, colour: np.ndarray | list[float]) -> Tables:
    return {"name": part.name, "shape": shape, "at": _short(at), "colour": _short(colour), "opacity": part.opacity}


def _ball_words(state: Snapshot, k: int) -> str:
    z, words = len(state.azimuth), []
    for i, race in ((k, "inner"), (z + k, "outer")):
        if state.load[i] > 0.0:
            words.append(
                f"{race} race {state.load[i]:.4g} N at {np.degrees(state.angle[i]):.2f}°, {1e-6 * state.peak[i]:.4g} MPa, "
                f"ellipse {2e3 * state.half[i, 0]:.3g} x {2e3 * state.half[i, 1]:.3g} mm"
            )
        else:
            words.append(f"{race} race without contact")
    return "; ".join(words)


def ball_cells(state: Snapshot, inner: bool) -> list[list[object]]:
    """A row for each ball, cells as ``BALL_COLUMNS`` says."""
    z, rows = len(state.azimuth), []
    for k in range(z):
        i = k if inner else z + k
        numbers = [np.degrees(state.angle[i]), 1e-6 * state.peak[i], *(1e3 * state.half[i])]
        cells = [f"{value:.4g}" for value in numbers] if state.load[i] > 0.0 else [None] * 4
        rows.append([k, f"{np.degrees(state.azimuth[k]) % 360.0:.4g}", f"{state.load[i]:.4g}", *cells])
    return rows


def _packing(surface: Surface, tones: np.ndarray | None = None) -> dict[str, str]:
    """Arrays in base64: points as float32, normals as int8 and tones as uint8 in fours, triangles as uint16."""
    assert len(surface.points) <= _MOST
    normals = np.zeros((len(surface.points), 4), dtype=np.int8)
    normals[:, :3] = np.round(127.0 * surface.normals)
    out = {"points": _number_text(surface.points.astype("<f4")), "normals": _number_text(normals)}
    out["triangles"] = _number_text(surface.triangles.astype("<u2"))
    if tones is not None:
        colours = np.full((len(tones), 4), 255, dtype=np.uint8)
        colours[:, :3] = np.round(255.0 * tones)
        out["tones"] = _number_text(colours)
    return out


def _number_text(array: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


@cache
def _tones(colours: str) -> np.ndarray:
    """(256, 3) of a colour map of matplotlib."""
    import matplotlib

    return np.asarray(matplotlib.colormaps[colours](np.arange(256)))[:, :3]


def _tone(colours: str, share: np.ndarray | float) -> np.ndarray:
    """Red, green, blue from 0 to 1 at shares (n,) from 0 to 1 of a colour map."""
    return _tones(colours)[np.clip(256.0 * np.asarray(share, dtype=float), 0, 255).astype(int)]


def _bar(quantity: str, unit: str, colours: str, top: float) -> str:
    """A colour bar with its numbers."""
    tones = [_tone(colours, share) for share in np.linspace(0.0, 1.0, 11)]
    stops = ", ".join(f"rgb({', '.join(str(round(255 * float(part))) for part in tone)})" for tone in tones)
    numbers = "".join(f"<span>{share * top:.4g}</span>" for share in (0.0, 0.25, 0.5, 0.75, 1.0))
    return f'<div class="bar">{escape(quantity)} [{unit}]<i style="background: linear-gradient(90deg, {stops})"></i><div>{numbers}</div></div>'


def _short(values: np.ndarray | list[float]) -> list[float]:
    return [round(float(value), 4) for value in np.asarray(values).ravel()]
