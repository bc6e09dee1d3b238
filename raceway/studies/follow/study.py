"""The branch of steady orbits over a key, with the branches of twice the period that leave it, and what happens where it is unstable."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.periodic.branch import Branch, Point
from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.direct import MOST, directly, highest_order
from raceway.core.periodic.doubling import apart, doubled
from raceway.core.periodic.problem import Problem
from raceway.core.periodic.search import find
from raceway.core.periodic.special import DOUBLING
from raceway.errors import ConvergenceError
from raceway.studies.follow.instead import instead
from raceway.studies.follow.parameter import Parameter
from raceway.studies.follow.result import Followed
from raceway.studies.follow.walk import ERROR, OnProgress, Walk

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
