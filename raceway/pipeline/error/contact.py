"""What a contact law itself is off by: the entry ``contact`` of a result's table ``error``.

Notes
-----
At surface points the bodies deform and a law may leave some overlap: its share of the approach is how much too soft the
contact is.  A law of whole contacts on rigid bodies is held against exact Hertz at the same load, in its approach and in its stiffness.  Both say what the model
is off by, not the numbers: the entry is no part of ``total``.  Hertz's law on condensed and elastic bodies is calibrated on contacts at
surface points; what is left of their own error is a number's, and part of ``total`` where there is one.
"""

from __future__ import annotations

import numpy as np

from raceway.bodies.model import Model
from raceway.pipeline.pressure import law_of_pair
from raceway.pipeline.settle import Equilibrium

#: Differences from Hertz's approach below this are rounding, of an equilibrium solved to 1e-11.
_ROUNDING = 1e-8


def is_calibrated(model: Model) -> bool:
    """Whether contact resultants are calibrated on contacts at surface points: what that leaves is part of the total."""
    scene = model.scene
    kinds = scene.bodies.kind, scene.contact.discretisation, scene.contact.kind
    return kinds in (("condensed", "resultant", "hertz"), ("elastic", "resultant", "hertz"))


def contact_error(model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
    """Relative error of approaches and stiffnesses at the equilibrium, the largest of all loaded contacts, or None; and how."""
    loaded = equilibrium.contact_force > 0.0
    if not loaded.any():
        return None, "no contact carries anything"
    if model.scene.contact.discretisation == "nodal":
        return _penetration(model, equilibrium, loaded)
    kind = model.scene.contact.kind
    if is_calibrated(model):
        return model.bodies.calibration_error(model, equilibrium)
    if model.bodies is not None:
        return None, (
            f"law '{kind}' is calibrated to Hertz on elastic bodies, and nothing in a run tells how well: compare with "
            "contact.discretisation = 'nodal' (docs/condensed.md has both for B7206C)"
        )
    split = model.system.ball_count
    force = equilibrium.contact_force
    hertz = np.concatenate([model.inner.approach(force[:split]), model.outer.approach(force[split:])])
    approach = -equilibrium.gap
    off = float(np.abs(approach[loaded] / hertz[loaded] - 1.0).max())
    slope = np.concatenate([
        law_of_pair(model, race, part)[1] for race, part in enumerate((approach[:split], approach[split:]))
    ])  # fmt: skip
    stiffness = float(np.abs(slope[loaded] * hertz[loaded] / (1.5 * force[loaded]) - 1.0).max())
    if max(off, stiffness) < _ROUNDING:
        return None, "the law is Hertz's: what it assumes (smooth, dry half-spaces) is not estimated"
    return max(off, stiffness), (
        f"largest difference of a contact's stiffness ({stiffness:.1e}) or approach ({off:.1e}) from exact Hertz at the same "
        "load; not part of the total"
    )


def _penetration(model: Model, equilibrium: Equilibrium, loaded: np.ndarray) -> tuple[float | None, str]:
    columns = model.bodies.ball_columns(model, equilibrium)
    overlap, approach = (
        np.concatenate([columns[f"{name}_{race}_m"] for race in ("inner", "outer")])[loaded]
        for name in ("approach_penetration", "approach")
    )
    share = float((overlap / np.maximum(approach, 1e-300)).max())
    return share, "largest share of a contact's approach that the law lets the surfaces overlap; not part of the total"
