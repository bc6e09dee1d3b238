"""Floquet multipliers of a periodic motion: what becomes of a small disturbance.

Notes
-----
The transfer of a disturbance (dq, dq') over one span, turned back, has the multipliers mu as eigenvalues; over a turn they
are mu^(2 pi / span).  All inside the unit circle: disturbances die out.  One outside: the motion is never seen.  With next
to no damping they lie on the circle but for some 1e-7, and a disturbance neither grows nor dies.  An unstable motion is
left through +1 (fold, or symmetry breaking), -1 (period doubling) or a pair e^(+-j a) (a second frequency comes in).

References
----------
Nayfeh, Balachandran, Applied Nonlinear Dynamics (1995), chapter 3; Seydel, Practical Bifurcation and Stability Analysis,
3rd ed. (2010), chapter 7.
"""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np

from raceway.core.periodic.collocation import Solved

#: Distance from the unit circle that counts as on it: what a mesh fit for 1e-8 of the motion leaves of error.
NEUTRAL = 1e-6


@attrs.frozen(eq=False)
class Floquet:
    """Multipliers of one turn, the largest first.

    Attributes
    ----------
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
        """How an unstable motion is left: "+1", "-1" or "pair", of the period of one span; empty when it is not unstable."""
        if self.verdict != "unstable":
            return ""
        first = self.of_span[np.argmax(np.abs(self.of_span))]
        if abs(first.imag) > 1e-6 * abs(first):
            return "pair"
        return "+1" if first.real > 0.0 else "-1"

    def as_dict(self) -> dict[str, Any]:
        """For result.json."""
        return {
            "multipliers": [{"real": float(m.real), "imag": float(m.imag), "abs": float(abs(m))} for m in self.multipliers],
            "largest": self.largest,
            "verdict": self.verdict,
            "leaves_by": self.leaves_by or None,
        }


def floquet(solved: Solved) -> Floquet:
    """Multipliers of a periodic motion, from its last linearisation."""
    n = len(solved.problem.free)
    over_span = np.linalg.eigvals(solved.problem.closing.T @ solved.whole[:, : 2 * n]).astype(complex)
    turns = 2.0 * np.pi / solved.problem.symmetry.span
    with np.errstate(divide="ignore"):
        over_turn = np.exp(turns * np.log(over_span))
    order = np.argsort(-np.abs(over_turn))
    return Floquet(over_turn[order], over_span[order])
