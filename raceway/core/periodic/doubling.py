"""The branch of twice the period that leaves a branch at a period doubling.

Notes
-----
At a period doubling a disturbance v comes back as -v after a span: T v = -v.  Two spans of the orbit, with v along the first and
-v along the second, are the first point of a problem of two spans, at which another branch crosses with the tangent (v, 0).

References
----------
Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. (2010), section 7.4.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.symmetry import Symmetry, rotations


def twice(symmetry: Symmetry) -> Symmetry:
    """The symmetry of two spans."""
    turned = symmetry.rotation @ symmetry.rotation
    return Symmetry(2.0 * symmetry.span, turned, 2.0 * symmetry.angle, symmetry.order[symmetry.order], symmetry.pitch)


def two_spans(problem: Problem) -> Problem:
    """The same problem with a period of two spans."""
    return Problem(
        problem.system, problem.speed, twice(problem.symmetry), problem.share, problem.clock, problem.rule, problem.watch
    )


def doubled(branch: Branch, point: Point) -> tuple[Branch, Point]:
    """The branch of two spans, and its first point: ``point``, a period doubling, with the tangent that leaves it."""
    solved = point.solved
    problem, path = solved.problem, solved.path
    turned, order = problem.symmetry.rotation, problem.symmetry.order
    both = Path(
        np.append(path.nodes[:-1], problem.symmetry.span + path.nodes),
        np.vstack([path.q[:-1], path.q @ turned.T]),
        np.vstack([path.v[:-1], path.v @ turned.T]),
        np.vstack([path.a, path.a @ turned.T]),
        np.concatenate([path.ball, path.ball[:, order]]),
        np.concatenate([path.rate, path.rate[:, order]]),
    )
    values, vectors = np.linalg.eig(point.transfer)
    flip = vectors[:, np.argmin(np.abs(values + 1.0))].real
    at = branch.problem_at
    longer = attrs.evolve(branch, problem_at=lambda p: two_spans(at(p)), most_intervals=2 * branch.most_intervals)
    tangent = np.append(flip / branch.length, 0.0)
    return longer, longer.along(both, point.parameter, tangent / np.linalg.norm(tangent))


def apart(point: Point) -> np.ndarray:
    """(2 n,) by which the state changes over half of two spans, turned back; 0 where the orbit repeats itself after one."""
    problem, path = point.solved.problem, point.solved.path
    middle = int(np.argmin(np.abs(path.nodes - 0.5 * problem.symmetry.span)))
    back = rotations(np.array([-0.5 * problem.symmetry.angle]))[0]
    first = np.concatenate([path.q[0], path.v[0]])
    second = np.concatenate([back @ path.q[middle], back @ path.v[middle]])
    scale = np.tile(problem.weight, 2)
    return np.asarray((second - first) / scale)
