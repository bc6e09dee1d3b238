"""Error against run time for the article's scene: the default design of ``raceway precision``."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.evidence import Row, below
from raceway.scene.file import read_toml
from raceway.studies.precision.result import EXACT, words_of
from raceway.studies.precision.study import precision

TITLE = "Error against run time: the article's scene, rigid bodies"
SCENE = "examples/b7206.toml"
COMMAND = f"raceway precision {SCENE}"
DOCS = Path(__file__).resolve().parents[2] / "docs"
PICTURES = DOCS / "pictures"
#: The whole study, a row a setting.
FOLDER = DOCS / "reports" / "precision"
#: Error of K and the solve time it may cost [s].
WANTED = ((0.01, 0.05), (0.0001, 1.0))
#: Errors of the second-order methods at equal steps, Newmark's being 1: from the terms in dt^2 of w^2.
THEORY = {"central_difference": 0.5, "newmark": 1.0}


def rows() -> list[Row]:
    study = precision(read_toml(SCENE), repeats=5)
    content = study.to_dict()
    base = [row for row in content["rows"] if row["base"] and row["error"] is not None]
    reference = content["reference"]
    direct = [row for row in base if row["family"] == "steady orbit"]
    best = min(row["error"] for row in base if row not in direct)
    out = [
        below(
            "bound of the reference over the error of the best transient row", reference["error"] / best, 1.0 / EXACT, COMMAND,
            f"|Z| = {reference['value']:.10g} N/m, bound {reference['error']:.1g}: {reference['how']}",
        )
    ]  # fmt: skip
    # Computed anew from the quantities: the marks of the table have to be these.
    within = [_apart(row, reference) <= EXACT * reference["error"] for row in base]
    good = within == [row["at_bound"] for row in base]
    marked = sum(row["at_bound"] for row in direct)
    note = f"of all rows, {sum(within)} are within ten bounds; the steady orbit is the reference's own method, to larger tolerances"
    out.append(Row("rows of the steady orbit that are marked as known to the bound only", f"{marked} of {len(direct)}",
                   "exactly those within ten bounds, here and in all other rows", good, COMMAND, note))  # fmt: skip
    for error, seconds in WANTED:
        good = [row for row in base if row["errors"]["equivalent_stiffness"] + reference["error"] <= error]
        fastest = min(good, key=lambda row: row["cost"]["solve_s"], default=None)
        name = f"solve time for K within {100.0 * error:g} % [ms]"
        if fastest is None:
            out.append(Row(name, "none", f"at most {1e3 * seconds:g}", False, COMMAND))
            continue
        note = f"{words_of(fastest['setting'])}: error of K {fastest['errors']['equivalent_stiffness']:.1g}; "
        note += f"whole run {1e3 * fastest['time_s']:.3g} ms of processor time"
        out.append(below(name, 1e3 * fastest["cost"]["solve_s"], 1e3 * seconds, COMMAND, note))
    out += _order(base)
    out += [Row("finished rows", f"{len(base)} of the scene's model", "reported", True, COMMAND)]
    out += [Row("in words", words, "reported", True, COMMAND) for words in content["words"]]
    _files(study)
    return out


def _apart(row: dict[str, Any], reference: dict[str, Any]) -> float:
    """Distance of a row's Z from the reference's, over the reference's size."""
    own = complex(row["quantities"]["z_real"], row["quantities"]["z_imag"])
    known = complex(*(reference["quantities"][name]["value"] for name in ("z_real", "z_imag")))
    return abs(own - known) / abs(known)


def _order(base: list[dict[str, Any]]) -> list[Row]:
    """Observed orders, and the integrators in the order of theory at equal steps."""
    ladder = [row for row in base if row["family"] == "time step"]
    out = []
    for kind in sorted({row["setting"]["integrator.kind"] for row in ladder}):
        found = [r["order"] for r in ladder if r["setting"]["integrator.kind"] == kind and r["order"] is not None]
        good = bool(found) and all(abs(order - 2.0) <= 0.1 for order in found)
        values = ", ".join(f"{order:.2f}" for order in found)
        out.append(Row(f"observed orders of {kind}", values, "2 within 0.1, all of them", good, COMMAND))
    ratios = []
    for row in ladder:
        if row["setting"]["integrator.kind"] == "central_difference":
            steps = row["setting"]["integrator.steps_per_turn"]
            same = {"integrator.kind": "newmark", "integrator.steps_per_turn": steps}
            ratios.append(row["error"] / next(r["error"] for r in ladder if r["setting"] == same))
    wanted = THEORY["central_difference"] / THEORY["newmark"]
    good = all(abs(ratio - wanted) <= 0.05 * wanted for ratio in ratios)
    note = "w^2 becomes (2/dt sin(w dt/2))^2 and (2/dt tan(w dt/2))^2: -dt^2/12 against +dt^2/6"
    shown = ", ".join(f"{ratio:.3f}" for ratio in ratios)
    out.append(
        Row("error of central_difference over newmark's, equal steps", shown, f"{wanted:g} within 5 %", good, COMMAND, note)
    )
    return out


def _files(study: Any) -> None:
    study.write(FOLDER, pictures=False)
    with tempfile.TemporaryDirectory() as folder:
        study.write(Path(folder), pictures=True)
        shutil.copy(Path(folder) / "precision.png", PICTURES / "precision.png")
