"""A harmonic motion of one contact: the loop of force over approach, the energy that it costs, K and C.

Notes
-----
With the approach d = d_0 + x cos(w t), a = (2/T) int F cos(w t) dt and b = -(2/T) int F sin(w t) dt over one period: K = a / x,
C = b / (w x), and the energy a cycle is W = int F dd = pi b x = pi C w x^2.  The loss factor is w C / K, the tangent of the phase.
Means over equal samples of a period are exact for the smooth forces of closed contacts.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.ring.increment import Increment
from raceway.studies.law.contact import Contact

#: Samples a period, and periods of a law with memory, of which the last is taken: by then it has forgotten how the motion began.
SAMPLES, PERIODS = 720, 4
#: Of a mean of so many samples, over the largest force.
_ROUNDING = 1e-13


@attrs.frozen(eq=False)
class Cycle:
    """One period of the approach.

    Attributes
    ----------
    frequency : [Hz];  amplitude : x [m]
    approach, rate, force : (n,) over one period [m, m/s, N]
    stiffness : K [N/m];  damping : C [N s/m];  energy : lost [J];  loss_factor : w C / K; None without K
    opens : whether the contact opens on the way
    """

    frequency: float
    amplitude: float
    approach: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    stiffness: float
    damping: float
    energy: float
    loss_factor: float | None
    opens: bool


def cycle(contact: Contact, amplitude: float, frequency: float) -> Cycle:
    """A contact moved about its equilibrium with an amplitude [m] and a frequency [Hz]."""
    w = 2.0 * np.pi * frequency
    phase = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    approach, rate = contact.approach + amplitude * np.cos(phase), -w * amplitude * np.sin(phase)
    remembers = contact.system.law_state.size > 0
    step = Increment(0.0, 0.0, np.zeros_like(contact.system.law_state))  # no time has passed before the first sample
    force = np.empty(SAMPLES)
    for _ in range(PERIODS if remembers else 1):
        for k in range(SAMPLES):
            force[k], _, _, memory = contact.at(float(approach[k]), float(rate[k]), step)
            step = attrs.evolve(step, dt=1.0 / (frequency * SAMPLES), memory=memory)
    in_phase, ahead = 2.0 * float(np.mean(force * np.cos(phase))), -2.0 * float(np.mean(force * np.sin(phase)))
    ahead = ahead if abs(ahead) > _ROUNDING * float(np.max(force)) else 0.0
    return Cycle(
        frequency, amplitude, approach, rate, force, in_phase / amplitude, ahead / (w * amplitude), np.pi * ahead * amplitude,
        ahead / in_phase if in_phase > 0.0 else None, bool((force <= 0.0).any()),
    )  # fmt: skip
