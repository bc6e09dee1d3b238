"""One name a meaning: kyy and kyy_tilts_follow, the largest load and pressure, told alike by screen, JSON, band, sensitivities, sweep and fit."""

from __future__ import annotations

import contextlib
import io
import json
import re
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below, near
from raceway.cli import main

#: Tilt free, loads in two directions, balls with centrifugal force: no two of the numbers below are equal.
TOML = """
[bearing]
preset = "B7206C"
[load]
axial = 400.0
radial = [60.0, 0.0]
[supports]
tilt = "free"
[kinematics]
spin_speed_rpm = 12000.0
[tolerances]
load.axial = "±1 %"
"""
SCENE: dict[str, Any] = tomllib.loads(TOML)
FAST = {
    "title": "fast",
    "bearing": {"preset": "B7206C"},
    "load": {"axial": 100.0},
    "kinematics": {"spin_speed_rpm": 30000.0},
}
#: By name: unit as a head of a fit has it, and what the screen shows of it.
HEADS = {
    "kyy": ("N/µm", r"tangent kyy +([\d.]+) N/µm"),
    "kyy_tilts_follow": ("N/µm", r"kyy tilts follow +([\d.]+) N/µm"),
    "x": ("µm", r"displacement x +([-\d.]+) µm"),
    "largest_ball_load": ("N", r"most loaded ball +([\d.]+) N"),
}
SI = {"N/µm": 1e6, "µm": 1e-6, "N": 1.0}
#: The screen has five digits.
DIGITS = 5e-5
COMMAND = "raceway run SCENE.toml --set supports.tilt=free"


def rows() -> list[Row]:
    """The rows of this subject."""
    with tempfile.TemporaryDirectory() as folder:
        return _everywhere(Path(folder)) + _largest()


def _meant(result: rw.Result) -> dict[str, float]:
    """The numbers from the 5x5 matrix, displacement and contact forces: kyy_tilts_follow by a compliance, not by the program's formula."""
    k, radial = result.stiffness, np.ix_([1, 3, 4], [1, 3, 4])
    follow = 1.0 / np.linalg.inv(k[radial])[0, 0]
    return {
        "kyy": k[1, 1],
        "kyy_tilts_follow": follow,
        "x": result.displacement[0],
        "largest_ball_load": result.equilibrium.contact_force.max(),
    }


def _screen(folder: Path) -> tuple[str, dict[str, Any]]:
    """What ``raceway run`` prints and writes."""
    file = folder / "scene.toml"
    file.write_text(TOML, encoding="utf-8")
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.suppress(SystemExit):
        main(["run", str(file), "--out", str(folder)])
    return text.getvalue(), json.loads((folder / "result.json").read_text())


def _everywhere(folder: Path) -> list[Row]:
    text, content = _screen(folder)
    expected, still = _meant(rw.run(SCENE)), content["equilibrium"]
    swept = rw.sweep(SCENE, {"load.axial": [400.0]})
    told = {
        "result.json": (still["stiffness"][1][1], still["kyy_tilts_follow_n_per_m"], still["displacement"]["x"], still["largest_ball_load_n"]),
        "table [tolerances]": tuple(content["tolerances"]["quantities"][name]["value"] for name in HEADS),
        "band": tuple(rw.band(SCENE, count=2).nominal[name] for name in HEADS),
        "sensitivities": tuple(rw.sensitivities(SCENE, ["load.axial"]).values[name] for name in HEADS),
        "sweep": tuple(map(float, (swept.stiffness[0, 1, 1], swept.kyy_tilts_follow[0], swept.axial_displacement[0], swept.peak_ball_load[0]))),
    }  # fmt: skip
    printed = {name: SI[unit] * float(re.search(pattern, text)[1]) for name, (unit, pattern) in HEADS.items()}  # type: ignore[index]
    what = (
        "kyy, kyy_tilts_follow, x, largest ball load against the 5x5 matrix and contact forces, largest relative difference"
    )
    found = [below(f"{where}: {what}", _apart(values, expected), 1e-6, COMMAND) for where, values in told.items()]
    found.append(below("screen of run: the same, five digits", _apart(tuple(printed.values()), expected), DIGITS, COMMAND))
    return [*found, *_fits(expected, printed)]


def _apart(values: tuple[float, ...], expected: dict[str, float]) -> float:
    return max(abs(value / expected[name] - 1.0) for name, value in zip(HEADS, values, strict=True))


def _fits(expected: dict[str, float], printed: dict[str, float]) -> list[Row]:
    """The contact angle of the scene, 15 deg, from each number alone, the search begun at 16 deg."""
    start = {**SCENE, "bearing": {"preset": "B7206C", "contact_angle_deg": 16.0}}
    key, found = "bearing.contact_angle_deg", []
    for name, (unit, _) in HEADS.items():
        head = f"{name.replace('_', ' ')} [{unit}]"
        exact, rounded = (rw.fit({head: [values[name] / SI[unit]]}, start, [key])[key] for values in (expected, printed))
        command = f'raceway fit DATA.csv --scene SCENE.toml --free {key}, head "{head}"'
        found.append(near(f"fit of {name} of result.json: contact angle, deg", exact, 15.0, 1e-6, command))
        # The numbers hang on the angle with a power of order 1, so that it is off by a few times their digits.
        found.append(near(f"fit of {name} as printed: contact angle, deg", rounded, 15.0, 1e-3, command))
    return found


def _largest() -> list[Row]:
    fast = rw.run(FAST)
    table, what = fast.to_dict()["equilibrium"], "100 N, 30 000 r/min"
    loads = fast.equilibrium.contact_force.reshape(2, -1).max(axis=1)
    # Hertz's p0 of the largest load of each race, from the ellipse itself.
    peaks = [float(one.peak_pressure(load)) for one, load in zip((fast.model.inner, fast.model.outer), loads, strict=True)]
    told = sum(table[f"largest_{one}_race"] == "outer" for one in ("ball_load", "pressure"))
    swept = rw.sweep(FAST, {"load.axial": [100.0]})
    values = rw.sensitivities(FAST, ["load.axial"]).values
    command = "raceway run SCENE.toml --set load.axial=100 --set kinematics.spin_speed_rpm=30000"
    return [
        near(f"{what}: {name}", value, expected, relative, command)
        for name, value, expected, relative in (
            (f"largest ball load, N (inner race {loads[0]:.1f})", table["largest_ball_load_n"], 147.6, 1e-3),
            (f"largest pressure, MPa (inner race {1e-6 * peaks[0]:.0f})", 1e-6 * table["largest_pressure_pa"], 1030.0, 1e-3),
            ("largest pressure against Hertz's of both races, Pa", table["largest_pressure_pa"], max(peaks), 1e-12),
            ("load and pressure whose race is told as the outer one, of 2", told, 2.0, 0.0),
            ("sweep's peak_ball_load against all contact forces, N", float(swept.peak_ball_load[0]), loads.max(), 1e-12),
            ("sweep's p0, Pa", float(swept.p0[0]), max(peaks), 1e-12),
            ("largest_ball_load of sensitivities, fit and band, N", values["largest_ball_load"], loads.max(), 1e-12),
        )
    ]
