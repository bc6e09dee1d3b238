"""Presets made from what a maker prints: ``python packages/raceway-catalogue/tests/presets.py`` writes raceway/data/series, a file a series."""

import csv
from collections.abc import Iterable
from contextlib import suppress
from math import pi
from pathlib import Path

import attrs
import raceway_catalogue
from raceway_catalogue.deep_groove import GROOVES
from raceway_catalogue.infer import lines_by_size
from raceway_catalogue.inferred import infer_printed
from raceway_catalogue.printed import printed_by
from raceway_catalogue.rating_conventions import CONFORMITY, POISSON, YOUNG

from raceway import Inferred, SceneError
from raceway.extend import clearance_range

FOLDER = Path(__file__).resolve().parents[3] / "raceway" / "data" / "series"
SERIES = ("70", "72", "79")
#: Series of deep-groove bearings of ISO, and how their maker writes them.
DEEP_GROOVE = {"618": "68", "619": "69", "60": "60", "62": "62", "63": "63"}
#: The largest error of a printed rating of a preset.
_LARGEST = 0.01
_ANGULAR_PRINT = "NSK, Super precision bearings, tables of angular contact ball bearings"
_DEEP_PRINT = "NSK, Rolling bearings, CAT. No. E1102e, tables of single-row deep groove ball bearings"


@attrs.frozen
class _Kind:
    """What the file of a series says beside numbers.

    title, maker : of the series;  uncertainty : parts in raceway/data/uncertainty.toml;  columns : source, whether it is inferred, and the column of its relative scatter
    constants : value, source and scatter of what all bearings of the series have
    errors : what is printed and compared
    """

    title: str
    uncertainty: tuple[str, ...]
    columns: dict[str, tuple[str, bool, str | None]]
    constants: dict[str, tuple[object, str, float | None]]
    maker: str = "NSK"
    errors: tuple[str, ...] = ("dynamic_rating_error", "static_rating_error")


def _columns(printed: str, angle: str, how: str, pitch: str) -> dict[str, tuple[str, bool, str | None]]:
    keys = "bore", "outer_diameter", "width", "contact_angle_deg", "dynamic_rating", "static_rating"
    columns: dict[str, tuple[str, bool, str | None]] = dict.fromkeys(keys, (printed, False, None))
    columns["contact_angle_deg"] = angle, False, None
    return columns | {
        "ball_count": (
            f"{how}, by the tables of ISO 281 and ISO 76; scatter: what remains for all other counts",
            True,
            "count_scatter",
        ),
        "ball_diameter": (f"{how}: the usual size that meets them; scatter: what C alone leaves", True, "ball_scatter"),
        "pitch_diameter": (pitch, True, "pitch_scatter"),
    }


def _steel(young: float, why: str) -> dict[str, tuple[float, str, float | None]]:
    numbers = (("young", young), ("poisson", POISSON))
    return {f"{part}.{key}": (value, why, None) for part in ("rings", "balls") for key, value in numbers}


_FITTED = "meets the printed axial stiffnesses of 384 pairs of series 70 with a median error of 0.8 %; scatter: of the sizes, fitted one by one"
_GROOVES = (
    "largest groove radius that the ratings of ISO 76 and ISO/TS 16281 allow, a default: makers print none; scatter: 0.515 to 0.525 inner, "
    "0.52 to 0.535 outer"
)


def _angular(series: str) -> _Kind:
    return _Kind(
        f"angular-contact ball bearing of series {series}",
        ("angular_79" if series == "79" else "angular", f"makers_{series}"),
        _columns(
            _ANGULAR_PRINT,
            "suffix C 15, A5 25, A 30 deg; " + _ANGULAR_PRINT,
            "inferred by `raceway catalogue --infer` from the load ratings of all contact angles of the size",
            "(bore + outer diameter) / 2; scatter: of 103 bearings whose maker prints it, 101 have it within 1 %",
        ),
        dict.fromkeys(("conformity_inner", "conformity_outer"), (CONFORMITY, _FITTED, 0.0015))
        | _steel(YOUNG, "assumed by the fit of the conformity"),
    )


