"""Compiled systems: internal force and tangents of the inner ring after the balls are condensed out.

Every kernel has the signature ``raceway.core.signatures.SYSTEM``, whose records stand there::

    system(t, q, v, balls, contacts, constants, response) -> status

    q, v (5,)   displacement [m, rad] and velocity of the reference point: x, y, z, tilt_y, tilt_z
    balls       position (Z, 2 to 8), in: a first guess; out: the position of each ball in its meridian plane [m], then the slip
                of its inner and outer contact where there is friction [m], of condensed bodies the structural approach of
                both contacts and, where balls act on each other through the rings, at last the displacement of the inner
                groove centre against the outer one by that [m].  gain [1/s], history (like position) [m/s]: 0 and zeros at
                rest; the columns of slips hold those that were committed last [m]; see ``layout``
    contacts    the law, its parameters and memory: inner races first, then outer
    constants   of the model, laid out in ``layout``
    response    f, K, C: internal force [N, N m] and its derivatives by q and by v; a caller that needs no tangents gives K and
                C of shape (0, 0), which are left alone.  work (rows, 2 Z): ``layout.work_rows`` tells how many; on return
                rows GAP and CONTACT_FORCE hold gap [m] and force [N] of every contact

and returns 0, or 1 when the balls did not find their equilibrium.  Damping and tilt stiffness of the shaft, masses and
outer loads are linear and belong to ``raceway.core.ring.system``.  Z counts the balls of all rows.

rigid_inertial     rigid balls: two unknowns each, a convex potential; with gyroscopic moments or friction: none
rolling            moments and friction of four balls, in lanes
structural         each of these on elastic rings and balls: contacts and structural compliances in series
between            balls that act on each other through elastic rings
layout             constants of a model, columns of ``ball``, rows of ``work``; a ball's seat on the ring;  tensors: vectors of its meridian plane
rollers            cylindrical rollers: line contacts cut into laminae, four rollers at a time
impact             one mass against one contact, for the published impacts and the integrators' tests
"""

#: Rows of ``work`` that the law fills or reads, of every contact: gap [m], its rate [m/s], force [N], its derivatives by both.
GAP, GAP_RATE, CONTACT_FORCE, FORCE_BY_GAP, FORCE_BY_RATE = range(5)
#: Rows of rigid bodies in all.  Those of the ball solvers (5 to 25 and from 33 on) stand with the kernels; between them what the
#: bodies' elasticity adds to each gap [m], its rate [m/s] and the energy it stores [J], zeros for rigid bodies; the gap that a
#: damped contact answers to [m]; place of the ball [m] and the known part of its rate [m/s]; offsets of both grooves [m].
WORK_ROWS = 42
SHIFT, SHIFT_RATE, STORED, AHEAD, PLACE, HISTORY, OFFSET = range(26, 33)
#: Rows that condensed bodies have beyond these.  Kernels fill them with the derivatives of both contact forces of a ball by
#: the vector e, its velocity, the shifts (own and the other contact's) and the turn of the section; of its force on the
#: ring, and of its couple, by the shifts; of that force (two rows each: axial, radial) by e and by its velocity, and by the
#: turn; of the couple by e; at last the force itself [N].
(
    BY_AXIAL, BY_RADIAL, BY_AXIAL_SPEED, BY_RADIAL_SPEED, BY_OWN, BY_OTHER, BY_TURN,
    AXIAL_BY_SHIFT, RADIAL_BY_SHIFT, COUPLE_BY_SHIFT,
) = range(WORK_ROWS, WORK_ROWS + 10)  # fmt: skip
FORCE_BY_CENTRE, FORCE_BY_SPEED, FORCE_BY_TURN, COUPLE_BY_CENTRE, FORCE = (
    WORK_ROWS + 10, WORK_ROWS + 12, WORK_ROWS + 14, WORK_ROWS + 15, WORK_ROWS + 16
)  # fmt: skip
KERNEL_ROWS = 17
#: How far the rings' elasticity moves the inner groove centre against the outer one (axial, radial) [m], and the rate of that.
MOVED, MOVED_RATE = WORK_ROWS + KERNEL_ROWS, WORK_ROWS + KERNEL_ROWS + 1
