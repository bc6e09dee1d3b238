"""The FMU of the force of a bearing with rigid rings and balls on its shaft."""

from __future__ import annotations

import attrs
import numpy as np

from raceway import Scene
from raceway.extend import DIMENSIONS, STIFFNESS, entry_unit
from raceway_fmu.rigid_force import rigid_force
from raceway_fmu.unit import Unit, Variable

#: What users have to know beside.
NOTES = (
    "the force of the contacts alone: masses, loads, dampers and the shaft's stiffness are the simulator's; dashpots of [contact] are left out",
    "cage_angle 0: balls at their azimuths; its integral of cage_speed: ball passing",
)
#: Relative errors: a ball's last step is at most 1e-7 of its approach, of which forces keep the square, stiffness the first power.
_OF_FORCE, _OF_STIFFNESS = 1e-9, 1e-6
_INPUTS = (
    *(Variable(name, "m", "displacement of the inner ring", 0.0) for name in "xyz"),
    *(Variable(name, "rad", "tilt of the inner ring about y, z", 0.0) for name in ("tilt_y", "tilt_z")),
    Variable("speed", "rad/s", "of the shaft", 0.0),
    Variable("cage_angle", "rad", "by which the balls have travelled: 0, or the integral of cage_speed", 0.0),
)


def force_unit(scene: Scene, name: str, highest_rpm: float | None = None) -> Unit:
    """See ``raceway_fmu.rigid_force.rigid_force``."""
    force = rigid_force(scene, highest_rpm)
    (inner, outer), rpm = force.limits, force.highest * 30.0 / np.pi
    ranges = f"speed 0 to {rpm:g} r/min, ball loads to {inner:.4g} N inside and {outer:.4g} N outside"
    errors = {"force": max(force.error, _OF_FORCE), STIFFNESS.name: max(force.error, _OF_STIFFNESS)}
    forces = [Variable(f"force_{name}", "N", "of the bearing on the shaft") for name in "xyz"]
    moments = [Variable(f"moment_{name}", "N m", "of the bearing on the shaft") for name in "yz"]
    further = [
        Variable("largest_ball_load", "N", "of both races"),
        Variable("cage_speed", "rad/s", "of the balls round the axis"),
    ]
    loads = [
        Variable(f"ball_load_{race}[{k + 1}]", "N", f"of each ball on the {race} race")
        for race in ("inner", "outer")
        for k in range(force.balls)
    ]
    entries = [
        Variable(
            f"{STIFFNESS.name}.{a}.{b}",
            entry_unit(STIFFNESS.unit, (a, b)),
            "tangent: what the force loses by a displacement",
        )
        for a in DIMENSIONS["dof"]
        for b in DIMENSIONS["dof"]
    ]
    return Unit(
        name,
        f"force of the bearing on its shaft, rigid rings and balls; {ranges}; relative error {errors['force']:.1e}.",
        "force.c",
        force.numbers,
        f"beyond what the model is made for ({ranges}): computed all the same",
        (*_INPUTS[:5], attrs.evolve(_INPUTS[5], start=force.speed, low=0.0, high=force.highest), _INPUTS[6]),
        (*forces, *moments, *further, *loads, *entries),
        tuple(
            Variable(f"relative_error.{kind}", "1", "of the largest, against Raceway's kernels", e)
            for kind, e in errors.items()
        ),
    )
