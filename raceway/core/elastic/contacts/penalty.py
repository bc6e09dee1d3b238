"""Stiffness of a penalty [N/m3]: pressure per penetration, scaled from the bodies' own."""

from __future__ import annotations

import numpy as np

#: Stiffness of the penalty over E* / h.  The layer under one row of elements of size h yields about h p / E*: ten times
#: stiffer, the penalty adds a tenth of what the mesh errs by; stiffer still, pressures ring from point to point.
RATIO = 10.0


def penalty_stiffness(modulus: float, size: np.ndarray | float) -> np.ndarray:
    """RATIO E* / h with E* [Pa] and the size h [m] of the facets across the contact."""
    return np.asarray(RATIO * modulus / np.asarray(size))
