"""Balls and sectors that are the same mesh, turned, or not by the tenth digit of one node; forces of equal parts by one matrix."""

import numpy as np
import pytest

from checks.validation.reference import elastic
from raceway.core.fem.elastic.body_forces import BodyForces, CopiedStiffness
from raceway.core.fem.elastic.copies import Copies, same_bodies, sectors, turn
from raceway.core.fem.hexahedron.rows import BlockRows
from raceway.extend import ThreadPool
from tests.core.superelements.bearings import built, tiny

Z = 5
AZIMUTH = 0.3 + 2.0 * np.pi / Z * np.arange(Z)


def balls():
    points, cells = elastic.ball(3e-3, 4)
    points = points + [0.0, 0.02, 0.0]
    return [(points @ turn(angle).T, cells) for angle in AZIMUTH], 1000 + len(points) * np.arange(Z)


def test_a_turn_is_about_x_from_y_to_z():
    assert turn(0.5 * np.pi) @ [1.0, 2.0, 3.0] == pytest.approx([1.0, -3.0, 2.0], abs=1e-15)


def test_turned_balls_are_one_group():
    bodies, starts = balls()
    ((copies, members),) = same_bodies(bodies, AZIMUTH, starts)
    assert members == list(range(Z))
    assert copies.before.size == copies.behind.size == 0
    for k, (points, _) in enumerate(bodies):
        assert np.abs(copies.points @ copies.turns[k].T - points).max() < 1e-13 * np.abs(points).max()
        assert (copies.nodes[k] == starts[k] + np.arange(len(points))).all()


def test_a_ball_with_a_node_moved_in_the_tenth_digit_is_a_group_of_its_own():
    bodies, starts = balls()
    bodies[2][0][7] *= 1.0 + 1e-10
    assert [members for _, members in same_bodies(bodies, AZIMUTH, starts)] == [[0, 1, 3, 4], [2]]
    bodies, starts = balls()  # of other cells
    bodies[1] = bodies[1][0], np.roll(bodies[1][1], 1, axis=0)
    bodies[3] = bodies[3][0][:-1], bodies[3][1]
    assert [members for _, members in same_bodies(bodies, AZIMUTH, starts)] == [[0, 2, 4], [1], [3]]


def ring_parts(index):
    """Points, cells, marks and azimuths of a ring of the tiny bearing: its seat is marked."""
    bearing = tiny().bearing.bearing
    body = bearing.system.assembly.bodies[index]
    marks = np.zeros((len(body.points), 1), dtype=bool)
    marks[bearing._meshes[index].nodes("seat")] = True
    return body.points.copy(), np.asarray(body.operator.cells, dtype=np.int64), marks, bearing.setup.azimuth


@pytest.mark.parametrize("index", [0, 1])
def test_both_structured_rings_are_sectors(index):
    points, cells, marks, azimuth = ring_parts(index)
    found = sectors(points, cells, azimuth, marks, 100)
    count = len(azimuth)
    assert isinstance(found, Copies)
    assert len(found.cells) * count == len(cells)
    for k in range(count):
        there = found.points @ found.turns[k].T
        assert np.abs(points[found.nodes[k] - 100] - there).max() < 1e-13 * np.abs(points).max()
        # The second cut plane of a sector is the first one of the next.
        assert (found.nodes[k][found.behind] == found.nodes[(k + 1) % count][found.before]).all()
    assert found.points[found.behind] == pytest.approx(found.points[found.before] @ turn(2 * np.pi / count).T, abs=1e-16)
    # Every node belongs to one sector, those of its second cut plane left out, and every cell too.
    own = np.setdiff1d(np.arange(len(found.points)), found.behind)
    assert (np.sort(found.nodes[:, own].ravel()) == 100 + np.arange(len(points))).all()
    made = np.sort(found.nodes[:, found.cells].reshape(-1, 8) - 100, axis=1)
    assert set(map(tuple, made)) == set(map(tuple, np.sort(cells, axis=1)))
    # Balls are in the middle of their sectors.
    centre = found.points[found.cells].mean(axis=1)
    along = np.arctan2(centre[:, 2], centre[:, 1]) - azimuth[0]
    along = np.abs(np.mod(along + np.pi, 2.0 * np.pi) - np.pi)
    assert along.max() < np.pi / len(azimuth)


def moved(points, node):
    points[node] *= 1.0 + 1e-10
    return points


