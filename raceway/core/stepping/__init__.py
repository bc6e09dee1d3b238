"""Systems that are stepped from Python: too large, or too varied, for one compiled loop.

protocol            what such a system must do, as numbered duties
record              schedule, start and record of a time integration
recorder            sampled steps become a ``Record``; progress; failures with the last good state
states              shapes of states that compiled kernels take
vectors             passes of explicit steps over long vectors
implicit            Newmark's method and generalised-alpha: Newton with a line search
central_difference  explicit steps, without matrices
quasi_static        the motion as a series of equilibria
energy              balance of the energies that a system tells

Each loop does what the compiled loop of the same name in ``raceway.core.schemes.compiled`` does, step for step.
"""
