"""scene -> plan -> model -> equilibrium -> motion -> identification -> result, within the time and memory of the plan.

A busy machine ends no run: what is counted is processor time.
"""

import os
import platform
from collections.abc import Callable
from functools import partial
from math import inf
from pathlib import Path

import attrs
import numpy as np

from raceway import __version__
from raceway.bodies.model import Equilibrium, Model, build_model
from raceway.core.jit import clock, take_compile_seconds, working_clock, working_process_time, working_processor_time
from raceway.core.record import Stay
from raceway.core.signals import Identification, Line, lines
from raceway.core.threads import compile_beside
from raceway.errors import BeyondPlanError, ConvergenceError, PluginError, RacewayError, SceneError
from raceway.framework.estimate import Estimate
from raceway.framework.loading.registry import Registry, default_registry
from raceway.pipeline import PATIENCE
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.error import Errors, body_errors, error_warnings, errors_of, misfit_warnings
from raceway.pipeline.identified import Identified, series_warnings, start_warnings, with_series_error
from raceway.pipeline.plausible import inertia_warnings, motion_warnings, pressure_warnings, refuse_impossible
from raceway.pipeline.quantities import stated_quantities
from raceway.pipeline.result import Result, band_table
from raceway.pipeline.simulate import OnProgress, Simulation, simulate, simulate_speeds, stability_of, work_of
from raceway.planning.plan import ScenePlan, make_plan, plan_of
from raceway.planning.resolve import Problem, resolve
from raceway.planning.rules import scene_warnings
from raceway.scene.scene import Scene
from raceway.scene.tables import TIME_CONSTANTS
from raceway.storage.tables import Tables

#: Shorter plans count as this one [s]: start-up and search for orbits are the less predictable the shorter the run.
_LEAST_S = 3.0
#: The same of memory: runs that converge stay within 1.6 times their plan (examples/b7206_elastic_coarse.toml at points, soft to stiff).
_MOST_MEMORY = 3.0
#: Kernels of a steady motion, the last of a run that are needed.
_OF_ORBITS = "raceway.core.periodic.newton:newton", "raceway.core.periodic.intervals:spread"
#: What kernels that compile, and libraries that load, may hold beyond the plan in a fresh process [B].
_COMPILING = 0.5e9


def run(
    scene: Scene,
    registry: Registry | None = None,
    on_progress: OnProgress | None = None,
    near: Result | None = None,
    patience: float = PATIENCE,
    stay: Stay = False,
) -> Result:
    """Compute one scene.

    on_progress : called as ``on_progress(what, done, total)`` between chunks of steps; an exception stops the run
    near : of a similar scene: what is dear to search for (equilibria of contacts at surface points, steady motions that are
        nearly linear) is searched for from its own, which changes the result within the tolerances of the search only
    stay : on the steady motion of ``near`` where several may exist, instead of searching for all, for scenes that follow one another,
        on a curve or in an iteration: which of them is found then depends on ``near``; "unstable": where it is unstable, too
    patience : times the planned time, of processor time, after which a run is stopped between its steps

    SceneError: A combination that cannot run.
    ConvergenceError, StabilityError, BeyondPlanError: No solution, or none in the time allowed; ``error.state`` holds the last good arrays.
    """
    registry = registry or default_registry()
    try:
        try:
            once = partial(_run, registry=registry, on_progress=on_progress, near=near, patience=patience, stay=stay)
            band = scene.contact.in_a_band and scene.excitation is not None
            result = _run_band(scene, once) if band else once(scene)
            try:
                registry.notify("raceway_run_finished", result=result)
            except RacewayError as why:  # what is computed is kept
                return attrs.evolve(result, warnings=(*result.warnings, f"after the run: {why}"))
            return result
        except (ArithmeticError, np.linalg.LinAlgError) as why:
            reason = f"the numbers of this scene exceed the range of floating-point arithmetic ({why}): check its units"
            raise ConvergenceError(reason) from why
    except RacewayError as error:
        try:
            registry.notify("raceway_run_failed", error=error)
        except PluginError as fault:  # what the run failed with comes first
            error.add_note(str(fault))
        raise


