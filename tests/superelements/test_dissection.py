"""Order of elimination: every node once, children before parents, borders that are what other cells share."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.linear.dissection import LEAF, dissect
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


def test_children_come_before_their_parents_and_have_one(dissected):
    _, _, _, found = dissected
    children = [child for domain in found.domains for child in domain.children]
    assert sorted(children) == list(range(len(found.domains) - 1))
    assert all(child < number for number, domain in enumerate(found.domains) for child in domain.children)
    assert all((domain.cells is None) == (len(domain.children) == 2) for domain in found.domains)


def test_leaves_are_all_cells_once(dissected):
    _, cells, _, found = dissected
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
