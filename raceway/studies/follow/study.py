"""The branch of steady orbits over a key: points, special points, peaks, where contacts are lost, how it ends."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Solved, solve
from raceway.core.periodic.direct import MOST, directly, highest_order, mesh_of
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.sampling import motion_at
from raceway.core.periodic.search import find
from raceway.core.periodic.special import located, special_points
from raceway.errors import ConvergenceError
from raceway.studies.follow.parameter import Parameter
from raceway.studies.follow.result import OPENS, PEAK, Followed, Label
from raceway.studies.follow.row import growth_of_swing, openness, row_of

#: Error of the first orbit over its size, and of all others.
_TOLERANCE, _ERROR = 1e-8, 1e-6
#: Error of an orbit over its size at which the branch is left.
_LOST = 1e-3
#: First step, and most change of the key in a step, in tenths of the range.
_FIRST, _MOST = 0.02, 0.5
OnProgress = Callable[[str, int, int], None]


@attrs.frozen
class Rule:
    """How a branch is followed.

    Attributes
    ----------
    points : that it may have at most
    aim : deviation of an orbit's start from the prediction along the tangent, over the orbit's size: steps are chosen for it
    """

    points: int = 1000
    aim: float = 0.02


def follow(parameter: Parameter, rule: Rule, on_progress: OnProgress | None = None) -> Followed:
    """The branch from the orbit at the first value of the key to the last one.

    Raises
    ------
    ConvergenceError
        No equilibrium or no orbit at the first value.
    """
    model, equilibrium = parameter.settled(parameter.first)
    q, tangent, mass = equilibrium.displacement, equilibrium.stiffness, model.mass_used
    try:
        parameter.settled(parameter.last)
    except ConvergenceError as why:
        raise ConvergenceError(f"at `{parameter.key}` = {parameter.last:g}: {why}", why.state) from why
    symmetry = parameter.symmetry(q)
    problem = parameter.problem_at(parameter.first, symmetry)
    if on_progress is not None:
        problem = attrs.evolve(problem, watch=lambda: on_progress("the first orbit", 0, 0))
    first = _first(problem, q, tangent)
    unit = abs(parameter.last - parameter.first) / 10.0
    fastest = highest_order(problem, tangent) * problem.speed
    branch = Branch(lambda p: parameter.problem_at(p, symmetry), unit, first.size, _ERROR, MOST, None, fastest, rule.aim)
    curve = Followed(parameter.key, parameter.first, parameter.last, float(np.degrees(symmetry.span)), model.scene.title)
    walk = _Walk(branch, curve, parameter, mass)
    walk.go(first, rule, on_progress)
    return curve


def _first(problem: Problem, q: np.ndarray, tangent: np.ndarray) -> Solved:
    """The first orbit: that from the linear response if full steps lead to one, else the one that the search takes."""
    try:
        return directly(problem, q, tangent, _TOLERANCE).solved
    except ConvergenceError:
        return find(problem, q, tangent, _TOLERANCE).refined.solved


@attrs.define(eq=False)
class _Walk:
    """Follows a branch and writes down what it meets.

    Attributes
    ----------
    mass : m of K [kg]
    """

    branch: Branch
    curve: Followed
    parameter: Parameter
    mass: float
    arc: float = 0.0

    def go(self, first: Solved, rule: Rule, on_progress: OnProgress | None) -> None:
        """Points one by one, until the range or the number of points is left, or the branch ends."""
        self._go(first, rule, on_progress)
        self.curve.labels.sort(key=lambda label: label.row.arc)

    def _go(self, first: Solved, rule: Rule, on_progress: OnProgress | None) -> None:
        curve, parameter = self.curve, self.parameter
        sense = 1.0 if parameter.last > parameter.first else -1.0
        here = self.branch.start(first, parameter.first, sense)
        self._tell(here)
        size, least = _FIRST, 1e-6 * _FIRST
        while len(curve.rows) < rule.points:
            if on_progress is not None:
                on_progress("orbits", len(curve.rows), rule.points)
            try:
                there = self.branch.step(here, size)
            except ConvergenceError as why:
                size *= 0.5
                if size < least:
                    curve.end = f"the branch ends at {here.parameter:.6g}: {why}"
                    return
                continue
            beyond = [
                end for end in (parameter.first, parameter.last) if (there.parameter - end) * (here.parameter - end) < 0.0
            ]
            if beyond:
                there, size = located(self.branch, here, there, size, _reached(beyond[-1]))
            self._between(here, there, size)
            self.arc += size
            self._tell(there)
            if there.error > _LOST:
                curve.end = (
                    f"left at {there.parameter:.6g}: no mesh follows the orbit closer than {there.error:.1e} of its size"
                )
                if curve.rows[-1].lost:
                    curve.end += f" where up to {curve.rows[-1].lost} balls lose their inner race at once"
                return
            if beyond:
                curve.end = "" if beyond[-1] == parameter.last else f"the branch comes back to {parameter.first:.6g}"
                return
            size = min(size * self.branch.growth(there), _MOST / max(abs(there.tangent[-1]), 1e-300))
            here = self._meshed(there)
        curve.end = f"left after {rule.points} orbits at {here.parameter:.6g} (--points)"

    def _tell(self, point: Point) -> None:
        self.curve.rows.append(row_of(point, self.arc, self.mass))

    def _between(self, one: Point, two: Point, size: float) -> None:
        """Special points, peaks and the loss of contacts between two neighbours."""
        curve, branch = self.curve, self.branch
        try:
            for special in special_points(branch, one, two, size):
                row = row_of(special.point, self.arc + special.length, self.mass)
                curve.labels.append(Label(special.kind, row, special.angle, special.point))
            if growth_of_swing(branch, one) > 0.0 >= growth_of_swing(branch, two):
                peak, length = located(branch, one, two, size, lambda point: growth_of_swing(branch, point))
                curve.labels.append(Label(PEAK, row_of(peak, self.arc + length, self.mass)))
            if (openness(one.solved)[0] < 0.0) != (openness(two.solved)[0] < 0.0):
                opens, length = located(branch, one, two, size, lambda point: openness(point.solved)[0])
                curve.labels.append(Label(OPENS, row_of(opens, self.arc + length, self.mass)))
        except (ConvergenceError, ValueError) as why:
            curve.notes.append(f"between {one.parameter:.6g} and {two.parameter:.6g}: not located ({why})")

    def _meshed(self, point: Point) -> Point:
        """The same orbit on a mesh that is fit for the fastest vibration at the present speed."""
        problem, path = point.solved.problem, point.solved.path
        nodes = mesh_of(problem, point.highest)
        wanted, there = len(nodes) - 1, path.intervals
        if wanted > there or 2 * wanted < there and point.error < 1e-2 * _ERROR:
            q, v, *_ = motion_at(problem, path, nodes)
            *_, a, ball, rate = motion_at(problem, path, problem.angles(nodes))
            parts = (np.ascontiguousarray(part) for part in (q, v, a, ball, rate))
            try:
                solved = solve(problem, Path(nodes, *parts), 1e-2 * _ERROR)
                again = self.branch.start(solved, point.parameter, float(np.sign(point.tangent[-1])))
            except ConvergenceError:
                return point
            if float(again.tangent @ point.tangent) > 0.9:
                return again
        return point


def _reached(end: float) -> Callable[[Point], float]:
    return lambda point: float(point.parameter - end)
