"""Weights of a cell's nodes at points inside of a mesh, and a little outside."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.elastic.contacts.interior import locate
from validation.reference import elastic

SIZE = np.array([0.03, 0.02, 0.01])


@pytest.fixture(scope="module")
def distorted():
    """A block of 120 cells whose inner nodes are moved by up to a tenth of a cell: no cell is a parallelepiped."""
    points, cells = elastic.block(tuple(SIZE), (6, 5, 4))
    inside = np.all((points > 1e-9) & (points < SIZE - 1e-9), axis=1)
    shift = 0.1 * SIZE / (6, 5, 4) * np.random.default_rng(3).uniform(-1.0, 1.0, points.shape)
    return points + inside[:, None] * shift, cells


def places(count: int) -> np.ndarray:
    return SIZE * np.random.default_rng(4).uniform(0.0, 1.0, (count, 3))


def test_linear_functions_are_interpolated_exactly(distorted):
    points, cells = distorted
    where = places(200)
    nodes, weights = locate(points, cells, where)
    assert nodes.shape == weights.shape == (200, 8)
    # Newton's method ends at rounding of the coordinates, and the shape functions sum to one.
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-13)
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, points[nodes]), where, atol=1e-13 * SIZE.max())
    # Inside of the cell that holds the point no weight is negative.
    assert weights.min() > -1e-9


def test_the_nodes_are_those_of_one_cell(distorted):
    points, cells = distorted
    known = {tuple(cell) for cell in cells.tolist()}
    assert {tuple(found) for found in locate(points, cells, places(50))[0].tolist()} <= known


def test_a_node_is_found_with_its_own_weight_alone(distorted):
    points, cells = distorted
    nodes, weights = locate(points, cells, points)
    own = np.where(nodes == np.arange(len(points))[:, None], weights, 0.0).sum(axis=1)
    np.testing.assert_allclose(own, 1.0, atol=1e-12)  # Newton's method ends at rounding


def test_a_point_slightly_outside_is_extrapolated_from_the_nearest_cell(distorted):
    points, cells = distorted
    where = places(40)
    where[:, 2] = SIZE[2] * 1.02  # a twelfth of a cell above the top
    nodes, weights = locate(points, cells, where)
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, points[nodes]), where, atol=1e-13 * SIZE.max())
    assert weights.min() < -0.05
    assert (points[nodes][:, :, 2].max(axis=1) == SIZE[2]).all()  # a cell of the top layer


def test_fewer_cells_than_are_tried_are_enough():
    points, cells = elastic.block((1.0, 1.0, 1.0), (1, 1, 1))
    nodes, weights = locate(points, cells, np.array([[0.25, 0.5, 0.75]]))
    values = dict(zip(nodes[0].tolist(), weights[0].tolist(), strict=True))
    far = int(np.flatnonzero((points == 1.0).all(axis=1))[0])
    assert values[far] == pytest.approx(0.25 * 0.5 * 0.75, rel=1e-12)  # trilinear shape function, to rounding
