"""Pressures at surface points of condensed bodies.

patch        grids of surface points on which a ball meets a race, and the bodies' compliances on them
reach        extent of the grids: windows of contact angles, widest ellipse
compliances  patches from the sections of rings and ball, through the cache
gap          exact gap of the sphere to the torus, with its derivatives
gather       sub-matrices of the compliance of both bodies
factor       a Cholesky factor that follows a changing set of points
unilateral   f >= 0, w >= 0, f w = 0 by an active set
nodal_law    pressures by a contact law at every point, by Newton's method
friction     stick and slip of a contact's points along the groove
gyroscopic   gyroscopic moments of balls as tangential resultants
contact      one ball against one race: resultant, tangent, pressures
field        the pressures of a contact over its points
balls        equilibrium of all balls between both races
history      memory of contacts and balls between accepted steps
pool         patches and solvers, shared by all copies of a system
system       the inner ring on such balls, with the interface of ``raceway.core.ring.system.System``

Lengths in metres.  In a ball's meridian plane vectors are (axial, radial); contact angles are counted from the radial
direction, so that both contact angles of a ball pressed straight through are equal and positive.
"""
