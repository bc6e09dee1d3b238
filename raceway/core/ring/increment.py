"""A step of an integrator, as a ring's forces need to know it."""

from __future__ import annotations

import attrs
import numpy as np


@attrs.frozen(eq=False)
class Increment:
    """A step of an integrator since the law's memory was committed.

    Attributes
    ----------
    dt : its length [s];  gain : derivative of the balls' rates by their places [1/s]
    memory : (2 Z, m); None for the ring's ``law_state``
    """

    dt: float = 0.0
    gain: float = 0.0
    memory: np.ndarray | None = None


#: No time has passed.
AT_ONCE = Increment()
