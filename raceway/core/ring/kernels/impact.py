"""One mass against one contact: published impacts, and the simplest motion that a law or an integrator can be tried on.

Notes
-----
The mass moves along x, the first coordinate of the ring; gap = clearance - x, and the contact pushes along -x.  With
the contact far away and a linear stiffness the same system is a linear oscillator.  Laws work on two contacts at least
(a bearing has two races), so the second one is there and stays open.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from raceway.core.excitations.harmonic import no_force
from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE, GAP, GAP_RATE
from raceway.core.ring.kernels.layout import COLUMNS, DAMPING, OFFSET_INNER, REST_AXIAL, SCALARS, TILT_ARM, normal_forces
from raceway.core.ring.system import System
from raceway.core.signatures import SYSTEM

#: Entry of ``scalars`` in which this kernel finds the gap at x = 0 [m]; there is no groove whose offset it could be.
CLEARANCE = OFFSET_INNER
#: Where the contact that is not used stays [m].
_OPEN = 1.0


@jit(SYSTEM)
def impact(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; q[0] is the only coordinate that counts, the balls do not move."""
    scalars, _ = constants
    f, K, C, work = response
    gap, rate, force = work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    d_gap, d_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    for i in range(gap.size):
        gap[i] = _OPEN
        rate[i] = 0.0
    gap[0] = scalars[CLEARANCE] - q[0]
    rate[0] = -v[0]
    normal_forces(contacts, scalars, work)
    for i in range(5):
        f[i] = 0.0
    f[0] = force[0]
    if K.size == 0:
        return 0
    for i in range(5):
        for j in range(5):
            K[i, j] = 0.0
            C[i, j] = 0.0
    K[0, 0] = -d_gap[0]
    C[0, 0] = -d_rate[0]
    return 0


def impact_system(
    mass: float,
    law: Any,
    law_params: np.ndarray,
    *,
    state_size: int = 0,
    clearance: float = 0.0,
    stiffness: float = 0.0,
    damping: float = 0.0,
    contact_damping: float = 0.0,
    load: float = 0.0,
    force: Any = no_force,
    force_params: np.ndarray | None = None,
) -> System:
    """A mass that can move along x against one contact, ready for every integrator.

    Parameters
    ----------
    mass : [kg]
    law : compiled ``LAW``;  law_params : (k,), (1, k) or (2, k) its parameters
    state_size : columns of memory that the law keeps
    clearance : gap at x = 0 [m]; negative: overlap
    stiffness, damping : linear spring [N/m] and dashpot [N s/m] between the mass and the ground
    contact_damping : dashpot of the closed contact [N s/m]
    load : constant force along x [N]
    force : compiled ``FORCE``, the excitation, with its force_params (k,)
    """
    params = np.atleast_2d(np.asarray(law_params, dtype=float))
    scalars = np.zeros(SCALARS)
    # Only the length that the first trust radius of an equilibrium is taken from: a typical approach of a contact.
    scalars[REST_AXIAL] = 1e-4
    scalars[TILT_ARM] = 1.0
    scalars[DAMPING] = contact_damping
    scalars[CLEARANCE] = clearance
    first = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    return System(
        kernel=impact,
        base_kernel=impact,
        law=law,
        law_params=np.array(np.broadcast_to(params[:2], (2, params.shape[1])), order="C"),
        law_state=np.zeros((2, state_size)),
        scalars=scalars,
        table=np.zeros((1, COLUMNS)),
        mass=mass * np.eye(5),
        damping=damping * np.diag(first),
        stiffness=stiffness * np.diag(first),
        free=first,
        load=load * first,
        force=force,
        force_params=np.zeros(1) if force_params is None else np.ascontiguousarray(force_params, dtype=float),
    )


def single_contact(ring: System, contact: int) -> System:
    """One contact of a ring, with its law, parameters and normal damping, whose approach is x.

    Parameters
    ----------
    contact : its number, inner races first, then outer
    """
    system = impact_system(1.0, ring.law, ring.law_params[contact], state_size=ring.law_state.shape[1])
    entries = {CLEARANCE: 0.0, REST_AXIAL: system.scalars[REST_AXIAL], TILT_ARM: system.scalars[TILT_ARM]}
    # Whatever else a ring says of its contacts' normal forces holds here, too.
    system.scalars = ring.scalars.copy()
    for entry, value in entries.items():
        system.scalars[entry] = value
    return system
