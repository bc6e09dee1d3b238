"""Where on a meshed surface a point lies."""

import numpy as np
import pytest

from raceway.core.elastic.contacts.facets import Facets


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
