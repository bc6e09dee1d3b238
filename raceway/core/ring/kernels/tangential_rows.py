"""Rows of ``work`` of balls with tangential forces, beyond the law's.

Notes
-----
A row is 2 Z long: index k is a ball's inner contact or axial component, Z + k its outer contact or radial component.  Where a
row holds two quantities of a ball, the second one begins at Z + k.
"""

from typing import NamedTuple

from numba import float64, int64, types

from raceway.core.jit import jit
from raceway.core.ring.kernels import CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE
from raceway.core.signatures import MATRIX

#: Vectors (axial, radial): groove centre e [m] and its velocity [m/s], last step of the ball [m], directions of its contacts.
CENTRE, VELOCITY, STEP = 5, 6, 7
INNER, OUTER = 9, 10
#: Imbalance along the last step [N m], then what a ball is doing.
SLOPE, STATE = 8, 8
#: Values of STATE: it moves, it has settled, it lies between the races without forces.
MOVES, SETTLED, LOOSE = 0.0, 1.0, 2.0
#: Distance of the ball from the groove's centre [m].
LENGTH = 11
#: Of settled balls, since the law is called again for others: normal force [N], its derivatives by gap and gap rate.
KEPT_FORCE, KEPT_BY_GAP, KEPT_BY_RATE = 12, 13, 14
#: cos and sin of the azimuth.
DIRECTION = 16
#: Tangential force h of a contact [N] with its derivatives by the contact's length [N/m], its angle [N] and its shift [N/m].
TANGENTIAL, BY_LENGTH, BY_ANGLE, BY_SHIFT = 15, 17, 18, 24
#: Derivative of the inner h by the outer angle [N], then of the outer h by the inner angle [N].
BY_OTHER_ANGLE = 19
#: Couple on the ring's section [N m], then its derivative by the inner length [N].
COUPLE, COUPLE_BY_LENGTH = 20, 20
#: Its derivatives by the inner angle, then by the outer angle [N m].
COUPLE_BY_ANGLE = 21
#: Its derivative by the section's turn [N m], then that of the inner h [N].
COUPLE_BY_TURN, BY_TURN = 22, 22
#: Derivative of the outer h by the inner length [N/m], then the size of the imbalance at the last step [N].
OUTER_BY_INNER_LENGTH, MERIT = 23, 23
#: Derivative of the couple by the inner shift [N], then how far the section's turn moves the inner groove [m].
COUPLE_BY_SHIFT, TURNED = 25, 25


class Contact(NamedTuple):
    """Direction n of a contact, distance of ball and groove centre [m], normal force [N] and its derivative by that [N/m]."""

    axial: float
    radial: float
    length: float
    force: float
    stiffness: float


CONTACT = types.NamedUniTuple(float64, 5, Contact)
#: Inner and outer contact of a ball.
CONTACTS = types.UniTuple(CONTACT, 2)


@jit(CONTACTS(int64, float64, MATRIX), inline=True)
def contacts_of(k, ball_gain, work):
    """Both contacts of ball k as the law has left them."""
    z = work.shape[1] // 2
    inner = -work[FORCE_BY_GAP, k] - ball_gain * work[FORCE_BY_RATE, k]
    outer = -work[FORCE_BY_GAP, z + k] - ball_gain * work[FORCE_BY_RATE, z + k]
    return (
        Contact(work[INNER, k], work[INNER, z + k], work[LENGTH, k], work[CONTACT_FORCE, k], inner),
        Contact(work[OUTER, k], work[OUTER, z + k], work[LENGTH, z + k], work[CONTACT_FORCE, z + k], outer),
    )
