"""Pressures at surface points of condensed bodies.

patch      grids of surface points on which a ball meets a race, exact gaps with their derivatives, the bodies' compliances
compliance   of points of a patch, and its factors
pressure   one ball against one race: pressures by a law or an active set, resultant, tangent; extent of the grids
friction   stick and slip of a contact's points along the groove
balls      equilibrium of all balls between both races, with their gyroscopic moments
system     the inner ring on such balls, with the interface of ``raceway.core.ring.ring.Ring``; memory, patches of all copies

Lengths in metres.  In a ball's meridian plane vectors are (axial, radial); contact angles are counted from the radial
direction, so that both contact angles of a ball pressed straight through are equal and positive.
"""
