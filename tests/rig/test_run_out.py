"""The run-out from a slow roll: what the unbalance does at that speed already is no run-out."""

from __future__ import annotations

from cmath import exp
from math import pi

import numpy as np
import pytest

from raceway.studies.measured.orders import Order
from raceway.studies.measured.run_out import less_response
from raceway.studies.shaft.rotor import rotor

#: Of the unbalance from the mark [rad].
ANGLE = 0.6


def rolled(line: complex, speed: float) -> Order:
    return Order(line, 0.0, 0.0, speed, speed, speed, line, 0.0, 0.0, 40, 16, True)


@pytest.mark.parametrize("rpm", [600.0, 3000.0])
@pytest.mark.parametrize("true", [0.0, 5e-6 * exp(1.1j)])
def test_the_response_is_taken_out(rig, held, rpm, true):
    """The response from the whole rotor on the bearings' springs: load and deflection in one system, not by compliances."""
    line = rotor(rig, rpm * pi / 30.0)
    # Unknowns: deflection and slope of the ring, force and moment on the bearing.
    stiffness = np.linalg.inv(held.compliance)
    system = np.block([[np.eye(2), -line.ring[:, 1:].astype(complex)], [stiffness, -np.eye(2)]])
    load = np.concatenate([line.ring[:, 0] * line.unbalance_force, np.zeros(2)])
    force, moment = np.linalg.solve(system, load)[2:]
    response = line.at_sensor(force, moment) * exp(1j * ANGLE)
    assert abs(response) > 1e-9  # there is something to take out
    found = less_response(rolled(true + response, line.speed), held, line, ANGLE)
    assert found.vector == pytest.approx(true, abs=1e-6 * abs(response))
