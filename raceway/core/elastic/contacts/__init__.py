"""Forces between two elastic bodies, at points of their surfaces or a force a contact; knows meshes, no assembly.

surface     quadrature points of a contacting surface, on the exact sphere where it is one
facets      facets under points of a surface, with weights
gap         distance from the exact surfaces, its normal and curvature
interior    cells around points inside of a body, with weights
contact     gap, normal, pressure and friction at places; nodal forces and their tangent
near        the few nodes that places hang on
nodal       places that are points of a surface
resultant   contact resultants, whose law replaces the local compliance of the mesh
footprint   nodal weights of a contact resultant, and the motion of the surface there
separation  compliance of the mesh under it: local part and structural part
traction    duties of friction;  friction: Coulomb's at the points, by return mapping
penalty     stiffness of the penalty from the bodies' own
contact_axis  normal of a loaded contact through its centre, in each body
stress_profile  stresses along it, and the largest shear stress
recovery    peak pressures, approach, and penetration of the penalty
"""
