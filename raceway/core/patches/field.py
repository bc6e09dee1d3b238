"""The pressures of one contact as a field over its surface points."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.patches.contact import ContactState
from raceway.core.patches.patch import Patch


@attrs.frozen(eq=False)
class PressureField:
    """Pressures on a ball's surface.

    Attributes
    ----------
    along : (m,) place along the groove, from the contact angle of zero [m];  across : (n,) along the rolling direction [m]
    angle : (m,) of the rows on the ball, as contact angles [rad]
    pressure : (m, n) [Pa], zero where nothing carries
    """

    along: np.ndarray
    across: np.ndarray
    angle: np.ndarray
    pressure: np.ndarray


def pressure_field(patch: Patch, pressed: ContactState) -> PressureField:
    """Pressures of a contact at all points of its patch."""
    pressure = np.zeros(patch.rows * patch.columns)
    pressure[pressed.nodes] = pressed.load / patch.area
    radius = patch.ball.radius
    return PressureField(
        radius * patch.phi, radius * patch.ball.latitude, patch.phi, pressure.reshape(patch.rows, patch.columns)
    )
