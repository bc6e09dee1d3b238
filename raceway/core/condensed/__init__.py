"""Contacts of condensed bodies: finite elements of rings and balls reduced to what the contacts feel.

patch        grids of surface points on which ball rows meet race rows, and the bodies' compliances on them
gap          exact gap of the sphere to the torus at every point, with its derivatives
gather       sub-matrices of the compliance of both bodies, for chosen points
factor       a Cholesky factor that follows a changing set of points
unilateral   pressures without penetration, by an active set
nodal_law    pressures by a contact law at every point, by Newton
contact      one ball against one race: forces, tangent, pressure field
balls        all balls between both races: places and resultants that are in equilibrium
patch_system the ring on such balls, with the interface of ``raceway.core.system.System``

Lengths in metres.  In a ball's meridian plane vectors are (axial, radial); angles are counted from the radial
direction towards +axial, on the outer race outwards, on the inner race inwards, so that both contact angles of a ball
pressed straight through are equal.
"""
