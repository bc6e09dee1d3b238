"""Central differences of fourth order."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

#: Steps at which a function is looked at, with their weights: (8 (f_1 - f_-1) - (f_2 - f_-2)) / 12 h, its error h^4 f^(5) / 30.
WEIGHTS = {-2: 1.0 / 12.0, -1: -8.0 / 12.0, 1: 8.0 / 12.0, 2: -1.0 / 12.0}


def derivative(values: Mapping[int, np.ndarray], step: float) -> np.ndarray:
    """Derivative of arrays that are given at multiples -2, -1, 1, 2 of a step."""
    # In pairs, so that what does not change gives exactly nothing.
    inner, outer = (values[k] - values[-k] for k in (1, 2))
    found: np.ndarray = (WEIGHTS[1] * inner + WEIGHTS[2] * outer) / step
    return found
