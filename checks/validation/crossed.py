"""Random scenes, each for two integrators, and how far apart their answers are."""

import copy
from contextlib import suppress
from typing import Any

import numpy as np

from raceway import RacewayError, scene_from_dict
from raceway.testing import run

Tables = dict[str, Any]
_METHODS = ("newmark", "generalized_alpha", "central_difference", "periodic")
#: Integrators that solve for the motion itself refuse friction.
_TRANSIENTS = _METHODS[:3]
_STARTS = ("orbit", "ramp", "static")
#: One scene in four has friction.
_FRICTION = (*9 * (0.0,), 0.03, 0.1, 0.3)


def crossed(number: int) -> tuple[Tables, Tables]:
    """The same scene for two integrators: loads, speeds, masses and forces from linear response to lift-off.  With friction
    both begin differently."""
    rng = np.random.default_rng(number)

    def decades(low: float, high: float) -> float:
        return float(f"{10.0 ** rng.uniform(np.log10(low), np.log10(high)):.4g}")

    axial, friction = decades(100.0, 3000.0), float(rng.choice(_FRICTION))
    bearing: Tables = {"preset": "B7206C"}
    if rng.random() < 0.3:
        count, angle = int(rng.integers(7, 19)), float(rng.uniform(12, 40))
        bearing |= {"ball_count": count, "ball_diameter": 7.5e-3, "contact_angle_deg": angle}
    base: Tables = {
        "bearing": bearing,
        "load": {"axial": axial, "radial": [decades(1.0, 0.5 * axial) if rng.random() < 0.3 else 0.0, 0.0]},
        "supports": {"tilt": ["locked", "free", decades(1e3, 1e6)][int(rng.integers(3))]},
        "rotor": {"mass": decades(0.3, 100.0), "damping": decades(10.0, 1e4) if rng.random() < 0.6 else 0.0},
        "excitation": {"kind": str(rng.choice(["bidirectional", "unidirectional"])),
            "speed_rpm": decades(2000.0, 20000.0), "amplitude": "constant", "force": axial * decades(0.01, 0.8)},
        "contact": {"kind": "hertz", "damping": float(rng.choice([1e-3, 1.0, 100.0])), "friction": friction},
        "kinematics": {"ball_inertia": bool(rng.random() < 0.5)},
    }  # fmt: skip
    methods = rng.permutation(_TRANSIENTS if friction else _METHODS)[:2]
    starts = rng.permutation(_STARTS)[:2] if friction else rng.choice(["orbit", "orbit", "orbit", "ramp"], 2)
    pair = []
    for method, start in zip(methods, starts, strict=True):
        tables = copy.deepcopy(base)
        tables["integrator"] = {"kind": str(method)}
        if method != "periodic":
            tables["integrator"] |= {"start": str(start), "turns": int(rng.choice([8, 12, 20]))}
            if method != "central_difference":
                tables["integrator"]["steps_per_turn"] = int(rng.choice([120, 240]))
        pair.append(tables)
    return pair[0], pair[1]


def compared(number: int) -> tuple[float, float, bool] | None:
    """Friction, distance of both Z over the sum of their stated errors, and whether several steady motions are told.

    None where a run fails or states no error.  That friction remembers its start, or that an orbit is unstable, tells of no others.
    """
    pair = crossed(number)
    with suppress(RacewayError):
        first, second = (run(scene_from_dict(tables)) for tables in pair)
        totals = first.error["total"], second.error["total"]
        if None in totals:
            return None
        z, other = (one.identification.dynamic_stiffness for one in (first, second))
        distance = abs(z - other) / (totals[0] * abs(z) + totals[1] * abs(other))
        told = any("steady motions that are not unstable exist" in text for text in (*first.warnings, *second.warnings))
        return pair[0]["contact"]["friction"], distance, told
    return None
