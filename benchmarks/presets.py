"""Presets made from what a maker prints: ``python -m benchmarks.presets`` writes raceway/data/series, a file a series."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

import attrs

from raceway.errors import SceneError
from raceway.scene.clearance import clearance_range
from raceway.studies.catalogue.deep_groove import GROOVES, STIFFNESS_ERROR
from raceway.studies.catalogue.infer import _sizes_of
from raceway.studies.catalogue.inferred import STIFFNESS_90, Inferred, infer_printed
from raceway.studies.catalogue.printed import printed_by
from raceway.studies.catalogue.rating_conventions import CONFORMITY, POISSON, YOUNG

FOLDER = Path(__file__).resolve().parents[1] / "raceway" / "data" / "series"
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

    title, uncertainty : of the series;  columns : source, whether it is inferred, and the column of its relative scatter
    constants : value, source and scatter of what all bearings of the series have
    """

    title: str
    uncertainty: tuple[object, ...]
    columns: dict[str, tuple[str, bool, str | None]]
    constants: dict[str, tuple[float, str, float | None]]


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
#: 90 % of stiffnesses, axial and radial, lie within this, and what was compared (tests/evidence/test_catalogue.py).
_UNCERTAINTY = ("stiffness_error", "radial_stiffness_error", "stiffness_basis")
_KNOWN = (
    STIFFNESS_90["tables"], 0.08,
    "axial stiffnesses printed for pairs of series 70, from grooves that those of 7206 give, and the reverse; radial: the printed "
    "factors of 15 and 30 deg, which are rounded",
)  # fmt: skip
_UNCERTAIN = {
    "79": (
        0.2, 0.2,
        "no stiffness of this series is printed: what one groove for all sizes leaves of a series of another maker, if it is taken "
        "from his other series",
    )
}  # fmt: skip
_GROOVES = (
    "largest groove radius that the ratings of ISO 76 and ISO/TS 16281 allow, a default: makers print none; scatter: 0.515 to 0.525 inner, "
    "0.52 to 0.535 outer"
)


def _angular(series: str) -> _Kind:
    return _Kind(
        f"angular-contact ball bearing of series {series}",
        _UNCERTAIN.get(series, _KNOWN),
        _columns(
            _ANGULAR_PRINT,
            "suffix C 15, A5 25, A 30 deg; " + _ANGULAR_PRINT,
            "inferred by `raceway catalogue --infer` from the load ratings of all contact angles of the size",
            "(bore + outer diameter) / 2; scatter: of 103 bearings whose maker prints it, 101 have it within 1 %",
        ),
        dict.fromkeys(("conformity_inner", "conformity_outer"), (CONFORMITY, _FITTED, 0.0015))
        | _steel(YOUNG, "assumed by the fit of the conformity"),
    )


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
        (
            STIFFNESS_ERROR,
            0.09,
            "no stiffness is printed: computed for 6002, 6206 and 6316 with grooves and clearances within their scatter",
        ),
        {**columns, "radial_clearance": (clearance, True, "clearance_scatter")},
        {"conformity_inner": (GROOVES[0], _GROOVES, 0.01), "conformity_outer": (GROOVES[1], _GROOVES, 0.01)}
        | _steel(207e9, "the steel of ISO/TS 16281"),
    )


_ERRORS = ("dynamic_rating_error", "static_rating_error")


def text(kind: _Kind, sizes: list[Inferred]) -> str:
    """The TOML file of a series."""
    order = [*kind.columns, *(scatter for *_, scatter in kind.columns.values() if scatter), *_ERRORS]
    lines = [
        "# Written by `python -m benchmarks.presets`; do not edit by hand.  Lengths in m; scatters and errors are relative.",
        f'title = "{kind.title}"',
        *(f"{key} = {_toml(value)}" for key, value in zip(_UNCERTAINTY, kind.uncertainty, strict=True)),
        f"order = {_list(order)}",
        "# Computed over printed, less 1: of the printed ratings at the bearing's own contact angle.",
        f"printed = {_list(_ERRORS)}",
    ]
    for key, (source, inferred, scatter) in kind.columns.items():
        lines += ["", f"[columns.{key}]", f'source = "{source}"']
        lines += ["inferred = true", f'scatter = "{scatter}"'] if inferred else []
    for key, (value, source, spread) in kind.constants.items():
        lines += ["", f"[constants.{key}]", f"value = {value!r}", f'source = "{source}"', "inferred = true"]
        lines += [] if spread is None else [f"scatter = {spread}"]
    lines += ["", "[bearings]"]
    for found in sizes:
        lines += [f"{name} = {row}" for name, row in _rows(found)]
    return "\n".join(lines) + "\n"


def _toml(value: object) -> str:
    return f'"{value}"' if isinstance(value, str) else repr(value)


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
        cells = [f"{x:.10g}" for x in numbers] + [f"{x:.1e}" for x in scatters] + [f"{x:.1e}" for x in errors]
        rows.append((_key(name), f"[{', '.join(cells)}]"))
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
    sizes = [infer_printed(one, maker="NSK", conformity=CONFORMITY) for one in _sizes_of(printed_by("nsk"))]
    texts = {
        series: text(_angular(series), [x for x in sizes if x.printed.names[0].startswith(series)]) for series in SERIES
    }
    deep = []
    for one in printed_by("nsk_deep_groove"):
        with suppress(SceneError):  # one of 256 has ratings that no balls explain
            deep.append(infer_printed(one, maker="NSK"))
    deep = [x for x in deep if max(abs(check.error) for check in x.checks) <= _LARGEST]
    for series, written in DEEP_GROOVE.items():
        texts[series] = text(_deep_groove(series), [x for x in deep if x.printed.names[0].startswith(written)])
    return texts


def main() -> None:
    for series, content in every().items():
        (FOLDER / f"{series}.toml").write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
