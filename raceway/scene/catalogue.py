"""Bearing presets, with the source of every number.

One TOML file a preset, in ``raceway/data/bearings``, holds ``title`` and one table for each key of the scene's [bearing] table
(``rings.young`` is [rings.young]) with ``value``, ``source`` and, where no document states the number, ``inferred = true``.

One TOML file a series, in ``raceway/data/series``, holds the same for many bearings: [columns.KEY] with ``source``, ``inferred`` and the name of the
column of its relative scatter, [constants.KEY] for what all have, and in [bearings] a row of numbers a designation.  Series are
written by ``python packages/raceway-catalogue/tests/presets.py`` from what makers print.  ``70.toml`` and ``70_NTN.toml`` are one series of two makers.

``maker`` says whose bearings they are, ``uncertainty`` what is not known of their stiffness: parts of ``raceway/data/uncertainty.toml``.
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Iterator
from fnmatch import fnmatch
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import TYPE_CHECKING

import attrs

from raceway.errors import SceneError
from raceway.scene.bearing import data_table
from raceway.scene.designation import RATINGS
from raceway.storage.tables import ReadTables, Tables, nested

if TYPE_CHECKING:
    from raceway.scene.designation import Designation

#: What a result says of each part of ``raceway/data/uncertainty.toml``.
_INFERRED, _PART = "inferred geometry", ("part", "axial", "radial", "why", "remedy")
#: Relative scatter of the conformity of presets with a file of their own: of the sizes of series 70, fitted one by one, (f - 0.5) scatters by 5 % (``studies.infer``).
_CONFORMITY = 0.002
#: Names that the message of an unknown preset offers, and the share of common letters from which they are like it.
_OFFERED, _LIKE = 5, 0.5
#: Way out where the balls of a bearing are not known.
_NEEDED = (
    "Give [bearing] `ball_count`, `ball_diameter`, `pitch_diameter`, `conformity_inner`, `conformity_outer` and `radial_clearance` or "
    "`contact_angle_deg` instead of `preset`, or infer the balls from printed ratings: `raceway catalogue --infer`"
)


@attrs.frozen
class Fact:
    """One number of a preset: key of the [bearing] table, value, where it comes from; relative uncertainty of what is inferred."""

    key: str
    value: object
    source: str
    inferred: bool
    scatter: float | None = None


@attrs.frozen
class Preset:
    """A bearing of the catalogue.

    Attributes
    ----------
    maker : whose geometry it is, "" where the source says none
    data : what is not known of the stiffness, as ``geometry.data`` of a result; empty: a source states the numbers
    printed : how well the inferred geometry meets what the maker prints, relative errors by name
    designation, tolerance_class : what the parts of a maker's designation mean, in one line; its class of ISO 492

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.catalogue("7014C")[0]
    >>> [(fact.key, fact.scatter) for fact in found.facts if fact.key == "pitch_diameter"], found.stiffness_error
    ([('pitch_diameter', 0.01)], 0.045)
    """

    name: str
    title: str
    facts: tuple[Fact, ...]
    maker: str = ""
    data: tuple[Tables, ...] = ()
    printed: dict[str, float] = attrs.field(factory=dict)
    designation: str = ""
    tolerance_class: str = ""

    @property
    def stiffness_error(self) -> float | None:
        """Relative uncertainty of its axial stiffness by inferred geometry, 95 %; None: of numbers that a source states."""
        return max(map(abs, self.data[0]["axial"])) if self.data else None

    @property
    def radial_stiffness_error(self) -> float | None:
        """The same of the radial stiffness, tilt locked."""
        return max(map(abs, self.data[0]["radial"])) if self.data else None

    @property
    def size(self) -> tuple[object, ...]:
        """Bore, outer diameter, width [m] and nominal contact angle [deg], a multiple of 5."""
        table = self.table
        return *(table.get(key) for key in ("bore", "outer_diameter", "width")), 5 * round(0.2 * table["contact_angle_deg"])

    @property
    def table(self) -> Tables:
        """The [bearing] table that the preset stands for, without the printed ratings."""
        return nested((fact.key, fact.value) for fact in self.facts if fact.key not in RATINGS and _of_bearing(fact.key))

    @property
    def other_tables(self) -> Tables:
        """Further tables of a scene with this bearing, such as [bodies] of rollers; empty for ball bearings."""
        return nested((fact.key, fact.value) for fact in self.facts if not _of_bearing(fact.key))

    @property
    def ratings(self) -> dict[str, float]:
        """Printed load ratings [N] by their keys, where a document prints them."""
        return {fact.key: float(str(fact.value)) for fact in self.facts if fact.key in RATINGS}


def _of_bearing(key: str) -> bool:
    return key.partition(".")[0] not in ("bodies", "contact", "supports")


@cache
def catalogue() -> dict[str, Preset]:
    """All presets by name: those with a file of their own, then the series."""
    presets = dict(single_presets())
    for stem in _series_files():
        for name, entry in _series_presets(stem).items():
            presets.setdefault(name, entry)
    return presets


@cache
def _series_files() -> dict[str, Traversable]:
    """By the beginning of the designations in it, and for another maker's series _ and that."""
    return {file.name.removesuffix(".toml"): file for file in _tomls(files("raceway").joinpath("data/series"))}


