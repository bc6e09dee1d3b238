"""Rates of convergence, bending, and nearly incompressible material."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.hexahedron.strain import KINDS
from validation.hexahedron.blocks import block
from validation.hexahedron.manufactured import errors


@pytest.mark.parametrize("kind", KINDS)
def test_rates(kind):
    coarse, fine = errors(kind, 6), errors(kind, 12)
    rates = np.log2(coarse / fine)
    assert rates[0] >= 1.85 and rates[1] >= 0.95, rates
    assert fine[0] <= 0.05, fine


def test_mean_dilatation_does_not_lock_where_full_integration_does():
    """A cantilever four elements high, nu = 0.4999: its deflection over that of a bar hardly depends on nu."""
    found = {}
    for poisson in (0.3, 0.4999):
        for kind in ("full", "mean_dilatation"):
            found[kind, poisson] = _deflection(kind, poisson)
    softening = found["mean_dilatation", 0.4999] / found["mean_dilatation", 0.3]
    locked = found["full", 0.4999] / found["full", 0.3]
    assert softening > 0.8 and locked < 0.7, (softening, locked)


def _deflection(kind, poisson):
    """Tip deflection of a cantilever, times Young's modulus."""
    points, cells = block((16, 4, 4), (8.0, 1.0, 1.0))
    op = HexOperator(points, cells, 2.0 * (1.0 + poisson), poisson, 1.0, kind)
    return _tip(op, points) * 2.0 * (1.0 + poisson)


def _tip(op, points):
    """Mean tip deflection along z under a unit shear force at the end x = max, x = 0 clamped."""
    end = points[:, 0] > points[:, 0].max() - 1e-9
    load = np.zeros_like(points)
    load[end, 2] = 1.0 / end.sum()
    free = np.repeat(points[:, 0] > 1e-9, 3)
    u = np.zeros(points.size)
    K = op.stiffness()
    u[free] = spsolve(K[free][:, free].tocsc(), load.ravel()[free])
    return u.reshape(-1, 3)[end, 2].mean()


def test_incompatible_modes_bend_a_thin_beam_with_one_element_across():
    """Length 20, one element of 1 x 1 across, nu = 0: Timoshenko's deflection F l^3 / 3 E I + F l / k G A."""
    points, cells = block((20, 1, 1), (20.0, 1.0, 1.0))
    beam = 20.0**3 / 3.0 * 12.0 + 20.0 / (5.0 / 6.0 * 0.5)
    ratio = {kind: _tip(HexOperator(points, cells, 1.0, 0.0, 1.0, kind), points) / beam for kind in KINDS}
    assert ratio["incompatible"] == pytest.approx(1.0, abs=0.01)
    assert ratio["full"] < 0.75  # shear locking: elements as long as high bend 1.5 times too stiffly
