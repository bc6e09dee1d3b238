"""What a time integration starts from, is asked for, and leaves behind."""

from collections.abc import Callable, Mapping
from typing import Any, Literal, Protocol

import attrs
import numpy as np
from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import VECTOR
from raceway.core.threads import ThreadPool
from raceway.errors import PluginError
from raceway.storage.tables import Tables

#: Called between chunks with the steps done and the steps in all.
OnChunk = Callable[[int, int], None]
#: On the motion of a similar problem, or else on the first that is not unstable, where several may exist; "unstable": on that motion
#: where it is unstable, too.
Stay = bool | Literal["unstable"]


@attrs.frozen(eq=False)
class Motion:
    """State of the ring and the balls at one time.

    Attributes
    ----------
    q, v, a : (5,) displacement, velocity, acceleration (of generalised-alpha: its own a)
    ball, ball_before : (Z, 2 or 4) positions (and slips) of the balls now and one step earlier [m]
    memory : (2 Z, m) of the contact law; None for a law that remembers nothing yet
    net_force : (5,) internal less outer forces [N, N m]; None where it is -M a: of generalised-alpha it is not, and a run that
        goes on from another's final motion needs it
    full_state : arrays by name, all unknowns and all memory of a system of more than the ring's five coordinates; None for others
    near : the ``solution`` in the record of a similar motion by the same method, for methods that can start from one
    stay : on the motion of ``near`` where several may exist
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    ball_before: np.ndarray
    net_force: np.ndarray | None = None
    memory: np.ndarray | None = None
    full_state: Mapping[str, np.ndarray] | None = None
    near: Any = None
    stay: Stay = False


@attrs.frozen(eq=False)
class Schedule:
    """Times of an integration: ``steps`` steps of ``dt`` [s], every ``stride``-th recorded, from step ``first`` on.

    Attributes
    ----------
    steps_per_turn : int
    turns : int
    ramp : float, the excitation grows smoothly over this time [s]
    first : steps that were taken before: a run that goes on from another's final motion keeps its clock
    """

    dt: float
    steps_per_turn: int
    turns: int
    stride: int = 1
    ramp: float = 0.0
    first: int = 0

    @property
    def steps(self) -> int:
        return self.steps_per_turn * self.turns

    def when(self, step: int) -> str:
        """Where a run stands after so many steps of its own, in words."""
        time, turn = (self.first + step) * self.dt, (self.first + step) // self.steps_per_turn + 1
        return f"after {step} of {self.steps} steps (t = {time:.6g} s, turn {turn})"


@attrs.frozen(eq=False)
class Record:
    """Sampled motion of the inner ring's reference point, with forces.

    Attributes
    ----------
    time : (n,) [s]
    displacement, velocity, force : (n, 5) motion and outer (excitation) force
    gap, contact_force : (n, 2 Z) inner races first [m, N];  ball : (n, Z, 2 or 4) positions and slips [m]
    final : Motion
    counts : dict with steps, evaluations, max_penetration_m, peak_contact_force_n
    energies : name -> (n,) [J], of systems that have them
    solution : what a similar motion by the same method may start from
    """

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    ball: np.ndarray
    final: Motion
    schedule: Schedule
    counts: Tables
    energies: dict[str, np.ndarray] = attrs.field(factory=dict)
    solution: Any = None

    def last(self, turns: int) -> "Record":
        """The part that belongs to the last turns."""
        first = self.schedule.first + self.schedule.steps - turns * self.schedule.steps_per_turn
        keep = slice(int(np.searchsorted(self.time, (first + 0.5 * self.schedule.stride) * self.schedule.dt, "right")), None)
        names = ("time", "displacement", "velocity", "force", "gap", "contact_force", "ball")
        energies = {name: values[keep] for name, values in self.energies.items()}
        return attrs.evolve(self, energies=energies, **{name: getattr(self, name)[keep] for name in names})


@jit(void(int64, int64, float64, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR), releases=True)
def predict(first, last, dt, u, v, a, half, displacement, guess):  # type: ignore[no-untyped-def]
    """Entries ``first`` to ``last - 1`` of the velocity at half a step, the displacement and the guessed velocity at its end.

    u, v, a : (size,) of the step before;  half, displacement, guess : (size,) out
    """
    for i in range(first, last):
        half[i] = v[i] + 0.5 * dt * a[i]
        displacement[i] = u[i] + dt * half[i]
        guess[i] = v[i] + dt * a[i]


@jit(boolean(int64, int64, float64, VECTOR, VECTOR), releases=True)
def finish(first, last, dt, a, v):  # type: ignore[no-untyped-def]
    """The velocity v (size,), at first that at half the step, at its end; whether all accelerations a (size,) are finite."""
    bad = 0
    for i in range(first, last):
        v[i] = v[i] + 0.5 * dt * a[i]
        # Less itself it is zero, or no number.
        bad += 0 if a[i] - a[i] == 0.0 else 1
    return bad == 0


@jit(float64(int64, int64, VECTOR, VECTOR, VECTOR, VECTOR), releases=True)
def work(first, last, outer_before, outer, u_before, u):  # type: ignore[no-untyped-def]
    """Work of the mean outer force over a step, of the entries ``first`` to ``last - 1`` [J]: four sums that do not wait."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    fours = first + (last - first) // 4 * 4
    for i in range(first, fours, 4):
        a += (outer_before[i] + outer[i]) * (u[i] - u_before[i])
        b += (outer_before[i + 1] + outer[i + 1]) * (u[i + 1] - u_before[i + 1])
        c += (outer_before[i + 2] + outer[i + 2]) * (u[i + 2] - u_before[i + 2])
        d += (outer_before[i + 3] + outer[i + 3]) * (u[i + 3] - u_before[i + 3])
    for i in range(fours, last):
        a += (outer_before[i] + outer[i]) * (u[i] - u_before[i])
    return 0.5 * ((a + b) + (c + d))


