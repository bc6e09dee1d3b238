"""Forces on the ring from the energy stored in contacts and bodies: a second way to the same numbers."""

from __future__ import annotations

import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.contact.damping import stored_energy
from raceway.core.ring.energy import energy_balance
from raceway.core.ring.start import at_rest
from raceway.core.ring.surrogate import surrogate
from raceway.core.ring.system import System
from raceway.core.stepping.record import Record, Schedule

#: Step of the difference over the deepest penetration: its error is the square of that.
_PART = 1e-3


def axial_force(model: Model, found: Equilibrium) -> float:
    """Slope [N] of the stored energy along the ring's axial displacement, in equilibrium; for conservative forces.

    Notes
    -----
    Balls are in equilibrium themselves, so that what follows of them does not count.  Unlike a sum over the balls' loads it
    holds what a compliance that varies with the contact angle pushes along the groove.
    """
    system, axis = surrogate(model.system), np.eye(5)[0]
    step = _PART * float(np.max(-system.evaluate(found.displacement, ball=found.ball).gap))
    places = [found.displacement + sign * step * axis for sign in (-1.0, 1.0)]
    states = [system.evaluate(place, ball=found.ball) for place in places]
    gap, force, ball = (np.array([getattr(one, name) for one in states]) for name in ("gap", "contact_force", "ball"))
    still = np.zeros((2, 5))
    final = at_rest(system, places[1], ball[1], False)
    record = Record(np.array([0.0, 1.0]), np.array(places), still, still, gap, force, ball, final, Schedule(1.0, 2, 1), {})
    stored = energy_balance(system, record).stored
    # Contacts by the law's force between both gaps: over the whole approach a law with a short transition at first touch, such
    # as a roughness, is integrated to 1e-5 only, which the small difference of two energies magnifies.
    change = stored[1] - stored[0] - float(np.diff(_from_first_touch(system, gap)).item()) + _between(system, gap)
    # The stored energy counts the load's potential, too, whose slope is the load.
    return float(system.load[0] + change / (2.0 * step))


def _from_first_touch(system: System, gap: np.ndarray) -> np.ndarray:
    """(2,) energy [J] of all contacts, as ``energy_balance`` integrates it, at gaps (2, n)."""
    found, scratch = np.empty(gap.shape), np.empty((6, gap.shape[1]))
    for one, out in zip(gap, found, strict=True):
        stored_energy(system.law, system.law_params, system.law_state, system.law_state.copy(), one, scratch, out)
    return np.asarray(found.sum(axis=1))


def _between(system: System, gap: np.ndarray) -> float:
    """What all contacts store [J] from the first of two gaps (2, n) to the second."""
    (first, last), n = gap, gap.shape[1]
    total = 0.0
    for at, weight in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        force, slopes = np.empty(n), np.empty((2, n))
        here = first + 0.5 * (1.0 + at) * (last - first)
        system.law(here, np.zeros(n), system.law_params, system.law_state, system.law_state.copy(), 0.0, force, *slopes)
        total -= 0.5 * weight * float((force * (last - first)).sum())
    return total