def _ntn(sizes: list[Inferred]) -> str:
    """Series 70 of NTN's own designations: balls are NSK's, grooves and angle those that give the printed stiffnesses."""
    printed = "NTN-SNR, ULTAGE high-precision angular contact ball bearings 70xxU, 79xxU"
    balls = "inferred: NSK's of the same dimensions, NTN prints none; where it has one more ball, a narrower groove stands for it"
    fitted = f"gives axial and radial stiffness of the pair that NTN prints: {printed}"
    columns: dict[str, tuple[str, bool, str | None]] = dict.fromkeys(
        ("bore", "outer_diameter", "width"), (printed, False, None)
    )
    columns["contact_angle_deg"] = f"{fitted}; nominal: suffix UC 15, UAD 25 deg", True, "angle_scatter"
    for key in ("ball_count", "ball_diameter", "pitch_diameter", "conformity_inner", "conformity_outer"):
        columns[key] = fitted if "conformity" in key else balls, True, f"{key}_scatter"
    errors, rows = ("pair_stiffness_error", "radial_stiffness_error"), []
    steel = _steel(YOUNG, "assumed by the fit of the conformity")
    kind = _Kind("angular-contact ball bearing of NTN's series 70U", ("angular_pair",), columns, steel, "NTN", errors)
    for one in printed_by("ntn"):
        own = next(x for x in sizes if x.printed.names[0].startswith(one.names[0][:4]))
        found = infer_printed(attrs.evolve(one, ratings=own.printed.ratings), maker="NSK")
        (angle,) = found.contact_angles.values()
        numbers = [angle, *found.numbers.values()]
        scatters = [angle.scatter, 1.0 / found.ball_count.value, *(x.scatter for x in numbers[2:])]
        values = [one.bore, one.outer_diameter, one.width, *(x.value for x in numbers)]
        rows.append((one.names[0], _cells(values, [*scatters, *(x.error for x in found.checks[-2:])])))
    return text(kind, rows)


def _deep_groove(series: str) -> _Kind:
    written = f", there series {DEEP_GROOVE[series]}" if DEEP_GROOVE[series] != series else ""
    columns = _columns(
        _DEEP_PRINT + written,
        "deep groove: none without clearance, with it the clearance sets it",
        "inferred by `raceway catalogue --infer` from C, C0 and f_0",
        "(bore + outer diameter) / 2, or what C and C0 ask for; scatter: as found for angular-contact bearings",
    )
    clearance = "ISO 5753-1, class CN (normal), middle of the range, a default: a suffix C2, C3 or C4 says another; scatter: the range"
    return _Kind(
        f"deep-groove ball bearing of series {series}",
        ("deep_groove", "deep_groove_clearance", "makers_deep_groove"),
        {**columns, "radial_clearance": (clearance, True, "clearance_scatter")},
        {"conformity_inner": (GROOVES[0], _GROOVES, 0.01), "conformity_outer": (GROOVES[1], _GROOVES, 0.01)}
        | _steel(207e9, "the steel of ISO/TS 16281"),
    )


#: Rollers over the pitch circle in bearings with cages, and its spread; of shorter ones the effective length is a whole number of mm.
_FILL, _SPREAD, _WHOLE, _SHORT = 0.82, 0.025, 0.1, 14e-3


def rolling_rating(count: int, diameter: float, pitch: float, length: float) -> tuple[float, float]:
    """C of ISO 281, C0 of ISO 76 [N] of one row of cylindrical rollers; lengths in m.  ISO 281:2007, b_m = 1.1; f_c by the
    closed form of ISO/TR 1281-1 with reduction factor 0.83; ISO 76:2006: C0 = 44 (1 - g) Z L D."""
    g, z, d, long = diameter / pitch, count, 1e3 * diameter, 1e3 * length
    ratio = (1.04 * ((1.0 - g) / (1.0 + g)) ** (143 / 108)) ** 4.5
    factor = 0.377 * 0.83 * 551.13373 * g ** (2 / 9) * (1.0 - g) ** (29 / 27) / (1.0 + g) ** 0.25 * (1.0 + ratio) ** (-2 / 9)
    return 1.1 * factor * long ** (7 / 9) * z**0.75 * d ** (29 / 27), 44.0 * (1.0 - g) * z * long * d