def _run_band(scene: Scene, once: Callable[[Scene], Result]) -> Result:
    """The result at the low end of the band of time constants, with ``band`` from both ends; cost is that of both runs."""
    contacts = [attrs.evolve(scene.contact, damping=0.0, time_constant=tau) for tau in TIME_CONSTANTS]
    low, high = (once(attrs.evolve(scene, contact=contact)) for contact in contacts)
    of_one = ("peak_memory_bytes", "threads", "device")
    sums = {key: value + high.cost[key] for key, value in low.cost.items() if key not in of_one}
    model = attrs.evolve(low.model, problem=resolve(scene))
    warnings = tuple(dict.fromkeys((*low.warnings, *high.warnings)))
    return attrs.evolve(low, model=model, cost={**high.cost, **sums}, band=band_table([low, high]), warnings=warnings)


def steady_plan(scene: Scene) -> ScenePlan:
    """The plan of a scene, with [heat] at its steady temperatures.

    ConvergenceError: There are none.
    """
    plan = make_plan(scene)
    if scene.heat is None:
        return plan
    from raceway.pipeline.warm import warm_plan

    return warm_plan(scene)


def _run(
    scene: Scene, registry: Registry, on_progress: OnProgress | None, near: Result | None, patience: float, stay: Stay
) -> Result:
    start, processor = working_clock(), working_process_time()
    plan = steady_plan(scene)
    allowance = Allowance.of(plan, patience)
    registry.notify("raceway_plan_made", plan=plan)
    steady = plan.problem.searches_orbits or (plan.problem.recorded and plan.problem.integrator.method.steady)
    compile_beside("raceway.core.ring.equilibrium:solve_equilibrium", *(_OF_ORBITS if steady else ()))
    model = build_model(scene, plan)
    after_model = working_clock()

    def progress(label: str, step: int, total: int) -> None:
        registry.notify("raceway_chunk_done", done=step, total=total)
        if on_progress is not None:
            on_progress(label, step, total)
        allowance.check(label, step, total)

    equilibrium = solve_equilibrium(model, progress, None if near is None else near.equilibrium.displacement)
    if model.excitation is None:
        answer = _Answer(body_errors(model, equilibrium, Estimate.STATIC_SCENE()))
    else:
        model, motions, doubts = _motions(model, equilibrium, progress, near, stay, allowance, registry)
        answer = _answer(model, equilibrium, motions, allowance, doubts)
    end, processor = working_clock(), working_process_time() - processor
    compile_s = take_compile_seconds()
    bodies = model.bearing.report(model, equilibrium) or None
    times = {"wall_s": end - start, "cpu_s": processor, "compile_s": compile_s, "compiled_kept": clock["unkept"] == 0}
    solve_s = end - after_model - answer.error_s
    times |= {"build_s": max(after_model - start, 0.0), "solve_s": solve_s, "error_s": answer.error_s}
    simulation = answer.motions[-1] if answer.motions else None
    quantities = stated_quantities(model, equilibrium, None if simulation is None else simulation.record)
    if scene.heat is not None:
        from raceway.pipeline.warm import band_of_heat, friction_band

        band = quantities.tables["heat"]["band"] = band_of_heat(scene, friction_band(quantities.values))
        if simulation is not None:
            band["not_computed"] = "the motion is computed at one set of temperatures; kyy at rest has a band"
    # Each once: a mesh too coarse for its answer comes first, keys without effect last.
    errors, identification = answer.errors, answer.identification
    warnings = [
        *answer.doubts,
        *error_warnings(errors, identification is not None),
        *misfit_warnings(model, errors.identification.size),
        *start_warnings(model, errors.transient.size, errors.transient.how),
        *series_warnings(identification),
        *model.bearing.warnings(model, equilibrium),
        *([] if identification is None else inertia_warnings(bodies, errors.total.size)),
        *pressure_warnings(model, equilibrium.contact_force),
        *equilibrium.warnings,
        *quantities.warnings,
        *(text for motion in answer.motions for text in (*motion.warnings, *motion_warnings(motion.model, motion.record))),
        *scene_warnings(model.problem),
    ]
    return Result(
        model=model,
        equilibrium=equilibrium,
        identification=answer.identification,
        simulation=simulation,
        errors=errors,
        cost={**times, **work_of(answer.motions)},
        stability=stability_of(answer.motions),
        environment=_environment(model.problem, registry),
        lines=_lines(model, simulation),
        bodies=bodies,
        stated=quantities,
        warnings=tuple(dict.fromkeys(warnings)),
    )


