"""What a contact law itself is off by, of bodies whose contacts are not calibrated.

Notes
-----
At surface points the bodies deform and a law may leave some overlap: its share of the approach is how much too soft the
contact is.  A law of resultants on rigid bodies is held against exact Hertz at the same load, in its approach and in its
stiffness.  Both say what the model is off by, not the numbers: they are no part of the total error.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.bodies.pressure import law_of_pair
from raceway.framework.duties import renews
from raceway.framework.estimate import Estimate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model, Told

#: Differences from Hertz's approach below this are rounding, of an equilibrium solved to 1e-11.
_ROUNDING = 1e-8


def against_hertz(model: Model, equilibrium: Equilibrium) -> Told:
    """Largest relative difference of a loaded contact's approach or stiffness from Hertz's at the same load."""
    if renews(model.scene.contact.law):
        return None, Estimate.BEYOND_HERTZ(kind=model.scene.contact.kind)
    loaded = equilibrium.contact_force > 0.0
    split = model.system.ball_count
    force = equilibrium.contact_force
    hertz = np.concatenate([model.inner.approach(force[:split]), model.outer.approach(force[split:])])
    approach = -equilibrium.gap
    off = float(np.abs(approach[loaded] / hertz[loaded] - 1.0).max())
    slope = np.concatenate([
        law_of_pair(model.system, race, part)[1] for race, part in enumerate((approach[:split], approach[split:]))
    ])  # fmt: skip
    stiffness = float(np.abs(slope[loaded] * hertz[loaded] / (1.5 * force[loaded]) - 1.0).max())
    if max(off, stiffness) < _ROUNDING:
        return None, Estimate.HERTZ_ITSELF()
    return max(off, stiffness), Estimate.AGAINST_HERTZ(stiffness=stiffness, approach=off)


def overlap(columns: Mapping[str, np.ndarray], equilibrium: Equilibrium) -> Told:
    """Largest share of a loaded contact's approach that the surfaces overlap; ``columns`` : those of the balls."""
    loaded = equilibrium.contact_force > 0.0
    left, approach = (
        np.concatenate([columns[f"{name}_{race}_m"] for race in ("inner", "outer")])[loaded]
        for name in ("approach_penetration", "approach")
    )
    share = float((left / np.maximum(approach, 1e-300)).max())
    return share, Estimate.OVERLAP()


def untold(model: Model) -> Told:
    """Of laws that are calibrated to Hertz and nothing more is known of."""
    return None, Estimate.LAW_UNKNOWN(kind=model.scene.contact.kind)
