"""Comparisons and the map of excitations."""

import os
import runpy
from pathlib import Path

import numpy as np
import pytest
from raceway_article.trends import TRENDS

from raceway import compare, sweep
from raceway.extend import read_toml

pytestmark = pytest.mark.night

ROOT = Path(__file__).parents[4]
MAP = read_toml(ROOT / "examples" / "hardening_map.toml")
AXIAL, SPEED, TILT_AXIS = "load.axial", "excitation.speed_rpm", "supports.tilt"
SPEEDS, TILT = "excitation.speed_rpm=10980:15000:5", "supports.tilt=locked,free"
FACTORS = ["excitation.kind=unidirectional,bidirectional", "excitation.amplitude=constant,unbalance", SPEEDS, TILT,
           "kinematics.ball_inertia=false,true"]  # fmt: skip


@pytest.mark.parametrize(("words", "scene", "vary"), [
    ("excitation, amplitude, speed, tilt, ball inertia", "b7206", FACTORS),
    ("rigid and condensed bodies, speed, tilt", "b7206_condensed", ["bodies.kind=rigid,condensed", SPEEDS, TILT]),
])  # fmt: skip
def test_comparison(claim, words, scene, vary):
    study = compare(read_toml(ROOT / "examples" / f"{scene}.toml"), vary)
    content = study.to_dict()
    rows = content["rows"]
    failed = sum("identification" not in row["result"] for row in rows)
    where = f"comparison over {words}"
    source = "a steady motion exists"
    claim(
        f"{where}: runs without a dynamic stiffness, of {len(rows)}", failed, at_most=0, basis="closed form", source=source
    )
    assert not study.held
    hidden = sum(not effect["resolved"] for effect in content["effects"] if len(effect["term"]) == 1)
    quantity, source = f"{where}: main effects on K and |Z| hidden by the runs' errors", "errors that the runs state"
    claim(quantity, hidden, at_most=0, basis="own other method", source=source)


def test_complete_map(claim):
    """examples/hardening_map.py."""
    axes = runpy.run_path(str(ROOT / "examples" / "hardening_map.py"))["axes"]
    begun = sum(os.times()[:4])
    points = sweep(MAP, axes, executor="processes")
    spent = sum(os.times()[:4]) - begun
    failed = int((points.status == "failed").sum())
    quantity = (
        f"map of {points.status.size} points, 50 N to 10 kN, 1000 to 60 000 r/min, 15 to 40 deg: points without a number"
    )
    claim(quantity, failed, at_most=0, basis="closed form", source="the potential of loaded rings is convex")
    quantity = "the same: processor time of all processes"
    claim(quantity, spent, at_most=60.0, unit="s", basis="regression", source="half a minute each")


def test_map_against_another_solver(claim):
    plain = {**MAP, "kinematics": {"ball_inertia": True}}
    k = sweep(plain, {TILT_AXIS: ["locked", "free"], AXIAL: [400, 1000, 2000], SPEED: [10980, 15000]}).equivalent_stiffness
    slow, fast = (k.sel({SPEED: speed}) for speed in (10980, 15000))
    first, change = [], []
    for tilt in ("locked", "free"):
        for load in (400, 1000, 2000):
            expected, ratios = TRENDS[tilt, float(load), True]
            at = {TILT_AXIS: tilt, AXIAL: load}
            first.append(1e-6 * float(slow.sel(at)) / expected - 1.0)
            change.append(float(fast.sel(at) / slow.sel(at)) / ratios[-1] - 1.0)
    where = "tilt locked and free, 400, 1000, 2000 N, centrifugal force, no ring growth"
    source = "another rigid-ring solver (packages/raceway-article/raceway_article/trends.py), which loads towards ball 0; three or four digits"
    quantity = f"k at 10 980 r/min, {where}: largest relative difference"
    claim(quantity, np.abs(first).max(), at_most=0.003, basis="other program", source=source)
    quantity = f"k(15 000 r/min) / k(10 980 r/min), {where}: largest relative difference"
    claim(quantity, np.abs(change).max(), at_most=0.0015, basis="other program", source=source)


def test_inertia_of_the_ring_alone(claim):
    """With no rotor the contacts carry m w^2 r of the ring's own 61 g besides the force."""
    axes = {TILT_AXIS: ["locked", "free"], AXIAL: [400, 2000], SPEED: [10980, 15000]}
    periodic = {**MAP, "integrator": {"kind": "periodic", "turns": 1, "steps_per_turn": 360}}
    statics, orbits = (sweep(tables, axes).equivalent_stiffness for tables in (MAP, periodic))
    quantity = "k of the map, which has no inertia of the ring: largest relative difference"
    source = "steady orbits of the ring's own 61 g: m w^2 of 0.15 N/um, and its tilt inertia, which softened tilts feel"
    claim(quantity, float(abs(orbits / statics - 1.0).max()), at_most=0.02, basis="own other method", source=source)
