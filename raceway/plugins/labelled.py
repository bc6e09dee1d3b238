"""Labelled arrays, with names, coordinates and units: of any answer, and those of one run for ``Result.to_xarray``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from raceway.errors import RacewayError, extra

if TYPE_CHECKING:
    from raceway.framework.higher_types import Result

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

    names, found, z = list(COORDINATES), result.equilibrium, result.model.system.ball_count
    ring, ball = ("dof",), ("race", "ball")
    variables = {
        "displacement": (ring, found.displacement, labels("displacement", "m, rad", "equilibrium under the constant loads")),
        "stiffness": (
            ("dof", "dof2"),
            found.stiffness,
            labels("stiffness", "N/m, N/rad, N m/m, N m/rad", "tangent of the contacts at the equilibrium"),
        ),
        "ball_load": (ball, found.contact_force.reshape(2, z), labels("ball_load", "N", "static contact force")),
        "contact_angle": (
            ball,
            np.degrees([found.angle_inner, found.angle_outer]),
            labels("contact_angle", "deg", "static; nan where the contact is open"),
        ),
    }
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
        moved = ("time", *ring)
        variables["motion"] = (moved, record.displacement, labels("motion", "m, rad", "of the inner ring"))
        variables["force"] = (moved, record.force, labels("force", "N, N m", "of the excitation"))
        loads = record.contact_force.reshape(len(record.time), 2, z)
        variables["contact_force"] = (("time", *ball), loads, labels("contact_force", "N", "of each ball on each race"))
    if result.dynamic_stiffness is not None:
        variables["z_real"] = (
            (),
            result.dynamic_stiffness.real,
            labels("z_real", "N/m", "real part of the dynamic stiffness Z = F/x"),
        )
        variables["z_imag"] = ((), result.dynamic_stiffness.imag, labels("z_imag", "N/m", "imaginary part of Z, w C"))
        for name, unit, words in _IDENTIFIED:
            value = getattr(result, name)
            variables[name] = ((), np.nan if value is None else value, labels(name, unit, words))
        spread = result.model_spread[0]
        if spread is not None and spread["equivalent_stiffness"] is not None:
            coordinates["end"] = ["low", "high"]
            about = labels("equivalent_stiffness_model", "1", "relative change of K by hypotheses left at their defaults")
            variables["equivalent_stiffness_model"] = (("end",), spread["equivalent_stiffness"], about)
    attributes = {"title": result.title, "warnings": "\n".join(result.warnings)}
    return labelled_dataset(variables, coordinates, attributes)
