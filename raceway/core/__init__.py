"""Numerics only: arrays in, arrays out.

jit            the one decorator for compiled kernels;  compiler: what numba does otherwise for them;  wheel_kernels: those that a wheel brings;  deferred: those beside light classes
columns        numbers that may be columns, one of each operating point; interpolation of smooth functions between few
lanes          one number of each of four balls at a time
signatures     types of the kernels that are passed as function pointers
threads        threads that share work, and how many there are; a second process that compiles kernels meanwhile
contact        Hertz contact, half-space, elastic sphere, geometry of the bearing, contact damping
record         duties of a system that is stepped from Python; schedule, start and record of a time integration;  recorder: takes steps into it
ring           the compiled bearing: five coordinates of the inner ring, balls condensed out
time           one-step, explicit and static methods: compiled loops and loops in Python
periodic       steady motions by collocation and continuation, with their Floquet multipliers
quantities     lives, friction, temperatures
signals        dynamic stiffness from the spectral lines of a motion
fem            the shared finite elements: meshes, hexahedra, condensation, elastic bodies in full
"""

import os

from raceway.errors import RacewayError

_THREADS = os.environ.get("NUMBA_NUM_THREADS", "1")
if not _THREADS.isdigit() or int(_THREADS) == 0:  # numba's import ends by a ValueError, or prints one
    raise RacewayError(f"`NUMBA_NUM_THREADS` = {_THREADS!r}: must be a whole number from 1; unset it for all cores")
