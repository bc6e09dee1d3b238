"""The error that the periodic solver states, against the motion at a far closer tolerance."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.testing import b7206c, run


def motion(tolerance: float, axial: float):
    tables = b7206c(
        load={"axial": axial},
        rotor={"mass": 2.0},
        excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 6.39e-4, "load_share": 0.5},
        supports={"tilt": "free"},
        integrator={"kind": "periodic", "tolerance": tolerance, "symmetry": "none"},
    )
    return run(scene_from_dict(tables))


@pytest.mark.parametrize("axial", [400.0, 1000.0])
def test_the_stated_error_is_neither_far_below_nor_far_above_the_true_one(axial):
    loose, tight = motion(1e-3, axial), motion(1e-11, axial)
    stated = loose.simulation.whole.counts["error"]
    change = (loose.simulation.record.displacement - tight.simulation.record.displacement)[:, :3]
    size = np.abs(tight.simulation.record.displacement[:, 1:3]).max()
    true = np.abs(change).max() / size
    assert true <= 3.0 * stated
    assert stated <= 30.0 * true
