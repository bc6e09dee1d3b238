"""Time response in ROSS with the nonlinear forces of its rolling bearings."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from raceway.errors import ConvergenceError, RacewayError
from raceway.studies.ross.bearing import RollingBearing

#: Options of ROSS's Newmark method that are handed on, with its own defaults.
_OPTIONS: dict[str, Any] = {"gamma": 0.5, "beta": 0.25, "tol": None, "progress_interval": None}
_MOST, _TOLERANCE, _SMALL = 40, 1e-10, 1e-15


def run_time_response(rotor: Any, speed: float, F: np.ndarray, t: np.ndarray, **options: Any) -> Any:
    """ROSS's time response by Newmark's method, each ``RollingBearing`` with its nonlinear force.

    Parameters
    ----------
    rotor : ross.Rotor with one or more ``RollingBearing``
    speed : constant [rad/s]
    F : (m, ndof) forces [N];  t : (m,) [s]
    options : gamma, beta, tol, progress_interval of ROSS's Newmark method

    Returns
    -------
    ross.TimeResponseResults

    Raises
    ------
    RacewayError
        A rotor without such a bearing, a speed that changes, forces of another shape, another option.
    ConvergenceError
        A displacement at which a bearing finds no equilibrium: a load that it cannot carry, or steps that are too long.

    Notes
    -----
    The rotor's matrices hold K of small motions at this speed; the right-hand side gets K q - f(q) of each bearing.  ROSS asks
    for it at the state of the step before.  It is taken at the end of the step: the displacements q there follow linearly from
    these forces by the step's own matrix M + gamma dt C + beta dt^2 K, and Newton's method finds where both agree.  So a step
    is the implicit one of Newmark's method, of second order in dt.
    """
    bearings = [one for one in rotor.bearing_elements if isinstance(one, RollingBearing)]
    if not bearings:
        raise RacewayError("the rotor stands on no raceway.ross.RollingBearing: take rotor.run_time_response")
    if np.ndim(speed):
        raise RacewayError(
            "`speed`: nonlinear bearing forces are of one speed; for a run-up take rotor.run_time_response, whose bearings "
            "have the stiffness of small motions at each speed"
        )
    unknown = sorted(set(options) - set(_OPTIONS))
    if unknown:
        raise RacewayError(f"`{unknown[0]}` is no option here, beside nonlinear bearings: {', '.join(_OPTIONS)} are")
    forces, times = np.asarray(F, dtype=float), np.asarray(t, dtype=float)
    if forces.shape != (len(times), rotor.ndof):
        raise RacewayError(
            f"`F` has the shape {forces.shape}; one row a time and one column a degree of freedom make {(len(times), rotor.ndof)}"
        )
    newmark = {name: options.get(name, value) for name, value in _OPTIONS.items()}
    added = _Added(rotor, bearings, float(speed), forces, newmark["gamma"], newmark["beta"])
    return rotor.run_time_response(float(speed), forces, times, method="newmark", add_to_RHS=added, **options)


class _Added:
    """K q - f(q) (ndof,) at the end of a step, as ROSS's ``add_to_RHS``."""

    def __init__(
        self, rotor: Any, bearings: list[RollingBearing], speed: float, forces: np.ndarray, gamma: float, beta: float
    ) -> None:
        self.bearings, self.speed, self.forces, self.gamma, self.beta = bearings, speed, forces, gamma, beta
        self.mass, self.stiffness = rotor.M(), rotor.K(speed)
        self.damping = rotor.C(speed) + speed * rotor.G()
        ends = np.cumsum([0, *(one.node_bearing.size for one in bearings)])
        self.parts = [slice(int(a), int(b)) for a, b in zip(ends, ends[1:], strict=False)]
        self.places = np.zeros((int(ends[-1]), rotor.ndof))
        self.small = np.zeros((int(ends[-1]),) * 2)
        for part, one in zip(self.parts, bearings, strict=True):
            self.places[part, one.dofs] = one.frame
            self.small[part, part] = one.node_bearing.dynamic_stiffness(speed, speed).real
        self.dt, self.factors, self.receptance = 0.0, None, self.small

    def __call__(self, step: int, **state: Any) -> np.ndarray:
        """By the number of the step; ``state``: time_step [s], disp_resp, velc_resp, accl_resp (ndof,) before it."""
        dt, gamma, beta = float(state["time_step"]), self.gamma, self.beta
        if dt != self.dt:
            self.dt, self.factors = dt, lu_factor(self.mass + gamma * dt * self.damping + beta * dt**2 * self.stiffness)
            self.receptance = beta * dt**2 * self.places @ lu_solve(self.factors, self.places.T)
        y, v, a = (np.asarray(state[f"{name}_resp"], dtype=float) for name in ("disp", "velc", "accl"))
        y, v = y + dt * v + (0.5 - beta) * dt**2 * a, v + (1.0 - gamma) * dt * a
        rest = self.forces[step] - self.stiffness @ y - self.damping @ v
        linear = self.places @ (y + beta * dt**2 * lu_solve(self.factors, rest))
        return np.asarray(self.places.T @ self._agreed(linear))

    def _agreed(self, linear: np.ndarray) -> np.ndarray:
        """K q - f(q) with q = q_linear + H (K q - f(q))."""
        q = linear.copy()
        slope = np.zeros_like(self.small)
        for _ in range(_MOST):
            extra = self.small @ q
            for part, one in zip(self.parts, self.bearings, strict=True):
                force, tangent = one.node_bearing.resistance(self.speed, q[part])
                extra[part] -= force
                slope[part, part] = self.small[part, part] - tangent
            change = np.linalg.solve(np.eye(len(q)) - self.receptance @ slope, linear + self.receptance @ extra - q)
            q = q + change
            if np.abs(change).max() <= _TOLERANCE * np.abs(q).max() + _SMALL:
                return extra + slope @ change
        raise ConvergenceError("the bearings' forces and the rotor's step find no common displacement: take shorter steps")
