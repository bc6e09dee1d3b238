"""Bodies whose every node is a degree of freedom, in contact at points of their surfaces or by a force a contact.

body        one body: mesh, material, supports
assembly    the unknowns of all bodies in one vector, rigid frames included; linear forces, masses, energies
cage        what holds a ball that nothing else holds: at its azimuth, without turning
contacts    places where forces act between two bodies, and what the forces are: a package of its own
touching    the contacts of a ball bearing, of either kind
solver      conjugate gradients with multigrid and the rigid frames' own coordinates
whole_contacts  whole contacts and the cage added to the inverse of the bodies
factorised  sparse factors in the place of multigrid, for small systems
statics     Newton's method with a line search; the last good state is kept
system      all of it, stepped in time or settled
setup       what a ball bearing is beyond its meshes
bearing     the bodies of a ball bearing, made into a system
ring        the bearing seen from its inner ring: the interface of all systems
start       where motions begin
"""
