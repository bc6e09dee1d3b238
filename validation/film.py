"""Films by formulas written out for one contact, a preload by hand, and rates of integrators with damped contacts.

Nothing here uses ``raceway.core.contact.film``.
"""

from __future__ import annotations

from math import atan, cos, exp, hypot, pi, sin
from typing import Any

import numpy as np
from scipy.optimize import brentq

import raceway as rw
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import simulate
from raceway.planning.plan import make_plan
from raceway.scene.tables import Scene

#: B7206C as the scenes here have it.
BALLS, DIAMETER, PITCH, CONFORMITY, ANGLE = 12, 9.525e-3, 46e-3, 0.522, pi / 12.0
OIL = {"kind": "film", "oil": "VG 32", "temperature_c": 40.0, "roughness": 1e-7}


def regimes(u: float, g: float, w: float, k: float, ratio: float) -> list[tuple[float, float]]:
    """(H_c, H_min) of the four regimes, in the order of ``raceway.core.contact.film.REGIMES``."""
    gv = g * w**3 / u**2
    rigid_viscous = 141.0 * gv**0.375 * (1.0 - exp(-0.0387 * ratio)) * (u / w) ** 2
    phi = 1.0 / (1.0 + 2.0 / (3.0 * ratio))
    rigid = 128.0 * ratio * phi * phi * (0.131 * atan(ratio / 2.0) + 1.683) ** 2 * (u / w) ** 2
    return [
        (
            2.69 * u**0.67 * g**0.53 * w ** (-0.067) * (1.0 - 0.61 * exp(-0.73 * k)),
            3.63 * u**0.68 * g**0.49 * w ** (-0.073) * (1.0 - exp(-0.68 * k)),
        ),
        (
            7.32 * (1.0 - 0.72 * exp(-0.28 * k)) * u**0.64 * w ** (-0.22),
            7.43 * u**0.65 * w ** (-0.21) * (1.0 - 0.85 * exp(-0.31 * k)),
        ),
        (rigid_viscous, rigid_viscous),
        (rigid, rigid),
    ]


def scene(contact: dict[str, Any], **tables: dict[str, Any]) -> Scene:
    """A B7206C under 1 kN and a small force that turns at 12 000 r/min, tilt locked."""
    said: dict[str, Any] = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 1000.0},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 1.0},
        "contact": contact,
        "integrator": {"kind": "newmark", "turns": 12},
    }
    return rw.Scene.from_dict({key: {**said.get(key, {}), **tables.get(key, {})} for key in {**said, **tables}})


def pair(contact: dict[str, Any], kind: str, speed_rpm: float, inertia: bool = False) -> Scene:
    """Two rows back to back with 1 kN of preload, without other loads."""
    bearing = {"arrangement": "DB", "preload": 1000.0, "preload_kind": kind}
    excitation, kinematics = {"speed_rpm": speed_rpm}, {"ball_inertia": inertia}
    return scene(contact, bearing=bearing, load={"axial": 0.0}, excitation=excitation, kinematics=kinematics)


def preload_by_hand(preload: float, factors: tuple[float, float], films: tuple[float, float]) -> float:
    """Force of two rows on each other [N] that were mounted dry under ``preload`` [N], with films that stand off [m].

    Notes
    -----
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


def springs(model: rw.Model | Any, equilibrium: Any) -> float:
    """kyy of the contacts' springs alone [N/m], of weightless balls: the tangent without the turn of the balls' forces.

    Notes
    -----
    A dashpot c = tau k damps with tau times this; the rest of the tangent, Q / s across the line of the groove centres, is
    prestress, which no dashpot has.
    """
    z = len(model.azimuth)
    force, angle = equilibrium.contact_force[:z], equilibrium.angle_inner
    centre = model.system.centre_vectors(equilibrium.displacement)[0]
    length = np.hypot(centre[:, 0], centre[:, 1])
    prestress = force / length * np.sin(angle) ** 2 * np.cos(model.azimuth) ** 2
    return float(equilibrium.stiffness[1, 1] - prestress.sum())


def motion(integrator: str, contact: dict[str, Any], steps_per_turn: int, keep: int) -> np.ndarray:
    """(n, 2) radial motion at ``keep`` samples a turn, two turns after the force was applied suddenly."""
    excitation = {"force": 200.0}
    method = {"kind": integrator, "turns": 2, "steps_per_turn": steps_per_turn, "start": "static"}
    found = scene(contact, excitation=excitation, integrator=method, rotor={"mass": 2.0}, kinematics={"ball_inertia": False})
    model = rw.build_model(found, make_plan(found))
    whole = simulate(model, settle(model)).whole
    every = len(whole.time) // (2 * keep)
    return np.asarray(whole.displacement[every - 1 :: every, 1:3])
