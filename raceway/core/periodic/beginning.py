"""The periodic motion that a transient starts on, with what is known of its stability and of others.

Notes
-----
The search of ``raceway.core.periodic.search``, so that a transient and the steady orbit that is solved for directly are of one
motion.  Where it finds nothing, Fourier collocation (``raceway.core.ring.orbit``) may: its damped iteration ends on any motion.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.collocation import solve
from raceway.core.periodic.direct import HIGHEST, highest_order, mesh_of, problem_of
from raceway.core.periodic.neighbour import Recorded
from raceway.core.periodic.problem import Problem
from raceway.core.periodic.refinement import refine
from raceway.core.periodic.sampling import states
from raceway.core.periodic.search import Found, can_follow, find, found_by
from raceway.core.periodic.told import orbits, several, unstable
from raceway.core.ring.address import by_address
from raceway.core.ring.orbit import Orbit, States, evaluate_many, steady_orbit
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError
from raceway.storage.tables import Tables

#: Samples of an orbit, as many as Fourier collocation has, and error of the search over the motion.
_SAMPLES, _TOLERANCE = 65, 1e-7


@attrs.frozen(eq=False)
class Beginning:
    """The motion that a transient starts on.

    Attributes
    ----------
    orbit : periodic motion at equidistant times
    told : every motion that was found, as ``raceway.core.periodic.told`` tells them; empty where nothing could be said
    warnings : what a user should know
    """

    orbit: Orbit
    told: list[Tables] = attrs.field(factory=list)
    warnings: tuple[str, ...] = ()


def beginning(system: System, period: float, q: np.ndarray, watch: Callable[[], None] | None = None) -> Beginning | None:
    """The motion to start on; None where it is not searched for, because each try would take seconds.

    Parameters
    ----------
    system : with compiled forces, without friction, memory and orbiting balls;  q : (5,) static equilibrium
    watch : called in the search, which what it raises ends

    Raises
    ------
    ConvergenceError
        No periodic motion found.
    """
    system = by_address(system)
    tangent = system.evaluate(q).stiffness
    problem = problem_of(system, 2.0 * np.pi / period, q)
    if not can_follow(problem, q, tangent):
        return None
    if watch is not None:
        problem = attrs.evolve(problem, watch=watch)
    try:
        found = find(problem, q, tangent, _TOLERANCE)
    except ConvergenceError:
        orbit, highest = steady_orbit(system, period, q, _SAMPLES), highest_order(problem, tangent)
        try:
            found = _collocated(problem, orbit, highest)
        except ConvergenceError:
            if highest <= HIGHEST:
                raise
            return Beginning(orbit)  # so slow that no mesh holds the vibrations that it has none of
    told = orbits(found.all)
    warnings = several(told)
    if not told[0]["stable"]:
        warnings += (
            f"the motion starts on a steady orbit that is unstable, {unstable(told[0])}; no stable one was found, and a real "
            "ring does not stay on it",
        )
    return Beginning(sampled(found, period), told, warnings)


def _collocated(problem: Problem, orbit: Orbit, highest: float) -> Found:
    """The motion of Fourier collocation, solved for once more on a mesh."""
    known = Recorded(orbit.period, orbit.displacement, orbit.velocity, orbit.acceleration)
    path = known.first_guess(problem, np.zeros(5), np.zeros((5, 5)), mesh_of(problem, highest))
    return found_by(refine(solve(problem, path, 1e-2 * _TOLERANCE), _TOLERANCE), highest, "by Fourier collocation")


def sampled(found: Found, period: float) -> Orbit:
    """A motion at equidistant times of a turn."""
    solved = found.refined.solved
    problem, system = solved.problem, solved.problem.system
    times = period / _SAMPLES * np.arange(_SAMPLES)
    q, v, a, ball, rate = states(solved, problem.speed * times)
    q, v = np.ascontiguousarray(q), np.ascontiguousarray(v * problem.speed)
    f, K, C = np.empty((_SAMPLES, 5)), np.empty((_SAMPLES, 5, 5)), np.empty((_SAMPLES, 5, 5))
    done = evaluate_many(system.compiled_forces, system.law_state, States(times, q, v, ball, rate), f, K, C)
    if done < _SAMPLES:
        raise ConvergenceError("the balls find no place between the races", {"q": q[done].copy()})
    force = np.array([system.outer_force(t) for t in times])
    iterations = found.refined.sweeps
    return Orbit(period, q, v, a * problem.speed**2, force, ball, K, C, found.refined.error, iterations)
