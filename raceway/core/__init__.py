"""Numerics only: arrays in, arrays out.

jit            the one decorator for compiled kernels
signatures     types of the kernels that are passed as function pointers
threads        threads that share work, and how many there are
contact        Hertz contact, half-space, elastic sphere, geometry of the bearing, contact damping
contact_laws, excitations   compiled kernels of the built-in plug-ins
ring           the compiled bearing: five coordinates of the inner ring, balls condensed out
schemes        one-step, explicit and static methods: compiled loops and loops in Python
stepping       time integration of systems that are stepped from Python; records
periodic       steady motions by collocation and continuation, with their Floquet multipliers
signals        dynamic stiffness from the spectral lines of a motion
mesh           hexahedral meshes of rings and balls
hexahedron     the eight-node hexahedron
linear         static and free linear elasticity: multigrid, natural frequencies
revolution     compliances of bodies of revolution, harmonic by harmonic
condensed      structural compliances behind contact resultants
patches        pressures at surface points on condensed bodies
elastic        bodies whose every node is a degree of freedom, in contact
"""

import os

from raceway.errors import RacewayError

_THREADS = os.environ.get("NUMBA_NUM_THREADS", "1")
if not _THREADS.isdigit() or int(_THREADS) == 0:  # numba's import ends by a ValueError, or prints one
    raise RacewayError(f"`NUMBA_NUM_THREADS` = {_THREADS!r}: must be a whole number from 1; unset it for all cores")
