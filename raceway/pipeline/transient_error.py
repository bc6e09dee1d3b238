"""What a transient and the start of a motion do to Z: its distance from the steady motion, its free vibration, another start.

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

Harris, Proc. IEEE 66 (1978), 51 (windows); Nayfeh, Mook, Nonlinear Oscillations (1979), section 4.3 (cubic terms).
"""

import attrs
import numpy as np

from raceway.core.record import Record
from raceway.core.signals import stiffness, synchronous_phasor
from raceway.errors import ConvergenceError, StabilityError
from raceway.framework.duties import ramp_turns
from raceway.framework.estimate import Estimate, Note
from raceway.framework.loading.registry import default_registry
from raceway.pipeline.identified import Identified
from raceway.pipeline.simulate import OnProgress, Simulation, last_turn, settles_elsewhere, simulate, steady_record
from raceway.plugins.identifiers import whole_turns

#: Free vibrations below this share of the 1x power shift nothing that can be seen.
_LEAST_FREE = 1e-10
#: Other starts in the order in which they are tried.
_OTHERS: dict[str, tuple[str, ...]] = {"orbit": ("ramp", "static"), "ramp": ("orbit", "static"), "static": ("orbit", "ramp")}
#: A series of equilibria knows no velocities: it begins under the force or under one that grows.
_SERIES: dict[str, tuple[str, ...]] = {"orbit": ("ramp",), "ramp": ("static",), "static": ("ramp",)}


def settled_value(run: Identified) -> complex | None:
    """Z [N/m] that the scene's identifier finds in steady motions instead of the recorded ones.

    Returns
    -------
    complex or None
        None where a steady motion cannot be solved for (friction, laws with memory, bodies that are stepped from Python), is
        not found, or is another one than the transient converges to.  Of a speed that changes, that at the speed of the stated Z.
    """
    if run.model.excitation.period_s is None:
        # The windows before lead to that one's motion, where several exist.
        for speed, _ in run.identification.series[:-1]:
            run.steady.value(speed)
        return run.steady.value(run.identification.speed)
    records = []
    for motion in run.motions:
        near = last_turn(motion.whole, motion.model.excitation.period_s)
        orbit = steady_record(motion.model, motion.equilibrium, near, run.on_progress)
        if orbit is None or settles_elsewhere(motion.model, motion, orbit):
            return None
        records.append(orbit)
    return run.identify(records)


@attrs.frozen
class Clean:
    """Z without leakage [N/m]; what the free vibration shifts it by, still in it [N/m]; how both were found."""

    value: complex
    lasting: complex
    how: Note
    #: distance of Z of both halves of the turns [N/m]; None below four turns, whose halves are too short for the window
    halves: float | None = None


def without_free_vibration(motion: Simulation) -> Clean | None:
    """Z of the turns that are used, by Hann's window; of a single turn by what does not close; None where neither can be."""
    if motion.model.excitation.period_s is None:
        return None
    record = whole_turns(motion.record)
    per_turn = motion.steps_per_turn // motion.whole.schedule.stride
    if len(record.time) >= 2 * per_turn:
        frequency, samples = motion.model.excitation.frequency_hz, len(record.time)
        value, half = _by_window(record, slice(None), frequency), samples // per_turn // 2 * per_turn
        ends = (slice(half), slice(samples - half, None))
        values = [_by_window(record, end, frequency) for end in ends] if half >= 2 * per_turn else []
        halves = abs(values[0] - values[1]) if values else None
        return Clean(value, _lasting(motion, record, value), Estimate.LEAKAGE(), halves)
    if len(motion.whole.time) <= per_turn or not motion.model.problem.integrator.method.inertial:
        return None
    # Z of the last turn less what its free vibration leaves in the 1x line.
    from scipy.linalg import eigh

    record, system, w = motion.whole, motion.model.system, 2.0 * np.pi * motion.model.excitation.frequency_hz
    free = np.flatnonzero(system.free > 0.0)
    tangent = 0.5 * (motion.equilibrium.stiffness_rows_held + motion.equilibrium.stiffness_rows_held.T)
    squares, modes = eigh(system.reduced(tangent + system.stiffness), system.reduced(system.mass))
    signals = (record.displacement, record.velocity)
    gaps = ((signal[-1] - signal[-1 - per_turn])[free] for signal in signals)
    jump, slope = (modes.T @ system.reduced(system.mass) @ gap for gap in gaps)
    turn = slice(-per_turn, None)
    line = synchronous_phasor(record.time[turn], record.displacement[turn], w / (2.0 * np.pi))
    seam = np.exp(-1j * w * record.time[-1])
    line[free] -= w / np.pi * seam * modes @ ((slope + 1j * w * jump) / (w**2 - squares))
    force = synchronous_phasor(record.time[turn], record.force[turn], w / (2.0 * np.pi))
    return Clean(stiffness(force, line), 0j, Estimate.OPEN_TURN())


