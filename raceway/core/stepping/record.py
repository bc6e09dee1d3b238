"""What a time integration starts from, is asked for, and leaves behind."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import attrs
import numpy as np

from raceway.storage.tables import Tables

#: Called between chunks with the steps done and the steps in all.
OnChunk = Callable[[int, int], None]


@attrs.frozen(eq=False)
class Motion:
    """State of the ring and the balls at one time.

    Attributes
    ----------
    q, v, a : (5,) displacement, velocity, acceleration (of generalised-alpha: its own a)
    ball, ball_before : (Z, 2 or 4) positions (and slips) of the balls now and one step earlier [m]
    memory : (2 Z, m) of the contact law; None for a law that remembers nothing yet
    rest : (5,) internal less outer forces [N, N m]; None where it is -M a: of generalised-alpha it is not, and a run that
        goes on from another's final motion needs it
    whole : arrays by name, all unknowns and all memory of a system of more than the ring's five coordinates; None for others
    near : the ``solution`` in the record of a similar motion by the same method, for methods that can start from one
    stay : whether to stay on the motion of ``near`` where several may exist
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    ball: np.ndarray
    ball_before: np.ndarray
    rest: np.ndarray | None = None
    memory: np.ndarray | None = None
    whole: Mapping[str, np.ndarray] | None = None
    near: Any = None
    stay: bool = False


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
    energies : name -> (n,) [J], of systems that tell them
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

    def last(self, turns: int) -> Record:
        """The part that belongs to the last turns."""
        first = self.schedule.first + self.schedule.steps - turns * self.schedule.steps_per_turn
        keep = self.time > (first + 0.5 * self.schedule.stride) * self.schedule.dt
        names = ("time", "displacement", "velocity", "force", "gap", "contact_force", "ball")
        energies = {name: values[keep] for name, values in self.energies.items()}
        return attrs.evolve(self, energies=energies, **{name: getattr(self, name)[keep] for name in names})
