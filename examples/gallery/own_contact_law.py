"""
An own contact law
==================

A law of one line, Q = k delta, in a file of its own, beside Hertz over the axial load.
Its stiffness does not grow with the load; it falls, because the contact angle grows.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

file = Path(tempfile.mkdtemp(), "linear_law.py")
file.write_text("""
import attrs, numpy as np
from raceway import LAW, hookimpl, jit, option, positive

@jit(LAW)
def linear(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        k = params[i, 0] if gap[i] < 0.0 else 0.0
        force[i], d_gap[i], d_rate[i] = -k * gap[i], -k, 0.0

@attrs.frozen
class Linear:
    name, discretisations, state_size, dissipative = "linear", {"resultant"}, 0, False
    slope: float = option(8e7, unit="N/m", help="k", rule=positive())

    def build(self, pairs):
        return np.full((pairs.hertz_factor.size, 1), self.slope)

    def kernel(self):
        return linear

@hookimpl
def raceway_contact_laws():
    return [Linear]
""")

loads = np.linspace(100, 2000, 12)  # N
bearing = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
axes = {"contact.kind": ["hertz", "linear"], "load.axial": loads}
swept = rw.sweep(bearing, axes, plugins=[file])
stiffness = 1e-6 * swept.stiffness.sel(dof="y", dof2="y").values

plt.figure(layout="constrained")
plt.plot(loads, stiffness.T, "o-", label=["Hertz", "linear"])
plt.xlabel("axial load [N]")
plt.ylabel("kyy [N/µm]")
plt.legend()
growth = stiffness[:, -1] / stiffness[:, 0]
print(
    f"kyy from 100 to 2000 N: times {growth[0]:.2f} with Hertz, {growth[1]:.2f} with the linear law"
)
