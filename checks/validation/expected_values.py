"""The table that an independent rigid-ring solver gave for the B7206C, and the program's own numbers of the same quantities.

Static scenes: pure axial load for the table; for the trends the rig's rotating force, quasi-static, as a radial load
towards ball 0 with fixed balls.  Secant stiffness is that force over the displacement along it.
"""

import numpy as np

from checks.validation.scenes import rig_force, static
from raceway.testing import settled

#: Axial load [N]: axial displacement [um], contact angle [deg], ball load [N], p inner, outer [MPa], k axial, k radial
#: with tilt locked, with tilt free [N/um].
TABLE = {
    400.0: (17.96, 17.35, 111.8, 1128.0, 939.0, 38.6, 183.4, 16.5),
    1200.0: (33.01, 19.26, 303.1, 1573.0, 1309.0, 68.6, 250.3, 34.7),
    2000.0: (43.02, 20.52, 475.5, 1828.0, 1521.0, 91.6, 286.6, 46.9),
}


def axial_row(axial: float) -> np.ndarray:
    """(8,) the program's numbers in the order of ``TABLE``."""
    model, now = settled(static(axial, "locked"))
    load = now.contact_force[0]
    locked, free = np.linalg.inv(now.stiffness[:3, :3]), np.linalg.inv(now.stiffness)
    pressures = model.inner.peak_pressure(load), model.outer.peak_pressure(load)
    stiffness = 1.0 / np.array([free[0, 0], locked[1, 1], free[1, 1]])
    return np.array(
        [now.displacement[0] * 1e6, np.degrees(now.angle_inner[0]), load, *np.array(pressures) / 1e6, *stiffness / 1e6]
    )


def secant(axial: float, tilt: str, speed_rpm: float, inertia: bool) -> float:
    """Radial stiffness under the rig's force [N/m]."""
    force = rig_force(speed_rpm)
    return float(force / settled(static(axial, tilt, force, speed_rpm, inertia))[1].displacement[1])
