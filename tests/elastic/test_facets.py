"""Where on a meshed surface a point lies."""

import numpy as np
import pytest

from raceway.core.elastic.contacts.facets import Facets
from raceway.core.elastic.contacts.surface import surface_points


@pytest.mark.parametrize("above", [0.05, 0.3, 0.8])
def test_a_point_above_a_ridge_lies_on_the_ridge(above):
    """Two facets of 1 by 1 that fall off by 1 : 2 to both sides of the line x = 0, z = 0."""
    points = np.array(
        [[-1.0, y, -0.5] for y in (0.0, 1.0)] + [[0.0, y, 0.0] for y in (0.0, 1.0)] + [[1.0, y, -0.5] for y in (0.0, 1.0)]
    )
    facets = Facets(points, np.array([[0, 2, 3, 1], [2, 4, 5, 3]]))
    facet, weights, _ = facets.locate(np.array([[0.01, 0.4, above], [-0.01, 0.7, above]]))
    found = np.einsum("nk,nka->na", weights, points[facets.quads[facet]])
    # The foot of the point on both planes lies beyond the ridge, whose nearest point it is: exact to rounding.
    np.testing.assert_allclose(found, [[0.0, 0.4, 0.0], [0.0, 0.7, 0.0]], atol=1e-12)


def uneven():
    """Nodes and facets of a unit square in the plane z = 0, divided 4 by 4 with inner nodes moved by up to a fifth of a facet."""
    line = np.linspace(0.0, 1.0, 5)
    x, y = np.meshgrid(line, line, indexing="ij")
    inside = (x > 0.0) & (x < 1.0) & (y > 0.0) & (y < 1.0)
    move = 0.05 * np.random.default_rng(1).uniform(-1.0, 1.0, (2, 5, 5)) * inside
    number = np.arange(25).reshape(5, 5)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.stack([x + move[0], y + move[1], 0.0 * x], axis=-1).reshape(-1, 3), quads


def test_a_point_on_uneven_facets_is_found():
    """Three steps of Newton's method leave 1e-6 of a facet that is no parallelogram."""
    facets = Facets(*uneven())
    where = np.column_stack([np.random.default_rng(2).uniform(0.01, 0.99, (100, 2)), np.zeros(100)])
    facet, weights, outside = facets.locate(where)
    assert outside.max() == 0.0
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, facets.points[facets.quads[facet]]), where, atol=2.5e-7)


def test_points_of_uneven_facets_have_their_areas():
    """Gauss' rule is exact for the area and the centre of a plane facet: of all together, those of the square."""
    found = surface_points(*uneven())
    assert found.area.sum() == pytest.approx(1.0, rel=1e-12)
    assert (found.area[:, None] * found.place).sum(axis=0) == pytest.approx([0.5, 0.5, 0.0], rel=1e-12)