def _by_window(record: Record, part: slice, frequency_hz: float) -> complex:
    """Z [N/m] of some whole turns under Hann's window."""
    lines = hann_line(record.time[part], np.hstack([record.force, record.displacement])[part], frequency_hz)
    return stiffness(lines[:5], lines[5:])


def hann_line(time: np.ndarray, signal: np.ndarray, frequency_hz: float) -> np.ndarray:
    """1x phasor (k,) of a signal (n, k) under Hann's window over two or more whole turns.

    The window's spectrum ends two lines from its middle: mean and harmonics of a periodic signal leak nothing.
    """
    window = 1.0 - np.cos(2.0 * np.pi * (np.arange(len(time)) + 0.5) / len(time))
    return synchronous_phasor(time, signal, frequency_hz, window)


def _lasting(motion: Simulation, record: Record, value: complex) -> complex:
    """Shift of Z [N/m] by the free vibration."""
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    turns = len(record.time) // per_turn
    by_turn = record.displacement[: turns * per_turn, :3].reshape(turns, per_turn, 3)
    periodic = by_turn.mean(axis=0)
    # The mean over the turns keeps 1 / turns of a free vibration's power.
    free = float(((by_turn - periodic) ** 2).sum(axis=2).mean()) * turns / (turns - 1)
    periodic_power = float(((periodic - periodic.mean(axis=0)) ** 2).sum(axis=1).mean())
    if periodic_power == 0.0 or free < _LEAST_FREE * periodic_power:
        return 0j
    tangent = default_registry().find("identifier", "tangent").plugin().identify([], motion.equilibrium, motion.model)
    share = 2.0 * free / periodic_power
    return share / (1.0 + share) * (value - tangent.dynamic_stiffness)


@attrs.frozen
class Run:
    """Z [N/m] of a run without what its free vibration leaks into the 1x component, and its steps per turn."""

    value: complex
    steps: int

    @classmethod
    def of(cls, motion: Simulation) -> "Run":
        clean, model = without_free_vibration(motion), motion.model
        if clean is not None:
            return cls(clean.value, motion.steps_per_turn)
        identification = model.problem.identifier.method.identify([motion.record], motion.equilibrium, model)
        return cls(identification.dynamic_stiffness, motion.steps_per_turn)


def distance(motion: Simulation, run: Run, on_progress: OnProgress | None = None) -> tuple[float, str]:
    """Distance of Z from that of another start, over the smaller Z, and the name of that start.

    ConvergenceError, StabilityError: No other start gives a motion.

    motion : from the scene's own start;  run : from the same start, over as many turns
    """
    kinds = (_OTHERS if motion.model.problem.integrator.method.inertial else _SERIES)[motion.start.kind]
    if not motion.start.repeats:
        kinds = tuple(kind for kind in kinds if kind != "orbit")  # searched for in vain
    failure: ConvergenceError | StabilityError | None = None
    problem = motion.model.problem
    if ramp_turns(problem.excitation) > 0.0:
        problem = attrs.evolve(problem, excitation=attrs.evolve(problem.excitation, ramp_turns=0.0))
    for kind in kinds:
        other_problem = attrs.evolve(problem, integrator=attrs.evolve(problem.integrator, start=kind))
        try:
            model = attrs.evolve(motion.model, problem=other_problem)
            other_motion = simulate(model, motion.equilibrium, on_progress, run.steps, near=motion.near, stay=True)
        except (ConvergenceError, StabilityError) as error:
            failure = error
            continue
        if other_motion.start.kind == kind:
            value = Run.of(other_motion).value
            return abs(run.value - value) / min(abs(run.value), abs(value)), kind
    raise failure or ConvergenceError("no orbit was found to start on")
