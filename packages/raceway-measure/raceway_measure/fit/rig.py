"""A bearing in its rig from the 1x response at the sensor: by inversion, and by a fit of free numbers of the scene.

The shaft's answers are linear in unbalance force U, bearing force F and bearing moment M.  The response at the sensor is one complex
equation for F and M; the other says that the bearing, under F and M, tilts as the shaft does.  By inversion the tilt is that of the
scene's bearing (it cannot be seen beside a bearing); the deflection, and so the radial stiffness, is that of the signal.

A fit makes shaft and bearing move together.  The response is one complex number, and the error of its phase is that of the keyphasor:
residuals are those along the measured response and across it, each over its standard error.  Derivatives are central differences of the
balance of shaft and bearing, which is solved to 1e-7: its integrator may be any, and each solution continues the motion before it.
"""

from collections.abc import Sequence

import attrs
import numpy as np
from raceway_rotor.rig_table import Rig, rig_of
from raceway_rotor.shaft import Bearing, Rotor, State, balance, bearing, find_root, rotor

from raceway import ConvergenceError, Result, Scene, SceneError
from raceway.extend import Registry, key_of
from raceway_measure.fit.estimate import COVERAGE, Free, estimate, free_keys, uncertain, with_free
from raceway_measure.fit.fitted import Derived, Fitted, Series, refuse_few
from raceway_measure.fit.shaft_angle import rotation_of
from raceway_measure.fit.signals import Signals, faults_at, recording_of
from raceway_measure.fit.synchronous import RunOut, Synchronous, response_of, synchronous

#: Step of differences over the size of a number: rounding of the balance is 1e-4 of them, and so is their curvature.
_STEP = 1e-3
#: Least standard error of a response over its size: that of the balance.
_LEAST = 1e-6
#: Words in keys that damp a bearing: without a free one C is the scene's, not the signals'.
_DAMPING = ("damping", "time_constant", "loss_factor")


def refuse_no_load(scene: Scene) -> None:
    """``SceneError`` for a bearing without axial load, which has no stiffness to compare with."""
    if scene.load.axial <= 0.0:
        message = "must be the axial load of the measurement, greater than 0: add --set load.axial=..."
        raise SceneError.at("load.axial", scene.load.axial, message)


def invert(shaft: Rotor, bearing: Bearing, sensor: complex) -> State:
    """State of the bearing from the deflection at the sensor [m], its phase against the unbalance.

    ConvergenceError: No moment found at which bearing and shaft tilt alike.
    """

    def force(moment: complex) -> complex:
        return complex((sensor - shaft.at_sensor(0.0, moment)) / shaft.sensor[1])

    def difference(moment: np.ndarray) -> np.ndarray:
        load = force(moment[0])
        return bearing.answer(shaft.speed, load, moment[0])[1:] - shaft.at_ring(load, moment[0])[1:]

    # With the tilts' tangent at rest the difference is linear in the moment.
    step = -shaft.sensor[2] / shaft.sensor[1]
    gain = (bearing.compliance[1] - shaft.ring[1, 1:]) @ np.array([step, 1.0])
    at_zero = bearing.compliance[1, 0] * force(0.0) - shaft.at_ring(force(0.0), 0.0)[1]
    start = np.array([-at_zero / gain])
    size = np.abs(bearing.compliance[1]) @ np.abs([force(start[0]), start[0]])
    (moment,), runs = find_root(difference, start, np.array([[gain]]), np.array([size]))
    return _state(shaft, force(moment), moment, bearing, runs)


def with_tilt_of(shaft: Rotor, state: State, sensor: complex, stiffer: float = 1.0) -> State:
    """State of the bearing by the deflection at the sensor, with the moment over tilt of a state nearby; costs no run.

    stiffer : factor on the moment over tilt; 0 for a bearing that resists no tilt
    """
    # Unknown F, M and slope: sensor, slope of the shaft, and M * slope_0 = stiffer * M_0 * slope.
    matrix = np.array([
        [shaft.sensor[1], shaft.sensor[2], 0.0],
        [shaft.ring[1, 1], shaft.ring[1, 2], -1.0],
        [0.0, state.slope, -stiffer * state.moment],
    ])  # fmt: skip
    scale = np.array([1.0, abs(state.moment / state.force), abs(state.slope / state.force)])
    rows = np.array([abs(shaft.sensor[1]), scale[2], abs(state.slope) * scale[1]])
    right = np.array([sensor - shaft.sensor[0] * shaft.unbalance_force, -shaft.ring[1, 0] * shaft.unbalance_force, 0.0])
    load = scale * np.linalg.solve(matrix * scale / rows[:, None], right / rows)
    return _state(shaft, load[0], load[1], state, 0)


