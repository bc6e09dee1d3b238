"""Exported coefficients of a loaded, damped B7206C, read back by their formats' fields alone, for the report ``ross``."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from validation.rotor_files import COMBI214, DIGITS, apdl, by_direction, constants, entries, read_csv, tables

COMMAND = "pytest tests/test_rotor_files.py"
SPIN = "kinematics.spin_speed_rpm"
#: 15 significant digits are written.
_ROUNDED = 1e-14
#: C of a motion at 10 Hz against that of slow motions: an error of second order in the frequency.
_SLOW = 1e-5
_RADIANS = np.pi / 30.0
_SCENE = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0, "radial": [200.0, 150.0]}, "contact": {"damping": 300.0},
    "supports": {"tilt": "locked", "axial": "displacement"}, "identifier": {"kind": "tangent"},
}  # fmt: skip


def rows() -> list[Row]:
    data = rw.sweep(_SCENE, {SPIN: "0:20000:5"})
    K, C = data["stiffness"].values, data["damping"].values
    speed = data[SPIN].values * _RADIANS
    out = []
    for name, limit, found in (
        ("Nastran: frequency, kxx, kyy, kzz, the tilts' diagonal, and C of them", DIGITS, _nastran(data, speed, K, C)),
        ("Ansys: speed, the 2x2 matrices K and C across the axis", _ROUNDED, _ansys(data, speed, K, C)),
        ("CSV and JSON: speed, K and C, 5x5", 0.0, max(_csv(data, speed, K, C), _json(data, speed, K, C))),
    ):
        words = f"file for {name}, read back, against the sweep, largest difference over the largest entry of its kind"
        out.append(
            below(words, found, limit, COMMAND, "B7206C, 1 kN axial, 250 N across, 300 N s/m each contact, 0 to 20000 r/min")
        )
    return [*out, _damping()]


def _apart(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.max(np.abs(found - expected)) / np.max(np.abs(expected)))


def _nastran(data: Any, speed: np.ndarray, K: np.ndarray, C: np.ndarray) -> float:
    found = entries(rw.export_coefficients(data, kind="nastran").text)
    there = tables(found)
    (numbers,) = [by_direction(fields) for name, fields in found if name == "PBUSHT"]
    worst = 0.0
    for letter, matrix in (("K", K), ("B", C)):
        for direction, i in ((0, 0), (1, 1), (2, 2), (4, 3), (5, 4)):
            hertz, values = there[int(numbers[letter][direction])]
            worst = max(worst, _apart(2.0 * np.pi * hertz, speed), _apart(values, matrix[:, i, i]))
    return worst


def _ansys(data: Any, speed: np.ndarray, K: np.ndarray, C: np.ndarray) -> float:
    found, commands = apdl(rw.export_coefficients(data, kind="ansys").text)
    worst, places = 0.0, list(COMBI214.values())
    for k, name in enumerate(constants(commands)):
        i, j = places[k % 4]
        matrix = (K, C)[k // 4][:, 1:3, 1:3]
        size = np.max(np.abs(matrix))
        worst = max(worst, _apart(found[name][0], speed), float(np.max(np.abs(found[name][1] - matrix[:, i, j]))) / size)
    return worst


def _csv(data: Any, speed: np.ndarray, K: np.ndarray, C: np.ndarray) -> float:
    columns = read_csv(rw.export_coefficients(data, kind="csv").text)
    names = list(columns)
    first = names.index("K x x [N/m]")
    both = np.stack([columns[name] for name in names[first : first + 50]], axis=-1).reshape(-1, 2, 5, 5)
    return max(_apart(columns["speed [rad/s]"], speed), _apart(both[:, 0], K), _apart(both[:, 1], C))


def _json(data: Any, speed: np.ndarray, K: np.ndarray, C: np.ndarray) -> float:
    content = json.loads(rw.export_coefficients(data, kind="json").text)
    parts = [(content[key]["values"], expected) for key, expected in (("speed", speed), ("K", K), ("C", C))]
    return max(_apart(np.array(values), expected) for values, expected in parts)


def _damping() -> Row:
    """C of the equilibrium against that of a small motion in time, which knows nothing of the matrix."""
    given = {
        **_SCENE, "load": {"axial": 1000.0}, "rotor": {"mass": 2.0}, "integrator": {"kind": "periodic"}, "identifier": {},
        "kinematics": {"spin_speed_rpm": 20000.0},
        "excitation": {"kind": "bidirectional", "amplitude": "constant", "force": 1.0, "speed_rpm": 600.0},
    }  # fmt: skip
    result = rw.run(given)
    assert result.identification is not None
    apart = result.equilibrium.damping[1, 1] / result.identification.equivalent_damping - 1.0
    words = "C of the equilibrium at 20 000 r/min against that of a small motion in time (1 N at 10 Hz), relative difference"
    return below(words, abs(float(apart)), _SLOW, COMMAND)
