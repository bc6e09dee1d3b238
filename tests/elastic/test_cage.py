"""What an ideal cage holds of a ball, and places of contacts in a vibration."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.elastic.cage import NAMES, cage_rows, cage_stiffness
from tests.superelements.bearings import built


def test_a_rigid_motion_gives_its_parts():
    rng = np.random.default_rng(3)
    points, mass = rng.standard_normal((40, 3)), rng.uniform(1.0, 2.0, 40)
    azimuth = 0.7
    along, radius = np.array([0.0, -np.sin(azimuth), np.cos(azimuth)]), np.array([0.0, np.cos(azimuth), np.sin(azimuth)])
    arm = points - mass @ points / mass.sum()
    for motion, axis in zip(NAMES, (along, along, radius, np.array([1.0, 0.0, 0.0])), strict=True):
        u = np.cross(axis, arm) if "turning" in motion else np.tile(axis, (len(points), 1))
        found = cage_rows(points, mass, along) @ u.ravel()
        wanted = [float(name == motion) for name in NAMES]
        # "radius" is a unit vector of either sign.
        assert np.abs(found) == pytest.approx(wanted, abs=1e-12)


def test_with_friction_balls_roll_along_their_orbits_and_not_across():
    """Against the stiffness of a contact at the ball's surface: what rolls is hardly held, what does not is rigid beside it."""
    normal, diameter = 1e8, 0.01
    orbit, across, *rolling = cage_stiffness(normal, diameter, friction=True)
    arm = 0.25 * diameter**2
    assert orbit < 1e-2 * normal
    assert max(rolling) < 1e-2 * normal * arm
    assert across > 10.0 * normal * arm


def test_places_stay_through_a_vibration():
    """Of a tenth of a facet's half width; at rest they are looked up anew."""
    contact = built().bearing.bearing.system.contact
    places = contact.projected.copy()
    moved = places + 0.1 * float(contact.pairs[0].facets.short.min())
    before = contact.move
    assert not contact.update(moved, in_motion=True)
    assert contact.move is before
    assert contact.update(moved)
    assert contact.update(places)
