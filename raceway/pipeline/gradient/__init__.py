"""Derivatives of a result by the continuous keys of its scene, by the implicit function theorem: nothing is solved again.

differences     steps and weights of central differences of fourth order
variation       models of one scene at neighbouring values of a key; what they cost is counted
statics         of displacement, stiffness and ball loads of the equilibrium
motion          of the dynamic stiffness of the steady orbit
gradients       both, key by key
quantities      the numbers that are told of, and their derivatives
first_order     their band over the tolerances of the scene
"""
