"""From a system and an equilibrium to the record of its periodic motion: found directly, from a neighbour, or along branches."""

from collections.abc import Callable, Sequence

import attrs
import numpy as np

from raceway.core.periodic import search
from raceway.core.periodic.collocation import Problem, Solved, solve
from raceway.core.periodic.floquet import Floquet
from raceway.core.periodic.intervals import forces
from raceway.core.periodic.refinement import displacements, record, refine, states
from raceway.core.periodic.search import Neighbour, PeriodicMotion, Recorded
from raceway.core.record import Motion, Record, Schedule, Stay
from raceway.core.ring.kernels.layout import CAGE, FRICTION
from raceway.core.ring.orbit import Orbit, States, responses, steady_orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import System, compiled, surrogate
from raceway.core.signals import stiffness
from raceway.errors import ConvergenceError, SceneError
from raceway.storage.tables import Tables

#: Samples of a turn for its 1x line: a path has no more intervals as a rule, and harmonics up to this order alias nothing.
_OF_A_TURN = 2.0 * np.pi * np.arange(360) / 360

_WAYS = {
    "+1": "through +1: it drifts to another motion",
    "-1": "through -1: the period doubles",
    "pair": "as a pair: a second frequency arises",
}


def orbit_tables(motions: Sequence[PeriodicMotion]) -> list[Tables]:
    """``motion.orbits`` of result.json: every motion that was found, the one that is taken first."""
    tables = []
    for motion in motions:
        floquet, (z, amplitude) = motion.floquet, synchronous_response(motion.refined.solved)  # of the 1x line
        tables.append({
            "dynamic_stiffness": {"real": z.real, "imag": z.imag, "abs": abs(z)},
            "amplitude_m": amplitude,
            "multiplier": floquet.largest,
            "verdict": floquet.verdict,
            "leaves_by": floquet.leaves_by or None,
            "stable": floquet.verdict != "unstable",
            "found": motion.how,
            "taken": motion is motions[0],
        })  # fmt: skip
    return tables


def synchronous_response(solution: Solved, angles: np.ndarray = _OF_A_TURN) -> tuple[complex, float]:
    """Z [N/m] along the force and the major semi-axis [m] of the radial motion's synchronous (1x) component, at angles (n,) of whole turns."""
    problem, push = solution.problem, np.empty((len(angles), 5))
    forces(problem.system.force, problem.system.force_params, angles / problem.clock, push)
    phasor = 2.0 / len(angles) * np.exp(-1j * angles)
    line, force = phasor @ displacements(solution, angles), phasor @ push
    forward, backward = 0.5 * abs(line[1] - 1j * line[2]), 0.5 * abs(line[1] + 1j * line[2])
    return complex(stiffness(force, line)), float(forward + backward)


def _coexistence(motions: Sequence[PeriodicMotion]) -> tuple[str, ...]:
    """What a user should know where more than one motion exists that a ring can stay on."""
    lasting = [motion for motion in motions if motion.floquet.verdict != "unstable"]
    if len(lasting) < 2:
        return ()
    stiffnesses = [synchronous_response(motion.refined.solved)[0] for motion in lasting]
    values = " and ".join(
        f"{1e-6 * z.real:.5g} {'-' if z.imag < 0.0 else '+'} {1e-6 * abs(z.imag):.4g}j" for z in stiffnesses
    )
    return (
        f"{len(lasting)} steady motions that are not unstable exist here, Z = {values} N/µm: the history decides which one occurs. The "
        "first is reported; motion.orbits lists all found, others may exist",
    )


