"""One mass against one contact: published impacts, and the simplest motion that a law or an integrator can be tried on.

The mass moves along x, the first coordinate of the ring; gap = clearance - x, and the contact pushes along -x.  With
the contact far away and a linear stiffness the same system is a linear oscillator.  Laws work on two contacts at least
(a bearing has two races), so the second one is there and stays open.
"""

import numpy as np

from raceway.core.jit import Kernel, jit
from raceway.core.ring import kernels as rows
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.layout import normal_forces
from raceway.core.ring.system import System, no_force
from raceway.core.signatures import SYSTEM

#: Entry of ``scalars`` in which this kernel finds the gap at x = 0 [m]; there is no groove whose offset it could be.
CLEARANCE = ring.OFFSET_INNER
#: Where the contact that is not used stays [m].
_OPEN = 1.0


@jit(SYSTEM)
def _impact(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; q[0] is the only coordinate that counts, the balls do not move."""
    scalars, _ = constants
    f, K, C, work = response
    gap, rate, force = work[rows.GAP], work[rows.GAP_RATE], work[rows.CONTACT_FORCE]
    d_gap, d_rate = work[rows.FORCE_BY_GAP], work[rows.FORCE_BY_RATE]
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
    law: Kernel,
    law_params: np.ndarray,
    *,
    clearance: float = 0.0,
    stiffness: float = 0.0,
    damping: float = 0.0,
    load: float = 0.0,
) -> System:
    """A mass that can move along x against one contact, ready for every integrator.

    Parameters
    ----------
    mass : [kg]
    law : compiled ``LAW``;  law_params : (k,), (1, k) or (2, k) its parameters
    clearance : gap at x = 0 [m]; negative: overlap
    stiffness, damping : linear spring [N/m] and dashpot [N s/m] between the mass and the ground
    load : constant force along x [N]
    """
    params = np.atleast_2d(np.asarray(law_params, dtype=float))
    scalars = np.zeros(ring.SCALARS)
    # Only the length that the first trust radius of an equilibrium is taken from: a typical approach of a contact.
    scalars[ring.REST_AXIAL] = 1e-4
    scalars[ring.TILT_ARM] = 1.0
    scalars[CLEARANCE] = clearance
    first = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    return System(
        kernel=_impact,
        base_kernel=_impact,
        law=law,
        law_params=np.array(np.broadcast_to(params[:2], (2, params.shape[1])), order="C"),
        law_state=np.zeros((2, 0)),
        scalars=scalars,
        table=np.zeros((1, ring.COLUMNS)),
        mass=mass * np.eye(5),
        damping=damping * np.diag(first),
        stiffness=stiffness * np.diag(first),
        free=first,
        load=load * first,
        force=no_force,
        force_params=np.zeros(1),
    )


def single_contact(bearing: System, contact: int) -> System:
    """One contact of a bearing, with its law, parameters and normal damping, whose approach is x.

    contact : its number, inner races first, then outer
    """
    system = impact_system(1.0, bearing.law, bearing.law_params[contact])
    system.law_state = np.zeros((2, bearing.law_state.shape[1]))
    # Whatever else a bearing says of its contacts' normal forces holds here, too.
    lengths, scalars = [ring.REST_AXIAL, ring.TILT_ARM], bearing.scalars.copy()
    scalars[CLEARANCE], scalars[lengths] = 0.0, system.scalars[lengths]
    system.scalars = scalars
    return system
