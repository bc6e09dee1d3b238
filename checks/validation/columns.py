"""Random scenes whose points are computed by the compiled loops and by runs of their own: the largest difference between the two."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import attrs
import numpy as np

import raceway as rw
from raceway import ConvergenceError, scene_from_dict
from raceway.extend import continuous_keys, registry_with, resolve
from raceway.planning.columns import why_no_column
from raceway.points.column_quantities import of_result

_BEARINGS: list[dict[str, Any]] = [
    {"preset": "B7206C"},
    {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "row_distance": 0.016},
    {"preset": "B7206C", "arrangement": "DF", "preload": 200.0, "second_preload": 350.0, "row_distance": 0.016},
    {"preset": "B7206C", "arrangement": "DT", "row_distance": 0.016},
    {"ball_diameter": 7.94e-3, "pitch_diameter": 39.04e-3, "ball_count": 9, "conformity_inner": 0.515, "conformity_outer": 0.53,
     "radial_clearance": 10e-6, "bore": 25e-3, "outer_diameter": 52e-3, "width": 15e-3},
]  # fmt: skip
_LAWS: list[dict[str, Any]] = [
    {"kind": "hertz"}, {"kind": "penalty"}, {"kind": "penalty", "calibrate_at": 120.0}, {"kind": "hertz", "damping": 0.01},
    {"kind": "hertz", "time_constant": 2e-6}, {"kind": "film", "oil": "VG 32", "temperature_c": 60.0},
    {"kind": "film", "viscosity": 0.02, "damping": 0.01}, {"kind": "stiffening"}, {"kind": "oil_layer"},
]  # fmt: skip
#: Keys with the ranges of their numbers.
_RANGES: dict[str, tuple[float, float]] = {
    "load.axial": (150.0, 2500.0), "load.radial[0]": (-60.0, 60.0), "load.moment[1]": (-0.3, 0.3),
    "bearing.conformity_inner": (0.508, 0.54), "bearing.conformity_outer": (0.51, 0.54),
    "bearing.contact_angle_deg": (12.0, 30.0), "bearing.preload": (100.0, 900.0), "bearing.rings.young": (1.9e11, 2.2e11),
    "bearing.balls.young": (2.0e11, 3.2e11), "bearing.balls.density": (3000.0, 7900.0),
    "bearing.ball_diameter": (6.0e-3, 7.0e-3), "mounting.inner_temperature": (0.0, 15.0),
    "mounting.shaft_interference": (0.0, 8e-6), "kinematics.radial_expansion": (0.0, 3e-6), "supports.tilt": (1e3, 1e6),
    "contact.temperature_c": (20.0, 100.0), "contact.viscosity": (0.005, 0.1), "contact.starvation": (0.3, 1.0),
    "contact.cubic": (1e16, 1e18), "contact.thickness": (5e-8, 5e-7), "contact.calibrate_at": (50.0, 200.0),
}  # fmt: skip
_REGISTRY = registry_with([Path(__file__).with_name("laws.py")])
_OUTPUTS = ("displacement", "stiffness", "largest_ball_load", "ball_load")
_MOTION = ("z_real", "z_imag", "equivalent_stiffness", "forward_amplitude", "largest_multiplier")


@attrs.frozen
class Case:
    """A scene, its inputs with their columns, and what is asked for."""

    scene: rw.Scene
    columns: dict[str, np.ndarray]
    outputs: tuple[str, ...]


def case(seed: int, points: int = 4) -> Case:
    """A random one."""
    rng = np.random.default_rng(seed)
    bearing, law = dict(_BEARINGS[rng.integers(len(_BEARINGS))]), dict(_LAWS[rng.integers(len(_LAWS))])
    tilt: Any = rng.choice(["locked", "free", "spring"])
    moving = bool(rng.integers(2))
    ring_growth = bool(rng.integers(2)) and "bore" not in bearing
    tables: dict[str, Any] = {
        "bearing": bearing,
        "contact": law,
        "load": {"axial": 800.0, "radial": [0.0, 0.0], "moment": [0.0, 0.0]},
        "supports": {"tilt": 2e4 if tilt == "spring" else str(tilt)},
        "rotor": {"mass": 1.0, "damping": 20.0},
        "kinematics": {
            "ball_inertia": bool(rng.integers(4)), "ring_growth": ring_growth, "ball_growth": bool(rng.integers(2)),
        },
    }  # fmt: skip
    if tables["kinematics"]["ball_inertia"] and rng.integers(2):
        tables["kinematics"]["gyroscopic"] = str(rng.choice(["outer_race", "shared"]))
    if "preset" in bearing and not seed % 4:
        mesh = {"kind": "structured", "element_size": 2.5e-3, "nodes_per_semi_axis": 1}
        tables |= {"bodies": {"kind": "condensed"}, "mesh": mesh}
    if moving:
        kind = str(rng.choice(["unidirectional", "bidirectional"]))
        tables["excitation"] = {"kind": kind, "speed_rpm": 9000.0, "unbalance": 2e-5}
        tables["integrator"] = {"kind": "periodic", "tolerance": 1e-10}
    else:
        tables["kinematics"]["spin_speed_rpm"] = 9000.0
    scene = scene_from_dict(tables, _REGISTRY)
    speed = "excitation.speed_rpm" if moving else "kinematics.spin_speed_rpm"
    ranges = {**_RANGES, speed: (1000.0, 18_000.0)} | ({"excitation.unbalance": (1e-6, 5e-5)} if moving else {})
    problem = resolve(scene)
    keys = [key for key in ranges if _has(scene, key, ring_growth) and not why_no_column(problem, key)]
    chosen = sorted(rng.choice(keys, size=min(len(keys), int(rng.integers(1, 6))), replace=False).tolist())
    columns = {key: rng.uniform(*ranges[key], size=points) for key in chosen}
    return Case(scene, columns, (*_OUTPUTS, *(_MOTION if moving else ())))


def _has(scene: rw.Scene, key: str, ring_growth: bool) -> bool:
    """Whether a scene has the key and lets it vary alone."""
    b = scene.bearing
    if key.startswith("bearing.") and ring_growth:
        return False  # the growth of each ring is solved for on its own section
    if key == "bearing.preload":
        return b.preload > 0.0
    if key == "bearing.contact_angle_deg":
        return b.contact_angle_deg is not None
    if key == "bearing.ball_diameter":
        return b.radial_clearance is None
    if key == "supports.tilt":
        return isinstance(scene.supports.tilt, float)
    return not key.startswith("contact.") or key in {known.path for known in continuous_keys(scene)}


@attrs.frozen
class Comparison:
    """Points of random cases beside runs.

    worst : largest relative difference of all numbers but the displacement;  moved : of that
    status : how many points are computed, run, refused or failed, and which a run does not solve, "ONLY_COMPUTED"
    seconds : processor time
    """

    worst: float
    moved: float
    status: Counter[str]
    seconds: float

    @classmethod
    def of(cls, seed: int) -> Comparison:
        """Of one random case."""
        c, worst, moved, start = case(seed), 0.0, 0.0, time.process_time()
        f = rw.function(c.scene, c.columns, c.outputs, tolerance=3e-10, threads=1)
        answer = f(**c.columns)
        status = [rw.PointStatus(number).name for number in answer["status"]]
        for row in np.flatnonzero(answer["status"] == rw.PointStatus.COMPUTED):
            try:
                result = rw.run(f.scene_at({key: column[row] for key, column in c.columns.items()}))
            except ConvergenceError:
                status[row] = "ONLY_COMPUTED"
                continue
            for name in c.outputs:
                value = np.asarray(of_result(name, result))
                # Without damping Im Z is what rounding leaves of Z.
                size = abs(result.identification.dynamic_stiffness) if name in ("z_real", "z_imag") else np.abs(value).max()
                if name == "largest_multiplier":
                    size *= 1e3  # a run's mesh gives it to 1e-6
                off = float(np.abs(answer[name][row] - value).max() / size)
                worst, moved = (worst, max(moved, off)) if name == "displacement" else (max(worst, off), moved)
        return cls(worst, moved, Counter(status), time.process_time() - start)


def compare(seeds: Iterable[int], processes: int = 1) -> Comparison:
    """Random cases, shared among processes."""
    if processes > 1:
        with ProcessPoolExecutor(processes) as pool:
            parts = list(pool.map(Comparison.of, seeds, chunksize=10))
    else:
        parts = list(map(Comparison.of, seeds))
    status = sum((part.status for part in parts), Counter[str]())
    worst, moved = max(part.worst for part in parts), max(part.moved for part in parts)
    return Comparison(worst, moved, status, sum(part.seconds for part in parts))
