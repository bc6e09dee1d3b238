"""The compiled bearing: five coordinates of the inner ring, balls condensed out.

system          arrays and kernels of one model, ready for an integrator
kernels         internal force and tangents
equilibrium     static state by a trust region on the total potential
root            static state where forces have no potential: gyroscopic moments, friction
loops           compiled time loops;  advance: runs them in chunks
orbit           steady orbit by Fourier collocation
start           initial state of a time integration
changing_speed  parts of a system that follow a changing spin speed
energy          balance of a recorded motion;  friction: energy stored and lost by Coulomb friction
stepped         any system of these coordinates, made steppable from Python
address         compiled kernels as plain addresses
"""
