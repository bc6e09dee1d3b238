"""The inverse with whole contacts and a cage against a dense one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csr_array

from raceway.core.elastic.cage import Cage
from raceway.core.elastic.low_rank import LowRankContacts

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
    return Cage(csr_array(rows), SPRINGS, ("along", "about x", "about y"), np.zeros(SIZE))


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
    assert held.energy(u + v) - held.energy(u - v) == pytest.approx(2.0 * held.internal(u) @ v, rel=1e-12)


@pytest.mark.parametrize("rates", [0.0, 2e5])
@pytest.mark.parametrize("held", [None, cage()], ids=["loose", "caged"])
def test_it_is_the_inverse_of_bodies_contacts_and_cage(bodies, contact, held, rates):
    matrix, inverse = bodies
    whole = LowRankContacts(contact, held, inverse, FREE)
    residual = np.random.default_rng(4).standard_normal(len(FREE))
    wanted = np.linalg.solve(dense(matrix, contact, held, rates), residual)
    # Both lose the condition number of A, some 1e3, and of the contacts' matrix beside it, to rounding.
    np.testing.assert_allclose(whole.inverse(inverse, rates)(residual), wanted, atol=1e-9 * np.abs(wanted).max())
    # The contacts and the cage matter: without them the answer is another one by far.
    assert np.abs(inverse(residual) - wanted).max() > 0.1 * np.abs(wanted).max()


def test_new_tangents_need_no_new_answers_of_the_bodies(bodies, contact):
    matrix, inverse = bodies
    asked = []

    def counted(columns):
        asked.append(columns.shape)
        return inverse(columns)

    held = cage()
    whole = LowRankContacts(contact, held, counted, FREE)
    assert asked == [(len(FREE), 3 * CONTACTS + len(SPRINGS))]
    contact.stiffness = 3.0 * contact.stiffness[::-1]
    residual = np.random.default_rng(5).standard_normal(len(FREE))
    found = whole.inverse(inverse, 0.0)(residual)
    wanted = np.linalg.solve(dense(matrix, contact, held, 0.0), residual)
    np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())  # as above
    assert len(asked) == 1


def test_symmetric_as_conjugate_gradients_need_it(bodies, contact):
    _, inverse = bodies
    apply = LowRankContacts(contact, cage(), inverse, FREE).inverse(inverse, 1e4)
    whole = np.column_stack([apply(column) for column in np.eye(len(FREE))])
    assert np.abs(whole - whole.T).max() < 1e-9 * np.abs(whole).max()  # rounding, as above
    assert np.linalg.eigvalsh(whole + whole.T).min() > 0.0
