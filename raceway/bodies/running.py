"""Contact laws at the running speed: entraining speeds, loads, and parameters that fit the equilibrium."""

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.basis import Basis, contact_pairs
from raceway.bodies.contacts import contact_angles
from raceway.core.columns import per_ball
from raceway.core.contact.film import entraining_speed
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError
from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import law_params, reach_of
from raceway.planning.resolve import Problem

#: Part of the most loaded contact's load of a race and row that a contact without it is taken to be about to carry.
_LEAST = 0.1
#: Loads are met to this part of the largest one; iterations.  They converge fast: a film thins with the load to the power 0.067.
LOAD_TOLERANCE, ITERATIONS = 1e-11, 40


def running_pairs(
    problem: Problem,
    basis: Basis,
    force: np.ndarray,
    angles: tuple[np.ndarray, np.ndarray],
    speed: float | None = None,
    mounted: ContactPairs | None = None,
) -> ContactPairs:
    """The contacts as a law sees them in the running equilibrium; those of n points (n 2 Z,) one after the other.

    Parameters
    ----------
    force : (..., 2 Z) [N];  angles : of inner and outer contacts (..., Z) [rad], nan where they are open
    speed : of the inner ring [rad/s], default: the scene's spin speed
    mounted : the contacts at standstill, where they are known
    """
    load, alpha = force.reshape(*force.shape[:-1], 2, -1).copy(), np.stack(angles, axis=-2)
    for row, geometry in enumerate(basis.geometries):
        in_row = basis.row == row
        of_row, angle = load[..., in_row], alpha[..., in_row]
        if problem.kinematics.orbiting:
            of_row = of_row.mean(axis=-1, keepdims=True)
        load[..., in_row] = np.maximum(of_row, _LEAST * of_row.max(axis=-1, keepdims=True))
        closed = ~np.isnan(angle)
        count = closed.sum(axis=-1, keepdims=True)
        mean = np.where(closed, angle, 0.0).sum(axis=-1, keepdims=True) / np.maximum(count, 1)
        alpha[..., in_row] = np.where(closed, angle, np.where(count, mean, per_ball(per_ball(geometry.contact_angle))))
    pitch, ball = (
        np.stack(np.broadcast_arrays(*(getattr(geometry, name) for geometry in basis.geometries)), axis=-1)[..., basis.row]
        for name in ("pitch_diameter", "ball_diameter")
    )
    spin = per_ball(problem.spin_speed if speed is None else speed)
    speeds = entraining_speed(spin, pitch, ball, alpha[..., 0, :], alpha[..., 1, :])
    # A set of which no ball is loaded runs as one that is about to be.
    load = np.where(load > 0.0, load, _LEAST * per_ball(per_ball(basis.ball_load)))
    pairs = contact_pairs(problem, basis) if mounted is None else mounted
    return attrs.evolve(pairs, entraining_speed=np.concatenate(speeds, axis=-1).ravel(), load=load.ravel())


def renew(
    problem: Problem,
    basis: Basis,
    system: System,
    guess: np.ndarray,
    seek: Callable[[System, np.ndarray], np.ndarray] | None,
) -> np.ndarray:
    """(5,) equilibrium with the law's parameters at the running speed, which are built into the system.

    seek : finds the equilibrium of a sprung set, whose rows slide; None: rows stay

    ConvergenceError: No equilibrium, or loads and parameters that do not meet.
    """
    law, q, before = problem.contact.law, guess, np.zeros(2 * system.ball_count)
    for trial in range(ITERATIONS):
        try:
            q = q if seek is None else seek(system, q)
            q, ball, _ = system.solve_equilibrium(q)
        except ConvergenceError as why:
            if trial == 0:  # at standstill
                raise
            raise ConvergenceError(
                f"contact law '{problem.contact.kind}' at the running speed: {why}. Raise the load, lower the speed, "
                "or choose options of the law that change its contacts less from standstill",
                why.state,
            ) from why
        now = system.without(CAGE).evaluate(q, ball=ball)
        force = now.contact_force
        if np.abs(force - before).max() <= LOAD_TOLERANCE * max(force.max(), 1e-300):
            return q
        # The kernel of balls without mass leaves the second column alone: they lie between the groove centres.
        angles = contact_angles(system.centre_vectors(q, ball=now.ball)[0], bool(now.ball[:, 1].any()), now.ball, force)
        pairs = running_pairs(problem, basis, force, angles)
        renewed = system.running(law_params(law, pairs), reach_of(law, pairs))
        system.table, system.law_params = renewed.table, renewed.law_params
        system.mounted_params, system.reach = renewed.mounted_params, renewed.reach
        if system.spin is not None:
            system.spin = attrs.evolve(system.spin, law=_following(problem, basis, force, angles))
        before = force
    reason = f"contact law '{problem.contact.kind}': loads and parameters do not converge in {ITERATIONS} equilibria"
    raise ConvergenceError(reason, {"q": q, "ball": ball})


def _following(
    problem: Problem, basis: Basis, force: np.ndarray, angles: tuple[np.ndarray, np.ndarray]
) -> Callable[[System, float], System]:
    """A system and another speed [rad/s] -> the system with its law there, at the loads and angles of the equilibrium."""

    law, mounted = problem.contact.law, contact_pairs(problem, basis)

    def follow(system: System, speed: float) -> System:
        if speed <= 0.0:
            assert system.mounted_params is not None and system.reach is not None, "built in above"
            return system.running(system.mounted_params, np.zeros_like(system.reach))
        pairs = running_pairs(problem, basis, force, angles, speed, mounted)
        return system.running(law_params(law, pairs), reach_of(law, pairs))

    return follow