@attrs.frozen
class _Answer:
    """What a run has beside the equilibrium; ``doubts``: what went wrong on the way; ``error_s``: time of the error [s]."""

    errors: Errors
    identification: Identification | None = None
    motions: list[Simulation] = attrs.field(factory=list)
    error_s: float = 0.0
    doubts: tuple[str, ...] = ()


def _answer(
    model: Model, equilibrium: Equilibrium, motions: list[Simulation], allowance: "Allowance", doubts: list[str]
) -> _Answer:
    """What the scene's identifier finds in the motions, and its error.

    ConvergenceError: a motion that leaves the grooves, or without a number.
    """
    for motion in motions:
        refuse_impossible(motion.model, equilibrium, motion.whole)
    records = [motion.record for motion in motions]
    identification = model.problem.identifier.method.identify(records, equilibrium, model)
    if not np.isfinite(identification.dynamic_stiffness):
        raise ConvergenceError("the 1x displacement does no work with the force: no dynamic stiffness can be identified")
    at_value = Identified(model, equilibrium, motions, identification, allowance.check)
    start = working_clock()
    if allowance.spent:  # what is computed is kept
        doubts = [allowance.words("the error is not estimated, because the run far exceeded its plan"), *doubts]
        errors = Errors.unknown(Estimate.BEYOND_PLAN())
    else:
        errors = errors_of(at_value)
    identification = with_series_error(at_value, errors.time_step.size)
    return _Answer(errors, identification, motions, working_clock() - start, tuple(doubts))


def _motions(
    model: Model, equilibrium: Equilibrium, progress: OnProgress, near: Result | None, stay: Stay, allowance: "Allowance",
    registry: Registry,
) -> tuple[Model, list[Simulation], list[str]]:  # fmt: skip
    """The motions that the identifier needs, with their model and warnings; a similar scene's is followed by the same integrator.

    They are integrated over time where planning chose a steady orbit that is not found or is unstable.
    """
    needs, motions = model.problem.identifier.method.needs, list[Simulation]()
    automatic = model.problem.integrator.method.steady and model.problem.integrator_why != ""
    try:
        if "speeds" in needs:
            motions = simulate_speeds(model, progress)
        elif "record" in needs:
            follow = None if near is None else near.simulation
            motions = [simulate(model, equilibrium, progress, near=follow, stay=stay)]
    except (ConvergenceError, SceneError) as fault:
        if not automatic:
            raise
        why = f"no steady orbit was found ({str(fault).partition('. ')[0]})"
    else:
        if not automatic or all(motion.whole.counts["floquet"]["verdict"] != "unstable" for motion in motions):
            return model, motions, []
        why = "the steady orbit is unstable"
    plan = plan_of(model.problem.integrated(why))
    registry.notify("raceway_plan_made", plan=plan)
    allowance.planned += plan.predicted_wall_s
    model = attrs.evolve(model, problem=plan.problem, plan=plan)
    model, motions, _ = _motions(model, equilibrium, progress, near, stay, allowance, registry)
    return model, motions, [f"the motion is integrated over time: {why}"]


