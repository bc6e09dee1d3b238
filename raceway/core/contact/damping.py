"""Normal damping of every contact law, and the energy that a contact stores."""

from numba import float64, void

from raceway.core.jit import jit
from raceway.core.signatures import LAW_POINTER, MATRIX, VECTOR


@jit(void(float64, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR), inline=True)
def add_damping(damping, gap, gap_rate, force, d_gap, d_rate):
    """Add a viscous force -damping * gap_rate [N] to closed contacts; the sum never pulls.

    Where the dashpot would pull harder than the law pushes, the contact carries nothing.
    """
    if damping == 0.0:
        return
    for i in range(gap.size):
        if gap[i] < 0.0:
            total = force[i] - damping * gap_rate[i]
            if total > 0.0:
                force[i] = total
                d_rate[i] -= damping
            else:
                force[i] = 0.0
                d_gap[i] = 0.0
                d_rate[i] = 0.0


# Gauss-Legendre nodes and weights of order 8 on (0, 1): with delta = u^2, exact for every power law delta^(n/2), n <= 13.
_NODES = (
    0.019855071751231856, 0.10166676129318664, 0.2372337950418355, 0.4082826787521751,
    0.5917173212478249, 0.7627662049581645, 0.8983332387068134, 0.9801449282487682,
)  # fmt: skip
_WEIGHTS = (
    0.05061426814518813, 0.11119051722668724, 0.15685332293894363, 0.18134189168918100,
    0.18134189168918100, 0.15685332293894363, 0.11119051722668724, 0.05061426814518813,
)  # fmt: skip


@jit(void(LAW_POINTER, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX, VECTOR))
def stored_energy(law, params, state_old, state_new, gap, scratch, energy):
    """energy (n,) [J]: the integral of the law's force over the approach from first touch to ``gap`` (n,), at rest.

    Meant for laws without memory; ``scratch`` is (6, n).
    """
    n = gap.size
    where, rate, force, d_gap, d_rate = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
    for i in range(n):
        energy[i] = 0.0
        rate[i] = 0.0
    for node in range(8):
        u, w = _NODES[node], _WEIGHTS[node]
        for i in range(n):
            where[i] = min(gap[i], 0.0) * u * u
        law(where, rate, params, state_old, state_new, 0.0, force, d_gap, d_rate)
        for i in range(n):
            energy[i] -= w * 2.0 * u * min(gap[i], 0.0) * force[i]
