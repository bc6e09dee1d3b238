"""The compiled bearing: five coordinates of the inner ring, balls condensed out.

ring            five coordinates on balls, however their forces are computed;  increment: a step that they are asked at
system          a ring whose forces are compiled;  surrogate: rings that are stepped, and a compiled one near each
kernels         internal force and tangents
viscous_stiffness   of damped contacts against small harmonic motions
equilibrium     static state by a trust region on the total potential
root            static state where forces have no potential: gyroscopic moments, friction
dense           linear algebra inside kernels
orbit           steady orbit by Fourier collocation
start           initial state of a time integration
changing_speed  parts of a system that follow a changing spin speed
energy          balance of a recorded motion;  friction: energy stored and lost by Coulomb friction
stepped         any system of these coordinates, made steppable from Python
address         compiled kernels as plain addresses
"""
