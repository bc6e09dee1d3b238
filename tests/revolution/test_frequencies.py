"""Natural frequencies by harmonics against those of the full body."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh

from raceway.core.revolution.body import Revolution
from tests.revolution.sections import STEEL, ball, ring
from validation.reference.swept import Swept

DIVISIONS = 12


@pytest.mark.parametrize("seat", ["free", "clamped"])
def test_a_ring_has_the_frequencies_of_its_full_mesh(seat):
    profile = ring(True, step=0.6e-3, size=4e-3)
    found = np.sort(Revolution(profile, DIVISIONS, *STEEL, seat=seat).frequencies(range(DIVISIONS // 2 + 1), 3).ravel())
    swept = Swept(profile, DIVISIONS)
    mass = np.repeat(swept.operator.lumped_mass(), 3)
    free = np.ones((len(swept.points), 3), dtype=bool)
    if seat == "clamped":
        free[swept.seat_nodes()] = False
    keep = np.flatnonzero(free.reshape(-1))
    matrix, heavy = swept.stiffness[keep][:, keep], diags_array(mass[keep], format="csc")
    squares = eigsh(matrix, 12, heavy, sigma=-1e8, v0=np.ones(len(keep)), return_eigenvectors=False)
    full = np.sqrt(np.sort(squares)[6 if seat == "free" else 0 :]) / (2.0 * np.pi)
    # Each frequency of a harmonic above 0 stands twice in the full body; iterations of both stop at rounding.
    for value in full[:5]:
        assert np.abs(found / value - 1.0).min() < 1e-7
    assert found[0] == pytest.approx(full[0], rel=1e-7)


def test_a_bed_lies_between_clamp_and_free():
    profile = ring(False)
    held, soft, free = (
        Revolution(profile, DIVISIONS, *STEEL, seat=seat).frequencies([2], 1)[0, 0] for seat in ("clamped", 1e11, "free")
    )
    assert free < soft < held


def test_a_free_ball_is_elastic_above_200_khz():
    """Lamb's lowest mode of a sphere, 2.65 c_s / (2 pi R) spheroidal and 2.50 torsional for nu = 0.29."""
    young, poisson, density = STEEL
    found = Revolution(ball(0.25e-3), 24, *STEEL, seat="free").frequencies(range(3), 1).min()
    torsion = 2.501 * np.sqrt(young / (2.0 * (1.0 + poisson)) / density) / (2.0 * np.pi * 4.7625e-3)
    # Coarse, with lumped masses and a hole on the axis: some percent.
    assert found == pytest.approx(torsion, rel=0.04)
