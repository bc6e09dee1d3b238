"""Order of elimination, and multifrontal factors against dense elimination of the assembled matrix."""

from __future__ import annotations

import numpy as np
import pytest

from raceway import ConvergenceError
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.linear.dissection import LEAF, dissect
from raceway.core.linear.fronts import Fronts, factored
from raceway.core.linear.rigid_motions import rigid_motions
from tests.superelements.bearings import STEEL, assembled, schur, unknowns
from validation.reference import elastic

MESHES = {
    "block": elastic.block((0.03, 0.02, 0.01), (14, 9, 7)),
    "ball": elastic.ball(3e-3, 10),
    "ring": elastic.ring(0.015, 0.02, 0.008, (5, 4, 40)),
    "one leaf": elastic.block((1.0, 1.0, 1.0), (3, 3, 3)),
}


@pytest.fixture(params=MESHES, scope="module")
def dissected(request):
    points, cells = MESHES[request.param]
    kept = np.random.default_rng(5).choice(len(points), 20, replace=False)
    return points, cells, np.sort(kept), dissect(points, cells, kept)


def leaves_below(dissection, number):
    """Cells of a domain, by its leaves."""
    domain = dissection.domains[number]
    if domain.cells is not None:
        return dissection.order[slice(*domain.cells)]
    return np.concatenate([leaves_below(dissection, child) for child in domain.children])


def test_every_node_is_eliminated_once_or_kept(dissected):
    points, _, kept, found = dissected
    eliminated = np.concatenate([domain.inner for domain in found.domains])
    assert (np.sort(np.concatenate([eliminated, kept])) == np.arange(len(points))).all()
    assert (found.domains[-1].border == kept).all()


def test_children_come_before_their_parents_and_leaves_are_all_cells_once(dissected):
    _, cells, _, found = dissected
    children = [child for domain in found.domains for child in domain.children]
    assert sorted(children) == list(range(len(found.domains) - 1))
    assert all(child < number for number, domain in enumerate(found.domains) for child in domain.children)
    assert all((domain.cells is None) == (len(domain.children) == 2) for domain in found.domains)

    assert (np.sort(found.order) == np.arange(len(cells))).all()
    ends = [domain.cells for domain in found.domains if domain.cells is not None]
    assert [first for first, _ in ends] == [0, *(last for _, last in ends[:-1])]
    assert ends[-1][1] == len(cells)
    assert all(0 < last - first <= LEAF for first, last in ends)


def test_a_border_is_what_other_cells_share_or_is_kept(dissected):
    """Domain by domain, by sets: nodes of its cells that also belong to other cells, or that are kept."""
    _, cells, kept, found = dissected
    for number, domain in enumerate(found.domains):
        own = leaves_below(found, number)
        others = np.setdiff1d(np.arange(len(cells)), own)
        here, elsewhere = set(cells[own].ravel()), set(cells[others].ravel()) | set(kept)
        assert domain.border.tolist() == sorted(here & elsewhere)
        below = set().union(*(found.domains[child].border for child in domain.children)) if domain.children else here
        assert domain.inner.tolist() == sorted(below - set(domain.border))


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
@pytest.mark.parametrize("formulation", ["one_point", "incompatible"])
@pytest.mark.parametrize("mass", [0.0, 1e11])
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


def test_a_floating_body_resists_no_rigid_motion():
    operator = operator_of("ball")
    found = fronts_of(operator, far_nodes(operator.points))
    motions = rigid_motions(operator.points)[found.kept]
    assert np.abs(found.schur @ motions).max() < 1e-10 * np.abs(found.schur).max()
    # And nothing but those six: the seventh eigenvalue is that of an elastic deformation.
    values = np.linalg.eigvalsh(found.schur)
    assert np.abs(values[:6]).max() < 1e-10 * values[-1] < 1e-5 * values[6]


def held(operator):
    """Unknowns at the bottom of a ball, of which one is held along x and y alone."""
    free = np.ones((len(operator.points), 3), dtype=bool)
    free[operator.points[:, 2] < -2.5e-3] = False
    free[int(operator.points[:, 2].argmax())] = False, False, True
    return free.ravel()


def test_held_unknowns_are_left_out():
    operator = operator_of("ball")
    nodes, free = far_nodes(operator.points), held(operator)
    found = fronts_of(operator, nodes, free)
    kept = unknowns(nodes)[free[unknowns(nodes)]]
    inner = np.setdiff1d(np.flatnonzero(free), kept)
    wanted = schur(assembled(operator), kept, inner)
    assert (found.kept == kept).all()
    assert np.abs(found.schur - wanted).max() < 1e-10 * np.abs(wanted).max()


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


def test_what_forward_leaves_acts_on_the_kept_unknowns():
    """b_k - A_ki A_ii^-1 b_i, to single precision."""
    operator = operator_of("ring")
    found = fronts_of(operator, far_nodes(operator.points))
    matrix, kept = assembled(operator), found.kept
    inner = np.setdiff1d(np.arange(len(matrix)), kept)
    right = np.random.default_rng(2).standard_normal((len(matrix), 2))
    wanted = right[kept] - matrix[np.ix_(kept, inner)] @ np.linalg.solve(matrix[np.ix_(inner, inner)], right[inner])
    values = right.astype(np.float32)
    found.forward(values)
    assert np.abs(values[kept] - wanted).max() < 1e-4 * np.abs(wanted).max()


@pytest.mark.parametrize("nodes", [[], [0], [0, 1]])
@pytest.mark.parametrize("counts", [(1, 1, 1), (2, 1, 1), (5, 4, 3), (7, 3, 2), (9, 2, 2)])
def test_a_body_that_nothing_holds_is_refused(counts, nodes):
    """Nothing kept, one node, two: rotations about the line through them are left.  Rounding makes some last pivots positive."""
    for formulation in ("one_point", "incompatible"):
        operator = HexOperator(*elastic.block((0.03, 0.02, 0.01), counts), *STEEL, formulation)
        with pytest.raises(ConvergenceError, match="singular: something is held by nothing"):
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


def test_progress_is_told_front_by_front_by_their_work():
    operator, seen = operator_of("ball"), []
    found = dissect(operator.points, operator.cells, far_nodes(operator.points))
    ordered = operator.of_mesh(operator.points, operator.cells[found.order])
    everything = np.ones(3 * len(operator.points), dtype=bool)
    fronts = factored(found, ordered.cells, ordered.element_stiffness, everything, lambda *told: seen.append(told))
    count = len(found.domains)
    assert len(seen) == count and len({total for _, total in seen}) == 1
    done = [0, *(done for done, _ in seen)]
    assert done[-1] == seen[0][1] and (np.diff(done) > 0).all()
    single = sum(s * (s + b) for s, b in ((len(front.inner), len(front.border)) for front in fronts.fronts))
    assert fronts.bytes == 4 * single


def test_factors_come_back_from_plain_arrays():
    """Views, no copies; the same solutions to the last bit."""
    operator = operator_of("ball")
    found = fronts_of(operator, far_nodes(operator.points), held(operator))
    arrays = found.arrays()
    again = Fronts.of_arrays(arrays)
    assert all(np.shares_memory(front.lower, arrays["factors"]) for front in again.fronts)
    right = np.random.default_rng(4).standard_normal((3 * len(operator.points), 2)).astype(np.float32)
    one, other = right.copy(), right.copy()
    found.forward(one)
    again.forward(other)
    assert (one == other).all() and (found.kept == again.kept).all()
    found.backward(one)
    again.backward(other)
    assert (one == other).all()
