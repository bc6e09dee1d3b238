"""The branch of steady orbits over a key, with the branches of twice the period that leave it, and what happens where it is unstable."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.periodic.branch import DOUBLING, Branch, Point, apart, doubled, located, special_points
from raceway.core.periodic.collocation import Path, Problem, Solved, solve
from raceway.core.periodic.refinement import motion_at
from raceway.core.periodic.search import MOST, directly, find, highest_order, mesh_of
from raceway.errors import ConvergenceError
from raceway.points.attractor import instead
from raceway.points.branch import OPENS, PEAK, Followed, Label, Row, growth_of_swing, openness, resonance, row_of
from raceway.points.parameter import Parameter

#: Error of orbits over their size that meshes are kept fit for, and that at which a branch is left.
ERROR, _LOST = 1e-6, 1e-3
#: Length from the prediction to a point over the step, from which it may be another branch's.
_STRAYED = 0.2
#: Most change of the key in a step, in tenths of the range.
_MOST = 0.5
#: Distance from the last value over the range, from which it is reached with the key held.
_BESIDE = 1e-4
OnProgress = Callable[[str, int, int], None]


@attrs.define(eq=False)
class Walk:
    """Follows a branch and writes down what it meets.

    Attributes
    ----------
    mass : m of K [kg];  points : orbits at most
    """

    branch: Branch
    curve: Followed
    parameter: Parameter
    mass: float
    points: int
    arc: float = 0.0

    def go(
        self, here: Point, size: float, on_progress: OnProgress | None, closed: Callable[[Point], bool] | None = None
    ) -> None:
        """Points one by one, until the range or the number of points is left, the branch ends, or ``closed`` says so."""
        self._go(here, size, on_progress, closed)
        self.curve.labels.sort(key=lambda label: label.row.arc)

    def _go(self, here: Point, size: float, on_progress: OnProgress | None, closed: Callable[[Point], bool] | None) -> None:
        curve, least = self.curve, 1e-6 * size
        self._tell(here, row_of(here, self.arc, self.mass))
        while len(curve.rows) < self.points:
            if on_progress is not None:
                on_progress("orbits", len(curve.rows), self.points)
            try:
                there = self.branch.step(here, size)
                if there.strayed > _STRAYED * size:
                    raise ConvergenceError("the branch bends too much for the step")
                there, size, end = self._within(here, there, size)
                row = row_of(there, self.arc + size, self.mass)
            except ConvergenceError as why:
                size *= 0.5
                if size < least:
                    if not self._at_the_last(here):
                        curve.end = f"the branch ends at {here.parameter:.6g}: {why}{resonance(here.solved)}"
                    return
                continue
            if closed is not None and closed(there):
                return
            self._between(here, there, size)
            self.arc += size
            self._tell(there, row)
            if there.error > _LOST:
                curve.end = (
                    f"left at {there.parameter:.6g}: no mesh follows the orbit closer than {there.error:.1e} of its size"
                )
                if curve.rows[-1].lost:
                    curve.end += f" where up to {curve.rows[-1].lost} balls lose their inner race at once"
                curve.end += resonance(there.solved)
                return
            if end is not None:
                curve.end = "" if end == self.parameter.last else f"the branch comes back to {end:.6g}"
                return
            size = min(size * self.branch.growth(there), _MOST / max(abs(there.tangent[-1]), 1e-300))
            here = self._meshed(there)
        curve.end = f"left after {self.points} orbits at {here.parameter:.6g} (--points)"

    def _at_the_last(self, here: Point) -> bool:
        """Beside the last value, beyond which there may be no scene, as no damping below 0: with the key held."""
        gap = self.parameter.last - here.parameter
        if abs(gap) > _BESIDE * abs(self.parameter.last - self.parameter.first):
            return False
        try:
            solved = solve(
                self.parameter.problem_at(self.parameter.last, here.solved.problem.symmetry), here.solved.path, 1e-2 * ERROR
            )
            there = self.branch.start(solved, self.parameter.last, float(np.sign(gap)))
        except ConvergenceError:
            return False
        self.arc += abs(gap) / self.branch.unit
        self._tell(there, row_of(there, self.arc, self.mass))
        return True

    def _within(self, one: Point, two: Point, size: float) -> tuple[Point, float, float | None]:
        """The second point, or that at the end of the range between the two; the step's length, and that end."""
        for end in (self.parameter.last, self.parameter.first):
            if (two.parameter - end) * (one.parameter - end) < 0.0:
                return *located(self.branch, one, two, size, _reached(end)), end
        return two, size, None

    def _tell(self, point: Point, row: Row) -> None:
        before = self.curve.rows[-1] if self.curve.rows else None
        self.curve.rows.append(row)
        if row.verdict == "unstable":
            worst = self.curve.worst
            if before is None or before.verdict != "unstable":
                worst.append(point)
            elif row.multiplier > worst[-1].floquet.largest:
                worst[-1] = point

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
            span = f"between {one.parameter:.6g} and {two.parameter:.6g}"
            curve.notes.append(
                f"{span} a fold, peak or change of stability or contact is not located, take a smaller --aim ({why})"
            )

    def _meshed(self, point: Point) -> Point:
        """The same orbit on a mesh that is fit for the fastest vibration at the present speed."""
        problem, path = point.solved.problem, point.solved.path
        nodes = mesh_of(problem, point.highest)
        wanted, there = len(nodes) - 1, path.intervals
        if wanted > there or 2 * wanted < there and point.error < 1e-2 * ERROR:
            q, v, *_ = motion_at(problem, path, nodes)
            *_, a, ball, rate = motion_at(problem, path, problem.angles(nodes))
            parts = (np.ascontiguousarray(part) for part in (q, v, a, ball, rate))
            try:
                solved = solve(problem, Path(nodes, *parts), 1e-2 * ERROR)
                again = self.branch.start(solved, point.parameter, float(np.sign(point.tangent[-1])))
            except ConvergenceError:
                return point
            if float(again.tangent @ point.tangent) > 0.9:
                return again
        return point