@cache
def _series_presets(stem: str) -> dict[str, Preset]:
    return {entry.name: entry for entry in _series(tomllib.loads(_series_files()[stem].read_text(encoding="utf-8")))}


@cache
def single_presets() -> dict[str, Preset]:
    """Presets with a file of their own; they go before those of a series."""
    return {entry.name: entry for entry in map(_single, _tomls(files("raceway").joinpath("data/bearings")))}


def preset_of(name: object, maker: object = None) -> Preset | None:
    """One preset, by its name in the catalogue or by a maker's designation.

    maker : whose bearing of these dimensions and this contact angle it is; None: that of the name

    SceneError: A designation of a kind of bearing that is not computed; a maker that is not known, or has no such bearing here.
    """
    entry = _entry(name) if isinstance(name, str) else None
    return entry if maker is None or entry is None or entry.maker == maker else _of_maker(str(name), str(maker))


@cache
def _of_maker(name: str, maker: str) -> Preset:
    """The bearing of a maker with the dimensions and the nominal angle of a preset; errors as in ``preset_of``."""
    from raceway.scene.designation import read_designation

    entry, designation, makers = _entry(name), read_designation(name), set[str]()
    for other in catalogue().values():
        makers.add(other.maker)
        if entry is not None and (other.maker, other.size) == (maker, entry.size):
            return other if designation is None or not entry.designation else _with_designation(name, other, designation)
    rule = (
        f"must be one of {', '.join(sorted(filter(None, makers)))} with a bearing of the size of {name}. Leave it out, which states "
        "the spread between makers, or infer the bearing from what this one prints: `raceway catalogue --infer`"
    )
    raise SceneError.at("bearing.maker", maker, rule)


@cache
def _entry(name: str) -> Preset | None:
    if (entry := _preset_named(name)) is not None:
        return entry
    from raceway.scene.designation import read_designation

    designation = read_designation(name)
    if designation is None:
        return None
    entry = next(filter(None, map(_preset_named, designation.names)), None)
    return None if entry is None else _with_designation(name, entry, designation)


def _with_designation(name: str, entry: Preset, designation: Designation) -> Preset:
    """A bearing of the catalogue with what a designation says of clearance, balls and tolerances."""
    from raceway.scene.designation import clearance_range

    facts, data = {fact.key: fact for fact in entry.facts}, entry.data
    if designation.clearance and "radial_clearance" in facts:
        kind = "roller" if "bodies.kind" in facts else "ball"
        limits = clearance_range(kind, float(str(facts["bore"].value)), designation.clearance) or (0.0, 0.0)
        source = f"ISO 5753-1, class {designation.clearance}, middle of the range; uncertainty: the range"
        scatter = (limits[1] - limits[0]) / sum(limits)
        facts["radial_clearance"] = Fact("radial_clearance", 0.5 * sum(limits), source, True, scatter)
        why = f"clearance class {designation.clearance}: {1e6 * limits[0]:g} to {1e6 * limits[1]:g} µm"
        said = {"why": why, "remedy": "`bearing.radial_clearance`"}
        data = tuple({**part, **part["of_class"], **said} if "of_class" in part else part for part in data)
    if designation.ceramic:
        facts = {key: fact for key, fact in facts.items() if not key.startswith("balls.")}
        facts["balls.material"] = Fact("balls.material", designation.ceramic, f"{name}: ceramic balls", False)
    title = f"{name}: {entry.title.partition(': ')[2] or entry.title}"
    entry = attrs.evolve(entry, name=name, title=title, facts=tuple(facts.values()), data=data)
    return attrs.evolve(entry, designation=designation.words, tolerance_class=designation.tolerance)


