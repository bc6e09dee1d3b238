"""MASTA values of a 7-ball deep-groove bearing, from the public test file of github.com/minzhun/ISO16281.

Frame: their radial x is our y (ball 0 lies on it), their axial z our x; Fx acts along and Mx about the same axis.
Normalisation: axial displacement from the middle of the axial clearance; psi the size of the tilt vector; both arms of a
tilt d_m / 2 (``tilt_arm = "pitch"``).  Tolerance 1e-4: the digits that are printed, and the curvatures, which they take at
a contact angle of zero and we at the free one (4e-5).
"""

from __future__ import annotations

import numpy as np

from raceway import scene_from_dict
from raceway.extend import run


def test_the_arm_of_the_tilt_matters():
    """With the arm of the groove centres the tilt is off by far more than the tolerance: the check can fail."""
    tables = {
        "title": "groove arm",
        "bearing": {"preset": "DGB7-MASTA", "tilt_arm": "groove"},
        "supports": {"tilt": "free"},
        "load": {"axial": 1000.0, "radial": [1000.0, 0.0]},
    }
    q = run(scene_from_dict(tables)).equilibrium.displacement
    assert abs(1e3 * np.hypot(q[3], q[4]) / 2.6872 - 1.0) > 1e-3
