"""What an ideal cage holds of a ball, its energy, and the inverse with whole contacts and a cage against a dense one."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array

from raceway.core.fem.elastic.assembly import Cage
from raceway.core.fem.elastic.bearing import cage_fields, cage_rows, cage_stiffness
from raceway.core.fem.elastic.iterative_solver import LowRankContacts
from tests.core.superelements.bearings import built

#: Nodes, of which the last one is held, and contacts.
NODES, CONTACTS = 9, 4
SIZE = 3 * NODES
FREE = np.arange(SIZE - 3)
#: A cage's springs [N/m, N m/rad], of sizes as different as in a bearing.
SPRINGS = np.array([3e6, 20.0, 50.0])


def symmetric(rng: np.random.Generator, size: int, smallest: float) -> np.ndarray:
    root = rng.standard_normal((size, size))
    return root @ root.T + smallest * np.eye(size)


@pytest.fixture
def bodies():
    """Stiffness of bodies [N/m] on the free nodes, and its inverse on columns."""
    matrix = 1e6 * symmetric(np.random.default_rng(1), len(FREE), 1.0)
    return matrix, lambda columns: np.linalg.solve(matrix, columns)


@pytest.fixture
def contact() -> Any:
    """What is asked of a contact; the last one is open."""
    rng = np.random.default_rng(2)
    stiffness = 1e6 * np.stack([symmetric(rng, 3, 0.1) for _ in range(CONTACTS)])
    rates = np.stack([symmetric(rng, 3, 0.1) for _ in range(CONTACTS)])
    stiffness[-1], rates[-1] = 0.0, 0.0
    move = rng.standard_normal((3 * CONTACTS, SIZE)) * (rng.uniform(size=(3 * CONTACTS, SIZE)) < 0.5)
    return SimpleNamespace(move=csr_array(move), stiffness=stiffness, rate_stiffness=rates)


def cage() -> Cage:
    rows = np.random.default_rng(3).standard_normal((len(SPRINGS), SIZE))
    return Cage(csr_array(rows), SPRINGS, np.zeros(SIZE))


def dense(matrix: np.ndarray, contact: Any, held: Cage | None, rates: float) -> np.ndarray:
    """A + B^T D B + L^T k L, written out."""
    out = matrix.copy()
    for k in range(CONTACTS):
        rows = contact.move.toarray()[3 * k : 3 * k + 3, FREE]
        out += rows.T @ (contact.stiffness[k] + rates * contact.rate_stiffness[k]) @ rows
    if held is not None:
        rows = held.rows.toarray()[:, FREE]
        out += rows.T @ np.diag(held.stiffness) @ rows
    return out


def test_the_cage_s_force_is_the_gradient_of_its_energy():
    """Of a quadratic form central differences are exact."""
    held, (u, v) = cage(), np.random.default_rng(6).standard_normal((2, SIZE))
    energy = [0.5 * held.force(w) @ (held.rows @ w) for w in (u + v, u - v)]
    assert energy[0] - energy[1] == pytest.approx(2.0 * held.internal(u) @ v, rel=1e-12)


@pytest.mark.parametrize("rates", [0.0, 2e5])
@pytest.mark.parametrize("held", [None, cage()], ids=["loose", "caged"])
def test_it_is_the_inverse_of_bodies_contacts_and_cage(bodies, contact, held, rates):
    """Bodies are asked once: new tangents need no new answers of theirs.  Symmetric, as conjugate gradients need it."""
    matrix, inverse = bodies
    asked = []

    def counted(columns):
        asked.append(columns.shape)
        return inverse(columns)

    whole = LowRankContacts(contact, held, counted, FREE)
    residual = np.random.default_rng(4).standard_normal(len(FREE))
    for _ in range(2):
        apply = whole.inverse(inverse, rates)
        wanted = np.linalg.solve(dense(matrix, contact, held, rates), residual)
        # Both lose the condition number of A, some 1e3, and of the contacts' matrix beside it, to rounding.
        np.testing.assert_allclose(apply(residual), wanted, atol=1e-9 * np.abs(wanted).max())
        # The contacts and the cage matter: without them the answer is another one by far.
        assert np.abs(inverse(residual) - wanted).max() > 0.1 * np.abs(wanted).max()
        columns = np.column_stack([apply(column) for column in np.eye(len(FREE))])
        assert np.abs(columns - columns.T).max() < 1e-9 * np.abs(columns).max()  # rounding, as above
        assert np.linalg.eigvalsh(columns + columns.T).min() > 0.0
        contact.stiffness, contact.rate_stiffness = 3.0 * contact.stiffness[::-1], contact.rate_stiffness[::-1]
    assert asked == [(len(FREE), 3 * CONTACTS + (0 if held is None else len(SPRINGS)))]


def test_a_rigid_motion_gives_its_parts():
    rng = np.random.default_rng(3)
    points, mass = rng.standard_normal((40, 3)), rng.uniform(1.0, 2.0, 40)
    azimuth = 0.7
    along, radius = np.array([0.0, -np.sin(azimuth), np.cos(azimuth)]), np.array([0.0, np.cos(azimuth), np.sin(azimuth)])
    arm = points - mass @ points / mass.sum()
    for row, axis in enumerate((along, along, radius, np.array([1.0, 0.0, 0.0]))):
        u = np.cross(axis, arm) if row else np.tile(axis, (len(points), 1))
        found = cage_rows(points, mass, *cage_fields(points, mass, along)) @ u.ravel()
        wanted = np.eye(4)[row]
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
