"""Coulomb friction at the surface points of one contact: traction along the groove, stick and slip point by point.

All points share one rigid displacement along the groove (``raceway.core.ring.kernels.rolling``: the way L a of the
contact less the turn of the ring's section), as bodies do that are stiff away from their contact.  With C the
compliance of ball and race along the groove and s the slip of every point,

    place - s - C q = 0,  |q| <= mu f    where a point sticks,        q = +- mu f    where it slips, s growing along q

which is the return mapping of all points at once: the least of q.C q / 2 - q.(place - s) under the bounds, found by an active set.
Points without pressure follow the ball.  Tangential displacements by pressures are left out: between bodies of one material
both surfaces move alike (Goodman 1962).  So is traction along the rolling direction.

Mindlin, Compliance of elastic bodies in contact, J. Appl. Mech. 16 (1949); Johnson, Contact Mechanics (1985), 5.4, 7.2.
"""

import attrs
import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from raceway.core.fem.patches.compliance import between
from raceway.core.fem.patches.patch import Patch
from raceway.errors import ConvergenceError

#: Iterations with whole exchanges, after which only the worst point is exchanged, and their largest number.
_WHOLE, _LIMIT = 25, 400
_NONE = np.zeros(0, dtype=np.int64)


@attrs.frozen(eq=False)
class Traction:
    """A contact's answer along the groove."""

    force: float  # resultant of the tractions [N], positive against a positive place
    by_place: float  # its derivative by the place [N/m]
    by_load: np.ndarray  # (n,) by the points' pressure forces
    slip: np.ndarray  # (rows * columns,) of every point [m]
    lost: float  # energy that slipping took since the slips given [J]
    sliding: np.ndarray  # (n,) 1, -1 where a point slips, 0 where it sticks


class Friction:
    """Stick and slip of one contact, with the memory that makes the next solution cheap.

    patch : with the compliances along the groove (``_Race.shear``, ``_Ball.shear``);  coefficient : of friction
    """

    def __init__(self, patch: Patch, coefficient: float) -> None:
        assert patch.race.shear is not None
        assert patch.ball.shear is not None
        self.patch, self.coefficient = patch, coefficient
        self._race, self._ball = patch.race.shear, patch.ball.shear
        self._nodes, self._block = _NONE, np.zeros((0, 0))
        self._sliding = np.zeros(patch.rows * patch.columns, dtype=np.int64)
        self._stuck, self._lower = _NONE, np.zeros((0, 0))

    def pull(self, nodes: np.ndarray, load: np.ndarray, position: float, slip: np.ndarray) -> Traction:
        """Tractions at a place [m] of the contact along the groove.

        nodes, load : (n,) points that carry and their forces [N];  slip : (rows * columns,) committed last [m]

        ConvergenceError: The sets repeat themselves.
        """
        after = np.full(len(slip), position)
        if not len(nodes):
            return Traction(0.0, 0.0, np.zeros(0), after, 0.0, np.zeros(0, dtype=np.int64))
        self._gather(nodes)
        bound, free = self.coefficient * load, position - slip[nodes]
        sliding = self._sliding[nodes]
        for iteration in range(1, _LIMIT + 1):
            sticking = np.flatnonzero(sliding == 0)
            traction = sliding * bound
            if len(sticking):
                self._factorise(sticking)
                traction[sticking] = self._solve((free - self._block @ traction)[sticking])
            excess = free - self._block @ traction  # what slips on top
            breaks = (sliding == 0) & (np.abs(traction) > bound * (1.0 + 1e-12))
            stops = sliding * excess < 0.0
            if not (breaks.any() or stops.any()):
                break
            if iteration > _WHOLE:
                breaks, stops = only_largest(breaks, np.abs(traction) - bound), stops & ~breaks.any()
                stops = only_largest(stops, -sliding * excess)
            sliding = np.where(breaks, np.sign(traction).astype(np.int64), np.where(stops, 0, sliding))
        else:
            raise ConvergenceError(f"the slipping points were not determined in {_LIMIT} exchanges")
        self._sliding[:] = 0
        self._sliding[nodes] = sliding
        by_load = self.coefficient * sliding.astype(float)
        by_place = 0.0
        if len(sticking):
            ones = self._solve(np.ones(len(sticking)))
            by_place = float(ones.sum())
            by_load *= 1.0 - ones @ self._block[sticking]
        moved = np.where(sliding == 0, 0.0, excess)
        after[nodes] = slip[nodes] + moved
        return Traction(float(traction.sum()), by_place, by_load, after, float(traction @ moved), sliding)

    def _gather(self, nodes: np.ndarray) -> None:
        if np.array_equal(nodes, self._nodes):
            return
        self._nodes, self._stuck = nodes.copy(), _NONE
        self._block = np.empty((len(nodes), len(nodes)))
        between(self._ball, self._race, nodes, nodes, self._block)

    def _factorise(self, sticking: np.ndarray) -> None:
        if np.array_equal(sticking, self._stuck):
            return
        self._lower, status = dpotrf(self._block[np.ix_(sticking, sticking)], lower=1)
        if status != 0:
            why = "the compliance along a groove is not positive definite: its mesh is too coarse or distorted"
            raise ConvergenceError(why)
        self._stuck = sticking.copy()

    def _solve(self, right: np.ndarray) -> np.ndarray:
        return np.asarray(dpotrs(self._lower, right, lower=1)[0])


def only_largest(flags: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Only that of the flagged ones whose value is largest."""
    out = np.zeros_like(flags)
    if flags.any():
        out[np.argmax(np.where(flags, values, -np.inf))] = True
    return out
