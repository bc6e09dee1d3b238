"""What nodal contacts and their balls remember between accepted steps, in the rows of a system's ``memory``."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.condensed.balls import Given
from raceway.core.condensed.friction import Gripped

#: Columns before the slips: energy lost, number of velocities known, the last velocity, the one before.
_LOST, _KNOWN, _LAST, _BEFORE, _SLIP = range(5)


@attrs.frozen(eq=False)
class History:
    """Attributes: lost (2 Z,) [J];  known : 0 to 2;  last, before : (Z, 2) velocities of the balls [m/s];  slip : (2 Z, points) [m],
    beyond the slip of the contact as a whole; without columns at first."""

    lost: np.ndarray
    known: int
    last: np.ndarray
    before: np.ndarray
    slip: np.ndarray

    @classmethod
    def of(cls, memory: np.ndarray, balls: int) -> History:
        """From the rows of a memory (2 Z, 0 or more)."""
        if memory.shape[1] <= _BEFORE:
            none = np.zeros((balls, 2))
            return cls(np.zeros(2 * balls), 0, none, none, np.zeros((2 * balls, 0)))
        last, before = (memory[:, column].reshape(2, -1).T for column in (_LAST, _BEFORE))
        return cls(memory[:, _LOST], int(memory[0, _KNOWN]), last, before, memory[:, _SLIP:])

    def slips(self, reference: np.ndarray, sizes: list[int]) -> list[np.ndarray]:
        """Of the points of every contact [m]; reference (2 Z,): of the contacts as a whole;  sizes : points of each."""
        if not self.slip.shape[1]:
            return [np.full(size, whole) for whole, size in zip(reference, sizes, strict=True)]
        return [whole + row[:size] for whole, row, size in zip(reference, self.slip, sizes, strict=True)]

    def with_inertia(self, given: Given, mass: float, dt: float, gain: float, rate: np.ndarray) -> Given:
        """With the force -m a of balls that move at gain * place + rate, a from the velocities before (BDF 2, at first BDF 1)."""
        if not self.known:
            return given
        if self.known == 1:
            to_v, rest = 1.0 / dt, -self.last / dt
        else:
            to_v, rest = 1.5 / dt, (0.5 * self.before - 2.0 * self.last) / dt
        return attrs.evolve(given, push=-mass * (to_v * rate + rest), spring=mass * to_v * gain)

    def after(self, velocity: np.ndarray | None, gripped: list[Gripped | None], reference: np.ndarray) -> np.ndarray:
        """(2 Z, 4 + points) the memory when the step is accepted; velocity (Z, 2) of the balls, None in a series of equilibria."""
        rubbed = [one for one in gripped if one is not None]
        points = max((len(one.slip) for one in rubbed), default=0)
        out = np.zeros((len(gripped), _SLIP + points))
        out[:, _LOST] = self.lost
        if velocity is not None:
            out[:, _KNOWN] = min(self.known + 1, 2)
            out[:, _LAST], out[:, _BEFORE] = velocity.T.reshape(-1), self.last.T.reshape(-1)
        for k, one in enumerate(rubbed):
            out[k, _LOST] += one.lost
            out[k, _SLIP : _SLIP + len(one.slip)] = one.slip - reference[k]
        return out
