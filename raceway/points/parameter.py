"""One continuous key of a scene: the systems and boundary-value problems over it.

Notes
-----
The model is built anew at each value, about a millisecond for rigid bodies.  Where the systems at both ends and between them
differ by the excitation and by arrays that are linear in the key (loads, gyroscopic terms), only these change.
"""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.core.periodic.collocation import Problem, Symmetry, one_turn
from raceway.core.periodic.search import problem_of
from raceway.core.periodic.steady import refuse
from raceway.core.record import Schedule
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.system import System, by_address, compiled
from raceway.errors import ConvergenceError, SceneError
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.continuous import with_number
from raceway.scene.scene import Scene

#: A place between the ends where nothing special is to be expected.
_BETWEEN = 0.382
#: Problems that are kept: a correction asks for the same three again.
_KEPT = 12
#: Rounding of a part that is linear in the key, over its size.
_ROUNDING = 1e-12


@attrs.define(eq=False)
class Parameter:
    """A key of a scene from ``first`` to ``last``.

    Attributes
    ----------
    whole : the scene, which has a number at the key;  key : a continuous one, such as "load.axial"
    linear : parts of the system that change linearly, where nothing else does but the excitation; None where more changes
    """

    whole: Scene
    key: str
    first: float
    last: float
    linear: tuple[str, ...] | None = attrs.field(default=None, init=False)
    _ends: tuple[System, System] = attrs.field(init=False)
    _kept: dict[float, Problem] = attrs.field(factory=dict, init=False)

    def __attrs_post_init__(self) -> None:
        self._check()
        one, between, two = (self._built(p) for p in (self.first, self.value(_BETWEEN), self.last))
        differing = [
            field.name
            for field in attrs.fields(System)
            if not (
                _same(*(getattr(s, field.name) for s in (one, between)))
                and _same(*(getattr(s, field.name) for s in (one, two)))
            )
        ]
        if not differing:
            raise SceneError.at(self.key, None, "changes nothing of the motion: there is no branch over it")
        differing.remove("force_params") if "force_params" in differing else None
        if all(_linear(*(getattr(system, name) for system in (one, between, two))) for name in differing):
            self.linear = tuple(differing)
        self._ends = one, two

    def value(self, part: float) -> float:
        """The key's value at a part of the range, from 0 to 1."""
        return self.first + part * (self.last - self.first)

    def scene(self, p: float) -> Scene:
        return with_number(self.whole, self.key, float(p))

    def model(self, p: float) -> Model:
        """Model of the scene at a value of the key."""
        scene = self.scene(p)
        return build_model(scene, make_plan(scene))

    def settled(self, p: float) -> tuple[Model, Equilibrium]:
        """Model and static equilibrium."""
        model = self.model(p)
        return model, settle(model)

    def symmetry(self, q: np.ndarray) -> Symmetry:
        """One ball pitch where forces and bodies allow it everywhere, else one turn; q (5,): the first equilibrium."""
        found = [self._symmetry(p, q) for p in (self.first, self.value(_BETWEEN), self.last)]
        return found[0] if all(one.pitch for one in found) else one_turn(self.system(self.first))

    def _symmetry(self, p: float, q: np.ndarray) -> Symmetry:
        return problem_of(self.system(p), 2.0 * np.pi / self.excitation(p).period_s, q).symmetry

    def excitation(self, p: float) -> Any:
        """Of the scene at a value of the key."""
        return self.scene(p).excitation

    def system(self, p: float) -> System:
        """The compiled ring at a value of the key."""
        return self._system(p, self.excitation(p))

    def _system(self, p: float, excitation: Any) -> System:
        if self.linear is None:
            return self._built(p)
        part = (p - self.first) / (self.last - self.first)
        one, two = self._ends
        changed = {name: (1.0 - part) * getattr(one, name) + part * getattr(two, name) for name in self.linear}
        return attrs.evolve(one, force_params=excitation.parameters(), **changed)

    def problem_at(self, p: float, symmetry: Symmetry) -> Problem:
        """The boundary-value problem at a value of the key; the last ones are kept."""
        found = self._kept.get(p)
        if found is None or found.symmetry is not symmetry:
            try:
                excitation = self.excitation(p)
                found = Problem(self._system(p, excitation), 2.0 * np.pi / excitation.period_s, symmetry)
            except (SceneError, ValueError) as why:
                raise ConvergenceError(f"beyond it there is no scene ({why})") from why
            if len(self._kept) >= _KEPT:
                self._kept.clear()
            self._kept[p] = found
        return found

    def _built(self, p: float) -> System:
        ring = compiled(self.model(p).system)
        assert ring is not None, "refused before"
        return by_address(ring)

    def _check(self) -> None:
        """Refuse ranges that leave what the key allows, and scenes without a steady orbit."""
        for p in (self.first, self.last):
            try:
                scene = self.scene(p)
            except ValueError as why:
                over = f"{self.first:g}:{self.last:g}"
                raise SceneError.at(self.key, p, f"{why} (followed over every value of {over})") from None
        excitation = scene.excitation
        if excitation is None:
            raise SceneError.at("excitation", None, "is missing: there is no motion to follow")
        if excitation.period_s is None:
            raise SceneError.at(
                "excitation.kind", excitation.name, "does not repeat itself every turn: there is no steady orbit"
            )
        model = build_model(scene, make_plan(scene))
        refuse(model.system, Schedule(excitation.period_s / 36, 36, 1))
        if model.system.scalars[CAGE] != 0.0:
            words = (
                "balls that orbit pass at a frequency of their own, so that K, C and multipliers belong to no whole turns of the force: "
                "the branch is followed for balls that stand, --set kinematics.orbiting=false. Single values with orbiting balls: "
                "`raceway run` or `raceway sweep`"
            )
            raise SceneError.at("kinematics.orbiting", True, words)


def _same(one: object, two: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(two, np.ndarray):
        return bool(one.shape == two.shape and np.array_equal(one, two))
    return one is two or one == two


def _linear(one: object, between: object, two: object) -> bool:
    """Whether an array at a place between lies on the line from the first to the last one."""
    if not (isinstance(one, np.ndarray) and isinstance(between, np.ndarray) and isinstance(two, np.ndarray)):
        return False
    there = (1.0 - _BETWEEN) * one + _BETWEEN * two
    return bool(np.abs(there - between).max(initial=0.0) <= _ROUNDING * max(np.abs(one).max(), np.abs(two).max()))
