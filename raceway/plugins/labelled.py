"""Labelled arrays, with names, coordinates and units: of any answer, and those of one run for ``Result.to_xarray``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from raceway.errors import RacewayError, extra

if TYPE_CHECKING:
    from raceway.pipeline.result import Result

#: Name, unit and meaning of the numbers that are identified.
_IDENTIFIED = (
    ("speed_rpm", "r/min", "speed of the excitation"),
    ("equivalent_stiffness", "N/m", "K = Re Z + m w^2"),
    ("equivalent_stiffness_error", "N/m", "estimated error of K"),
    ("equivalent_damping", "N s/m", "C = Im Z / w"),
    ("equivalent_damping_error", "N s/m", "estimated error of C"),
)


def labelled_dataset(variables: Any, coordinates: Any, attributes: Any) -> Any:
    """An xarray.Dataset; RacewayError where xarray is missing."""
    try:
        import xarray
    except ImportError as why:
        raise RacewayError(f"labelled results need xarray, which is not installed: {extra('results')} ({why})") from None
    return xarray.Dataset(variables, coordinates, attributes)


def labels(name: str, unit: str, words: str) -> dict[str, str]:
    """Attributes of a labelled array: xarray writes the short ``long_name`` and the unit beside an axis."""
    return {"units": unit, "long_name": name.replace("_", " "), "description": words}


def labelled(result: Result) -> Any:
    """All arrays of a run as an xarray.Dataset.

    Returns
    -------
    xarray.Dataset : ``displacement``, ``stiffness``, ``ball_load`` and ``contact_angle`` of the equilibrium; the ``motion``,
        ``force`` and ``contact_force`` of the turns that are used by ``time``, where motion was recorded; the identified numbers

    Raises
    ------
    RacewayError
        xarray is missing.
    """
    import numpy as np

    from raceway.core.ring.ring import COORDINATES

    state, z, names = result.equilibrium, result.model.system.ball_count, list(COORDINATES)
    ring, ball = ("dof",), ("race", "ball")
    columns: list[tuple[str, tuple[str, ...], Any, str, str]] = [
        ("displacement", ring, state.displacement, "m, rad", "equilibrium under the constant loads"),
        (
            "stiffness",
            ("dof", "dof2"),
            state.stiffness,
            "N/m, N/rad, N m/m, N m/rad",
            "tangent of the contacts at the equilibrium",
        ),
        ("ball_load", ball, state.contact_force.reshape(2, z), "N", "static contact force"),
        (
            "contact_angle",
            ball,
            np.degrees([state.angle_inner, state.angle_outer]),
            "deg",
            "static; nan where the contact is open",
        ),
    ]
    coordinates: dict[str, Any] = {
        "dof": names,
        "dof2": names,
        "race": ["inner", "outer"],
        "ball": np.arange(z),
        "azimuth": (("ball",), np.degrees(result.model.azimuth) % 360.0, labels("azimuth", "deg", "from +y towards +z")),
    }
    if result.simulation is not None:
        record = result.simulation.record
        coordinates["time"] = (("time",), record.time, labels("time", "s", "in the turns that are used"))
        loads = record.contact_force.reshape(len(record.time), 2, z)
        columns += [
            ("motion", ("time", *ring), record.displacement, "m, rad", "of the inner ring"),
            ("force", ("time", *ring), record.force, "N, N m", "of the excitation"),
            ("contact_force", ("time", *ball), loads, "N", "of each ball on each race"),
        ]
    if result.dynamic_stiffness is not None:
        columns += [
            ("z_real", (), result.dynamic_stiffness.real, "N/m", "real part of the dynamic stiffness Z = F/x"),
            ("z_imag", (), result.dynamic_stiffness.imag, "N/m", "imaginary part of Z, w C"),
        ]
        for name, unit, words in _IDENTIFIED:
            value = getattr(result, name)
            columns.append((name, (), np.nan if value is None else value, unit, words))
        spread = result.model_spread[0]
        if spread is not None and spread["equivalent_stiffness"] is not None:
            coordinates["end"] = ["low", "high"]
            words = "relative change of K by hypotheses left at their defaults"
            columns.append(("equivalent_stiffness_model", ("end",), spread["equivalent_stiffness"], "1", words))
    variables = {name: (axes, values, labels(name, unit, words)) for name, axes, values, unit, words in columns}
    attributes = {"title": result.title, "warnings": "\n".join(result.warnings)}
    return labelled_dataset(variables, coordinates, attributes)
