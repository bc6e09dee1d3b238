"""The kernels against their readable references, and against each other."""

import numpy as np
import pytest

from checks.validation.hexahedra import distorted
from checks.validation.reference import hexahedron as reference
from checks.validation.reference.elastic import block
from raceway import MeshError
from raceway.extend import KINDS, HexOperator

STEEL = (2.1e11, 0.29, 7810.0)
#: Rounding of a sum of some hundred products.
ROUNDING = 1e-13


@pytest.fixture(scope="module", params=[(5, 7, 9), (1, 1, 1)], ids=["many", "one"])
def mesh(request):
    """Numbered at random; of elements more than a block and no multiple of it, or one alone, so that blocks are filled up."""
    points, cells, _ = distorted(request.param)
    order = np.random.default_rng(6).permutation(len(points))
    return points[order], np.argsort(order)[cells][::-1], np.random.default_rng(1).standard_normal(points.shape)


@pytest.mark.parametrize("kind", KINDS)
def test_stiffness_equals_the_reference_and_the_kernel(mesh, kind):
    points, cells, u = mesh
    op = HexOperator(points, cells, *STEEL, kind)
    matrices = [reference.element_stiffness(kind, points[cell], op.moduli[0], op.moduli[1], 0.05) for cell in cells]
    expected = reference.assembled(cells, len(points), matrices, 3)
    K = op.stiffness()
    assert np.abs(K.toarray() - expected).max() <= ROUNDING * np.abs(expected).max()
    assert np.abs((K - K.T).toarray()).max() <= ROUNDING * np.abs(expected).max()
    force = op.internal_force(u)
    assert np.abs(K @ u.ravel() - force.ravel()).max() <= ROUNDING * np.abs(force).max()
    for threads in (2, 3, 8):
        assert np.array_equal(force, op.internal_force(u, threads=threads))


def test_the_readable_loop_gives_the_fast_kernels_force(mesh):
    points, cells, u = mesh
    op = HexOperator(points, cells, *STEEL, hourglass=0.1)
    f = np.zeros_like(points)
    reference.one_point_force(cells, points, u, op.moduli[0], op.moduli[1], 0.1, *reference.EXACT, reference.HOURGLASS, f)
    assert np.abs(f - op.internal_force(u)).max() <= ROUNDING * np.abs(f).max()


def test_bad_input_is_refused_in_words():
    points, cells = block((1.0, 1.0, 1.0), (2, 2, 2))
    turned = cells.copy()
    turned[3] = turned[3][[4, 5, 6, 7, 0, 1, 2, 3]]
    for error, words, *given in (
        (MeshError, "element 3 is inverted", points, turned, *STEEL),
        (MeshError, "nodes 0 to 26", points, cells + 1, *STEEL),
        (MeshError, r"cells \(m, 8\)", points, cells[:, :4], *STEEL),
        (MeshError, "element 0 is inverted or degenerate", np.full_like(points, np.nan), cells, *STEEL),
        (ValueError, "poisson", points, cells, 2.1e11, 0.5, 7810.0),
        (ValueError, "one_point", points, cells, *STEEL, "two_points"),
    ):
        with pytest.raises(error, match=words):
            HexOperator(*given)
