"""Every formulation: constant strain, rigid motion, energy, mass, stable step, rates of convergence, locking."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from checks.validation.hexahedra import distorted, errors
from checks.validation.reference import hexahedron as reference
from checks.validation.reference.elastic import block
from raceway.extend import KINDS, HexOperator

STEEL = (2.1e11, 0.29, 7810.0)
EVERY = pytest.mark.parametrize("kind", KINDS)
SLOPES = np.array([[1.0, 0.3, -0.2], [0.1, -0.7, 0.5], [0.4, 0.2, 0.6]])


@EVERY
def test_patch(kind):
    """A linear field on a distorted mesh: inner nodes find it, and every stress is the exact one."""
    points, cells, inner = distorted((4, 4, 4))
    op = HexOperator(points, cells, *STEEL, kind)
    exact = points @ SLOPES.T + 0.1
    free = np.repeat(inner, 3)
    K, u = op.stiffness().toarray(), exact.ravel().copy()
    u[free] = np.linalg.solve(K[np.ix_(free, free)], -K[np.ix_(free, ~free)] @ u[~free])
    assert np.abs(u - exact.ravel()).max() <= 1e-12 * np.abs(exact).max()
    strain = 0.5 * (SLOPES + SLOPES.T)
    stress = op.moduli[0] * np.trace(strain) * np.eye(3) + 2.0 * op.moduli[1] * strain
    expected = stress[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    assert np.abs(op.stress(u.reshape(-1, 3)) - expected).max() <= 1e-12 * np.abs(expected).max()
    energy = 0.5 * np.sum(stress * strain) * op.element_masses.sum() / op.density
    assert op.energy(exact) == pytest.approx(energy, rel=1e-12)
    assert op.hourglass_energy(exact) <= 1e-24 * energy


@EVERY
@pytest.mark.parametrize("counts", [(1, 1, 1), (2, 3, 2)])
def test_six_zero_energy_modes_and_no_more(kind, counts):
    points, cells, _ = distorted(counts)
    values = np.linalg.eigvalsh(HexOperator(points, cells, *STEEL, kind).stiffness().toarray())
    assert np.abs(values[:6]).max() <= 1e-13 * values[-1]
    assert values[6] >= 1e-4 * values[-1]


def test_hourglass_control_holds_twelve_modes_and_its_energy_is_what_it_adds():
    points, cells, _ = distorted((1, 1, 1))
    values = np.linalg.eigvalsh(HexOperator(points, cells, *STEEL, hourglass=0.0).stiffness().toarray())
    assert np.sum(np.abs(values) <= 1e-13 * values[-1]) == 6 + 12
    points, cells, _ = distorted((3, 3, 3))
    u = np.random.default_rng(8).standard_normal(points.shape)
    held, free = HexOperator(points, cells, *STEEL), HexOperator(points, cells, *STEEL, hourglass=0.0)
    assert held.hourglass_energy(u) == pytest.approx(held.energy(u) - free.energy(u), rel=1e-12)
    assert HexOperator(points, cells, *STEEL, "full").hourglass_energy(u) == 0.0


@EVERY
def test_masses(kind):
    points, cells, _ = distorted((3, 2, 4))
    op = HexOperator(points, cells, *STEEL, kind)
    matrices = [reference.element_mass(points[cell], 7810.0) for cell in cells]
    expected = reference.assembled(cells, len(points), matrices, 1).sum(axis=1)
    assert np.abs(expected - op.lumped_mass()).max() <= 1e-13 * op.lumped_mass().max()
    straight = HexOperator(*block((0.5, 0.25, 2.0), (3, 2, 4)), *STEEL, kind)
    assert straight.lumped_mass().sum() == pytest.approx(7810.0 * 0.25, rel=1e-14)


@EVERY
def test_stable_step_is_safe_and_close(kind):
    """Elements bound the mesh from above: on one element exactly, on equal cubes, whose neighbours cannot all swing at once
    in the fastest way, a fifth to a quarter below."""
    for counts, least in (((1, 1, 1), 1.0 - 1e-12), ((4, 4, 4), 0.75)):
        points, cells, _ = distorted(counts, 0.0 if counts[0] > 1 else 0.25)
        op = HexOperator(points, cells, *STEEL, kind)
        mass = np.repeat(op.lumped_mass(), 3)
        fastest = np.sqrt(eigh(op.stiffness().toarray(), np.diag(mass), eigvals_only=True)[-1])
        assert least <= op.stable_step() * fastest / 2.0 <= 1.0 + 1e-12


def test_stable_step_of_a_distorted_mesh_is_the_least_of_all_elements():
    points, cells, _ = distorted((5, 5, 5), 0.3)
    each = [HexOperator(points, cells[[e]], *STEEL).stable_step() for e in range(len(cells))]
    assert HexOperator(points, cells, *STEEL).stable_step() == pytest.approx(min(each), rel=1e-12)


@EVERY
def test_rates(kind):
    coarse, fine = errors(kind, 6), errors(kind, 12)
    rates = np.log2(coarse / fine)
    assert rates[0] >= 1.85 and rates[1] >= 0.95, rates
    assert fine[0] <= 0.05, fine


def deflection(kind, poisson, size, counts):
    """Mean tip deflection of a cantilever along x under a unit shear force along z, times Young's modulus."""
    points, cells = block(size, counts)
    end, free = points[:, 0] > size[0] - 1e-9, np.repeat(points[:, 0] > 1e-9, 3)
    load, u = np.zeros_like(points), np.zeros(points.size)
    load[end, 2] = 1.0 / end.sum()
    K = HexOperator(points, cells, 1.0, poisson, 1.0, kind).stiffness()
    u[free] = spsolve(K[free][:, free].tocsc(), load.ravel()[free])
    return u.reshape(-1, 3)[end, 2].mean()


def test_mean_dilatation_does_not_lock_where_full_integration_does():
    """A cantilever four elements high, nu = 0.4999: its deflection over that of a bar hardly depends on nu."""
    softening, locked = (
        np.divide(*(deflection(kind, poisson, (8.0, 1.0, 1.0), (16, 4, 4)) for poisson in (0.4999, 0.3)))
        for kind in ("mean_dilatation", "full")
    )
    assert softening > 0.8 and locked < 0.7, (softening, locked)


def test_incompatible_modes_bend_a_thin_beam_with_one_element_across():
    """Length 20, one element of 1 x 1 across, nu = 0: Timoshenko's deflection F l^3 / 3 E I + F l / k G A."""
    beam = 20.0**3 / 3.0 * 12.0 + 20.0 / (5.0 / 6.0 * 0.5)
    thin, locked = (deflection(kind, 0.0, (20.0, 1.0, 1.0), (20, 1, 1)) / beam for kind in ("incompatible", "full"))
    assert thin == pytest.approx(1.0, abs=0.01)
    assert locked < 0.75  # shear locking: elements as long as high bend 1.5 times too stiffly
