"""The B7206C against the table and the trends that an independent rigid-ring solver gave."""

from __future__ import annotations

import numpy as np

from benchmarks.evidence import Row, near
from raceway.studies.article.expected import SPEEDS, TRENDS
from validation.expected_values import TABLE, axial_row, secant

TITLE = "B7206C against the values expected of an independent solver"
COMMAND = "python -m benchmarks.evidence expected_values"
_NAMES = (
    "axial displacement [um]",
    "contact angle [deg]",
    "ball load [N]",
    "peak pressure, inner [MPa]",
    "peak pressure, outer [MPa]",
    "axial stiffness [N/um]",
    "radial stiffness, tilt locked [N/um]",
    "radial stiffness, tilt free [N/um]",
)


def rows() -> list[Row]:
    found = []
    for axial, expected in TABLE.items():
        for name, value, wanted in zip(_NAMES, axial_row(axial), expected, strict=True):
            found.append(near(f"{axial:.0f} N axial: {name}", value, wanted, 0.005, COMMAND))
    for (tilt, axial, inertia), (first, ratios) in TRENDS.items():
        curve = np.array([secant(axial, tilt, speed, inertia) for speed in SPEEDS])
        balls = "with" if inertia else "without"
        where = f"tilt {tilt}, {axial:.0f} N, {balls} centrifugal force"
        found.append(near(f"{where}: k at 10 980 r/min [N/um]", curve[0] / 1e6, first, 0.005, COMMAND))
        ok = np.abs(curve[1:] / curve[0] - ratios).max() <= 0.002
        text = " ".join(f"{ratio:.4f}" for ratio in curve[1:] / curve[0])
        limit = " ".join(f"{ratio:.3f}" for ratio in ratios) + " within 0.002"
        found.append(Row(f"{where}: k / k(10 980) at 12 000 to 15 000 r/min", text, limit, ok, COMMAND))
    return found
