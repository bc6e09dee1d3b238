"""Rotor models and ROSS.

Each number is the worst of the versions of ROSS that are there (checks/validation/ross_rotor.py).  The files for Nastran, Ansys and
spreadsheets are read back by the fields of their formats: neither program is there.
"""

import pytest

from checks.validation.ross_rotor import in_ross

pytestmark = pytest.mark.night

#: K of a rotor's bearing, iterated step by step [N/um].
STEPWISE = {1000.0: 230.2772, 400.0: 107.4227}


def test_table_in_ross(claim):
    found = in_ross("table")
    off = max(max(one["points"]) for one in found)
    quantity = (
        "coefficients in ROSS at the points of our tables, by element, by file, over speed and frequency: largest difference"
    )
    source = "interpolation goes through its points; ROSS 2 by `element()`"
    claim(quantity, off, at_most=1e-12, basis="closed form", source=source)
    off = max(abs(one["critical"]) for one in found)
    quantity = "critical speed in ROSS of a symmetric rigid rotor on our tables: relative difference"
    claim(quantity, off, at_most=1e-3, basis="closed form", source="M w^2 = 2 K(w); the shaft's own bending is 1e-5")


@pytest.mark.parametrize("axial", STEPWISE)
def test_force_of_a_rotor_on_its_bearing(claim, axial):
    known = 1e6 * STEPWISE[axial]
    worst = max(in_ross("inside", axial), key=lambda k: abs(k - known))
    quantity = f"rig's rotor in ROSS, {axial:g} N axial: K at the rotor's own amplitude, by `raceway.ross`"
    source = "force, stiffness and response iterated step by step, seven digits"
    claim(quantity, 1e-6 * worst, near=STEPWISE[axial], within=1e-6, unit="N/um", basis="regression", source=source)


def test_motion_in_time(claim):
    off = max(abs(one["time"] / one["harmonic"] - 1.0) for one in in_ross("in_time"))
    quantity = (
        "amplitude at the bearing after 40 turns in time, 400 N axial: relative difference from the unbalance response"
    )
    claim(quantity, off, at_most=0.01, basis="own other method", source="128 steps a turn, a damper at the disc")
