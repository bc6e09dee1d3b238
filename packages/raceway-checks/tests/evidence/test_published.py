"""Published numbers and closed forms.

Frames and normalisations stand with each case in packages/raceway-checks/raceway_checks/data/cases.json, how each is computed in raceway/studies/verify.
"""

from functools import cache

import pytest
from raceway_checks.verify.study import COMPUTED, verify


@cache
def numbers(start: str):
    """Every number of the cases whose names begin so."""
    found = verify(only=[name for name in COMPUTED if name.startswith(start)]).rows
    assert all(row.computed is not None for row in found), [row.note for row in found if row.computed is None]
    return found


def largest(case: str, words: str | tuple[str, ...], count: int, tolerance: float) -> float:
    """Largest relative error of the so many numbers of a case whose quantity begins so.  The command must hold each of them
    against the limit that stands here."""
    chosen = [row for row in numbers(case) if row.quantity.startswith(words)]
    assert len(chosen) == count and {row.tolerance for row in chosen} == {tolerance}
    return max(row.error for row in chosen)


@pytest.mark.parametrize(("case", "preloads", "axial", "why"), [
    ("7206C", 4, 0.04, "the conformity is fitted to its eight numbers and those of 7206A5, which it meets within 3.6 %"),
    ("7206A", 3, 0.01, "not in that fit; two or three printed digits"),
])  # fmt: skip
def test_stiffness_of_pairs(claim, case, preloads, axial, why):
    """A pair as the scene of a pair and as twice the tangent of one row, tilts locked."""
    for direction, limit, reason in (
        ("axial", axial, why),
        ("radial", 0.08, "printed as a rounded factor times the axial one"),
    ):
        error = largest(f"nsk-{case}-stiffness", f"{direction} stiffness", 2 * preloads, limit)
        quantity = f"NSK {case}, {direction} stiffness of a pair at {preloads} preloads: largest relative error"
        claim(quantity, error, at_most=limit, basis="published", source=f"NSK, super-precision bearings: {reason}")


def test_displacements_of_a_deep_groove_bearing(claim):
    words = ("radial", "axial", "tilt")
    error = max(largest(f"masta-dgbb-{case}", words, count, 1e-4) for case, count in ((1, 1), (3, 1), (5, 3)))
    quantity = "7-ball deep-groove bearing, three load cases: displacements and tilt: largest relative error"
    source = "MASTA, in github.com/minzhun/ISO16281: printed digits, and curvatures at a contact angle of zero, worth 4e-5"
    claim(quantity, error, at_most=1e-4, basis="other program", source=source)


def test_reference_lives_of_a_deep_groove_bearing(claim):
    error = largest("masta-dgbb", "reference life", 3, 1e-4)
    quantity = "7-ball deep-groove bearing, three load cases: reference life of ISO/TS 16281: largest relative error"
    claim(
        quantity, error, at_most=1e-4, basis="other program", source="MASTA, in github.com/minzhun/ISO16281: printed digits"
    )


def test_ellipses(claim):
    error = largest("harris-mindel-1973-hertz-inner", "", 4, 5e-5)
    quantity = "ellipse, approach and pressure of an inner race at 24 000 r/min: largest relative error"
    claim(quantity, error, at_most=5e-5, basis="published", source="Harris & Mindel (1973), Fig. 15: five printed digits")
    error = largest("harris-table-6.1", "", 63, 4e-4)
    quantity = "a*, b*, delta* at 21 curvature differences: largest relative error"
    source = "Harris & Kotzalas, Essential Concepts, Table 6.1: four digits, and the table's own numerical error"
    claim(quantity, error, at_most=4e-4, basis="published", source=source)


def test_impacts_of_spheres(claim):
    where = "impacts of Chung & Ooi (2011), glass pair and alumina on a plane"
    cases, names = ("chung-ooi-1-glass", "chung-ooi-3-alumina"), ("newmark", "generalized_alpha", "central_difference")
    words = ("peak force, closed", "largest approach, closed", "contact time, closed")
    error = max(largest(case, word, 1, 1e-5) for case in cases for word in words)
    quantity = f"{where}: force, approach and time by Hertz's formulas: largest relative error"
    claim(quantity, error, at_most=1e-5, basis="closed form", source="six printed digits")
    words = tuple(f"{what}, {name}" for what in ("peak force", "contact time") for name in names)
    error = max(largest(case, word, 1, 1e-3) for case in cases for word in words)
    quantity = f"{where}: force and time by three integrators: largest relative error"
    source = "100 steps a contact: second order, and a peak that is the largest sample (1e-4)"
    claim(quantity, error, at_most=1e-3, basis="closed form", source=source)


def test_force_of_the_rig(claim):
    error = largest("seed-unbalance", "", 24, 1e-5)
    quantity = "rotating force of 7.1 g at 90 mm, both excitations, 10 980 to 15 000 r/min: largest relative error"
    source = "m e w^2, half of it on each of two bearings (Lubricants 2026, 14(3), 128): six digits"
    claim(quantity, error, at_most=1e-5, basis="closed form", source=source)


@pytest.mark.night
def test_peak_pressure_of_finite_elements(claim):
    where = "B7206C, peak pressure of finite elements"
    source = "Lubricants 2026, 14(3), 128, section 3.2: the largest deviation of ABAQUS from MESYS there"
    error = largest("seed-static-pressures", "peak pressure", 8, 0.0242)
    quantity = f"{where}: largest relative error against Hertz in the equilibrium of rigid rings"
    claim(quantity, error, at_most=0.0242, basis="own other method", source=source)
    error = largest("seed-static-pressures", "mesh independence", 2, 0.01)
    quantity = f"{where}: coarse against fine mesh, largest relative difference"
    claim(quantity, error, at_most=0.01, basis="own other method", source="the same, its mesh independence")
