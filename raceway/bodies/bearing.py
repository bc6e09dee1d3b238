"""What the pipeline asks of a bearing that was built, whatever its bodies are made of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.basis import Basis
from raceway.core.ring.system import System

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model

#: A number and how it was found, or None and why there is none.
Told = tuple[float | None, str]


@attrs.frozen(eq=False)
class Bearing(ABC):
    """A bearing of one kind of bodies.

    Attributes
    ----------
    basis : geometry and contacts that do not depend on loads
    system : the ring on its balls
    guess : (5,) first guess of the equilibrium, with a held axial displacement
    """

    basis: Basis
    system: System
    guess: np.ndarray

    def settle(self, near: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, int]:
        """Displacement (5,), balls (Z, k) and iterations at the equilibrium under the constant loads.

        Parameters
        ----------
        near : (5,) equilibrium of a similar bearing, for bodies whose equilibria take long

        Raises
        ------
        ConvergenceError
            None was found.
        """
        return self.system.settle(self.guess)

    @property
    def foreseen(self) -> System | None:
        """A system that shows in milliseconds what nothing holds; None where the own equilibrium does."""
        return None

    def has_places(self, balls: str) -> bool:
        """Whether ``ball[:, :2]`` are the balls' places; False where they lie between the groove centres.

        Parameters
        ----------
        balls : the plan's "weightless", "inertial" or "tangential"
        """
        return balls != "weightless"

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,)."""
        return {}

    def report(self, model: Model, equilibrium: Equilibrium) -> dict[str, Any]:
        """The table ``model`` of result.json; empty where there is nothing to tell."""
        return {}

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """What a user should know of the bodies at the equilibrium."""
        return []

    @abstractmethod
    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Relative error of the stiffness or displacement by the bodies' meshes."""

    @abstractmethod
    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Relative error of loaded contacts by their law or its calibration; some contact is loaded."""
