"""The rig's shaft and disc: what the tested bearing and the sensor do under unbalance, bearing force and moment."""

from __future__ import annotations

from functools import lru_cache
from math import ceil, pi

import attrs
import numpy as np

from raceway.scene.rig import Rig
from raceway.studies.shaft.beam import Beam, beam

#: Longest element over the shaft's diameter: halving it moves no answer of the rig by 1e-6.
_ELEMENT = 0.25


@attrs.frozen(eq=False)
class Rotor:
    """Answers of the free shaft at one speed, linear in unbalance force, bearing force and bearing moment.

    Attributes
    ----------
    speed : W [rad/s]
    ring, sensor : answers (w, s) of the shaft in the bearing and (w) at the sensor: rows of (.., 3) for
        a unit of unbalance force [N] at the disc, force [N] and moment [N m] of the shaft on each bearing

    Notes
    -----
    Both bearings carry the same, as mirror images.  Slope and moment are those of the bearing's own frame, whose axis points
    to where its load seats it.
    """

    speed: float
    ring: np.ndarray
    sensor: np.ndarray
    unbalance_force: float

    def at_ring(self, force: complex, moment: complex) -> np.ndarray:
        """Deflection [m] and slope [rad] of the shaft in the bearing (2,)."""
        return self.ring @ np.array([self.unbalance_force, force, moment])

    def at_sensor(self, force: complex, moment: complex) -> complex:
        """Deflection at the sensor [m]."""
        return complex(self.sensor @ np.array([self.unbalance_force, force, moment]))


@lru_cache(maxsize=32)  # one rig is asked for at many speeds, changed rigs again for each record
def shaft(rig: Rig, shear: bool = True, finer: int = 1) -> Beam:
    """The rig's shaft with its disc.

    Parameters
    ----------
    shear : False leaves shear and rotary inertia out of the shaft
    finer : divides the length of the elements
    """
    middle, half = 0.5 * rig.shaft_length, 0.5 * rig.disc_thickness
    places = sorted({0.0, *rig.bearings, rig.sensor, middle - half, middle, middle + half, rig.shaft_length})
    nodes = [places[0]]
    for before, after in zip(places, places[1:], strict=False):
        if after - before > 1e-6:  # nearer ones share a node
            parts = finer * ceil((after - before) / (_ELEMENT * rig.shaft_diameter))
            nodes += np.linspace(before, after, parts + 1)[1:].tolist()
    centres = 0.5 * (np.array(nodes[1:]) + np.array(nodes[:-1]))
    stiff = np.where(np.abs(centres - middle) < half, rig.hub_diameter or rig.shaft_diameter, rig.shaft_diameter)
    bare = beam(np.array(nodes), rig.shaft_diameter, rig.young, rig.poisson, rig.density, shear, stiff)
    if not shear:
        bare = attrs.evolve(bare, rotary=0.0 * bare.rotary, polar=0.0 * bare.polar)
    inner, outer, width = 0.5 * rig.shaft_diameter, rig.disc_radius, rig.disc_thickness
    mass = rig.density * pi * (outer**2 - inner**2) * width
    polar = 0.5 * mass * (outer**2 + inner**2)
    return bare.with_disc(middle, mass, 0.5 * polar + mass * width**2 / 12.0, polar)


def rotor(rig: Rig, speed: float, line: Beam | None = None) -> Rotor:
    """The rotor at a speed [rad/s].

    Parameters
    ----------
    line : another model of the shaft
    """
    line = line or shaft(rig)
    left, right = (2 * line.node(place) for place in rig.bearings)
    disc, sensor = 2 * line.node(0.5 * rig.shaft_length), 2 * line.node(rig.sensor)
    sign = 1.0 if rig.arrangement == "DB" else -1.0
    loads = np.zeros((len(line.stiffness), 3))
    loads[disc, 0] = 1.0
    loads[[left, right], 1] = -1.0
    loads[left + 1, 2], loads[right + 1, 2] = -sign, sign
    answer = np.linalg.solve(line.dynamic(speed, speed), loads)
    return Rotor(
        speed=speed,
        ring=np.array([answer[left], sign * answer[left + 1]]),
        sensor=answer[sensor],
        unbalance_force=rig.unbalance * speed**2,
    )
