"""Films by formulas written out for one contact, a preload by hand, and rates of integrators with damped contacts.

Nothing here uses ``raceway.core.contact.film``.
"""

from math import atan, cos, exp, hypot, pi, sin
from typing import Any

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import raceway as rw
from raceway import Scene
from raceway.testing import b7206c

#: B7206C as the scenes here have it.
BALLS, DIAMETER, PITCH, CONFORMITY, ANGLE = 12, 9.525e-3, 46e-3, 0.522, pi / 12.0
#: Mineral oils: viscosity [mPa s] at 30, 60 and 100 C, pressure-viscosity coefficient [1e-9/Pa] there; Stachowiak and Batchelor,
#: Engineering Tribology, table 2.3.
MEASURED = (
    ((38.0, 12.1, 5.3), (None, 18.4, 13.4)), ((153.0, 34.0, 9.1), (23.7, 20.5, 15.8)), ((250.0, 50.5, 12.6), (25.0, 21.3, 17.6)),
    ((810.0, 135.0, 26.8), (34.0, 28.0, 22.0)), ((18.6, 6.3, 2.4), (20.0, 16.0, 13.0)), ((45.0, 12.0, 3.9), (28.0, 20.0, 16.0)),
    ((107.0, 23.3, 6.4), (29.6, 22.8, 17.8)), ((122.0, 26.3, 7.3), (27.0, 21.6, 17.5)), ((171.0, 31.0, 7.5), (28.0, 23.0, 18.0)),
    ((30.7, 8.6, 3.1), (25.7, 20.3, 15.4)), ((165.0, 30.0, 6.8), (33.0, 23.8, 16.0)), ((310.0, 44.2, 9.4), (34.6, 26.3, 19.5)),
    ((2000.0, 180.0, 24.0), (41.5, 29.4, 25.0)),
)  # fmt: skip
#: Path [m] and printed h_min [µm] of a steel ball of 30 mm that rolls down a plate at 45 degrees in oil of 50 mPa s, 2.2e-8 1/Pa: an
#: exercise in the notation of Stachowiak and Batchelor (R' = R/2, u = v/2, k = 1.0339), which takes the contact for
#: piezoviscous-elastic throughout.  After 1 m the contact is light and fast, and its isoviscous-rigid film, 0.626 µm, is thicker:
#: the exercise's answer is not that of the four regimes.
ROLLED = ((0.01, "0.059"), (1.0, "0.281"))
OIL = {"kind": "film", "oil": "VG 32", "temperature_c": 40.0, "roughness": 1e-7}
#: A DB pair that carries 1000 N at 18 000 r/min when it is dry; an isothermal film of VG 32 adds two thirds.
SPINDLE = {"preset": "7014C", "arrangement": "DB", "preload": 300.0}


def regimes(u: float, g: float, w: float, k: float, ratio: float) -> list[tuple[float, float]]:
    """(H_c, H_min) of the four regimes, in the order of ``raceway.core.contact.film.REGIMES``."""
    gv = g * w**3 / u**2
    rigid_viscous = 141.0 * gv**0.375 * (1.0 - exp(-0.0387 * ratio)) * (u / w) ** 2
    phi = 1.0 / (1.0 + 2.0 / (3.0 * ratio))
    rigid = 128.0 * ratio * phi * phi * (0.131 * atan(ratio / 2.0) + 1.683) ** 2 * (u / w) ** 2
    hard = 2.69 * u**0.67 * g**0.53 * w ** (-0.067) * (1.0 - 0.61 * exp(-0.73 * k))
    hard_least = 3.63 * u**0.68 * g**0.49 * w ** (-0.073) * (1.0 - exp(-0.68 * k))
    soft = 7.32 * (1.0 - 0.72 * exp(-0.28 * k)) * u**0.64 * w ** (-0.22)
    soft_least = 7.43 * u**0.65 * w ** (-0.21) * (1.0 - 0.85 * exp(-0.31 * k))
    return [(hard, hard_least), (soft, soft_least), (rigid_viscous, rigid_viscous), (rigid, rigid)]


def rolled(path: float) -> dict[str, Any]:
    """What ``raceway.core.contact.film.film`` takes of the ball of ``ROLLED``, after a path [m]."""
    young, radius, slope = 2.1e11 / (1.0 - 0.3**2), 0.015, sin(pi / 4.0)
    load = 7800.0 * 4.0 / 3.0 * pi * radius**3 * 9.81 * slope
    speed = 0.5 * (10.0 / 7.0 * 9.81 * path * slope) ** 0.5
    # Theirs is the reduced radius of both directions, half of the ball's.
    told = {
        "viscous": 0.05 * speed, "modulus": young, "along": radius / 2.0, "across": radius / 2.0, "load": load, "k": 1.0339,
    }  # fmt: skip
    return {"alpha": 2.2e-8, **{name: np.array([value]) for name, value in told.items()}}


def rolled_by_regime(path: float) -> list[float]:
    """h_min [µm] of the same ball by each of ``regimes``."""
    alpha, *rest = rolled(path).values()
    viscous, modulus, radius, _, load, k = (float(one[0]) for one in rest)
    each = regimes(viscous / (modulus * radius), alpha * modulus, load / (modulus * radius**2), k, 1.0)
    return [1e6 * radius * minimum for _, minimum in each]


