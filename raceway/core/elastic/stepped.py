"""Elastic bodies in nodal contact, stepped in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.stepping.protocol import Observation, State
from raceway.core.stepping.record import Motion
from raceway.core.stepping.vectors import divide

if TYPE_CHECKING:
    from raceway.core.elastic.system import ElasticSystem

#: Names of the unknowns in ``Motion.whole``.
_UNKNOWNS = ("u", "v", "a", "rest")
#: What ``Seen`` gives: ring displacement, velocity (5,), gaps, contact forces (2 Z,), ball places (Z, 2).
Seen = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class SteppedElastic:
    """``SteppedSystem`` around an ``ElasticSystem``.

    Parameters
    ----------
    system : ElasticSystem
    look : function of (system, y, v), optional
        What a record keeps; None: smallest gap and normal force of every pair, no ring.
    ball_count : int
        Half the number of contact forces that ``look`` gives.
    """

    def __init__(
        self,
        system: ElasticSystem,
        look: Callable[[ElasticSystem, np.ndarray, np.ndarray], Seen] | None = None,
        ball_count: int = 0,
    ):
        self.system, self._look = system, look
        contact = system.contact
        self.ball_count = ball_count
        self.conservative = contact is None or contact.friction is None
        self.smooth = system.condensed is not None
        self.size: int = system.size
        self.threads = system.assembly.threads
        if look is None and contact is not None:
            self.ball_count = (len(contact.counts) + 1) // 2

    def begin(self, motion: Motion) -> State:
        whole = dict(motion.whole or {})
        contact = self.system.contact
        if contact is not None and "projected" in whole:
            contact.restore(whole["projected"], whole["memory"])
            if contact.friction is not None:
                contact.friction.restore(whole)
        return State(*(np.array(whole[name]) for name in _UNKNOWNS))

    def motion(self, state: State) -> Motion:
        s, contact = state.copy(), self.system.contact
        rest = -self.mass_times(s.a) if s.rest is None else s.rest
        whole = dict(zip(_UNKNOWNS, (s.u, s.v, s.a, rest), strict=True))
        if contact is not None:
            whole |= {"projected": contact.projected.copy(), "memory": contact.memory.copy()}
            if contact.friction is not None:
                whole |= contact.friction.state()
        q, v, _, _, ball = self._seen(s.u, s.v)
        a = self._seen(s.u, s.a)[1]
        return Motion(q, v, a, ball, ball.copy(), whole=whole)

    def motion_of(self, y: np.ndarray, v: np.ndarray, a: np.ndarray) -> Motion:
        """A motion with unknowns, velocities and accelerations (size,) whose forces balance."""
        return self.motion(State(y, v, a, -self.mass_times(a)))

    def moving(self, velocity: np.ndarray) -> Motion:
        """Nothing displaced, nodes moving with (nodes, 3) [m/s]: the start of an impact."""
        a = self.system.assembly
        zero = np.zeros(self.size)
        v = np.concatenate([np.zeros(a.frame_size), velocity.reshape(-1)[a.free]])
        still = np.zeros((self.ball_count, 2))
        whole = {"u": zero, "v": v, "a": zero.copy(), "rest": zero.copy()}
        return Motion(np.zeros(5), np.zeros(5), np.zeros(5), still, still.copy(), whole=whole)

    def outer_force(self, t: float) -> np.ndarray:
        out = np.zeros(5)
        force = self.system.outer_force(t)[:5]
        out[: len(force)] = force
        return out

    def external(self, t: float, scale: float) -> np.ndarray:
        load, force = self.system.load, self.system.outer_force(t)
        out = np.empty(self.size)
        self.threads.do_shares(self.size, lambda first, last: np.copyto(out[first:last], load[first:last]))
        out[: len(force)] += scale * force
        return out

    def internal(self, t: float, dt: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.asarray(self.system.internal(t, dt, u, v))

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray) -> np.ndarray:
        return np.asarray(self.system.increment(c_k, c_c, c_m, right))

    def mass_times(self, a: np.ndarray) -> np.ndarray:
        return np.asarray(self.system.mass_times(a))

    def accelerations(self, outer: np.ndarray, inner: np.ndarray, a: np.ndarray, c: float) -> np.ndarray:
        """In place of ``inner``: masses of nodes are lumped, those of the frames a small matrix."""
        assembly = self.system.assembly
        m, free = assembly.frame_size, assembly.frame_free
        frame = np.zeros(m)
        if free.any():
            rest = outer[:m] - inner[:m] + c * (assembly.frame_damping @ a[:m])
            frame[free] = np.linalg.solve((assembly.frame_mass + c * assembly.frame_damping)[np.ix_(free, free)], rest[free])
        masses, outside, inside = assembly.free_mass, outer[m:], inner[m:]
        self.threads.do_shares(len(masses), lambda first, last: divide(first, last, outside, inside, masses))
        inner[:m] = frame
        return inner

    def measure(self, r: np.ndarray) -> float:
        return float(self.system.measure(r))

    def contacts(self) -> tuple[float, float, float]:
        depth, peak, total = self.system.contacts()
        return depth, peak, total

    def stable_step(self) -> float:
        return float(self.system.stable_step())

    def stiffened(self) -> bool:
        return bool(self.system.stiffened())

    def commit(self) -> None:
        self.system.commit()

    def rollback(self) -> None:
        self.system.rollback()

    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation:
        q, speed, gap, force, ball = self._seen(u, v)
        return Observation(q, speed, gap, force, ball, self.system.energies(u, v))

    def _seen(self, u: np.ndarray, v: np.ndarray) -> Seen:
        if self._look is not None:
            return self._look(self.system, u, v)
        contact, z = self.system.contact, self.ball_count
        gap, force = np.zeros(2 * z), np.zeros(2 * z)
        if contact is not None:
            n = len(contact.counts)
            gap[:n] = contact.deepest()
            force[:n] = np.linalg.norm(contact.resultants(), axis=1)
        return np.zeros(5), np.zeros(5), gap, force, np.zeros((z, 2))
