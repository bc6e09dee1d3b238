"""Relative errors of Z, each with how it was estimated.

A method of order p leaves an error c dt^p.  A second run with n' instead of n steps per turn gives c, so that the error of
the run itself is (Z - Z') / ((n / n')^p - 1); it costs n' / n of the run.

A series of equilibria has no such order.  Each equilibrium is exact, and over a whole turn the Fourier line of N samples errs by the
harmonics N - 1, N + 1, 2N - 1 and so on, which no inertia keeps small.  Half the samples, or twice as many, may hold the same ones:
45 and 90 samples of a motion with a mirror axis do.  A series of a larger number, which shares no divisor with N, has other and
smaller ones.

What a transient leaves is the distance from the steady motion where that can be solved for and the motion did not start on it, and
else what the window over the turns sees (``transient_error``); with friction at least the distance from another start.  Step errors
are taken from values without a transient: leakage has no order.

K and C of several whirl speeds are compared with Z of the motions at those speeds, and at the scene's own.

Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (2nd ed., 1993), section II.4 (step halving).
Trefethen, Weideman, SIAM Review 56 (2014), 385 (aliasing of the trapezoidal rule).
"""

from __future__ import annotations

from math import ceil, pi
from typing import TYPE_CHECKING, cast

import attrs
import numpy as np

from raceway.answers.quantities import C, K
from raceway.bodies.model import Equilibrium, Model
from raceway.core.ring.ring import TOLERANCE
from raceway.core.ring.system import compiled, surrogate
from raceway.errors import BeyondPlanError, ConvergenceError
from raceway.framework.estimate import Estimate, Note
from raceway.framework.loading.registry import default_registry
from raceway.pipeline.content import ErrorTable
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.identified import Identified
from raceway.pipeline.simulate import Simulation, simulate
from raceway.planning.resolve import fits

if TYPE_CHECKING:
    from raceway.pipeline.transient_error import Clean, Run

#: Least steps per turn (of ``integrator.steps_per_turn``), and how close the second run may come to the stable limit.
_LEAST_STEPS = 8
_MOST_OF_LIMIT = 0.95
#: A second run whose step differs by less than this tells nothing.
_LEAST_RATIO = 1.1
#: Steps of a run instead of the second one where that one's free vibration hides what the steps change, over those of the first.
_CLOSER = 2.0 / 3.0
#: Turns of a second run with more steps, which is shorter so that it costs no more than the first.
_LEAST_TURNS = 4
#: Least equilibria per turn of a second series.
_LEAST_EQUILIBRIA = 181
#: Largest deviation of a turn from all turns over |Z| up to which turns repeat.
_REPEATS = 1e-2
#: What an estimate is good to: a factor of so much.
_RIGHT = 3.0
#: Difference of a contact law from Hertz's that is reported: one of pressures over overlaps is a third off by its form.
_OTHER_LAW = 0.5
#: Relative difference of two speeds that are one; misfit over |Z| above which K and C describe no Z.
_SAME_SPEED, _MISFIT = 1e-9, 0.05
#: Why there is no total, of a Z that is identified.
_TOTAL_UNKNOWN = (Estimate.MESH_UNKNOWN, Estimate.TURNS_DIFFER, Estimate.PART_UNKNOWN)


@attrs.frozen
class Part:
    """One contribution: ``size`` relative to |Z|, its complex ``shift`` of Z where that is known, and how it was found."""

    size: float | None
    how: str
    shift: complex | None = None

    @property
    def estimate(self) -> Estimate | None:
        """What the note is made of; None of a plain sentence."""
        return self.how.estimate if isinstance(self.how, Note) else None


