"""What a transient and the start of a motion do to Z: its distance from the steady motion, its free vibration, another start.

Notes
-----
The motion that a transient would settle on is solved for where that can be done: its Z has no transient and no time step in it.

What has not died out of a transient is a free vibration, beside the lines of the excitation.  Its leakage into the 1x line
falls with 1 / turns for a plain mean over whole turns and with 1 / turns^3 under Hann's window, so that the difference of
both is the leakage of the plain one.

Over a single turn of period T a free vibration f'' = -n^2 f leaves (2 / T) [f' + j w f] / (w^2 - n^2) in the 1x line, the
bracket being what the turn does not close by.

A free vibration within two lines of 1x, of 1 / turns each, is not told from it by the window: the response beats, and both
halves of the turns have different lines under it.

A free vibration that goes on shifts the secant stiffness itself.  A force k r (1 + c |r|^2) with a forced circle a and a
free vibration of mean square b^2 answers at 1x with k (1 + c (a^2 + 2 b^2)) (no other term of |r|^2 r has this frequency):
with s = 2 b^2 / a^2 the free vibration makes s / (1 + s) of the difference between this secant stiffness and the tangent.

With friction a motion remembers how it began.  Where a contact sticks follows from the slip before, which no damping takes back: two
starts under one force end on two steady motions.  Their distance is no transient that dies out, and no window over the turns of one
of them sees it.  A further run begins otherwise, with the steps of the one that is made for the error of the time step: equal steps
err alike.  Free vibrations, which each run states as its own error, are taken from both.  The orbit without friction and the motions
from rest are furthest apart; a growing force leaves the least free vibration.

Of a run-up the distance of each window from the steady motion at its speed is its error: free vibrations, an amplitude that lags
behind, and the steps in time are in it.  Where no such motion can be solved for, it is the identifier's own error of the window, plus
that of the time step.

References
----------
Harris, Proc. IEEE 66 (1978), 51 (windows); Nayfeh, Mook, Nonlinear Oscillations (1979), section 4.3 (cubic terms).
"""

from __future__ import annotations

from math import pi
from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.core.record import Motion, Record, Schedule
from raceway.core.signals import Identification, fourier_line, stiffness, without_drift
from raceway.errors import BeyondPlanError, ConvergenceError, SceneError, StabilityError
from raceway.framework.estimate import Estimate, Note
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress, Simulation, simulate
from raceway.planning.steady_orbits import compares_with_steady_motion, remembers_its_start
from raceway.plugins.identifiers import Tangent, whole_turns
from raceway.storage.tables import Tables

#: Samples of the steady turn, and the error of its displacement over its amplitude.
_SAMPLES, _TOLERANCE = 360, 1e-8
#: Speeds in a row without a steady motion after which none is searched for.
_GIVEN_UP = 3
#: Two turns that differ by less than this share of their distance from the steady motion repeat each other.
_REPEATS = 0.01


def settled_value(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    found: Identification,
    steady: Settled,
    on_progress: OnProgress | None = None,
) -> complex | None:
    """Z [N/m] that the scene's identifier finds in steady motions instead of the recorded ones.

    Parameters
    ----------
    motions : model and motion of each speed
    found : what was identified in them; of a speed that changes, the steady motion at the speed of its Z counts
    steady : motions of an excitation that changes its speed
    on_progress : called in the search, which what it raises ends

    Returns
    -------
    complex or None
        None where a steady motion cannot be solved for (friction, laws with memory, bodies that are stepped from Python), is
        not found, or is another one than the transient settles on.
    """
    if model.excitation.period_s is None:
        # The windows before lead to that one's motion, where several exist.
        for speed, _ in found.series[:-1]:
            steady.value(speed, on_progress)
        return steady.value(found.speed, on_progress)
    records = []
    for one, motion in motions:
        settled = steady_record(one, equilibrium if one is model else settle(one), motion, on_progress)
        if settled is None or settles_elsewhere(one, motion, settled):
            return None
        records.append(settled)
    return model.scene.identifier.method.identify(records, equilibrium, model).dynamic_stiffness