def _preset_named(name: str) -> Preset | None:
    """By its name in the catalogue; only the series that it begins with are read."""
    series = (stem for stem in _series_files() if name.startswith(stem.partition("_")[0]))
    return single_presets().get(name) or next(filter(None, (_series_presets(stem).get(name) for stem in series)), None)


def _tomls(folder: Traversable) -> list[Traversable]:
    return sorted((file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda f: f.name)


def _single(file: Traversable) -> Preset:
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    title, maker, data = content.pop("title"), content.pop("maker", ""), _uncertainty(content.pop("uncertainty", ()))
    return Preset(file.name.removesuffix(".toml"), title, tuple(_facts(content, "")), maker, data)


def _uncertainty(names: Iterable[str]) -> tuple[Tables, ...]:
    return tuple(data_table("uncertainty")[name] for name in names)


def _facts(tables: ReadTables, prefix: str) -> list[Fact]:
    facts: list[Fact] = []
    for key, table in tables.items():
        if "value" in table:
            by_inference = bool(table.get("inferred", False))
            scatter = table.get("scatter", _CONFORMITY if by_inference and key.startswith("conformity") else None)
            facts.append(Fact(prefix + key, table["value"], table["source"], by_inference, scatter))
        else:
            facts += _facts(table, f"{prefix}{key}.")
    return facts


def _series(content: ReadTables) -> Iterator[Preset]:
    columns, same = content["columns"], _facts(content["constants"], "")
    for name, numbers in content["bearings"].items():
        row = dict(zip(content["order"], numbers, strict=True))
        columns_of = [
            Fact(key, row[key], column["source"], bool(column.get("inferred", False)), row.get(column.get("scatter")))
            for key, column in columns.items()
        ]
        title = f"{name}: {content['title']}, {1e3 * row['bore']:g} x {1e3 * row['outer_diameter']:g} x {1e3 * row['width']:g} mm"
        title += f", {row['contact_angle_deg']:g} deg" if row["contact_angle_deg"] else ""
        ratings = {key: row[key] for key in content["printed"]}
        yield Preset(name, title, (*columns_of, *same), content["maker"], _uncertainty(content["uncertainty"]), ratings)


def found_by(pattern: str) -> list[Preset]:
    """Presets whose name matches a pattern of the shell (70*C), or holds the text, in any case."""
    word = pattern.lower()
    matches = [entry for entry in catalogue().values() if fnmatch(entry.name.lower(), word)]
    matches = matches or [entry for entry in catalogue().values() if word in entry.name.lower()]
    return matches or [entry for entry in [preset_of(pattern)] if entry is not None]


def preset(name: object, maker: object = None) -> Tables:
    """The [bearing] table of a preset; SceneError: unknown name, with the nearest five, or maker, with the known ones."""
    entry = preset_of(name, maker)
    if entry is None:
        raise SceneError.at("bearing.preset", name, no_preset(str(name)))
    return {**entry.table, "preset": name}


def no_preset(name: str) -> str:
    """What is said of an unknown designation."""
    from raceway.scene.designation import read_designation, unlisted

    by_lower = {word.lower(): word for word in catalogue()}
    if bearing := unlisted(name):
        return f"is {bearing}, whose balls the catalogue does not have. {_NEEDED}"
    close = difflib.get_close_matches(name.lower(), list(by_lower), n=_OFFERED, cutoff=_LIKE)
    designation = read_designation(name)
    why = f" ({designation.words})" if designation is not None and not designation.names else ""
    if not close:
        return f"no such preset{why}, and none like it (`raceway catalogue` lists all). {_NEEDED}"
    return f"no such preset{why}; the nearest: {', '.join(by_lower[word] for word in close)} (`raceway catalogue` lists all)"


def geometry_of(bearing: ReadTables, tables: ReadTables) -> Tables | None:
    """What a result says of the uncertainty of presets; None without one, or where their sources state the numbers.

    bearing : the [bearing] table with the presets' numbers, in its rows, too
    tables : the table as the user wrote it, whose own numbers are no inferred ones

    ``preset`` and ``inferences`` are those of [bearing]; rows of other presets are in ``rows``, by their numbers from 0.  Of
    several presets the uncertainties are the largest.
    """
    rows = tables.get("row")
    rows = rows if isinstance(rows, list | tuple) else []
    of_all = {"maker": tables.get("maker")}
    presets_of = {k: row for k, row in enumerate(rows) if isinstance(row, dict) and "preset" in row}
    inferences = {k: _inference(row["preset"], {**of_all, **row}) for k, row in presets_of.items()}
    by_row = {k: geometry for k, geometry in inferences.items() if geometry is not None}
    # Where all rows bring presets, nothing of the table's own is left to speak of.
    common = _inference(bearing.get("preset"), tables) if not rows or len(inferences) < len(rows) else None
    if common is None and not by_row:
        return None
    presets = [*([] if common is None else [common]), *by_row.values()]
    data: dict[str, Tables] = {}
    for part in (part for geometry in presets for part in geometry["data"]):
        same = data.setdefault(part["part"], dict(part))
        for key in ("axial", "radial"):
            same[key] = [min(same[key][0], part[key][0]), max(same[key][1], part[key][1])]
    axial, radial = (max(geometry[key] for geometry in presets) for key in ("stiffness_error", "radial_stiffness_error"))
    alike = all((p["maker"], p["inferred_from"]) == (presets[0]["maker"], presets[0]["inferred_from"]) for p in presets)
    maker, source = (presets[0]["maker"], presets[0]["inferred_from"]) if alike else (None, None)
    whose = f"{maker}'s geometry inferred" if maker else "geometry inferred" + (f" from {source}'s prints" if source else "")
    first = f"stiffness uncertain by about {100.0 * axial:.0f} % axially, {100.0 * radial:.0f} % radially"
    return {
        **(common or {}),
        **({"rows": [{"row": k, **geometry} for k, geometry in by_row.items()]} if by_row else {}),
        "maker": maker,
        "inferred_from": source,
        "stiffness_error": axial,
        "radial_stiffness_error": radial,
        "data": list(data.values()),
        "words": f"{whose}: {'; '.join(first if key == _INFERRED else _words(part) for key, part in data.items())}",
    }


def _words(part: ReadTables) -> str:
    """A part in a line of a screen, and the key that removes it."""
    axial, radial = (f"{100.0 * low:+.0f} to {100.0 * high:+.0f} %" for low, high in (part["axial"], part["radial"]))
    both = axial if axial == radial else f"{axial} axially, {radial} radially"
    return f"{part['why'].partition(':')[0]}: {both} ({part['remedy']})"


def _inference(name: object, tables: ReadTables) -> Tables | None:
    """preset, maker, inferred and uncertainties of one preset, less the keys that the user gives."""
    entry = preset_of(name, tables.get("maker"))
    if entry is None or not entry.data:
        return None
    shown = [fact for fact in entry.facts if "." not in fact.key or fact.key == "bodies.roller_length"]
    facts = [fact for fact in shown if fact.inferred and fact.key not in tables]
    if not facts:
        return None
    # What is known of a part: all keys of one of its sets.
    data = [
        {key: part[key] for key in _PART}
        for part in entry.data
        if not any(all(tables.get(key) is not None for key in keys) for keys in part.get("known_by", ()))
    ]
    parts = {part["part"]: part for part in data}
    own = parts.get(_INFERRED, {"axial": [0.0], "radial": [0.0], "why": ""})
    return {
        "preset": entry.name,
        **({"designation": entry.designation} if entry.designation else {}),
        "maker": entry.maker if entry.maker and "other makers" not in parts else None,
        "inferred_from": entry.maker or None,
        "inferred": {fact.key: {"value": fact.value, "scatter": fact.scatter, "source": fact.source} for fact in facts},
        "printed": {fact.key: {"value": fact.value, "source": fact.source} for fact in shown if not fact.inferred},
        "stiffness_error": max(map(abs, own["axial"])),
        "radial_stiffness_error": max(map(abs, own["radial"])),
        "stiffness_basis": own["why"],
        "data": data,
    }
