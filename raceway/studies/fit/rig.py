"""The rig's 1x line at its sensor beside a record of it: shaft and bearing together, as the free numbers make the bearing.

Notes
-----
The line is one complex number, and the phase of its error is the mark's: residuals are those along the line and across it, each over
its standard error.  Derivatives are central differences of the balance of shaft and bearing, which is solved to 1e-7: its
integrator may be any, and each solution continues the motion of the one before.
"""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.scene.continuous import key_of, with_number
from raceway.scene.rig import Rig
from raceway.scene.scene import Scene
from raceway.studies.fit.estimate import Free, uncertain
from raceway.studies.fit.identification import refuse_no_load, seen
from raceway.studies.fit.shaft_angle import turning
from raceway.studies.fit.signals import Recording
from raceway.studies.fit.synchronous import Order, RunOut, order
from raceway.studies.fit.table import COVERAGE
from raceway.studies.shaft.bearing import State, balance, bearing
from raceway.studies.shaft.rotor import rotor

#: Step of differences over the size of a number: rounding of the balance is 1e-4 of them, and so is their curvature.
_STEP = 1e-3
#: Least standard error of a line over its size: that of the balance.
_LEAST = 1e-6


@attrs.define(eq=False)
class RigLine:
    """Weighted residuals of the line: ``raceway.studies.fit.estimate.Residuals``.

    Attributes
    ----------
    found : line of the record;  known, slow : run-out, or the slow roll that shows it
    state : at the last numbers;  slopes : of K [N/m] and C [N s/m] by the free numbers there (2, p), and of the line (p,)
    """

    scene: Scene
    rig: Rig
    registry: Registry
    free: Sequence[Free]
    found: Order
    known: RunOut | None
    slow: Order | None
    state: State | None = None
    line: complex = 0.0
    errors: tuple[float, float] = (0.0, 0.0)
    slopes: np.ndarray = attrs.field(factory=lambda: np.empty((2, 0)))
    line_slopes: np.ndarray = attrs.field(factory=lambda: np.empty(0))
    _last: list[Result] = attrs.field(factory=list, init=False)

    @classmethod
    def of(
        cls,
        recording: Recording,
        scene: Scene,
        rig: Rig,
        registry: Registry,
        free: Sequence[Free],
        known: RunOut | None,
        slow: Order | None,
    ) -> RigLine:
        """Of a record.

        Raises
        ------
        RacewayError
            A record that cannot be used.
        """
        if not any(one.name == "load.axial" for one in free):
            refuse_no_load(scene)
        return cls(scene, rig, registry, free, order(turning(recording)), known, slow)

    @property
    def count(self) -> int:
        """Numbers that the record tells: with a mark two, without its size."""
        return 2 if self.found.marked else 1

    def residuals(self, at: np.ndarray) -> np.ndarray:
        self.state = self._balanced(at)
        return self._whitened(self.state.sensor if self.found.marked else abs(self.state.sensor), self.line)

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        steps = [_STEP * one.size * along for one, along in zip(self.free, np.eye(len(at)), strict=True)]
        found = [self._difference((self.scene, at - step), (self.scene, at + step), 2.0 * step.sum()) for step in steps]
        columns, slopes, lines = zip(*found, strict=True)
        self.slopes, self.line_slopes = np.array(slopes).T, np.array(lines)
        return np.column_stack(columns)

    def uncertain(self, at: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray, complex]]:
        """Cause -> what a standard error of it moves residuals (n,), K and C (2,) and the line by."""
        found = {}
        for one in uncertain(self.scene, [key.name for key in self.free]):
            path, size = next(iter(one.sizes.items()))
            step = min(_STEP * abs(key_of(self.scene, path).value) / size or 1.0, 1.0)
            before, after = ((one.moved(self.scene, sign * step), at) for sign in (-1.0, 1.0))
            found[one.cause] = self._difference(before, after, 2.0 * step)
        return found

    def _difference(
        self, before: tuple[Scene, np.ndarray], after: tuple[Scene, np.ndarray], over: float
    ) -> tuple[np.ndarray, np.ndarray, complex]:
        """Of residuals (n,), of K and C (2,) and of the line between two scenes with numbers, over a step."""
        kept, ends = (self.state, self.line, self.errors), []
        for scene, at in (before, after):
            state = self._balanced(at, scene)
            ends.append((state, self.line, state.sensor if self.found.marked else abs(state.sensor)))
        self.state, self.line, self.errors = kept
        (less, under, low), (more, line, high) = ends
        # Of the run-out, too: what the unbalance does in a slow roll depends on the bearing.
        column = self._whitened(high - line, low - under) / over
        slopes = np.array([more.stiffness - less.stiffness, more.damping - less.damping]) / over
        return column, slopes, (high - low) / over

    def notes(self) -> tuple[str, ...]:
        """What a reader of the numbers should know."""
        out = [
            "shaft, unbalance and sensor's place of [rig] are taken as known: what they are off by is no part of the intervals"
        ]
        if not self.found.marked:
            out.append("no mark (`key`): the line's size alone is fitted")
        if self.known is None and self.slow is None:
            out.append("no run-out was subtracted: give --slow-roll or --run-out")
        return tuple(out)

    def _whitened(self, one: complex, other: complex) -> np.ndarray:
        """Difference of two lines along the measured one and across it, over the errors."""
        apart = (one - other) * np.conj(self.line) / abs(self.line)
        along, across = self.errors
        return np.array([apart.real / along, apart.imag / across][: self.count])

    def _balanced(self, at: np.ndarray, scene: Scene | None = None) -> State:
        """State of the rig with a bearing of such numbers; the line and its errors, less the run-out that it leaves."""
        scene = scene or self.scene
        for one, value in zip(self.free, at, strict=True):
            try:
                scene = with_number(scene, one.name, float(value))
            except ValueError as why:
                raise SceneError.at(one.name, float(value), str(why)) from None
        held = bearing(scene, scene.load.axial, self.registry)
        there = seen(self.found, self.rig, held, self.known, self.slow)
        self.line, self.errors = there.line, self._errors(there.run_out.error, abs(there.fourier - there.line))
        line = rotor(self.rig, self.found.speed)
        following = attrs.evolve(held, last=list(self._last))
        try:
            state = balance(line, following)
        except ConvergenceError:
            if not self._last:
                raise
            following = held  # the motion before leads to none
            state = balance(line, following)
        self._last[:] = following.last
        return state

    def _errors(self, run_out: float, window: float) -> tuple[float, float]:
        """Standard errors along the line and across it [m]: scatter, slow roll, window, and across it the marks."""
        both = 0.5 * (self.found.error**2 + run_out**2 + (window / COVERAGE) ** 2) + (_LEAST * abs(self.line)) ** 2
        across = both + (self.found.doubt * abs(self.found.line) / COVERAGE) ** 2
        return float(np.sqrt(both)), float(np.sqrt(across))


def refuse_across(scene: Scene, free: Sequence[Free]) -> None:
    """Keys that a rig which whirls in circles has not.

    Raises
    ------
    SceneError
        Naming the key.
    """
    for one in free:
        table = one.name.partition(".")[0]
        if table in ("excitation", "rotor") and one.name != "rotor.damping":
            raise SceneError.at(
                one.name, None, "is the rig's: its table [rig] says unbalance and shaft, and the record the speed"
            )
        if one.name.startswith(("load.radial", "load.moment")):
            raise SceneError.at(one.name, None, "the rig is taken to whirl in circles: no load across its axis can be free")
