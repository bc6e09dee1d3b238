"""Responses in ROSS with the stiffness, or the nonlinear force, of its rolling bearings at the motion that the rotor makes there."""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np
from scipy.linalg import lu_factor, lu_solve

from raceway import ConvergenceError, RacewayError
from raceway_rotor.bearing import RollingBearing
from raceway_rotor.node_bearing import NodeBearing
from raceway_rotor.shaft import find_root

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from pint import Quantity
    from ross import Rotor
    from ross.results import ForcedResponseResults, TimeResponseResults

_HALVINGS = 6
#: Options of ROSS's Newmark method that are handed on, beside gamma and beta.
_OPTIONS = "tol", "progress_interval"
_MOST, _TOLERANCE, _SMALL = 40, 1e-10, 1e-15


@attrs.frozen(eq=False)
class UnbalanceResponse:
    """Response of a rotor to unbalance, consistent with the amplitude at its bearings.

    Attributes
    ----------
    rotor : whose bearings have the K and C below at these speeds, and those of small motions at others
    response : its ForcedResponseResults of ROSS, with all its plots
    speed : (m,) [rad/s]
    stiffness, damping : tag of a bearing -> (m, n, n) over ROSS's x, y, z (alpha, beta) at each speed [N/m, N s/m]
    force : tag -> (m, n) complex amplitudes of the shaft's load on the ring along them [N, N m]
    runs : (m,) evaluations of the bearings
    """

    rotor: Rotor
    response: ForcedResponseResults
    speed: np.ndarray
    stiffness: dict[str, np.ndarray]
    damping: dict[str, np.ndarray]
    force: dict[str, np.ndarray]
    runs: np.ndarray


def run_unbalance_response(
    rotor: Rotor,
    node: ArrayLike,
    unbalance_magnitude: ArrayLike | Quantity,
    unbalance_phase: ArrayLike | Quantity,
    frequency: ArrayLike | Quantity,
) -> UnbalanceResponse:
    """ROSS's unbalance response, each ``RollingBearing`` with its stiffness at the rotor's own motion.

    Parameters
    ----------
    rotor : ross.Rotor with one or more ``RollingBearing``
    node, unbalance_magnitude, unbalance_phase : int or list, [kg m], [rad], as ROSS takes them
    frequency : (m,) speeds [rad/s], greater than 0

    Raises
    ------
    RacewayError
        A rotor without such a bearing, speeds that are none, an unbalance of zero.
    ConvergenceError
        No common motion of rotor and bearings, or a load that a bearing cannot carry; names the speed.

    Notes
    -----
    Loads f of the shaft on the rings are sought such that the rings' motion u(f), the synchronous (1x) component of a series of
    equilibria, is the rotor's: u(f) = u_0 - H f with the response u_0 and the receptance H of the rotor without these
    bearings.  The search (Broyden) begins at small motions, at each speed anew, so that speeds do not depend on each other; of
    several motions at one speed it finds the one nearest to these.  At the end K is the smallest symmetric
    change of the tangent that carries this motion, C that of small motions.
    """
    bearings = _rolling_bearings(rotor, "run_unbalance_response")
    speeds = np.atleast_1d(np.asarray(getattr(frequency, "m_as", lambda _: frequency)("rad/s"), dtype=float))
    if speeds.ndim != 1 or not np.all(np.isfinite(speeds)) or not np.all(speeds > 0.0):
        raise RacewayError("`frequency`: speeds must be finite and greater than 0 rad/s")
    balances = [_Balance.at(rotor, bearings, w, (node, unbalance_magnitude, unbalance_phase)).solved() for w in speeds]
    z = [np.array([matrices[k] for _, matrices, _ in balances]) for k in range(len(bearings))]
    at_motion = {id(b): b.holding(dict(zip(speeds, z_k, strict=True))) for b, z_k in zip(bearings, z, strict=True)}
    # A copy on other bearings, without the results that ROSS caches
    elements = [at_motion.get(id(element), element) for element in rotor.bearing_elements]
    twin = copy(rotor)
    for name in [name for name in vars(twin) if name.startswith("__wire|")]:  # of the package methodtools
        delattr(twin, name)
    twin.bearing_elements = elements
    response = twin.run_unbalance_response(node, unbalance_magnitude, unbalance_phase, list(speeds))
    stiffness, damping, force = {}, {}, {}
    for k, bearing in enumerate(bearings):
        dynamic = np.array([bearing.across(matrix) for matrix in z[k]])
        stiffness[bearing.tag], damping[bearing.tag] = dynamic.real, dynamic.imag / speeds[:, None, None]
        across = bearing.frame[bearing.node_bearing.moving].T
        force[bearing.tag] = np.array([across @ loads[k] for loads, _, _ in balances])
    return UnbalanceResponse(twin, response, speeds, stiffness, damping, force, np.array([runs for *_, runs in balances]))


