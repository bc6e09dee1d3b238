"""The fixed point at which the shaft and the bearing, stiffer or softer with its force, agree."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.errors import ConvergenceError
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import Rotor

#: Agreement of shaft and bearing, over the bearing's motion: a hundredth of what is asked of the identification, squared.
TOLERANCE = 1e-7
_MOST, _HALVINGS = 40, 4


@attrs.frozen
class State:
    """State of the tested bearing in the rig.

    Attributes
    ----------
    speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]
    deflection, slope : of the inner ring [m, rad];  sensor : deflection there [m]
    mass : of the inner ring [kg];  coupling : force by tilt at rest, of the bearing [N/rad]
    runs : of the bearing, that it took

    Notes
    -----
    Complex amplitudes in forward whirl; the unbalance force is real.  The shaft bends the bearing, too: what it carries for
    its tilt, ``coupling`` times the slope, taken off the force leaves the stiffness against deflection alone.
    """

    speed: float
    force: complex
    moment: complex
    deflection: complex
    slope: complex
    sensor: complex
    mass: float
    coupling: float
    runs: int

    @property
    def dynamic_stiffness(self) -> complex:
        """Z = F / x [N/m]: the shaft's force on the inner ring over its deflection."""
        return self.force / self.deflection

    @property
    def stiffness(self) -> float:
        """K = Re Z + m w^2 [N/m]."""
        return self.dynamic_stiffness.real + self.mass * self.speed**2

    @property
    def damping(self) -> float:
        """C = Im Z / w [N s/m]."""
        return self.dynamic_stiffness.imag / self.speed

    @property
    def locked(self) -> tuple[float, float]:
        """K [N/m] and C [N s/m] without the part that the slope brings: as with the tilt locked."""
        z = (self.force - self.coupling * self.slope) / self.deflection
        return z.real + self.mass * self.speed**2, z.imag / self.speed


def balance(line: Rotor, held: Bearing) -> State:
    """Force and moment at which the ring and the shaft in it move alike.

    Raises
    ------
    ConvergenceError
        No such force and moment found.
    """
    speed = line.speed
    gain = held.compliance - line.ring[:, 1:]
    start = np.linalg.solve(gain, line.ring[:, 0] * line.unbalance_force)

    def apart(load: np.ndarray) -> np.ndarray:
        return held.answer(speed, load[0], load[1]) - line.at_ring(load[0], load[1])

    size = np.abs(held.compliance @ start)
    load, runs = find_root(apart, start.astype(complex), gain, size)
    deflection, slope = line.at_ring(*load)
    return State(speed, load[0], load[1], deflection, slope, line.at_sensor(*load), held.mass, held.coupling, runs)


def find_root(
    apart: Callable[[np.ndarray], np.ndarray], start: np.ndarray, slope: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, int]:
    """A complex root (n,) of a function by Broyden's method, and the number of evaluations.

    Parameters
    ----------
    slope : (n, n) first guess of the derivative;  size : (n,) of the function's values, for the tolerance

    Notes
    -----
    Real and imaginary parts are unknowns of their own: a stiffness that depends on the amplitude is not analytic.

    References
    ----------
    Broyden, Math. Comp. 19 (1965) 577.
    """
    n = len(start)
    jacobian = np.block([[slope.real, -slope.imag], [slope.imag, slope.real]])
    scale = np.concatenate([size, size])

    def value(u: np.ndarray) -> np.ndarray:
        found = apart(u[:n] + 1j * u[n:])
        return np.concatenate([found.real, found.imag]) / scale

    jacobian = jacobian / scale[:, None]
    u = np.concatenate([start.real, start.imag])
    f = value(u)
    for count in range(1, _MOST):
        worst = float(np.abs(f).max())
        if worst < TOLERANCE:
            return u[:n] + 1j * u[n:], count
        try:
            step = -np.linalg.solve(jacobian, f)
        except np.linalg.LinAlgError:
            raise ConvergenceError(f"shaft and bearing find no common motion: they differ by {worst:.1e}") from None
        for half in range(_HALVINGS + 1):
            try:
                tried = value(u + step)
            except ConvergenceError:  # a load that the bearing cannot carry: nearer ones are tried
                if half == _HALVINGS:
                    raise
            else:
                if half == _HALVINGS or np.abs(tried).max() <= 2.0 * worst:
                    break
            step = 0.5 * step
        jacobian += np.outer(tried - f - jacobian @ step, step) / (step @ step)
        u, f = u + step, tried
    raise ConvergenceError(
        f"shaft and bearing find no common motion after {_MOST} tries: they differ by {np.abs(f).max():.1e}"
    )
