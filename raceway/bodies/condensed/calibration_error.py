"""What the calibration of contact resultants at surface points leaves, of a scene's loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.framework.estimate import Estimate

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.core.structural import ElasticBodies


def calibration_error(
    compliances: ElasticBodies, model: Model, equilibrium: Equilibrium, more: float = 0.0
) -> tuple[float | None, str]:
    """Relative error of a ball's stiffness by what its contacts' calibration leaves, the largest of all loaded balls; and how.

    Parameters
    ----------
    more : error of the compliance of each contact besides [m/N]
    """
    at_inner, at_outer = compliances.calibrations
    if at_inner is None or at_outer is None:
        return None, Estimate.NOT_CALIBRATED()
    z = model.system.ball_count
    force = equilibrium.contact_force
    loaded = (force[:z] > 0.0) & (force[z:] > 0.0)
    if not loaded.any():
        return None, Estimate.NO_BALL_LOADED()
    inner, outer = force[:z][loaded], force[z:][loaded]
    give = model.inner.approach(inner) / (1.5 * inner) + model.outer.approach(outer) / (1.5 * outer)
    give += sum(compliances.at(float(np.nanmean(equilibrium.angle_inner)))) + 2.0 * compliances.ball_opposite
    left = at_inner.error(inner) + at_outer.error(outer) + 2.0 * more
    return float((left / give).max()), Estimate.CALIBRATED()
