"""All derivatives of one result, key by key."""

from __future__ import annotations

from functools import cached_property

import attrs

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.errors import SceneError
from raceway.pipeline.gradient.motion import MotionGradient, SteadyOrbit
from raceway.pipeline.gradient.statics import StaticGradient, static_gradient
from raceway.pipeline.gradient.variation import NoDerivative
from raceway.scene.continuous import Key, key_of


@attrs.frozen(eq=False)
class Gradient:
    """Derivatives by one key: of the equilibrium, and of the steady orbit where the scene has an excitation."""

    statics: StaticGradient
    motion: MotionGradient | None

    @property
    def nothing(self) -> bool:
        """Whether the key changes nothing at all."""
        return self.statics.step == 0.0 and (self.motion is None or self.motion.nothing)


@attrs.frozen(eq=False)
class Gradients:
    """Derivatives of an equilibrium, and of the steady orbit about it.

    Raises
    ------
    SceneError
        Bodies whose contacts are pressures at surface points, or are not compiled.
    """

    model: Model
    equilibrium: Equilibrium

    def __attrs_post_init__(self) -> None:
        traits = self.model.traits
        if not (traits.compiled and traits.resultants):
            why = "surface points open and close one by one: their forces have no derivative. Take contact.discretisation = 'resultant'"
            raise SceneError.at("bodies.kind", self.model.scene.bodies.name, f"{why} on rigid or condensed bodies")

    @cached_property
    def orbit(self) -> SteadyOrbit | None:
        """The steady orbit, searched for once; None in a static scene.

        Raises
        ------
        SceneError, ConvergenceError
            The force has none, or none was found.
        """
        return None if self.model.excitation is None else SteadyOrbit.of(self.model, self.equilibrium)

    def by(self, key: Key) -> Gradient:
        """By one key.

        Raises
        ------
        NoDerivative
            There is none, with the reason.
        """
        statics = static_gradient(self.model, self.equilibrium, key)
        return Gradient(statics, None if self.orbit is None else self.orbit.gradient(statics))

    def by_path(self, path: str) -> Gradient:
        """By the key of a path, such as "load.axial".

        Raises
        ------
        SceneError
            No continuous key, or one without a derivative.
        """
        try:
            return self.by(key_of(self.model.scene, path))
        except NoDerivative as why:
            raise SceneError.at(path, None, str(why)) from None
