"""scene -> plan -> model -> settle -> advance -> identify -> result, within the time and memory of the plan.

A busy machine ends no run: what is counted is processor time.
"""

from __future__ import annotations

import os
import platform
import resource
import sys
from collections.abc import Callable
from functools import partial
from math import inf
from pathlib import Path

import attrs
import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model, build_model
from raceway.core.jit import clock, take_compile_seconds, working_clock, working_process_time, working_processor_time
from raceway.core.record import drift, friction_lost, largest_share
from raceway.core.ring.energy import energy_balance
from raceway.core.ring.kernels.layout import GYROSCOPIC
from raceway.core.ring.system import compiled
from raceway.core.signals import Identification, Line, lines
from raceway.errors import BeyondPlanError, ConvergenceError, PluginError, RacewayError
from raceway.framework.estimate import Estimate
from raceway.framework.registry import Registry, default_registry
from raceway.pipeline.error import body_errors, error_table, error_warnings, misfit_warnings, no_error, unresolved
from raceway.pipeline.plausible import (
    inertia_warnings,
    motion_warnings,
    pressure_warnings,
    refuse_impossible,
    sliding_warnings,
)
from raceway.pipeline.result import Result, run_band
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress, Simulation, simulate, simulate_speeds
from raceway.pipeline.transient_error import Settled, series_warnings, start_warnings, with_series_error
from raceway.planning.implausible import implausible
from raceway.planning.plan import Plan, make_plan
from raceway.scene.scene import Scene
from raceway.scene.unused import unused
from raceway.storage.tables import Tables

#: A run is stopped beyond so many times its predicted time; predictions are within a factor of three of measured ones.
PATIENCE = 20.0
#: Shorter plans count as this one [s]: start-up and search for orbits are the less predictable the shorter the run.
_LEAST_S = 3.0
#: The same of memory: runs that converge stay within 1.6 times their plan (examples/b7206_elastic_coarse.toml at points, soft to stiff).
_MOST_MEMORY = 3.0
#: What kernels that compile, and libraries that load, may hold beyond the plan in a fresh process [B].
_COMPILING = 0.5e9


@attrs.define
class Allowance:
    """Processor time [s] and memory [B] that a run may take; kernels that compile count for nothing.

    Attributes
    ----------
    planned : predicted time of the whole run;  patience : how many times that may pass;  begun : reading of the clock
    bytes : predicted memory at the peak, 0 where it has no limit;  held : what the process held before the run
    """

    planned: float
    patience: float
    begun: float = attrs.field(factory=lambda: working_processor_time())
    bytes: float = 0.0
    held: float = attrs.field(factory=lambda: resident_bytes())

    @classmethod
    def of(cls, plan: Plan, patience: float) -> Allowance:
        """Without an end where the plan knows no more than what a run takes at least."""
        if plan.at_least or patience == inf:
            return cls(max(plan.predicted_wall_s, _LEAST_S), inf)
        return cls(max(plan.predicted_wall_s, _LEAST_S), patience, bytes=plan.predicted_bytes)

    @property
    def taken(self) -> float:
        return working_processor_time() - self.begun

    @property
    def grown(self) -> bool:
        """Whether the run itself holds far more than planned: what earlier runs left in the process is not its own."""
        return self.bytes > 0.0 and resident_bytes() - self.held > _MOST_MEMORY * self.bytes + _COMPILING

    @property
    def spent(self) -> bool:
        return self.taken > self.patience * self.planned or self.grown

    def words(self, where: str) -> str:
        """What a person is told of a run that is stopped."""
        if self.grown:
            return (
                f"{where}: its memory is far over the planned {self.bytes / 2**30:.2g} GiB: its contacts are far larger than "
                "those of Hertz that the mesh is made for. Take a stiffer law, a smaller load, or `--patience inf`"
            )
        return (
            f"{where}: {self.taken:.3g} s of processor time are over {self.patience:g} times the planned {self.planned:.3g} s. "
            "`raceway run --patience` takes another factor, or inf"
        )

    def check(self, what: str, done: int, total: int) -> None:
        """Stop a run between its steps.

        Raises
        ------
        BeyondPlanError
            Much more than the plan's time is gone, and steps are left.
        """
        if self.spent and not 0 < total <= done:
            raise BeyondPlanError(self.words(f"stopped far beyond the plan, in {what}, {_told(done, total)} done"))


