"""One continuous key of a scene: the systems and boundary-value problems over it.

The model is built anew at each value, about a millisecond for rigid bodies.  Where the systems at both ends and between them
differ by the excitation and by arrays that are linear in the key (loads, gyroscopic terms), only these change.
"""

from typing import Any

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model, build_model
from raceway.core.periodic.collocation import Problem
from raceway.core.periodic.search import problem_of
from raceway.core.periodic.steady import refuse
from raceway.core.periodic.turn import Symmetry, one_turn
from raceway.core.record import Schedule
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.system import System, compiled
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.contracts import Excitation
from raceway.framework.loading.registry import Registry
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.points.base import numbers_at
from raceway.scene.inputs import parse_value, with_value
from raceway.scene.keys import key_of, with_number
from raceway.scene.scene import Scene, scene_from_dict
from raceway.scene.units import number_in
from raceway.storage.tables import Tables

#: Part of the range, between its ends, where nothing special is to be expected.
_BETWEEN = 0.382
#: Problems that are cached: a correction asks for the same three again.
_CACHED = 12
#: Rounding of a part that is linear in the key, over its size.
_ROUNDING = 1e-12
_FORM = "must have the form table.key=first:last, for instance excitation.speed_rpm=500:30000"


def parameter_of(tables: Tables, over: str, registry: Registry) -> "Parameter":
    """The key and its ends of the text ``KEY=first:last``, in a scene that is solved for its steady orbits."""
    key, sign, ends = over.partition("=")
    texts = ends.split(":")
    if not (sign and len(texts) == 2 and "." in key):
        raise SceneError.at("--over", over, _FORM)
    key, tables = key.strip(), with_value(tables, "integrator", {"kind": "periodic"})
    # What has no number yet, as supports.tilt = "free", is read with one; keys of lists have theirs.
    values = [parse_value(text) for text in texts]
    if "[" not in key:
        values = [numbers_at(tables, {key: value}, registry)[key] for value in values]
        tables = with_value(tables, key, values[0])
    scene = scene_from_dict(tables, registry)
    unit = key_of(scene, key).unit
    first, last = (_number(key, value, unit) for value in values)
    if first == last:
        raise SceneError.at(key, over, "has equal ends: there is no branch to follow")
    return Parameter(scene, key, first, last)


def _number(key: str, value: str | float, unit: str) -> float:
    try:
        return number_in(unit, value) if isinstance(value, str) else float(value)
    except (TypeError, ValueError):
        raise SceneError.at(key, value, "is not a number: only continuous keys can be followed") from None


@attrs.define(eq=False)
class Parameter:
    """A key of a scene from ``first`` to ``last``."""

    base: Scene  # the scene, which has a number at the key
    key: str  # a continuous one, such as "load.axial"
    first: float
    last: float
    #: parts of the system that change linearly, where nothing else does but the excitation; None where more changes
    linear: tuple[str, ...] | None = attrs.field(default=None, init=False)
    _ends: tuple[System, System] = attrs.field(init=False)
    _problems: dict[float, Problem] = attrs.field(factory=dict, init=False)

    def __attrs_post_init__(self) -> None:
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
            raise SceneError.at("excitation.kind", excitation.name, "does not repeat every turn: there is no steady orbit")
        model = build_model(scene)
        refuse(model.system, Schedule(excitation.period_s / 36, 36, 1))
        if model.system.scalars[CAGE] != 0.0:
            words = (
                "the ball-pass frequency of orbiting balls differs from that of the force, so K, C and multipliers per turn are undefined: follow the branch "
                "with stationary balls, --set kinematics.orbiting=false. Single values with orbiting balls: `raceway run` or `raceway sweep`"
            )
            raise SceneError.at("kinematics.orbiting", True, words)
        first, between, last = (self._ring_at(p) for p in (self.first, self.value(_BETWEEN), self.last))
        parts = {f.name: tuple(getattr(system, f.name) for system in (first, between, last)) for f in attrs.fields(System)}
        differing = {name: (a, b, c) for name, (a, b, c) in parts.items() if not (_equal(a, b) and _equal(a, c))}
        if not differing:
            raise SceneError.at(self.key, None, "has no effect on the motion: there is no branch over it")
        differing.pop("force_params", None)
        # Arrays between the ends that lie on the line from the first to the last one.
        if all(isinstance(array, np.ndarray) for arrays in differing.values() for array in arrays) and all(
            np.abs((1.0 - _BETWEEN) * a + _BETWEEN * c - b).max(initial=0.0)
            <= _ROUNDING * max(np.abs(a).max(), np.abs(c).max())
            for a, b, c in differing.values()
        ):
            self.linear = tuple(differing)
        self._ends = first, last

    def value(self, part: float) -> float:
        """The key's value at a part of the range, from 0 to 1."""
        return self.first + part * (self.last - self.first)

    def scene(self, p: float) -> Scene:
        return with_number(self.base, self.key, float(p))

    def model(self, p: float) -> Model:
        """Model of the scene at a value of the key."""
        return build_model(self.scene(p))

    def static_state(self, p: float) -> tuple[Model, Equilibrium]:
        """Model and static equilibrium."""
        model = self.model(p)
        return model, solve_equilibrium(model)

    def symmetry(self, q: np.ndarray) -> Symmetry:
        """One ball pitch where forces and bodies allow it everywhere, else one turn; q (5,): the first equilibrium."""
        symmetries = [
            problem_of(self.system(p), 2.0 * np.pi / self.excitation(p).period_s, q).symmetry
            for p in (self.first, self.value(_BETWEEN), self.last)
        ]
        return symmetries[0] if all(symmetry.pitch for symmetry in symmetries) else one_turn(self.system(self.first))

    def excitation(self, p: float) -> Any:
        """Of the scene at a value of the key."""
        return self.scene(p).excitation

    def system(self, p: float, excitation: Excitation | None = None) -> System:
        """The compiled ring at a value of the key, whose excitation may be at hand."""
        if self.linear is None:
            return self._ring_at(p)
        part = (p - self.first) / (self.last - self.first)
        first, last = self._ends
        parts = {name: (1.0 - part) * getattr(first, name) + part * getattr(last, name) for name in self.linear}
        return attrs.evolve(first, force_params=(excitation or self.excitation(p)).parameters(), **parts)

    def problem_at(self, p: float, symmetry: Symmetry) -> Problem:
        """The boundary-value problem at a value of the key; the last ones are cached."""
        problem = self._problems.get(p)
        if problem is None or problem.symmetry is not symmetry:
            try:
                excitation = self.excitation(p)
                problem = Problem(self.system(p, excitation), 2.0 * np.pi / excitation.period_s, symmetry)
            except (SceneError, ValueError) as why:
                raise ConvergenceError(f"no valid scene beyond it ({why})") from why
            if len(self._problems) >= _CACHED:
                self._problems.clear()
            self._problems[p] = problem
        return problem

    def _ring_at(self, p: float) -> System:
        ring = compiled(self.model(p).system)
        assert ring is not None, "refused before"
        return ring


def _equal(first: object, second: object) -> bool:
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        return bool(first.shape == second.shape and np.array_equal(first, second))
    return first is second or first == second
