"""``Result.to_xarray``: arrays of one run with names, coordinates and units."""

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
    try:
        import xarray
    except ImportError:
        raise RacewayError(f"labelled arrays need xarray, which is not installed: {extra('results')}") from None
    import numpy as np

    from raceway.core.ring.ring import COORDINATES

    names, found, z = list(COORDINATES), result.equilibrium, result.model.system.ball_count
    ring, ball = ("dof",), ("race", "ball")
    variables = {
        "displacement": (ring, found.displacement, _about("m, rad", "equilibrium under the constant loads")),
        "stiffness": (
            ("dof", "dof2"),
            found.stiffness,
            _about("N/m, N/rad, N m/m, N m/rad", "tangent of the contacts at the equilibrium"),
        ),
        "ball_load": (ball, found.contact_force.reshape(2, z), _about("N", "static contact force")),
        "contact_angle": (
            ball,
            np.degrees([found.angle_inner, found.angle_outer]),
            _about("deg", "static; nan where the contact is open"),
        ),
    }
    coordinates: dict[str, Any] = {
        "dof": names,
        "dof2": names,
        "race": ["inner", "outer"],
        "ball": np.arange(z),
        "azimuth": (("ball",), np.degrees(result.model.azimuth) % 360.0, _about("deg", "from +y towards +z")),
    }
    if result.simulation is not None:
        record = result.simulation.record
        coordinates["time"] = (("time",), record.time, _about("s", "in the turns that are used"))
        moved = ("time", *ring)
        variables["motion"] = (moved, record.displacement, _about("m, rad", "of the inner ring"))
        variables["force"] = (moved, record.force, _about("N, N m", "of the excitation"))
        loads = record.contact_force.reshape(len(record.time), 2, z)
        variables["contact_force"] = (("time", *ball), loads, _about("N", "of each ball on each race"))
    if result.dynamic_stiffness is not None:
        variables["z_real"] = (
            (),
            result.dynamic_stiffness.real,
            _about("N/m", "real part of the dynamic stiffness Z = F/x"),
        )
        variables["z_imag"] = ((), result.dynamic_stiffness.imag, _about("N/m", "imaginary part of Z, w C"))
        for name, unit, words in _IDENTIFIED:
            value = getattr(result, name)
            variables[name] = ((), np.nan if value is None else value, _about(unit, words))
    attributes = {"title": result.title, "warnings": "\n".join(result.warnings)}
    return xarray.Dataset(variables, coordinates, attributes)


def _about(unit: str, words: str) -> dict[str, str]:
    return {"units": unit, "long_name": words}
