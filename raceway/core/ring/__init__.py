"""The compiled bearing: five coordinates of the inner ring, balls condensed out.

ring          five coordinates on balls, however their forces are computed;  stepped: in loops of Python
system        a ring whose forces are compiled: parts that follow a changing speed, kernels as addresses, steps from Python
kernels       internal force and tangents
equilibrium   static state: by a trust region on the total potential, by a root where there is none;  elimination: linear algebra in kernels
equilibria    compiled: the static state of many points;  lockstep: of four at a time, in lanes
compliances   of elastic bodies, in lanes
orbit         steady orbit by Fourier collocation, and the initial state of a time integration
energy        balance of a recorded motion; energy stored and lost by Coulomb friction
viscous_stiffness   of damped contacts against small harmonic motions
"""
