"""What a scheme is made of, and which part of it takes the steps of a system.  Nothing compiled is imported before steps are taken."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import attrs

from raceway.errors import PluginError

if TYPE_CHECKING:
    from raceway.core.record import Motion, OnChunk, Record, Schedule, SteppedSystem
    from raceway.core.recorder import Recorder
    from raceway.core.ring.ring import Ring
    from raceway.core.ring.system import System

    #: Takes all steps of a compiled ring.
    Compiled = Callable[[System, Motion, Schedule, OnChunk | None], Record]
    #: Takes all steps of the recorder's schedule, each handed to ``recorder.accept``.
    Stepped = Callable[[SteppedSystem, Recorder], None]


class Scheme(Protocol):
    """The drivers of an integrator: at least one of them is no None.

    ``compiled`` is quick, and serves bearings whose forces are compiled; ``stepped`` serves all.
    """

    @property
    def compiled(self) -> Compiled | None: ...
    @property
    def stepped(self) -> Stepped | None: ...


@attrs.frozen
class Drivers:
    """A scheme of drivers of one's own."""

    compiled: Compiled | None = None
    stepped: Stepped | None = None


def missing_driver(scheme: Scheme, compiled: bool) -> str:
    """Name of the driver that steps of a bearing with compiled forces, or of another one, lack; empty where one is there."""
    if scheme.stepped is not None or (compiled and scheme.compiled is not None):
        return ""
    return "compiled or stepped" if compiled else "stepped"


def integrate(
    integrator: Any, system: Ring | SteppedSystem, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None
) -> Record:
    """Take all steps of a schedule by the driver that the system asks for.

    Parameters
    ----------
    integrator : its ``scheme`` is used
    system : a ring of five coordinates, or a ``SteppedSystem``

    Raises
    ------
    ConvergenceError, StabilityError
        With the reason, the time and the last good motion in ``state``.
    PluginError
        A scheme without the driver, which a plan refuses before.
    """
    from raceway.core.ring.ring import Ring
    from raceway.core.ring.system import compiled

    scheme: Scheme = integrator.scheme
    ring = compiled(system) if isinstance(system, Ring) else None
    if ring is not None and scheme.compiled is not None:
        return scheme.compiled(ring, start, schedule, on_chunk)
    if scheme.stepped is None:
        name = getattr(integrator, "name", type(integrator).__name__)
        why = f"integrator '{name}' has no driver `{missing_driver(scheme, ring is not None)}`, which these bodies need"
        raise PluginError(why)
    from raceway.core.recorder import Recorder
    from raceway.core.ring.stepped import SteppedBearing

    stepper: SteppedSystem = (system.stepped() or SteppedBearing(system)) if isinstance(system, Ring) else system
    with stepper.threads:
        recorder = Recorder(stepper, stepper.begin(start), schedule, on_chunk)
        scheme.stepped(stepper, recorder)
        return recorder.record()


@attrs.frozen
class Explicit:
    """Equations in ``raceway.core.time``; ``device``: "cpu", "gpu", or "auto": a CUDA device where it can take the steps."""

    device: str = "cpu"

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Steps of a compiled ring."""
        import numpy as np

        from raceway.core.time.advance import advance
        from raceway.core.time.compiled import central_difference

        return advance(central_difference, system, start, schedule, np.zeros(1), on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Steps of any system, without matrices."""
        from raceway.core.time.stepped import central_difference

        central_difference(system, recorder, self.device)


@attrs.frozen
class OneStep:
    """Equations in ``raceway.core.time``.

    alpha_m, alpha_f : weights of the old step's inertia and other forces;  beta, gamma : Newmark's
    tolerance : residual of a step's iteration over the largest force of excitation and inertia
    """

    alpha_m: float = 0.0
    alpha_f: float = 0.0
    beta: float = 0.25
    gamma: float = 0.5
    tolerance: float = 1e-9

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Steps of a compiled ring."""
        import numpy as np

        from raceway.core.record import check_start
        from raceway.core.time.advance import advance
        from raceway.core.time.compiled import implicit

        check_start(system, start)
        rounding = system.force_rounding(start.q, start.ball)
        numbers = np.array([self.alpha_m, self.alpha_f, self.beta, self.gamma, self.tolerance, rounding])
        return advance(implicit, system, start, schedule, numbers, on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Steps of any system."""
        from raceway.core.time.stepped import implicit

        implicit(system, recorder, (self.alpha_m, self.alpha_f, self.beta, self.gamma), self.tolerance)


@attrs.frozen
class Static:
    """Equations in ``raceway.core.time``; ``tolerance``: residual of an equilibrium over the sum of forces."""

    tolerance: float = 1e-11

    def compiled(self, system: System, start: Motion, schedule: Schedule, on_chunk: OnChunk | None = None) -> Record:
        """Equilibria of a compiled ring."""
        import numpy as np

        from raceway.core.time.advance import advance
        from raceway.core.time.compiled import quasi_static

        if system.conservative:
            from raceway.core.ring.equilibrium import solve_equilibrium as solver
        else:
            from raceway.core.ring.equilibrium import find_root as solver
        return advance(quasi_static(solver), system, start, schedule, np.array([self.tolerance]), on_chunk)

    def stepped(self, system: SteppedSystem, recorder: Recorder) -> None:
        """Equilibria of any system."""
        from raceway.core.time.stepped import quasi_static

        quasi_static(system, recorder, self.tolerance)
