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
    "peak_ball_load": ("N", "largest load of a ball on the inner race"),
    "min_ball_load": ("N", "least load of a ball on the inner race, 0 where one is loose"),
    "p0": ("Pa", "largest Hertz pressure of both races"),
    "error_total": ("1", "estimated relative error of Z"),
    "error_time_step": ("1", "part of the time step in the relative error of Z"),
    "error_transient": ("1", "part of the transient in the relative error of Z"),
    "error_mesh": ("1", "part of the mesh in the relative error of Z"),
    "error_contact": ("1", "part of the contact law in the relative error of Z"),
    "error_identification": ("1", "part of the identification in the relative error of Z"),
}
#: Arrays over ``dof``: name -> (dimensions, unit, words).
ARRAYS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "displacement": (("dof",), "m, rad", "equilibrium under the constant loads"),
    "stiffness": (("dof", "dof2"), "N/m, N/rad, N m/m, N m/rad", "tangent of the contacts at the equilibrium"),
    "damping": (("dof", "dof2"), "N s/m, N s/rad, N m s/m, N m s/rad", "damping of the contacts at the equilibrium"),
}


def values_of(result: Result) -> Tables:
    """Plain numbers and lists of a result; what it does not have is absent."""
    found, still = result.identification, result.equilibrium
    values: Tables = {}
    if found is not None:
        z = found.dynamic_stiffness
        values |= {
            "z_real": z.real,
            "z_imag": z.imag,
            "equivalent_stiffness": found.equivalent_stiffness,
            "equivalent_damping": found.equivalent_damping,
            "force_amplitude": found.force_amplitude,
            "frequency": found.frequency_hz,
            "mass": found.mass_used,
            "forward_amplitude": found.forward_amplitude,
            "backward_amplitude": found.backward_amplitude,
            "orbit_major": found.orbit_major,
            "orbit_minor": found.orbit_minor,
            "residual": found.residual,
        }
    values |= _loads(result)
    values |= {f"error_{name}": size for name, size in result.error.items() if name != "how"}
    values = {name: float(value) for name, value in values.items() if value is not None and math.isfinite(value)}
    return values | {name: getattr(still, name).tolist() for name in ARRAYS}


def _loads(result: Result) -> Tables:
    """Of the motion where there is one, else of the equilibrium."""
    from raceway.pipeline.motion import motion_table

    model, z = result.model, result.model.system.ball_count
    if result.simulation is not None:
        record = result.simulation.record
        told = motion_table(model, record)
        return {
            "axial_displacement": told["axial_displacement_m"],
            "peak_ball_load": told["peak_ball_load_n"],
            "p0": max(told["peak_pressure_inner_pa"], told["peak_pressure_outer_pa"]),
            "min_ball_load": record.contact_force[:, :z].min(),
        }
    inner, outer = result.equilibrium.contact_force[:z], result.equilibrium.contact_force[z:]
    return {
        "axial_displacement": result.equilibrium.displacement[0],
        "peak_ball_load": inner.max(),
        "p0": max(model.bearing.contact_ellipse(model, race, load)[0].max() for race, load in enumerate((inner, outer))),
        "min_ball_load": inner.min(),
    }
