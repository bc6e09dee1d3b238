"""The table ``error`` of a result: relative errors of Z, each with how it was estimated.

Notes
-----
A method of order p leaves an error c dt^p.  A second run with n' instead of n steps a turn gives c, so that the error of
the run itself is (Z - Z') / ((n / n')^p - 1); it costs n' / n of the run.

A series of equilibria has no such order.  Each equilibrium is exact, and over a whole turn the Fourier line of N samples errs by the
harmonics N - 1, N + 1, 2N - 1 and so on, which no inertia keeps small.  Half the samples, or twice as many, may hold the same ones:
45 and 90 samples of a motion with a mirror axis do.  A series of a larger number, which shares no divisor with N, has other and
smaller ones.

What a transient leaves is the distance from the steady motion where that can be solved for and the motion did not start on it, and
else what the window over the turns sees (``transient_error``); with friction at least the distance from another start.  Step errors
are taken from values without a transient: leakage has no order.

K and C of several whirl speeds are compared with Z of the motions at those speeds, and at the scene's own.

References
----------
Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (2nd ed., 1993), section II.4 (step halving).
Trefethen, Weideman, SIAM Review 56 (2014), 385 (aliasing of the trapezoidal rule).
"""

from __future__ import annotations

from math import ceil, pi
from typing import Any

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.ring.ring import TOLERANCE
from raceway.core.ring.system import compiled, surrogate
from raceway.core.signals import Identification
from raceway.errors import BeyondPlanError, ConvergenceError
from raceway.framework.estimate import Estimate, Note
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress, Simulation, simulate
from raceway.pipeline.transient_error import Clean, Run, Settled, distance, settled_value, without_free_vibration
from raceway.planning.recording import fits
from raceway.planning.steady_orbits import compares_with_steady_motion, remembers_its_start
from raceway.plugins.identifiers import Fft1x
from raceway.storage.tables import Tables

#: Least steps a turn (of ``integrator.steps_per_turn``), and how close the second run may come to the stable limit.
_LEAST_STEPS = 8
_MOST_OF_LIMIT = 0.95
#: A second run whose step differs by less than this tells nothing.
_LEAST_RATIO = 1.1
#: Steps of a run instead of the second one where that one's free vibration hides what the steps change, over those of the first.
_CLOSER = 2.0 / 3.0
#: Turns of a second run with more steps, which is shorter so that it costs no more than the first.
_LEAST_TURNS = 4

#: Largest deviation of a turn from all turns over |Z| up to which turns repeat.
_REPEATS = 1e-2
#: What an estimate is good to: a factor of so much.
_RIGHT = 3.0

#: Why there is no total, of a Z that is identified.
_TOTAL_UNKNOWN = (Estimate.MESH_UNKNOWN, Estimate.TURNS_DIFFER, Estimate.PART_UNKNOWN)
_NAMES = ("total", "time_step", "transient", "mesh", "contact", "identification")
#: Difference of a contact law from Hertz's that is reported: one of pressures over overlaps is a third off by its form.
_OTHER_LAW = 0.5


@attrs.frozen
class Part:
    """One contribution: ``size`` relative to |Z|, its complex ``shift`` of Z where that is known, and how it was found."""

    size: float | None
    how: str
    shift: complex | None = None


def no_error(how: Note) -> dict[str, Any]:
    """The table without numbers, and one reason."""
    return {**dict.fromkeys(_NAMES), "bodies": None, "how": dict.fromkeys(_NAMES, how)}


def unresolved(error: dict[str, Any]) -> list[str]:
    """The total and the parts that are as large as what they are the error of: nothing identified says anything then.

    Notes
    -----
    Estimates are those of small errors, to first order: of one that is not small nothing follows, neither for Z nor for K.
    """
    return [name for name in _NAMES if (error[name] or 0.0) >= 1.0]