def with_moment(shaft: Rotor, sensor: complex, moment: complex, bearing: State | Bearing) -> State:
    """State of the bearing by the deflection at the sensor under a moment [N m]."""
    force = (sensor - shaft.at_sensor(0.0, moment)) / shaft.sensor[1]
    return _state(shaft, force, moment, bearing, 0)


def _state(shaft: Rotor, force: complex, moment: complex, bearing: State | Bearing, runs: int) -> State:
    deflection, slope = shaft.at_ring(force, moment)
    sensor = shaft.at_sensor(force, moment)
    return State(shaft.speed, force, moment, deflection, slope, sensor, bearing.mass, bearing.coupling, runs)


def changed_rotors(rig: Rig, speed: float) -> dict[str, Rotor]:
    """The rotor with one change of what is taken as known."""
    rigs: dict[str, Rig] = {
        "shaft's diameter +1 %": attrs.evolve(rig, shaft_diameter=1.01 * rig.shaft_diameter),
        "Young's modulus of the shaft +1 %": attrs.evolve(rig, young=1.01 * rig.young),
        "density of shaft and disc +1 %": attrs.evolve(rig, density=1.01 * rig.density),
    }
    hub = 2.0 * (rig.hub_diameter or rig.shaft_diameter)
    if hub <= 2.0 * rig.disc_radius:
        rigs["disc stiffens the shaft (hub twice as thick)"] = attrs.evolve(rig, hub_diameter=hub)
    try:
        farther = attrs.evolve(rig, sensor_distance=rig.sensor_distance + 5e-4)
        rigs["sensor 0.5 mm farther from the bearing"] = farther
    except ValueError:  # it sits at the end already
        rigs["sensor 0.5 mm nearer to the bearing"] = attrs.evolve(rig, sensor_distance=rig.sensor_distance - 5e-4)
    return {change: rotor(other_rig, speed) for change, other_rig in rigs.items()}


@attrs.frozen(eq=False)
class _Balanced:
    """Shaft and bearing in balance, compared with the measured response."""

    state: State  # of the bearing
    #: computed, measured : response at the sensor [m], its size alone without pulses
    computed: complex
    measured: complex
    errors: tuple[float, float]  # standard errors along the measured response and across it [m]


@attrs.frozen(eq=False)
class _Slope:
    """Derivatives by one number: of the weighted residuals (n,), of K [N/m] and C [N s/m] (2,), and of the response [m]."""

    residuals: np.ndarray
    coefficients: np.ndarray
    response: complex


