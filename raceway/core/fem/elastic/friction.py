"""Coulomb friction at the points of a nodal contact, by return mapping with a committed history.

A point that shifts by s against its partner since the last commit carries the trial resistance
t* = t0 + k s, both in the present tangent plane (t0 is what it carried at the commit).  It sticks, t = t*, while
|t*| <= mu p; else it slips: t = mu p t* / |t*|.  With tau = t* / |t*| and n the normal along which the gap opens,

    dt/ds = k (I - n n)                                          sticking
    dt/ds = (mu p / |t*|) k (I - n n - tau tau) + mu dp/dg tau n slipping

The last term makes the tangent unsymmetric.  It is mu times the normal stiffness, so that leaving it out of the system
costs a linear convergence with a factor of about mu: at mu = 0.03 three decimals in two iterations.

Simo, Laursen: An augmented Lagrangian treatment of contact problems involving friction, Computers & Structures 42 (1992);
Wriggers: Computational Contact Mechanics (2006), section 5.2.
"""

from collections.abc import Mapping

import numpy as np
from numba import boolean, float64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR

#: Columns of the tangent's coefficients: across and along the slip [N/m3], and mu dp/dg [N/m3].
_ACROSS, _ALONG, _COUPLING = range(3)


@jit(void(VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, float64, VECTOR, MATRIX, MATRIX, MATRIX, VECTOR), releases=True)
def return_map(pressure, d_gap, normal, shift, before, coefficient, stick, resistance, direction, factors, dissipation):  # type: ignore[no-untyped-def]
    """Resistances of n points, their tangents and what they lost.

    pressure, d_gap : (n,) normal pressure [Pa] and its derivative by the gap [N/m3];  normal : (n, 3) unit normals
    shift : (n, 3) motion of the points against their partners since the commit [m];  before : (n, 3) resistances at the commit [Pa]
    coefficient : of friction;  stick : (n,) stiffness of sticking points [N/m3]
    resistance : (n, 3) out: what the partner pulls the points back with [Pa]
    direction, factors : (n, 3) out: unit directions of slip, and the columns ``_ACROSS``, ``_ALONG``, ``_COUPLING``
    dissipation : (n,) out: energy lost since the commit [J/m2], by the mean resistance over the step
    """
    for i in range(pressure.size):
        k = stick[i]
        off, off_before = 0.0, 0.0
        for c in range(3):
            off += normal[i, c] * (k * shift[i, c])
            off_before += normal[i, c] * before[i, c]
        size = 0.0
        for c in range(3):
            trial = before[i, c] - off_before * normal[i, c] + k * shift[i, c] - off * normal[i, c]
            resistance[i, c] = trial
            size += trial * trial
        size = size**0.5
        limit = coefficient * pressure[i]
        share = 1.0
        factors[i, 0], factors[i, 1], factors[i, 2] = k, k, 0.0
        if size > limit:
            share = limit / size
            factors[i, 0], factors[i, 1], factors[i, 2] = k * share, 0.0, coefficient * d_gap[i]
        work = 0.0
        for c in range(3):
            trial = resistance[i, c]
            direction[i, c] = trial / size if size > 0.0 else 0.0
            resistance[i, c] = share * trial
            work += 0.5 * (resistance[i, c] + before[i, c]) * (1.0 - share) * trial
        dissipation[i] = work / k


@jit(void(MATRIX, MATRIX, MATRIX, boolean, CUBE), releases=True)
def tangents(factors, direction, normal, symmetric, out):  # type: ignore[no-untyped-def]
    """Minus the derivatives (n, 3, 3) of the tractions by the shift, from what ``return_map`` found [N/m3]."""
    for i in range(out.shape[0]):
        for a in range(3):
            for b in range(3):
                slip = direction[i, a] * direction[i, b]
                beside = (1.0 if a == b else 0.0) - normal[i, a] * normal[i, b] - slip
                total = factors[i, 0] * beside + factors[i, 1] * slip
                if not symmetric:
                    total += factors[i, 2] * direction[i, a] * normal[i, b]
                out[i, a, b] = total


class CoulombFriction:
    """Coulomb friction of n points against the other surface.

    coefficient : mu > 0;  stick : (n,) stiffness of sticking points [N/m3]
    symmetric : whether tangents leave the coupling with the pressure out, for solvers of symmetric systems

    committed, place : (n, 3) resistances [Pa] and displacements [m] at the last commit
    dissipated : (n,) energy lost up to the last commit [J/m2]
    """

    def __init__(self, coefficient: float, stick: np.ndarray, symmetric: bool = True) -> None:
        self.coefficient, self.symmetric = float(coefficient), symmetric
        self.stick = np.ascontiguousarray(stick, dtype=float)
        n = len(self.stick)
        self.committed, self.place, self.dissipated = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
        self._trial, self._direction, self._factors = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
        self._place, self._lost = np.zeros((n, 3)), np.zeros(n)

    def evaluate(
        self, displacement: np.ndarray, normal: np.ndarray, pressure: np.ndarray, d_gap: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Traction on the points (n, 3) [Pa] and minus its derivative by ``displacement`` (n, 3, 3) [N/m3].

        displacement : (n, 3) displacement of the points against the other surface [m]
        normal : (n, 3);  pressure : (n,) [Pa];  d_gap : (n,) its derivative by the gap [N/m3]
        """
        self._place = np.array(displacement)
        return_map(
            pressure, d_gap, normal, self._place - self.place, self.committed, self.coefficient, self.stick,
            self._trial, self._direction, self._factors, self._lost,
        )  # fmt: skip
        tangent = np.empty((len(normal), 3, 3))
        tangents(self._factors, self._direction, normal, self.symmetric, tangent)
        return -self._trial, tangent

    @property
    def slipping(self) -> np.ndarray:
        """(n,) whether a point slips at the last place, or is open."""
        return np.asarray(self._factors[:, _ALONG] == 0.0)

    def stored(self) -> np.ndarray:
        """(n,) energy in the sticking springs at the last place [J/m2]."""
        return np.asarray(0.5 * (self._trial**2).sum(axis=1) / self.stick)

    def begin(self, displacement: np.ndarray) -> None:
        """No point carries anything or has lost anything where it is now, displaced by (n, 3) [m]."""
        self.committed, self.place = np.zeros_like(displacement), np.array(displacement)
        self.dissipated = np.zeros(len(displacement))

    def commit(self) -> None:
        """The last place becomes history."""
        self.committed, self.place = self._trial.copy(), self._place.copy()
        self.dissipated = self.dissipated + self._lost

    def state(self) -> dict[str, np.ndarray]:
        """The history as arrays by name."""
        return {
            "friction": self.committed.copy(),
            "friction_place": self.place.copy(),
            "friction_dissipated": self.dissipated.copy(),
        }

    def restore(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Set the history to what ``state`` gave."""
        self.committed, self.place = arrays["friction"].copy(), arrays["friction_place"].copy()
        self.dissipated = arrays["friction_dissipated"].copy()