def error_warnings(error: dict[str, Any], identified: bool) -> list[str]:
    """What is said first of a number: that it is smaller than its error, that its error is not known, that its law is another one."""
    names, found, contact = unresolved(error), list[str](), error["contact"] or 0.0
    if names:
        size, name = max((error[name], name) for name in names)
        which = "its estimated error" if name == "total" else f"the error of {name.replace('_', ' ')}"
        what, lost = ("Z", "K and C say") if identified else ("the stiffness", "it says")
        found.append(f"{what} is not resolved: {which} is {size:.2g} times its size, so that {lost} nothing")
    elif contact >= _OTHER_LAW:
        found.append(
            f"the contact law is off Hertz's by {contact:.2g}, which is not part of the stated error: {error['how']['contact']}"
        )
    why = error["how"]["total"]
    if identified and why.estimate in _TOTAL_UNKNOWN:
        found.append(f"the error of Z is {why}")
    return found


def body_errors(model: Model, equilibrium: Equilibrium, how: Note) -> dict[str, Any]:
    """The table with what the equilibrium tells, errors of mesh and contacts; of all else ``how``."""
    table = no_error(how)
    table["mesh"], table["how"]["mesh"] = model.bearing.mesh_error(model, equilibrium)
    loaded = (equilibrium.contact_force > 0.0).any()
    contact = model.bearing.contact_error(model, equilibrium) if loaded else (None, Estimate.UNLOADED())
    table["contact"], table["how"]["contact"] = contact
    return table


def error_table(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    found: Identification,
    steady: Settled,
    on_progress: OnProgress | None = None,
) -> dict[str, Any]:
    """The table ``error``.

    Parameters
    ----------
    motions : model and motion of each speed; empty where the identifier needs no motion
    steady : steady motions of an excitation that changes its speed
    on_progress : called in further runs and searches; the error of one that it ends is not known
    """
    table = body_errors(model, equilibrium, Estimate.NO_MOTION())
    how: dict[str, str] = table["how"]
    if not motions:
        parts = {"time_step": Part(TOLERANCE, Estimate.NO_TIME_STEP())}
    else:
        step, second = _time_step(model, equilibrium, motions, found.dynamic_stiffness, on_progress)
        transient = _transient(model, equilibrium, motions, found, step, steady, on_progress)
        if remembers_its_start(model.scene) and transient.size is not None:
            first = motions[-1][1]
            run = second or Run.of(model, equilibrium, first)
            transient = _from_other_start(model, equilibrium, first, run, transient, on_progress)
        parts = {
            "time_step": step,
            "transient": transient,
            "identification": _identification(model, equilibrium, found),
        }
    parts["mesh"] = Part(table["mesh"], how["mesh"])
    if model.traits.calibrated:
        parts["contact"] = Part(table["contact"], how["contact"])
    # The same for all runs on these bodies, and of the size of Z alone.
    table["bodies"] = sum(parts[name].size or 0.0 for name in ("mesh", "contact") if name in parts)
    for name, part in parts.items():
        table[name], how[name] = part.size, part.how
    if model.traits.every_node:
        how["total"] = Estimate.MESH_UNKNOWN()
        return table
    if motions and _wanders(motions[-1][1], found):
        how["total"] = Estimate.TURNS_DIFFER()
        return table
    needed = ("time_step", "transient", *(("identification",) if "speeds" in model.scene.identifier.method.needs else ()))
    unknown = [name for name in needed if motions and parts[name].size is None]
    if unknown:
        names = [name.replace("_", " ") for name in unknown]
        reasons = [f"that of the {name} is not known ({parts[key].how})" for key, name in zip(unknown, names, strict=True)]
        how["total"] = Estimate.PART_UNKNOWN(reasons=" and ".join(reasons), part=names[0])
        return table
    one_window = bool(found.series_error)
    how["total"] = Estimate.SUM_OF_LAST_WINDOW(rpm=60.0 * found.frequency_hz) if one_window else Estimate.SUM()
    table["total"] = _total(parts)
    return table


def _wanders(simulation: Simulation, found: Identification) -> bool:
    """Whether a ramp that stands in for an orbit ends in turns that do not repeat: single turns may be far from where they lead."""
    start = simulation.start
    return not start.settled and start.orbit is None and (found.spread is None or found.spread > _REPEATS)


def _total(parts: dict[str, Part]) -> float | None:
    """Errors whose phases are known may cancel; half the larger is kept, because each is known to that only."""
    known = [part for part in parts.values() if part.size is not None]
    if not known:
        return None
    sizes = [part.size or 0.0 for part in known if part.shift is None]
    shifts = [part.shift for part in known if part.shift is not None]
    together = max(abs(sum(shifts)), *(0.5 * abs(shift) for shift in shifts)) if shifts else 0.0
    return float(together + sum(sizes))


