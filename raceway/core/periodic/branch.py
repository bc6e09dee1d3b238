"""Pseudo-arclength continuation of periodic motions over a parameter: load, speed, share of the force, anything.

The state y0 = (q, q') at the start of the span and the parameter p are followed together along their common arc, so that a
fold, where p turns back, is passed like any other point.  Newton's corrector adds one row to the closing condition
(P - T) dy0 - T_p dp = T_r + y_m - P y0: the correction stands across the predictor.  The derivative of the balance of forces by
p is a difference quotient at the same angles where the caller knows none.  Points are handed over one by one: each holds its
linearised problem, and what a caller does not keep is given back.

Keller, in Rabinowitz (ed.), Applications of Bifurcation Theory (1977); Seydel, Practical Bifurcation and Stability
Analysis, 3rd ed. (2010), chapter 4.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cached_property

import attrs
import numpy as np

from raceway.core.periodic.collocation import Path, Problem, Solved, gap, renew, stiff
from raceway.core.periodic.floquet import Floquet, floquet_of, transfer
from raceway.core.periodic.intervals import FORCE, IMBALANCE, Change, Eliminated, condense, imbalances, spread
from raceway.core.periodic.refinement import Estimate, divided, estimate, fitting, motion_at, sampled_at
from raceway.core.periodic.search import mesh_of
from raceway.core.periodic.turn import Symmetry, rotations
from raceway.errors import ConvergenceError

_LIMIT = 12
#: Part of the intervals, or of the longest one, from which on a motion is solved for once more on a mesh that fits it.
_FEWER = 0.7
#: Relative step of the difference quotient by the parameter.
_DIFFERENCE = 1e-6


@attrs.frozen(eq=False)
class Point:
    """One motion of a branch.

    parameter : p;  solved : the motion;  error : estimated, over its size
    tangent : (2 n + 1,) direction of the branch in scaled state and parameter;  folded : the parameter turned back since
        the point before
    deviation : of the state at the start from its prediction, over the motion's size
    strayed : length from the prediction to the point, in units of the arc
    highest : order of the fastest vibration, which ``transfer`` is fit for; 0: as exact as the mesh
    """

    parameter: float
    solved: Solved
    error: float
    tangent: np.ndarray
    folded: bool
    deviation: float = 0.0
    strayed: float = 0.0
    highest: float = 0.0

    @cached_property
    def transfer(self) -> np.ndarray:
        """(2 n, 2 n) of a disturbance over a span, turned back."""
        return transfer(self.solved, self.highest)

    @cached_property
    def floquet(self) -> Floquet:
        return floquet_of(self.transfer, self.solved.problem.symmetry.span)


@attrs.define(eq=False)
class Branch:
    """Follows one branch of periodic motions.

    problem_at : parameter -> Problem; unknown coordinates, span and balls' numbers stay the same
    unit : a typical change of the parameter;  length : a typical size of the motion [m]
    tolerance : error of the motion over its size that meshes are refined for;  most_intervals : that they may have
    slope : (problem, path) -> (m s, 5) derivative of the balance of forces by the parameter; None for a difference quotient, or none but that of the speed
    fastest : parameter -> highest natural frequency [rad/s], which multipliers are fit for; 0: as exact as the mesh
    aim : deviation that steps are chosen for; None: by the number of corrections
    widest : interval of the mesh that the branch began with [rad], of all where vibrations do not decide
    """

    problem_at: Callable[[float], Problem]
    unit: float
    length: float
    tolerance: float = 1e-6
    most_intervals: int = 2048
    slope: Callable[[Problem, Path], np.ndarray] | None = None
    fastest: Callable[[float], float] = lambda _: 0.0
    aim: float | None = None
    widest: float = np.inf

    def start(self, solution: Solved, parameter: float, sense: float = 1.0) -> Point:
        """The first point, from a motion that is known; ``sense``: the side to which the parameter goes."""
        n2 = 2 * len(solution.problem.free)
        across = np.zeros(n2 + 1)
        across[-1] = sense
        _, tangent, linear, error = self._correct(solution.path, parameter, across, None)
        self.widest = float(np.diff(solution.path.nodes).max())
        return Point(parameter, linear, error.error, tangent, False, highest=self._order(linear, parameter))

    def along(self, path: Path, parameter: float, tangent: np.ndarray) -> Point:
        """The point of an orbit that is known, with a direction to leave it by.

        ConvergenceError: The path is none of forces that have values.
        """
        problem = self.problem_at(parameter)
        linearisation = self._linearise(problem, path, parameter)
        if linearisation is None:
            raise ConvergenceError("the balls have no equilibrium between the races")
        solution = Solved(problem, path, linearisation[0], float(np.abs(path.v / problem.weight).max()), True, 0, 0.0)
        return Point(parameter, solution, 0.0, tangent, False, highest=self._order(solution, parameter))

    def follow(self, first: Point, step: float, longest: float | None = None) -> Iterator[Point]:
        """Points from ``first`` on, one by one, for as long as they are asked for.

        step : first length along the branch, in units; ``longest`` : of all steps, four times the first by default

        ConvergenceError: Where the branch cannot be followed further.
        """
        yield first
        here, size = first, step
        longest = 4.0 * step if longest is None else longest
        while True:
            here.solved.problem.watch()
            try:
                here = self.step(here, size)
            except ConvergenceError as why:
                size *= 0.5
                if size < 1e-6 * step:
                    raise ConvergenceError(f"the branch ends at {here.parameter:.6g}: {why}") from why
                continue
            yield here
            size = min(size * self.growth(here), longest)

    def growth(self, here: Point) -> float:
        """Factor of the next step over the one that led here: a prediction along the tangent deviates by its square."""
        if self.aim is not None:
            return float(np.clip(np.sqrt(self.aim / max(here.deviation, 1e-300)), 0.3, 2.0))
        return 1.5 if here.solved.sweeps <= 4 else 0.7 if here.solved.sweeps > 7 else 1.0

    def step(self, here: Point, size: float) -> Point:
        """The point at a length along the branch, in units.

        ConvergenceError: The corrector finds none, or turned round.
        """
        solution = here.solved
        path, dp = solution.path, size * here.tangent[-1] * self.unit
        # Predictor: the last linearised problem carries the tangent at the start through the span; the last correction, which it
        # adds once more, is far below the tolerance.
        own = attrs.evolve(path, ball=path.ball.copy(), rate=path.rate.copy())
        trial, _ = _shifted_path(own, solution.problem.free, solution.eliminated, size * self.displacement(here), dp)
        at = here.parameter + dp
        parameter, tangent, last, error = self._correct(trial, at, here.tangent, (trial, at))
        for _ in range(4):
            if error.error <= self.tolerance or 2 * last.path.intervals > self.most_intervals:
                break
            parts = np.where((error.defect > 0.1 * error.defect.max()) | (error.between > 0.1 * error.between.max()), 2, 1)
            finer = sampled_at(last.problem, last.path, divided(last.path.nodes, parts))
            parameter, tangent, last, error = self._correct(finer, parameter, here.tangent, (finer, parameter))
        # Back where it came from: a corrector that turned round.
        if float(tangent @ here.tangent) < 0.5:
            raise ConvergenceError("the branch bends too much for the step")
        path, fold = last.path, tangent[-1] * here.tangent[-1] < 0.0
        off = np.abs([path.q[0] - trial.q[0], path.v[0] - trial.v[0]]) / last.problem.weight
        deviation = float(off.max()) / max(last.size, 1e-300)
        state = (path.state(0, last.problem.free) - trial.state(0, last.problem.free)) / self.length
        strayed = float(np.hypot(np.linalg.norm(state), (parameter - at) / self.unit))
        order = self._order(last, parameter)
        widest = float(mesh_of(last.problem, order)[1]) if order > 0.0 else self.widest
        nodes = fitting(path.nodes, error, self.tolerance * last.size, widest)
        if len(nodes) < _FEWER * len(path.nodes) or np.diff(path.nodes).max() > widest / _FEWER:
            with suppress(ConvergenceError):
                other = sampled_at(last.problem, path, nodes)
                again = self._correct(other, parameter, tangent, (other, parameter))
                if again[3].error <= max(self.tolerance, error.error) and float(again[1] @ tangent) > 0.9:
                    parameter, tangent, last, error = again
        return Point(parameter, last, error.error, tangent, fold, deviation, strayed, self._order(last, parameter))

    def crossing(self, point: Point) -> float:
        """Determinant of the bordered problem, which changes its sign where another branch crosses, and not at a fold."""
        return float(
            np.linalg.det(self._bordered_matrix(point.solved.problem, point.solved.eliminated.span_transfer, point.tangent))
        )

    def displacement(self, point: Point) -> np.ndarray:
        """(2 n,) of the unknown state at the start of the span, by a unit of length along the branch."""
        return self.length * point.tangent[:-1]

    def _order(self, solution: Solved, parameter: float) -> float:
        return self.fastest(parameter) / solution.problem.speed

    def _bordered_matrix(self, problem: Problem, span_transfer: np.ndarray, across: np.ndarray) -> np.ndarray:
        """(2 n + 1, 2 n + 1) of the closing condition in scaled state and parameter, ``across`` as its last row."""
        n2 = 2 * len(problem.free)
        out = np.empty((n2 + 1, n2 + 1))
        out[:n2, :n2] = problem.closing - span_transfer[:, :n2]
        out[:n2, n2] = -span_transfer[:, n2 + 1] * self.unit / self.length
        out[n2] = across
        return out

    def _linearise(self, problem: Problem, path: Path, parameter: float) -> tuple[Eliminated, np.ndarray] | None:
        push = problem.push(path.nodes)
        own = self.slope is None and problem.by_parameter == 0.0
        by = self._difference(problem, path, parameter) if own else self.slope and self.slope(problem, path)
        out, report = problem.eliminated(path.nodes), np.zeros(3)
        success = condense(problem.equations, problem.mesh(path.nodes), path.samples(push, by), out, report)
        return (out, report) if success == path.intervals and np.isfinite(report).all() else None

    def _difference(self, problem: Problem, path: Path, parameter: float) -> np.ndarray:
        """By the parameter: central, at the end of what it may be to one side."""
        h, sides = _DIFFERENCE * self.unit, []
        for off in (-h, h):
            try:
                sides.append((off, self.problem_at(parameter + off)))
            except ConvergenceError:
                sides.append((0.0, problem))
        (low, before), (high, after) = sides
        if low == high:
            self.problem_at(parameter + h)  # why there is none on either side
        return (self._imbalance(after, path) - self._imbalance(before, path)) / (high - low)

    def _imbalance(self, problem: Problem, path: Path) -> np.ndarray:
        push = problem.push(path.nodes)
        out = np.zeros_like(push)
        if imbalances(problem.equations, problem.mesh(path.nodes), path.samples(push), out) < path.intervals:
            raise ConvergenceError("the balls have no equilibrium between the races")
        return out

    def _correct(
        self, path: Path, parameter: float, across: np.ndarray, prediction: tuple[Path, float] | None
    ) -> tuple[float, np.ndarray, Solved, Estimate]:
        """Newton across the predictor; without one, the parameter stays.  Parameter, tangent, motion, error."""
        worst, problem = np.inf, self.problem_at(parameter)
        free, n, lagging = problem.free, len(problem.free), stiff(problem, path)
        for sweeps in range(1, _LIMIT + 1):
            linearisation = self._linearise(problem, path, parameter)
            if linearisation is None:
                raise ConvergenceError("the balls have no equilibrium between the races")
            linear, report = linearisation
            span_transfer = linear.span_transfer
            border = self._bordered_matrix(problem, span_transfer, across)
            right = np.zeros((2 * n + 1, 2))
            right[: 2 * n, 0] = (span_transfer[:, 2 * n] + gap(problem, path)) / self.length
            right[2 * n, 1] = 1.0
            if prediction is not None:
                off = path.state(0, free) - prediction[0].state(0, free)
                right[2 * n, 0] = -across[: 2 * n] @ off / self.length
                right[2 * n, 0] -= across[-1] * (parameter - prediction[1]) / self.unit
            try:
                solution = np.linalg.solve(border, right)
            except np.linalg.LinAlgError as why:
                raise ConvergenceError("the branch has no single direction here") from why
            first, dp = self.length * solution[: 2 * n, 0], self.unit * solution[2 * n, 0]
            corrected, change = _shifted_path(path, free, linear, first, dp)
            correction = float(np.abs(change.q / problem.weight).max())
            if not np.isfinite(correction) or (
                sweeps > 2 and report[IMBALANCE] > 10.0 * worst and report[IMBALANCE] > 1e-9 * report[FORCE]
            ):
                raise ConvergenceError("the corrector diverges")
            worst = report[IMBALANCE]
            path = corrected
            parameter += dp
            renew(problem, path, lagging)
            size = float(np.abs(path.v / problem.weight).max())
            displacement = float(np.abs(path.q / problem.weight).max())
            if sweeps > 1 and correction <= 1e-2 * self.tolerance * max(size, 1e-3 * self.length) + 1e-14 * displacement:
                tangent = solution[:, 1] / np.linalg.norm(solution[:, 1])
                solved = Solved(problem, path, linear, size, True, sweeps, correction)
                # The error across the branch, which has a value at folds too.
                bordered = self._bordered_matrix(problem, span_transfer, tangent)
                error = estimate(solved, lambda end: np.linalg.solve(bordered, np.append(end, 0.0))[:-1])  # noqa: B023
                return parameter, tangent, solved, error
            problem = self.problem_at(parameter)
        raise ConvergenceError("the corrector does not converge")


def _shifted_path(path: Path, free: np.ndarray, linear: Eliminated, first: np.ndarray, dp: float) -> tuple[Path, Change]:
    """A path after changes of its first state (2 n,) and of the parameter, and its change."""
    change = Change(np.zeros_like(path.q), np.zeros_like(path.v), np.zeros_like(path.a))
    spread(free, linear, first, dp, change)
    return Path(path.nodes, path.q + change.q, path.v + change.v, path.a + change.a, path.ball, path.rate), change


def _two_spans(problem: Problem) -> Problem:
    span = problem.symmetry
    turn, order = span.rotation @ span.rotation, span.order[span.order]
    return attrs.evolve(problem, symmetry=Symmetry(2.0 * span.span, turn, 2.0 * span.angle, order, span.pitch))


def doubled(branch: Branch, point: Point) -> tuple[Branch, Point]:
    """The branch of two spans, and its first point: ``point``, a period doubling, with the tangent that leaves it.

    At a period doubling a disturbance v comes back as -v after a span: T v = -v. Two spans of the orbit, with v along the
    first and -v along the second, are the first point of a problem of two spans, at which another branch crosses with the
    tangent (v, 0).

    Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. (2010), section 7.4.
    """
    solution = point.solved
    problem, path = solution.problem, solution.path
    rotation, order = problem.symmetry.rotation, problem.symmetry.order
    both = Path(
        np.append(path.nodes[:-1], problem.symmetry.span + path.nodes), np.vstack([path.q[:-1], path.q @ rotation.T]),
        np.vstack([path.v[:-1], path.v @ rotation.T]), np.vstack([path.a, path.a @ rotation.T]),
        np.concatenate([path.ball, path.ball[:, order]]), np.concatenate([path.rate, path.rate[:, order]]),
    )  # fmt: skip
    values, vectors = np.linalg.eig(point.transfer)
    flip = vectors[:, np.argmin(np.abs(values + 1.0))].real
    at = branch.problem_at
    longer = attrs.evolve(branch, problem_at=lambda p: _two_spans(at(p)), most_intervals=2 * branch.most_intervals)
    tangent = np.append(flip / branch.length, 0.0)
    return longer, longer.along(both, point.parameter, tangent / np.linalg.norm(tangent))


def apart(point: Point) -> np.ndarray:
    """(2 n,) by which the state changes over half of two spans, turned back; 0 where the orbit repeats itself after one."""
    problem, path = point.solved.problem, point.solved.path
    q, v, *_ = motion_at(problem, path, np.array([0.0, 0.5 * problem.symmetry.span]))
    back = rotations(np.array([-0.5 * problem.symmetry.angle]))[0]
    first, second = np.concatenate([q[0], v[0]]), np.concatenate([back @ q[1], back @ v[1]])
    return np.asarray((second - first) / np.tile(problem.weight, 2))
