"""Rotor models and ROSS.

Each number is the worst of the versions of ROSS that are there (checks/validation/ross_rotor.py).  The files for Nastran, Ansys and
spreadsheets are read back by the fields of their formats: neither program is there.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

import raceway as rw
from checks.validation.ross_rotor import in_ross
from checks.validation.rotor_files import COMBI214, DIGITS, apdl, by_direction, constants, entries, read_csv, tables

pytestmark = pytest.mark.night

#: K of a rotor's bearing, iterated step by step [N/um].
STEPWISE = {1000.0: 230.2772, 400.0: 107.4227}


def test_table_in_ross(claim):
    found = in_ross("table")
    off = max(max(one["points"]) for one in found)
    quantity = (
        "coefficients in ROSS at the points of our tables, by element, by file, over speed and frequency: largest difference"
    )
    claim(
        quantity,
        off,
        at_most=1e-12,
        basis="closed form",
        source="interpolation goes through its points; ROSS 2 by `element()`",
    )
    off = max(abs(one["critical"]) for one in found)
    quantity = "critical speed in ROSS of a symmetric rigid rotor on our tables: relative difference"
    claim(quantity, off, at_most=1e-3, basis="closed form", source="M w^2 = 2 K(w); the shaft's own bending is 1e-5")


@pytest.mark.parametrize("axial", STEPWISE)
def test_force_of_a_rotor_on_its_bearing(claim, axial):
    steps = [one[-1] for one in in_ross("fixed_point", axial)]
    inside = in_ross("inside", axial)
    assert all(step["change"] <= 1e-9 for step in steps)
    where = f"rig's rotor in ROSS, {axial:g} N axial"
    known, values = 1e6 * STEPWISE[axial], [one["k"] for one in steps + inside]
    worst = max(values, key=lambda k: abs(k - known))
    quantity = f"{where}: K at the rotor's own amplitude, by `raceway.ross` and step by step, furthest from what was found"
    claim(quantity, 1e-6 * worst, near=STEPWISE[axial], within=1e-6, unit="N/um", basis="regression", source="seven digits")


def test_motion_in_time(claim):
    off = max(abs(one["time"] / one["harmonic"] - 1.0) for one in in_ross("in_time"))
    quantity = (
        "amplitude at the bearing after 40 turns in time, 400 N axial: relative difference from the unbalance response"
    )
    claim(quantity, off, at_most=0.01, basis="own other method", source="128 steps a turn, a damper at the disc")


def test_beam(claim):
    found = np.max(in_ross("beam"), axis=0)
    for what, off in zip(
        ("first three frequencies of forward whirl", "unbalance response at bearing and sensor"), found, strict=True
    ):
        claim(
            f"study rig's rotor by our beam: {what}: largest relative difference",
            off,
            at_most=1e-3,
            basis="other program",
            source="ROSS",
        )


SPIN = "kinematics.spin_speed_rpm"
LOADED = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0, "radial": [200.0, 150.0]}, "contact": {"damping": 300.0},
    "supports": {"tilt": "locked", "axial": "displacement"}, "identifier": {"kind": "tangent"},
}  # fmt: skip


def apart(found, expected, size=None) -> float:
    return float(np.max(np.abs(np.asarray(found) - expected)) / (size or np.max(np.abs(expected))))


def nastran(data, speed, K, C):
    found = entries(rw.export_coefficients(data, kind="nastran").text)
    there = tables(found)
    (numbers,) = [by_direction(fields) for name, fields in found if name == "PBUSHT"]
    for letter, matrix in (("K", K), ("B", C)):
        for direction, i in ((0, 0), (1, 1), (2, 2), (4, 3), (5, 4)):
            hertz, values = there[int(numbers[letter][direction])]
            yield apart(2.0 * np.pi * hertz, speed)
            yield apart(values, matrix[:, i, i])


def ansys(data, speed, K, C):
    found, commands = apdl(rw.export_coefficients(data, kind="ansys").text)
    places = list(COMBI214.values())
    for k, name in enumerate(constants(commands)):
        i, j = places[k % 4]
        matrix = (K, C)[k // 4][:, 1:3, 1:3]
        yield apart(found[name][0], speed)
        yield apart(found[name][1], matrix[:, i, j], np.max(np.abs(matrix)))


def csv_and_json(data, speed, K, C):
    columns = read_csv(rw.export_coefficients(data, kind="csv").text)
    first = list(columns).index("K x x [N/m]")
    both = np.stack([columns[name] for name in list(columns)[first : first + 50]], axis=-1).reshape(-1, 2, 5, 5)
    content = json.loads(rw.export_coefficients(data, kind="json").text)
    own = [content[key]["values"] for key in ("speed", "K", "C")]
    for found in ([columns["speed [rad/s]"], both[:, 0], both[:, 1]], own):
        yield from map(apart, found, (speed, K, C))


def test_files(claim):
    data = rw.sweep(LOADED, {SPIN: "0:20000:5"})
    known = data[SPIN].values * (np.pi / 30.0), data["stiffness"].values, data["damping"].values
    for name, limit, source, found in (
        ("Nastran: frequency, K and C on the diagonal", DIGITS, "digits of its fields", nastran(data, *known)),
        ("Ansys: speed, the 2x2 matrices K and C across the axis", 1e-14, "15 significant digits", ansys(data, *known)),
        ("CSV and JSON: speed, K and C, 5x5", 0.0, "all digits of a number", csv_and_json(data, *known)),
    ):
        quantity = f"file for {name}, read back: largest difference over the largest entry of its kind"
        claim(
            quantity, max(found), at_most=limit, basis="closed form", source=f"{source}; a sweep of a loaded, damped B7206C"
        )


def test_damping_at_rest(claim):
    """C of the equilibrium knows nothing of time, that of a small motion nothing of the matrix."""
    excitation = {"kind": "bidirectional", "amplitude": "constant", "force": 1.0, "speed_rpm": 600.0}
    moving = {"load": {"axial": 1000.0}, "rotor": {"mass": 2.0}, "integrator": {"kind": "periodic"}, "identifier": {}}
    result = rw.run({**LOADED, **moving, "kinematics": {"spin_speed_rpm": 20000.0}, "excitation": excitation})
    off = abs(result.equilibrium.damping[1, 1] / result.identification.equivalent_damping - 1.0)
    quantity = "C of the equilibrium at 20 000 r/min against that of a motion of 1 N at 10 Hz: relative difference"
    claim(quantity, off, at_most=1e-5, basis="own other method", source="an error of second order in the frequency")
