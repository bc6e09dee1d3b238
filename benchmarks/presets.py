"""Presets made from what a maker prints: ``python -m benchmarks.presets`` writes raceway/data/series, a file a series."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from raceway.studies.catalogue.infer import _sizes_of
from raceway.studies.catalogue.inferred import STIFFNESS_90, Inferred, infer_printed
from raceway.studies.catalogue.printed import printed_by
from raceway.studies.catalogue.rating_conventions import CONFORMITY, POISSON, YOUNG

FOLDER = Path(__file__).resolve().parents[1] / "raceway" / "data" / "series"
SERIES = ("70", "72", "79")
_PRINTED = "NSK, Super precision bearings, tables of angular contact ball bearings"
_HOW = "inferred by `raceway catalogue --infer` from the load ratings of all contact angles of the size"
#: Columns: source, whether it is inferred, and the column of its relative scatter.
_COLUMNS = {
    "bore": (_PRINTED, False, None),
    "outer_diameter": (_PRINTED, False, None),
    "width": (_PRINTED, False, None),
    "contact_angle_deg": ("suffix C 15, A5 25, A 30 deg; " + _PRINTED, False, None),
    "dynamic_rating": (_PRINTED, False, None),
    "static_rating": (_PRINTED, False, None),
    "ball_count": (
        f"{_HOW}, by the tables of ISO 281 and ISO 76; scatter: what remains for all other counts",
        True,
        "count_scatter",
    ),
    "ball_diameter": (f"{_HOW}: the usual size that meets them; scatter: what C alone leaves", True, "ball_scatter"),
    "pitch_diameter": (
        "(bore + outer diameter) / 2; scatter: of 103 bearings whose maker prints it, 101 have it within 1 %",
        True,
        "pitch_scatter",
    ),
}
#: 90 % of stiffnesses, axial and radial, lie within this, and what was compared (tests/evidence/test_catalogue.py).
_UNCERTAINTY = ("stiffness_error", "radial_stiffness_error", "stiffness_basis")
_KNOWN = (
    STIFFNESS_90["tables"], 0.08,
    '"axial stiffnesses printed for pairs of series 70, from grooves that those of 7206 give, and the reverse; radial: the printed '
    'factors of 15 and 30 deg, which are rounded"',
)  # fmt: skip
_UNCERTAIN = {
    "79": (
        0.2, 0.2,
        '"no stiffness of this series is printed: what one groove for all sizes leaves of a series of another maker, if it is taken '
        'from his other series"',
    )
}  # fmt: skip
_ERRORS = ("dynamic_rating_error", "static_rating_error")


def text(series: str, sizes: list[Inferred]) -> str:
    """The TOML file of a series."""
    order = [*_COLUMNS, "count_scatter", "ball_scatter", "pitch_scatter", *_ERRORS]
    lines = [
        "# Written by `python -m benchmarks.presets`; do not edit by hand.  Lengths in m; scatters and errors are relative.",
        f'title = "angular-contact ball bearing of series {series}"',
        *(f"{key} = {value}" for key, value in zip(_UNCERTAINTY, _UNCERTAIN.get(series, _KNOWN), strict=True)),
        f"order = {_list(order)}",
        "# Computed over printed, less 1: of the printed ratings at the bearing's own contact angle.",
        f"printed = {_list(_ERRORS)}",
    ]
    for key, (source, inferred, scatter) in _COLUMNS.items():
        lines += ["", f"[columns.{key}]", f'source = "{source}"']
        lines += ["inferred = true", f'scatter = "{scatter}"'] if inferred else []
    fitted = "meets the printed axial stiffnesses of 384 pairs of series 70 with a median error of 0.8 %"
    for key in ("conformity_inner", "conformity_outer"):
        lines += _constant(key, CONFORMITY, f"{fitted}; scatter: of the sizes, fitted one by one", 0.0015)
    for part in ("rings", "balls"):
        for key, value in (("young", YOUNG), ("poisson", POISSON)):
            lines += _constant(f"{part}.{key}", value, "assumed by the fit of the conformity", None)
    lines += ["", "[bearings]"]
    for found in sizes:
        lines += [f"{name} = {row}" for name, row in _rows(found)]
    return "\n".join(lines) + "\n"


def _constant(key: str, value: float, source: str, scatter: float | None) -> list[str]:
    lines = ["", f"[constants.{key}]", f"value = {value!r}", f'source = "{source}"', "inferred = true"]
    return lines + ([] if scatter is None else [f"scatter = {scatter}"])


def _rows(found: Inferred) -> list[tuple[str, str]]:
    one, rows = found.printed, []
    for name, rating in zip(one.names, one.ratings, strict=True):
        here = [x for x in found.checks if x.contact_angle_deg == rating.contact_angle_deg]
        errors = [next(x.error for x in here if x.quantity == word) for word in ("dynamic rating", "static rating")]
        numbers = [
            one.bore,
            one.outer_diameter,
            one.width,
            rating.contact_angle_deg,
            rating.dynamic,
            rating.static,
            *(n.value for n in list(found.numbers.values())[:3]),
        ]
        scatters = [found.ball_count.scatter, found.ball_diameter.scatter, found.pitch_diameter.scatter]
        cells = [f"{x:.10g}" for x in numbers] + [f"{x:.1e}" for x in scatters] + [f"{x:.1e}" for x in errors]
        rows.append((name, f"[{', '.join(cells)}]"))
    return rows


def _list(words: Iterable[str]) -> str:
    return "[" + ", ".join(f'"{word}"' for word in words) + "]"


def every() -> dict[str, str]:
    """Text by series."""
    sizes = [infer_printed(one, maker="NSK", conformity=CONFORMITY) for one in _sizes_of(printed_by("nsk"))]
    return {series: text(series, [x for x in sizes if x.printed.names[0].startswith(series)]) for series in SERIES}


def main() -> None:
    for series, content in every().items():
        (FOLDER / f"{series}.toml").write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
