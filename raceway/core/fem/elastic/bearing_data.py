"""Data of an elastic bearing beyond its meshes."""

from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import contact_modulus
from raceway.core.fem.elastic.copies import turn
from raceway.core.jit import Kernel

Material = tuple[float, float, float]


@attrs.frozen(eq=False)
class BearingData:
    """Data of a bearing beyond its meshes.

    geometry : BallBearing;  azimuth : (Z,) of the balls [rad];  rings, balls : young [Pa], poisson, density [kg/m3]
    reference_load : load of a ball [N], from which the points that may touch are chosen
    law : kernel of signature ``LAW``;  params : function of (pair (n,), area (n,)) -> (n, k) parameters of the points;
        pairs are counted as in a record: inner races of all balls, then outer
    state_size : columns of the law's memory
    mass, damping, stiffness : (5, 5) of rotor and shaft at the reference point, without the ring
    free : (5,) bool;  load : (5,) constant load [N, N m];  formulation, hourglass, least_step : of the hexahedra
    seat_inner, seat_outer : "rigid" or a bed [N/m3]
    contact_damping : normal damping [N s/m] of each contact at the reference load
    ball_force : outward force on each ball [N], centrifugal
    growth : how much larger in radius the inner raceway is than meshed [m]: fit, temperature, rotation
    caged : whether an ideal cage holds the balls at their azimuth
    angles : (2 Z,) contact angles [rad] at which contact resultants press on the meshes, inner races first; None: pressures at points
    beyond : (2 Z,) compliance of a contact at its surface points beyond Hertz's and what is matched at depth [m/N]: its calibration
    friction : Coulomb's coefficient;  stick : stiffness of sticking points [N/m3], None: Mindlin's ratio times the penalty's
    """

    geometry: BallBearing
    azimuth: np.ndarray
    rings: Material
    balls: Material
    reference_load: float
    law: Kernel
    params: Callable[[np.ndarray, np.ndarray], np.ndarray]
    mass: np.ndarray
    free: np.ndarray
    load: np.ndarray
    damping: np.ndarray = attrs.field(factory=lambda: np.zeros((5, 5)))
    stiffness: np.ndarray = attrs.field(factory=lambda: np.zeros((5, 5)))
    state_size: int = 0
    formulation: str = "full"
    hourglass: float = 0.05
    least_step: float = 0.0
    seat_inner: float | str = "rigid"
    seat_outer: float | str = "rigid"
    contact_damping: float = 0.0
    ball_force: float = 0.0
    growth: float = 0.0
    caged: bool = True
    angles: np.ndarray | None = None
    beyond: np.ndarray | None = None
    friction: float = 0.0
    stick: float | None = None

    @property
    def modulus(self) -> float:
        return contact_modulus(*self.rings[:2], *self.balls[:2])

    @property
    def offsets(self) -> tuple[np.ndarray, np.ndarray]:
        """Groove centres, inner and outer: axial place and radius [m]."""
        g = self.geometry
        direction = np.array([np.sin(g.contact_angle), np.cos(g.contact_angle)])
        middle = np.array([0.0, 0.5 * g.pitch_diameter])
        return middle + g.offset_inner * direction, middle - g.offset_outer * direction

    @property
    def ball_count(self) -> int:
        return len(self.azimuth)

    def radial(self, ball: int) -> np.ndarray:
        """(3,) from the axis to a ball, of length 1."""
        psi = self.azimuth[ball]
        return np.array([0.0, np.cos(psi), np.sin(psi)])

    def line(self, ball: int, angle: float) -> np.ndarray:
        """(3,) from a ball to the outer race, of length 1, at a contact angle [rad]."""
        return np.sin(angle) * np.array([1.0, 0.0, 0.0]) + np.cos(angle) * self.radial(ball)

    def turn(self, ball: int) -> np.ndarray:
        """(3, 3) about the axis, from azimuth zero to a ball's."""
        return turn(float(self.azimuth[ball]))
