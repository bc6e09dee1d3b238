"""Bodies whose every node is a degree of freedom, in contact at surface points or by one resultant a contact.

assembly    one body, springs and cage; the unknowns of all bodies in one vector, rigid frames included; forces, masses, energies
unknowns    copies between unknowns and nodal vectors; mean motions of bodies
bearing_data   data of an elastic bearing beyond its meshes
surface     quadrature points of a contacting surface, on the exact sphere where it is one; facets and cells under points
contact     pressure at surface points: gap, normal, nodal forces and their tangent;  friction: Coulomb's, by return mapping
resultant   contact resultants, whose law replaces the local compliance of the mesh
stress      stresses below a loaded contact along its normal
linear_statics   K u = f of one body with prescribed displacements: conjugate gradients and multigrid
iterative_solver   conjugate gradients with multigrid, the rigid frames' own coordinates and low-rank changes by the contacts
newton      Newton's method with a line search; the last good state is kept
fronts      elimination down to kept nodes, with fronts of dense matrices, in the order of nested dissection
copies      equal parts of bodies;  body_forces: K u of all, by one matrix for equal parts or element by element
superelement   a body eliminated once, down to the nodes that contacts may touch: free copies, and sectors of a ring
interface   all bodies, seen from the nodes of their contacts;  superelement_solver: Newton's method in the contacts alone
explicit    compiled explicit steps of one-point elements in contact at surface points;  explicit_kernels: the parts of a step
bearing     the bodies of a ball bearing as one system, in equilibrium or stepped in time
device      CUDA devices, and functions for their kernels of the sources of the CPU's;  device_steps: explicit steps there
ring        the bearing seen from its inner ring: the interface of all systems
"""