@attrs.frozen
class Errors:
    """Of one run; ``bodies`` is the sum of mesh and calibration, of the size of Z alone and the same for all runs on these bodies."""

    total: Part
    time_step: Part
    transient: Part
    mesh: Part
    contact: Part
    identification: Part
    bodies: float | None = None

    @classmethod
    def unknown(cls, how: Note) -> Errors:
        """Without numbers, and one reason."""
        part = Part(None, how)
        return cls(part, part, part, part, part, part)

    @property
    def parts(self) -> dict[str, Part]:
        """The total and its parts by their names."""
        return {field.name: getattr(self, field.name) for field in attrs.fields(Errors) if field.name != "bodies"}

    @property
    def unresolved(self) -> list[str]:
        """The total and the parts that are as large as what they are the error of: nothing identified says anything then.

        Estimates are those of small errors, to first order: of one that is not small nothing follows, neither for Z nor for K.
        """
        return [name for name, part in self.parts.items() if (part.size or 0.0) >= 1.0]

    @property
    def table(self) -> ErrorTable:
        """Without what other hypotheses change."""
        sizes, how = ({name: getattr(part, key) for name, part in self.parts.items()} for key in ("size", "how"))
        return cast(ErrorTable, {**sizes, "bodies": self.bodies, "how": how, "unresolved": self.unresolved})


def body_errors(model: Model, equilibrium: Equilibrium, how: Note) -> Errors:
    """Those of mesh and contacts, which the equilibrium has; of all else ``how``."""
    mesh = model.bearing.mesh_error(model, equilibrium)  # before the contacts': bodies go on from what they solved last
    has_contact = (equilibrium.contact_force > 0.0).any()
    contact = model.bearing.contact_error(model, equilibrium) if has_contact else (None, Estimate.UNLOADED())
    return attrs.evolve(Errors.unknown(how), mesh=Part(*mesh), contact=Part(*contact))


def errors_of(run: Identified) -> Errors:
    """Of what is identified in a run's motions."""
    model = run.model
    errors = body_errors(model, run.equilibrium, Estimate.NO_MOTION())
    parts = {"time_step": Part(TOLERANCE, Estimate.NO_TIME_STEP())}
    if run.motions:
        step, second = _time_step(run)
        transient = _transient(run, step)
        if model.problem.depends_on_start and transient.size is not None:
            transient = _from_other_start(run, second, transient)
        parts = {"time_step": step, "transient": transient, "identification": _identification(run)}
    of_bodies = {"mesh": errors.mesh} | ({"contact": errors.contact} if model.traits.calibrated else {})
    errors = attrs.evolve(errors, **parts, bodies=sum(part.size or 0.0 for part in of_bodies.values()))
    parts |= of_bodies
    if (why := _no_total(run, parts)) is not None:
        return attrs.evolve(errors, total=Part(None, why))
    window = {"rpm": 60.0 * run.identification.frequency_hz}
    how = Estimate.SUM_OF_LAST_WINDOW(**window) if run.identification.series_error else Estimate.SUM()
    # Errors whose phases are known may cancel; half the larger is kept, because each is known to that only.
    estimates = [part for part in parts.values() if part.size is not None]
    sizes = [part.size or 0.0 for part in estimates if part.shift is None]
    shifts = [part.shift for part in estimates if part.shift is not None]
    together = max(abs(sum(shifts)), *(0.5 * abs(shift) for shift in shifts)) if shifts else 0.0
    return attrs.evolve(errors, total=Part(float(together + sum(sizes)) if estimates else None, how))


def error_warnings(errors: Errors, identified: bool) -> list[str]:
    """What stands before a number: it is smaller than its error, its error is not known, its law is another one."""
    warnings, contact = list[str](), errors.contact.size or 0.0
    if names := errors.unresolved:
        size, name = max((errors.parts[name].size or 0.0, name) for name in names)
        cause = "its estimated error" if name == "total" else f"the error of {name.replace('_', ' ')}"
        number, what = ("Z", "K and C carry") if identified else ("the stiffness", "it carries")
        warnings.append(f"{number} is not resolved: {cause} is {size:.2g} times its size, so that {what} no information")
    elif contact >= _OTHER_LAW:
        words = f"the contact law deviates from Hertz's by {contact:.2g}, which the stated error does not include: {errors.contact.how}"
        warnings.append(words)
    if identified and errors.total.estimate in _TOTAL_UNKNOWN:
        warnings.append(f"the error of Z is {errors.total.how}")
    return warnings


