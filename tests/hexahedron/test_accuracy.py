"""Rates of convergence, bending, and nearly incompressible material."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags_array
from scipy.sparse.linalg import cg, spsolve

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.hexahedron.strain import KINDS
from tests.hexahedron.blocks import block, warped
from tests.reference.hexahedron import gauss, slopes, values

DIRECTION = np.array([1.0, -0.5, 0.7])


def _field(x):
    """A bubble c sin(pi x) sin(pi y) sin(pi z): values, gradients, second derivatives of the scalar."""
    s, c = np.sin(np.pi * x), np.cos(np.pi * x)
    gradient = np.stack([np.pi * c[..., k] * s[..., k - 1] * s[..., k - 2] for k in range(3)], axis=-1)
    second = np.empty((*x.shape, 3))
    for i in range(3):
        for j in range(3):
            k = 3 - i - j
            second[..., i, j] = -(np.pi**2) * s.prod(axis=-1) if i == j else np.pi**2 * c[..., i] * c[..., j] * s[..., k]
    return s.prod(axis=-1), gradient, second


def _errors(kind, count, poisson=0.3):
    """Errors in L2 and in the H1 seminorm, relative to the field's own."""
    points, cells, inner = warped(count)
    op = HexOperator(points, cells, 1.0, poisson, 1.0, kind)
    lame, shear = op.moduli[:2]
    at_points, corners, load = [], points[cells], np.zeros_like(points)
    for at, weight in gauss(3):
        N, J = values(at), np.einsum("eni,nj->eij", corners, slopes(at))
        x, volume = np.einsum("n,eni->ei", N, corners), weight * np.linalg.det(J)
        _, _, second = _field(x)
        trace = np.trace(second, axis1=1, axis2=2)
        body = -(lame + shear) * second @ DIRECTION - shear * trace[:, None] * DIRECTION
        np.add.at(load, cells, volume[:, None, None] * N[None, :, None] * body[:, None, :])
        at_points.append((N, slopes(at) @ np.linalg.inv(J), volume, x))
    free = np.repeat(inner, 3)
    K = op.stiffness()[free][:, free]
    u = np.zeros(points.size)
    u[free], info = cg(K, load.ravel()[free], rtol=1e-9, M=diags_array(1.0 / K.diagonal()))
    assert info == 0
    nodal, sums = u.reshape(-1, 3)[cells], np.zeros(4)
    for N, gradients, volume, x in at_points:
        value, slope, _ = _field(x)
        exact, exact_slope = value[:, None] * DIRECTION, DIRECTION[None, :, None] * slope[:, None, :]
        off = np.einsum("n,eni->ei", N, nodal) - exact
        off_slope = np.einsum("eni,enj->eij", nodal, gradients) - exact_slope
        sums += [np.sum(volume @ part.reshape(len(cells), -1) ** 2) for part in (off, off_slope, exact, exact_slope)]
    return np.sqrt(sums[:2] / sums[2:])


@pytest.mark.parametrize("kind", KINDS)
def test_rates(kind):
    coarse, fine = _errors(kind, 6), _errors(kind, 12)
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
