"""Bodies whose every node is a degree of freedom, in contact at surface points or by one resultant a contact.

body        one body: mesh, material, supports
assembly    the unknowns of all bodies in one vector, rigid frames included; linear forces, masses, energies
cage        an ideal cage: mean azimuth and mean rotation of each ball
body_forces   internal forces of all bodies, shared by threads
copies      equal balls, and equal sectors of a ring
equal_parts   which parts of a bearing are copies
copied_stiffness   internal forces of all copies by the matrix of one
mean_motions  mean motions of bodies and the forces on them, block by block
unknowns      copies between unknowns and nodal vectors
contacts    forces between two bodies
touching    the contacts of a ball bearing, of either kind
bed         springs under a surface
superelements   bodies in nodal contact, solved exactly: equal balls and sectors factored once
solver      conjugate gradients with multigrid and the rigid frames' own coordinates
low_rank        contact resultants and the cage as low-rank changes of the preconditioner
factorised  sparse factors instead of multigrid, for small systems
line_search  how far along Newton's step
statics     Newton's method with a line search; the last good state is kept
system      all of it as one system, settled or stepped in time
stepped     time steps of bodies in nodal contact
bearing_data       data of an elastic bearing beyond its meshes
bearing     the bodies of a ball bearing, made into a system
ring        the bearing seen from its inner ring: the interface of all systems
start       initial state of a time integration
"""