@jit(void(int64, int64, VECTOR, VECTOR, VECTOR), releases=True)
def divide(first, last, outer, inner, masses):  # type: ignore[no-untyped-def]
    """Accelerations of the entries ``first`` to ``last - 1``, in place of the inner forces: (outer - inner) / masses."""
    for i in range(first, last):
        inner[i] = (outer[i] - inner[i]) / masses[i]


#: What is stored in the system, and what has left it.
STORED, LOST = ("elastic", "kinetic", "contact"), ("friction", "damping")


def drift(energies: Mapping[str, np.ndarray]) -> float | None:
    """Largest change of stored + lost - external work, over the largest of these energies' ranges; None without energies.

    Notes
    -----
    "external" is the work of loads and excitation, summed over all steps with the mean force of each step.
    """
    if "external" not in energies:
        return None
    terms = [energies[name] for name in (*STORED, *LOST) if name in energies]
    total = np.sum(terms, axis=0) - energies["external"]
    size = max([float(np.ptp(term)) for term in (*terms, energies["external"])] + [1e-300])
    return float(np.abs(total - total[0]).max() / size)


def largest_share(energies: Mapping[str, np.ndarray], part: str, total: str) -> float:
    """Largest part over the largest whole, for instance "hourglass" of "elastic"."""
    return float(energies[part].max(initial=0.0) / max(energies[total].max(initial=0.0), 1e-300))


def friction_lost(energies: Mapping[str, np.ndarray]) -> float:
    """What friction took between the first sample and the last [J]."""
    work = energies["friction"]
    return float(work[-1] - work[0]) if len(work) else 0.0


@attrs.define(eq=False)
class State:
    """Unknowns of a system at one time.

    Attributes
    ----------
    u, v, a : (size,) displacement, velocity, acceleration (of generalised-alpha: its own a)
    net_force : (size,) internal less outer forces; of generalised-alpha it is not -M a; None where it is
    """

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    net_force: np.ndarray | None = None

    def copy(self) -> "State":
        return State(self.u.copy(), self.v.copy(), self.a.copy(), None if self.net_force is None else self.net_force.copy())


