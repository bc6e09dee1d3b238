"""Variables that a sweep keeps of each point: names, units, words, and their places in a result."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.pipeline.result import Result

#: Coordinates of the ring, in the order of ``displacement`` and ``stiffness``.
DOF = ("x", "y", "z", "tilt_y", "tilt_z")

#: Numbers: name -> (unit, words).
NUMBERS: dict[str, tuple[str, str]] = {
    "z_real": ("N/m", "real part of the dynamic stiffness Z = F/x"),
    "z_imag": ("N/m", "imaginary part of the dynamic stiffness Z = F/x, w C"),
    "equivalent_stiffness": ("N/m", "K = Re Z + m w^2"),
    "equivalent_damping": ("N s/m", "C = Im Z / w"),
    "force_amplitude": ("N", "amplitude of the 1x force"),
    "frequency": ("Hz", "of the 1x line"),
    "mass": ("kg", "m of K = Re Z + m w^2"),
    "forward_amplitude": ("m", "forward part of the 1x orbit"),
    "backward_amplitude": ("m", "backward part of the 1x orbit"),
    "orbit_major": ("m", "major semi-axis of the 1x orbit"),
    "orbit_minor": ("m", "minor semi-axis of the 1x orbit"),
    "residual": ("1", "motion that is not 1x, rms over rms of 1x"),
    "axial_displacement": ("m", "mean axial displacement"),
    "kyy_tilts_follow": ("N/m", "radial tangent with tilts that follow as supports.tilt lets them, x and z held"),
    "peak_ball_load": ("N", "largest load of a ball, of both races"),
    "peak_ball_load_inner": ("N", "largest load of a ball on the inner race"),
    "peak_ball_load_outer": ("N", "largest load of a ball on the outer race"),
    "min_ball_load": ("N", "least load of a ball on the inner race, 0 where one is loose"),
    "p0": ("Pa", "largest Hertz pressure, of both races"),
    "p0_inner": ("Pa", "largest Hertz pressure on the inner race"),
    "p0_outer": ("Pa", "largest Hertz pressure on the outer race"),
    "error_total": ("1", "estimated relative error of Z"),
    "error_time_step": ("1", "part of the time step in the relative error of Z"),
    "error_transient": ("1", "part of the transient in the relative error of Z"),
    "error_mesh": ("1", "part of the mesh in the relative error of Z"),
    "error_contact": ("1", "part of the contact law in the relative error of Z"),
    "error_identification": ("1", "part of the identification in the relative error of Z"),
    "error_model_bound": ("1", "upper estimate of the change of kyy by hypotheses of [kinematics] left at their defaults"),
}
#: Arrays over ``dof``: name -> (dimensions, unit, words).
ARRAYS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "displacement": (("dof",), "m, rad", "equilibrium under the constant loads"),
    "stiffness": (
        ("dof", "dof2"),
        "N/m, N/rad, N m/m, N m/rad",
        "tangent of the contacts at the equilibrium: kyy is y, y, tilts held",
    ),
    "damping": (("dof", "dof2"), "N s/m, N s/rad, N m s/m, N m s/rad", "damping of the contacts at the equilibrium"),
}


def values_of(result: Result) -> Tables:
    """Plain numbers and lists of a result; what it does not have is absent."""
    from raceway.pipeline.plausible import closed_bound

    found, still = result.identification, result.equilibrium
    values: Tables = {}
    if found is not None:
        z = found.dynamic_stiffness
        values |= {
            "z_real": z.real,
            "z_imag": z.imag,
            "frequency": found.frequency_hz,
            "mass": found.mass_used,
            **{name: getattr(found, name) for name in NUMBERS if hasattr(found, name)},
        }
    values |= {"kyy_tilts_follow": result.kyy_tilts_follow, **_loads(result)}
    values |= {f"error_{name}": size for name, size in result.error.items() if name not in ("how", "unresolved")}
    values["error_model_bound"] = closed_bound(result.model, still)
    values = {name: float(value) for name, value in values.items() if value is not None and math.isfinite(value)}
    return values | {name: getattr(still, name).tolist() for name in ARRAYS}


def _loads(result: Result) -> Tables:
    """Of the motion where there is one, else of the equilibrium."""
    from raceway.pipeline.settle import largest_contacts, motion_table, pressures

    model, z = result.model, result.model.system.ball_count
    if result.simulation is not None:
        record = result.simulation.record
        told, loads = motion_table(model, record), record.contact_force
    else:
        loads = result.equilibrium.contact_force
        told = largest_contacts(loads, pressures(model, loads), "peak")
    return {
        "axial_displacement": told.get("axial_displacement_m", result.equilibrium.displacement[0]),
        "min_ball_load": loads[..., :z].min(),
        "peak_ball_load": told["peak_ball_load_n"],
        "p0": told["peak_pressure_pa"],
        **{f"peak_ball_load_{race}": told[f"peak_ball_load_{race}_n"] for race in ("inner", "outer")},
        **{f"p0_{race}": told[f"peak_pressure_{race}_pa"] for race in ("inner", "outer")},
    }
