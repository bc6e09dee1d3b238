"""Independent implementations in plain numpy and scipy that the program is held against.

Nothing here imports ``raceway``: every number is computed a second time, from physics.md's equations, by other means.

hertz      exact elliptic Hertz by quadrature and root finding
half_space  stresses below Hertz's pressure by quadrature of point loads
ring       rigid-ring bearing: balls in series (weightless) or with centrifugal force, force and tangent of the ring
row_set    rows mirrored, placed and pressed together on one shaft
statics    equilibrium by scipy's root finders
shooting   periodic motion by DOP853 and Newton on the monodromy matrix; 1x dynamic stiffness
"""
