"""Labelled arrays, with names, coordinates and units: of any answer, and those of one run for ``Result.to_xarray``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from raceway.answers.quantities import (
    AZIMUTH,
    BALL_LOAD,
    C_ERROR,
    CONTACT_ANGLE,
    CONTACT_FORCE,
    DISPLACEMENT,
    ENDS,
    FORCE,
    K_ERROR,
    MOTION,
    SPEED,
    STIFFNESS,
    TIME,
    Z_IMAG,
    Z_REAL,
    C,
    K,
    Quantity,
)  # fmt: skip
from raceway.errors import RacewayError, extra
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.plugins.formats import RunResult


def labelled_dataset(variables: Tables, coordinates: Any, attributes: Tables) -> Any:
    """An xarray.Dataset; RacewayError where xarray is missing."""
    try:
        import xarray
    except ImportError as why:
        raise RacewayError(f"labelled results need xarray, which is not installed: {extra('results')} ({why})") from None
    return xarray.Dataset(variables, coordinates, attributes)


def labelled(result: RunResult) -> Any:
    """All arrays of a run as an xarray.Dataset.

    Returns
    -------
    xarray.Dataset : ``displacement``, ``stiffness``, ``ball_load`` and ``contact_angle`` of the equilibrium; the ``motion``,
        ``force`` and ``contact_force`` of the turns that are used by ``time``, where motion was recorded; the identified numbers, and
        ends of the intervals of K and kyy

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    import numpy as np

    from raceway.core.ring.ring import COORDINATES

    state, z, names = result.equilibrium, result.model.system.ball_count, list(COORDINATES)
    angles = np.degrees([state.angle_inner, state.angle_outer])
    arrays: list[tuple[Quantity, object]] = [
        (DISPLACEMENT, state.displacement),
        (STIFFNESS, state.stiffness),
        (BALL_LOAD, state.contact_force.reshape(2, z)),
        (CONTACT_ANGLE, angles),
    ]
    coordinates: dict[str, object] = {
        "dof": names,
        "dof2": names,
        "race": ["inner", "outer"],
        "ball": np.arange(z),
        AZIMUTH.name: (AZIMUTH.dims, np.degrees(result.model.azimuth) % 360.0, AZIMUTH.labels),
    }
    if result.simulation is not None:
        record = result.simulation.record
        coordinates[TIME.name] = (TIME.dims, record.time, TIME.labels)
        loads = record.contact_force.reshape(len(record.time), 2, z)
        arrays += [(MOTION, record.displacement), (FORCE, record.force), (CONTACT_FORCE, loads)]
    if result.identification is not None:
        numbers = ((quantity, quantity.of(result)) for quantity in (Z_REAL, Z_IMAG, SPEED, K, K_ERROR, C, C_ERROR))
        arrays += [(quantity, np.nan if value is None else value) for quantity, value in numbers]
    ends = {quantity: quantity.of(result) for quantity in ENDS.values()}
    arrays += [(quantity, value) for quantity, value in ends.items() if value is not None]
    variables = {quantity.name: (quantity.dims, values, quantity.labels) for quantity, values in arrays}
    attributes = {"title": result.title, "warnings": "\n".join(result.warnings)}
    return labelled_dataset(variables, coordinates, attributes)
