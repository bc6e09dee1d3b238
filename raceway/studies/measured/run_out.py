"""The run-out of the measured track: what a slow roll, which bends nothing, shows once a turn."""

from __future__ import annotations

from cmath import exp
from math import radians

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.studies.measured.angle import turning
from raceway.studies.measured.orders import Order, order
from raceway.studies.measured.recording import Recording
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import Rotor


@attrs.frozen
class RunOut:
    """The run-out: a complex amplitude of e^{j angle} from the mark, its standard error [m], and where it is from."""

    vector: complex = 0.0
    error: float = 0.0
    how: str = "none subtracted"


def given(amplitude: float, angle_deg: float) -> RunOut:
    """A run-out that is known: amplitude [m] and angle of its high spot from the mark."""
    return RunOut(amplitude * exp(1j * radians(angle_deg)), 0.0, "given")


def slow_roll(recording: Recording) -> Order:
    """The 1x line of a slow roll.

    Raises
    ------
    RacewayError
        What is wrong with the record; a record without marks has no phase.
    """
    try:
        found = turning(recording)
        if not found.marked:
            raise RacewayError("no `key`: without a mark a vector has no phase and cannot be subtracted")
        return order(found)
    except RacewayError as why:
        raise RacewayError(f"slow roll: {why}") from None


def less_response(found: Order, held: Bearing, line: Rotor, unbalance_angle: float) -> RunOut:
    """The run-out in a slow roll: its 1x line less what the unbalance does at that speed already.

    Parameters
    ----------
    line : the rotor at the slow roll's speed;  unbalance_angle : of the unbalance from the mark [rad]

    Notes
    -----
    The bearing's stiffness at rest is good enough: the response is a thousandth of that at the speed.
    """
    load = np.linalg.solve(held.compliance - line.ring[:, 1:], line.ring[:, 0] * line.unbalance_force)
    response = line.at_sensor(load[0], load[1]) * exp(1j * unbalance_angle)
    rpm = found.speed * 30.0 / np.pi
    error = float(np.hypot(found.error, 0.5 * found.doubt * abs(found.line)))  # the doubt is a bound: two standard errors
    return RunOut(found.line - response, error, f"slow roll at {rpm:.0f} r/min, {found.turns} turns")
