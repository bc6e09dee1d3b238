"""Numerics only: arrays in, arrays out.

jit           the one decorator for compiled kernels, and their cache on disk
signatures    the types of every kernel that is passed as a function pointer
hertz         exact elliptic Hertz contact
half_space    a half-space under normal forces;  sphere: an elastic ball beyond Hertz
geometry      groove curvatures, groove centres, cage speed
contact       what the core adds to every law: damping, the energy stored in a contact
dense         5x5 linear algebra without allocation
bodies        the rigid bearing as a compiled system, and a one-contact impact
system        the arrays and kernels of one model, ready for an integrator
equilibrium   the static state by a trust region on the total potential
orbit         the periodic orbit by Fourier collocation, used to start transients
contact_laws, excitations, integrators   the compiled parts of the plug-ins, file by file under their names
"""