def _reached(end: float) -> Callable[[Point], float]:
    return lambda point: float(point.parameter - end)


#: Error of the first orbit over its size.
_TOLERANCE = 1e-8
#: First step, in tenths of the range and sizes of the first orbit.
_FIRST = 0.02


class FollowInterrupt(KeyboardInterrupt):
    """Ctrl-C on the way; ``partial``: the curve up to there, whose ``end`` says so."""

    def __init__(self, partial: Followed) -> None:
        super().__init__()
        self.partial = partial


@attrs.frozen
class Rule:
    """How a branch is followed.

    Attributes
    ----------
    points : that it may have at most
    aim : deviation of an orbit's start from the prediction along the tangent, over the orbit's size: steps are chosen for it
    doubled : whether branches of twice the period are followed, too
    turns : of the time integration from the most unstable orbit of each unstable stretch; 0: none
    """

    points: int = 1000
    aim: float = 1e-3
    doubled: bool = False
    turns: int = 0


def follow(parameter: Parameter, rule: Rule, on_progress: OnProgress | None = None) -> Followed:
    """The branch from the orbit at the first value of the key to the last one.

    Raises
    ------
    ConvergenceError
        No equilibrium or no orbit at the first value.
    FollowInterrupt
        On Ctrl-C, with the orbits so far.
    """
    model, equilibrium = parameter.settled(parameter.first)
    q, tangent, mass = equilibrium.displacement, equilibrium.stiffness_rows_held, model.mass_used
    try:
        end = parameter.settled(parameter.last)[1]
    except ConvergenceError as why:
        raise ConvergenceError(f"at `{parameter.key}` = {parameter.last:g}: {why}", why.state) from why
    symmetry = parameter.symmetry(q)
    problem = parameter.problem_at(parameter.first, symmetry)
    if on_progress is not None:
        problem = attrs.evolve(problem, watch=lambda: on_progress("the first orbit", 0, 0))
    first = _first(problem, q, tangent)
    unit = abs(parameter.last - parameter.first) / 10.0
    last = parameter.problem_at(parameter.last, symmetry)
    squares = [(highest_order(at, k) * at.speed) ** 2 for at, k in ((problem, tangent), (last, end.stiffness_rows_held))]

    def fastest(p: float) -> float:
        """Highest natural frequency [rad/s]: its square is linear in a stiffness."""
        part = (p - parameter.first) / (parameter.last - parameter.first)
        return float(np.sqrt(max(squares[0] + part * (squares[1] - squares[0]), min(squares))))

    branch = Branch(lambda p: parameter.problem_at(p, symmetry), unit, first.size, ERROR, MOST, None, fastest, rule.aim)
    curve = Followed(parameter.key, parameter.first, parameter.last, float(np.degrees(symmetry.span)), model.scene.title)
    sense = 1.0 if parameter.last > parameter.first else -1.0
    try:
        Walk(branch, curve, parameter, mass, rule.points).go(
            branch.start(first, parameter.first, sense), _FIRST, on_progress
        )
        if rule.doubled:
            _doubled(branch, curve, parameter, mass, rule, on_progress)
        for one in (curve, *curve.doubled) if rule.turns else ():
            one.instead += [instead(point, rule.turns, on_progress) for point in one.worst]
    except KeyboardInterrupt as stop:
        raise FollowInterrupt(_stopped(curve)) from stop
    return curve


