"""From scene and plan to arrays and kernels."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import attrs
import numpy as np

from raceway.bodies.basis import Built
from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import Ellipse
from raceway.core.ring.system import System
from raceway.planning.plan import Plan
from raceway.scene.tables import Scene


@attrs.frozen(eq=False)
class Model:
    """Everything that a run computes with.

    Attributes
    ----------
    geometry : lengths of the row;  inner, outer : load-independent Hertz contacts
    azimuth : (Z,) at time zero, rows one after the other [rad];  guess : (5,) first guess of the equilibrium, with a held axial displacement
    bodies : what the kind of bodies knows beyond that, see ``raceway.bodies``; None for rigid ones
    """

    scene: Scene
    plan: Plan
    geometry: BallBearing
    inner: Ellipse
    outer: Ellipse
    azimuth: np.ndarray
    system: System
    guess: np.ndarray
    bodies: Any = None

    @property
    def excitation(self) -> Any:
        return self.scene.excitation

    @property
    def mass_used(self) -> float:
        """m of K = Re Z + m w^2 [kg]: that of the ring and its share of the rotor; 0 without inertia forces."""
        return float(self.system.mass[1, 1]) if self.scene.integrator.method.inertial else 0.0


def build_model(scene: Scene, plan: Plan) -> Model:
    """Arrays and kernels of a scene, by the builder of its kind of bodies.

    Raises
    ------
    PluginError
        A law that builds parameters of a wrong shape.
    ConvergenceError
        No equilibrium under the axial load whose displacement is to be held.
    """
    kind = "patches" if scene.contact.discretisation == "nodal" and scene.bodies.kind == "condensed" else scene.bodies.kind
    built: Built = import_module(f"raceway.bodies.{kind}.build").build(scene, plan)
    basis = built.basis
    return Model(
        scene, plan, basis.geometry, basis.inner, basis.outer, basis.azimuth, built.system, built.guess, built.bodies
    )
