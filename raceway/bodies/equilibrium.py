"""The static state of a bearing under its constant loads."""

from __future__ import annotations

import attrs
import numpy as np


@attrs.frozen(eq=False)
class Equilibrium:
    """The static state under the constant loads.

    Attributes
    ----------
    displacement : (5,) x, y, z [m], tilts [rad]
    stiffness : (5, 5) tangent of the contacts, rows on a spring following: how the constant loads change by the displacement
    damping : (5, 5) of the contacts there, of slow motions, w -> 0 [N s/m, N s/rad, N m s/m, N m s/rad]; 0 for elastic bodies, which
        know it in motion only
    stiffness_rows_held, damping_rows_held : the same with rows on a spring held where they stand, as within a motion
    ball : (Z, 2) positions in the meridian planes [m]
    gap, contact_force : (2 Z,) inner races first [m, N]
    angle_inner, angle_outer : (Z,) contact angles [rad], nan where a contact is open
    warnings : what a user should know
    """

    displacement: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    stiffness_rows_held: np.ndarray
    damping_rows_held: np.ndarray
    ball: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    angle_inner: np.ndarray
    angle_outer: np.ndarray
    iterations: int
    warnings: tuple[str, ...]


def tilts_follow(stiffness: np.ndarray, tilt: float | str) -> float | None:
    """Static condensation of the tilts: kyy - k_yt (k_tt + k_shaft I)^-1 k_ty [N/m].

    Parameters
    ----------
    stiffness : (5, 5) tangent stiffness of the equilibrium
    tilt : the scene's ``supports.tilt``: "locked" (None is returned), "free", or the tilt stiffness of the shaft [N m/rad]
    """
    if tilt == "locked":
        return None
    tilts = stiffness[3:, 3:] + (tilt if isinstance(tilt, float) else 0.0) * np.eye(2)
    if not np.linalg.det(tilts):
        return float(stiffness[1, 1])
    return float(stiffness[1, 1] - stiffness[1, 3:] @ np.linalg.solve(tilts, stiffness[3:, 1]))
