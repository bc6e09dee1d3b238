"""Small linear algebra of the compiled loops, against LAPACK; block products against scipy."""

import numpy as np
import pytest
import scipy.sparse as sp

from raceway.core.fem.elastic.linear_statics import BlockMatrix
from raceway.core.ring.elimination import cholesky_solve, eliminate, solve


@pytest.mark.parametrize("gauss", [eliminate, solve])
@pytest.mark.parametrize("seed", range(5))
def test_elimination_and_cholesky_are_lapack_s(seed, gauss):
    rng = np.random.default_rng(seed)
    matrix, rhs = rng.normal(size=(5, 5)), rng.normal(size=5)
    matrix[0, 0] = 0.0  # takes a pivot from below
    both = np.column_stack([matrix, rhs, rhs[::-1]])
    assert gauss(both)
    # Backward stable: rounding times the condition number.
    expected = np.linalg.solve(matrix, np.column_stack([rhs, rhs[::-1]]))
    np.testing.assert_allclose(both[:, 5:], expected, rtol=1e-13 * np.linalg.cond(matrix))
    positive = matrix @ matrix.T + np.eye(5)
    found = rhs.copy()
    assert cholesky_solve(positive.copy(), found, 5)
    np.testing.assert_allclose(found, np.linalg.solve(positive, rhs), rtol=1e-13 * np.linalg.cond(positive))


def test_a_singular_or_indefinite_matrix_is_told():
    singular = np.outer([1.0, 2.0, 3.0], [1.0, 0.0, 1.0])
    assert not solve(np.column_stack([singular, np.ones(3)]))
    assert not eliminate(np.column_stack([singular, np.ones(3)]))
    assert not cholesky_solve(np.diag([1.0, -1.0, 1.0]), np.ones(3), 3)


@pytest.mark.parametrize("real, tolerance", [(np.float64, 1e-14), (np.float32, 1e-6)])
def test_block_products_are_scipy_s(real, tolerance):
    rng = np.random.default_rng(2)
    matrix = sp.random(30, 30, density=0.3, random_state=2, format="csr")
    x, base = rng.normal(size=30).astype(real), rng.normal(size=30).astype(real)
    found = BlockMatrix(matrix, real).times(x, base, 0.5)
    np.testing.assert_allclose(found, matrix @ x + 0.5 * base, atol=30 * tolerance)
