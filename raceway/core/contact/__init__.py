"""Contact of two bodies, and the geometry of a ball bearing.

hertz        exact elliptic Hertz contact
subsurface   Hertz's stresses below a contact, and the largest shear stress
half_space   half-space under normal forces
sphere       structural compliance of a ball beyond the half-space
geometry     groove curvatures, groove centres, contact angle, cage speed
film         thickness of an elastohydrodynamic film, entraining speed
damping      normal damping, and the energy that a contact stores
"""