def _stopped(curve: Followed) -> Followed:
    """What there is of a curve that was stopped."""
    curve.doubled = [one for one in curve.doubled if one.rows]
    for one in (curve, *curve.doubled):
        one.labels.sort(key=lambda label: label.row.arc)
    here = curve.rows[-1].parameter if curve.rows else curve.first
    if curve.end or here == curve.last:
        curve.notes.append("stopped before the branches of twice the period and the time integrations were finished")
    else:
        curve.end = f"stopped at {here:.6g} after {len(curve.rows)} orbits; --over {curve.key}={here:.6g}:{curve.last:g} goes on from there"
    return curve


def _doubled(
    branch: Branch, curve: Followed, parameter: Parameter, mass: float, rule: Rule, on_progress: OnProgress | None
) -> None:
    """The branches of twice the period; one that ends at another period doubling is that one's, too."""
    met: list[float] = []
    for label in curve.labels:
        point = label.point
        if label.kind != DOUBLING or point is None or any(abs(point.parameter - p) < 1e-6 * branch.unit for p in met):
            continue
        met.append(point.parameter)
        one = attrs.evolve(
            curve, span_deg=2.0 * curve.span_deg, rows=[], labels=[], notes=[], worst=[], doubled=[], instead=[]
        )
        curve.doubled.append(one)
        longer, first = doubled(branch, point)
        halves = _Halves()
        Walk(longer, one, parameter, mass, rule.points).go(first, _FIRST, on_progress, halves.together)
        if halves.met:
            one.end = ""
            others = [other.row.parameter for other in curve.labels if other.kind == DOUBLING]
            met.append(min(others, key=lambda p: abs(p - one.rows[-1].parameter)))


@attrs.define
class _Halves:
    """Whether the two halves of a doubled orbit have come together again, which they do at another period doubling."""

    first: np.ndarray | None = None
    met: bool = False

    def together(self, point: Point) -> bool:
        """Asked for each point of the branch in its order."""
        here = apart(point)
        self.first = here if self.first is None else self.first
        self.met = float(here @ self.first) <= 0.0
        return self.met


def _first(problem: Problem, q: np.ndarray, tangent: np.ndarray) -> Solved:
    """The first orbit: that from the linear response if full steps lead to one, else the one that the search takes."""
    try:
        return directly(problem, q, tangent, _TOLERANCE).solved
    except ConvergenceError:
        return find(problem, q, tangent, _TOLERANCE).refined.solved
