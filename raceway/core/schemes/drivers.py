"""What a scheme is made of, and which part of it takes the steps of a system."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import attrs

from raceway.errors import PluginError

if TYPE_CHECKING:
    from raceway.core.ring.ring import Ring
    from raceway.core.ring.system import System
    from raceway.core.stepping.protocol import SteppedSystem
    from raceway.core.stepping.record import Motion, OnChunk, Record, Schedule
    from raceway.core.stepping.recorder import Recorder

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
    integrator: Any,
    system: Ring | SteppedSystem,
    start: Motion,
    schedule: Schedule,
    on_chunk: OnChunk | None = None,
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
    from raceway.core.ring.surrogate import compiled
    from raceway.core.stepping.recorder import Recorder

    scheme: Scheme = integrator.scheme
    ring = compiled(system) if isinstance(system, Ring) else None
    if ring is not None and scheme.compiled is not None:
        return scheme.compiled(ring, start, schedule, on_chunk)
    if scheme.stepped is None:
        name = getattr(integrator, "name", type(integrator).__name__)
        raise PluginError(
            f"integrator '{name}' has no driver `{missing_driver(scheme, ring is not None)}`, which these bodies need"
        )
    stepper: SteppedSystem = system.stepped() if isinstance(system, Ring) else system
    with stepper.threads:
        recorder = Recorder(stepper, stepper.begin(start), schedule, on_chunk)
        scheme.stepped(stepper, recorder)
        return recorder.record()
