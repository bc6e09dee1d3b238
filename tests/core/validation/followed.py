"""The article's bearing with folds and Neimark-Sacker points, and its orbits by methods of their own."""

from typing import Any

import attrs
import numpy as np

from checks.validation.reference.harmonic_balance import harmonic_balance
from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import swinging, trajectory
from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.refinement import displacements
from raceway.core.periodic.search import directly, highest_order
from raceway.core.periodic.steady import synchronous_response
from raceway.extend import System
from raceway.points.parameter import parameter_of
from raceway.testing import default_registry

#: B7206C, 400 N axial, tilt free, weightless balls; 40 N along y and a dashpot of about 2 % of critical damping.
SCENE: dict[str, Any] = {
    "title": "B7206C, 400 N axial, tilt free, 40 N along one direction", "bearing": {"preset": "B7206C"},
    "supports": {"tilt": "free"}, "rotor": {"mass": 2.0, "damping": 200.0}, "load": {"axial": 400.0},
    "excitation": {"kind": "unidirectional", "speed_rpm": 6000.0, "amplitude": "constant", "force": 40.0},
    "kinematics": {"ball_inertia": False, "gyroscopic": "none", "ring_growth": False},
    "contact": {"damping": 0.0},
}  # fmt: skip
OVER = "excitation.speed_rpm=500:30000"
FORCE = 40.0


class _WithLinearDamping(Ring):
    """The reference ring with the dashpots of the system: those of the rotor and the gyroscopic terms."""

    matrix: np.ndarray

    def damping_matrix(self, q: np.ndarray) -> np.ndarray:
        return self.matrix


def _ring(system: System) -> _WithLinearDamping:
    ring = _WithLinearDamping(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522)
    ring.matrix, ring.damping = system.damping, 1.0  # not 0: the matrix counts
    return ring


def by_harmonic_balance(point: Point, harmonics: int = 24) -> complex:
    """Z [N/m] of an orbit with the reference ring's forces, beginning 1 % off it."""
    solved = point.solved
    system, w = solved.problem.system, solved.problem.speed
    free, ring, count = solved.problem.free, _ring(system), 4 * harmonics
    angles = 2.0 * np.pi * np.arange(count) / count
    first = displacements(solved, angles)
    mean = first.mean(axis=0)
    push = np.tile(system.load, (count, 1))
    push[:, 1] += FORCE * np.cos(angles)
    part = np.ix_(free, free)

    def inner(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        force, tangent, _ = ring(q)
        return force[free], tangent[part]

    off = mean + 1.01 * (first - mean)
    weight = solved.problem.weight[free]
    # Tilts as lengths keep the Jacobian's entries alike.
    scale = np.diag(weight)
    found = harmonic_balance(
        lambda y: (weight * inner(weight * y)[0], scale @ inner(weight * y)[1] @ scale), scale @ system.mass[part] @ scale,
        scale @ system.damping[part] @ scale, push[:, free] * weight, w, off[:, free] / weight, harmonics, solved.size,
    )  # fmt: skip
    y = weight[1] * found[:, 1]
    return complex(FORCE / (2.0 / count * np.exp(-1j * angles) @ y))


def by_integration(point: Point, turns: int = 1, force: float = FORCE) -> tuple[complex, np.ndarray, np.ndarray]:
    """Z [N/m] of the last of some turns that begin on an orbit, the monodromy's multipliers, and what the turns lack (5,)."""
    problem, path = point.solved.problem, point.solved.path
    system, w = problem.system, problem.speed
    times = 2.0 * np.pi / w * np.arange(181 * turns - turns + 1) / 180
    q, _, flow = trajectory(
        _ring(system), system.mass, system.load, swinging(force, w), system.free, path.q[0], path.v[0] * w, times, 1e-11,
        True,
    )  # fmt: skip
    last = q[-181:]
    y = 2.0 / 180 * np.exp(-1j * w * times[-181:-1]) @ last[:-1, 1]
    return complex(force / y), np.linalg.eigvals(flow), q[-1] - q[0]


def on_the_way(speed_rpm: float) -> Point:
    """The orbit of ``SCENE`` that the linear response leads to at a speed."""
    parameter = parameter_of({**SCENE}, OVER, default_registry())
    _, equilibrium = parameter.settled(speed_rpm)
    symmetry = parameter.symmetry(equilibrium.displacement)
    problem = parameter.problem_at(speed_rpm, symmetry)
    solved = directly(problem, equilibrium.displacement, equilibrium.stiffness, 1e-9).solved
    fastest = highest_order(problem, equilibrium.stiffness) * problem.speed
    return Branch(lambda p: parameter.problem_at(p, symmetry), 2950.0, solved.size, 1e-8, fastest=lambda _: fastest).start(
        solved, speed_rpm
    )


def beside(fold: Point, count: int = 1) -> list[Point]:
    """Orbits on either side of a fold of ``SCENE``, some steps of 3 units of the arc away."""
    parameter = parameter_of({**SCENE}, OVER, default_registry())
    symmetry = fold.solved.problem.symmetry
    branch = Branch(
        lambda p: parameter.problem_at(p, symmetry), 2950.0, fold.solved.size, 1e-8,
        fastest=lambda _: fold.highest * fold.solved.problem.speed,
    )  # fmt: skip
    across = np.zeros_like(fold.tangent)  # the tangent in the units of another branch
    across[:-1] = fold.tangent[:-1]
    begin = attrs.evolve(fold, tangent=across / np.linalg.norm(across))
    found = [begin, begin]
    for _ in range(count):
        found = [branch.step(one, step) for one, step in zip(found, (-3.0, 3.0), strict=True)]
    return found


def z_of(point: Point) -> complex:
    return synchronous_response(point.solved, np.pi * np.arange(720) / 180.0)[0]  # two turns, where a period doubles