def growth_of_disturbances(floquet: Floquet) -> str:
    """Growth of disturbances of an unstable motion, in words."""
    return f"disturbances grow {floquet.largest:.4g} times per turn, {_WAYS[floquet.leaves_by]}"


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

    start : near a static equilibrium, from which the motion is searched for; its ``near`` is the solution of a similar problem,
        or a turn that was recorded

    SceneError: Bodies that are stepped from Python, friction, a law with memory, a force that does not repeat itself, or balls that orbit
        without the symmetry of a pitch.
    ConvergenceError: No such motion found.
    """
    refuse(ring, schedule)
    system = surrogate(ring)
    speed = 2.0 * np.pi / (schedule.dt * schedule.steps_per_turn)
    q, tangent = static_equilibrium(system.without(CAGE), start)
    problem = search.problem_of(system, speed, q, symmetric)
    if system.scalars[CAGE] != 0.0 and not problem.symmetry.pitch:
        why = (
            "the ball-pass frequency of orbiting balls differs from that of the force, so that no motion repeats every turn; only a "
            "force that turns over equal balls without a radial load has one (integrator.symmetry = 'auto'). Use 'newmark'"
        )
        raise SceneError.at("integrator.kind", "periodic", why)
    if on_chunk is not None:
        problem = attrs.evolve(problem, watch=lambda: on_chunk(0, schedule.steps))
    motion = find(problem, q, tangent, tolerance, start.near, start.stay)
    refined = motion.refined
    counts = {
        "steps": refined.solved.path.intervals,
        "evaluations": refined.evaluations,
        "error": refined.error,
        "floquet": {**motion.floquet.to_dict(), "span_deg": float(np.degrees(problem.symmetry.span)), "found": motion.how},
        "orbits": orbit_tables(motion.all),
        "warnings": _warnings(motion, tolerance),
    }
    out = attrs.evolve(record(refined.solved, schedule, counts), solution=motion.neighbour(q, tangent))
    if on_chunk is not None:
        on_chunk(schedule.steps, schedule.steps)
    return out


def static_equilibrium(system: System, start: Motion) -> tuple[np.ndarray, np.ndarray]:
    """The static equilibrium (5,) that the start is at or near, and its tangent (5, 5)."""
    now = system.evaluate(start.q, ball=start.ball)
    imbalance = np.abs((now.force + system.stiffness @ start.q - system.load) * system.free)
    largest = max(float(np.abs(now.contact_force).sum()), float(np.abs(system.load).max()))
    if imbalance.max() <= _SETTLED * largest:
        return start.q, now.stiffness
    q, ball, _ = system.solve_equilibrium(start.q)
    return q, system.evaluate(q, ball=ball).stiffness


def refuse(system: Ring, schedule: Schedule) -> None:
    """Raise ``SceneError`` for what has no motion that repeats every turn, or none that depends on the force alone."""
    turn = schedule.dt * schedule.steps_per_turn
    pairs = [(system.outer_force(part * turn), system.outer_force((1.0 + part) * turn)) for part in (0.0, 0.31, 0.77)]
    largest = max(float(np.abs(now).max()) for now, _ in pairs)
    if compiled(system) is None:
        why = "bodies that are stepped from Python have no compiled forces to linearise thousands of states with"
    elif system.law_state.shape[1] > 0:
        why = "the periodic motion of a contact law with memory cannot be solved for directly"
    elif system.scalars[FRICTION] != 0.0:
        why = "with friction, sticking depends on the start of the motion, and no steady orbit is unique"
    elif any(np.abs(now - later).max() > 1e-9 * largest for now, later in pairs):
        why = "the force does not repeat every turn"
    else:
        return
    raise SceneError.at("integrator.kind", "periodic", f"{why}. Use 'newmark'")


def _warnings(motion: PeriodicMotion, tolerance: float) -> tuple[str, ...]:
    """What a user should know of a motion that was hard to find, is not stable or not alone, or not as exact as asked for."""
    out = list(_coexistence(motion.all))
    if motion.fold is not None:
        out.append(
            f"no branch from rest reaches the force: it turns back at {100.0 * motion.fold:.3g} % of the force (an internal "
            f"resonance); this motion was reached {motion.how}, and others may exist"
        )
    if motion.floquet.verdict == "unstable":
        out.append(f"the periodic motion is unstable, {growth_of_disturbances(motion.floquet)}; a ring does not stay on it")
    if motion.refined.error > tolerance:
        out.append(f"the mesh does not resolve the motion better than {motion.refined.error:.1e} of its amplitude")
    return tuple(out)


#: Samples of an orbit, as many as Fourier collocation has, and error of the search over the motion.
_SAMPLES, _TOLERANCE = 65, 1e-7


def starting_orbit(
    system: System, period: float, q: np.ndarray, watch: Callable[[], None] | None = None, near: Neighbour | None = None,
    stay: Stay = False,
) -> tuple[Orbit, list[Tables], tuple[str, ...]] | None:  # fmt: skip
    """The motion to start on at equidistant times, the tables of every one that was found, and warnings.

    None where it is not searched for, because each try would take seconds; no motions where nothing could be said.

    system : with compiled forces, without friction, memory and orbiting balls;  q : (5,) static equilibrium
    watch : called in the search, which what it raises ends;  near, stay : see ``find``

    ConvergenceError: No periodic motion found.

    The search of ``raceway.core.periodic.search``, so that a transient and the steady orbit that is solved for directly are
    of one motion. Where it finds nothing, Fourier collocation (``raceway.core.ring.orbit``) may: its damped iteration ends
    on any motion.
    """
    tangent = system.evaluate(q).stiffness
    problem = search.problem_of(system, 2.0 * np.pi / period, q)
    if not search.can_continue(problem, q, tangent):
        return None
    if watch is not None:
        problem = attrs.evolve(problem, watch=watch)
    try:
        motion = find(problem, q, tangent, _TOLERANCE, near, stay)
    except ConvergenceError:
        orbit, highest = steady_orbit(system, period, q, _SAMPLES), search.highest_order(problem, tangent)
        try:
            # The motion of Fourier collocation, solved for once more on a mesh.
            record = Recorded(orbit.period, orbit.displacement, orbit.velocity, orbit.acceleration)
            path = record.first_guess(problem, np.zeros(5), np.zeros((5, 5)), search.mesh_of(problem, highest))
            motion = search.with_multipliers(
                refine(solve(problem, path, 1e-2 * _TOLERANCE), _TOLERANCE), highest, "by Fourier collocation"
            )
        except ConvergenceError:
            if highest <= search.HIGHEST:
                raise
            return orbit, [], ()  # so slow that no mesh holds the vibrations that it has none of
    warnings = _coexistence(motion.all)
    if motion.floquet.verdict == "unstable":
        warnings += (
            f"the motion starts on a steady orbit that is unstable, {growth_of_disturbances(motion.floquet)}; no stable one was found, and a real "
            "ring does not stay on it",
        )
    # The motion at equidistant times of a turn.
    found, times = motion.refined, period / _SAMPLES * np.arange(_SAMPLES)
    problem, system = found.solved.problem, found.solved.problem.system
    q, v, a, ball, rate = states(found.solved, problem.speed * times)
    v = v * problem.speed
    now = responses(system, States(times, q, v, ball, rate), tangents=True)
    force = np.array([system.outer_force(t) for t in times])
    orbit = Orbit(period, q, v, a * problem.speed**2, force, ball, now.K, now.C, found.error, found.sweeps)
    return orbit, orbit_tables(motion.all), warnings


#: Distance of a motion from its neighbour, over its size, up to which it is that one's continuation.
_STAYS = 0.2


def find(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, near: Neighbour | Recorded | None = None,
    stay: Stay = False,
) -> PeriodicMotion:  # fmt: skip
    """The periodic motion of a ring about the equilibrium q (5,), to a relative tolerance, and others beside it.

    near : a motion to start from
    stay : on that one, or else on the first that is not unstable, instead of searching for all that may exist; and where branches are not followed and nothing
        is found directly, give up instead of letting the force grow on a mesh of thousands of intervals; "unstable": on that one
        where it is unstable, too, or else on what the branch from rest leads to

    Newton's iteration from the linear response, with full steps only: one that has to be shortened may end on a resonant
    branch far away.  Where it fails, is unstable, or ends far from the linear response, there may be several motions: the
    branch that leads from the resting ring is followed round its folds, and every place where it meets the full force is a
    motion.  The first one along the branch that is not unstable is taken; where all are, motions that the undamped ring's branch
    leads to are tried, and else the one is taken that is left slowest.  Where the branch never reaches the full force and all
    found so far are unstable, motions at other speeds and loads are followed to this one.

    ConvergenceError: No periodic motion found, with what was tried.
    """
    highest = search.highest_order(problem, tangent)
    if near is not None and (stay or near.near_linear):
        followed = _continued(problem, q, tangent, tolerance, highest, near, stay == "unstable")
        # Far from the linear response there may be other motions: then the search without a neighbour decides.
        if followed is not None and (stay or not _may_coexist(followed, q, tangent)):
            return followed
    direct = None
    try:
        direct = search.with_multipliers(search.directly(problem, q, tangent, tolerance), highest, "directly")
    except ConvergenceError:
        pass
    else:
        if not _may_coexist(direct, q, tangent):
            return direct
    from raceway.core.periodic.branches import chosen, grown_from_rest  # few motions need them

    if not search.can_continue(problem, q, tangent):
        # Each point would take seconds.
        if direct is None and stay:
            raise ConvergenceError("no motion with the period of the force was found directly", {"q": q.copy()})
        return direct or search.with_multipliers(
            grown_from_rest(problem, q, tangent, tolerance, highest), highest, "from rest"
        )
    return chosen(problem, q, tangent, tolerance, direct, bool(stay), near is None or stay != "unstable")


def _continued(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float, near: Neighbour | Recorded,
    through: bool,
) -> PeriodicMotion | None:  # fmt: skip
    """The motion that continues a neighbour, if it is close to it; ``through``: where it is unstable, too, not only where the neighbour solves the same problem."""
    known = near.excess.nodes if isinstance(near, Neighbour) and near.solves(problem) else None
    first = near.first_guess(problem, q, tangent, search.mesh_of(problem, highest) if known is None else known)
    if first is None:
        return None
    try:
        solved = search.full_steps(problem, first, 1e-2 * tolerance)
        if np.abs((solved.path.q - first.q) / problem.weight).max() > _STAYS * solved.size:
            return None
        motion = search.with_multipliers(refine(solved, tolerance), highest, "directly")
    except ConvergenceError:
        return None
    return motion if through or known is not None or motion.floquet.verdict != "unstable" else None


def _may_coexist(motion: PeriodicMotion, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether a motion is unstable or so far from its linear response about q (5,) that other ones may exist beside it."""
    return motion.floquet.verdict == "unstable" or not motion.neighbour(q, tangent).near_linear
