"""Steady temperatures of a bearing in its machine: a network of six nodes, and correlations for its conductances.

Nodes are the inner ring, the balls, the outer ring, shaft, housing and the oil in the bearing, each of one temperature; beside them stand
the oil's inlet and the ambient, whose temperatures are known.  With the conductances G [W/K] between nodes and the heats Q [W] that
arise in them, sum_j G_ij (T_i - T_j) = Q_i.  A raceway's track is hotter than the mean of its ring, which alone is a node.

Oil comes in cold, is thrown to the outer ring and leaves over its shoulders.  The mist between the rings, stirred by the balls for tens
of turns (``jet_oil_fraction``), has the temperature T at which the oil leaves: that of its node, whose throughput m c_p is a conductance to the
inlet.  Inner ring and balls give their heat to the mist.  The outer ring's film warms up from the inlet's T_0 to T on its way: of
plug flow along a wall of one temperature, with N = G / (m c_p), the mean is T + (T_0 - T) (1/N - 1/(exp N - 1)), between
(T_0 + T) / 2 of a short and T of a long way.

Harris & Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapter 7 (networks of temperature nodes).
"""

from collections.abc import Mapping
from functools import cached_property

import attrs
import numpy as np

from raceway.core.columns import Number, elliptic_integrals

NODES = ("inner", "balls", "outer", "shaft", "housing", "oil")
#: Nodes whose temperatures are known.
_KNOWN = ("inlet", "ambient")
#: Conductances by name, and the nodes that they join.
LINKS: dict[str, tuple[str, str]] = {
    "inner_balls": ("inner", "balls"), "outer_balls": ("outer", "balls"),
    "inner_oil": ("inner", "oil"), "balls_oil": ("balls", "oil"), "outer_oil": ("outer", "oil"),
    "inner_shaft": ("inner", "shaft"), "outer_housing": ("outer", "housing"),
    "shaft_ambient": ("shaft", "ambient"), "housing_ambient": ("housing", "ambient"),
    "throughput": ("oil", "inlet"),
}  # fmt: skip
#: Of bearing steel: conductivity [W/m/K] and sqrt(conductivity, density and heat capacity) [W s^0.5/m2/K] of 46 W/m/K, 7810 kg/m3
#: and 475 J/kg/K (100Cr6); silicon nitride has some 30 W/m/K and 8000 W s^0.5/m2/K.
STEEL_CONDUCTIVITY, STEEL_EFFUSIVITY = 46.0, 13_060.0
#: B(1/2, 5/4) = integral of (1 - y^2)^(1/4) from -1 to 1.
_CHORDS = 1.748038369528081
#: Of a joint between a ring and its seat [W/m2/K]: air of 0.026 W/m/K in a mean gap of 5 um, which the roughness of ground seats leaves.
#: Dry joints of steel are published with 2000 to 20 000.
JOINT = 5200.0
#: Heat that ISO 15312 lets a bearing's seats give off at 50 K above the ambient [W/m2], up to seats of 50 000 mm2; beyond,
#: times (area / 50 000 mm2) to this power.
_EMISSION, _LARGE_SEATS, _LARGE_POWER = 16_000.0, 0.05, -0.34