#: Parts of a ring that is none of equal sectors, from those of one that is.
UNEQUAL = {
    "first node moved in the tenth digit": lambda points, **_: {"points": moved(points, 0)},
    "a node moved": lambda points, **_: {"points": moved(points, 17)},
    "last node moved": lambda points, **_: {"points": moved(points, -1)},
    "held in one sector alone": lambda marks, **_: {"marks": marks ^ (np.arange(len(marks)) == 3)[:, None]},
    "a cell of one sector missing": lambda cells, **_: {"cells": cells[1:]},
    "a cell of each sector missing": lambda cells, **_: {"cells": cells[3:]},
    "balls at uneven azimuths": lambda azimuth, **_: {"azimuth": azimuth + [0.0, 1e-10, 0.0]},
    "two balls": lambda azimuth, **_: {"azimuth": azimuth[0] + np.pi * np.arange(2)},
    "seven balls over 24 cells around": lambda **_: {"azimuth": 2.0 * np.pi / 7 * np.arange(7)},
}


@pytest.mark.parametrize("case", UNEQUAL)
def test_a_ring_of_unequal_parts_is_no_sectors(case):
    parts = dict(zip(("points", "cells", "marks", "azimuth"), ring_parts(0), strict=True))
    assert sectors(**parts | UNEQUAL[case](**parts), first=0) is None


#: Sums of some hundred products.
ROUNDING = 1e-13


def assembly_of(formulation):
    return built(bodies={"formulation": formulation}).bearing.bearing.system.assembly


def moved_by_chance(assembly, seed=0):
    return np.random.default_rng(seed).standard_normal(3 * assembly.nodes)


def element_by_element(assembly, u):
    return np.concatenate(
        [body.operator.internal_force(u[assembly.part(k)]).ravel() for k, body in enumerate(assembly.bodies)]
    )


@pytest.mark.parametrize("formulation", ["one_point", "full", "incompatible"])
def test_forces_of_all_bodies_are_those_of_their_elements(formulation):
    assembly = assembly_of(formulation)
    u = moved_by_chance(assembly)
    wanted = element_by_element(assembly, u)
    found = np.zeros_like(u)
    for group in assembly.groups:
        assert len(group.copies.turns) == 3
        part = CopiedStiffness(group.copies, assembly.bodies[group.members[0]].operator).apply(u)
        assert not (found.any() and (found * part).any()), "a node is written twice"
        found += part
    assert np.abs(found - wanted).max() < ROUNDING * np.abs(wanted).max()


@pytest.mark.parametrize("threads", [1, 2])
def test_bodies_in_groups_and_others_stand_side_by_side(threads, monkeypatch):
    """One ring and all balls by matrices, the other ring by its elements in ranges: to the last bit the same for all threads."""
    monkeypatch.setattr("raceway.core.fem.hexahedron.rows._FEWEST", 100)
    assembly = assembly_of("incompatible")
    assert len(assembly.bodies[0].operator.ranges) > 2
    u = moved_by_chance(assembly)
    forces = BodyForces([body.operator for body in assembly.bodies], assembly.starts, assembly.groups[1:])
    seen = np.zeros(len(u), dtype=int)

    def also(force, begin, end):
        seen[begin:end] += 1

    def found(pool):
        forces.compute(u, pool, [])
        return forces.sum(pool, also).copy()

    with ThreadPool(1) as one, ThreadPool(threads) as several:
        alone = found(one)
        assert (found(several) == alone).all()
    assert (seen == 2).all()
    wanted = element_by_element(assembly, u)
    assert np.abs(alone - wanted).max() < ROUNDING * np.abs(wanted).max()


def test_forces_of_one_body_at_many_displacements():
    assembly = assembly_of("incompatible")
    rows = assembly.part(2)
    columns = np.random.default_rng(2).standard_normal((rows.stop - rows.start, 3))
    wanted = np.stack([assembly.bodies[2].operator.internal_force(u).ravel() for u in columns.T], axis=1)
    assert np.abs(assembly.body_forces.of_mesh(2, columns) - wanted).max() < ROUNDING * np.abs(wanted).max()
    u = moved_by_chance(assembly)
    ring = assembly.bodies[1].operator.internal_force(u[assembly.part(1)]).ravel()
    assert np.abs(assembly.body_forces.of_body(1, u) - ring).max() < ROUNDING * np.abs(ring).max()


def test_rows_are_those_of_the_sparse_matrix():
    body = assembly_of("incompatible").bodies[0].operator
    rows = BlockRows.assemble(body.cells, len(body.points), body.element_stiffness)
    moved = np.random.default_rng(1).standard_normal((len(body.points), 3, 2))
    some = np.array([3, 0, 17])
    wanted = (body.stiffness() @ moved.reshape(-1, 2)).reshape(-1, 3, 2)[some]
    assert np.abs(rows.times(some, moved) - wanted).max() < ROUNDING * np.abs(wanted).max()
