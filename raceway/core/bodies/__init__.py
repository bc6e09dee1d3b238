"""Compiled systems: internal force and tangents of the inner ring after the balls are condensed out.

Every kernel has the signature ``raceway.core.signatures.SYSTEM``::

    system(t, dt, q, v, ball, ball_gain, ball_known, law, law_params, law_old, law_new,
           scalars, table, work, f, K, C) -> status

    q, v (5,)            displacement [m, rad] and velocity of the reference point: x, y, z, tilt_y, tilt_z
    ball (Z, 2 or 4)     in: a first guess; out: the position of each ball in its meridian plane [m], then the slip
                         of its inner and outer contact where there is friction [m]
    ball_gain [1/s], ball_known (Z, 2 or 4) [m/s]   rate of a ball = ball_gain * ball + ball_known: an integrator
                         states its difference formula with them; 0 and zeros at rest.  Columns 2 and 3 hold the slips
                         that were committed last [m]
    law_params (2 Z, k), law_old, law_new (2 Z, m)   the law's parameters and memory: inner races first, then outer
    scalars, table       constants of the model, laid out in ``raceway.core.bodies.ring``
    work (WORK_ROWS, 2 Z)   on return rows 0 and 2 hold gap [m] and force [N] of every contact
    f (5,), K, C (5, 5)  internal force [N, N m] and its derivatives by q and by v; a caller that needs no tangents gives
                         K and C of shape (0, 0), which are left alone

and returns 0, or 1 when the balls did not find their equilibrium.  Damping and tilt stiffness of the shaft, masses and
outer loads are linear and belong to ``raceway.core.system``.  Z counts the balls of all rows.

rigid_weightless   balls without mass: the two races in series
rigid_inertial     balls with centrifugal force: two unknowns each, a convex potential
rigid_tangential   the same with gyroscopic moments or friction: no potential
impact             one mass against one contact, for the published impacts and the integrators' tests
"""

#: Rows of ``work``: gap, gap rate, force, d_gap, d_rate, then scratch of the ball solvers.
WORK_ROWS = 24
