"""Scenes and measurements of the report ``periodic``."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import attrs
import numpy as np

from raceway import scene_from_dict
from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.periodic.branch import Point
from raceway.core.periodic.direct import highest_order, mesh_of, problem_of
from raceway.core.periodic.from_rest import from_rest
from raceway.core.periodic.sampling import motion_at
from raceway.core.periodic.symmetry import one_turn
from raceway.core.ring.address import by_address
from raceway.core.ring.orbit import steady_orbit
from raceway.core.signals.identification import stiffness
from raceway.errors import ConvergenceError
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import simulate
from validation.scenes import model_of, rotating

Tables = dict[str, Any]


def scene(kind: str = "periodic", axial: float = 1000.0, tilt: str = "locked", rpm: float = 12000.0, inertia: bool = False,
          **tables: Any) -> Tables:  # fmt: skip
    """The article's bearing with its rotating force, changed."""
    found = rotating(axial, tilt, rpm, inertia, kind)
    for table, values in tables.items():
        found[table] = {**found.get(table, {}), **values}
    return found


ONE_WAY = {"kind": "unidirectional"}


def solved(tables: Tables) -> Result:
    return run(scene_from_dict(tables))


def by_turns(tables: Tables, turns: int, steps: int) -> Result:
    """The same scene by Newmark's method, with a C2 ramp over two thirds of the turns."""
    found = copy.deepcopy(tables)
    found["integrator"] = {"kind": "newmark", "turns": turns, "steps_per_turn": steps, "start": "ramp"}
    return solved(found)


def apart(one: Result, two: Result) -> float:
    """Relative distance of the dynamic stiffnesses."""
    z, other = one.identification.dynamic_stiffness, two.identification.dynamic_stiffness
    return abs(z - other) / abs(other)


def cpu_ms(work: Callable[[], Any], repeats: int) -> float:
    """Least processor time of a few calls [ms]; the first one, which may compile, is not counted."""
    work()
    least = np.inf
    for _ in range(repeats):
        begin = time.process_time_ns()
        work()
        least = min(least, (time.process_time_ns() - begin) * 1e-6)
    return float(least)


def prepared(tables: Tables) -> tuple[Model, Equilibrium]:
    model = model_of(tables)
    return model, settle(model)


def solve_ms(tables: Tables, repeats: int) -> float:
    """Processor time from the equilibrium to the recorded motion, the start on the orbit included [ms]."""
    model, equilibrium = prepared(tables)
    return cpu_ms(lambda: simulate(model, equilibrium), repeats)


def methods(tables: Tables) -> list[tuple[str, float, float]]:
    """Method, relative error of Z and processor time [ms] of ways to the steady orbit of one scene."""
    wanted = _value(_with(tables, tolerance=1e-11))
    found = []
    for symmetry in ("auto", "none"):
        for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
            one = _with(tables, tolerance=tolerance, symmetry=symmetry)
            words = (
                f"periodic, {'one turn' if symmetry == 'none' else 'symmetry where there is one'}, tolerance {tolerance:g}"
            )
            found.append((words, abs(_value(one) / wanted - 1.0), solve_ms(one, 10)))
    model, equilibrium = prepared(tables)
    for samples in (17, 33, 65, 129, 257):
        words = f"Fourier collocation, {samples} times"
        try:
            orbit = steady_orbit(model.system, model.excitation.period_s, equilibrium.displacement, samples)
        except ConvergenceError as why:
            found.append((f"{words}: {str(why)[:60]}", float("nan"), float("nan")))
            continue
        force, line = (np.fft.fft(part, axis=0)[1] for part in (orbit.force, orbit.displacement))
        period, start = model.excitation.period_s, equilibrium.displacement
        spent = cpu_ms(partial(steady_orbit, model.system, period, start, samples), 3)
        found.append((words, abs(stiffness(force, line) / wanted - 1.0), spent))
    for steps in (90, 360, 1440):
        one = copy.deepcopy(tables)
        one["integrator"] = {"kind": "newmark", "turns": 12, "steps_per_turn": steps}
        found.append((f"newmark, 12 turns of {steps} steps", abs(_value(one) / wanted - 1.0), solve_ms(one, 5)))
    return found


def _with(tables: Tables, **options: Any) -> Tables:
    return {**tables, "integrator": {"kind": "periodic", **options}}


def _value(tables: Tables) -> complex:
    return solved(tables).identification.dynamic_stiffness


@attrs.frozen
class Resonance:
    """How the branch from rest of a scene ends.

    Attributes
    ----------
    orders : natural frequencies over the force's;  fold : largest share of the force on the branch
    ends_at : share at its last point;  order : harmonic that is largest there, and its amplitude [m]
    """

    orders: np.ndarray
    fold: float
    ends_at: float
    order: int
    amplitude: float


def resonance(tables: Tables) -> Resonance:
    """Follow the motions of a scene from no force on."""
    model, equilibrium = prepared(tables)
    system = by_address(model.system)
    speed = 2.0 * np.pi / model.excitation.period_s
    tangent, q = equilibrium.stiffness, equilibrium.displacement
    problem = attrs.evolve(problem_of(system, speed, q, False), symmetry=one_turn(system))
    points = list(from_rest(problem, q, tangent, mesh_of(problem, highest_order(problem, tangent))))
    last = _lines(points[-1])
    order = int(np.argmax(last))
    fold = max(point.parameter for point in points)
    orders = system.natural_frequencies(tangent) / speed
    return Resonance(orders, fold, points[-1].parameter, order, float(last[order]))


def _lines(point: Point) -> np.ndarray:
    """Largest amplitude of each harmonic over the translations [m]."""
    angles = 2.0 * np.pi / 256 * np.arange(256)
    q = motion_at(point.solved.problem, point.solved.path, angles)[0]
    lines = 2.0 / 256 * np.abs(np.fft.rfft(q[:, :3], axis=0))
    lines[0] = 0.0
    return lines.max(axis=1)
