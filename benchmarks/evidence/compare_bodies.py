"""What elastic rings and balls do to the dynamic stiffness of the article's bearing, and to its trend with speed."""

from __future__ import annotations

from pathlib import Path

from benchmarks.evidence import Row
from raceway.scene.file import read_toml
from raceway.studies.compare.study import Comparison, compare

TITLE = "What elastic rings and balls change: dynamic stiffness over speed, tilt and seat"
SCENE = "examples/b7206_condensed.toml"
SPEEDS = "excitation.speed_rpm=10980:15000:5"
VARY = ["bodies.kind=rigid,condensed", SPEEDS, "supports.tilt=locked,free"]
COMMAND = f"raceway compare {SCENE} " + " ".join(f"--vary {axis}" for axis in VARY)
#: A housing and a shaft that give: beds of 500 N/mm3 under both rings.
SEATS = {"supports.outer_seat": 500e9, "supports.inner_seat": 500e9}
PICTURES = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "condensed"


def rows() -> list[Row]:
    found = compare(read_toml(SCENE), VARY)
    stiffness = _stiffness(found)
    failed = len(found.to_dict()["rows"]) - len(stiffness)
    out = [
        Row("runs with a dynamic stiffness", f"{len(stiffness)} of {len(stiffness) + failed}", "all", not failed, COMMAND)
    ]
    seated = _stiffness(compare(_on_beds(), [SPEEDS, "supports.tilt=locked,free"]))
    seats = " ".join(f"--set {path}={value:g}" for path, value in SEATS.items())
    beds = f"raceway compare {SCENE} {seats} " + " ".join(f"--vary {axis}" for axis in VARY[1:])
    for tilt in ("locked", "free"):
        rigid, elastic = (_along(stiffness, kind, tilt) for kind in ("rigid", "condensed"))
        soft = _along(seated, "condensed", tilt)
        for word, line, command in (("rigid seats", elastic, COMMAND), ("beds of 500 N/mm3", soft, beds)):
            first, last = (100.0 * (line[i] / rigid[i] - 1.0) for i in (0, -1))
            what = f"tilt {tilt}, {word}: K of elastic bodies over that of rigid ones, at 10 980 and 15 000 r/min"
            out.append(Row(what, f"{first:+.1f} %, {last:+.1f} %", "reported", True, command))
        trend = [f"{100.0 * (line[-1] / line[0] - 1.0):+.1f} %" for line in (rigid, elastic, soft)]
        what = f"tilt {tilt}: change of K from 10 980 to 15 000 r/min: rigid, elastic on rigid seats, elastic on beds"
        out.append(Row(what, ", ".join(trend), "reported", True, COMMAND))
    out += [Row("in words", words, "reported", True, COMMAND) for words in found.words]
    PICTURES.mkdir(exist_ok=True)
    found.picture(PICTURES)
    return out


def _on_beds() -> dict[str, object]:
    tables = read_toml(SCENE)
    for path, value in SEATS.items():
        table, key = path.split(".")
        tables[table][key] = value
    return tables


def _stiffness(found: Comparison) -> dict[tuple[str, str, float], float]:
    """K [N/m] by kind of bodies, tilt and speed."""
    out = {}
    for row in found.to_dict()["rows"]:
        point, result = row["point"], row["result"]
        if "identification" in result:
            key = point.get("bodies.kind", "condensed"), point["supports.tilt"], float(point["excitation.speed_rpm"])
            out[key] = float(result["identification"]["equivalent_stiffness"])
    return out


def _along(stiffness: dict[tuple[str, str, float], float], kind: str, tilt: str) -> list[float]:
    return [value for (bodies, boundary, _), value in sorted(stiffness.items()) if (bodies, boundary) == (kind, tilt)]