def resident_bytes() -> float:
    """Memory that this process holds; 0 where the system does not tell."""
    try:
        return float(Path("/proc/self/statm").read_text().split()[1]) * float(os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError):
        return 0.0


def _told(done: int, total: int) -> str:
    return f"{done} of {total}" if total else str(done)


def run(
    scene: Scene,
    registry: Registry | None = None,
    on_progress: OnProgress | None = None,
    near: Result | None = None,
    patience: float = PATIENCE,
    stay: bool = False,
) -> Result:
    """Compute one scene.

    Parameters
    ----------
    on_progress : called as ``on_progress(what, done, total)`` between chunks of steps; an exception stops the run
    near : of a similar scene: what is dear to search for (equilibria of contacts at surface points, steady motions that are
        nearly linear) is searched for from its own, which changes the result within the tolerances of the search only
    stay : on the steady motion of ``near`` where several may exist, instead of searching for all, for scenes that are tried
        one after another in an iteration: which of them is found then depends on ``near``
    patience : times the planned time, of processor time, after which a run is stopped between its steps

    Raises
    ------
    SceneError
        A combination that cannot run.
    ConvergenceError, StabilityError, BeyondPlanError
        No solution, or none in the time allowed; ``error.state`` holds the last good arrays.
    """
    registry = registry or default_registry()
    try:
        try:
            once = partial(_run, registry=registry, on_progress=on_progress, near=near, patience=patience, stay=stay)
            band = scene.contact.in_a_band and scene.excitation is not None
            return _finished(run_band(scene, once) if band else once(scene), registry)
        except (ArithmeticError, np.linalg.LinAlgError) as why:
            raise ConvergenceError(
                f"the numbers of this scene leave what can be computed with ({why}): check its units"
            ) from why
    except RacewayError as error:
        try:
            registry.notify("raceway_run_failed", error=error)
        except PluginError as other:  # what the run failed with comes first
            error.add_note(str(other))
        raise


def _run(
    scene: Scene,
    registry: Registry,
    on_progress: OnProgress | None,
    near: Result | None,
    patience: float,
    stay: bool,
) -> Result:
    wall, processor = working_clock(), working_process_time()
    plan = make_plan(scene)
    allowance = Allowance.of(plan, patience)
    registry.notify("raceway_plan_made", plan=plan)
    model = build_model(scene, plan)
    built = working_clock()

    def progress(what: str, done: int, total: int) -> None:
        registry.notify("raceway_chunk_done", done=done, total=total)
        if on_progress is not None:
            on_progress(what, done, total)
        allowance.check(what, done, total)

    equilibrium = settle(model, progress, None if near is None else near.equilibrium.displacement)
    if scene.excitation is None:
        found = _Found(body_errors(model, equilibrium, Estimate.STATIC_SCENE()))
    else:
        found = _dynamic(model, equilibrium, allowance, partial(_moved, model, equilibrium, progress, near, stay))
    found.error["unresolved"] = unresolved(found.error)
    done, processor = working_clock(), working_process_time() - processor
    compile_s = take_compile_seconds()
    bodies = model.bearing.report(model, equilibrium) or None
    times = {
        "wall_s": done - wall,
        "cpu_s": processor,
        "compile_s": compile_s,
        "build_s": built - wall,
        "solve_s": done - built,
    }
    return Result(
        model=model,
        equilibrium=equilibrium,
        identification=found.identification,
        simulation=found.simulation,
        error=found.error,
        cost=_cost([one for _, one in found.motions], times, found.error_s),
        stability=_stability(found.motions),
        environment=_environment(scene, registry),
        lines=_lines(model, found.simulation),
        bodies=bodies,
        warnings=_warnings(model, equilibrium, found, bodies),
    )


