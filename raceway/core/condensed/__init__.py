"""Condensed bodies: finite elements of rings and balls reduced to what the contacts feel.

Contacts as resultants:

line_load    a Hertz line load on a groove, and the half-space's displacement under it
structural   structural compliances of rings by depth matching: what the elements give beyond a half-space
grooves      compliances between groove centres, from what contacts feel
calibration  structural compliance of one contact at its surface points, which the others are shifted to
elastic_bodies  both of a bearing, and the compiled system with them in the place of rigid rings
modes        first natural frequencies of the rings

Contacts as pressures at surface points:

patch        grids of surface points on which ball rows meet race rows, and the bodies' compliances on them
reach        how far contacts go: windows of contact angles and the widest ellipse
compliances  patches from the sections of rings and ball, through the cache
gap          exact gap of the sphere to the torus at every point, with its derivatives
gather       sub-matrices of the compliance of both bodies, for chosen points
factor       a Cholesky factor that follows a changing set of points
unilateral   pressures without penetration, by an active set
nodal_law    pressures by a contact law at every point, by Newton
friction     stick and slip of a contact's points along the groove
gyroscopic   moments of balls as tangential resultants
contact      one ball against one race: forces, tangent, pressure field
field        the pressures of a contact over its points
balls        all balls between both races: places and resultants that are in equilibrium
history      what contacts and balls remember between accepted steps
pool         patches and solvers, shared by all copies of a system
patch_system the ring on such balls, with the interface of ``raceway.core.ring.system.System``

Lengths in metres.  In a ball's meridian plane vectors are (axial, radial); contact angles are counted from the radial
direction, so that both contact angles of a ball pressed straight through are equal and positive.
"""
