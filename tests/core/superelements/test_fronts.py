"""Order of elimination, and multifrontal factors against dense elimination of the assembled matrix."""

import numpy as np
import pytest

from checks.validation.reference import elastic
from raceway import ConvergenceError
from raceway.core.fem.elastic.fronts import dissect, factored
from raceway.extend import HexOperator
from tests.core.superelements.bearings import STEEL, assembled, schur, unknowns

MESHES = {
    "block": elastic.block((0.03, 0.02, 0.01), (14, 9, 7)), "ball": elastic.ball(3e-3, 10),
    "ring": elastic.ring(0.015, 0.02, 0.008, (5, 4, 40)), "one leaf": elastic.block((1.0, 1.0, 1.0), (3, 3, 3)),
}  # fmt: skip


@pytest.fixture(params=MESHES, scope="module")
def dissected(request):
    points, cells = MESHES[request.param]
    kept = np.random.default_rng(5).choice(len(points), 20, replace=False)
    return points, cells, np.sort(kept), dissect(points, cells, kept)


def test_every_node_is_eliminated_once_or_kept(dissected):
    points, _, kept, found = dissected
    eliminated = np.concatenate([domain.inner for domain in found.domains])
    assert (np.sort(np.concatenate([eliminated, kept])) == np.arange(len(points))).all()
    assert (found.domains[-1].border == kept).all()


def test_cuts_are_small():
    """The top separator of a box is one layer across its longest side, here 10 x 8 of 2550 nodes, and of a ring two sections."""
    points, cells = elastic.block((0.06, 0.02, 0.01), (33, 9, 7))
    found = dissect(points, cells, np.zeros(0, dtype=int))
    assert len(found.domains[-1].inner) == 10 * 8
    points, cells = elastic.ring(0.015, 0.02, 0.008, (5, 4, 40))
    assert len(dissect(points, cells, np.zeros(0, dtype=int)).domains[-1].inner) == 2 * 6 * 5


BODIES = {"ball": elastic.ball(3e-3, 8), "ring": elastic.ring(0.015, 0.02, 0.008, (4, 3, 40))}


def operator_of(name, formulation="one_point"):
    return HexOperator(*BODIES[name], *STEEL, formulation)


def fronts_of(operator, kept, free=None, mass=0.0):
    found = dissect(operator.points, operator.cells, kept)
    ordered = operator.of_mesh(operator.points, operator.cells[found.order])

    def matrices(part):
        out = ordered.element_stiffness(part)
        for k, shares in enumerate(ordered.element_masses[part]):
            out[k] += mass * np.diag(np.repeat(shares, 3))
        return out

    everything = np.ones(3 * len(operator.points), dtype=bool)
    return factored(found, ordered.cells, matrices, everything if free is None else free)


def far_nodes(points, count=9):
    """Nodes at one end."""
    return np.sort(np.argsort(points @ [1.0, 0.3, 0.2])[:count])


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize(("formulation", "mass"), [("one_point", 1e11), ("incompatible", 0.0)])
def test_what_is_left_is_the_dense_schur_complement(name, formulation, mass):
    """Double precision: condition 1e5 of these meshes times 1e-16; a mass at which it counts (1e11: 50 kHz)."""
    operator = operator_of(name, formulation)
    kept = unknowns(far_nodes(operator.points))
    found = fronts_of(operator, far_nodes(operator.points), mass=mass)
    assert (found.kept == kept).all()
    inner = np.setdiff1d(np.arange(3 * len(operator.points)), kept)
    wanted = schur(assembled(operator, mass), kept, inner)
    assert np.abs(found.schur - wanted).max() < 1e-10 * np.abs(wanted).max()
    assert np.abs(found.schur - found.schur.T).max() == 0.0


def held(operator):
    """Unknowns at the bottom of a ball, of which one is held along x and y alone."""
    free = np.ones((len(operator.points), 3), dtype=bool)
    free[operator.points[:, 2] < -2.5e-3] = False
    free[int(operator.points[:, 2].argmax())] = False, False, True
    return free.ravel()


def solved(found, right):
    """A^-1 b, in single precision but for the kept unknowns."""
    values = right.astype(np.float32)
    found.forward(values)
    values[found.kept] = np.linalg.solve(found.schur, values[found.kept].astype(float))
    found.backward(values)
    return values.astype(float)


def test_solutions_have_single_precision_and_ten_digits_after_two_refinements():
    """Three right sides at once; 1e-7 times a condition of some 1e3 that single precision feels here, each time anew."""
    operator = operator_of("ball")
    free = held(operator)
    found = fronts_of(operator, far_nodes(operator.points), free)
    matrix = assembled(operator)[np.ix_(free, free)]
    right = np.random.default_rng(1).standard_normal((len(free), 3)) * free[:, None]
    wanted = np.zeros_like(right)
    wanted[free] = np.linalg.solve(matrix, right[free])

    def error(values):
        return np.abs(values - wanted).max() / np.abs(wanted).max()

    state = solved(found, right)
    assert error(state) < 1e-4
    for _ in range(2):
        rest = right.copy()
        rest[free] -= matrix @ state[free]
        state += solved(found, rest)
    assert error(state) < 1e-10


@pytest.mark.parametrize("nodes", [[], [0], [0, 1]])
@pytest.mark.parametrize("counts", [(1, 1, 1), (2, 1, 1), (5, 4, 3), (7, 3, 2), (9, 2, 2)])
def test_a_body_that_nothing_holds_is_refused(counts, nodes):
    """Nothing kept, one node, two: rotations about the line through them are left.  Rounding makes some last pivots positive."""
    for formulation in ("one_point", "incompatible"):
        operator = HexOperator(*elastic.block((0.03, 0.02, 0.01), counts), *STEEL, formulation)
        with pytest.raises(ConvergenceError, match="singular: a part is unconstrained"):
            fronts_of(operator, np.array(nodes, dtype=int))


def test_a_slender_body_is_not_called_singular():
    """A rod a hundred times as long as thick, held at one end: bending is 1e-8 as stiff as stretching."""
    points, cells = elastic.block((0.1, 0.001, 0.001), (200, 1, 1))
    operator = HexOperator(points, cells, *STEEL, "incompatible")
    free = np.repeat(points[:, 0] > 0.0, 3)
    tip = np.flatnonzero(points[:, 0] == points[:, 0].max())
    found = fronts_of(operator, tip, free)
    force = np.zeros(12)
    force[2::3] = 0.25
    bent = np.linalg.solve(found.schur, force)[2::3].mean()
    # F L^3 / 3 E I; shear adds 1e-4, the clamped end takes some 1e-3.
    assert bent == pytest.approx(0.1**3 / (3.0 * STEEL[0] * 0.001**4 / 12.0), rel=0.01)
