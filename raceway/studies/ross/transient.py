"""Time response in ROSS with the nonlinear forces of its rolling bearings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from raceway.errors import RacewayError
from raceway.studies.ross.bearing import RollingBearing
from raceway.studies.ross.installed import ross


def run_time_response(rotor: Any, speed: float, F: np.ndarray, t: np.ndarray, **options: Any) -> Any:
    """ROSS's time response by Newmark's method, each ``RollingBearing`` with its nonlinear force.

    Parameters
    ----------
    rotor : ross.Rotor with one or more ``RollingBearing``
    speed : constant [rad/s]
    F : (m, ndof) forces [N];  t : (m,) [s]
    options : of ``rotor.run_time_response``: ``newmark_type="robust"`` (ROSS 3) iterates within a step, ``add_to_RHS`` adds a
        force of your own

    Returns
    -------
    ross.TimeResponseResults

    Raises
    ------
    RacewayError
        A rotor without such a bearing, a speed that changes, an option that the ROSS that is installed lacks.
    ConvergenceError
        A displacement that no bearing survives.

    Notes
    -----
    The rotor's matrices hold K of small motions at this speed; added to the right-hand side is K q - f(q), by the number
    of a step.  ROSS hands over the state of the step before; the force is taken where that state leads to in a step,
    q + v dt + a dt^2 / 2, which leaves an error of third order in dt.
    """
    bearings = [one for one in rotor.bearing_elements if isinstance(one, RollingBearing)]
    if not bearings:
        raise RacewayError("the rotor stands on no raceway.ross.RollingBearing: take rotor.run_time_response")
    if np.ndim(speed):
        raise RacewayError(
            "`speed`: nonlinear bearing forces are of one speed; for a run-up take rotor.run_time_response, whose bearings "
            "have the stiffness of small motions at each speed"
        )
    robust = options.get("newmark_type", "simple") == "robust"
    if robust:
        ross("run_time_response(newmark_type='robust')", least=3)
    if "model_reduction" in options:
        raise RacewayError("`model_reduction`: the bearings' forces need all degrees of freedom; leave it out")
    mine, other = nonlinear_force(bearings, rotor.ndof, float(speed), predicted=not robust), options.pop("add_to_RHS", None)
    force = mine if other is None else (lambda step, **state: mine(step, **state) + other(step, **state))
    return rotor.run_time_response(float(speed), F, t, method="newmark", add_to_RHS=force, **options)


def nonlinear_force(
    bearings: list[RollingBearing], size: int, speed: float, predicted: bool = True
) -> Callable[..., np.ndarray]:
    """K q - f(q) (size,) of bearings as ROSS's ``add_to_RHS``.

    Parameters
    ----------
    predicted : whether the state handed over is that of the step before
    """
    parts = [(one, one.dofs, one.frame, one.node_bearing.dynamic_stiffness(speed, speed).real) for one in bearings]

    def added(step: int, **state: Any) -> np.ndarray:
        moved = np.array(state["disp_resp"], dtype=float)
        if predicted:
            dt = float(state["time_step"])
            moved = moved + dt * state["velc_resp"] + 0.5 * dt**2 * state["accl_resp"]
        out = np.zeros(size)
        for one, dofs, frame, stiffness in parts:
            q = frame @ moved[dofs]
            out[dofs] += frame.T @ (stiffness @ q - one.node_bearing.force(speed, q))
        return out

    return added