def _lines(model: Model, simulation: Simulation | None) -> list[Line]:
    """1x to 3x, and the ball-pass lines of orbiting balls, in the turns that identification uses."""
    if simulation is None or model.excitation.period_s is None or model.problem.several_speeds:
        return []
    frequency = model.excitation.frequency_hz
    frequencies = {f"{k}x": k * frequency for k in (1, 2, 3)}
    if model.problem.kinematics.orbiting:
        passing = model.geometry.ball_count * model.geometry.cage_speed(model.problem.spin_speed) / (2.0 * np.pi)
        frequencies |= {"ball pass": passing, "2x ball pass": 2.0 * passing}
    return lines(simulation.record.time, simulation.record.displacement, frequencies)


def _environment(problem: Problem, registry: Registry) -> Tables:
    import numba

    plugins = [("contact_law", problem.contact.kind), ("integrator", problem.integrator.kind)]
    plugins += [("identifier", problem.identifier.kind), ("bodies", problem.bodies.name)]
    plugins += [] if problem.excitation is None else [("excitation", problem.excitation.name)]
    entries = [registry.find(kind, name) for kind, name in plugins]
    return {
        "raceway": __version__,
        "python": platform.python_version(),
        "numba": numba.__version__,
        "numpy": np.__version__,
        "plugins": [{"kind": e.kind, "name": e.name, "distribution": e.distribution, "version": e.version} for e in entries],
        "host": f"{platform.system()} {platform.machine()}",
    }


@attrs.define
class Allowance:
    """Processor time [s] and memory [B] that a run may take; kernels that compile do not count.

    planned : predicted time of the run;  patience : how many times that may pass;  started : reading of the clock
    bytes : predicted memory at the peak, 0 where it has no limit;  held : what the process held before the run
    """

    planned: float
    patience: float
    started: float = attrs.field(factory=lambda: working_processor_time())
    bytes: float = 0.0
    held: float = attrs.field(default=attrs.Factory(lambda self: _resident_bytes() if self.bytes else 0.0, takes_self=True))

    @classmethod
    def of(cls, plan: ScenePlan, patience: float) -> "Allowance":
        """Without an end where the plan knows no more than what a run takes at least."""
        seconds = max(plan.predicted_wall_s, _LEAST_S)
        return cls(seconds, inf) if plan.at_least or patience == inf else cls(seconds, patience, bytes=plan.predicted_bytes)

    @property
    def taken(self) -> float:
        return working_processor_time() - self.started

    @property
    def grown(self) -> bool:
        """Whether the run itself holds far more than planned: what earlier runs left in the process is not its own."""
        return self.bytes > 0.0 and _resident_bytes() - self.held > _MOST_MEMORY * self.bytes + _COMPILING

    @property
    def spent(self) -> bool:
        return self.taken > self.patience * self.planned or self.grown

    def words(self, where: str) -> str:
        """Why a run is stopped, and the way out."""
        if self.grown:
            return (
                f"{where}: its memory far exceeds the predicted {self.bytes / 2**30:.2g} GiB: its contacts are far larger than "
                "the Hertz contacts for which the mesh is made. Use a stiffer law, a smaller load, or `--patience inf`"
            )
        return (
            f"{where}: {self.taken:.3g} s of processor time are over {self.patience:g} times the planned {self.planned:.3g} s. "
            "`raceway run --patience` sets another factor, or inf"
        )

    def check(self, label: str, step: int, total: int) -> None:
        """Stop a run between its steps: ``BeyondPlanError`` where much more than the plan's time is gone, and steps are left."""
        if self.spent and not 0 < total <= step:
            count = f"{step} of {total}" if total else str(step)
            raise BeyondPlanError(self.words(f"stopped far beyond the plan, in {label}, {count} done"))


def _resident_bytes() -> float:
    """Memory that this process holds; 0 where the system does not tell."""
    try:
        return float(Path("/proc/self/statm").read_text().split()[1]) * float(os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError):
        return 0.0
