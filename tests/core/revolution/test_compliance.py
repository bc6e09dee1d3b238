"""Compliances and frequencies by harmonics against full three-dimensional solves, their symmetries, and what is kept on disk."""

import numpy as np
import pytest
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh

from raceway import MeshError
from raceway.core.fem.revolution.body import Revolution, seat_areas, solved_harmonics
from raceway.core.fem.revolution.sections import dofs
from tests.core.revolution.sections import STEEL, ball, ring
from tests.core.validation.swept import Swept

DIVISIONS, BED = 16, 5e11
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


def apart(profile, seat, solve, formulation="incompatible"):
    """Largest relative difference of the harmonics' compliance of a race from full solutions ``solve(swept, force)``."""
    at, swept = dofs(profile.race, ALL), Swept(profile, DIVISIONS, formulation)
    found = Revolution(profile, DIVISIONS, *STEEL, formulation, seat).compliance(at, at, harmonics="all")
    return difference(found, swept, lambda force: solve(swept, force), 1)


@pytest.mark.parametrize("inner", [True, False])
@pytest.mark.parametrize("formulation", ["incompatible", "full", "one_point"])
def test_a_clamped_ring_equals_the_full_solve(inner, formulation):
    """Two factorisations of well-conditioned systems: rounding only."""
    assert apart(ring(inner), "clamped", Swept.clamped, formulation) < 1e-10


def test_a_ring_on_a_bed_equals_the_full_solve():
    profile = ring(False)
    areas = seat_areas(profile, DIVISIONS)
    assert DIVISIONS * areas.sum() == pytest.approx(2.0 * np.pi * 31e-3 * 16e-3, rel=1e-12)  # the exact cylinder
    assert apart(profile, BED, lambda swept, force: swept.bedded(force, areas, BED)) < 1e-10


def test_a_floating_ball_equals_the_full_solve():
    """Rounding, and the digits that a body held at three points loses."""
    assert apart(ball(), "free", Swept.floating) < 1e-9


def test_a_stiff_bed_is_a_clamp():
    profile = ring(False)
    at = dofs(profile.race)
    held, bedded = (Revolution(profile, DIVISIONS, *STEEL, seat=seat).compliance(at, at) for seat in ("clamped", 1e19))
    # The bed gives way by 1 / (1e19 N/m3 times some mm2), 1e-5 of a contact's compliance.
    assert np.abs(held - bedded).max() < 1e-4 * np.abs(held).max()


@pytest.mark.parametrize("seat", ["clamped", "free", BED])
def test_reciprocity(seat):
    profile = ball() if seat == "free" else ring(True)
    body = Revolution(profile, 40, *STEEL, seat=seat)
    at = dofs(profile.race, ALL)
    there = body.compliance(at, at, np.array([3]))[0]
    back = body.compliance(at, at, np.array([-3]))[0]
    assert np.abs(there - back.T).max() < 1e-12 * np.abs(there).max()


def test_loads_and_observations_apart_equal_those_together():
    """Few loads and many observed nodes are solved, many on both sides condensed: the same numbers, of any of all offsets."""
    profile = ring(True)
    body = Revolution(profile, DIVISIONS, *STEEL)
    every = dofs(np.arange(len(profile.points)), ALL)
    few = dofs(profile.race[2:4], (0, 1))
    solved = body.compliance(few, every)
    assert len(solved) == DIVISIONS
    condensed = body.compliance(every, every, np.array([-1, 17, 5]))
    at = [int(np.flatnonzero((every == dof).all(axis=1))[0]) for dof in few]
    assert np.abs(solved[[15, 1, 5]] - condensed[:, :, at]).max() < 1e-12 * np.abs(solved).max()
    held = np.isin(every[:, 0], profile.seat)
    assert not solved[:, held].any() and solved[:, ~held].any()


@pytest.mark.parametrize("seat", ["clamped", BED])
def test_sampled_harmonics_equal_all_of_them(seat):
    """400 sectors, finest around the ring as in a contact: 1e-7 where the spline's steps are chosen for it."""
    profile = ring(True, step=0.25e-3, size=3e-3)
    body = Revolution(profile, 400, *STEEL, seat=seat)
    at = dofs(profile.race[::3], ALL)
    offsets = np.array([0, 1, 2, 10, 33, 100])
    every, sampled = (body.compliance(at, at, offsets, which) for which in ("all", "sampled"))
    assert len(solved_harmonics(400, "sampled")) < 50
    assert np.abs(sampled - every).max() < 1e-6 * np.abs(every).max()


