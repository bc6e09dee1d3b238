"""The compiled force of nothing; those of excitations are beside their classes in ``raceway.plugins.excitations``."""

from raceway.core.jit import jit
from raceway.core.signatures import FORCE


@jit(FORCE)
def no_force(t, params, out):
    """Nothing acts."""
    for i in range(out.size):
        out[i] = 0.0
