"""Forces between two elastic bodies, at points of their surfaces or a force a contact; knows meshes, no assembly.

surface     quadrature points of a contacting surface, on the exact sphere where it is one
facets      where on a meshed surface a point lies: facet and weights
gap         distance from the exact surfaces, its normal and curvature
interior    where inside of a body a point lies: cell and weights
contact     gap, normal, pressure and friction at places; nodal forces and their tangent
nodal       places that are points of a surface
resultant   places that are whole contacts, whose law replaces what the mesh below gives way
footprint   where a whole contact acts on a mesh, and how the surface moves there
separation  what the mesh gives way under it: the part that is the contact's, the part that is the body's
traction    what friction offers;  friction: Coulomb's at the points, by return mapping
penalty     stiffness of the penalty from the bodies' own
recovery    peak pressures, approach, and what the penalty takes of it
"""
