"""Memory of nodal contacts and their balls between accepted steps, in the rows of a system's ``memory``."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.patches.balls import AppliedLoads
from raceway.core.patches.friction import Traction
from raceway.core.patches.patch import Patch

#: Columns before the slips: energy lost, number of velocities known, the last velocity, the one before, number of the patches.
_LOST, _KNOWN, _LAST, _BEFORE, _GRID, _SLIP = range(6)


@attrs.frozen(eq=False)
class History:
    """One state's memory.

    Attributes
    ----------
    lost : (2 Z,) energy that friction has taken [J]
    known : 0 to 2;  last, before : (Z, 2) velocities of the balls [m/s]
    grid : number of the patches on which the slips lie;  slip : (2 Z, points) [m], beyond the slip of the contact as a
        whole; without columns at first
    """

    lost: np.ndarray
    known: int
    last: np.ndarray
    before: np.ndarray
    grid: int
    slip: np.ndarray

    @classmethod
    def of(cls, memory: np.ndarray, balls: int) -> History:
        """From the rows of a memory (2 Z, 0 or more)."""
        if memory.shape[1] < _SLIP:
            none = np.zeros((balls, 2))
            return cls(np.zeros(2 * balls), 0, none, none, 0, np.zeros((2 * balls, 0)))
        last, before = (memory[:, column].reshape(2, -1).T for column in (_LAST, _BEFORE))
        return cls(memory[:, _LOST], int(memory[0, _KNOWN]), last, before, int(memory[0, _GRID]), memory[:, _SLIP:])

    def slips(self, reference: np.ndarray, generations: list[tuple[Patch, Patch]]) -> list[np.ndarray]:
        """Of the points of every contact on the last of the patches [m]; reference (2 Z,): of the contacts as a whole."""
        balls, now, then = len(reference) // 2, generations[-1], generations[self.grid]
        out = []
        for k, whole in enumerate(reference):
            patch, before = now[k // balls], then[k // balls]
            if not self.slip.shape[1]:
                out.append(np.full(patch.rows * patch.columns, whole))
            elif patch is before:
                out.append(whole + self.slip[k, : patch.rows * patch.columns])
            else:
                out.append(whole + _resampled(self.slip[k, : before.rows * before.columns], before, patch))
        return out

    def with_inertia(self, given: AppliedLoads, mass: float, dt: float, gain: float, rate: np.ndarray) -> AppliedLoads:
        """With the force -m a of balls that move at gain * place + rate, a from the velocities before (BDF 2, at first BDF 1)."""
        if not self.known:
            return given
        if self.known == 1:
            to_v, rest = 1.0 / dt, -self.last / dt
        else:
            to_v, rest = 1.5 / dt, (0.5 * self.before - 2.0 * self.last) / dt
        return attrs.evolve(given, push=-mass * (to_v * rate + rest), spring=mass * to_v * gain)

    def after(
        self, velocity: np.ndarray | None, traction_state: list[Traction | None], reference: np.ndarray, grid: int = 0
    ) -> np.ndarray:
        """(2 Z, 5 + points) the memory when the step is accepted; velocity (Z, 2) of the balls, None in a series of equilibria."""
        rubbed = [one for one in traction_state if one is not None]
        points = max((len(one.slip) for one in rubbed), default=0)
        out = np.zeros((len(traction_state), _SLIP + points))
        out[:, _LOST], out[:, _GRID] = self.lost, grid
        if velocity is not None:
            out[:, _KNOWN] = min(self.known + 1, 2)
            out[:, _LAST], out[:, _BEFORE] = velocity.T.reshape(-1), self.last.T.reshape(-1)
        for k, one in enumerate(rubbed):
            out[k, _LOST] += one.lost
            out[k, _SLIP : _SLIP + len(one.slip)] = one.slip - reference[k]
        return out


def _resampled(slip: np.ndarray, before: Patch, now: Patch) -> np.ndarray:
    """Slips on wider patches: linear between rows; points that are new have not carried and follow the ball, as the corner does."""
    old = slip.reshape(before.rows, before.columns)
    out = np.full((now.rows, now.columns), old[0, 0])
    more = (now.columns - before.columns) // 2
    for column in range(before.columns):
        ends = float(old[0, column]), float(old[-1, column])
        out[:, more + column] = np.interp(now.race.angle, before.race.angle, old[:, column], *ends)
    return out.reshape(-1)
