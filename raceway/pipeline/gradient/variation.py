"""Models of one scene at neighbouring values of a continuous key."""

from __future__ import annotations

import attrs

from raceway.bodies.model import Model, build_model
from raceway.errors import RacewayError
from raceway.framework.duties import same_bodies
from raceway.scene.continuous import Key, with_number
from raceway.scene.tables import Scene

#: First try of a step at a key that is 0, by unit: far below what changes a bearing much.
_TRIED = {"m": 1e-9, "N": 1e-3, "N m": 1e-6, "deg": 1e-4, "r/min": 1e-2, "K": 1e-3, "kg": 1e-6, "s": 1e-9, "N s/m": 1e-3}
_ELSE, _RELATIVE = 1e-9, 1e-6


class NoDerivative(Exception):  # noqa: N818  (an answer, told in the table, no failure)
    """Why a quantity has no derivative by a key, in one sentence."""


@attrs.define
class Variation:
    """One key of a model's scene.

    Attributes
    ----------
    built : models that were built
    """

    model: Model
    key: Key
    built: int = 0

    @property
    def tried(self) -> float:
        """A small first step, in the unit of the key."""
        value = self.key.value
        return _RELATIVE * abs(value) if value else _TRIED.get(self.key.unit, _ELSE)

    def scene(self, step: float) -> Scene:
        """The scene with another number at the key.

        Raises
        ------
        NoDerivative
            The number leaves the key's range, or changes a mesh.
        """
        path, value = self.key.path, self.key.value + step
        try:
            scene = with_number(self.model.scene, path, value)
        except ValueError as why:
            if self.key.value == 0.0:
                raise NoDerivative("is 0, the end of its range: it switches a part on, which is no small change") from None
            raise NoDerivative(f"is at the end of its range: {why}") from None
        if not same_bodies(self.model.scene, scene):
            raise NoDerivative(
                "changes the meshes of the bodies: the difference of two meshes is their error, no derivative. "
                "bodies.kind = 'rigid' has one"
            )
        return scene

    def at(self, step: float) -> Model:
        """Its model; the plan stays.

        Raises
        ------
        NoDerivative
            As ``scene``, or no model can be built of it.
        """
        scene = self.scene(step)
        self.built += 1
        try:
            return build_model(scene, self.model.plan)
        except RacewayError as why:
            raise NoDerivative(f"no model can be built at {self.key.value + step:.6g}: {why}") from None
