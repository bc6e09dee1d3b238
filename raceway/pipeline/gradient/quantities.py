"""The numbers of a result whose derivatives are told, and these by a key."""

from __future__ import annotations

import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.pipeline.gradient.gradients import Gradient
from raceway.pipeline.gradient.motion import SteadyOrbit
from raceway.pipeline.result import tilts_follow

#: Names with units, in the order of columns; what a scene does not have is left out.
UNITS = {
    "K": "N/m",
    "C": "N s/m",
    "amplitude": "m",
    "kxx": "N/m",
    "kyy": "N/m",
    "x": "m",
    "largest_ball_load": "N",
}
#: Part of |Z| below which w C is no number that an orbit resolves.
_RESOLVED = 1e-6


def values(model: Model, equilibrium: Equilibrium, orbit: SteadyOrbit | None) -> dict[str, float]:
    """K, C and amplitude of the 1x line of the steady orbit; kxx, kyy (tilts follow where they may), x and largest ball load at rest."""
    found: dict[str, float] = {}
    if orbit is not None:
        real, damping, stiffness, amplitude = (float(one) for one in orbit.line)
        found |= {"K": stiffness, "amplitude": amplitude}
        if abs(damping) * orbit.solved.problem.speed > _RESOLVED * abs(real):
            found["C"] = damping
    loads = equilibrium.contact_force[: model.system.ball_count]
    found |= {
        "kxx": float(equilibrium.stiffness[0, 0]),
        "kyy": _kyy(equilibrium.stiffness, model.scene.supports.tilt),
        "x": float(equilibrium.displacement[0]),
        "largest_ball_load": float(loads.max()),
    }
    return {name: found[name] for name in UNITS if name in found}


def derivatives(model: Model, equilibrium: Equilibrium, gradient: Gradient) -> dict[str, float]:
    """Of the same, by the number at the gradient's key."""
    found: dict[str, float] = {}
    if gradient.motion is not None:
        one = gradient.motion
        found |= {"K": one.equivalent_stiffness, "C": one.equivalent_damping, "amplitude": one.amplitude}
    statics = gradient.statics
    largest = int(np.argmax(equilibrium.contact_force[: model.system.ball_count]))
    found |= {
        "kxx": float(statics.stiffness[0, 0]),
        "kyy": _slope_of_kyy(model, equilibrium, gradient),
        "x": float(statics.displacement[0]),
        "largest_ball_load": float(statics.contact_force[largest]),
    }
    return found


def _kyy(stiffness: np.ndarray, tilt: float | str) -> float:
    follows = tilts_follow(stiffness, tilt)
    return float(stiffness[1, 1]) if follows is None else follows


def _slope_of_kyy(model: Model, equilibrium: Equilibrium, gradient: Gradient) -> float:
    """Along the line of the stiffness, and of the shaft's where that is the key."""
    statics, tilt = gradient.statics, model.scene.supports.tilt
    step = statics.step
    if step == 0.0:
        return 0.0
    by = step if statics.key.path == "supports.tilt" else 0.0
    ends = [
        _kyy(equilibrium.stiffness + k * step * statics.stiffness, tilt + k * by if isinstance(tilt, float) else tilt)
        for k in (-1.0, 1.0)
    ]
    return (ends[1] - ends[0]) / (2.0 * step)
