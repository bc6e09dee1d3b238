"""Bodies whose every node is a degree of freedom, in contact at points of their surfaces or by a force a contact.

body        one body: mesh, material, supports
assembly    the unknowns of all bodies in one vector, rigid frames included; linear forces, masses, energies
cage        what holds a ball that nothing else holds: at its azimuth, without turning
surface     quadrature points of a contacting surface, on the exact sphere where it is one
facets      where on a meshed surface a point lies: facet and weights
gap         distance from the exact surfaces, its normal and curvature
interior    where inside of a body a point lies: cell and weights
contact     gap, normal, pressure and friction at places; nodal forces and their tangent
nodal       places that are points of a surface
resultant   places that are whole contacts, whose law replaces what the mesh below gives way
footprint   where a whole contact acts on a mesh, and how the surface moves there
separation  what the mesh gives way under it: the part that is the contact's, the part that is the body's
touching    the contacts of a ball bearing, of either kind
traction    what friction offers;  friction: Coulomb's at the points, by return mapping
penalty     stiffness of the penalty from the bodies' own
solver      conjugate gradients with multigrid and the rigid frames' own coordinates
whole_contacts  whole contacts and the cage added to the inverse of the bodies
factorised  sparse factors in the place of multigrid, for small systems
statics     Newton's method with a line search; the last good state is kept
system      all of it, stepped in time or settled
recovery    peak pressures, approach, and what the penalty takes of it
setup       what a ball bearing is beyond its meshes
bearing     the bodies of a ball bearing, made into a system
ring        the bearing seen from its inner ring: the interface of all systems
start       where motions begin
"""
