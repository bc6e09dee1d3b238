"""Normal forces of all contacts of a bearing: the law, with the damping that the scene asks for.

Notes
-----
A time constant tau makes a contact that answers as its spring does to g + tau dg/dt: for small motions that is a dashpot
c = tau k beside the spring, with k the law's own stiffness at every gap.  The force stays continuous, never pulls and never gives
energy: as the law's force grows with the approach, its excess over the spring's has the sign of the approach's rate.  The viscous part
of the approach is at most as large as the elastic one, so that a contact which begins to touch carries nothing.
"""

from numba import void

from raceway.core.contact.damping import add_damping
from raceway.core.jit import jit
from raceway.core.ring.kernels import AHEAD, CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE, GAP, GAP_RATE
from raceway.core.ring.kernels.layout import DAMPING, TIME_CONSTANT
from raceway.core.signatures import CONTACTS, MATRIX, VECTOR


@jit(void(CONTACTS, VECTOR, MATRIX), inline=True)
def normal_forces(contacts, scalars, work):
    """Rows CONTACT_FORCE, FORCE_BY_GAP and FORCE_BY_RATE of ``work`` from rows GAP and GAP_RATE."""
    law, params, old, new, dt = contacts
    gap, rate, force = work[GAP], work[GAP_RATE], work[CONTACT_FORCE]
    by_gap, by_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    tau = scalars[TIME_CONSTANT]
    if tau == 0.0:
        law(gap, rate, params, old, new, dt, force, by_gap, by_rate)
        add_damping(scalars[DAMPING], gap, rate, force, by_gap, by_rate)
        return
    ahead = work[AHEAD]
    for i in range(gap.size):
        viscous = tau * rate[i]
        ahead[i] = gap[i] + max(viscous, gap[i]) if gap[i] < 0.0 else gap[i]
    law(ahead, rate, params, old, new, dt, force, by_gap, by_rate)
    for i in range(gap.size):
        if tau * rate[i] > gap[i]:
            by_rate[i] += tau * by_gap[i]
        else:
            by_gap[i] *= 2.0
