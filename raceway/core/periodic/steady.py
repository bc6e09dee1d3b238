"""From a system and an equilibrium to the record of its periodic motion."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.direct import problem_of
from raceway.core.periodic.sampling import record
from raceway.core.periodic.search import Found, find
from raceway.core.periodic.told import orbits, several, unstable
from raceway.core.ring.address import by_address
from raceway.core.ring.kernels.layout import CAGE, FRICTION
from raceway.core.ring.ring import Ring
from raceway.core.ring.surrogate import compiled, surrogate
from raceway.core.ring.system import System
from raceway.core.stepping.record import Motion, Record, Schedule
from raceway.errors import SceneError
from raceway.storage.tables import Tables

#: Imbalance of an equilibrium over the contact forces that the settled state is known by.
_SETTLED = 1e-8


def steady(
    ring: Ring,
    start: Motion,
    schedule: Schedule,
    tolerance: float,
    symmetric: bool = True,
    on_chunk: Callable[[int, int], None] | None = None,
) -> Record:
    """The motion that repeats itself after a turn of ``schedule``, sampled at its steps.

    Parameters
    ----------
    start : near a static equilibrium, from which the motion is searched for; its ``near`` is the solution of a similar problem,
        or a turn that was recorded

    Raises
    ------
    SceneError
        Bodies that are stepped from Python, friction, a law with memory, a force that does not repeat itself, or balls that orbit
        without the symmetry of a pitch.
    ConvergenceError
        No such motion found.
    """
    refuse(ring, schedule)
    system = by_address(surrogate(ring))
    speed = 2.0 * np.pi / (schedule.dt * schedule.steps_per_turn)
    q, tangent = _equilibrium(system.without(CAGE), start)
    problem = problem_of(system, speed, q, symmetric)
    if system.scalars[CAGE] != 0.0 and not problem.symmetry.pitch:
        why = (
            "balls that orbit pass at another frequency than the force, so that no motion repeats itself every turn; only a "
            "force that turns over equal balls without a radial load has one (integrator.symmetry = 'auto'). Use 'newmark'"
        )
        raise SceneError.at("integrator.kind", "periodic", why)
    if on_chunk is not None:
        problem = attrs.evolve(problem, watch=lambda: on_chunk(0, schedule.steps))
    found = find(problem, q, tangent, tolerance, start.near, start.stay)
    refined, told = found.refined, orbits(found.all)
    counts = {
        "steps": refined.solved.path.intervals,
        "evaluations": refined.evaluations,
        "error": refined.error,
        "floquet": {**found.fate.to_dict(), "span_deg": float(np.degrees(problem.symmetry.span)), "found": found.how},
        "orbits": told,
        "warnings": warnings(found, told, tolerance),
    }
    out = attrs.evolve(record(refined.solved, schedule, counts), solution=found.neighbour(q, tangent))
    if on_chunk is not None:
        on_chunk(schedule.steps, schedule.steps)
    return out


def _equilibrium(system: System, start: Motion) -> tuple[np.ndarray, np.ndarray]:
    """The static equilibrium (5,) that the start is at or near, and its tangent (5, 5)."""
    now = system.evaluate(start.q, ball=start.ball)
    rest = np.abs((now.force + system.stiffness @ start.q - system.load) * system.free)
    largest = max(float(np.abs(now.contact_force).sum()), float(np.abs(system.load).max()))
    if rest.max() <= _SETTLED * largest:
        return start.q, now.stiffness
    q, ball, _ = system.settle(start.q)
    return q, system.evaluate(q, ball=ball).stiffness


def refuse(system: Ring, schedule: Schedule) -> None:
    """Raise ``SceneError`` for what has no motion that repeats itself every turn, or none that depends on the force alone."""
    if compiled(system) is None:
        why = "bodies that are stepped from Python have no compiled forces to linearise thousands of states with. Use 'newmark'"
        raise SceneError.at("integrator.kind", "periodic", why)
    if system.law_state.shape[1] > 0:
        why = "a contact law with memory has no periodic motion that can be solved for by itself. Use 'newmark'"
        raise SceneError.at("integrator.kind", "periodic", why)
    if system.scalars[FRICTION] != 0.0:
        why = "where a contact with friction sticks depends on how the motion began: there is no single one. Use 'newmark'"
        raise SceneError.at("integrator.kind", "periodic", why)
    turn = schedule.dt * schedule.steps_per_turn
    pairs = [(system.outer_force(part * turn), system.outer_force((1.0 + part) * turn)) for part in (0.0, 0.31, 0.77)]
    largest = max(float(np.abs(one).max()) for one, _ in pairs)
    if any(np.abs(one - two).max() > 1e-9 * largest for one, two in pairs):
        raise SceneError.at("integrator.kind", "periodic", "the force does not repeat itself every turn. Use 'newmark'")


def warnings(found: Found, told: list[Tables], tolerance: float) -> tuple[str, ...]:
    """What a user should know of a motion that was hard to find, is not stable or not alone, or not as exact as asked for."""
    out = list(several(told))
    if found.fold is not None:
        out.append(
            f"no motion grows out of rest: its branch turns back at {100.0 * found.fold:.3g} % of the force (an internal "
            f"resonance); this motion was reached {found.how}, and others may exist"
        )
    if found.fate.verdict == "unstable":
        out.append(f"the periodic motion is unstable, {unstable(told[0])}; a real ring does not stay on it")
    if found.refined.error > tolerance:
        out.append(f"the mesh cannot follow the motion closer than {found.refined.error:.1e} of its amplitude")
    return tuple(out)