def test_what_cannot_be_is_refused():
    for error, words, section, divisions, seat in (
        (MeshError, "N/m3", ring(True), DIVISIONS, 0.0),
        (MeshError, "N/m3", ring(True), DIVISIONS, -1.0),
        (MeshError, "3 elements", ring(True), 2, "clamped"),
        (MeshError, "seat", ball(), DIVISIONS, "clamped"),
        (ValueError, "neither", ring(True), DIVISIONS, "glued"),
    ):
        with pytest.raises(error, match=words):
            Revolution(section, divisions, *STEEL, seat=seat)
    with pytest.raises(ValueError, match="'sampled'"):
        Revolution(ring(True), DIVISIONS, *STEEL).compliance(np.zeros((1, 2), int), np.zeros((1, 2), int), harmonics="some")


@pytest.mark.parametrize("seat", ["free", "clamped"])
def test_a_ring_has_the_frequencies_of_its_full_mesh(seat):
    profile = ring(True, step=0.6e-3, size=4e-3)
    found = np.sort(Revolution(profile, 12, *STEEL, seat=seat).frequencies(range(7), 3).ravel())
    swept = Swept(profile, 12)
    free = np.ones((len(swept.points), 3), dtype=bool)
    if seat == "clamped":
        free[swept.seat_nodes()] = False
    keep = np.flatnonzero(free.reshape(-1))
    matrix, heavy = (
        swept.stiffness[keep][:, keep],
        diags_array(np.repeat(swept.operator.lumped_mass(), 3)[keep], format="csc"),
    )
    squares = eigsh(matrix, 12, heavy, sigma=-1e8, v0=np.ones(len(keep)), return_eigenvectors=False)
    full = np.sqrt(np.sort(squares)[6 if seat == "free" else 0 :]) / (2.0 * np.pi)
    # Each frequency of a harmonic above 0 stands twice in the full body; iterations of both stop at rounding.
    for value in full[:5]:
        assert np.abs(found / value - 1.0).min() < 1e-7
    assert found[0] == pytest.approx(full[0], rel=1e-7)


def test_a_bed_lies_between_clamp_and_free():
    profile = ring(False)
    held, soft, free = (
        Revolution(profile, 12, *STEEL, seat=seat).frequencies([2], 1)[0, 0] for seat in ("clamped", 1e11, "free")
    )
    assert free < soft < held


def test_a_free_ball_has_the_first_torsion_of_a_sphere():
    """Lamb: 2.50 c_s / (2 pi R), above 200 kHz.  Coarse, with lumped masses and a hole on the axis: some percent."""
    young, poisson, density = STEEL
    found = Revolution(ball(0.25e-3), 24, *STEEL, seat="free").frequencies(range(3), 1).min()
    torsion = 2.501 * np.sqrt(young / (2.0 * (1.0 + poisson)) / density) / (2.0 * np.pi * 4.7625e-3)
    assert found == pytest.approx(torsion, rel=0.04)


BASE = {"young": 212e9, "poisson": 0.29, "formulation": "incompatible", "seat": "clamped", "hourglass": 0.005}
CHANGES = [
    {}, {"young": 300e9}, {"poisson": 0.2}, {"formulation": "full"}, {"formulation": "one_point"},
    {"formulation": "one_point", "hourglass": 0.05}, {"seat": 5e11}, {"seat": 1e11}, {},
]  # fmt: skip


def test_every_input_is_part_of_the_key(tmp_path, monkeypatch):
    """All of them in one cache: an answer of another material, seat or element would be read back bit for bit."""
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    section = ring(True, 1e-3, 3e-3)
    load = dofs(section.race)[:2]
    for change in CHANGES:
        given = {**BASE, **change}
        body = Revolution(section, 12, **given)
        found = body.cached_compliance("test", load, load)
        np.testing.assert_array_equal(found, body.compliance(load, load, None, "sampled"), err_msg=str(change))
    first, finer, other = (
        Revolution(section, divisions, 212e9, 0.29).cached_compliance("test", loads, load)
        for divisions, loads in ((12, load), (24, load), (12, load[1:]))
    )
    assert finer.shape != first.shape
    np.testing.assert_array_equal(other, first[..., 1:])
