"""Floquet multipliers of a periodic motion: what becomes of a small disturbance.

The transfer of a disturbance (dq, dq') over one span, turned back, has the multipliers mu as eigenvalues; over a turn they
are mu^(2 pi / span).  All inside the unit circle: disturbances die out.  One outside: the motion is never seen.  With next
to no damping they lie on the circle but for some 1e-7, and a disturbance neither grows nor dies.  An unstable motion is
left through +1 (fold, or symmetry breaking), -1 (period doubling) or a pair e^(+-j a) (a second frequency comes in).

Nayfeh, Balachandran, Applied Nonlinear Dynamics (1995), chapter 3; Seydel, Practical Bifurcation and Stability Analysis,
3rd ed. (2010), chapter 7.
"""

import attrs
import numpy as np

from raceway.core.periodic.collocation import Solved, linearised
from raceway.core.periodic.refinement import divided, sampled_at
from raceway.storage.tables import Tables

#: Distance from the unit circle that counts as on it: what a mesh fit for 1e-8 of the motion leaves of error.
NEUTRAL = 1e-6
#: Phase of the fastest vibration in an interval that leaves its multiplier an error of 1e-6 of a turn at order 30.
_PHASE = 1.05


@attrs.frozen(eq=False)
class Floquet:
    """Multipliers of one turn, the largest first.

    multipliers : (2 n,) complex, over a turn of the force;  of_span : (2 n,) over one span
    """

    multipliers: np.ndarray
    of_span: np.ndarray

    @property
    def largest(self) -> float:
        """Growth of the most persistent disturbance in a turn."""
        return float(np.abs(self.multipliers[0]))

    @property
    def verdict(self) -> str:
        """ "stable", "unstable" or "neutral" (on the unit circle to 1e-6)."""
        if self.largest > 1.0 + NEUTRAL:
            return "unstable"
        return "stable" if self.largest < 1.0 - NEUTRAL else "neutral"

    @property
    def leaves_by(self) -> str:
        """Type of instability: "+1", "-1" or "pair", of the period of one span; empty when it is not unstable."""
        if self.verdict != "unstable":
            return ""
        first = self.of_span[np.argmax(np.abs(self.of_span))]
        if abs(first.imag) > 1e-6 * abs(first):
            return "pair"
        return "+1" if first.real > 0.0 else "-1"

    def to_dict(self) -> Tables:
        """For result.json."""
        return {
            "multipliers": [{"real": float(m.real), "imag": float(m.imag), "abs": float(abs(m))} for m in self.multipliers],
            "largest": self.largest,
            "verdict": self.verdict,
            "leaves_by": self.leaves_by or None,
        }


def floquet(solution: Solved, highest: float = 0.0) -> Floquet:
    """Multipliers of a periodic motion, from its last linearisation.

    highest : order of the fastest vibration about the motion: a mesh that is fit for the motion may be too coarse for it

    The rates of the balls are taken as they are along the motion.  That leaves the phases as they are, and the decay that the
    contacts' dashpots bring off by the difference of the races' compliances over their sum (2 % of the decay for B7206C).
    """
    return floquet_of(transfer(solution, highest), solution.problem.symmetry.span)


def transfer(solution: Solved, highest: float = 0.0) -> np.ndarray:
    """(2 n, 2 n) of a disturbance of the state over a span, turned back; ``highest`` as of ``floquet``."""
    problem, path, span_transfer = solution.problem, solution.path, solution.eliminated.span_transfer
    parts = np.ceil(np.diff(path.nodes) * min(highest, 2000.0) / _PHASE - 1e-9).astype(int)
    if parts.max() > 1:  # linearised anew where intervals are long for the fastest vibration
        finer = sampled_at(problem, path, divided(path.nodes, np.maximum(parts, 1)))
        span_transfer = linearised(problem, finer).span_transfer
    return np.asarray(problem.closing.T @ span_transfer[:, : 2 * len(problem.free)])


def floquet_of(over: np.ndarray, span: float) -> Floquet:
    """Multipliers of a transfer over a span [rad]."""
    over_span = np.linalg.eigvals(over).astype(complex)
    over_turn = over_span ** (2.0 * np.pi / span)
    order = np.argsort(-np.abs(over_turn))
    return Floquet(over_turn[order], over_span[order])