@attrs.frozen(eq=False, slots=False)
class Network:
    """The network of a bearing at n operating points.

    conductances : of all ``LINKS`` [W/K], numbers or columns (n,); ``inf`` gives both nodes one temperature
    heats : (n, 6) heat that arises in the ``NODES`` [W];  inlet, ambient : temperatures, numbers or columns (n,)

    Nodes of one temperature are one unknown.  An infinite path from the inlet to the ambient would be a contradiction: the ambient's
    then counts.
    """

    conductances: Mapping[str, Number]
    heats: np.ndarray
    inlet: Number
    ambient: Number

    @cached_property
    def temperatures(self) -> np.ndarray:
        """(n, 6) of ``NODES``, in the unit and from the origin of ``inlet`` and ``ambient``."""
        n, names = len(self.heats), (*NODES, *_KNOWN)
        group = list(range(len(names)))
        infinite = {link for link, value in self.conductances.items() if np.all(np.isinf(value))}
        for link in infinite:
            first, second = (group[names.index(node)] for node in LINKS[link])
            group = [max(first, second) if member in (first, second) else member for member in group]
        balance, arising = np.zeros((n, len(names), len(names))), np.zeros((n, len(names)))
        for node in range(len(NODES)):
            arising[:, group[node]] += self.heats[:, node]
        for link in (link for link in LINKS if link not in infinite):  # in their order, which a set's is not
            i, j = (group[names.index(node)] for node in LINKS[link])
            for end, part in self._away[link]:
                k, conductance = group[names.index(end)], part * self.conductances[link]
                balance[:, i, k] -= conductance
                balance[:, j, k] += conductance
        free, boundary = sorted({member for member in group if member < len(NODES)}), [len(NODES), len(NODES) + 1]
        level = np.zeros((n, len(names)))
        level[:, boundary] = np.stack([np.broadcast_to(self.inlet, n), np.broadcast_to(self.ambient, n)], axis=1)
        if free:
            loads = arising[:, free] - np.einsum("nij,nj->ni", balance[:, free][:, :, boundary], level[:, boundary])
            level[:, free] = np.linalg.solve(balance[:, free][:, :, free], loads[..., None])[..., 0]
        return level[:, group[: len(NODES)]]

    @cached_property
    def _away(self) -> dict[str, list[tuple[str, Number]]]:
        """Of each link the nodes, and their parts of the temperature difference that drives heat back to its first node."""
        film, throughput = (np.asarray(self.conductances[link], dtype=float) for link in ("outer_oil", "throughput"))
        with np.errstate(all="ignore"):
            units = np.where(np.isfinite(throughput), film / throughput, 0.0)
            cold = np.where(units > 1e-4, 1.0 / units - 1.0 / np.expm1(units), 0.5)
        ends: dict[str, list[tuple[str, Number]]] = {
            link: [(first, -1.0), (second, 1.0)] for link, (first, second) in LINKS.items()
        }
        return ends | {"outer_oil": [("outer", -1.0), ("oil", 1.0 - cold), ("inlet", cold)]}

    @property
    def flows(self) -> dict[str, np.ndarray]:
        """Heat (n,) [W] along each of ``LINKS``, from its first node to its second; nan where the link is infinite, but what the
        oil carries off: all that does not go to the ambient."""
        at = dict(zip(NODES, self.temperatures.T, strict=True)) | {"inlet": self.inlet, "ambient": self.ambient}
        along = {}
        for link in LINKS:
            infinite = np.all(np.isinf(self.conductances[link]))
            difference = np.asarray(-sum(part * at[node] for node, part in self._away[link]))
            along[link] = np.full_like(difference, np.nan) if infinite else self.conductances[link] * difference
        if np.isnan(along["throughput"]).any():
            along["throughput"] = self.heats.sum(axis=1) - along["shaft_ambient"] - along["housing_ambient"]
        return along


def rolling_contact(
    semi_major: np.ndarray, semi_minor: np.ndarray, speed: np.ndarray, film: Number = 0.0, oil_conductivity: Number = 0.14
) -> np.ndarray:
    """Conductance of each contact of a steel ball that rolls on a steel race [W/K], 0 of one that is open.

    semi_major, semi_minor : a across and b along the motion [m];  speed : of both surfaces through the contact [m/s]
    film : thickness of the oil between them [m];  oil_conductivity : [W/m/K]

    Two half-spaces of the effusivity e = sqrt(k rho c) that touch for the time t exchange e dT sqrt(t / pi) a unit of area.  A strip of the
    ellipse at y across the motion is t = 2 b sqrt(1 - (y/a)^2) / u in contact, so that with B(1/2, 5/4) = 1.748 the sum over strips is
    G_m = 1.748 a e sqrt(2 b u / pi).  At rest an isothermal ellipse between two half-spaces has G_s = pi k a / K(1 - b^2/a^2).
    Between the limits of high and low Peclet numbers u b / kappa: G = sqrt(G_s^2 + G_m^2).  The film, pi a b k_oil / h, is in
    series.  Holds where a spot of a race cools down between contacts: t much less than the time from ball to ball.

    Bejan, J. Heat Transfer 111 (1989) 257 (rolling contact heat transfer); Carslaw & Jaeger, Conduction of Heat in Solids, 2nd ed.,
    section 2.9 (two half-spaces); Muzychka, Yovanovich, J. Heat Transfer 123 (2001) 624 (limits of the Peclet number, joined);
    Greenwood, Wear 150 (1991) 153 (the sum of squares).  The first two formulas are derived anew; the sum of squares interpolates.
    """
    contact = semi_minor > 0.0
    a, b = np.where(contact, semi_major, 1.0), np.where(contact, semi_minor, 1.0)
    moving = _CHORDS * a * STEEL_EFFUSIVITY * np.sqrt(2.0 * b * np.abs(speed) / np.pi)
    at_rest = np.pi * STEEL_CONDUCTIVITY * a / elliptic_integrals((b / a) ** 2)[0]
    return np.where(contact, 1.0 / (1.0 / np.hypot(moving, at_rest) + film / (np.pi * a * b * oil_conductivity)), 0.0)


