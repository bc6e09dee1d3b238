"""A ring of sectors, closed harmonic by harmonic, against the same ring as a whole, and its turned and mirrored answers."""

import numpy as np
import pytest

from checks.validation.reference import elastic
from raceway.core.fem.elastic.copies import Copies, sectors
from raceway.core.fem.elastic.superelement import Closed, Loose, Part, gather_turned
from raceway.extend import HexOperator
from tests.core.superelements.bearings import STEEL, assembled, schur, unknowns

#: Even and odd: with and without the harmonic in which neighbours move against each other.
COUNTS = [3, 4, 5]


def ring_of(count, held=True):
    """A ring of ``count`` sectors of six cells around, held at its bore, with five nodes of every sector as its contacts'."""
    points, cells = elastic.ring(0.015, 0.02, 0.008, (3, 2, 6 * count))
    azimuth = 2.0 * np.pi / count * np.arange(count)
    free = np.ones(len(points), dtype=bool)
    if held:
        free = np.hypot(points[:, 1], points[:, 2]) > 0.0151
    found = sectors(points, cells, azimuth, free[:, None], 0)
    operator = HexOperator(points, cells, *STEEL, "incompatible")
    inside = np.setdiff1d(np.flatnonzero(free[found.nodes[0]]), np.concatenate([found.before, found.behind]))
    return operator, found, inside[3:20:4], free


def both(count, mass=0.0):
    operator, found, contact, free = ring_of(count)
    closed = Closed.of(Part.of(found, operator, contact, free[found.nodes[0]], mass))
    single = Copies.single(operator.points, np.asarray(operator.cells))
    whole = Loose.of(Part.of(single, operator, found.nodes[:, contact].ravel(), free, mass))
    return operator, closed, whole, free


@pytest.mark.parametrize("mass", [0.0, 1e10])
@pytest.mark.parametrize("count", COUNTS)
def test_sectors_and_the_whole_ring_are_as_flexible(count, mass):
    """Both are exact: rounding times a condition of some 1e3."""
    operator, closed, whole, free = both(count, mass)
    flexibility = closed.among(np.arange(closed.nodes.size))
    assert np.abs(flexibility - flexibility.T).max() < 1e-13 * np.abs(flexibility).max()
    assert np.abs(flexibility - whole.flexibility).max() < 1e-12 * np.abs(whole.flexibility).max()
    kept = unknowns(closed.nodes.ravel())
    inner = np.setdiff1d(np.flatnonzero(np.repeat(free, 3)), kept)
    wanted = np.linalg.inv(schur(assembled(operator, mass), kept, inner))
    assert np.abs(flexibility - wanted).max() < 1e-10 * np.abs(wanted).max()
    some = np.random.default_rng(count).permutation(closed.nodes.size)[:7]
    assert np.abs(closed.among(some) - wanted[np.ix_(unknowns(some), unknowns(some))]).max() < 1e-10 * np.abs(wanted).max()


@pytest.mark.parametrize("mass", [0.0, 1e10])
@pytest.mark.parametrize("count", COUNTS)
def test_forces_anywhere_are_carried_to_the_contacts_and_back(count, mass):
    """To single precision, against a dense solution of the assembled ring; other forces on every sector."""
    operator, closed, whole, free = both(count, mass)
    force = np.random.default_rng(count).standard_normal((len(free), 3)) * free[:, None]
    force = force.ravel()
    chosen = np.flatnonzero(np.repeat(free, 3))
    wanted = np.zeros_like(force)
    wanted[chosen] = np.linalg.solve(assembled(operator, mass)[np.ix_(chosen, chosen)], force[chosen])
    for element in (closed, whole):
        loads, carried = element.forward(force)
        moved = element.respond(loads).ravel()
        places = unknowns(element.nodes.ravel())
        assert np.abs(moved - wanted[places]).max() < 1e-4 * np.abs(wanted).max()
        found = np.zeros_like(force)
        element.backward(carried, moved.reshape(loads.shape), found)
        assert np.abs(found - wanted).max() < 1e-4 * np.abs(wanted).max()


def test_flexibilities_of_turned_copies_are_turned():
    """Nodes of two copies in any order, against Q A Q^T of the whole matrix."""
    rng = np.random.default_rng(1)
    turns = np.stack([np.linalg.qr(rng.standard_normal((3, 3)))[0] for _ in range(2)])
    blocks = rng.standard_normal((2, 12, 12))
    whole = np.block([[blocks[0], blocks[1]], [blocks[1], blocks[0]]])  # a force on copy 1 and copy 0: one copy further
    turn = np.zeros((24, 24))
    for node in range(8):
        turn[3 * node : 3 * node + 3, 3 * node : 3 * node + 3] = turns[node // 4]
    nodes = np.array([5, 0, 7, 2])
    out = np.empty((12, 12))
    gather_turned(blocks, turns, nodes // 4, nodes % 4, out)
    places = unknowns(nodes)
    assert out == pytest.approx((turn @ whole @ turn.T)[np.ix_(places, places)], rel=1e-12)


def test_a_bed_under_some_cells_is_in_the_factors():
    """Springs of 1e9 N/m at the nodes of three cells: the dense matrix with them."""
    operator, found, contact, free = ring_of(3)
    single = Copies.single(operator.points, np.asarray(operator.cells))
    nodes = found.nodes[:, contact].ravel()
    cells, springs = np.array([5, 40, 41, 5]), 1e9 * np.ones((4, 1, 1)) * np.eye(24)
    whole = Loose.of(Part.of(single, operator, nodes, free, 0.0, (cells, springs)))
    matrix = assembled(operator)
    for cell in cells:
        places = unknowns(np.asarray(operator.cells[cell], dtype=np.int64))
        matrix[places, places] += 1e9
    kept = unknowns(nodes)
    inner = np.setdiff1d(np.flatnonzero(np.repeat(free, 3)), kept)
    wanted = np.linalg.inv(schur(matrix, kept, inner))
    assert np.abs(whole.flexibility - wanted).max() < 1e-10 * np.abs(wanted).max()