def _rolling_bearings(rotor: Rotor, method: str) -> list[RollingBearing]:
    bearings = [element for element in rotor.bearing_elements if isinstance(element, RollingBearing)]
    if not bearings:
        raise RacewayError(f"the rotor has no raceway.ross.RollingBearing: use rotor.{method}")
    return bearings


def _blocks(sizes: list[int]) -> list[slice]:
    """The bearings' coordinates among those of all."""
    ends = np.cumsum([0, *sizes])
    return [slice(int(a), int(b)) for a, b in zip(ends, ends[1:], strict=False)]


@attrs.frozen(eq=False)
class _Balance:
    """One speed [rad/s]: motion u_0 of the bearings' coordinates without their forces, receptance H."""

    speed: float
    bearings: list[NodeBearing]
    response: np.ndarray
    receptance: np.ndarray

    @classmethod
    def at(
        cls, rotor: Rotor, bearings: list[RollingBearing], w: float, unbalance: tuple[ArrayLike | Quantity, ...]
    ) -> _Balance:
        dynamic = rotor.K(w) + 1j * w * (rotor.C(w) + w * rotor.G()) - w**2 * rotor.M(w)
        rows = []
        for bearing in bearings:
            moving = bearing.node_bearing.moving
            frame = bearing.frame[moving]
            small = bearing.node_bearing.dynamic_stiffness(w, w)[np.ix_(moving, moving)]
            dynamic[np.ix_(bearing.dofs, bearing.dofs)] -= frame.T @ small @ frame
            rows.append(np.zeros((len(frame), rotor.ndof)))
            rows[-1][:, bearing.dofs] = frame
        selection = np.vstack(rows)
        force = np.zeros(rotor.ndof, dtype=complex)
        # Forces of pint as numbers of their base units.
        plain = (v.to_base_units().magnitude if hasattr(v, "to_base_units") else v for v in unbalance)
        for node, magnitude, phase in zip(*map(np.atleast_1d, plain), strict=True):
            turning = magnitude * w**2 * np.exp(1j * phase)
            force[rotor.number_dof * int(node) : rotor.number_dof * int(node) + 2] += turning, -1j * turning
        answers = np.linalg.solve(dynamic, np.column_stack([force, selection.T]))
        return cls(w, [b.node_bearing for b in bearings], selection @ answers[:, 0], selection @ answers[:, 1:])

    def solved(self) -> tuple[list[np.ndarray], list[np.ndarray], int]:
        """Load and Z of each bearing, and the number of evaluations."""
        w, gain = self.speed, np.zeros_like(self.receptance)
        for block, bearing in self._by_block():
            gain[block, block] = np.linalg.inv(bearing.dynamic_stiffness(w, w)[np.ix_(bearing.moving, bearing.moving)])
        slope = gain + self.receptance
        start = np.linalg.solve(slope, self.response)
        load, runs = self._search(start, slope, self._size(gain @ start))
        loads = [load[block] for block, _ in self._by_block()]
        return loads, [b.stiffness_on(w, f, b.motion(w, f)) for f, b in zip(loads, self.bearings, strict=True)], runs

    def _search(self, start: np.ndarray, slope: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, int]:
        def difference(load: np.ndarray) -> np.ndarray:
            motion = [bearing.motion(self.speed, load[block]) for block, bearing in self._by_block()]
            return np.concatenate(motion) - self.response + self.receptance @ load

        last = ConvergenceError()
        for half in range(_HALVINGS + 1):
            try:
                return find_root(difference, 0.5**half * start, slope, size)
            except ConvergenceError as why:
                last = why
        raise ConvergenceError(f"at {30.0 / np.pi * self.speed:.6g} r/min: {last}", last.state)

    def _by_block(self) -> list[tuple[slice, NodeBearing]]:
        return list(zip(_blocks([len(b.moving) for b in self.bearings]), self.bearings, strict=True))

    def _size(self, motion: np.ndarray) -> np.ndarray:
        """Of each coordinate's motion, for the tolerance: the largest of its bearing."""
        size = np.empty(len(motion))
        for block, bearing in self._by_block():
            units = bearing.units(self.speed)
            size[block] = np.abs(motion[block] * units).max() / units
        return size


