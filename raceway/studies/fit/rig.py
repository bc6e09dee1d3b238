"""Fit to the signals of a rig: the 1x response at its sensor by shaft and bearing together, as the free numbers make the bearing.

Notes
-----
The response is one complex number, and the error of its phase is that of the keyphasor: residuals are those along the measured response
and across it, each over its standard error.  Derivatives are central differences of the balance of shaft and bearing, which is solved
to 1e-7: its integrator may be any, and each solution continues the motion of the one before.
"""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.scene.continuous import key_of
from raceway.scene.reading import rig_of
from raceway.scene.rig import Rig
from raceway.scene.scene import Scene
from raceway.studies.fit.estimate import COVERAGE, Free, estimate, free_keys, uncertain, with_free
from raceway.studies.fit.fit import Derived, Fitted, Series, refuse_few
from raceway.studies.fit.identify import refuse_no_load
from raceway.studies.fit.shaft_angle import rotation_of
from raceway.studies.fit.signals import Signals, faults_at, recording_of
from raceway.studies.fit.synchronous import RunOut, Synchronous, response_of, synchronous
from raceway.studies.shaft.bearing import State, balance, bearing
from raceway.studies.shaft.rotor import rotor

#: Step of differences over the size of a number: rounding of the balance is 1e-4 of them, and so is their curvature.
_STEP = 1e-3
#: Least standard error of a response over its size: that of the balance.
_LEAST = 1e-6
#: Words in keys that damp a bearing: without a free one C is the scene's, not the signals'.
_DAMPING = ("damping", "time_constant", "loss_factor")


@attrs.frozen(eq=False)
class Balanced:
    """Shaft and bearing in balance, compared with the measured response.

    Attributes
    ----------
    state : of the bearing;  computed, measured : response at the sensor [m], its size alone without pulses
    errors : standard errors along the measured response and across it [m]
    """

    state: State
    computed: complex
    measured: complex
    errors: tuple[float, float]


@attrs.frozen(eq=False)
class Slope:
    """Derivatives by one number: of the weighted residuals (n,), of K [N/m] and C [N s/m] (2,), and of the response [m]."""

    residuals: np.ndarray
    coefficients: np.ndarray
    response: complex


@attrs.define(eq=False)
class RigResiduals:
    """Weighted residuals of the 1x response: ``raceway.studies.fit.estimate.Residuals``.

    Attributes
    ----------
    component : of the record;  run_out : the run-out, or the 1x component of a slow roll
    last : at the last numbers;  slopes : by the free numbers there
    """

    scene: Scene
    rig: Rig
    registry: Registry
    free: Sequence[Free]
    component: Synchronous
    run_out: RunOut | Synchronous | None
    last: Balanced = attrs.field(init=False)
    slopes: list[Slope] = attrs.field(factory=list, init=False)
    _motion: list[Result] = attrs.field(factory=list, init=False)

    @property
    def count(self) -> int:
        """Numbers in the response: two with pulses, its size without."""
        return 2 if self.component.marked else 1

    def residuals(self, at: np.ndarray) -> np.ndarray:
        self.last = self._balanced(self.scene, at)
        return self._weighted(self.last.computed - self.last.measured)

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        steps = [_STEP * key.size * axis for key, axis in zip(self.free, np.eye(len(at)), strict=True)]
        self.slopes = [self._slope((self.scene, at - step), (self.scene, at + step), 2.0 * step.sum()) for step in steps]
        return np.column_stack([slope.residuals for slope in self.slopes])

    def uncertain(self, at: np.ndarray) -> dict[str, Slope]:
        """Cause -> derivatives by its standard error."""
        slopes = {}
        for numbers in uncertain(self.scene, [key.name for key in self.free]):
            path, size = next(iter(numbers.sizes.items()))
            step = min(_STEP * abs(key_of(self.scene, path).value) / size or 1.0, 1.0)
            before, after = ((numbers.moved(self.scene, sign * step), at) for sign in (-1.0, 1.0))
            slopes[numbers.cause] = self._slope(before, after, 2.0 * step)
        return slopes

    def _slope(self, before: tuple[Scene, np.ndarray], after: tuple[Scene, np.ndarray], step: float) -> Slope:
        """Between two scenes with numbers."""
        low, high = self._balanced(*before), self._balanced(*after)
        # Of the run-out, too: the response to the unbalance in a slow roll depends on the bearing.
        column = self._weighted(high.computed - high.measured, low.computed - low.measured) / step
        stiffness, damping = high.state.stiffness - low.state.stiffness, high.state.damping - low.state.damping
        return Slope(column, np.array([stiffness, damping]) / step, (high.computed - low.computed) / step)

    def _weighted(self, residual: complex, less: complex = 0.0) -> np.ndarray:
        """A difference of two responses along the measured one and across it, over the errors."""
        rotated = (residual - less) * np.conj(self.last.measured) / abs(self.last.measured)
        along, across = self.last.errors
        return np.array([rotated.real / along, rotated.imag / across][: self.count])

    def _balanced(self, scene: Scene, at: np.ndarray) -> Balanced:
        """The rig with the bearing of such numbers, and the measured response less the run-out that this bearing leaves."""
        scene = with_free(scene, self.free, at)
        tested = bearing(scene, scene.load.axial, self.registry)
        response = response_of(self.component, self.rig, tested, self.run_out)
        shaft = rotor(self.rig, self.component.speed)
        following = attrs.evolve(tested, last=list(self._motion))
        try:
            state = balance(shaft, following)
        except ConvergenceError:
            if not self._motion:
                raise
            following = tested  # the motion before leads to none
            state = balance(shaft, following)
        self._motion[:] = following.last
        # Noise, slow roll, window, and across the response the angle of the pulses.
        window = abs(response.fourier - response.deflection) / COVERAGE
        noise = 0.5 * (self.component.error**2 + response.run_out.error**2 + window**2)
        both = noise + (_LEAST * abs(response.deflection)) ** 2
        across = both + (self.component.angle_error * abs(self.component.forward) / COVERAGE) ** 2
        computed = state.sensor if self.component.marked else abs(state.sensor)
        return Balanced(state, computed, response.deflection, (float(np.sqrt(both)), float(np.sqrt(across))))

    def notes(self) -> list[str]:
        """Sentences that a reader of the numbers needs."""
        out = [
            "shaft, unbalance and sensor's place of [rig] are taken as known: what they are off by is no part of the intervals"
        ]
        if not self.component.marked:
            out.append("no mark (`key`): the line's size alone is fitted")
        if self.run_out is None:
            out.append("no run-out was subtracted: give --slow-roll or --run-out")
        return out