def _finished(result: Result, registry: Registry) -> Result:
    """The result, with what plug-ins that hear of it fail in."""
    try:
        registry.notify("raceway_run_finished", result=result)
    except RacewayError as why:  # what is computed is kept
        return attrs.evolve(result, warnings=(*result.warnings, f"after the run: {why}"))
    return result


@attrs.frozen
class _Found:
    """What a run found beside the equilibrium; ``warned``: what went wrong on the way; ``error_s``: time of the error [s]."""

    error: Tables
    identification: Identification | None = None
    motions: list[tuple[Model, Simulation]] = attrs.field(factory=list)
    error_s: float = 0.0
    warned: tuple[str, ...] = ()

    @property
    def simulation(self) -> Simulation | None:
        return self.motions[-1][1] if self.motions else None


def _dynamic(
    model: Model, equilibrium: Equilibrium, allowance: Allowance, move: Callable[[], list[tuple[Model, Simulation]]]
) -> _Found:
    """Motion, what is identified from it, and the error of that."""
    motions = move()
    for one, motion in motions:
        refuse_impossible(one, equilibrium, motion.whole)
    identification = model.scene.identifier.method.identify([one.record for _, one in motions], equilibrium, model)
    _refuse_no_number(identification)
    begun, warned, steady = working_clock(), [], Settled(model)
    if allowance.spent:  # what is computed is kept
        warned.append(allowance.words("the error is not estimated, because this run went far beyond its plan"))
        error = no_error(Estimate.BEYOND_PLAN())
    else:
        error = error_table(model, equilibrium, motions, identification, steady, allowance.check)
    identification = with_series_error(model, identification, error, steady, allowance.check)
    return _Found(error, identification, motions, working_clock() - begun, tuple(warned))


def _moved(
    model: Model, equilibrium: Equilibrium, progress: OnProgress, near: Result | None, stay: bool
) -> list[tuple[Model, Simulation]]:
    """The motions that the identifier needs, each with its model."""
    needs = model.scene.identifier.method.needs
    if "speeds" in needs:
        return simulate_speeds(model, progress)
    if "record" in needs:
        return [(model, simulate(model, equilibrium, progress, near=_followed(model.scene, near), stay=stay))]
    return []


def _warnings(model: Model, equilibrium: Equilibrium, found: _Found, bodies: Tables | None) -> tuple[str, ...]:
    """Each once: a mesh too coarse for its answer comes first, keys without effect last."""
    error, identification = found.error, found.identification
    every = [
        *found.warned,
        *error_warnings(error, identification is not None),
        *misfit_warnings(model, error),
        *start_warnings(model, error),
        *series_warnings(identification),
        *model.bearing.warnings(model, equilibrium),
        *([] if identification is None else inertia_warnings(bodies, error["total"])),
        *pressure_warnings(model, equilibrium.contact_force),
        *equilibrium.warnings,
        *sliding_warnings(model, equilibrium),
        *_motion_warnings(found.motions),
        *implausible(model.scene),
        *unused(model.scene),
    ]
    return tuple(dict.fromkeys(every))


def _followed(scene: Scene, near: Result | None) -> Simulation | None:
    """The motion of a similar scene, where it is one by the same integrator."""
    same = near is not None and near.model.scene.integrator.kind == scene.integrator.kind
    return near.simulation if same and near is not None else None


def _lines(model: Model, simulation: Simulation | None) -> list[Line]:
    """1x to 3x, and the ball-pass lines of orbiting balls, in the turns that identification uses."""
    if simulation is None or model.excitation.period_s is None or "speeds" in model.scene.identifier.method.needs:
        return []
    frequency = model.excitation.frequency_hz
    wanted = {f"{k}x": k * frequency for k in (1, 2, 3)}
    if model.scene.kinematics.orbiting:
        passing = model.geometry.ball_count * model.geometry.cage_speed(model.scene.spin_speed) / (2.0 * np.pi)
        wanted |= {"ball pass": passing, "2x ball pass": 2.0 * passing}
    return lines(simulation.record.time, simulation.record.displacement, wanted)


