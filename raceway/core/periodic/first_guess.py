"""A first guess of the periodic motion: linear response about the static equilibrium."""

from __future__ import annotations

import numpy as np

from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.sweep import forces

#: Samples a turn of the force: enough for eight harmonics.
_SAMPLES = 32


def response(problem: Problem, tangent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Orders k (m,) of the force and the linear response's complex lines (m, 5): Re(x e^{j k theta}).

    Parameters
    ----------
    tangent : (5, 5) stiffness of the contacts at the equilibrium
    """
    system, w, free = problem.system, problem.speed, problem.free
    times = 2.0 * np.pi / problem.clock / _SAMPLES * np.arange(_SAMPLES)
    force = np.empty((_SAMPLES, 5))
    forces(system.force, system.force_params, times, force)
    lines = np.fft.rfft(problem.share * force[:, free], axis=0)[: _SAMPLES // 4 + 1] / _SAMPLES
    lines[1:] *= 2.0
    orders = np.flatnonzero(np.abs(lines).max(axis=1) > 1e-9 * np.abs(lines).max(initial=0.0))
    part = np.ix_(free, free)
    mass, damping, stiffness = system.mass[part], system.damping[part], (tangent + system.stiffness)[part]
    found = np.zeros((len(orders), 5), dtype=complex)
    for row, k in enumerate(orders):
        found[row, free] = np.linalg.solve(stiffness - (k * w) ** 2 * mass + 1j * k * w * damping, lines[k])
    return orders, found


def guess(problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path:
    """Linear response about an equilibrium q (5,), on a mesh."""
    orders, lines = response(problem, tangent)

    def at(angles: np.ndarray, derivative: int) -> np.ndarray:
        waves = np.exp(1j * angles[:, None] * orders) * (1j * orders) ** derivative
        return (waves @ lines).real

    return standing(problem, q, nodes, at(nodes, 0), at(nodes, 1), at(problem.angles(nodes), 2))


def standing(
    problem: Problem,
    q: np.ndarray,
    nodes: np.ndarray,
    dq: np.ndarray | float = 0.0,
    v: np.ndarray | float = 0.0,
    a: np.ndarray | float = 0.0,
) -> Path:
    """The equilibrium q (5,) for all times, with a motion about it."""
    m, s, z = len(nodes) - 1, len(problem.rule.points), problem.system.ball_count
    shape = (m * s, z, problem.system.ball_columns)
    zero = np.zeros((m + 1, 5))
    return Path(nodes, zero + q + dq, zero + v, np.zeros((m * s, 5)) + a, np.zeros(shape), np.zeros(shape))