def _no_total(run: Identified, parts: dict[str, Part]) -> Note | None:
    if run.model.traits.every_node:
        return Estimate.MESH_UNKNOWN()
    if not run.motions:
        return None
    start, spread = run.motion.start, run.identification.spread
    # A ramp that stands in for an orbit: single turns may be far from where they lead.
    if not start.repeats and start.orbit is None and (spread is None or spread > _REPEATS):
        return Estimate.TURNS_DIFFER()
    parts_of_total = ("time_step", "transient", *(("identification",) if run.several_speeds else ()))
    unknown = {name.replace("_", " "): parts[name].how for name in parts_of_total if parts[name].size is None}
    if not unknown:
        return None
    reasons = " and ".join(f"the error of the {name} is unknown ({how})" for name, how in unknown.items())
    return Estimate.PART_UNKNOWN(reasons=reasons, part=next(iter(unknown)))


def _time_step(run: Identified, second_steps: int | None = None) -> tuple[Part, Run | None]:
    """By a second run with other steps; that one, where other starts are compared with it because it is cheaper than the first.

    second_steps : steps per turn of the second run; None: chosen here
    """
    model, method, first = run.model, run.model.problem.integrator.method, run.motion
    if method.steady:
        return Part(first.whole.counts.get("error"), Estimate.OF_INTEGRATOR()), None
    if model.traits.every_node:
        return Part(None, Estimate.SECOND_RUN_COSTS()), None
    if not method.inertial:
        return _sampling(run), None
    from raceway.pipeline.transient_error import Run, without_free_vibration

    steps = first.steps_per_turn
    limits = [motion.critical_time_step for motion in run.motions if motion.critical_time_step is not None]
    explicit = not method.implicit and bool(limits)
    bound = first.whole.schedule.dt * steps / (_MOST_OF_LIMIT * min(limits)) if explicit else 0.0
    # Half as many, or as few as the stable limit leaves; half as many more where that tells nothing.
    fewer = max(steps // 2, _LEAST_STEPS, ceil(bound))
    count = second_steps or (fewer if steps >= _LEAST_RATIO * fewer else ceil(1.5 * steps))
    turns = model.plan.turns if count < steps else min(model.plan.turns, max(model.plan.turns // 2, _LEAST_TURNS))
    if not fits(turns, count, model.system.ball_count):
        return Part(None, Estimate.SECOND_RUN_TOO_LARGE(steps=count)), None
    models = [attrs.evolve(m.model, plan=attrs.evolve(m.model.plan, turns=turns)) for m in run.motions]
    try:
        again = [
            simulate(shorter, motion.equilibrium, run.on_progress, count, motion.start)
            for shorter, motion in zip(models, run.motions, strict=True)
        ]
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.SECOND_RUN_FAILED(steps=count, why=why)), None
    second = Run.of(again[-1]) if count < steps and model.problem.depends_on_start else None
    # Several speeds are told apart by the identifier alone.
    fine, coarse = (without_free_vibration(motion) if len(run.motions) == 1 else None for motion in (first, again[-1]))
    ratio = (steps / count) ** method.order - 1.0
    if fine is not None and coarse is not None:
        change = fine.value - coarse.value
        closer = max(ceil(_CLOSER * steps), ceil(bound))
        further = second_steps is None and _LEAST_RATIO * count <= closer <= steps / _LEAST_RATIO
        # Coarse steps leave their orbit by more than their order tells, and vibrate freely about another one: that hides what
        # they change, where it would be the largest error.
        below_vibration = coarse.halves is not None and coarse.halves > abs(change) > ratio * abs(run.value - fine.value)
        if further and below_vibration:
            return _time_step(run, closer)
    else:
        change = run.value - run.identify([motion.record for motion in again])
    shift = change / ratio / abs(run.value)
    if not np.isfinite(abs(shift)):
        return Part(None, Estimate.SECOND_RUN_WITHOUT_Z(steps=count)), second
    words = "half as many steps" if 2 * count == steps else f"{count} instead of {steps} steps per turn"
    return Part(float(abs(shift)), Estimate.SECOND_RUN(change=words, order=method.order), -shift), second


def _sampling(run: Identified) -> Part:
    """Of a series of equilibria, by a second one with more of them."""
    tolerance = getattr(run.model.problem.integrator.method, "tolerance", 0.0)
    steps = run.motion.steps_per_turn
    count = equilibria_of_second_series(steps)
    if not fits(run.model.plan.turns, count, run.model.system.ball_count, inertial=False):
        return Part(None, Estimate.SECOND_SERIES_TOO_LARGE(count=count))
    try:
        shift = (run.value - _finer_value(run, count)) / abs(run.value)
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.SECOND_SERIES_FAILED(count=count, why=why))
    if abs(shift) <= tolerance:
        return Part(tolerance, Estimate.RESIDUAL())
    return Part(float(abs(shift)), Estimate.SECOND_SERIES(count=count, steps=steps), shift)


def equilibria_of_second_series(steps: int) -> int:
    """Equilibria a turn of the second series: more than twice as many, and no few."""
    return max(2 * steps + 1, _LEAST_EQUILIBRIA)


def _finer_value(run: Identified, count: int) -> complex:
    """Z [N/m] of a series of ``count`` equilibria per turn.

    ConvergenceError: an equilibrium that is not found.

    Bodies that are stepped from Python take milliseconds an equilibrium: of them the change is that of their compiled
    surrogate, whose motion has nearly the same harmonics.
    """

    def identification(states: list[tuple[Model, Equilibrium]], steps: int) -> complex:
        return run.identify([simulate(*state, run.on_progress, steps).record for state in states])

    if compiled(run.model.system) is not None:
        return identification([(motion.model, motion.equilibrium) for motion in run.motions], count)
    models = [attrs.evolve(motion.model, system=surrogate(motion.model.system)) for motion in run.motions]

    def change(steps: int) -> complex:
        return identification([(model, solve_equilibrium(model)) for model in models], steps)

    return run.value + change(count) - change(run.motion.steps_per_turn)


def _transient(run: Identified, step: Part) -> Part:
    model, value, spread = run.model, run.value, run.identification.spread
    method = model.problem.integrator.method
    if method.steady:
        return Part(0.0, Estimate.STEADY())
    memory = not model.system.conservative or model.problem.contact.law.state_size > 0
    if not method.inertial and (model.plan.turns == 1 or not memory):
        return Part(0.0, Estimate.EQUILIBRIA())
    from raceway.pipeline.transient_error import settled_value, without_free_vibration

    if model.problem.compared_with_steady:
        try:
            steady = settled_value(run)
        except BeyondPlanError as why:
            return Part(None, Estimate.STEADY_BEYOND_PLAN(why=why))
        if steady is not None:
            # Less the part of the time step; relative to the smaller of both.
            shift = (value - steady) / min(abs(value), abs(steady)) - (step.shift or 0.0)
            return Part(float(abs(shift)), Estimate.FROM_STEADY(), shift)
    if run.several_speeds:
        return Part(None, Estimate.STEADY_SPEEDS_UNKNOWN())
    clean = without_free_vibration(run.motion)
    by_turns = Part(spread, Estimate.TURN_BY_TURN())
    if clean is None:
        return Part(None, Estimate.SINGLE_TURN()) if spread is None else by_turns
    shift = (value - clean.value + clean.lasting) / abs(value)
    if (spread or 0.0) > abs(shift) and window_misses_transient(model, run.motion, clean, abs(shift * value)):
        return by_turns
    return Part(float(abs(shift)), clean.how, shift)


def window_misses_transient(model: Model, simulation: Simulation, clean: Clean, leakage: float) -> bool:
    """Whether the window over the turns may miss a part of the transient.

    leakage : that the window finds [N/m]

    What began on no stable orbit may be on its way from one motion to another.  What began on none at all may beat with 1x:
    then the halves of the turns are further apart than the window over all turns accounts for.
    """
    start, problem = simulation.start, model.problem
    if not start.repeats:
        return True
    if start.orbit is not None and problem.contact.friction == 0.0 and problem.contact.law.state_size == 0:
        return False
    if not problem.integrator.method.inertial:
        return False
    return clean.halves is None or clean.halves > _RIGHT * leakage


def _from_other_start(run: Identified, second: Run | None, transient: Part) -> Part:
    """With friction the transient, and how far away another start leads."""
    from raceway.pipeline.transient_error import Run, distance

    reference = second or Run.of(run.motion)
    try:
        size, kind = distance(run.motion, reference, run.on_progress)
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.OTHER_START_FAILED(why=why))
    if not np.isfinite(size):
        return Part(None, Estimate.OTHER_START_WITHOUT_Z(kind=kind))
    how = Estimate.OTHER_START(size=size, kind=kind, transient=transient.how)
    return Part(float((transient.size or 0.0) + size), how)


