"""The motion that a transient would settle on, where it can be solved for: its Z has no transient and no time step in it."""

from __future__ import annotations

from math import pi
from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.core.signals.identification import Identification, fourier_line, stiffness
from raceway.core.stepping.record import Motion, Record, Schedule
from raceway.errors import ConvergenceError, SceneError
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress, Simulation

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
    from raceway.core.periodic.neighbour import Recorded

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
