"""The periodic boundary-value problem on one mesh, and Newton's iteration for all its unknowns at once."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.periodic.arrays import Eliminated
from raceway.core.periodic.newton import (
    CORRECTION,
    IMBALANCE,
    REPORT,
    ROUNDING,
    SHORTENED,
    SINGULAR,
    SIZE,
    SOLVED,
    STALLED,
    SWEEPS,
    Closure,
    Limits,
    newton,
)
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.rates import renew, stiff
from raceway.errors import ConvergenceError

#: Turns of motion and rates, and the change over the motion's size that rounding may leave.
_RATES, _LEFT = 20, 1e-9


@attrs.frozen(eq=False)
class Solved:
    """A periodic motion on one mesh.

    Attributes
    ----------
    eliminated : the last linearisation
    size : largest derivative by the angle [m], the amplitude of a 1x motion; tilts as lengths at the arm
    direct : whether full steps of Newton's iteration sufficed
    sweeps : of all intervals that it took;  correction : the last one [m]
    """

    problem: Problem
    path: Path
    eliminated: Eliminated
    size: float
    direct: bool
    sweeps: int
    correction: float

    @property
    def rounding(self) -> float:
        """What rounding leaves of error, over the motion's size: of displacements, or of forces where the last correction is that.

        Much of a motion of picometres.
        """
        place = ROUNDING * float(np.abs(self.path.q / self.problem.weight).max())
        return max(place, self.correction) / max(self.size, 1e-300)


def gap(problem: Problem, path: Path) -> np.ndarray:
    """Gap between the end of a path (2 n,) and the rotated state of its beginning: y_m - P y_0 of the unknown states."""
    first, last = (np.concatenate([path.q[k, problem.free], path.v[k, problem.free]]) for k in (0, -1))
    return np.asarray(last - problem.closing @ first)


def solve(problem: Problem, path: Path, tolerance: float, patience: int = 12, limit: int = 40) -> Solved:
    """Newton's iteration from a first guess.

    Parameters
    ----------
    tolerance : largest last correction over the motion's size
    patience : halvings of a step that may follow each other

    Notes
    -----
    Where dashpots make the balls lag, the motion with given rates and the rates of that motion are found in turn.

    Raises
    ------
    ConvergenceError
        With the state at the start of the span that the iteration ended at, finite or the first guess.
    """
    if not stiff(problem, path):
        return _newton(problem, path, tolerance, patience, limit, np.array(problem.system.rated_columns))
    sweeps, change = 0, np.inf
    for turn in range(_RATES):
        found = _newton(problem, path, tolerance, patience, limit, np.empty(0, dtype=np.int64))
        sweeps += found.sweeps
        last, change = change, float(np.abs((found.path.q - path.q) / problem.weight).max())
        path = found.path
        enough = 10.0 * max(tolerance, found.rounding) * found.size
        if turn > 0 and (change <= enough or (change >= last and change <= _LEFT * found.size)):
            return attrs.evolve(found, sweeps=sweeps)
        problem.watch()
        renew(problem, path, True)
    raise ConvergenceError(
        f"no periodic motion found near the first guess: the rates of the balls change it by {change:.2g} m still: too "
        "strong dashpots in the contacts",
        {"q": path.q[0].copy()},
    )


def _newton(problem: Problem, path: Path, tolerance: float, patience: int, limit: int, rated: np.ndarray) -> Solved:
    """The compiled iteration; ``rated``: columns of the balls whose rates are put in after every sweep."""
    eliminated, report = problem.eliminated(path.nodes), np.zeros(REPORT)
    q, v, a, ball, rate = path.q.copy(), path.v.copy(), path.a.copy(), path.ball.copy(), path.rate.copy()
    found = attrs.evolve(path, q=q, v=v, a=a, ball=ball, rate=rate)
    closure, limits = (
        Closure(problem.closing, problem.symmetry.order, rated),
        Limits(tolerance, problem.system.force_rounding(path.q[0]), limit, patience),
    )
    samples = found.samples(problem.push(path.nodes))
    status = newton(problem.equations, closure, problem.mesh(path.nodes), samples, limits, eliminated, report)
    if status != SOLVED:
        why = {STALLED: "the iteration stalls", SINGULAR: "the motion is singular"}.get(
            status, "the balls find no place between the races"
        )
        raise ConvergenceError(
            f"no periodic motion found near the first guess: {why} after {int(report[SWEEPS])} iterations, imbalance "
            f"{report[IMBALANCE]:.2g} N",
            {"q": q[0] if np.isfinite(q[0]).all() else path.q[0].copy()},
        )
    return Solved(
        problem,
        found,
        eliminated,
        float(report[SIZE]),
        report[SHORTENED] == 0.0,
        int(report[SWEEPS]),
        float(report[CORRECTION]),
    )