def _rollers(cells: dict[str, str]) -> list[float]:
    """Bearing numbers of one size of cylindrical rollers in the order of ``_roller_kind``'s columns, scatters and errors."""
    bore, outside, width, inner, outer = (1e-3 * float(cells[f"{key}_mm"]) for key in _ROLLER_SIZES)
    dynamic, static = float(cells["dynamic_rating_n"]), float(cells["static_rating_n"])
    diameter, pitch = round(0.5 * (outer - inner), 9), round(0.5 * (outer + inner), 9)

    def unlikely(count: int) -> float:
        length = 1e3 * static / rolling_rating(count, diameter, pitch, 1.0)[1]
        whole = (length - round(length)) / _WHOLE if diameter <= _SHORT and inner / bore > 1.2 else 0.0
        return float(((count * diameter / (pi * pitch) - _FILL) / _SPREAD) ** 2 + whole**2)

    count = min(range(6, int(pi * pitch / diameter)), key=unlikely)
    length = static / rolling_rating(count, diameter, pitch, 1.0)[1]
    errors = [
        round(x / y - 1.0, 9) for x, y in zip(rolling_rating(count, diameter, pitch, length), (dynamic, static), strict=True)
    ]
    low, high = clearance_range("roller", bore) or (0.0, 0.0)
    sizes = [bore, outside, width, 0.0, dynamic, static, count, diameter, pitch, 0.5 * (low + high), length]
    return [*sizes, 1.0 / count, (high - low) / (high + low), 1.0 / count, *errors]


_ROLLER_SIZES = ("bore", "outer_diameter", "width", "inner_raceway", "outer_raceway")
_ROLLER_PRINT = "NSK, Rolling bearings, CAT. No. E1102e, tables of single-row cylindrical roller bearings"


def _roller_kind(series: str) -> _Kind:
    races = f"{_ROLLER_PRINT}: raceway diameters F and E" + (
        "; E of N 2.. EC in SKF, General catalogue" if series == "NU2" else ""
    )
    columns = _columns(_ROLLER_PRINT, "cylindrical rollers have none", "", "")
    columns |= {
        "ball_count": ("rollers: inferred, that fill the pitch circle as usual; scatter: one more or less", True,
            "count_scatter"),
        "ball_diameter": (f"of the rollers, (E - F) / 2; {races}", False, None),
        "pitch_diameter": (f"(E + F) / 2; {races}", False, None),
        "radial_clearance": ("ISO 5753-1, class CN (normal), middle of the range, a default: a suffix C2, C3 or C4 says another", True,
            "clearance_scatter"),
        "bodies.roller_length": ("effective length: inferred from the printed C0 by ISO 76, with the rollers' number", True,
            "length_scatter"),
    }  # fmt: skip
    title = f"cylindrical roller bearing of series {series}"
    needed = "a key of ball bearings, not used"
    constants = {"conformity_inner": (0.52, needed, None), "conformity_outer": (0.52, needed, None)}
    scene = {"bodies.kind": "cylindrical_rollers", "contact.kind": "line", "supports.axial": "displacement"}
    return _Kind(
        title, ("rollers", "rollers_clearance", "makers_rollers"), columns,
        constants | {key: (word, "of cylindrical rollers", None) for key, word in scene.items()},
    )  # fmt: skip


def _roller_texts() -> dict[str, str]:
    lines = [
        line
        for line in (Path(raceway_catalogue.__file__).parent / "data" / "printed" / "nsk_cylindrical.csv")
        .read_text("utf-8")
        .splitlines()
        if line[0] != "#"
    ]
    rows = {cells["name"]: _rollers(cells) for cells in csv.DictReader(lines)}
    kinds = {series: _roller_kind(series) for series in ("NU2", "NU10")}
    return {
        series: text(kind, [(name, _cells(row[:11], row[11:])) for name, row in rows.items() if name[:-2] == series])
        for series, kind in kinds.items()
    }


