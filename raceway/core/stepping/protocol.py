"""What a system that is stepped from Python must do."""

from __future__ import annotations

from typing import Protocol

import attrs
import numpy as np

from raceway.core.stepping.record import Motion
from raceway.core.threads import ThreadPool


@attrs.define(eq=False)
class State:
    """Unknowns of a system at one time.

    Attributes
    ----------
    u, v, a : (size,) displacement, velocity, acceleration (of generalised-alpha: its own a)
    rest : (size,) internal less outer forces; of generalised-alpha it is not -M a; None where it is
    """

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    rest: np.ndarray | None = None

    def copy(self) -> State:
        return State(self.u.copy(), self.v.copy(), self.a.copy(), None if self.rest is None else self.rest.copy())


@attrs.frozen(eq=False)
class Observation:
    """What a ``Record`` keeps of one step.

    Attributes
    ----------
    displacement, velocity : (5,) of the ring's reference point
    gap, contact_force : (2 Z,) inner races first [m, N]
    ball : (Z, 2 or 4) positions (and slips) of the balls [m]
    energies : name -> [J]; the same names at every step, none where the system does not tell.  "elastic", "kinetic" and
        "contact" are stored (sticking friction's springs in "contact"), "friction" and "damping" lost since the beginning,
        "hourglass" is a part of "elastic"; the recorder adds "external", the work of all outer forces
    """

    displacement: np.ndarray
    velocity: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    ball: np.ndarray
    energies: dict[str, float] = attrs.field(factory=dict)


class SteppedSystem(Protocol):
    """M a + C v + f(u, v) = load + excitation(t), with C constant and f anything.

    1. ``size``: unknowns, vectors are (size,); ``ball_count``: Z; ``conservative``: forces have a potential; ``smooth``: Newton's
       method begins a step on the parabola through the displacements before, not at constant acceleration: for many modes that
       steps do not resolve, whose accelerations alternate.  Entries of coordinates that are held may be anything in forces; ``solve``
       and ``accelerations`` give zero there.
    2. ``begin(motion)``: the state that a motion stands for, with ``rest``, and all memory set to it; also for a motion that another run
       of the same system ended with, of which nothing may be lost.  ``motion(state)``: the way back, after ``commit``.
    3. ``outer_force(t)``: the excitation (5,) on the ring; ``external(t, scale)``: (size,) constant load + scale * excitation.
    4. ``internal(t, dt, u, v)``: C v + f(u, v) after a step dt from the committed memory; keeps its linearisation and its
       trial memory (contact, friction, balls) until the next call.  dt = 0: nothing moves, no rates and no inertia of
       what is condensed, v is zero.
    5. ``solve(c_k, c_c, c_m, right)``: (c_k K + c_c C + c_m M)^-1 right, K and C those of the last ``internal``.
    6. ``mass_times(a)``; ``accelerations(outer, inner, a, c)``: (M + c C)^-1 (outer - inner + c C a) with the constant C;
       the array ``inner`` may become the answer.
    7. ``measure(r)``: size of a force vector [N] in a norm of the system's own, held coordinates left out.
    8. ``contacts()``: greatest penetration [m], greatest contact force [N] and the sum of all [N], at the last ``internal``.
    9. ``stable_step()``: limit of explicit steps [s] at the last ``internal``.  ``stiffened()``: whether a contact has closed or
       become stiffer there than at any ``stable_step()`` before, so that another one may be shorter; asked at every explicit
       step, and cheap therefore.
    10. ``commit()``: the trial memory of the last ``internal`` becomes the committed one; ``rollback()``: it is forgotten.
    11. ``observe(u, v)``: what a record keeps of the step that was just committed; computes no forces anew.
    12. ``threads``: a ``ThreadPool``, which is open during a run and shares the passes over long vectors; of one thread where
        vectors are short.  Results do not depend on how many there are.

    All arrays that are handed out belong to the caller.
    """

    @property
    def size(self) -> int: ...
    @property
    def ball_count(self) -> int: ...
    @property
    def conservative(self) -> bool: ...
    @property
    def smooth(self) -> bool: ...
    @property
    def threads(self) -> ThreadPool: ...
    def begin(self, motion: Motion) -> State: ...
    def motion(self, state: State) -> Motion: ...
    def outer_force(self, t: float) -> np.ndarray: ...
    def external(self, t: float, scale: float) -> np.ndarray: ...
    def internal(self, t: float, dt: float, u: np.ndarray, v: np.ndarray) -> np.ndarray: ...
    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray) -> np.ndarray: ...
    def mass_times(self, a: np.ndarray) -> np.ndarray: ...
    def accelerations(self, outer: np.ndarray, inner: np.ndarray, a: np.ndarray, c: float) -> np.ndarray: ...
    def measure(self, r: np.ndarray) -> float: ...
    def contacts(self) -> tuple[float, float, float]: ...
    def stable_step(self) -> float: ...
    def stiffened(self) -> bool: ...
    def commit(self) -> None: ...
    def rollback(self) -> None: ...
    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation: ...
