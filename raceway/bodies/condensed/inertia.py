"""What it costs that condensed bodies follow at once: their first frequencies against that of the excitation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.bodies.basis import seat_of
from raceway.core.mesh.ring_mesh import ring_shape
from raceway.core.structural import first_frequency
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model


def inertia_table(model: Model, equilibrium: Equilibrium) -> Tables:
    """First elastic frequencies of both rings as supported and free, and of a ball along its grooves [Hz].

    Each with the error (w / w_1)^2 that leaving out its inertia makes in what it contributes; None in a static scene, and for
    a ball whose inertia the motion has.

    Notes
    -----
    A ball pressed by Q between two grooves is held along them by k = Q_i / L_i + Q_o / L_o, where L is the distance from the
    ball's centre to the groove's.
    """
    scene = model.scene
    b = scene.bearing
    excitation = scene.excitation
    frequency = None if excitation is None else float(excitation.frequency_hz)
    out: Tables = {}

    def tell(name: str, first: float | None) -> None:
        out[f"{name}_hz"] = first
        out[f"{name}_error"] = None if frequency is None or first is None else (frequency / first) ** 2

    for inner, word in ((True, "inner"), (False, "outer")):
        shape = ring_shape(b, inner)
        for name, seat in (("supported", seat_of(scene, inner)), ("free", "free")):
            steel = (b.rings.young, b.rings.poisson, b.rings.density)
            tell(f"{word}_{name}", first_frequency(shape, b.ball_diameter, *steel, seat))
    z, geometry = model.system.ball_count, model.geometry
    force = equilibrium.contact_force
    held = force[:z] / geometry.offset_inner + force[z:] / geometry.offset_outer
    loaded = held[(force[:z] > 0.0) & (force[z:] > 0.0)]
    mass = geometry.ball_mass(b.balls.density)
    slowest = float(np.sqrt(loaded.min() / mass) / (2.0 * np.pi)) if len(loaded) else None
    tell("ball_along_grooves", slowest)
    recorded = excitation is not None and "record" in scene.identifier.method.needs
    moves = recorded and scene.integrator.method.inertial and getattr(model.system, "ball_mass", 0.0) > 0.0
    out["ball_along_grooves_in_motion"] = moves
    if moves:
        out["ball_along_grooves_error"] = None
    return out
