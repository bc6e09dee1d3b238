"""The motion as a series of equilibria: no inertia, no rates.

Notes
-----
f(q) + K q = F at the end of each step, begun at the last two equilibria, extrapolated.  Without friction and gyroscopic moments
the forces of the balls have a potential, which is minimised; with them a root is found.

scheme     ``Static``;  compiled: its compiled loop, around the solver for forces with a potential or without
stepped    its loop from Python
"""
