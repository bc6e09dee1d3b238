"""Takes the steps of a motion into its record: samples, energies, extremes; stops what grows without bound."""

import time
from typing import Any

import numpy as np
from numba import boolean, float64, int64

from raceway.core.jit import jit
from raceway.core.record import Observation, OnChunk, Record, Schedule, State, SteppedSystem, ramp, work
from raceway.core.signatures import VECTOR
from raceway.errors import ConvergenceError, RacewayError, StabilityError

#: Largest displacement [m] or rotation [rad] that is still a motion of a bearing.
BOUND = 1.0

#: Entries of vectors that are summed together: of long ones by one thread at a time, always the same.
_BLOCK = 16384

#: Seconds between two reports of progress.
_REPORT_S = 0.1


def unbounded(schedule: Schedule, when: str, limit: float, state: dict[str, Any]) -> StabilityError:
    """The error for a motion that grows without bound, with the stable limit of explicit steps [s] where one is known."""
    hint = f"; stable limit of explicit steps there {limit:.3g} s" if 0.0 < limit < float("inf") else ""
    words = f"the motion grew without bound {when}, step {schedule.dt:.3g} s{hint}. Use more `integrator.steps_per_turn`, add damping, or move away from a resonance."
    return StabilityError(words, state)


class Recorder:
    """Follows one integration.

    system, schedule : what is integrated, over which times
    on_chunk : called with the steps done and the steps in all

    state : the last accepted ``State``;  device : that takes the steps
    evaluations : of the internal forces, all steps together
    """

    def __init__(self, system: SteppedSystem, state: State, schedule: Schedule, on_chunk: OnChunk | None) -> None:
        self.system, self.state, self.schedule, self.evaluations = system, state, schedule, 0
        self._on_chunk, self._reported = on_chunk, time.perf_counter()
        self.done, self.device = 0, "cpu"
        self._rows: list[tuple[float, Observation]] = []
        self._penetration = self._peak = self._work = 0.0
        self._outer = self.load(self.time_of(0))

    def time_of(self, step: int) -> float:
        """Time [s] at the end of a step, counted from 1."""
        return (self.schedule.first + step) * self.schedule.dt

    def load(self, t: float) -> np.ndarray:
        """(size,) constant load and excitation under the ramp."""
        return self.system.external(t, ramp(t, self.schedule.ramp))

    def accept(self, state: State, velocity: np.ndarray | None = None, outer: np.ndarray | None = None) -> None:
        """Commit a step, keep it in the record where its turn is, and report progress.

        velocity : (size,) what the record shows; None for ``state.v``
        outer : (size,) what ``load`` gave for the step's end, where the loop has it still

        StabilityError: A displacement or rotation that no bearing makes, or that is no number.
        """
        outer = self.load(self.time_of(self.done + 1)) if outer is None else outer
        system = self.system
        self._work += self._outer_work(state, outer)
        self._outer = outer
        penetration, peak, _ = system.contacts()
        self._penetration, self._peak = max(self._penetration, penetration), max(self._peak, peak)
        try:
            system.commit()
        except ConvergenceError as why:
            raise ConvergenceError(f"{why} It was {self.schedule.when(self.done)}.", self._last_good()) from why
        self._take(state, velocity)

    def accept_steps(self, count: int, state: State, work: float, penetration: float, peak: float) -> None:
        """As ``accept``, of steps that are committed: their outer work [J], greatest penetration [m] and contact force [N]."""
        self._work += work
        self._penetration, self._peak = max(self._penetration, penetration), max(self._peak, peak)
        self._take(state, None, count)

    def _take(self, state: State, velocity: np.ndarray | None, count: int = 1) -> None:
        system, schedule = self.system, self.schedule
        self.state = state
        self.done += count
        if (schedule.first + self.done) % schedule.stride == 0:
            t = self.time_of(self.done)
            observation = system.observe(state.u, state.v if velocity is None else velocity)
            if observation.energies:
                observation.energies["external"] = self._work
            self._rows.append((t, observation))
        now = time.perf_counter()
        if self._on_chunk is not None and (now - self._reported > _REPORT_S or self.done == schedule.steps):
            self._reported = now
            try:
                self._on_chunk(self.done, schedule.steps)
            except RacewayError as why:
                why.state = {**self._last_good(), **why.state}
                raise

    def record(self) -> Record:
        """The complete ``Record``."""
        times = np.array([t for t, _ in self._rows])
        observations = [observation for _, observation in self._rows]
        z = self.system.ball_count

        def stack(name: str, shape: tuple[int, ...]) -> np.ndarray:
            rows = [getattr(each, name) for each in observations]
            return np.array(rows) if rows else np.zeros((0, *shape))

        first: Observation | None = observations[0] if observations else None
        return Record(
            time=times,
            displacement=stack("displacement", (5,)),
            velocity=stack("velocity", (5,)),
            force=np.array([ramp(t, self.schedule.ramp) * self.system.outer_force(t) for t in times]).reshape(-1, 5),
            gap=stack("gap", (2 * z,)),
            contact_force=stack("contact_force", (2 * z,)),
            ball=stack("ball", (z, 2)),
            final=self.system.motion(self.state),
            schedule=self.schedule,
            counts={
                "steps": self.schedule.steps,
                "evaluations": self.evaluations,
                "threads": self.system.threads.count,
                "device": self.device,
                "max_penetration_m": self._penetration,
                "peak_contact_force_n": self._peak,
            },
            energies={
                name: np.array([observation.energies[name] for observation in observations])
                for name in (first.energies if first else ())
            },
        )

    def _outer_work(self, state: State, outer: np.ndarray) -> float:
        """Work of the mean outer forces over a step [J]; StabilityError: displacement beyond ``BOUND`` or not finite."""
        size = len(state.u)
        count = -(-size // _BLOCK)
        arrays = [np.ascontiguousarray(each, dtype=float) for each in (self._outer, outer, self.state.u, state.u)]
        works, fine = np.empty(count), np.empty(count, dtype=bool)

        def block_work(number: int) -> None:
            part = _BLOCK * number, min(_BLOCK * (number + 1), size)
            fine[number] = _within_bound(*part, BOUND, arrays[-1])
            works[number] = work(*part, *arrays)

        self.system.threads.do(count, block_work)
        if not fine.all():
            raise self.unbounded()
        return float(works.sum())

    def unbounded(self) -> StabilityError:
        """The error for a motion that grows without bound."""
        try:
            limit = self.system.stable_step()
        except ConvergenceError:
            limit = float("inf")
        return unbounded(self.schedule, self.schedule.when(self.done), limit, self._last_good())

    def stalled(self, residuals: list[float], why: str = "the iteration of a step did not converge") -> ConvergenceError:
        """The error for a step that found no balance, with the residuals [N] of its iterations."""
        tail = ("..., " if len(residuals) > 6 else "") + ", ".join(f"{r:.2g}" for r in residuals[-6:])
        history = f" (residuals of {len(residuals)} iterations: {tail} N)" if residuals else ""
        words = f"{why} {self.schedule.when(self.done)}{history}. Use more `integrator.steps_per_turn`."
        return ConvergenceError(words, {**self._last_good(), "residuals": np.array(residuals)})

    def _last_good(self) -> dict[str, np.ndarray]:
        self.system.rollback()
        motion = self.system.motion(self.state)
        state = {"t": np.array(self.time_of(self.done)), "q": motion.q, "v": motion.v, "a": motion.a, "ball": motion.ball}
        return state | dict(motion.full_state or {})


@jit(boolean(int64, int64, float64, VECTOR), releases=True)
def _within_bound(first, last, bound, u):  # type: ignore[no-untyped-def]
    """Whether the entries ``first`` to ``last - 1`` are numbers below the bound in size."""
    beyond = 0
    for i in range(first, last):
        beyond += 0 if abs(u[i]) < bound else 1
    return beyond == 0
