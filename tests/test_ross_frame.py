"""Every coefficient under its own name in ROSS' frame: a matrix without any symmetry."""

from __future__ import annotations

import numpy as np

from raceway.studies.ross.coefficients import Coefficients
from raceway.studies.ross.file import ross_file

SPEED = np.linspace(100.0, 900.0, 5)
#: ROSS' axes (X, Y) are (y, z) of the bearing: row, then column.
PLACES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1)}


def test_no_two_entries_are_swapped():
    stiffness = 1e8 * np.array([[1.0, 2.0], [3.0, 4.0]]) + np.zeros((5, 1, 1))
    damping = np.array([[10.0, 20.0], [30.0, 40.0]]) + SPEED[:, None, None]
    still = np.zeros((5, 5, 5))
    table = Coefficients(SPEED, None, stiffness, damping, np.full(5, 7e7), "tangent", "made up", (), still, still, "locked")
    for generation in (2, 3):
        content = ross_file(table, generation, "made_up", 1, ()).content
        for name, (row, column) in PLACES.items():
            np.testing.assert_array_equal(content[f"k{name}"], stiffness[:, row, column])
            np.testing.assert_array_equal(content[f"c{name}"], damping[:, row, column])
        np.testing.assert_array_equal(content["kzz"], 7e7)
