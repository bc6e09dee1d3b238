"""The numbers of a result whose derivatives are told, and these by a key."""

from __future__ import annotations

import numpy as np

from raceway.bodies.equilibrium import Equilibrium, tilts_follow
from raceway.bodies.model import Model
from raceway.framework.shown import race_words, tilt_words
from raceway.pipeline.gradient.gradients import Gradient
from raceway.pipeline.gradient.motion import SteadyOrbit
from raceway.pipeline.gradient.statics import StaticGradient
from raceway.pipeline.motion import race_of
from raceway.storage.tables import Tables

#: Names with units, in the order of columns; what a scene does not have is left out.
UNITS = {
    "K": "N/m",
    "C": "N s/m",
    "amplitude": "m",
    "kxx": "N/m",
    "kyy": "N/m",
    "kyy_tilts_follow": "N/m",
    "x": "m",
    "largest_ball_load": "N",
}
#: Part of |Z| below which w C is no number that an orbit resolves.
_RESOLVED = 1e-6


def values(model: Model, equilibrium: Equilibrium, orbit: SteadyOrbit | None) -> dict[str, float]:
    """The numbers that a scene has, by their names in ``UNITS``: of the steady orbit, and at rest."""
    found: dict[str, float] = {}
    if orbit is not None:
        real, damping, stiffness, amplitude = (float(one) for one in orbit.line)
        found |= {"K": stiffness, "amplitude": amplitude}
        if abs(damping) * orbit.solved.problem.speed > _RESOLVED * abs(real):
            found["C"] = damping
    found |= _at_rest(equilibrium, equilibrium)
    if (follows := tilts_follow(equilibrium.stiffness, model.scene.supports.tilt)) is not None:
        found["kyy_tilts_follow"] = follows
    return {name: found[name] for name in UNITS if name in found}


def described(name: str, value: float, words: dict[str, str]) -> Tables:
    """A number as JSON files hold it; ``words`` as ``definitions`` has them."""
    return {"value": value, "unit": UNITS[name], "definition": words[name]}


def definitions(model: Model, equilibrium: Equilibrium) -> dict[str, str]:
    """What each number of ``values`` is."""
    inner, outer = equilibrium.contact_force.reshape(2, -1).max(axis=1).tolist()
    return {
        "K": "Re Z + m w^2",
        "C": "Im Z / w",
        "amplitude": "of the 1x motion along the force",
        "kxx": "axial, other motions held",
        "kyy": "radial, tilts and other motions held",
        "kyy_tilts_follow": f"radial, {tilt_words(model.scene.supports.tilt)}: tilts follow, x and z held",
        "x": "axial displacement under the constant loads",
        "largest_ball_load": f"static, {race_words(race_of(inner, outer))}; the larger of both",
    }


def derivatives(model: Model, equilibrium: Equilibrium, gradient: Gradient) -> dict[str, float]:
    """Of the same, by the number at the gradient's key."""
    found: dict[str, float] = {}
    if gradient.motion is not None:
        one = gradient.motion
        found |= {"K": one.equivalent_stiffness, "C": one.equivalent_damping, "amplitude": one.amplitude}
    statics = gradient.statics
    found |= _at_rest(equilibrium, statics)
    if (tilt := model.scene.supports.tilt) != "locked":
        by = float(statics.key.path == "supports.tilt")
        found["kyy_tilts_follow"] = _slope_with_tilts(equilibrium.stiffness, statics.stiffness, tilt, by)
    return found


def _at_rest(equilibrium: Equilibrium, of: Equilibrium | StaticGradient) -> dict[str, float]:
    """The numbers that every scene has, of the equilibrium or of its slopes."""
    largest = int(np.argmax(equilibrium.contact_force))
    found = {"kxx": of.stiffness[0, 0], "kyy": of.stiffness[1, 1], "x": of.displacement[0]}
    return {name: float(one) for name, one in {**found, "largest_ball_load": of.contact_force[largest]}.items()}


def _slope_with_tilts(stiffness: np.ndarray, slope: np.ndarray, tilt: float | str, by: float) -> float:
    """Of kyy_tilts_follow where the stiffness (5, 5) moves with ``slope``, and the shaft's against tilts with ``by``."""
    tilts = stiffness[3:, 3:] + (tilt if isinstance(tilt, float) else 0.0) * np.eye(2)
    back = np.linalg.pinv(tilts)
    left, right = np.r_[1.0, -stiffness[1, 3:] @ back], np.r_[1.0, -back @ stiffness[3:, 1]]
    return float(left @ (slope[np.ix_([1, 3, 4], [1, 3, 4])] + by * np.diag([0.0, 1.0, 1.0])) @ right)
