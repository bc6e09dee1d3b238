"""A round shaft as Timoshenko elements, in forward whirl.

Notes
-----
Deflection w = y + j z and slope s = y' + j z' of a shaft that whirls with e^{j lambda t} while it spins with Omega:

    (K - lambda^2 (M_t + M_r) + lambda Omega G) q = f,    q = (w_0, s_0, w_1, s_1, ...)

G = 2 M_r for a round section (I_p = 2 I_t).  Force and moment are conjugate to w and s; a moment is M_z - j M_y, the slope
theta_z - j theta_y.  The shape functions are those of the exact static solution, so that a beam loaded at its nodes is exact.

References
----------
Przemieniecki, Theory of Matrix Structural Analysis (1968), sections 5.6 and 11.3; Friswell, Penny, Garvey, Lees, Dynamics of
Rotating Machines (2010), sections 5.4.3 to 5.4.6.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, pi

import attrs
import numpy as np

from raceway.scene.rig import Rig

#: Two points a node less would still integrate the stiffness exactly; mass needs degree 6.
_POINTS, _WEIGHTS = (
    0.5 * (values + shift) for values, shift in zip(np.polynomial.legendre.leggauss(4), (1.0, 0.0), strict=True)
)


@attrs.frozen(eq=False)
class Beam:
    """Nodes (n,) [m] of a round shaft and its matrices (2 n, 2 n).

    Attributes
    ----------
    stiffness, mass, rotary : K, M_t, M_r; a disc's are added to the last two
    polar : G / 1, the gyroscopic matrix over lambda Omega
    """

    nodes: np.ndarray
    stiffness: np.ndarray
    mass: np.ndarray
    rotary: np.ndarray
    polar: np.ndarray

    def node(self, position: float) -> int:
        """The node at a position [m]."""
        return int(np.argmin(np.abs(self.nodes - position)))

    def dynamic(self, whirl: float, spin: float) -> np.ndarray:
        """K - lambda^2 (M_t + M_r) + lambda Omega G for speeds [rad/s]."""
        return self.stiffness - whirl**2 * (self.mass + self.rotary) + whirl * spin * self.polar

    def with_disc(self, position: float, mass: float, transverse: float, polar: float) -> Beam:
        """A copy with a rigid disc at a node: mass [kg], inertias [kg m2]."""
        k = 2 * self.node(position)
        m, r, p = self.mass.copy(), self.rotary.copy(), self.polar.copy()
        m[k, k] += mass
        r[k + 1, k + 1] += transverse
        p[k + 1, k + 1] += polar
        return attrs.evolve(self, mass=m, rotary=r, polar=p)

    def with_spring(self, position: float, stiffness: float, tilt: float = 0.0) -> Beam:
        """A copy with a spring against the ground at a node [N/m, N m/rad]."""
        k = 2 * self.node(position)
        s = self.stiffness.copy()
        s[k, k] += stiffness
        s[k + 1, k + 1] += tilt
        return attrs.evolve(self, stiffness=s)

    def critical_speeds(self) -> np.ndarray:
        """Speeds [rad/s], ascending, at which forward whirl with the spin is a free motion."""
        inertia = self.mass + self.rotary - self.polar  # indefinite: a disc's polar inertia exceeds its transverse one
        values = np.linalg.eigvals(np.linalg.solve(self.stiffness, inertia))
        real = values.real[(np.abs(values.imag) < 1e-9 * np.abs(values).max()) & (values.real > 0.0)]
        return np.sort(1.0 / np.sqrt(real))


def beam(
    nodes: np.ndarray,
    diameter: float,
    young: float,
    poisson: float,
    density: float,
    shear: bool = True,
    stiff: np.ndarray | None = None,
) -> Beam:
    """A round shaft of one diameter.

    Parameters
    ----------
    nodes : (n,) ascending [m]
    shear : False gives an Euler-Bernoulli beam
    stiff : (n - 1,) diameters that bend, where something stiffens the shaft [m]; its mass is not added

    Notes
    -----
    Shear coefficient of a solid round section: 6 (1 + nu) / (7 + 6 nu) (Cowper 1966).
    """
    area, inertia = pi / 4.0 * diameter**2, pi / 64.0 * diameter**4
    bending = np.full(len(nodes) - 1, diameter) if stiff is None else stiff
    modulus = 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson) * young / (2.0 * (1.0 + poisson))
    size = 2 * len(nodes)
    k, m, r = (np.zeros((size, size)) for _ in range(3))
    for i, length in enumerate(np.diff(nodes)):
        part = slice(2 * i, 2 * i + 4)
        bend_stiffness, shear_stiffness = young * pi / 64.0 * bending[i] ** 4, modulus * pi / 4.0 * bending[i] ** 2
        phi = 12.0 * bend_stiffness / (shear_stiffness * length**2) if shear else 0.0
        for x, weight in zip(_POINTS, _WEIGHTS * length, strict=True):
            w, slope, turn, bend = _shapes(x, length, phi)
            k[part, part] += weight * bend_stiffness * np.outer(bend, bend)
            if shear:
                k[part, part] += weight * shear_stiffness * np.outer(slope - turn, slope - turn)
            m[part, part] += weight * density * area * np.outer(w, w)
            r[part, part] += weight * density * inertia * np.outer(turn, turn)
    return Beam(np.asarray(nodes), k, m, r, 2.0 * r)


def _shapes(x: float, length: float, phi: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Deflection, its derivative, section's rotation and its derivative (4,) at x in 0..1 for w_0, s_0, w_1, s_1."""
    one = 1.0 / (1.0 + phi)
    half = 0.5 * phi * length
    w = [
        1.0 - 3.0 * x**2 + 2.0 * x**3 + phi * (1.0 - x),
        length * (x - 2.0 * x**2 + x**3) + half * (x - x**2),
        3.0 * x**2 - 2.0 * x**3 + phi * x,
        length * (x**3 - x**2) - half * (x - x**2),
    ]
    slope = [
        -6.0 * x + 6.0 * x**2 - phi,
        length * (1.0 - 4.0 * x + 3.0 * x**2) + half * (1.0 - 2.0 * x),
        6.0 * x - 6.0 * x**2 + phi,
        length * (3.0 * x**2 - 2.0 * x) - half * (1.0 - 2.0 * x),
    ]
    turn = [
        6.0 * (x**2 - x) / length,
        1.0 - 4.0 * x + 3.0 * x**2 + phi * (1.0 - x),
        6.0 * (x - x**2) / length,
        3.0 * x**2 - 2.0 * x + phi * x,
    ]
    bend = [
        6.0 * (2.0 * x - 1.0) / length,
        6.0 * x - 4.0 - phi,
        6.0 * (1.0 - 2.0 * x) / length,
        6.0 * x - 2.0 + phi,
    ]
    return one * np.array(w), one * np.array(slope) / length, one * np.array(turn), one * np.array(bend) / length


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
    left, right = (2 * line.node(position) for position in rig.bearings)
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