def _identification(model: Model, equilibrium: Equilibrium, found: Identification) -> Part:
    if found.window is None:
        return Part(None, Estimate.NOT_BY_IDENTIFIER(kind=model.scene.identifier.kind))
    if "speeds" not in model.scene.identifier.method.needs:
        return Part(found.window, Estimate.TWO_FITS())
    try:
        size, rpm = largest_misfit(model, equilibrium, found)
    except ConvergenceError as why:
        return Part(None, Estimate.NO_MOTION_AT_SPEED(why=why))
    return Part(max(size, found.window), Estimate.MISFIT(rpm=rpm))


def _time_step(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    value: complex,
    on_progress: OnProgress | None,
    given: int | None = None,
) -> tuple[Part, Run | None]:
    """By a second run with other steps; that one, where other starts are compared with it because it is cheaper than the first.

    Parameters
    ----------
    given : steps a turn of the second run
    """
    method, first = model.scene.integrator.method, motions[-1][1]
    if method.steady:
        return Part(first.whole.counts.get("error"), Estimate.OF_INTEGRATOR()), None
    if model.traits.every_node:
        return Part(None, Estimate.SECOND_RUN_COSTS()), None
    if not method.inertial:
        return _sampling(motions, equilibrium, model, value, on_progress), None
    steps = first.whole.schedule.steps_per_turn
    limits = [one.critical_time_step for _, one in motions if one.critical_time_step is not None]
    explicit = not method.implicit and bool(limits)
    bound = first.whole.schedule.dt * steps / (_MOST_OF_LIMIT * min(limits)) if explicit else 0.0
    other = given or other_steps(steps, bound)
    turns = model.plan.turns if other < steps else min(model.plan.turns, max(model.plan.turns // 2, _LEAST_TURNS))
    if not fits(turns, other, model.system.ball_count):
        return Part(None, Estimate.SECOND_RUN_TOO_LARGE(steps=other)), None
    try:
        again = [
            simulate(_over(one, turns), _at(one, model, equilibrium), on_progress, other, begun=m) for one, m in motions
        ]
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.SECOND_RUN_FAILED(steps=other, why=why)), None
    second = Run.of(model, equilibrium, again[-1]) if other < steps and remembers_its_start(model.scene) else None
    fine, coarse = value, 0j
    # Several speeds are told apart by the identifier alone.
    clean = [without_free_vibration(model, equilibrium, one) if len(motions) == 1 else None for one in (first, again[-1])]
    if clean[0] is not None and clean[1] is not None:
        fine, coarse = clean[0].value, clean[1].value
        closer = max(ceil(_CLOSER * steps), ceil(bound))
        further = given is None and _LEAST_RATIO * other <= closer <= steps / _LEAST_RATIO
        if further and _hidden(clean[1], fine - coarse, (steps / other) ** method.order - 1.0, value - fine):
            return _time_step(model, equilibrium, motions, value, on_progress, closer)
    else:
        coarse = model.scene.identifier.method.identify([a.record for a in again], equilibrium, model).dynamic_stiffness
    shift = (fine - coarse) / ((steps / other) ** method.order - 1.0) / abs(value)
    if not np.isfinite(abs(shift)):
        return Part(None, Estimate.SECOND_RUN_WITHOUT_Z(steps=other)), second
    words = "half as many steps" if 2 * other == steps else f"{other} instead of {steps} steps a turn"
    return Part(float(abs(shift)), Estimate.SECOND_RUN(change=words, order=method.order), -shift), second


def _hidden(clean: Clean, change: complex, powers: float, leakage: complex) -> bool:
    """Whether the free vibration of a second run hides what its steps change, and that would be the largest error.

    Parameters
    ----------
    clean : of the second run;  change : of Z from it to the first [N/m], ``powers`` times the error of the first
    leakage : in Z of the first [N/m]

    Notes
    -----
    Coarse steps leave their orbit by more than their order tells, and vibrate freely about another one.
    """
    return clean.halves is not None and clean.halves > abs(change) > powers * abs(leakage)


def _sampling(
    motions: list[tuple[Model, Simulation]],
    equilibrium: Equilibrium,
    model: Model,
    value: complex,
    on_progress: OnProgress | None,
) -> Part:
    """Of a series of equilibria, by a second one with more of them."""
    tolerance = getattr(model.scene.integrator.method, "tolerance", 0.0)
    steps = motions[-1][1].whole.schedule.steps_per_turn
    count = more_equilibria(steps)
    if not fits(model.plan.turns, count, model.system.ball_count, inertial=False):
        return Part(None, Estimate.SECOND_SERIES_TOO_LARGE(count=count))
    try:
        shift = (value - finer_value(model, equilibrium, motions, value, count, on_progress)) / abs(value)
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.SECOND_SERIES_FAILED(count=count, why=why))
    if abs(shift) <= tolerance:
        return Part(tolerance, Estimate.RESIDUAL())
    return Part(float(abs(shift)), Estimate.SECOND_SERIES(count=count, steps=steps), shift)


