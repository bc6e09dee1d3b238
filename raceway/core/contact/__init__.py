"""Contact of two bodies, and the geometry of a ball bearing.

geometry   groove curvatures, groove centres, contact angle, cage speed; balls on springs under an axial load alone
hertz      exact elliptic Hertz contact, the half-space around it, stresses below it
damping    normal damping, and the energy that a contact stores
film       thickness of an elastohydrodynamic film, entraining speed
"""
