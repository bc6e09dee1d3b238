"""All balls between both races: places and contact forces that are in equilibrium, and what the ring feels of them.

Notes
-----
Contacts are numbered as in ``raceway.core.bodies``: inner races first.  A contact sees the ball at

    D_inner = p - e,    D_outer = p,    each plus  W F,

p the ball's centre and e the inner groove centre, both seen from the outer groove centre, F (2 Z, 2) the forces of all
contacts on the balls, and W the compliance between contacts: of a ball from pole to pole, of a ring from ball to ball.  W
acts on resultants: far from a contact the field of its pressure is that of its resultant.  With K the contacts' own
stiffness, S = (1 + K W)^-1 K is what they show together; the balls' balance F_inner + F_outer + F_c = 0 then is a system
in p alone.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.condensed.contact import Contact, Pressed
from raceway.errors import ConvergenceError

_LIMIT = 60
#: Share of the regularisation that gives an unloaded ball a stiffness, of the largest one.
_IDLE = 1e-12


@attrs.frozen(eq=False)
class Linear:
    """The balls linearised at one state.

    Attributes
    ----------
    pressed : (2 Z) answers of the contacts
    force : (2 Z, 2) forces on the balls that are carried on [N];  rest : (2 Z, 2) what the contacts give beyond them
    shown : (4 Z, 4 Z) S [N/m];  held : (2 Z, 2 Z) the balls' own stiffness H = P^T S P
    balance : (2 Z,) forces on the balls, contact forces at W F included to first order [N]
    """

    pressed: list[Pressed]
    force: np.ndarray
    rest: np.ndarray
    carried: np.ndarray
    shown: np.ndarray
    held: np.ndarray
    balance: np.ndarray


class Balls:
    """Balls of all rows with their contacts.

    Parameters
    ----------
    contacts : 2 Z contacts, inner races first
    coupling : (4 Z, 4 Z) W [m/N], symmetric
    loads : (Z, 2) forces on the balls themselves, axial and radial [N]: centrifugal
    step : largest step of a ball in an iteration [m]
    """

    def __init__(self, contacts: list[Contact], coupling: np.ndarray, loads: np.ndarray, step: float) -> None:
        self.contacts, self.coupling, self.loads, self.step = contacts, coupling, loads, step
        self.count = len(contacts) // 2
        n = 2 * self.count
        self._both = np.concatenate([np.eye(n), np.eye(n)])  # P: both contacts follow the ball
        self._inner = np.concatenate([np.eye(n), np.zeros((n, n))])  # E: the inner one follows the ring
        self._ones = np.eye(2 * n)
        self.evaluations = 0

    def linear(self, centre: np.ndarray, place: np.ndarray, force: np.ndarray, rate: np.ndarray) -> Linear:
        """Press all contacts.

        Parameters
        ----------
        centre, place : (Z, 2) e and p [m];  force : (2 Z, 2) F [N];  rate : (2 Z, 2) velocities of D [m/s]
        """
        moved = (self.coupling @ force.reshape(-1)).reshape(-1, 2)
        seen = np.concatenate([place - centre, place]) + moved
        pressed = [contact.press(d, r) for contact, d, r in zip(self.contacts, seen, rate, strict=True)]
        self.evaluations += 1
        answer = np.array([one.force for one in pressed])
        rest = (answer - force).reshape(-1)
        shown, held, carried = self._together([one.stiffness for one in pressed], rest)
        balance = self._both.T @ (force.reshape(-1) + carried) + self.loads.reshape(-1)
        return Linear(pressed, force, rest.reshape(-1, 2), carried, shown, held, balance)

    def without_ripple(self, now: Linear, centre: np.ndarray, place: np.ndarray) -> Linear:
        """The same state with the mean stiffness of every contact, see ``Contact.mean_stiffness``."""
        moved = (self.coupling @ now.force.reshape(-1)).reshape(-1, 2)
        seen = np.concatenate([place - centre, place]) + moved
        stiffness = [contact.mean_stiffness(d) for contact, d in zip(self.contacts, seen, strict=True)]
        shown, held, carried = self._together(stiffness, now.rest.reshape(-1))
        return attrs.evolve(now, shown=shown, held=held, carried=carried)

    def _together(self, stiffness: list[np.ndarray], rest: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """S, H and (1 + K W)^-1 rest, for the stiffness (2, 2) of every contact."""
        stiff = np.zeros_like(self.coupling)
        for k, one in enumerate(stiffness):
            stiff[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = one
        both = np.linalg.solve(self._ones + stiff @ self.coupling, np.column_stack([stiff, rest]))
        shown = 0.5 * (both[:, :-1] + both[:, :-1].T)
        held = self._both.T @ shown @ self._both
        held += _IDLE * max(np.abs(held).max(), 1.0) * np.eye(len(held))
        return shown, held, both[:, -1]

    def follow(self, now: Linear) -> np.ndarray:
        """(2 Z, 2 Z) motion of the balls that follows a motion of the inner groove centres."""
        return np.linalg.solve(now.held, self._both.T @ now.shown @ self._inner)

    def tangent(self, now: Linear) -> np.ndarray:
        """(2 Z, 2 Z) stiffness against motions of the inner groove centres."""
        carried = self._both.T @ now.shown @ self._inner
        return self._inner.T @ now.shown @ self._inner - carried.T @ np.linalg.solve(now.held, carried)

    def slip(self, now: Linear) -> np.ndarray:
        """(4 Z, 2 Z) change of D that a motion of the inner groove centres brings, the balls following."""
        return self._both @ self.follow(now) - self._inner

    def carried(self, now: Linear) -> np.ndarray:
        """(2 Z,) forces of the inner races on the balls that equilibrium of the balls will bring, to first order."""
        lost = self._inner.T @ now.shown @ self._both @ np.linalg.solve(now.held, now.balance)
        return (now.force.reshape(-1) + now.carried)[: 2 * self.count] - lost

    def move(self, now: Linear, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Steps of places (Z, 2) and forces (2 Z, 2) when the inner groove centres move by (2 Z,), by Newton."""
        driven = self._both.T @ now.shown @ self._inner @ moved
        step = np.linalg.solve(now.held, now.balance + driven)
        force = now.carried - now.shown @ (self._both @ step - self._inner @ moved)
        return step.reshape(-1, 2), force.reshape(-1, 2)

    def residual(self, now: Linear) -> float:
        """Largest force out of balance of any ball or contact [N]."""
        return float(max(np.abs(now.balance).max(), np.abs(now.rest).max()))

    def settle(
        self, centre: np.ndarray, place: np.ndarray, force: np.ndarray, rate: np.ndarray, tolerance: float
    ) -> tuple[np.ndarray, np.ndarray, Linear]:
        """Equilibrium of the balls while the ring stands: places, forces and the state there.

        Raises
        ------
        ConvergenceError
        """
        still = np.zeros(2 * self.count)
        now = self.linear(centre, place, force, rate)
        for _ in range(_LIMIT):
            size = self.residual(now)
            scale = max(np.abs(now.force).max(), np.abs(self.loads).max(), 1.0)
            if size <= tolerance * scale:
                return place, force, now
            step, change = self.move(now, still)
            part = min(1.0, self.step / max(np.abs(step).max(), 1e-300))
            for _ in range(8):
                other = self.linear(centre, place + part * step, force + part * change, rate)
                if self.residual(other) < (1.0 - 0.1 * part) * size or part < 0.02:
                    break
                part *= 0.4
            place, force, now = place + part * step, force + part * change, other
            if self.residual(now) >= size and size <= 1e3 * tolerance * scale:
                return place, force, now
        raise ConvergenceError(
            "the balls find no equilibrium between the races", {"place": place, "residual": self.residual(now)}
        )
