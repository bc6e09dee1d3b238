"""A harmonic motion of one contact: the loop of force over approach, the energy that it costs, K and C.

Notes
-----
With the approach delta = delta_0 + x cos(w t), a = (2/T) int F cos(w t) dt and b = -(2/T) int F sin(w t) dt over one period:
K = a / x, C = b / (w x), and the energy a cycle is W = int F ddelta = pi b x = pi C w x^2.  The loss factor is w C / K, the tangent of the phase.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.ring.increment import Increment
from raceway.studies.law.contact import Contact

#: Samples a period, and periods, of which the last is taken: by then a law's memory has forgotten how the motion began.
SAMPLES, PERIODS = 720, 4


@attrs.frozen(eq=False)
class Cycle:
    """One period of the approach.

    Attributes
    ----------
    frequency : [Hz];  amplitude : x [m];  mean : delta_0 [m]
    approach, rate, force : (n,) over one period [m, m/s, N]
    stiffness : K [N/m];  damping : C [N s/m];  energy : lost [J];  loss_factor : w C / K
    opens : whether the contact opens on the way
    """

    frequency: float
    amplitude: float
    mean: float
    approach: np.ndarray
    rate: np.ndarray
    force: np.ndarray
    stiffness: float
    damping: float
    energy: float
    loss_factor: float
    opens: bool


def cycle(contact: Contact, mean: float, amplitude: float, frequency: float) -> Cycle:
    """A contact moved about a mean approach [m] with an amplitude [m] and a frequency [Hz]."""
    w = 2.0 * np.pi * frequency
    phase = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    approach, rate = mean + amplitude * np.cos(phase), -w * amplitude * np.sin(phase)
    step = Increment(1.0 / (frequency * SAMPLES), 0.0, np.zeros_like(contact.system.law_state))
    force = np.empty(SAMPLES)
    for period in range(PERIODS if contact.system.law_state.size else 1):
        for k in range(SAMPLES):
            at_once = period == k == 0  # no time has passed before the first
            given = attrs.evolve(step, dt=0.0) if at_once else step
            force[k], _, _, memory = contact.at(float(approach[k]), float(rate[k]), given)
            step = attrs.evolve(step, memory=memory)
    in_phase, ahead = 2.0 * np.mean(force * np.cos(phase)), -2.0 * np.mean(force * np.sin(phase))
    stiffness, damping = float(in_phase / amplitude), float(ahead / (w * amplitude))
    return Cycle(
        frequency, amplitude, mean, approach, rate, force, stiffness, damping, float(np.pi * ahead * amplitude),
        w * damping / stiffness if stiffness > 0.0 else float("nan"), bool((force <= 0.0).any()),
    )  # fmt: skip
