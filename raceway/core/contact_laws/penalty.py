"""The penalty law at pairs and at points by one kernel, told apart by the columns of ``params``.

One column: the factor of a pair's force.  A second column: the stiffness k [N/m3] of the pressure p = k delta at a point,
beside a factor that ``build`` then sets to zero.
"""

from raceway.core.jit import jit
from raceway.core.signatures import LAW


@jit(LAW)
def square_or_linear(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Penalty: p = k delta at a point, or, integrated over the overlap of a paraboloid, Q = c delta^2 of a pair."""
    if params.shape[1] == 1:
        for i in range(gap.size):
            approach = max(-gap[i], 0.0)
            slope = params[i, 0] * approach
            force[i] = slope * approach
            d_gap[i] = -2.0 * slope
            d_rate[i] = 0.0
        return
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        linear = params[i, 1] if gap[i] < 0.0 else 0.0
        slope = params[i, 0] * approach
        force[i] = (slope + linear) * approach
        d_gap[i] = -2.0 * slope - linear
        d_rate[i] = 0.0