@attrs.define(eq=False)
class RigResiduals:
    """Weighted residuals of the 1x response: ``raceway_measure.fit.estimate.Residuals``."""

    scene: Scene
    rig: Rig
    registry: Registry
    free: Sequence[Free]
    component: Synchronous  # of the record
    run_out: RunOut | Synchronous | None  # the run-out, or the 1x component of a slow roll
    last: _Balanced = attrs.field(init=False)  # at the last numbers
    slopes: list[_Slope] = attrs.field(factory=list, init=False)  # by the free numbers there
    _motion: list[Result] = attrs.field(factory=list, init=False)

    @property
    def count(self) -> int:
        """Numbers in the response: two with pulses, its size without."""
        return 2 if self.component.marked else 1

    def residuals(self, at: np.ndarray) -> np.ndarray:
        self.last = self._balance_at(self.scene, at)
        return self._weigh(self.last.computed - self.last.measured)

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        steps = [_STEP * key.size * axis for key, axis in zip(self.free, np.eye(len(at)), strict=True)]
        self.slopes = [self._slope((self.scene, at - step), (self.scene, at + step), 2.0 * step.sum()) for step in steps]
        return np.column_stack([slope.residuals for slope in self.slopes])

    def uncertain(self, at: np.ndarray) -> dict[str, _Slope]:
        """Cause -> derivatives by its standard error."""
        slopes = {}
        for numbers in uncertain(self.scene, [key.name for key in self.free]):
            path, size = next(iter(numbers.sizes.items()))
            step = min(_STEP * abs(key_of(self.scene, path).value) / size or 1.0, 1.0)
            before, after = ((numbers.moved(self.scene, sign * step), at) for sign in (-1.0, 1.0))
            slopes[numbers.cause] = self._slope(before, after, 2.0 * step)
        return slopes

    def _slope(self, before: tuple[Scene, np.ndarray], after: tuple[Scene, np.ndarray], step: float) -> _Slope:
        """Between two scenes with numbers."""
        low, high = self._balance_at(*before), self._balance_at(*after)
        # Of the run-out, too: the response to the unbalance in a slow roll depends on the bearing.
        column = self._weigh(high.computed - high.measured, low.computed - low.measured) / step
        stiffness, damping = high.state.stiffness - low.state.stiffness, high.state.damping - low.state.damping
        return _Slope(column, np.array([stiffness, damping]) / step, (high.computed - low.computed) / step)

    def _weigh(self, residual: complex, less: complex = 0.0) -> np.ndarray:
        """A difference of two responses along the measured one and across it, over the errors."""
        in_phase = (residual - less) * np.conj(self.last.measured) / abs(self.last.measured)
        along, across = self.last.errors
        return np.array([in_phase.real / along, in_phase.imag / across][: self.count])

    def _balance_at(self, scene: Scene, at: np.ndarray) -> _Balanced:
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
        return _Balanced(state, computed, response.deflection, (float(np.sqrt(both)), float(np.sqrt(across))))

    def notes(self) -> list[str]:
        """Sentences that a reader of the numbers needs."""
        out = ["shaft, unbalance and sensor position of [rig] are taken as exact: their errors are not in the intervals"]
        if not self.component.marked:
            out.append("no mark (`key`): only the amplitude is fitted")
        if self.run_out is None:
            out.append("no run-out was subtracted: give --slow-roll or --run-out")
        return out


def fit_rig(
    signals: Signals, scene: Scene, names: list[str], registry: Registry, run_out: RunOut | Synchronous | None
) -> Fitted:
    """Free keys of a scene from the signals of its rig."""
    rig = rig_of(scene)
    free = free_keys(scene, names)
    for key in free:  # that a rig which whirls in circles does not have
        if key.name.partition(".")[0] in ("excitation", "rotor") and key.name != "rotor.damping":
            message = "is defined by the rig: unbalance and shaft by its table [rig], the speed by the record"
            raise SceneError.at(key.name, None, message)
        if key.name.startswith(("load.radial", "load.moment")):
            raise SceneError.at(key.name, None, "circular whirl of the rig is assumed: radial loads cannot be free")
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
    derivatives = [Derived("K", "N/m", last.state.stiffness, float(halves[0]))]
    if component.marked and any(word in key.name for key in free for word in _DAMPING):
        derivatives.append(Derived("C", "N s/m", last.state.damping, float(halves[1])))
    sensor_signal = last.measured if component.marked else abs(last.measured)
    parts = [("real", np.real), ("imaginary", np.imag)][: problem.count]
    responses = np.array([slope.response for slope in problem.slopes])
    directly = {cause: np.array([[part(slope.response)] for _, part in parts]) for cause, slope in causes.items()}
    series = Series(
        f"line at the sensor ({' and '.join(name for name, _ in parts)} part)", "m", "part", "", np.arange(1.0, len(parts) + 1.0),
        np.array([part(sensor_signal) for _, part in parts]), np.array([part(last.computed) for _, part in parts]),
        np.full(len(parts), answer.widened * last.errors[0]),
        answer.half_widths(np.array([part(responses) for _, part in parts]), directly),
    )  # fmt: skip
    title, notes = f"{scene.title}, {component.speed * 30.0 / np.pi:.1f} r/min", tuple(problem.notes())
    return Fitted(title, signals.source, "rig", True, answer, (series,), tuple(derivatives), notes)