def _identification(run: Identified) -> Part:
    window = run.identification.window
    if window is None:
        return Part(None, Estimate.NOT_BY_IDENTIFIER(kind=run.model.problem.identifier.kind))
    if not run.several_speeds:
        return Part(window, Estimate.TWO_FITS())
    try:
        size, rpm = _largest_misfit(run)
    except ConvergenceError as why:
        return Part(None, Estimate.NO_MOTION_AT_SPEED(why=why))
    return Part(max(size, window), Estimate.MISFIT(rpm=rpm))


def _largest_misfit(run: Identified) -> tuple[float, float]:
    """Largest |Z - (K - m w^2 + j w C)| over |Z|, and the whirl speed [r/min] where it is.

    Between and beyond the speeds of a fit nothing tells what Z does, a resonance included.  Where the scene's own whirl speed,
    whose Z and K are stated, is none of them, its motion is computed: spin and force are the same.  There the misfit is over
    the smaller one of both Z, so that it is an error of the stated one, too.

    ConvergenceError, StabilityError: no motion at the scene's own speed.
    """
    fit, model = run.identification, run.model
    series = list(fit.series)
    if all(abs(w / fit.speed - 1.0) > _SAME_SPEED for w, _ in series) and not model.traits.every_node:
        record = simulate(model, run.equilibrium).record
        by_lines = default_registry().find("identifier", "fft_1x").plugin()
        series.append((fit.speed, by_lines.identify([record], run.equilibrium, model).dynamic_stiffness))
    misfits = []
    for w, z in series:
        fit_value = complex(K.of(fit) - fit.mass_used * w**2, w * C.of(fit))
        scale = min(abs(z), abs(fit_value)) if abs(w / fit.speed - 1.0) <= _SAME_SPEED else abs(z)
        misfits.append((abs(z - fit_value) / scale, w * 30.0 / pi))
    return max(misfits)


def misfit_warnings(model: Model, misfit: float | None) -> list[str]:
    """Says where Z over the whirl speeds is not what K and C make of it."""
    if not model.problem.several_speeds or (misfit or 0.0) <= _MISFIT:
        return []
    return [
        f"Z is not of the form K - m w^2 + j w C over these whirl speeds (misfit {misfit:.2g} of |Z|; free tilts, "
        "gyroscopic moments, a resonance): K and C belong to no speed: use identifier 'fft_1x' at each"
    ]
