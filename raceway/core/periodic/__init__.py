"""The steady motion, solved for directly.

rule            Gauss points, and the matrices that integrate a polynomial acceleration twice
sweep           compiled: residuals, exact tangents and their condensation to transfer matrices, one interval after the other
rates           how fast the balls move, and how far dashpots make them lag
collocation     the boundary-value problem on one mesh, and Newton's iteration for it
symmetry        which rotation maps the motion onto itself, and after what time: one turn, or one ball pitch
first_guess     linear response about the static equilibrium
refinement      meshes halved where the error is made, until it is small enough; the error that is left
branch          pseudo-arclength continuation over any parameter, with folds
floquet         multipliers of the motion and what they mean
sampling        equidistant samples of the motion, as a ``Record``
"""
