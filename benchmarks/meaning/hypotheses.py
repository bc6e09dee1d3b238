"""``error.model`` against whole runs under each hypothesis: 12 bearings of the catalogue at 4 speeds, and what it costs.

Loads are light and heavy, tilts locked and free, forces turning and along one direction; K passes resonances of the tilts.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below

COMMAND = "python -m benchmarks.meaning hypotheses"
BEARINGS = ["7000C", "7003A5", "B7206C", "7206A", "7008C", "7010A", "7014C", "7014A", "7020A5", "7910C", "7210A5", "7920A5"]
#: n d_m [mm r/min].
SPEEDS = (0.3e6, 0.6e6, 0.9e6, 1.2e6)
#: Axial load over the square of the ball's diameter [MPa], a ball.
LOADS = (0.4e6, 2.0e6)
OTHERS = [pair for pair in product(("none", "outer_race", "shared"), (False, True)) if pair != ("none", False)]


def scene(bearing: int, speed: int) -> rw.Scene:
    """One of the 48."""
    b = rw.Scene.from_dict({"bearing": {"preset": BEARINGS[bearing]}, "load": {"axial": 1.0}}).bearing
    axial = LOADS[(bearing + speed) % 2] * b.ball_count * b.ball_diameter**2
    size = b.pitch_diameter / 46e-3
    return rw.Scene.from_dict(
        {
            "bearing": {"preset": BEARINGS[bearing]},
            "load": {"axial": axial},
            "supports": {"tilt": ("locked", "free")[(bearing + speed) // 2 % 2]},
            "rotor": {"mass": 2.0 * size**2, "transverse_inertia": 1e-3 * size**4},
            "excitation": {
                "kind": ("bidirectional", "unidirectional")[bearing // 2 % 2],
                "speed_rpm": 1e-3 * SPEEDS[speed] / b.pitch_diameter,
                "amplitude": "constant",
                "force": (0.4 if (bearing + 2 * speed) % 3 else 0.1) * axial,
            },
            "contact": {"damping": 0.001},
        }
    )


@cache
def misses() -> list[tuple[float, float, float]]:
    """Of each scene: distance of ``error.model`` from whole runs over their spread, of K and of kyy, and change of kyy over the bound."""
    return [_miss(scene(*numbers)) for numbers in product(range(len(BEARINGS)), range(len(SPEEDS)))]


def _miss(one: rw.Scene) -> tuple[float, float, float]:
    own = rw.run(one)
    told: Any = own.model_spread[0]
    found = [
        _answers(rw.run(one.with_(kinematics={"gyroscopic": moments, "ring_growth": growth}))) for moments, growth in OTHERS
    ]
    change = (np.array(found) - _answers(own)) / np.abs(_answers(own))
    ends = np.array([np.minimum(change.min(axis=0), 0.0), np.maximum(change.max(axis=0), 0.0)])
    parts = [told["equivalent_stiffness"] or [np.nan, np.nan], told["kyy"]]
    off = np.abs(np.array(parts).T - ends).max(axis=0) / (ends[1] - ends[0])
    return float(off[0]), float(off[1]), max(map(abs, told["kyy"])) / told["bound"]


def _answers(result: Any) -> np.ndarray:
    return np.array([result.equivalent_stiffness, result.stiffness[1, 1]])


def _cpu(*works: Any, count: int = 15) -> list[float]:
    """Least processor time of each of some calls by turns, after one that warms what is kept [s]: a busy machine slows all alike."""
    times: list[list[float]] = [[] for _ in works]
    for _ in range(count + 1):
        for work, taken in zip(works, times, strict=True):
            begun = time.process_time()
            work()
            taken.append(time.process_time() - begun)
    return [min(taken[1:]) for taken in times]


def _costs() -> Iterator[Row]:
    base = rw.Scene.from_toml("examples/b7206.toml")
    dynamic = {
        "newmark": {},
        "one direction": {"excitation": {"kind": "unidirectional"}},
        "tilt free": {"supports": {"tilt": "free"}},
    }
    for name, changes in dynamic.items():
        one = base.with_(**changes)
        alone, both = _cpu(lambda one=one: rw.run(one), lambda one=one: rw.run(one).model_spread)
        yield below(f"examples/b7206.toml, {name}: run with error.model over one without", both / alone, 1.2, COMMAND)
    for name, changes in {
        "periodic": {"integrator": {"kind": "periodic"}},
        "static": {"excitation": None, "kinematics": {"spin_speed_rpm": 12e3}},
    }.items():
        one = base.with_(**changes)
        both, alone = _cpu(lambda one=one: rw.run(one).model_spread, lambda one=one: rw.run(one))
        yield below(
            f"examples/b7206.toml, {name}: error.model [ms]",
            1e3 * (both - alone),
            50.0,
            COMMAND,
            "computed when asked for, not in sweeps",
        )


def rows() -> list[Row]:
    found = np.array(misses())
    worst, stated = np.nanmax(found, axis=0), np.isfinite(found[:, 0])
    note = f"{stated.sum()} of {len(found)} scenes; median {np.median(found[stated, 0]):.1e}"
    lost = "no steady orbit is found under a hypothesis, and no range is stated: balls lift off at every turn"
    return [
        below(f"scenes of {len(found)} without a range of K", float((~stated).sum()), 0.1 * len(found), COMMAND, lost),
        below("error.model of K against whole runs, over their spread: largest", worst[0], 0.01, COMMAND, note),
        below("the same of kyy", worst[1], 0.01, COMMAND),
        below("largest change of kyy over its closed bound", worst[2], 1.0, COMMAND),
        *_costs(),
    ]
