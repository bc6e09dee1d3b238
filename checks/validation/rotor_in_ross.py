"""The test rig's rotor in ROSS and by our own beam: natural frequencies at speed, response to unbalance.

Both stand on the tangent stiffness of the rig's bearings, deflection and tilt with their coupling.
"""

from math import pi
from typing import Any

import attrs
import numpy as np
from raceway_rotor.rig_table import rig_of
from raceway_rotor.ross_file import ross
from raceway_rotor.shaft import Beam, rotor, shaft

from checks.validation.command_line import EXAMPLES
from raceway import RacewayError, load_scene

AXIAL = 2000.0  # N


@attrs.frozen(eq=False)
class Compared:
    """Ours and ROSS's, columns (n, 2).

    frequencies : first three of forward whirl at the rig's first speed [rad/s]
    responses : amplitudes at the tested bearing and at the sensor, at the rig's speeds [m]
    """

    frequencies: np.ndarray
    responses: np.ndarray

    @staticmethod
    def difference(pairs: np.ndarray) -> float:
        """Largest relative difference."""
        return float(np.abs(pairs[:, 1] / pairs[:, 0] - 1.0).max())


def compared() -> Compared:
    """Both models at the rig's speeds.  RacewayError: ROSS is missing."""
    rig = rig_of(load_scene(EXAMPLES / "test_rig.toml"))
    line = shaft(rig)
    theirs, bearings = _in_ross(rig, line)
    speeds = np.array(rig.speeds_rpm) * pi / 30.0
    side = 1.0 if rig.arrangement == "DB" else -1.0
    held = [
        np.asarray(bearings[0].node_bearing.dynamic_stiffness(speed, speed).real[np.ix_([1, 4], [1, 4])]) for speed in speeds
    ]
    standing = line.stiffness.copy()
    for place, sign in zip(rig.bearings, (side, -side), strict=True):
        k, turn = 2 * line.node(place), np.diag([1.0, sign])
        standing[k : k + 2, k : k + 2] += turn @ held[0] @ turn
    # Forward whirl is of K - l^2 (M_t + M_r) + l W G at the spin speed W.
    size, inverse = len(standing), np.linalg.inv(line.mass + line.rotary)
    companion = np.block([[np.zeros((size, size)), np.eye(size)], [inverse @ standing, speeds[0] * inverse @ line.polar]])
    values = np.linalg.eigvals(companion)
    whirl = np.sort(values.real[values.real > 0.0])[:3]
    modes = theirs.run_modal(speeds[0], num_modes=40).wn
    frequencies = np.column_stack([whirl, [modes[np.argmin(np.abs(modes - w))] for w in whirl]])
    disc = line.node(0.5 * rig.shaft_length)
    found = np.asarray(theirs.run_unbalance_response(disc, rig.unbalance, 0.0, list(speeds)).forced_resp)
    rows = []
    for k, (speed, stiffness) in enumerate(zip(speeds, held, strict=True)):
        model = rotor(rig, float(speed))
        moved = model.ring[:, 0] * model.unbalance_force  # w = moved + A K w
        load = stiffness @ np.linalg.solve(np.eye(2) - model.ring[:, 1:] @ stiffness, moved)
        for place, ours in ((rig.bearings[0], model.at_ring(*load)[0]), (rig.sensor, model.at_sensor(*load))):
            rows.append((abs(ours), abs(found[theirs.number_dof * line.node(place), k])))
    return Compared(frequencies, np.array(rows))


def _in_ross(rig: Any, line: Beam) -> tuple[Any, list[Any]]:
    """Rotor and bearings in ROSS on the nodes of our beam."""
    program = ross("the comparison of shafts")
    from raceway.ross import RollingBearing

    if rig.hub_diameter is not None:
        raise RacewayError("the comparison of shafts has no hub: leave `rig.hub_diameter` out")
    steel = program.Material(name="steel", rho=rig.density, E=rig.young, Poisson=rig.poisson)
    elements = [
        program.ShaftElement(L=float(length), idl=0.0, odl=rig.shaft_diameter, material=steel)
        for length in np.diff(line.nodes)
    ]
    inner, outer, width = 0.5 * rig.shaft_diameter, rig.disc_radius, rig.disc_thickness
    mass = rig.density * pi * (outer**2 - inner**2) * width
    polar = 0.5 * mass * (outer**2 + inner**2)
    disc = program.DiskElement(
        n=line.node(0.5 * rig.shaft_length), m=mass, Id=0.5 * polar + mass * width**2 / 12.0, Ip=polar
    )
    side = 1.0 if rig.arrangement == "DB" else -1.0
    scene = EXAMPLES / "test_rig.toml"
    bearings = [
        RollingBearing(scene, sign * side * AXIAL, n=line.node(place), tilt="node")
        for place, sign in zip(rig.bearings, (1.0, -1.0), strict=True)
    ]
    return program.Rotor(elements, [disc], bearings), bearings
