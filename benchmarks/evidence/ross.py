"""ROSS reads our coefficients: at the points, in a rotor's critical speed, and in a loop with the force on the bearing.

The files for Nastran, Ansys and spreadsheets are read back by the fields of their formats: neither program is there.

ROSS is no part of the extra ``all``.  It is looked for in this environment, or in the interpreters that the variable
RACEWAY_ROSS_PYTHON names (several: separated as in PATH), each of which has raceway, too: pip install '.[sweep,ross]'.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import attrs

from benchmarks.evidence import Row, _coefficient_files, below, near

TITLE = "Rotor models: bearings in ROSS, files of coefficients"
ROOT = Path(__file__).resolve().parents[2]
STUDY = "benchmarks.evidence._ross_rotor"
COMMAND = f"python -m {STUDY}"
EXAMPLE = "examples/ross_rotor.py"
#: K of the former example, which iterated step by step [N/µm], and how near the new one has to come.
FORMER, DIGITS = {"1000.0": 230.2772, "400.0": 107.4227}, 1e-6
_TIMEOUT_S = 1800.0


def interpreters() -> list[str]:
    """Those that have ROSS."""
    named = os.environ.get("RACEWAY_ROSS_PYTHON", "")
    return [os.path.abspath(path) for path in named.split(os.pathsep) if path] or (
        [sys.executable] if find_spec("ross") else []
    )


def rows() -> list[Row]:
    found = interpreters()
    if not found:
        note = "extra ross absent: install it in an environment of its own and name its interpreter in RACEWAY_ROSS_PYTHON"
        return [Row("rotor models in ROSS", "not run", "run", False, COMMAND, note), *_coefficient_files.rows()]
    lines = len((ROOT / EXAMPLE).read_text(encoding="utf-8").splitlines())
    return [
        below("lines of the example, which puts two bearings under a rotor", lines, 25, f"python {EXAMPLE}"),
        *(row for path in found for row in _rows(path)),
        *_coefficient_files.rows(),
    ]


def _study(interpreter: str) -> dict[str, Any]:
    """What the study writes."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "numbers.json"
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        command = [interpreter, "-m", STUDY, "--out", str(out)]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=_TIMEOUT_S)
        if done.returncode:
            raise RuntimeError(f"the study ends with {done.returncode}: {done.stderr[-2000:]}")
        return json.loads(out.read_text(encoding="utf-8"))


def _rows(interpreter: str) -> list[Row]:
    found = _study(interpreter)
    name = f"ROSS {found['ross']}"
    by_itself = found["ross"].partition(".")[0] != "2"
    exact, alone = (max(found[key].values()) for key in ("at_points", "at_points_by_itself"))
    out = [
        below(
            f"{name}: all nine coefficients at the points of the table, largest relative difference from ours",
            exact, 1e-12, COMMAND,
            "read by ROSS by itself" if by_itself else "read by ROSS, then passing through the points: raceway.export_ross(...).element()",
        )
    ]  # fmt: skip
    if by_itself:
        out.append(below(f"{name}: the same, the file read by ROSS alone", alone, 1e-12, COMMAND))
        words = f"{name}: kxx of a table over speed and frequency at its 30 points, largest relative difference"
        out.append(below(words, found["grid_at_points"], 1e-12, COMMAND))
    else:
        stiff, damp = (max(v for k, v in found["at_points_by_itself"].items() if k[0] == letter) for letter in "kc")
        out.append(
            Row(
                f"{name}: the same, the file read by ROSS alone: stiffness, damping", f"{stiff:.1e}, {damp:.1e}", "reported", True,
                COMMAND, "its smoothing spline allows 1 N/m or 1 N s/m a point; the exporter says so",
            )
        )  # fmt: skip
    critical = near(
        f"{name}: critical speed of a symmetric rigid rotor [rad/s]", found["critical"], found["critical_closed"], 1e-3,
        COMMAND, "closed form M w^2 = 2 K(w)",
    )  # fmt: skip
    out.append(attrs.evolve(critical, value=f"{found['critical']:.6g}"))
    for axial, steps in found["fixed_point"].items():
        last, first = steps[-1], steps[0]
        out.append(
            below(
                f"{name}: force of the rotor on its bearing against the force of its stiffness, {float(axial):g} N axial, "
                f"after {len(steps)} rounds",
                last["change"], 1e-9, COMMAND,
                f"K {1e-6 * first['k']:.2f} N/µm for small motions, {1e-6 * last['k']:.2f} at {last['force']:.1f} N",
            )
        )  # fmt: skip
    for axial, one in found["inside"].items():
        words = f"{name}: K by raceway.ross at the rotor's own amplitude, {float(axial):g} N axial [N/µm]"
        note = f"{one['force']:.1f} N on the bearing, {one['runs']} evaluations"
        exact = near(words, 1e-6 * one["k"], FORMER[axial], DIGITS, COMMAND, note)
        out.append(attrs.evolve(exact, value=f"{1e-6 * one['k']:.6f}"))
    moved = found["in_time"]
    words = f"{name}: amplitude at the bearing after 40 turns in time against the unbalance response, 400 N axial, relative difference"
    told = f"{1e6 * moved['time']:.3f} against {1e6 * moved['harmonic']:.3f} µm; {1e6 * moved['linear']:.3f} with K of small motions"
    out.append(below(words, abs(moved["time"] / moved["harmonic"] - 1.0), 1e-2, COMMAND, f"{told}; 128 steps a turn"))
    for key, words in (
        ("frequencies", "first three frequencies of forward whirl"),
        ("responses", "unbalance response at bearing and sensor"),
    ):
        text = f"{name}: {words} of study rig's rotor by our beam, largest relative difference"
        out.append(below(text, found["beam"][key], 1e-3, COMMAND, "validation/rotor_in_ross.py"))
    row = found["response"][-1]
    out.append(
        Row(
            f"{name}: amplitude of the disc at {row['speed_rpm']:.0f} r/min with our table, with ROSS's closed formula [µm]",
            f"{1e6 * row['disc']:.1f}, {1e6 * row['disc_formula']:.1f}", "reported", True, COMMAND,
            f"stiffness {1e-6 * row['k']:.1f} against {1e-6 * row['k_formula']:.1f} N/µm (BallBearingElement, static load = axial)",
        )
    )  # fmt: skip
    return out