@attrs.define
class Settled:
    """Steady motions of an excitation that changes its speed, speed by speed; each is solved for once.

    Attributes
    ----------
    values : Z [N/m] by speed [rad/s]
    last : the motion at the last speed; where several exist, the next one continues it, as the motion that is integrated does
    missed : speeds in a row without a motion; after some, none is searched for
    """

    model: Model
    values: dict[float, complex | None] = attrs.field(factory=dict)
    last: Record | None = None
    missed: int = 0

    def value(self, speed: float, on_progress: OnProgress | None = None) -> complex | None:
        """Z [N/m] at one speed [rad/s]; None where there is no motion that can be solved for, or none is found."""
        if speed not in self.values:
            self.values[speed] = self._solved(speed, on_progress)
        return self.values[speed]

    def _solved(self, speed: float, on_progress: OnProgress | None) -> complex | None:
        one = _at_speed(self.model, speed)
        if one is None or self.missed >= _GIVEN_UP:
            return None
        near = None if self.last is None else self.last.solution
        record = _steady(one, settle(one), near, on_progress)
        self.missed = self.missed + 1 if record is None else 0
        if record is None:
            return None
        self.last = record
        frequency = one.excitation.frequency_hz
        return stiffness(*(fourier_line(record.time, part, frequency) for part in (record.force, record.displacement)))


def _at_speed(model: Model, speed: float) -> Model | None:
    """The same scene at one speed [rad/s], of an excitation that tells what it is there."""
    begun = getattr(model.excitation, "steady", None)
    if begun is None:
        return None
    scene = attrs.evolve(model.scene, excitation=attrs.evolve(begun(), speed_rpm=speed * 30.0 / pi))
    return build_model(scene, model.plan)


def steady_record(
    model: Model, equilibrium: Equilibrium, motion: Simulation | None = None, on_progress: OnProgress | None = None
) -> Record | None:
    """One turn of the steady motion; None where there is none that can be solved for, or none is found.

    Parameters
    ----------
    motion : that settles on it: where several exist, the one near its last turn is taken
    on_progress : called in the search, which what it raises ends
    """
    period = model.excitation.period_s
    near = None if motion is None or period is None else last_turn(motion.whole, period)
    return _steady(model, equilibrium, near, on_progress)


def _steady(model: Model, equilibrium: Equilibrium, near: Any, on_progress: OnProgress | None) -> Record | None:
    from raceway.core.periodic.steady import steady

    if model.excitation.period_s is None:
        return None
    q, ball = equilibrium.displacement, equilibrium.ball
    start = Motion(q, np.zeros(5), np.zeros(5), ball, ball.copy(), near=near, stay=True)
    schedule = Schedule(model.excitation.period_s / _SAMPLES, _SAMPLES, 1)
    watch = None if on_progress is None else (lambda done, total: on_progress("the steady motion", done, total))
    try:
        return steady(model.system, start, schedule, _TOLERANCE, on_chunk=watch)
    except (ConvergenceError, SceneError):
        return None


