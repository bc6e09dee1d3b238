"""Speed of the package, as ratios and times inside one run: ``python -m benchmarks.time_loop [--json]``.

Composed loop (function pointers between integrator, bodies, law and force) against a hand-fused one; a whole
``raceway run`` with warm caches; what a second process compiles; what light commands load.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import attrs
import numpy as np

from benchmarks.fused_loop import fused_loop
from benchmarks.processes import light_commands, second_process, whole_runs
from raceway import build_model, load_scene, make_plan
from raceway.bodies.model import Model
from raceway.core.ring.orbit import steady_orbit
from raceway.core.ring.start import from_orbit
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Motion, Record, Schedule
from raceway.pipeline.settle import settle

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "b7206.toml"
#: Two loops of the same physics, solved to 1e-9 of the largest force, differ by rounding only.
SAME = 1e-12
#: Composed over hand-fused, by the mass of the balls.
LIMIT = {"with centrifugal force": 1.15, "weightless": 1.3}
#: Short runs, many and by turns: on a machine that others use, only the least times of both meet the same machine.
_TURNS, _STEPS_PER_TURN, _REPEATS = 20, 360, 60


@attrs.frozen
class Loop:
    """One comparison: CPU time of a step [s], the least of several repeats, and how far the displacements differ.

    Attributes
    ----------
    deviation : largest difference of a displacement over the largest displacement
    """

    integrator: str
    balls: str
    composed: float
    fused: float
    deviation: float
    iterations: float

    @property
    def ratio(self) -> float:
        return self.composed / self.fused


def loops(repeats: int = _REPEATS) -> list[Loop]:
    """Both ball models with both kinds of time step, on the example's bearing."""
    return [compare(kind, inertial, repeats) for kind in ("newmark", "central_difference") for inertial in (True, False)]


def compare(kind: str, inertial: bool, repeats: int = _REPEATS) -> Loop:
    """One comparison."""
    changes = (
        f'integrator.kind="{kind}"',
        f"integrator.turns={_TURNS}",
        f"integrator.steps_per_turn={_STEPS_PER_TURN}",
        f"kinematics.ball_inertia={str(inertial).lower()}",
    )
    scene = load_scene(EXAMPLE, changes)
    model = build_model(scene, make_plan(scene))
    period = model.excitation.period_s
    schedule = Schedule(period / _STEPS_PER_TURN, _STEPS_PER_TURN, _TURNS)
    orbit = steady_orbit(model.system, period, settle(model).displacement)
    start = from_orbit(model.system, orbit, schedule.dt)
    _fused(model, start, attrs.evolve(schedule, turns=1), inertial)  # compiles
    composed, fused = [], []
    for _ in range(repeats):  # by turns, so that a slow moment of the machine meets both
        begin = time.process_time()
        record: Record = integrate(scene.integrator.method, model.system, start, schedule, None)
        middle = time.process_time()
        rows, iterations = _fused(model, start, schedule, inertial)
        composed.append(middle - begin)
        fused.append(time.process_time() - middle)
    ours = record.displacement
    deviation = float(np.abs(rows[:, 1:6] - ours).max() / np.abs(ours).max())
    if iterations != record.counts["evaluations"]:
        raise RuntimeError(f"the loops iterate differently: {iterations} against {record.counts['evaluations']}")
    steps = schedule.steps
    balls = "with centrifugal force" if inertial else "weightless"
    return Loop(kind, balls, min(composed) / steps, min(fused) / steps, deviation, iterations / steps)


def _fused(model: Model, start: Motion, schedule: Schedule, inertial: bool) -> tuple[np.ndarray, int]:
    """Rows of the record and the number of iterations; allocates what the package allocates, too."""
    s, z = model.system, model.geometry.ball_count
    method = model.scene.integrator.method
    implicit = bool(method.implicit)
    numbers = (method.beta, method.gamma, method.tolerance) if implicit else (0.25, 0.5, 0.0)
    rows, probes = np.zeros((schedule.steps, 16)), np.zeros((schedule.steps, 3, 2 * z))
    state = (start.q.copy(), start.v.copy(), start.a.copy(), start.ball.copy(), start.ball_before.copy())
    iterations = fused_loop(inertial, implicit)(
        s.scalars, s.table, np.array([model.inner.factor, model.outer.factor]), s.force_params, s.mass, s.damping,
        s.stiffness, s.free, s.load, *numbers, schedule.dt, schedule.steps, *state, rows, probes,
    )  # fmt: skip
    if iterations < 0:
        raise RuntimeError("the fused loop did not converge")
    return rows, iterations


def measure() -> dict[str, Any]:
    """Everything, as plain numbers."""
    return {
        "loops": [{**attrs.asdict(loop), "ratio": loop.ratio} for loop in loops()],
        "run": whole_runs(EXAMPLE),
        "second_process": second_process(EXAMPLE),
        "light_commands": light_commands(EXAMPLE),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="machine-readable")
    found = measure() if parser.parse_args().json else None
    if found is not None:
        print(json.dumps(found, indent=1))
        return
    for loop in loops():
        print(
            f"{loop.integrator}, balls {loop.balls}: {loop.composed * 1e9:.0f} ns a step against {loop.fused * 1e9:.0f} ns, "
            f"ratio {loop.ratio:.2f}, displacements differ by {loop.deviation:.1e}"
        )
    runs, second = whole_runs(EXAMPLE), second_process(EXAMPLE)
    print(f"raceway run, warm: {runs['minimum_s']:.2f} s at best, median {runs['median_s']:.2f} s")
    print(f"second process: {second['compiled']} kernels compiled, {second['loaded']} read, {second['new_files']} new files")
    for name, light in light_commands(EXAMPLE).items():
        print(f"raceway {name}: {light['minimum_s']:.2f} s, heavy packages loaded: {', '.join(light['heavy']) or 'none'}")


if __name__ == "__main__":
    main()
