"""Points of ``raceway study article`` that had no steady motion: found by following, or with what a ring does instead."""

from __future__ import annotations

from collections import Counter

from benchmarks.evidence import Row
from raceway.framework.registry import default_registry
from raceway.studies.article.design import Setting, article_tables, design
from raceway.studies.article.runs import Row as Point
from raceway.studies.article.runs import curve

TITLE = "The article's study where no ring stays on a steady motion"
COMMAND = "python -m benchmarks.evidence article_points"
#: The curves of rigid bodies with points that failed before motions were followed from near speeds and heavier loads; 9 of 36 did.
CURVES = (
    ("constant", "free", True, 800.0), ("unbalance", "shaft", True, 400.0), ("unbalance", "free", True, 400.0), ("unbalance", "free", False, 400.0),
)  # fmt: skip


def rows() -> list[Row]:
    registry, made = default_registry(), design(article_tables())
    found: list[tuple[str, Point]] = []
    for amplitude, tilt, inertia, load in CURVES:
        setting = Setting("unidirectional", amplitude, tilt, inertia, "rigid")
        points = [made.point(setting, load, speed, registry) for speed in made.speeds]
        found += [(setting.name, point) for point in curve(points, registry)]
    count = Counter(point["status"] for _, point in found)
    lost = count["failed"] + count["refused"] + sum("not integrated" in point["reason"] for _, point in found)
    kinds = ", ".join(f"{number} {status}" for status, number in count.items())
    out = [Row(f"points that failed, of {len(found)}", lost, "0", lost == 0, COMMAND, f"{kinds}; 9 failed before")]
    for name, point in found:
        if point["status"] != "completed":
            where = f"{name}, {point['axial_n']:g} N, {point['speed_rpm']:g} r/min"
            out.append(Row(where, point["status"], "reported", True, COMMAND, _words(point)))
        elif point["found"] not in ("directly", "from rest"):
            where = f"{name}, {point['axial_n']:g} N, {point['speed_rpm']:g} r/min: K [N/µm]"
            out.append(Row(where, f"{1e-6 * point['k']:.4g}", "reported", True, COMMAND, f"followed {point['found']}"))
    return out


def _words(point: Point) -> str:
    k = f"K {1e-6 * point['k']:.4g} N/µm, found {point['found']}; " if "k" in point else ""
    return k + str(point["reason"])