def run_time_response(
    rotor: Rotor, speed: float, F: np.ndarray, t: np.ndarray, gamma: float = 0.5, beta: float = 0.25, **options: float | None
) -> TimeResponseResults:
    """ROSS's time response by Newmark's method, each ``RollingBearing`` with its nonlinear force.

    Parameters
    ----------
    rotor : ross.Rotor with one or more ``RollingBearing``
    speed : constant [rad/s]
    F : (m, ndof) forces [N];  t : (m,) [s]
    gamma, beta : of Newmark's method;  options : tol, progress_interval of ROSS's

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
    bearings = _rolling_bearings(rotor, "run_time_response")
    if np.ndim(speed):
        remedy = "for a run-up use rotor.run_time_response, whose bearings have the stiffness of small motions at each speed"
        raise RacewayError(f"`speed`: nonlinear bearing forces are of one speed; {remedy}")
    unknown = sorted(set(options) - set(_OPTIONS))
    if unknown:
        raise RacewayError(f"`{unknown[0]}` is no option with nonlinear bearings: gamma, beta, {', '.join(_OPTIONS)} are")
    forces, times = np.asarray(F, dtype=float), np.asarray(t, dtype=float)
    if forces.shape != (len(times), rotor.ndof):
        raise RacewayError(
            f"`F` has the shape {forces.shape}; one row a time and one column a degree of freedom make {(len(times), rotor.ndof)}"
        )
    bearing_force = _NonlinearForce(rotor, bearings, float(speed), forces, gamma, beta)
    newmark = {"gamma": gamma, "beta": beta, **options}
    return rotor.run_time_response(float(speed), forces, times, method="newmark", add_to_RHS=bearing_force, **newmark)


class _NonlinearForce:
    """K q - f(q) (ndof,) at the end of a step, as ROSS's ``add_to_RHS``."""

    def __init__(
        self, rotor: Rotor, bearings: list[RollingBearing], speed: float, forces: np.ndarray, gamma: float, beta: float
    ) -> None:
        self.bearings, self.speed, self.forces, self.gamma, self.beta = bearings, speed, forces, gamma, beta
        self.mass, self.stiffness = rotor.M(), rotor.K(speed)
        self.damping = rotor.C(speed) + speed * rotor.G()
        self.blocks = _blocks([bearing.node_bearing.size for bearing in bearings])
        self.selection = np.zeros((self.blocks[-1].stop, rotor.ndof))
        self.small = np.zeros((self.blocks[-1].stop,) * 2)
        for block, bearing in zip(self.blocks, bearings, strict=True):
            self.selection[block, bearing.dofs] = bearing.frame
            self.small[block, block] = bearing.node_bearing.dynamic_stiffness(speed, speed).real
        self.dt, self.factors, self.receptance = 0.0, None, self.small

    def __call__(self, step: int, **state: Any) -> np.ndarray:
        """By the number of the step; ``state``: time_step [s], disp_resp, velc_resp, accl_resp (ndof,) before it."""
        dt, gamma, beta = float(state["time_step"]), self.gamma, self.beta
        if dt != self.dt:
            self.dt, self.factors = dt, lu_factor(self.mass + gamma * dt * self.damping + beta * dt**2 * self.stiffness)
            self.receptance = beta * dt**2 * self.selection @ lu_solve(self.factors, self.selection.T)
        y, v, a = (np.asarray(state[f"{name}_resp"], dtype=float) for name in ("disp", "velc", "accl"))
        y, v = y + dt * v + (0.5 - beta) * dt**2 * a, v + (1.0 - gamma) * dt * a
        residual = self.forces[step] - self.stiffness @ y - self.damping @ v
        linear = self.selection @ (y + beta * dt**2 * lu_solve(self.factors, residual))
        return np.asarray(self.selection.T @ self._solution(linear))

    def _solution(self, linear: np.ndarray) -> np.ndarray:
        """K q - f(q) with q = q_linear + H (K q - f(q))."""
        q = linear.copy()
        slope = np.zeros_like(self.small)
        for _ in range(_MOST):
            extra = self.small @ q
            for block, bearing in zip(self.blocks, self.bearings, strict=True):
                force, tangent = bearing.node_bearing.resistance(self.speed, q[block])
                extra[block] -= force
                slope[block, block] = self.small[block, block] - tangent
            change = np.linalg.solve(np.eye(len(q)) - self.receptance @ slope, linear + self.receptance @ extra - q)
            q = q + change
            if np.abs(change).max() <= _TOLERANCE * np.abs(q).max() + _SMALL:
                return extra + slope @ change
        raise ConvergenceError(
            "the bearings' forces and the rotor's step do not converge to a common displacement: use shorter steps"
        )
