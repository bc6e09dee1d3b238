"""Static solutions and natural frequencies of elastic bodies against closed forms, and what is refused."""

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh

from checks.validation.reference import elastic
from raceway import ConvergenceError
from raceway.extend import HexOperator, solve_static

YOUNG, POISSON, DENSITY = 212e9, 0.29, 7810.0


@pytest.mark.parametrize("count", [4, 12])  # factorised, and by iterations
def test_a_pulled_bar_stretches_uniformly(count):
    points, cells = elastic.block((0.03, 0.01, 0.01), (count, count, count))
    stiffness, _ = elastic.matrices(points, cells, YOUNG, POISSON, DENSITY)
    strain = 1e-4 * np.array([1.0, -POISSON, -POISSON])
    wanted = points * strain
    side = (np.isclose(points, 0.0) | np.isclose(points, points.max(axis=0))).any(axis=1)
    held = np.repeat(side[:, None], 3, axis=1)
    found = solve_static(stiffness, points, np.zeros_like(points), held, wanted)
    assert (found.iterations == 0) == (count == 4)
    # A linear field is exact on this mesh; what is left is the solver's tolerance of 1e-8.
    np.testing.assert_allclose(found.displacement, wanted, atol=1e-7 * np.abs(wanted).max())


def test_iterations_do_not_grow_with_the_mesh():
    counts = []
    for count in (10, 16):  # 1000 and 4096 cells
        points, cells = elastic.ball(3e-3, count)
        stiffness, _ = elastic.matrices(points, cells, YOUNG, POISSON, DENSITY)
        held = np.repeat((points[:, 2] < -2.5e-3)[:, None], 3, axis=1)
        load = np.zeros_like(points)
        load[points[:, 2].argmax(), 2] = -1.0
        found = solve_static(stiffness, points, load, held)
        rest = (stiffness @ found.displacement.ravel() - load.ravel())[~held.ravel()]
        # Of sums of some dozen terms a million times as large, which rounding moves by 1e-10 each.
        assert found.residual == pytest.approx(np.linalg.norm(rest), rel=0.01)
        assert found.residual <= 1e-7
        counts.append(found.iterations)
    assert max(counts) <= 20


def test_free_motions_are_named():
    points, cells = elastic.block((1.0, 1.0, 1.0), (2, 2, 2))
    stiffness, _ = elastic.matrices(points, cells, YOUNG, POISSON, DENSITY)
    on_axis = np.isclose(points[:, 1:], 0.0).all(axis=1)
    cases = {
        "translation along x, translation along y, translation along z, rotation about x": np.zeros_like(points, dtype=bool),
        "rotation about x.": np.repeat(on_axis[:, None], 3, axis=1),
        "translation along x, translation along y, rotation about z": np.repeat([[False, False, True]], len(points), axis=0),
    }
    for words, held in cases.items():
        with pytest.raises(ConvergenceError, match=words):
            solve_static(stiffness, points, np.zeros_like(points), held)


def test_numbers_that_are_not_finite_are_refused():
    points, cells = elastic.block((1.0, 1.0, 1.0), (1, 1, 1))
    stiffness, _ = elastic.matrices(points, cells, YOUNG, POISSON, DENSITY)
    with pytest.raises(ConvergenceError, match="not finite"):
        solve_static(stiffness, points, np.full_like(points, np.nan), np.ones_like(points, dtype=bool))


def lame_error(count: int) -> float:
    """Relative error of the Lame mode of a free cube, exact f = c_s / (sqrt(2) L) (Lame 1852; Demarest 1971)."""
    side = 0.01
    points, cells = elastic.block((side,) * 3, (count,) * 3)
    _, mass = elastic.matrices(points, cells, YOUNG, POISSON, DENSITY)
    stiffness = HexOperator(points, cells, YOUNG, POISSON, DENSITY, "full").stiffness()
    # A shift far below the elastic frequencies makes the matrix definite; the first six are rigid motions.
    start = np.random.default_rng(0).standard_normal(mass.shape[0])
    values, shapes = eigsh(stiffness.tocsc(), 18, mass.tocsc(), sigma=-1e6, v0=start)
    order = np.argsort(values)[6:]
    frequency, shape = np.sqrt(values[order]) / (2.0 * np.pi), shapes[:, order].T.reshape(12, -1, 3)
    x = np.pi * points / side
    exact = np.stack([np.cos(x[:, 0]) * np.sin(x[:, 1]), -np.sin(x[:, 0]) * np.cos(x[:, 1]), 0.0 * x[:, 2]], axis=1).ravel()
    share = (shape.reshape(12, -1) @ (mass @ exact)) ** 2
    wanted = np.sqrt(YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY) / (np.sqrt(2.0) * side)
    return frequency[share.argmax()] / wanted - 1.0


def test_lame_modes_of_a_free_cube_converge():
    coarse, fine = lame_error(4), lame_error(8)
    assert 0.0 < fine < 0.03  # frequencies of compatible elements come from above
    assert np.log2(coarse / fine) > 1.5  # order 2; three nearly equal frequencies exchange their shapes on coarse meshes


def test_flat_cells_are_coarsened_along_their_short_edges():
    points, cells = elastic.block((0.04, 0.01, 0.01), (8, 8, 40))  # 20 times as long as thick
    stiffness = HexOperator(points, cells, YOUNG, POISSON, DENSITY).stiffness()
    held = np.repeat((points[:, 2] < 1e-9)[:, None], 3, axis=1)
    load = np.zeros_like(points)
    load[points.sum(axis=1).argmax()] = 1.0
    found = solve_static(stiffness, points, load, held)
    assert 0 < found.iterations <= 20  # 62 where aggregates are as long as the cells
