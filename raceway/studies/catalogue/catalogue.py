"""The catalogue of bearings: ``raceway.catalogue``, and the answers of the command."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import cast

import attrs

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry
from raceway.framework.shown import Fact, number
from raceway.out.answer import Answer, Part
from raceway.out.table import Row, sections, written
from raceway.out.wrapping import Words
from raceway.pipeline.equilibrium import ball_pass
from raceway.scene.catalogue import Preset, found_by, geometry_of, materials, no_preset
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.catalogue.section import draw_section

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
    ['7014C', '7014A5', '7014A']
    >>> rw.catalogue("7014C")[0].table["ball_count"]
    20
    """
    presets = tuple(found_by(pattern))
    if not presets:
        raise SceneError.at("pattern", pattern, no_preset(pattern))
    return presets


@attrs.frozen(repr=False)
class Listing(Answer):
    """Bearings or materials.  ``title``: what they are;  ``content``: the tables;  ``parts``: what a terminal shows."""

    title: str
    content: Tables
    parts: Sequence[Part]

    def to_dict(self) -> Tables:
        return self.content

    def report(self) -> Sequence[Part]:
        return self.parts

    def _shown(self) -> tuple[str, list[Fact]]:
        return self.title, []


def look_up(pattern: str = "*", picture: str | Path | None = None, materials: bool = False) -> Listing:
    """List bearings whose name matches PATTERN; of a single one, all numbers with source and scatter, and its frequencies.

    Parameters
    ----------
    pattern : as in a shell, or a part of the name
    picture : draw the section of the one bearing found, in proportion
    materials : list the materials of rings and balls instead
    """
    if materials:
        return _materials()
    presets = catalogue(pattern)
    if picture is not None and Path(picture).suffix.lower() != ".png":
        raise SceneError.at("picture", str(picture), "the file must end in .png")
    if len(presets) == 1:
        return _entry(presets[0], None if picture is None else Path(picture))
    if picture is not None:
        raise SceneError.at("picture", str(picture), f"draws one bearing, '{pattern}' finds {len(presets)}")
    keys = "bore", "outer_diameter", "width", "contact_angle_deg", "ball_count", "ball_diameter", "pitch_diameter"
    rows: list[Tables] = [
        {
            "name": preset.name,
            **{key: preset.table.get(key) for key in keys},
            "stiffness_error": preset.stiffness_error,
            "radial_stiffness_error": preset.radial_stiffness_error,
        }
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
    return Listing(hint, {"bearings": rows}, [lines, Words(hint, "dim")])


def _mm(metres: float | None) -> str:
    return "-" if metres is None else f"{1e3 * metres:.5g}"


def _entry(preset: Preset, picture: Path | None) -> Listing:
    """One bearing: numbers with source and scatter, ball-pass frequencies at the free contact angle, what is inferred."""
    scene = scene_from_dict({"title": preset.name, "bearing": {"preset": preset.name}}, Registry(third_party=False))
    b, rows = scene.bearing, list[Row]([("Dimensions", "", "")])
    passes = ball_pass(b.ball_count, b.ball_diameter, b.pitch_diameter, b.contact_angle)
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
        errors = [
            f"{key.replace('_error', '').replace('_', ' ')} {100.0 * error:+.2f} %" for key, error in preset.printed.items()
        ]
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
        "files": [] if picture is None else [str(draw_section(preset.name, b, picture))],
    }
    parts += [Words(f"{', '.join(names)}: {source}", "dim") for source, names in sources.items()]
    return Listing(preset.title, content, [*parts, *written(content["files"])])


def _materials() -> Listing:
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
    return Listing("Materials", {"materials": list(map(attrs.asdict, materials().values()))}, [lines, *sources])
