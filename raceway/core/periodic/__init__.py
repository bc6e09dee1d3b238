"""The steady motion, solved for directly.

collocation   the boundary-value problem on one mesh;  turn: Gauss points and symmetry of that;  newton: its iteration, compiled
intervals     compiled: residuals, exact tangents, transfer matrices, rates and contacts, one interval after the other
refinement    meshes halved where the error is made; the error that is left; equidistant samples
branch        pseudo-arclength continuation over any parameter;  special_points: folds, branch points, period doublings
search        all motions: from a first guess or a neighbour;  branches: under a growing force, from another speed or load
floquet       Floquet multipliers and stability
orbits        compiled: steady orbits of many points;  lockstep: four of them at a time;  steps: their arrays, Newton's
fourier       motions by their samples, the linear response;  extremes: of the contact forces along them
monodromy     compiled: what becomes of a disturbance of an orbit over a span
steady        from a system and an equilibrium to the record of its steady motion, and where a transient starts
"""
