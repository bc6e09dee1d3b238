"""First guess of a periodic motion from a similar problem: the difference of that motion from its own linear response.

Notes
-----
The linear response of the new problem about its own equilibrium, plus the nonlinear part of its neighbour's motion, is where
Newton's iteration begins.  Where that part is large, several motions may exist under one force, and a neighbour could lead
to another one than the search from rest: it is left alone then, and so is what it led to when that is far from linear;
unless the neighbour's own continuation is asked for.
"""

from __future__ import annotations

from typing import ClassVar

import attrs
import numpy as np

from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.first_guess import guess, standing
from raceway.core.periodic.problem import Path, Problem
from raceway.core.periodic.sampling import motion_at

#: Nonlinear part over the motion's size, up to which a neighbour is followed.  A Duffing oscillator has one motion only as
#: long as its amplitude stays within a third of the linear one (with some damping); far below that nothing can fold.
MOST_NONLINEAR = 0.1


@attrs.frozen(eq=False)
class Neighbour:
    """A solved motion, to be followed.

    Attributes
    ----------
    problem : that it solves
    excess : motion less its linear response about the equilibrium; balls and rates as they are
    share : largest derivative of the excess over that of the motion
    """

    problem: Problem
    excess: Path
    share: float

    def first_guess(self, problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path | None:
        """First guess for Newton's iteration on a mesh; None where this motion is none of the problem's unknowns.

        Parameters
        ----------
        q : (5,) static equilibrium of ``problem``;  tangent : (5, 5) of its contacts
        """
        if not self._alike(problem):
            return None
        first = guess(problem, q, tangent, nodes)
        dq, dv, _, _, _ = motion_at(self.problem, self.excess, nodes)
        _, _, da, ball, rate = motion_at(self.problem, self.excess, problem.angles(nodes))
        return Path(nodes, first.q + dq, first.v + dv, first.a + da, np.ascontiguousarray(ball), np.ascontiguousarray(rate))

    @property
    def near_linear(self) -> bool:
        """Whether the motion is so close to its linear response that no other one is near."""
        return self.share <= MOST_NONLINEAR

    def _alike(self, problem: Problem) -> bool:
        mine, other = self.problem, problem
        same = (mine.system.ball_count, mine.system.ball_columns) == (other.system.ball_count, other.system.ball_columns)
        return same and mine.symmetry.span == other.symmetry.span and np.array_equal(mine.free, other.free)


@attrs.frozen(eq=False)
class Recorded:
    """A turn of a motion that was integrated, to be followed to the periodic one that it settles on.

    Attributes
    ----------
    period : [s];  displacement, velocity, acceleration : (n, 5) at equidistant times from 0 on
    """

    period: float
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray

    near_linear: ClassVar[bool] = False

    def first_guess(self, problem: Problem, q: np.ndarray, tangent: np.ndarray, nodes: np.ndarray) -> Path:
        """The same motion on a mesh; parameters as of ``Neighbour``'s."""
        w, inner = problem.speed, problem.angles(nodes)
        still = standing(problem, q, nodes)
        return attrs.evolve(
            still,
            q=self._at(self.displacement, nodes / w),
            v=self._at(self.velocity, nodes / w) / w,
            a=self._at(self.acceleration, inner / w) / w**2,
        )

    def _at(self, values: np.ndarray, times: np.ndarray) -> np.ndarray:
        """By trigonometric interpolation."""
        n = len(values)
        lines = np.fft.rfft(values, axis=0) / n
        lines[1 : (n + 1) // 2] *= 2.0  # but the line at half the sampling rate
        waves = np.exp(2j * np.pi / self.period * times[:, None] * np.arange(len(lines)))
        return np.ascontiguousarray((waves @ lines).real)


def neighbour_of(solved: Solved, q: np.ndarray, tangent: np.ndarray) -> Neighbour:
    """A solved motion, for other problems to start from; ``q``, ``tangent`` as in ``first_guess``."""
    problem, path = solved.problem, solved.path
    first = guess(problem, q, tangent, path.nodes)
    excess = attrs.evolve(path, q=path.q - first.q, v=path.v - first.v, a=path.a - first.a)
    share = float(np.abs(excess.v / problem.weight).max()) / max(solved.size, 1e-300)
    return Neighbour(problem, excess, share)
