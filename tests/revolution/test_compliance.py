"""Compliances by harmonics against full three-dimensional solves, and their symmetries."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import MeshError
from raceway.core.revolution.body import Revolution, seat_areas
from raceway.core.revolution.harmonics import solved_harmonics
from raceway.core.revolution.profile import dofs
from tests.revolution.sections import STEEL, ball, ring
from validation.reference.swept import Swept

DIVISIONS = 16
ALL = (0, 1, 2)


def difference(found: np.ndarray, swept: Swept, solve, node: int) -> float:
    """Largest difference from the full solve over all directions of the load, relative to the largest displacement."""
    race = swept.profile.race
    worst = 0.0
    for component in ALL:
        full = swept.seen(solve(swept.force(int(race[node]), component)), race)
        column = found[:, :, component * len(race) + node]
        worst = max(worst, float(np.abs(full - column).max() / np.abs(full).max()))
    return worst


@pytest.mark.parametrize("inner", [True, False])
@pytest.mark.parametrize("formulation", ["incompatible", "full", "one_point"])
def test_a_clamped_ring_equals_the_full_solve(inner, formulation):
    profile = ring(inner)
    body = Revolution(profile, DIVISIONS, *STEEL, formulation)
    at = dofs(profile.race, ALL)
    found = body.compliance(at, at, harmonics="all")
    swept = Swept(profile, DIVISIONS, formulation)
    # Two factorisations of well-conditioned systems: rounding only.
    assert difference(found, swept, swept.clamped, 1) < 1e-10


def test_a_ring_on_a_bed_equals_the_full_solve():
    profile, bed = ring(False), 5e11
    body = Revolution(profile, DIVISIONS, *STEEL, seat=bed)
    at = dofs(profile.race, ALL)
    found = body.compliance(at, at, harmonics="all")
    swept = Swept(profile, DIVISIONS)
    areas = seat_areas(profile, DIVISIONS)
    assert DIVISIONS * areas.sum() == pytest.approx(2.0 * np.pi * 31e-3 * 16e-3, rel=1e-12)  # the exact cylinder
    assert difference(found, swept, lambda f: swept.bedded(f, areas, bed), 1) < 1e-10


def test_a_stiff_bed_is_a_clamp():
    profile = ring(False)
    at = dofs(profile.race)
    held, bedded = (Revolution(profile, DIVISIONS, *STEEL, seat=seat).compliance(at, at) for seat in ("clamped", 1e19))
    # The bed gives way by 1 / (1e19 N/m3 times some mm2), 1e-5 of a contact's compliance.
    assert np.abs(held - bedded).max() < 1e-4 * np.abs(held).max()


def test_a_floating_ball_equals_the_full_solve():
    profile = ball()
    body = Revolution(profile, DIVISIONS, *STEEL, seat="free")
    at = dofs(profile.race, ALL)
    found = body.compliance(at, at, harmonics="all")
    swept = Swept(profile, DIVISIONS)
    # Rounding, and the digits that a body held at three points loses.
    assert difference(found, swept, swept.floating, 1) < 1e-9


def test_a_balanced_pair_leaves_the_masses_where_they_are():
    """Two opposite forces on a free ball: the mass-weighted mean motion of the compliance is none, by its definition."""
    profile = ball()
    body = Revolution(profile, 12, *STEEL, seat="free")
    every = dofs(np.arange(len(profile.points)), ALL)
    middle = np.array([[profile.race[len(profile.race) // 2], 0]])
    u = body.compliance(middle, every, harmonics="all")[:, :, 0].reshape(12, 3, -1)
    psi = 2.0 * np.pi * np.arange(12)[:, None] / 12
    y = u[:, 0] * np.cos(psi) - u[:, 1] * np.sin(psi)
    for part in (y, u[:, 2]):
        assert abs((part * body.sector.mass).sum()) < 1e-12 * np.abs(part).max() * body.mass


@pytest.mark.parametrize("seat", ["clamped", "free", 5e11])
def test_reciprocity(seat):
    profile = ball() if seat == "free" else ring(True)
    body = Revolution(profile, 40, *STEEL, seat=seat)
    at = dofs(profile.race, ALL)
    there = body.compliance(at, at, np.array([3]))[0]
    back = body.compliance(at, at, np.array([-3]))[0]
    assert np.abs(there - back.T).max() < 1e-12 * np.abs(there).max()


def test_loads_and_observations_apart_equal_those_together():
    """Few loads and many observed nodes are solved, many on both sides condensed: the same numbers."""
    profile = ring(True)
    body = Revolution(profile, DIVISIONS, *STEEL)
    every = dofs(np.arange(len(profile.points)), ALL)
    few = dofs(profile.race[2:4], (0, 1))
    offsets = np.array([0, 2, 5])
    solved = body.compliance(few, every, offsets)
    condensed = body.compliance(every, every, offsets)
    at = [int(np.flatnonzero((every == dof).all(axis=1))[0]) for dof in few]
    assert np.abs(solved - condensed[:, :, at]).max() < 1e-12 * np.abs(solved).max()
    held = np.isin(every[:, 0], profile.seat)
    assert not solved[:, held].any() and solved[:, ~held].any()


def test_only_the_offsets_asked_for_are_returned_and_all_by_default():
    profile = ring(True)
    body = Revolution(profile, DIVISIONS, *STEEL)
    at = dofs(profile.race[:2])
    every = body.compliance(at, at)
    assert every.shape == (DIVISIONS, 4, 4)
    some = body.compliance(at, at, np.array([-1, 17, 3]))
    assert np.abs(some - every[[15, 1, 3]]).max() < 1e-13 * np.abs(every).max()


@pytest.mark.parametrize("seat", ["clamped", 5e11])
def test_sampled_harmonics_equal_all_of_them(seat):
    """400 sectors, finest around the ring as in a contact: 1e-7 where the spline's steps are chosen for it."""
    profile = ring(True, step=0.25e-3, size=3e-3)
    body = Revolution(profile, 400, *STEEL, seat=seat)
    at = dofs(profile.race[::3], ALL)
    offsets = np.array([0, 1, 2, 10, 33, 100])
    every = body.compliance(at, at, offsets, "all")
    sampled = body.compliance(at, at, offsets)
    assert len(solved_harmonics(400, "sampled")) < 50
    assert np.abs(sampled - every).max() < 1e-6 * np.abs(every).max()


@pytest.mark.parametrize(("seat", "word"), [(0.0, "N/m3"), (-1.0, "N/m3")])
def test_a_bed_that_holds_nothing_is_refused(seat, word):
    with pytest.raises(MeshError, match=word):
        Revolution(ring(True), DIVISIONS, *STEEL, seat=seat)


def test_what_cannot_be_is_refused():
    with pytest.raises(MeshError, match="3 elements"):
        Revolution(ring(True), 2, *STEEL)
    with pytest.raises(MeshError, match="seat"):
        Revolution(ball(), DIVISIONS, *STEEL)
    with pytest.raises(ValueError, match="neither"):
        Revolution(ring(True), DIVISIONS, *STEEL, seat="glued")
    body = Revolution(ring(True), DIVISIONS, *STEEL)
    with pytest.raises(ValueError, match="'sampled'"):
        body.compliance(np.array([[0, 0]]), np.array([[0, 0]]), harmonics="some")
