"""Comparisons and the map: both excitations, amplitude laws, speed, tilt, axial load, contact angle, rigid and elastic bodies."""

from __future__ import annotations

import resource
from pathlib import Path

import numpy as np
import pytest

from raceway.framework.registry import default_registry
from raceway.scene.file import read_toml
from raceway.studies.article.expected import TRENDS
from raceway.studies.compare.study import compare
from raceway.studies.map.design import ANGLE, AXIAL, SPEED, design
from raceway.studies.map.study import study_map

pytestmark = pytest.mark.night

ROOT = Path(__file__).parents[2]
MAP = read_toml(ROOT / "raceway" / "data" / "map.toml")
SPEEDS, TILT = "excitation.speed_rpm=10980:15000:5", "supports.tilt=locked,free"
FACTORS = ["excitation.kind=unidirectional,bidirectional", "excitation.amplitude=constant,unbalance", SPEEDS, TILT,
           "kinematics.ball_inertia=false,true"]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "scene", "vary"),
    [
        ("excitation, amplitude, speed, tilt, ball inertia", "b7206", FACTORS),
        ("rigid and condensed bodies, speed, tilt", "b7206_condensed", ["bodies.kind=rigid,condensed", SPEEDS, TILT]),
    ],
)
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


def cpu() -> float:
    """Processor time of this process and of those that have ended [s]."""
    return sum(
        used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )


def mapped(tables, *vary, method="quasi_static", workers=1):
    registry = default_registry()
    return study_map(design(tables, vary, method, registry), workers, registry=registry)


def test_complete_map(claim):
    begun = cpu()
    study = mapped(MAP, workers=2)
    spent = cpu() - begun
    failed = sum(row["status"] != "completed" for row in study.rows)
    quantity = f"map of {len(study.rows)} points, 50 N to 10 kN, 1000 to 60 000 r/min, 15 to 40 deg: points without a number"
    claim(quantity, failed, at_most=0, basis="closed form", source="the potential of loaded rings is convex")
    claim(
        "the same: processor time of both processes",
        spent,
        at_most=60.0,
        unit="s",
        basis="regression",
        source="half a minute each",
    )


def test_map_against_another_solver(claim):
    plain = {**MAP, "kinematics": {"ball_inertia": True}}
    study = mapped(plain, f"{AXIAL}=400,1000,2000", f"{SPEED}=10980,15000", f"{ANGLE}=15")
    assert len(study.curves) == 6
    known = [TRENDS[curve["tilt"], float(curve["axial"]), True] for curve in study.curves]
    first = [1e-6 * curve["first_stiffness"] / k - 1.0 for curve, (k, _) in zip(study.curves, known, strict=True)]
    change = [
        (1.0 + curve["last_change"]) / ratios[-1] - 1.0 for curve, (_, ratios) in zip(study.curves, known, strict=True)
    ]
    where = "tilt locked and free, 400, 1000, 2000 N, centrifugal force, no ring growth"
    source = (
        "another rigid-ring solver (raceway/studies/article/expected.py), which loads towards ball 0; three or four digits"
    )
    quantity = f"k at 10 980 r/min, {where}: largest relative difference"
    claim(quantity, np.abs(first).max(), at_most=0.003, basis="other program", source=source)
    quantity = f"k(15 000 r/min) / k(10 980 r/min), {where}: largest relative difference"
    claim(quantity, np.abs(change).max(), at_most=0.0015, basis="other program", source=source)


def test_inertia_of_the_ring_alone(claim):
    """With no rotor the contacts carry m w^2 r of the ring's own 61 g besides the force."""
    vary = (f"{AXIAL}=400,2000", f"{SPEED}=10980,15000", f"{ANGLE}=15")
    both = [mapped(MAP, *vary, method=method).rows for method in ("quasi_static", "periodic")]
    change = max(abs(b["stiffness"] / a["stiffness"] - 1.0) for a, b in zip(*both, strict=True))
    quantity = "k of the map, which has no inertia of the ring: largest relative difference"
    source = "steady orbits of the ring's own 61 g: m w^2 of 0.15 N/um, and its tilt inertia, which softened tilts feel"
    claim(quantity, change, at_most=0.02, basis="own other method", source=source)