def inlet_film(loading: float) -> float:
    """Film over the isothermal one by integration of the inlet, of a thermal loading L.

    Grubin's inlet: beside a Hertz contact the gap is h = h0 (1 + z^1.5), the reduced pressure Q = 1 - e^(-alpha p) rises from 0 to
    1, and the flow that is turned back heats the oil, dQ/dz = A (H - 1) / H^3 / (1 + 0.5 F^0.85) with
    F = L / (1 - Q) ((H - 1) / H)^2.  A is proportional to h0^(-4/3) at one speed and load.
    Wilson, Sheu, J. Lubr. Technol. 105 (1983) 187, equations 1 to 3, for surfaces of one speed.
    """

    def rise(slope: float) -> float:
        def along(z: float, q: np.ndarray) -> list[float]:
            bend = z**1.5 / (1.0 + z**1.5)
            heat = loading / max(1.0 - float(q[0]), 1e-12) * bend**2
            return [-slope * bend / (1.0 + z**1.5) ** 2 / (1.0 + 0.5 * heat**0.85)]

        # Q that has come to 1 stays there: what is looked for is the least slope that brings it there.
        end = float(solve_ivp(along, (400.0, 0.0), [0.0], rtol=1e-7, atol=1e-9, method="LSODA").y[0, -1])
        return end - (1.0 - 1e-8) if end < 1.0 - 1e-8 else 1.0

    cold = 1.0 / quad(lambda z: z**1.5 / (1.0 + z**1.5) ** 3, 0.0, np.inf)[0]
    hot = brentq(rise, 0.99 * cold, 60.0 * cold, xtol=1e-5 * cold)
    return float((cold / hot) ** 0.75)


def skf_reduction(speed_rpm: float, diameter: float, viscosity: float) -> float:
    """SKF's factor of the heat of the inlet in its friction moment.

    diameter : mean, of bore and outside [m];  viscosity : kinematic, running [m2/s]
    SKF, Rolling bearings, general catalogue: phi_ish = 1 / (1 + 1.84e-9 (n d_m)^1.28 nu^0.64), n in r/min, d_m in mm, nu in mm2/s.
    """
    return float(1.0 / (1.0 + 1.84e-9 * (speed_rpm * 1e3 * diameter) ** 1.28 * (1e6 * viscosity) ** 0.64))


def scene(contact: dict[str, Any], **tables: dict[str, Any]) -> Scene:
    """A B7206C under 1 kN and a small force that turns at 12 000 r/min, tilt locked."""
    force = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 1.0}
    said: dict[str, Any] = b7206c(excitation=force, contact=contact, integrator={"kind": "newmark", "turns": 12})
    return rw.Scene.from_dict(said | {key: {**said.get(key, {}), **table} for key, table in tables.items()})


def pair(contact: dict[str, Any], kind: str, speed_rpm: float, inertia: bool = False) -> Scene:
    """Two rows back to back with 1 kN of preload, without other loads."""
    bearing = {"arrangement": "DB", "preload": 1000.0, "preload_kind": kind}
    excitation, kinematics = {"speed_rpm": speed_rpm}, {"ball_inertia": inertia}
    return scene(contact, bearing=bearing, load={"axial": 0.0}, excitation=excitation, kinematics=kinematics)


def preload_by_hand(preload: float, factors: tuple[float, float], films: tuple[float, float]) -> float:
    """Force of two rows on each other [N] that were mounted dry under ``preload`` [N], with films that stand off [m].

    Of balls without mass: F = Z Q sin(a), Q = K_n (s - B + h_i + h_o)^1.5 with the length s of the line of the groove centres,
    whose axial part the mounting holds.
    """
    distance = (2.0 * CONFORMITY - 1.0) * DIAMETER
    series = sum(one ** (-2.0 / 3.0) for one in factors) ** -1.5

    def force(x: float, off: float) -> float:
        axial, radial = distance * sin(ANGLE) + x, distance * cos(ANGLE)
        length = hypot(axial, radial)
        return BALLS * series * max(length - distance + off, 0.0) ** 1.5 * axial / length

    mounted = brentq(lambda x: force(x, 0.0) - preload, 0.0, 1e-4, xtol=1e-15)
    return force(mounted, sum(films))


def springs(model: Any, equilibrium: Any) -> float:
    """kyy of the contacts' springs alone [N/m], of weightless balls: the tangent without the turn of the balls' forces.

    A dashpot c = tau k damps with tau times this; the rest of the tangent, Q / s across the line of the groove centres, is
    prestress, which no dashpot has.
    """
    z = len(model.azimuth)
    force, angle = equilibrium.contact_force[:z], equilibrium.angle_inner
    centre = model.system.centre_vectors(equilibrium.displacement)[0]
    length = np.hypot(centre[:, 0], centre[:, 1])
    prestress = force / length * np.sin(angle) ** 2 * np.cos(model.azimuth) ** 2
    return float(equilibrium.stiffness[1, 1] - prestress.sum())
