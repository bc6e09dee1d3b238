"""What changes the dynamic stiffness of the article's bearing: main effects, interactions, and words, in the issue's
own comparison of both excitations under identical settings."""

from __future__ import annotations

from pathlib import Path

from benchmarks.evidence import Row
from raceway.scene.file import read_toml
from raceway.studies.compare.study import compare

TITLE = "What causes the change of stiffness: both excitations, amplitude laws, speed, tilt, ball inertia"
VARY = [
    "excitation.kind=unidirectional,bidirectional",
    "excitation.amplitude=constant,unbalance",
    "excitation.speed_rpm=10980:15000:5",
    "supports.tilt=locked,free",
    "kinematics.ball_inertia=false,true",
]
COMMAND = "raceway compare examples/b7206.toml " + " ".join(f"--vary {axis}" for axis in VARY)
PICTURES = Path(__file__).resolve().parents[2] / "docs" / "pictures"


def rows() -> list[Row]:
    found = compare(read_toml("examples/b7206.toml"), VARY)
    content = found.to_dict()
    runs = content["rows"]
    failed = [row for row in runs if "identification" not in row["result"]]
    out = [Row("runs with a dynamic stiffness", f"{len(runs) - len(failed)} of {len(runs)}", "all", not failed, COMMAND)]
    doubtful = [row for row in runs if row.get("doubt")]
    reasons = "; ".join(sorted({str(row["doubt"]) for row in doubtful}))
    note = f"{len(doubtful)} runs in doubt, kept in table and picture, out of the effects: {reasons}" if doubtful else ""
    held = ", ".join(found.held) or "none"
    out.append(Row("axes held because a corner is in doubt", held, "none", not found.held, COMMAND, note))
    unresolved = [effect["term"] for effect in content["effects"] if not effect["resolved"] and len(effect["term"]) == 1]
    worst = 100.0 * max(row["result"]["error"]["total"] for row in runs if row not in failed)
    note = f"largest error of a run {worst:.2g} %, of an effect {100.0 * max(e['error'] for e in content['effects']):.2g} %"
    out.append(Row("main effects on K and |Z| that the runs' errors hide", len(unresolved), "reported", True, COMMAND, note))
    for effect in content["effects"]:
        if effect["quantity"] == "equivalent_stiffness" and len(effect["term"]) <= 2:
            value = f"{effect['percent']:+.2f} %"
            if effect["difference"] is not None:
                value += f" ({effect['difference'] / 1e6:+.2f} N/um)"
            out.append(Row(f"effect on K: {' x '.join(effect['term'])}", value, "reported", True, COMMAND))
    out += [Row("in words", words, "reported", True, COMMAND) for words in found.words]
    found.picture(PICTURES)
    return out
