"""Pseudo-arclength continuation of periodic motions over a parameter: load, speed, share of the force, anything.

Notes
-----
The state y0 = (q, q') at the start of the span and the parameter p are followed together along their common arc, so that a
fold, where p turns back, is passed like any other point.  Newton's corrector adds one row to the closing condition
(P - T) dy0 - T_p dp = T_r + y_m - P y0: the correction stands across the predictor.  The derivative of the balance of forces by
p is a difference quotient at the same angles where the caller knows none.  Points are handed over one by one: each holds its
linearised problem, and what a caller does not keep is given back.

References
----------
Keller, in Rabinowitz (ed.), Applications of Bifurcation Theory (1977); Seydel, Practical Bifurcation and Stability
Analysis, 3rd ed. (2010), chapter 4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import attrs
import numpy as np

from raceway.core.periodic.arrays import Change, Eliminated
from raceway.core.periodic.collocation import Solved, gap
from raceway.core.periodic.floquet import Floquet, floquet
from raceway.core.periodic.intervals import FORCE, IMBALANCE, condense, imbalances
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.rates import renew, stiff
from raceway.core.periodic.refinement import divided, estimate, resampled
from raceway.core.periodic.sweep import spread
from raceway.errors import ConvergenceError

_LIMIT = 12
#: Relative step of the difference quotient by the parameter.
_DIFFERENCE = 1e-6


@attrs.frozen(eq=False)
class Point:
    """One motion of a branch.

    Attributes
    ----------
    parameter : p;  solved : the motion;  error : estimated, over its size
    tangent : (2 n + 1,) direction of the branch in scaled state and parameter;  folded : the parameter turned back since
        the point before
    """

    parameter: float
    solved: Solved
    error: float
    tangent: np.ndarray
    folded: bool

    @property
    def floquet(self) -> Floquet:
        return floquet(self.solved)


@attrs.define(eq=False)
class Branch:
    """Follows one branch of periodic motions.

    Parameters
    ----------
    problem_at : parameter -> Problem; unknown coordinates, span and balls' numbers stay the same
    unit : a typical change of the parameter;  length : a typical size of the motion [m]
    tolerance : error of the motion over its size that meshes are kept fit for;  most_intervals : that they may have
    slope : (problem, path) -> (m s, 5) derivative of the balance of forces by the parameter; None for a difference quotient
    """

    problem_at: Callable[[float], Problem]
    unit: float
    length: float
    tolerance: float = 1e-6
    most_intervals: int = 2048
    slope: Callable[[Problem, Path], np.ndarray] | None = None

    def start(self, solved: Solved, parameter: float, sense: float = 1.0) -> Point:
        """The first point, from a motion that is known; ``sense``: the side to which the parameter goes."""
        n2 = 2 * len(solved.problem.free)
        across = np.zeros(n2 + 1)
        across[-1] = sense
        _, _, tangent, linear = self._correct(solved.path, parameter, across, None)
        return Point(parameter, linear, estimate(linear).error, tangent, False)

    def follow(self, first: Point, step: float, longest: float | None = None) -> Iterator[Point]:
        """Points from ``first`` on, one by one, for as long as they are asked for.

        Parameters
        ----------
        step : first length along the branch, in units; ``longest`` : of all steps, four times the first by default

        Raises
        ------
        ConvergenceError
            Where the branch cannot be followed further.
        """
        yield first
        here, size = first, step
        longest = 4.0 * step if longest is None else longest
        while True:
            here.solved.problem.watch()
            try:
                here, iterations = self._step(here, size)
            except ConvergenceError as why:
                size *= 0.5
                if size < 1e-6 * step:
                    raise ConvergenceError(f"the branch ends at {here.parameter:.6g}: {why}") from why
                continue
            yield here
            size = min(size * (1.5 if iterations <= 4 else 0.7 if iterations > 7 else 1.0), longest)

    def _step(self, here: Point, size: float) -> tuple[Point, int]:
        solved = here.solved
        n, path, dp = len(solved.problem.free), solved.path, size * here.tangent[-1] * self.unit
        # Predictor: the last linearised problem carries the tangent at the start through the span; the last correction, which it
        # adds once more, is far below the tolerance.
        dq, dv, da = np.zeros_like(path.q), np.zeros_like(path.v), np.zeros_like(path.a)
        first = size * self.length * here.tangent[: 2 * n]
        spread(solved.problem.free, solved.eliminated, first, dp, Change(dq, dv, da))
        moved = attrs.evolve(path, q=path.q + dq, v=path.v + dv, a=path.a + da, ball=path.ball.copy(), rate=path.rate.copy())
        at = here.parameter + dp
        path, parameter, tangent, last = self._correct(moved, at, here.tangent, (moved, at))
        found = estimate(last)
        for _ in range(4):
            if found.error <= self.tolerance or 2 * path.intervals > self.most_intervals:
                break
            parts = np.where((found.defect > 0.1 * found.defect.max()) | (found.between > 0.1 * found.between.max()), 2, 1)
            nodes, parent = divided(path.nodes, parts)
            finer = resampled(last.problem, path, nodes, parent)
            path, parameter, tangent, last = self._correct(finer, parameter, here.tangent, (finer, parameter))
            found = estimate(last)
        # Back where it came from: a corrector that turned round.
        if float(tangent @ here.tangent) < 0.5:
            raise ConvergenceError("the branch bends too much for the step")
        folded = tangent[-1] * here.tangent[-1] < 0.0
        return Point(parameter, last, found.error, tangent, folded), last.sweeps

    def _linearise(self, problem: Problem, path: Path, parameter: float) -> tuple[Eliminated, np.ndarray] | None:
        """The linearisation, with the derivative by the parameter, and its report."""
        push = problem.push(path.nodes)
        if self.slope is not None:
            by = self.slope(problem, path)
        else:
            h = _DIFFERENCE * self.unit
            both = [self._imbalance(self.problem_at(parameter + off), path) for off in (-h, h)]
            by = (both[1] - both[0]) / (2.0 * h)
        out, report = problem.eliminated(path.nodes), np.zeros(3)
        done = condense(problem.equations, problem.mesh(path.nodes), path.samples(push, by), out, report)
        return (out, report) if done == path.intervals and np.isfinite(report).all() else None

    def _imbalance(self, problem: Problem, path: Path) -> np.ndarray:
        push = problem.push(path.nodes)
        out = np.zeros_like(push)
        if imbalances(problem.equations, problem.mesh(path.nodes), path.samples(push), out) < path.intervals:
            raise ConvergenceError("the balls find no place between the races")
        return out

    def _correct(
        self, path: Path, parameter: float, across: np.ndarray, predicted: tuple[Path, float] | None
    ) -> tuple[Path, float, np.ndarray, Solved]:
        """Newton across the predictor; without one, the parameter stays.  Path, parameter, tangent, last linearisation."""
        worst = np.inf
        lagging = stiff(self.problem_at(parameter), path)
        for sweeps in range(1, _LIMIT + 1):
            problem = self.problem_at(parameter)
            free = problem.free
            n = len(free)
            linearised = self._linearise(problem, path, parameter)
            if linearised is None:
                raise ConvergenceError("the balls find no place between the races")
            linear, report = linearised
            whole = linear.whole
            bordered = np.zeros((2 * n + 1, 2 * n + 1))
            bordered[: 2 * n, : 2 * n] = problem.closing - whole[:, : 2 * n]
            bordered[: 2 * n, 2 * n] = -whole[:, 2 * n + 1] * self.unit / self.length
            bordered[2 * n] = across
            right = np.zeros((2 * n + 1, 2))
            right[: 2 * n, 0] = (whole[:, 2 * n] + gap(problem, path)) / self.length
            right[2 * n, 1] = 1.0
            if predicted is not None:
                off = np.concatenate([(path.q[0] - predicted[0].q[0])[free], (path.v[0] - predicted[0].v[0])[free]])
                right[2 * n, 0] = -across[: 2 * n] @ off / self.length
                right[2 * n, 0] -= across[-1] * (parameter - predicted[1]) / self.unit
            try:
                found = np.linalg.solve(bordered, right)
            except np.linalg.LinAlgError as why:
                raise ConvergenceError("the branch has no single direction here") from why
            first, dp = self.length * found[: 2 * n, 0], self.unit * found[2 * n, 0]
            dq, dv, da = np.zeros_like(path.q), np.zeros_like(path.v), np.zeros_like(path.a)
            spread(free, linear, first, dp, Change(dq, dv, da))
            correction = float(np.abs(dq / problem.weight).max())
            if not np.isfinite(correction) or (
                sweeps > 2 and report[IMBALANCE] > 10.0 * worst and report[IMBALANCE] > 1e-9 * report[FORCE]
            ):
                raise ConvergenceError("the corrector diverges")
            worst = report[IMBALANCE]
            path = attrs.evolve(path, q=path.q + dq, v=path.v + dv, a=path.a + da)
            parameter += dp
            renew(problem, path, lagging)
            size = float(np.abs(path.v / problem.weight).max())
            place = float(np.abs(path.q / problem.weight).max())
            if sweeps > 1 and correction <= 1e-2 * self.tolerance * max(size, 1e-3 * self.length) + 1e-14 * place:
                tangent = found[:, 1] / np.linalg.norm(found[:, 1])
                solved = Solved(problem, path, linear, size, True, sweeps, correction)
                return path, parameter, tangent, solved
        raise ConvergenceError("the corrector does not converge")


def towards(one: Point, two: Point, wanted: float) -> Path:
    """The path at one parameter between two points, or of the second one where their meshes differ."""
    path = two.solved.path
    if one.solved.path.intervals == path.intervals and np.array_equal(one.solved.path.nodes, path.nodes):
        part = (wanted - one.parameter) / (two.parameter - one.parameter)
        path = between(one.solved.path, path, part)
    return path


def between(one: Path, two: Path, part: float) -> Path:
    """The second path's part and the first one's rest; ``part`` > 1 goes on beyond the second."""
    names = ("q", "v", "a", "ball", "rate")
    return attrs.evolve(two, **{x: (1.0 - part) * getattr(one, x) + part * getattr(two, x) for x in names})
