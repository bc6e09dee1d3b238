"""Files of one run, what they see of it, and arrays with names, coordinates and units.

pictures   orbit, spectrum, ball loads
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from raceway.answers import quantities
from raceway.answers.quantities import Quantity
from raceway.errors import RacewayError, extra
from raceway.storage.tables import Tables

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


def labelled_dataset(variables: Tables, coordinates: Any, attributes: Tables) -> Any:
    """An xarray.Dataset; RacewayError where xarray is missing."""
    try:
        import xarray
    except ImportError as why:
        raise RacewayError(f"labelled results need xarray, which is not installed: {extra('results')} ({why})") from None
    return xarray.Dataset(variables, coordinates, attributes)


def labelled(result: RunResult) -> Any:
    """All arrays of a run as an xarray.Dataset.

    ``displacement``, ``stiffness``, ``ball_load`` and ``contact_angle`` of the equilibrium; the ``motion``, ``force`` and
    ``contact_force`` of the turns that are used by ``time``, where motion was recorded; the identified numbers, and ends of the
    intervals of K and kyy.

    RacewayError: xarray is missing.
    """
    import numpy as np

    from raceway.core.ring.ring import COORDINATES

    state, z, names = result.equilibrium, result.model.system.ball_count, list(COORDINATES)
    arrays: list[tuple[Quantity, object]] = [
        (quantities.DISPLACEMENT, state.displacement),
        (quantities.STIFFNESS, state.stiffness),
        (quantities.BALL_LOAD, state.contact_force.reshape(2, z)),
        (quantities.CONTACT_ANGLE, np.degrees([state.angle_inner, state.angle_outer])),
    ]
    coordinates: dict[str, object] = {"dof": names, "dof2": names, "race": ["inner", "outer"], "ball": np.arange(z)}
    azimuth = quantities.AZIMUTH
    coordinates[azimuth.name] = (azimuth.dims, np.degrees(result.model.azimuth) % 360.0, azimuth.labels)
    if result.simulation is not None:
        record = result.simulation.record
        coordinates[quantities.TIME.name] = (quantities.TIME.dims, record.time, quantities.TIME.labels)
        arrays += [
            (quantities.MOTION, record.displacement),
            (quantities.FORCE, record.force),
            (quantities.CONTACT_FORCE, record.contact_force.reshape(len(record.time), 2, z)),
        ]
    if result.identification is not None:
        numbers = (
            (quantity, quantity.of(result))
            for quantity in (
                quantities.Z_REAL,
                quantities.Z_IMAG,
                quantities.SPEED,
                quantities.K,
                quantities.K_ERROR,
                quantities.C,
                quantities.C_ERROR,
            )
        )
        arrays += [(quantity, np.nan if value is None else value) for quantity, value in numbers]
    ends = {quantity: quantity.of(result) for quantity in quantities.ENDS.values()}
    arrays += [(quantity, value) for quantity, value in ends.items() if value is not None]
    variables = {quantity.name: (quantity.dims, values, quantity.labels) for quantity, values in arrays}
    return labelled_dataset(variables, coordinates, {"title": result.title, "warnings": "\n".join(result.warnings)})