def oil_convection(
    shaft_speed: Number, ratio: Number, viscosity: Number, conductivity: Number, capacity: Number, ball_diameter: Number
) -> Number:
    """Heat transfer coefficient between the oil in a bearing and rings or balls [W/m2/K].

    shaft_speed : of the inner ring, the outer one stands [rad/s];  ratio : D cos(alpha) / d_m
    viscosity : kinematic [m2/s];  conductivity : [W/m/K];  capacity : heat of a volume, density times c_p [J/m3/K]
    ball_diameter : [m]

    0.0986 (n (1 - D cos(alpha)/d_m) / nu)^(1/2) k Pr^(1/3), n in r/min, Pr = nu rho c_p / k: what a laminar boundary layer has on average
    (0.664 Re^(1/2) Pr^(1/3), Pohlhausen) at the speed of the cage over a length of 1.2 d_m.  Added is 2 k / D, of a sphere in oil at rest.
    For oil-lubricated bearings with Pr above 0.6; how much of a surface oil wets is not known, and published values for jets differ
    by a factor of two.

    Eschmann, Hasbargen, Weigand, Ball and Roller Bearings, 2nd ed. (1985), as papers on spindles use it.
    """
    prandtl = viscosity * capacity / conductivity
    rate = 30.0 / np.pi * shaft_speed * (1.0 - ratio) / viscosity
    return 0.0986 * np.sqrt(rate) * conductivity * np.cbrt(prandtl) + 2.0 * conductivity / ball_diameter


#: Range of n d_m [mm r/min] of the measurements behind ``jet_oil_fraction`` that are known here.
JET_SPEEDS = (1.3e6, 3.35e6)


def jet_oil_fraction(flow: Number, speed: Number, pitch_diameter: Number) -> Number:
    """Volume of oil over that of the space around the balls of one row, 1 at most.

    flow : through the row [m3/s];  speed : of the shaft [rad/s];  pitch_diameter : [m]

    XCAV = 1e5 W^0.37 / (n d_m^1.7), in cm3/min, r/min and mm, empirical, of jet lubricated ball bearings: with it the program SHABERTH has
    their measured heat, with a law of drag as that of ``Lubricant.drag_coefficient``.  Heat of such bearings is no independent check of it.
    That it goes with 1/n means that oil stays for a number of turns, some 40.
    Its own range is not known here, for the paper was not seen.  Its bearing of 35 mm bore (d_m 46.5 mm) was run with jets of 303 to
    1894 cm3/min (Schuller) at 28 000 to 72 000 r/min: n d_m ``JET_SPEEDS``.

    Parker, NASA TP-2275 (1984), as others cite it; Schuller, Pinel, Signer, NASA TP-1732 (1980), summary.
    """
    turns = 30.0 / np.pi * np.maximum(speed, 1e-9)
    return np.minimum(1e5 * (6e7 * flow) ** 0.37 / (turns * (1e3 * pitch_diameter) ** 1.7), 1.0)


def seat_emission(diameter: Number, seats: Number, width: Number) -> Number:
    """Conductance from a ring's seat through shaft or housing to the ambient [W/K].

    diameter : of this seat [m];  seats : bore and outer diameter together [m];  width : of the ring [m]

    16 W per 50 K and 1000 mm2 of both seats, pi B (d + D), of radial bearings in machines of no particular cooling; of seats
    beyond 50 000 mm2 less.  Shafts and housings with cooling, or none, differ by several times: ``shaft_ambient`` and ``housing_ambient``
    then have to be given.

    ISO 15312 (thermal speed ratings): reference heat flow density 0.016 W/mm2 at 70 and 20 degrees.
    """
    area = np.pi * width * seats
    large = np.maximum(area / _LARGE_SEATS, 1.0) ** _LARGE_POWER
    return _EMISSION / 50.0 * large * np.pi * width * diameter
