"""From scene and plan to arrays and kernels."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from raceway.bodies.basis import Basis
from raceway.bodies.bearing import Bearing
from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import Ellipse
from raceway.core.ring.ring import Ring
from raceway.errors import PluginError
from raceway.framework.contracts import Traits
from raceway.planning.plan import Plan
from raceway.scene.tables import Scene


@attrs.frozen(eq=False)
class Model:
    """Everything that a run computes with.

    Attributes
    ----------
    bearing : what was built of the bodies;  system : its ring, or a copy at another speed
    """

    scene: Scene
    plan: Plan
    bearing: Bearing
    system: Ring

    @property
    def basis(self) -> Basis:
        return self.bearing.basis

    @property
    def geometry(self) -> BallBearing:
        """Lengths of the row."""
        return self.basis.geometry

    @property
    def inner(self) -> Ellipse:
        """Load-independent Hertz contact of the inner race."""
        return self.basis.inner

    @property
    def outer(self) -> Ellipse:
        """Load-independent Hertz contact of the outer race."""
        return self.basis.outer

    @property
    def azimuth(self) -> np.ndarray:
        """(Z,) at time zero, rows one after the other [rad]."""
        return self.basis.azimuth

    @property
    def guess(self) -> np.ndarray:
        """(5,) first guess of the equilibrium, with a held axial displacement."""
        return self.bearing.guess

    @property
    def excitation(self) -> Any:
        return self.scene.excitation

    @property
    def traits(self) -> Traits:
        """Of the bodies in this scene."""
        traits: Traits = self.scene.bodies.traits(self.scene)
        return traits

    @property
    def mass_used(self) -> float:
        """m of K = Re Z + m w^2 [kg]: that of the ring and its share of the rotor; 0 without inertia forces."""
        return float(self.system.mass[1, 1]) if self.scene.integrator.method.inertial else 0.0


def build_model(scene: Scene, plan: Plan) -> Model:
    """Arrays and kernels of a scene, by its kind of bodies.

    Raises
    ------
    PluginError
        A law that builds parameters of a wrong shape, or bodies that build no bearing.
    ConvergenceError
        No equilibrium under the axial load whose displacement is to be held.
    """
    bearing = scene.bodies.build(scene, plan)
    if not isinstance(bearing, Bearing):
        raise PluginError(
            f"bodies '{scene.bodies.name}': build() returned {type(bearing).__name__}; it must be a raceway.bodies.bearing.Bearing"
        )
    return Model(scene, plan, bearing, bearing.system)