def text(kind: _Kind, bearings: list[tuple[str, str]]) -> str:
    """The TOML file of a series, with the rows of its bearings by designation."""
    order = [*kind.columns, *(scatter for *_, scatter in kind.columns.values() if scatter), *kind.errors]
    lines = [
        "# Written by `python packages/raceway-catalogue/tests/presets.py`; do not edit by hand.  Lengths in m; scatters and errors are relative.",
        f'title = "{kind.title}"',
        f'maker = "{kind.maker}"',
        f"uncertainty = {_list(kind.uncertainty)}",
        f"order = {_list(order)}",
        "# Computed over printed, less 1: at the bearing's own contact angle.",
        f"printed = {_list(kind.errors)}",
    ]
    for key, (source, inferred, scatter) in kind.columns.items():
        head = f'"{key}"' if "." in key else key
        lines += ["", f"[columns.{head}]", f'source = "{source}"']
        lines += ["inferred = true", f'scatter = "{scatter}"'] if inferred else []
    for key, (value, source, spread) in kind.constants.items():
        written = f'"{value}"' if isinstance(value, str) else repr(value)
        lines += ["", f"[constants.{key}]", f"value = {written}", f'source = "{source}"', "inferred = true"]
        lines += [] if spread is None else [f"scatter = {spread}"]
    lines += ["", "[bearings]"]
    lines += [f"{name} = {row}" for name, row in bearings]
    return "\n".join(lines) + "\n"


def _cells(numbers: Iterable[float], errors: Iterable[float]) -> str:
    """Errors that are the rounding of a processor are none."""
    return f"[{', '.join([f'{x:.10g}' for x in numbers] + [f'{x if abs(x) > 1e-9 else 0.0:.1e}' for x in errors])}]"


def _rows(found: Inferred) -> list[tuple[str, str]]:
    one, rows = found.printed, []
    for name, rating in zip(one.names, one.ratings, strict=True):
        here = [x for x in found.checks if x.contact_angle_deg == rating.contact_angle_deg]
        errors = [next(x.error for x in here if x.quantity == word) for word in ("dynamic rating", "static rating")]
        numbers = [one.bore, one.outer_diameter, one.width, rating.contact_angle_deg, rating.dynamic, rating.static]
        numbers += [n.value for n in list(found.numbers.values())[:3]]
        scatters = [found.ball_count.scatter, found.ball_diameter.scatter, found.pitch_diameter.scatter]
        if one.deep_groove and (limits := clearance_range("ball", one.bore)):
            numbers.append(0.5 * sum(limits))
            scatters.append((limits[1] - limits[0]) / sum(limits))
        rows.append((_key(name), _cells(numbers, [*scatters, *errors])))
    return rows


def _key(name: str) -> str:
    """A designation as a key of TOML: 68 and 69 of the maker as 618 and 619 of ISO, a slash before a bore that is no code."""
    series = next((iso for iso, written in DEEP_GROOVE.items() if iso != written and name.startswith(written)), None)
    if series is None:
        return f'"{name}"' if "/" in name else name
    bore = name[2:]
    return f"{series}{bore}" if len(bore) == 2 else f'"{series}/{bore.removeprefix("/")}"'


def _list(words: Iterable[str]) -> str:
    return "[" + ", ".join(f'"{word}"' for word in words) + "]"


def every() -> dict[str, str]:
    """Text by series."""

    def of(kind: _Kind, sizes: list[Inferred], written: str) -> str:
        return text(kind, [row for x in sizes if x.printed.names[0].startswith(written) for row in _rows(x)])

    sizes = [infer_printed(one, maker="NSK", conformity=CONFORMITY) for one in lines_by_size(printed_by("nsk"))]
    deep = []
    for one in printed_by("nsk_deep_groove"):
        with suppress(SceneError):  # one of 256 has ratings that no balls explain
            deep.append(infer_printed(one, maker="NSK"))
    deep = [x for x in deep if max(abs(check.error) for check in x.checks) <= _LARGEST]
    return {
        **{series: of(_angular(series), sizes, series) for series in SERIES},
        "70_NTN": _ntn(sizes),
        **{series: of(_deep_groove(series), deep, written) for series, written in DEEP_GROOVE.items()},
        **_roller_texts(),
    }


def main() -> None:
    for series, content in every().items():
        (FOLDER / f"{series}.toml").write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