def _at(one: Model, model: Model, equilibrium: Equilibrium) -> Equilibrium:
    """The equilibrium that belongs to the model of one speed."""

    return equilibrium if one is model else settle(one)


def _over(model: Model, turns: int) -> Model:
    return model if turns == model.plan.turns else attrs.evolve(model, plan=attrs.evolve(model.plan, turns=turns))


def other_steps(steps: int, least: float = 0.0) -> int:
    """Steps a turn of the second run: half, or as few as the stable limit leaves; half as many more where that tells nothing.

    Parameters
    ----------
    least : steps a turn that the stable limit asks for; 0 for an implicit method
    """
    fewer = max(steps // 2, _LEAST_STEPS, ceil(least))
    if steps >= _LEAST_RATIO * fewer:
        return fewer
    return ceil(1.5 * steps)


def _transient(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    found: Identification,
    step: Part,
    steady: Settled,
    on_progress: OnProgress | None,
) -> Part:
    method, value, simulation = model.scene.integrator.method, found.dynamic_stiffness, motions[-1][1]
    if method.steady:
        return Part(0.0, Estimate.STEADY())
    memory = not model.system.conservative or model.scene.contact.law.state_size > 0
    if not method.inertial and (model.plan.turns == 1 or not memory):
        return Part(0.0, Estimate.EQUILIBRIA())
    if compares_with_steady_motion(model.scene):
        try:
            settled = settled_value(model, equilibrium, motions, found, steady, on_progress)
        except BeyondPlanError as why:
            return Part(None, Estimate.STEADY_BEYOND_PLAN(why=why))
        if settled is not None:
            return _from_steady(settled, value, step)
    if "speeds" in model.scene.identifier.method.needs:
        return Part(None, Estimate.STEADY_SPEEDS_UNKNOWN())
    clean = without_free_vibration(model, equilibrium, simulation)
    by_turns = Part(found.spread, Estimate.TURN_BY_TURN())
    if clean is None:
        return Part(None, Estimate.SINGLE_TURN()) if found.spread is None else by_turns
    shift = (value - clean.value + clean.lasting) / abs(value)
    if (found.spread or 0.0) > abs(shift) and _unresolved(model, simulation, clean, abs(shift * value)):
        return by_turns
    return Part(float(abs(shift)), clean.how, shift)


def _unresolved(model: Model, simulation: Simulation, clean: Clean, seen: float) -> bool:
    """Whether the window over the turns may miss a part of the transient.

    Parameters
    ----------
    seen : what the window sees [N/m]

    Notes
    -----
    What began on no stable orbit may be on its way from one motion to another.  What began on none at all may beat with 1x:
    then the halves of the turns are further apart than the whole window accounts for.
    """
    if not simulation.start.settled:
        return True
    if (
        simulation.start.orbit is not None
        and model.scene.contact.friction == 0.0
        and model.scene.contact.law.state_size == 0
    ):
        return False
    if not model.scene.integrator.method.inertial:
        return False
    return clean.halves is None or clean.halves > _RIGHT * seen


def _from_other_start(
    model: Model, equilibrium: Equilibrium, first: Simulation, run: Run, own: Part, on_progress: OnProgress | None
) -> Part:
    """With friction the transient, and how far away another start leads."""
    try:
        size, kind = distance(model, equilibrium, first, run, on_progress)
    except (ConvergenceError, BeyondPlanError) as why:
        return Part(None, Estimate.OTHER_START_FAILED(why=why))
    if not np.isfinite(size):
        return Part(None, Estimate.OTHER_START_WITHOUT_Z(kind=kind))
    how = Estimate.OTHER_START(size=size, kind=kind, transient=own.how)
    return Part(float((own.size or 0.0) + size), how)


def _from_steady(settled: complex, value: complex, step: Part) -> Part:
    """Distance from Z of the steady motion, less the part of the time step; relative to the smaller of both."""
    shift = (value - settled) / min(abs(value), abs(settled)) - (step.shift or 0.0)
    return Part(float(abs(shift)), Estimate.FROM_STEADY(), shift)


#: Least equilibria a turn of a second series.
_LEAST = 181


def more_equilibria(steps: int) -> int:
    """Equilibria a turn of the second series: more than twice as many, and no few."""
    return max(2 * steps + 1, _LEAST)


def finer_value(
    model: Model,
    equilibrium: Equilibrium,
    motions: list[tuple[Model, Simulation]],
    value: complex,
    count: int,
    on_progress: OnProgress | None = None,
) -> complex:
    """Z [N/m] of a series of ``count`` equilibria a turn, where a series of the scene's number has ``value``.

    Raises
    ------
    ConvergenceError
        An equilibrium that is not found.

    Notes
    -----
    Bodies that are stepped from Python take milliseconds an equilibrium: of them the change is that of their compiled
    surrogate, whose motion has nearly the same harmonics.
    """

    def identified(models: list[Model], steps: int) -> complex:
        records = [simulate(one, equilibrium if one is model else settle(one), on_progress, steps).record for one in models]
        return model.scene.identifier.method.identify(records, equilibrium, model).dynamic_stiffness

    models = [one for one, _ in motions]
    if compiled(model.system) is not None:
        return identified(models, count)
    models = [attrs.evolve(one, system=surrogate(one.system)) for one in models]
    steps = motions[-1][1].whole.schedule.steps_per_turn
    return value + identified(models, count) - identified(models, steps)


#: Relative difference of two speeds that are one.
_SAME = 1e-9
#: Misfit over |Z| above which K and C are told to describe no Z.
_MUCH = 0.05


def largest_misfit(model: Model, equilibrium: Equilibrium, found: Identification) -> tuple[float, float]:
    """Largest |Z - (K - m w^2 + j w C)| over |Z|, and the whirl speed [r/min] where it is.

    Notes
    -----
    Between and beyond the speeds of a fit nothing tells what Z does, a resonance included.  Where the scene's own whirl speed,
    whose Z and K are stated, is none of them, its motion is computed: spin and force are the same.  There the misfit is over
    the smaller one of both Z, so that it is an error of the stated one, too.

    Raises
    ------
    ConvergenceError, StabilityError
        No motion at the scene's own speed.
    """
    series = list(found.series)
    if all(abs(w / found.speed - 1.0) > _SAME for w, _ in series) and not model.traits.every_node:
        record = simulate(model, equilibrium).record
        series.append((found.speed, Fft1x().identify([record], equilibrium, model).dynamic_stiffness))
    sizes = []
    for w, z in series:
        fitted = complex(found.equivalent_stiffness - found.mass_used * w**2, w * found.equivalent_damping)
        scale = min(abs(z), abs(fitted)) if abs(w / found.speed - 1.0) <= _SAME else abs(z)
        sizes.append((abs(z - fitted) / scale, w * 30.0 / pi))
    return max(sizes)


def misfit_warnings(model: Model, error: Tables) -> list[str]:
    """Says where Z over the whirl speeds is not what K and C make of it."""
    size = error["identification"]
    if (
        model.scene.excitation is None
        or "speeds" not in model.scene.identifier.method.needs
        or size is None
        or size <= _MUCH
    ):
        return []
    return [
        f"Z is not of the form K - m w^2 + j w C over these whirl speeds (misfit {size:.2g} of |Z|; free tilts, gyroscopic moments, "
        "a resonance): K and C are those of no speed, take identifier 'fft_1x' at each"
    ]