@attrs.frozen(eq=False)
class Observation:
    """What a ``Record`` keeps of one step."""

    #: displacement, velocity : (5,) of the ring's reference point
    displacement: np.ndarray
    velocity: np.ndarray
    #: gap, contact_force : (2 Z,) inner races first [m, N]
    gap: np.ndarray
    contact_force: np.ndarray
    ball: np.ndarray  # (Z, 2 or 4) positions (and slips) of the balls [m]
    #: name -> [J]; the same names at every step, none where the system has none.  "elastic", "kinetic" and "contact" are
    #: stored (sticking friction's springs in "contact"), "friction" and "damping" lost since the beginning, "hourglass" is a
    #: part of "elastic"; the recorder adds "external", the work of all outer forces
    energies: dict[str, float] = attrs.field(factory=dict)


class StepsAhead(Protocol):
    """``take(recorder, count)``: committed steps after the recorder's last; see ``Recorder.accept_steps``."""

    #: Steps that one call may take, some tenths of a second; what takes them.
    most: int
    device: str

    def take(self, recorder: Any, count: int) -> tuple[State, float, float, float]: ...


class SteppedSystem(Protocol):
    """M a + C v + f(u, v) = load + excitation(t), with C constant and f anything.

    1. ``size``: unknowns, vectors are (size,); ``ball_count``: Z; ``conservative``: forces have a potential; ``smooth``: Newton's
       method begins a step on the parabola through the displacements before, not at constant acceleration: for many modes that
       steps do not resolve, whose accelerations alternate.  Entries of coordinates that are held may be anything in forces; ``solve``
       and ``accelerations`` give zero there.
    2. ``begin(motion)``: the state that a motion stands for, with ``net_force``, and all memory set to it; also for a motion that another run
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
    12. ``explicit(dt, where)``: explicit steps of a system's own, many at a time (``raceway.core.fem.elastic.explicit.ExplicitSteps``), or
        None; ``where`` is "cpu", "gpu", which a ``SceneError`` refuses where no CUDA device can take them, or "auto": one where it can.
    13. ``threads``: a ``ThreadPool``, which is open during a run and shares the passes over long vectors; of one thread where
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
    def explicit(self, dt: float, where: str) -> StepsAhead | None: ...
    def commit(self) -> None: ...
    def rollback(self) -> None: ...
    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation: ...


def check_start(system: Any, start: Motion) -> None:
    """Refuse a motion that is none of a system's; see ``check_state``."""
    parts = {name: getattr(start, name) for name in ("q", "v", "a", "net_force", "ball", "ball_before", "memory")}
    check_state(system, "the motion that an integration starts from", **parts)


def check_state(system: Any, who: str, **arrays: np.ndarray | None) -> None:
    """Refuse arrays that are not a system's; None is left out.

    system : with ``ball_count``, ``ball_columns``, ``load`` and ``law_state``;  who : whose arrays they are, for the message
    arrays : by name: ``q``, ``v``, ``a``, ``net_force`` (5,), ``memory`` as ``law_state``, and any other (Z, columns) of balls

    PluginError: With the array, its shape, and the system's.
    """
    for name, values in arrays.items():
        if name in ("q", "v", "a", "net_force"):
            shape, rows = system.load.shape, "x, y, z, tilts"
        elif name == "memory":
            shape, rows = system.law_state.shape, "a row for each contact"
        else:
            shape, rows = (system.ball_count, system.ball_columns), "a row for each ball"
        if values is not None and np.shape(values) != shape:
            raise PluginError(f"{who}: `{name}` has the shape {np.shape(values)}; that of this system is {shape}: {rows}")


def ramp(t: float, duration: float) -> float:
    """Share of the excitation at time t: 10 s^3 - 15 s^4 + 6 s^5 over the ramp, as in the compiled loops."""
    if t >= duration:
        return 1.0
    s = max(t / duration, 0.0)
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
