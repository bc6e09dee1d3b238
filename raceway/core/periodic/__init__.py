"""The steady motion, solved for directly.

rule            Gauss points, and the matrices that integrate a polynomial acceleration twice
arrays          the arrays of a collocated motion, as compiled parts take them
intervals       compiled: residuals, exact tangents and their condensation to transfer matrices, one interval after the other
sweep           compiled: changes of a path, rates and contacts over all intervals
defects         compiled: what a path lacks at the ends of its intervals
newton          compiled: Newton's iteration on one mesh
rates           rates of the balls, and their lag behind dashpots
problem         the boundary-value problem, and a motion on a mesh
collocation     its solution on one mesh
symmetry        period of the motion up to a rotation: one turn, or one ball pitch
first_guess     linear response about the static equilibrium
neighbour       a first guess from the motion of a similar problem
refinement      meshes halved where the error is made; the error that is left
branch          pseudo-arclength continuation over any parameter, with folds
special         folds, branch points, period doublings and Neimark-Sacker points of a branch, located
doubling        the branch of twice the period at a period doubling
direct          a motion from a first guess, at once or under a growing force
from_rest       the branch that grows out of rest with the force
detour          a motion followed to from another speed or load
search          all motions that are found, directly and along branches
beginning       the motion that a transient starts on
floquet         Floquet multipliers and stability
sampling        equidistant samples of the motion, as a ``Record``
told            found motions as tables of a result
steady          from a system and an equilibrium to the record of its steady motion
"""