def fit_rig(
    signals: Signals, scene: Scene, names: list[str], registry: Registry, run_out: RunOut | Synchronous | None
) -> Fitted:
    """Free keys of a scene from the signals of its rig.

    Raises
    ------
    SceneError, ConvergenceError
        The fault of signals, keys or scene; no motion like the measured one, or no convergence of the search.
    """
    rig = rig_of(scene)
    free = free_keys(scene, names)
    _refuse_across(free)
    if not any(key.name == "load.axial" for key in free):
        refuse_no_load(scene)
    with faults_at(signals.source):
        component = synchronous(rotation_of(recording_of(signals)))
        problem = RigResiduals(scene, rig, registry, free, component, run_out)
        refuse_few(problem.count, len(free), signals.source)
        answer = estimate(problem, free, stated=True)
    problem.residuals(answer.values)
    last, causes = problem.last, problem.uncertain(answer.values)
    for cause, slope in causes.items():
        answer = answer.with_shifts(cause, slope.residuals[:, None])
    slopes = np.array([slope.coefficients for slope in problem.slopes]).T
    halves = answer.half_widths(slopes, {cause: slope.coefficients[:, None] for cause, slope in causes.items()})
    derived = [Derived("K", "N/m", last.state.stiffness, float(halves[0]))]
    if component.marked and any(word in key.name for key in free for word in _DAMPING):
        derived.append(Derived("C", "N s/m", last.state.damping, float(halves[1])))
    measured = last.measured if component.marked else abs(last.measured)
    parts = [("real", np.real), ("imaginary", np.imag)][: problem.count]
    responses = np.array([slope.response for slope in problem.slopes])
    directly = {cause: np.array([[part(slope.response)] for _, part in parts]) for cause, slope in causes.items()}
    series = Series(
        f"line at the sensor ({' and '.join(name for name, _ in parts)} part)", "m", "part", "", np.arange(1.0, len(parts) + 1.0),
        np.array([part(measured) for _, part in parts]), np.array([part(last.computed) for _, part in parts]),
        np.full(len(parts), answer.widened * last.errors[0]),
        answer.half_widths(np.array([part(responses) for _, part in parts]), directly),
    )  # fmt: skip
    title, notes = f"{scene.title}, {component.speed * 30.0 / np.pi:.1f} r/min", tuple(problem.notes())
    return Fitted(title, signals.source, "rig", True, answer, (series,), tuple(derived), notes)


def _refuse_across(free: Sequence[Free]) -> None:
    """Keys that a rig which whirls in circles does not have.

    Raises
    ------
    SceneError
        Naming the key.
    """
    for key in free:
        if key.name.partition(".")[0] in ("excitation", "rotor") and key.name != "rotor.damping":
            message = "is the rig's: its table [rig] says unbalance and shaft, and the record the speed"
            raise SceneError.at(key.name, None, message)
        if key.name.startswith(("load.radial", "load.moment")):
            message = "the rig is taken to whirl in circles: no load across its axis can be free"
            raise SceneError.at(key.name, None, message)
