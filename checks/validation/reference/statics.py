"""Equilibrium of the rigid ring by scipy's root finders, and checks on a claimed equilibrium."""

import numpy as np
from scipy.optimize import root

from checks.validation.reference.ring import Ring


def equilibrium(
    ring: Ring, load: np.ndarray, free: np.ndarray, start: np.ndarray, tilt_stiffness: float = 0.0, stages: int = 8
) -> np.ndarray:
    """Displacement q (5,) that balances ``load`` (5,): MINPACK's hybrid method, radial load and moments in stages.

    free : (5,) 1 for unknowns;  start : (5,) guess at the axial load alone
    """
    chosen = np.flatnonzero(free)
    scale = np.array([1.0, 1.0, 1.0, 1.0 / ring.arm, 1.0 / ring.arm]) * 1e-5
    shaft = np.diag([0.0, 0.0, 0.0, tilt_stiffness, tilt_stiffness])
    q = start.astype(float).copy()
    axial = np.array([load[0], 0.0, 0.0, 0.0, 0.0])
    for stage in range(stages + 1):
        now = axial + (load - axial) * stage / stages

        def balance(x: np.ndarray, now: np.ndarray = now) -> tuple[np.ndarray, np.ndarray]:
            state = q.copy()
            state[chosen] = x * scale[chosen]
            force, tangent, _ = ring(state)
            rest = (force + shaft @ state - now) * scale
            return rest[chosen], ((tangent + shaft) * scale[:, None] * scale)[np.ix_(chosen, chosen)]

        found = root(balance, q[chosen] / scale[chosen], jac=True, method="hybr", options={"xtol": 1e-14})
        q[chosen] = found.x * scale[chosen]
    return q
