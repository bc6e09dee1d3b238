"""Files of one run, and what they see of it.

pictures   orbit, spectrum, ball loads
labelled   arrays with names, coordinates and units
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.core.record import Record
    from raceway.core.signals import Identification


class RecordedMotion(Protocol):
    """The motion of a run: ``whole``, and ``record`` of the turns that are used."""

    @property
    def model(self) -> Model: ...
    @property
    def whole(self) -> Record: ...
    @property
    def record(self) -> Record: ...


class RunResult(Protocol):
    """What formats write of one run: ``raceway.pipeline.result.Result``; no motion or identification where none was asked for."""

    @property
    def title(self) -> str: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
    @property
    def model(self) -> Model: ...
    @property
    def equilibrium(self) -> Equilibrium: ...
    @property
    def simulation(self) -> RecordedMotion | None: ...
    @property
    def identification(self) -> Identification | None: ...