def last_turn(whole: Record, period: float) -> Any:
    """The last turn of a record as ``steady`` starts from it; None where the record is no whole turns of equal samples."""
    from raceway.core.periodic.search import Recorded

    steps, stride = whole.schedule.steps_per_turn, whole.schedule.stride
    n = steps // stride
    if n * stride != steps or len(whole.time) < n or whole.schedule.steps % steps:
        return None
    # Samples end each turn: the last one of a turn is the first moment of the next.
    q, v = (np.roll(values[-n:], 1, axis=0) for values in (whole.displacement, whole.velocity))
    lines = np.fft.rfft(v, axis=0) * (2j * pi / period * np.arange(n // 2 + 1))[:, None]
    return Recorded(period, q, v, np.fft.irfft(lines, n, axis=0))


def settles_elsewhere(model: Model, simulation: Simulation, settled: Record) -> bool:
    """Whether a motion repeats itself turn by turn on another orbit than the steady motion: several exist.

    Notes
    -----
    What is left of a free vibration near this orbit changes from turn to turn by as much as it is far from the orbit, unless
    its frequency is a multiple of the force's to some thousandths.
    """
    whole, frequency = simulation.whole, model.excitation.frequency_hz
    per_turn = whole.schedule.steps_per_turn // whole.schedule.stride
    if len(whole.time) < 2 * per_turn:
        return False
    last, before = whole.displacement[-per_turn:, :3], whole.displacement[-2 * per_turn : -per_turn, :3]
    lines = [
        fourier_line(one.time[-n:], one.displacement[-n:, :3], frequency)
        for one, n in ((whole, per_turn), (settled, _SAMPLES))
    ]
    apart = float(np.linalg.norm(lines[0] - lines[1]))
    change = float(np.sqrt(2.0 * ((last - before) ** 2).sum(axis=1).mean()))
    return change < _REPEATS * apart


#: Free vibrations below this share of the 1x power shift nothing that can be seen.
_LEAST_FREE = 1e-10


@attrs.frozen
class Clean:
    """Z without leakage [N/m]; what the free vibration shifts it by, still in it [N/m]; how both were found.

    Attributes
    ----------
    halves : distance of Z of both halves of the turns [N/m]; None below four turns, whose halves are too short for the window
    """

    value: complex
    lasting: complex
    how: Note
    halves: float | None = None


def without_free_vibration(model: Model, equilibrium: Equilibrium, simulation: Simulation) -> Clean | None:
    """Z of the turns that are used, by Hann's window; of a single turn by what does not close; None where neither can be."""
    if model.excitation.period_s is None:
        return None
    record, whole = whole_turns(simulation.record), simulation.whole
    per_turn = whole.schedule.steps_per_turn // whole.schedule.stride
    if len(record.time) >= 2 * per_turn:
        frequency, samples = model.excitation.frequency_hz, len(record.time)
        value, half = _windowed(record, slice(None), frequency), samples // per_turn // 2 * per_turn
        ends = (slice(half), slice(samples - half, None))
        parts = [_windowed(record, one, frequency) for one in ends] if half >= 2 * per_turn else []
        halves = abs(parts[0] - parts[1]) if parts else None
        return Clean(value, _lasting(model, equilibrium, record, value), Estimate.LEAKAGE(), halves)
    if len(whole.time) <= per_turn or not model.scene.integrator.method.inertial:
        return None
    value = _closed(model, equilibrium, whole, per_turn)
    return Clean(value, 0j, Estimate.OPEN_TURN())


def _windowed(record: Record, part: slice, frequency_hz: float) -> complex:
    """Z [N/m] of some whole turns under Hann's window."""
    lines = hann_line(record.time[part], np.hstack([record.force, record.displacement])[part], frequency_hz)
    return stiffness(lines[:5], lines[5:])


def _closed(model: Model, equilibrium: Equilibrium, whole: Record, per_turn: int) -> complex:
    """Z of the last turn less what its free vibration leaves in the 1x line."""
    from scipy.linalg import eigh

    system, w = model.system, 2.0 * np.pi * model.excitation.frequency_hz
    chosen = np.flatnonzero(system.free > 0.0)
    tangent = 0.5 * (equilibrium.stiffness_rows_held + equilibrium.stiffness_rows_held.T)
    squares, modes = eigh(system.reduced(tangent + system.stiffness), system.reduced(system.mass))
    jump, slope = (
        modes.T @ system.reduced(system.mass) @ (signal[-1] - signal[-1 - per_turn])[chosen]
        for signal in (whole.displacement, whole.velocity)
    )
    turn = slice(-per_turn, None)
    line = fourier_line(whole.time[turn], whole.displacement[turn], w / (2.0 * np.pi))
    seam = np.exp(-1j * w * whole.time[-1])
    line[chosen] -= w / np.pi * seam * modes @ ((slope + 1j * w * jump) / (w**2 - squares))
    return stiffness(fourier_line(whole.time[turn], whole.force[turn], w / (2.0 * np.pi)), line)


def hann_line(time: np.ndarray, signal: np.ndarray, frequency_hz: float) -> np.ndarray:
    """1x phasor (k,) of a signal (n, k) under Hann's window over two or more whole turns.

    Notes
    -----
    The window's spectrum ends two lines from its middle: mean and harmonics of a periodic signal leak nothing.
    """
    window = 1.0 - np.cos(2.0 * np.pi * (np.arange(len(time)) + 0.5) / len(time))
    kernel = window * np.exp(-2j * np.pi * frequency_hz * time)
    return 2.0 * (kernel[:, None] * without_drift(time, signal, frequency_hz)).mean(axis=0)


def _lasting(model: Model, equilibrium: Equilibrium, record: Record, value: complex) -> complex:
    """Shift of Z [N/m] by the free vibration."""
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    turns = len(record.time) // per_turn
    by_turn = record.displacement[: turns * per_turn, :3].reshape(turns, per_turn, 3)
    periodic = by_turn.mean(axis=0)
    # The mean over the turns keeps 1 / turns of a free vibration's power.
    free = float(((by_turn - periodic) ** 2).sum(axis=2).mean()) * turns / (turns - 1)
    forced = float(((periodic - periodic.mean(axis=0)) ** 2).sum(axis=1).mean())
    if forced == 0.0 or free < _LEAST_FREE * forced:
        return 0j
    tangent = Tangent().identify([], equilibrium, model).dynamic_stiffness
    share = 2.0 * free / forced
    return share / (1.0 + share) * (value - tangent)


#: Relative error of Z in a window above which it is told.
_MUCH = 0.05


def with_series_error(
    model: Model, found: Identification, error: Tables, steady: Settled, on_progress: OnProgress | None = None
) -> Identification:
    """The same with ``series_error`` held against steady motions where the speed changes.

    Parameters
    ----------
    error : table ``error`` of the result;  steady : motions that it was made with
    on_progress : called in searches for steady motions; of windows whose search it ends no error is stated
    """
    if not found.series_error:
        return found
    held = model.excitation.period_s is None and compares_with_steady_motion(model.scene)
    told: list[float | None] = []
    for (speed, z), own in zip(found.series, found.series_error, strict=True):
        try:
            settled = steady.value(speed, on_progress) if held else None
        except BeyondPlanError:  # of this window and of those to come nothing is known
            told += [None] * (len(found.series) - len(told))
            break
        if settled is not None:
            told.append(abs(z - settled) / min(abs(z), abs(settled)))
        else:
            told.append(None if own is None else own + (error["time_step"] or 0.0))
    return attrs.evolve(found, series_error=tuple(told))


def series_warnings(found: Identification | None) -> list[str]:
    """Says where windows of a run-up do not tell Z."""
    if found is None:
        return []
    known = [(size, speed) for size, (speed, _) in zip(found.series_error, found.series, strict=False) if size is not None]
    bad = [speed * 30.0 / pi for size, speed in known if not size <= _MUCH]
    if not bad:
        return []
    size, speed = max(known)
    return [
        f"the motion does not follow the speed in {len(bad)} of {len(found.series)} windows, {min(bad):.0f} to {max(bad):.0f} r/min: "
        f"the error of Z is up to {size:.2g} of |Z| there (at {speed * 30.0 / pi:.0f} r/min). Change the speed more slowly, or run "
        "these speeds one by one"
    ]


#: Other starts in the order in which they are tried.
_OTHERS: dict[str, tuple[str, ...]] = {"orbit": ("ramp", "static"), "ramp": ("orbit", "static"), "static": ("orbit", "ramp")}
#: A series of equilibria knows no velocities: it begins under the force or under one that grows.
_SERIES: dict[str, tuple[str, ...]] = {"orbit": ("ramp",), "ramp": ("static",), "static": ("ramp",)}


@attrs.frozen
class Run:
    """Z [N/m] of a run without what its free vibration leaks into the 1x line, and its steps a turn."""

    value: complex
    steps: int

    @classmethod
    def of(cls, model: Model, equilibrium: Equilibrium, motion: Simulation) -> Run:
        clean = without_free_vibration(model, equilibrium, motion)
        if clean is not None:
            return cls(clean.value, motion.whole.schedule.steps_per_turn)
        found = model.scene.identifier.method.identify([motion.record], equilibrium, model)
        return cls(found.dynamic_stiffness, motion.whole.schedule.steps_per_turn)


def distance(
    model: Model, equilibrium: Equilibrium, first: Simulation, run: Run, on_progress: OnProgress | None = None
) -> tuple[float, str]:
    """Distance of Z from that of another start, over the smaller Z, and the name of that start.

    Parameters
    ----------
    first : the motion from the scene's own start;  run : from the same start, over as many turns

    Raises
    ------
    ConvergenceError, StabilityError
        No other start gives a motion.
    """
    kinds = (_OTHERS if model.scene.integrator.method.inertial else _SERIES)[first.start.kind]
    if not first.start.settled:
        kinds = tuple(kind for kind in kinds if kind != "orbit")  # searched for in vain
    failed: ConvergenceError | StabilityError | None = None
    for kind in kinds:
        one = _begun_by(model, kind)
        try:
            motion = simulate(one, equilibrium, on_progress, run.steps)
        except (ConvergenceError, StabilityError) as error:
            failed = error
            continue
        if motion.start.kind == kind:
            other = Run.of(one, equilibrium, motion).value
            return abs(run.value - other) / min(abs(run.value), abs(other)), kind
    raise failed or ConvergenceError("no orbit was found to start on")


def _begun_by(model: Model, kind: str) -> Model:
    """The same scene with another start."""
    scene = model.scene
    excitation = scene.excitation
    if getattr(excitation, "ramp_turns", 0.0) > 0.0:
        excitation = attrs.evolve(excitation, ramp_turns=0.0)
    scene = attrs.evolve(scene, excitation=excitation, integrator=attrs.evolve(scene.integrator, start=kind))
    return attrs.evolve(model, scene=scene)


def start_warnings(model: Model, error: Tables) -> list[str]:
    """Says that an error is not known because no other start could be compared with."""
    if not remembers_its_start(model.scene) or error["transient"] is not None:
        return []
    return [
        f"friction: how far the answer depends on the motion's start is not known, and so is its error: {error['how']['transient']}"
    ]
