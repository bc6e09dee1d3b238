"""Small mechanical systems with known motions, for the suites of integrators and identifiers.

Notes
-----
The mass moves along x against one contact (gap = clearance - x, the contact pushes along -x) and along y and z on linear
springs, which a gyroscopic term couples.  Balls and tilts do not move.  A bearing has two races, so there are two
contacts; the second one stays open.
"""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
from scipy.integrate import solve_ivp

from raceway.core.contact_laws.power import three_halves
from raceway.core.excitations.harmonic import harmonic, no_force
from raceway.core.ring.kernels.layout import COLUMNS, DIAMETER, REST_AXIAL, SCALARS, TILT_ARM
from raceway.core.ring.system import System
from raceway.core.stepping.record import Motion
from raceway.storage.tables import Tables
from raceway.testing.compiled import counting, one_contact

#: A diameter that no ball here has: the gap at x = 0 [m].
CLEARANCE = DIAMETER
_OPEN = 1.0

MASS, STIFFNESS, DASHPOT, GYROSCOPIC = 2.0, 2e8, 600.0, 800.0
#: Circular frequency of the springs [rad/s] and the period [s].
NATURAL = float(np.sqrt(STIFFNESS / MASS))
PERIOD = 2.0 * np.pi / NATURAL
#: Factor of the contact [N/m^1.5] and the load [N] that preloads it.
FACTOR, PRELOAD = 1e10, 300.0
#: Amplitude of the force [N] and its speed [rad/s]: three quarters of the natural frequency.
AMPLITUDE, SPEED = 200.0, 0.75 * NATURAL


def counting_system() -> System:
    """``contact_system`` with the law ``counting``."""
    return attrs.evolve(contact_system(), law=counting, law_state=np.zeros((2, 1)))


def _system(free: list[float], **parts: Any) -> System:
    scalars = np.zeros(SCALARS)
    # The first trust radius of an equilibrium is taken from it: a typical approach.
    scalars[REST_AXIAL], scalars[TILT_ARM] = 1e-4, 1.0
    scalars[CLEARANCE] = parts.pop("clearance", 0.0)
    zero = np.zeros((5, 5))
    given = {
        "kernel": one_contact, "law": three_halves, "law_params": np.full((2, 1), FACTOR), "law_state": np.zeros((2, 0)),
        "scalars": scalars, "table": np.zeros((1, COLUMNS)), "mass": MASS * np.eye(5), "damping": zero,
        "stiffness": zero, "free": np.array(free), "load": np.zeros(5), "force": no_force, "force_params": np.zeros(1),
    }  # fmt: skip
    known = attrs.fields_dict(System)
    if "base_kernel" in known:
        given["base_kernel"] = one_contact
    return System(**{**given, **parts})


def linear_system(damped: bool = True, forced: bool = True) -> System:
    """Springs along y and z, coupled by a gyroscopic term, under a force that turns forward; the contact stays open."""
    damping = np.zeros((5, 5))
    if damped:
        damping[1, 1] = damping[2, 2] = DASHPOT
        damping[1, 2], damping[2, 1] = GYROSCOPIC, -GYROSCOPIC
    parts: Tables = {}
    if forced:
        parts = {"force": harmonic, "force_params": np.array([AMPLITUDE, SPEED, 0.3, 1.0, 0.0, 0.0, 1.0])}
    stiffness = np.diag([0.0, STIFFNESS, 1.3 * STIFFNESS, 0.0, 0.0])
    return _system([0.0, 1.0, 1.0, 0.0, 0.0], damping=damping, stiffness=stiffness, clearance=_OPEN, **parts)


def contact_system(load: float = PRELOAD, clearance: float = 0.0) -> System:
    """A mass on a Hertzian contact, pressed on by a constant load along x."""
    return _system([1.0, 0.0, 0.0, 0.0, 0.0], load=np.array([load, 0.0, 0.0, 0.0, 0.0]), clearance=clearance)


def motion(system: System, q: np.ndarray, v: np.ndarray) -> Motion:
    """A consistent start: the acceleration balances the forces at time zero."""
    still = np.zeros((1, 2))
    outer = system.outer_force(0.0)
    return Motion(q, v, system.acceleration(q, v, outer, system.evaluate(q, v, ball=still)), still, still.copy())


def exact(system: System, start: Motion, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and velocity (n, 5) by an eighth-order method at tolerances near rounding."""
    chosen = system.free > 0.0

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        q, v = np.ascontiguousarray(state[:5]), np.ascontiguousarray(state[5:])
        now = system.evaluate(q, v, ball=np.zeros((1, 2)))
        return np.concatenate([v * chosen, system.acceleration(q, v, system.outer_force(t), now)])

    scale = np.concatenate([np.full(5, 1e-6), np.full(5, 1e-6 * NATURAL)])
    # 1e-12 of the motion: far below the errors of the steps that are compared with it.
    found = solve_ivp(
        slope, (0.0, times[-1]), np.concatenate([start.q, start.v]), "DOP853", times, rtol=1e-11, atol=1e-11 * scale
    )
    return found.y[:5].T, found.y[5:].T


def contact_energy(system: System, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n,) kinetic and stored energy less the work of the load [J], for the springs and the Hertzian contact."""
    approach = np.maximum(q[:, 0] - system.scalars[CLEARANCE], 0.0)
    springs = 0.5 * np.einsum("ni,ij,nj->n", q, system.stiffness, q) - q @ system.load
    return 0.5 * np.einsum("ni,ij,nj->n", v, system.mass, v) + springs + 0.4 * system.law_params[0, 0] * approach**2.5