def _motion_warnings(motions: list[tuple[Model, Simulation]]) -> list[str]:
    return [w for model, one in motions for w in (*one.warnings, *motion_warnings(model, one.record))]


def _refuse_no_number(found: Identification) -> None:
    if not np.isfinite([found.dynamic_stiffness.real, found.dynamic_stiffness.imag]).all():
        raise ConvergenceError("the 1x displacement does no work with the force: no dynamic stiffness can be identified")


def _cost(simulations: list[Simulation], times: dict[str, float], error_s: float) -> Tables:
    """``times``: wall time, and those of compiling, building and solving, the error's in the last [s]."""
    scale = 1 if sys.platform == "darwin" else 1024
    return {
        **times,
        "compiled_kept": clock["unkept"] == 0,
        "build_s": max(times["build_s"], 0.0),
        "solve_s": times["solve_s"] - error_s,
        "error_s": error_s,
        "steps": sum(one.whole.counts["steps"] for one in simulations),
        "newton_iterations": sum(one.whole.counts["evaluations"] for one in simulations),
        "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale,
        "threads": max((one.whole.counts.get("threads", 1) for one in simulations), default=1),
    }


def _stability(motions: list[tuple[Model, Simulation]]) -> Tables:
    """The table ``stability``: the worst of all motions (several speeds may be run); friction's energy is their sum."""
    drifts = [one for one in (_drift(*motion) for motion in motions) if one is not None]
    rubbing = [_friction(m, s) for m, s in motions if m.scene.contact.friction > 0.0]
    told = [s.whole.energies for _, s in motions if s.whole.energies]
    limits = [s.critical_time_step for _, s in motions if s.critical_time_step is not None]
    fates = [s.whole.counts["floquet"] for _, s in motions if s.whole.counts.get("floquet") is not None]
    return {
        "floquet": max(fates, key=lambda fate: fate["largest"], default=None),
        "friction_energy_j": float(sum(rubbing)) if rubbing else None,
        "critical_time_step_s": min(limits, default=None),
        "energy_drift": max(drifts, default=None),
        "hourglass_energy_ratio": max((largest_share(one, "hourglass", "elastic") for one in told), default=None),
        "energies_j": {name: float(values[-1]) for name, values in told[-1].items()} if told else None,
        "max_penetration_m": max((s.whole.counts["max_penetration_m"] for _, s in motions), default=None),
        "status": "completed",
    }


def _friction(model: Model, simulation: Simulation) -> float:
    """Energy that friction took from a motion [J]."""
    if simulation.whole.energies:
        return friction_lost(simulation.whole.energies)
    return model.bearing.friction_lost(model.system, simulation.whole)


def _drift(model: Model, simulation: Simulation) -> float | None:
    """Drift of the energy balance; None where the motion's energy is not defined or is not balanced."""
    if simulation.whole.energies:
        return drift(simulation.whole.energies)
    if not model.traits.resultants:
        return None  # the energy that points store is not told by the gap of the pair
    law = model.scene.contact.law
    potential = law.state_size == 0 and not law.dissipative and model.system.scalars[GYROSCOPIC] == 0.0
    # What changes the speed of the balls does work, too.
    steady = simulation.start.kind != "ramp" and not model.scene.kinematics.orbiting and model.system.spin is None
    if not (potential and steady and model.scene.integrator.method.inertial):
        return None
    ring = compiled(model.system)
    return None if ring is None else energy_balance(ring, simulation.whole).drift


def _environment(scene: Scene, registry: Registry) -> Tables:
    import numba

    from raceway import __version__

    used = [
        ("contact_law", scene.contact.kind),
        ("integrator", scene.integrator.kind),
        ("identifier", scene.identifier.kind),
        ("bodies", scene.bodies.name),
    ]
    if scene.excitation is not None:
        used.append(("excitation", scene.excitation.name))
    entries = [registry.find(kind, name) for kind, name in used]
    return {
        "raceway": __version__,
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
        "plugins": [{"kind": e.kind, "name": e.name, "distribution": e.distribution, "version": e.version} for e in entries],
        "host": f"{platform.system()} {platform.machine()}",
    }
