"""Balls between elastic rings, around any kernel of rigid ones."""

from functools import cache

from raceway.core.jit import Kernel, jit
from raceway.core.ring.kernels.structural import GOES_ON, ITERATIONS, SETTLED, begin, correct, shift, tangents
from raceway.core.signatures import SYSTEM


@cache
def condensed(rigid: Kernel) -> Kernel:
    """The kernel of elastic rings and balls whose contacts, inertia and friction are those of a rigid kernel."""

    @jit(SYSTEM)
    def elastic(t, q, v, balls, contacts, constants, response):
        # See ``raceway.core.ring.kernels``; the last columns of ball belong to the elasticity of the bodies [m].
        ball, ball_gain, ball_known = balls
        scalars, table = constants
        f, K, C, work = response
        begin(t, q, v, constants, work)
        for _ in range(ITERATIONS):
            shift(scalars, ball, ball_gain, ball_known, work)
            status = rigid(t, q, v, balls, contacts, constants, response)
            if status != 0:
                return status
            answer = correct(scalars, table, ball, ball_gain, work, f)
            if answer == SETTLED:
                tangents(scalars, table, ball_gain, work, f, K, C)
                return 0
            if answer != GOES_ON:
                return 1
        return 1

    return elastic
