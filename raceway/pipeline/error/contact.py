"""The entry ``contact`` of a result's table ``error``: what a contact law, or its calibration, is off by."""

from __future__ import annotations

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model


def contact_error(model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
    """Relative error of approaches and stiffnesses at the equilibrium, the largest of all loaded contacts, or None; and how."""
    if not (equilibrium.contact_force > 0.0).any():
        return None, "no contact carries anything"
    return model.bearing.contact_error(model, equilibrium)
