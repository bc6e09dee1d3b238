"""Published lives, and the standard's equations as printed."""

from __future__ import annotations

import numpy as np

from raceway import run
from raceway.core.life import equivalent_loads, ring_lives, system_life
from raceway.extend import BallRow

#: 7 balls of 11.5 mm on 43.5 mm, C = 23 400 N: clearance [m], radial and axial force [N], moment about the radial force [N m], life.
#: MASTA, in the public test file Test_BallBearing.py of github.com/minzhun/ISO16281; the moment's line has a life of 8e5 and balls
#: with 20 N, where displacements are printed to 3e-5 only.
MASTA = [
    (0.0, 1000.0, 0.0, 0.0, 13163.019, 1e-4),
    (0.0, 0.0, 1000.0, 0.0, 2222.7318, 1e-4),
    (1e-5, 1000.0, 0.0, 0.0, 10795.7948, 1e-4),
    (1e-5, 0.0, 1000.0, 0.0, 3115.8781, 1e-4),
    (1e-5, 1000.0, 1000.0, 0.0, 1630.5367, 1e-4),
    (0.0, 0.0, 0.0, 1.0, 785144.7521, 3e-4),
    (1e-5, 1000.0, 1000.0, 1.0, 1627.7479, 1e-4),
]
DEEP_GROOVE = BallRow(7, 11.5e-3, 43.5e-3, 0.0, 0.52, 0.53)


def life(load: np.ndarray, ratings: np.ndarray) -> np.ndarray:
    return system_life(ring_lives(equivalent_loads(load), ratings))


def reference_life(clearance: float, radial: float, axial: float, moment: float) -> float:
    """L10r of a line of ``MASTA`` [1e6 revolutions], from the ball loads of its run."""
    bearing = {"preset": "DGB7-MASTA", "tilt_arm": "pitch", "radial_clearance": clearance}
    load = {"radial": [radial, 0.0], "axial": axial, "moment": [moment, 0.0]}
    loads = np.array(run({"bearing": bearing, "load": load, "supports": {"tilt": "free"}}).ball_loads)
    return float(life(np.stack([loads, loads]), DEEP_GROOVE.contact_ratings(23400.0)))


def printed_life_factor(kappa: float, load_ratio: float) -> float:
    """a_ISO by equations 31 to 33 of ISO 281:2007 as printed, one a range of kappa."""
    if kappa < 0.4:
        factor = 0.1 * (1 - (2.5671 - 2.2649 / kappa**0.054381) ** 0.83 * load_ratio ** (1 / 3)) ** -9.3
    elif kappa < 1:
        factor = 0.1 * (1 - (2.5671 - 1.9987 / kappa**0.19087) ** 0.83 * load_ratio ** (1 / 3)) ** -9.3
    else:
        strength = 1 - (2.5671 - 1.9987 / kappa**0.071739) ** 0.83 * load_ratio ** (1 / 3)
        factor = 0.1 * max(strength, 1e-9) ** -9.3
    return min(factor, 50.0)
