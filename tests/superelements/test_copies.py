"""Balls and sectors that are the same mesh, turned; those that are not, by the tenth digit of one node, are told."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.elastic.copies import Copies, same_bodies, sectors, turn
from tests.superelements.bearings import built
from validation.reference import elastic

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


def test_balls_of_other_cells_are_other_balls():
    bodies, starts = balls()
    bodies[1] = bodies[1][0], np.roll(bodies[1][1], 1, axis=0)
    bodies[3] = bodies[3][0][:-1], bodies[3][1]
    assert [members for _, members in same_bodies(bodies, AZIMUTH, starts)] == [[0, 2, 4], [1], [3]]


def ring_parts(index):
    """Points, cells, marks and azimuths of a ring of the tiny bearing: its seat is marked."""
    bearing = built().bearing.bearing
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


@pytest.mark.parametrize("index", [0, 1])
def test_balls_are_in_the_middle_of_their_sectors(index):
    points, cells, marks, azimuth = ring_parts(index)
    found = sectors(points, cells, azimuth, marks, 0)
    centre = found.points[found.cells].mean(axis=1)
    along = np.arctan2(centre[:, 2], centre[:, 1]) - azimuth[0]
    along = np.abs(np.mod(along + np.pi, 2.0 * np.pi) - np.pi)
    assert along.max() < np.pi / len(azimuth)


def no_sectors(**changes):
    points, cells, marks, azimuth = ring_parts(0)
    parts = {"points": points, "cells": cells, "azimuth": azimuth, "marks": marks} | changes
    return sectors(**parts, first=0) is None


def test_a_ring_with_a_node_moved_in_the_tenth_digit_is_none():
    points = ring_parts(0)[0]
    assert not no_sectors()
    for node in (0, 17, len(points) - 1):
        moved = points.copy()
        moved[node] *= 1.0 + 1e-10
        assert no_sectors(points=moved)


def test_a_ring_that_is_held_in_one_sector_alone_is_none():
    marks = ring_parts(0)[2]
    marks[3] = ~marks[3]
    assert no_sectors(marks=marks)


def test_a_ring_whose_cells_do_not_repeat_is_none():
    """A cell taken out of one sector, and one of three."""
    cells = ring_parts(0)[1]
    assert no_sectors(cells=cells[1:])
    assert no_sectors(cells=cells[3:])


def test_balls_at_uneven_azimuths_or_two_of_them_have_none():
    azimuth = ring_parts(0)[3]
    assert no_sectors(azimuth=azimuth + [0.0, 1e-10, 0.0])
    assert no_sectors(azimuth=azimuth[0] + np.pi * np.arange(2))
    # Seven sectors of 24 cells around: no seventh of the cells.
    assert no_sectors(azimuth=2.0 * np.pi / 7 * np.arange(7))
