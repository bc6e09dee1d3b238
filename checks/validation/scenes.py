"""Scenes that several reports share."""

from typing import Any

import numpy as np

from raceway import Result, run
from raceway.testing import Model, b7206c, default_registry

#: The rig's unbalance, 7.1 g at 90 mm; two bearings carry half of its force each.
UNBALANCE = 7.1e-3 * 0.09
SHARE = 0.5


def built_in(kind: str, name: str) -> Any:
    """The class of a plug-in, as the registry finds it."""
    return default_registry().find(kind, name).plugin


def rig_force(speed_rpm: float) -> float:
    """Force on one bearing [N]."""
    return SHARE * UNBALANCE * (speed_rpm * np.pi / 30.0) ** 2


def static(axial: float, tilt: str, radial: float = 0.0, spin_rpm: float = 0.0, inertia: bool = False) -> dict[str, Any]:
    """A static B7206C with a radial load towards ball 0."""
    load, kinematics = {"axial": axial, "radial": [radial, 0.0]}, {"ball_inertia": inertia, "spin_speed_rpm": spin_rpm}
    return b7206c(title="static", supports={"tilt": tilt}, load=load, kinematics=kinematics)


def rotating(axial: float, tilt: str, speed_rpm: float, inertia: bool, integrator: str) -> dict[str, Any]:
    """The rig's rotating unbalance on a B7206C with 2 kg and the article's damping, 12 turns."""
    force = {"kind": "bidirectional", "speed_rpm": speed_rpm, "amplitude": "unbalance", "unbalance": UNBALANCE}
    return b7206c(
        title="rotating", supports={"tilt": tilt}, rotor={"mass": 2.0}, load={"axial": axial}, contact={"damping": 0.001},
        excitation=force | {"load_share": SHARE}, kinematics={"ball_inertia": inertia},
        integrator={"kind": integrator, "turns": 12},
    )  # fmt: skip


_BALL = 9.525e-3


def small_force(identifier: str, integrator: str, share: float, changes: dict[str, Any] | None = None) -> Result:
    """A run at 12 000 r/min under a force along one direction of a share of 400 N."""
    force = {"kind": "unidirectional", "amplitude": "constant", "force": 400.0 * share, "speed_rpm": 12000.0}
    tables: dict[str, Any] = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "supports": {"tilt": "locked"}}
    tables |= {"kinematics": {"spin_speed_rpm": 12000.0}, "excitation": force}
    tables |= {"integrator": {"kind": integrator}, "identifier": {"kind": identifier}}
    return run(tables | {name: tables.get(name, {}) | table for name, table in (changes or {}).items()})


def random_tables(rng: np.random.Generator, law: str = "hertz") -> dict[str, Any]:
    """A random bearing under random loads, in the ranges that the report ``rigid`` names."""
    count = int(rng.integers(3, 61))
    pitch = max(46e-3, 1.05 * _BALL / np.sin(np.pi / count))
    axial = 10.0 ** rng.uniform(0.0, 5.0)
    radial, direction = axial * rng.uniform(0.0, 5.0), rng.uniform(0.0, 2.0 * np.pi)
    bearing: dict[str, Any] = {
        "ball_diameter": _BALL, "pitch_diameter": float(pitch), "ball_count": count,
        "conformity_inner": float(rng.uniform(0.505, 0.55)), "conformity_outer": float(rng.uniform(0.505, 0.55)),
        "first_ball_azimuth_deg": float(rng.uniform(0.0, 360.0)),
    }  # fmt: skip
    if rng.random() < 0.25:
        bearing["radial_clearance"] = float(rng.uniform(2e-6, 40e-6))
    else:
        bearing["contact_angle_deg"] = float(rng.uniform(10.0, 40.0))
    moment = rng.normal(size=2) * axial * pitch / 4.0 if rng.random() < 1.0 / 3.0 else np.zeros(2)
    return {
        "title": "random", "bearing": bearing,
        "supports": {"tilt": ["locked", "free", float(10.0 ** rng.uniform(2.0, 7.0))][int(rng.integers(3))]},
        "load": {"axial": float(axial), "radial": [float(radial * np.cos(direction)),
            float(radial * np.sin(direction))], "moment": [float(part) for part in moment]},
        "kinematics": {"ball_inertia": bool(rng.random() < 0.75), "spin_speed_rpm": float(rng.uniform(0.0, 1e5)),
            "gyroscopic": "none", "ring_growth": False},
        "contact": {"kind": law},
    }  # fmt: skip


def imbalance(model: Model, q: np.ndarray, ball: np.ndarray | None = None) -> float:
    """Largest force out of balance over the sum of the inner races' forces and loads; moments over the arm."""
    system = model.system
    now = system.evaluate(q, ball=ball)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])
    rest = (now.force + system.stiffness @ q - system.load) * system.free * weight
    size = now.contact_force[: model.geometry.ball_count].sum() + np.abs(system.load * weight).sum()
    return float(np.abs(rest).max() / size)
