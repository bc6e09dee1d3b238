"""Balls with tangential contact forces in their meridian plane: gyroscopic moments, Coulomb friction, or both.

Notes
-----
With n = (sin a, cos a) the direction of a contact at its angle a and t = (cos a, -sin a), the inner race gives a ball
g_i = f_i n_i + (tau_i - T_i) t_i and the outer one takes g_o = f_o n_o + (tau_o - T_o) t_o; g_i - g_o + F_c = 0.  T comes from
the gyroscopic moment, tau from friction; both put the couple -r h, h = tau - T, on the section of the inner ring (of friction
-r k_t u, which belongs to the stored energy).  Gyroscopic moments and sliding have no potential: tangents are not symmetric.
"""

from raceway.core.jit import jit
from raceway.core.ring.kernels import (
    CONTACT_FORCE,
    FORCE_BY_GAP,
    FORCE_BY_RATE,
    KERNEL_ROWS,
    WORK_ROWS,
)
from raceway.core.ring.kernels import tangential_rows as row
from raceway.core.ring.kernels.friction import roll, rub
from raceway.core.ring.kernels.gyroscopic import add_gyroscopic
from raceway.core.ring.kernels.layout import (
    FRICTION,
    GYROSCOPIC,
    LEVER,
    OFFSET_OUTER,
    SIDE,
    TILT_ARM,
    move_centres,
    place,
)
from raceway.core.ring.kernels.normal import normal_forces
from raceway.core.ring.kernels.section import Seat
from raceway.core.ring.kernels.tangential_newton import PATIENCE, approach, first_guess, seat_outside, settles
from raceway.core.ring.kernels.tangential_rows import contacts_of
from raceway.core.ring.kernels.tangential_tangents import add_settled
from raceway.core.signatures import SYSTEM

_ITERATIONS = 300


@jit(SYSTEM)
def rigid_tangential(t, q, v, balls, contacts, constants, response):
    """See ``raceway.core.ring.kernels``; ball (Z, 4): p [m], slips [m]."""
    ball, ball_gain, ball_known = balls
    scalars, table = constants
    f, K, C, work = response
    force = work[CONTACT_FORCE]
    by_gap, by_rate = work[FORCE_BY_GAP], work[FORCE_BY_RATE]
    elastic_bodies = work.shape[0] > WORK_ROWS
    z = table.shape[0]
    place(t, q, v, constants, work, (row.DIRECTION, row.CENTRE, row.VELOCITY))
    if elastic_bodies:
        move_centres(work, row.CENTRE, row.VELOCITY)
    moving = 0
    for k in range(z):
        moving += first_guess(k, q, scalars, table, ball, work)
    for attempt in range(_ITERATIONS):
        for k in range(z):
            if attempt == PATIENCE and work[row.STATE, z + k] == row.MOVES:
                # Forces without a potential can lead in circles: once more from the seat on the outer race.
                seat_outside(k, scalars, table, ball, work)
            approach(k, scalars, ball, ball_gain, ball_known, work)
        normal_forces(contacts, scalars, work)
        for k in range(z):
            if work[row.STATE, z + k] == row.MOVES:
                sides = contacts_of(k, ball_gain, work)
                if scalars[FRICTION] != 0.0:
                    rub(k, sides, scalars, ball, ball_known, work)
                else:
                    roll(k, work)
                if scalars[GYROSCOPIC] != 0.0:
                    add_gyroscopic(k, sides, scalars, work)
                moving -= settles(k, attempt, sides, scalars[OFFSET_OUTER], table, ball, work)
        if moving == 0:
            break
    if moving > 0:
        return 1
    f[:], K[:], C[:] = 0.0, 0.0, 0.0
    for k in range(z):
        if elastic_bodies:
            for i in range(WORK_ROWS, WORK_ROWS + KERNEL_ROWS):
                work[i, k], work[i, z + k] = 0.0, 0.0
        if work[row.STATE, z + k] == row.LOOSE:
            force[k], force[z + k] = 0.0, 0.0
            continue
        for c in (k, z + k):
            force[c], by_gap[c], by_rate[c] = work[row.KEPT_FORCE, c], work[row.KEPT_BY_GAP, c], work[row.KEPT_BY_RATE, c]
        if force[k] == 0.0 and by_gap[k] == 0.0:
            continue
        seat = Seat(work[row.DIRECTION, k], work[row.DIRECTION, z + k], scalars[TILT_ARM], table[k, SIDE], table[k, LEVER])
        if not add_settled(k, ball_gain, seat, work, f, K, C):
            return 1
    return 0
