"""The contact kernel against a readable reference, its tangent against differences, what it refuses."""

import numpy as np
import pytest

from raceway import ConvergenceError, MeshError
from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.body import Body
from raceway.core.elastic.contacts.gap import forces_and_tangents, gaps, plane
from raceway.core.elastic.contacts.nodal import NodalContact, Pair
from raceway.core.elastic.system import ElasticSystem
from validation.groove import GROOVE, HERTZ, RADIUS, ROLLING, guess, model
from validation.reference.contact import contact_forces, groove_gap

MIDDLE = np.array([0.0, 0.0, -(RADIUS + ROLLING)])
#: Few and coarse elements: these tests are about equations, not about Hertz.
MESH = {"growth": 2.2, "coarse": 1.6e-3}


@pytest.fixture(scope="module")
def pressed():
    """The quarter groove at 2 elements per semi-axis, in equilibrium under 300 N."""
    found = model(300.0, 2.0, **MESH)
    state = found.system.settle(guess(found, float(HERTZ.approach(300.0))))
    found.system.static_internal(state.y)
    return found, state


def test_gap_of_a_groove_is_the_references_and_its_derivatives_are_differences():
    rng = np.random.default_rng(1)
    where = np.array([0.0, 0.0, -RADIUS]) + 1e-3 * rng.uniform(-1.0, 1.0, (20, 3))
    surface = np.array([[1.0, *MIDDLE, ROLLING + GROOVE, GROOVE, 0.0, 0.0]])
    which = np.zeros(20, dtype=np.int64)

    def evaluate(place):
        gap, normal, bend = np.empty(20), np.empty((20, 3)), np.empty((20, 3, 3))
        gaps(np.ascontiguousarray(place), which, surface, gap, normal, bend)
        return gap, normal, bend

    gap, normal, bend = evaluate(where)
    for i in range(20):
        expected, direction = groove_gap(where[i], MIDDLE, ROLLING + GROOVE, GROOVE)
        assert gap[i] == pytest.approx(expected, abs=1e-15)  # rounding of lengths of 23 mm
        np.testing.assert_allclose(normal[i], direction, atol=1e-12)
    step = 1e-7
    for axis in range(3):
        more, less = evaluate(where + step * np.eye(3)[axis]), evaluate(where - step * np.eye(3)[axis])
        # Central differences of a surface of 1/mm curvature: (step/mm)^2 = 1e-8 of the values, and rounding over the step.
        np.testing.assert_allclose(normal[:, axis], (more[0] - less[0]) / (2 * step), atol=1e-7)
        np.testing.assert_allclose(bend[:, :, axis], (more[1] - less[1]) / (2 * step), atol=2e-6 * np.abs(bend).max())


def test_forces_of_a_soft_law_have_exact_tangents():
    """So soft that what the groove's curvature adds is a tenth; central differences as above."""
    where = np.array([0.0, 0.0, -RADIUS]) + 1e-3 * np.random.default_rng(3).uniform(-1.0, 1.0, (20, 3))
    surface = np.array([[1.0, *MIDDLE, ROLLING + GROOVE, GROOVE, 0.0, 0.0]])
    which, soft = np.zeros(20, dtype=np.int64), 1e9

    def evaluate(place):
        gap, normal, bend = np.empty(20), np.empty((20, 3)), np.empty((20, 3, 3))
        gaps(np.ascontiguousarray(place), which, surface, gap, normal, bend)
        force, stiffness, damping = np.empty((20, 3)), np.empty((20, 3, 3)), np.empty((20, 3, 3))
        pressure, slope, none = soft * (1e-3 - gap), np.full(20, -soft), np.zeros(20)
        forces_and_tangents(np.ones(20), pressure, slope, none, normal, bend, force, stiffness, damping)
        return force, stiffness, np.abs(pressure[:, None, None] * bend).max()

    _, stiffness, curved = evaluate(where)
    assert curved > 0.1 * soft
    for axis, step in enumerate(1e-7 * np.eye(3)):
        found = -(evaluate(where + step)[0] - evaluate(where - step)[0]) / 2e-7
        np.testing.assert_allclose(stiffness[:, :, axis], found, atol=1e-6 * soft)


def test_forces_are_the_references(pressed):
    found, state = pressed
    contact, assembly = found.system.contact, found.system.assembly
    move = contact.move[::3][:, ::3].tocsr()
    shares = [
        list(zip(move.indices[a:b], move.data[a:b], strict=True))
        for a, b in zip(move.indptr[:-1], move.indptr[1:], strict=True)
    ]
    u = assembly.nodal(state.y)
    inner = contact.evaluate(0.0, u)
    pressure, force = contact_forces(
        contact.place, contact.area, shares, MIDDLE, ROLLING + GROOVE, GROOVE, found.penalty, u.reshape(-1, 3)
    )
    assert pressure.max() > 1e9
    # Gaps of 1e-8 m are differences of lengths of 1e-2 m: 1e-16 / 1e-6 of relative rounding, times a few.
    np.testing.assert_allclose(contact.pressure, pressure, atol=1e-6 * pressure.max())
    np.testing.assert_allclose(-inner.reshape(-1, 3), force, atol=1e-6 * np.abs(force).max())


def test_no_momentum_is_lost(pressed):
    found, _ = pressed
    contact = found.system.contact
    force = contact.evaluate(0.0, found.system._u).reshape(-1, 3)
    carried = np.abs(force).sum(axis=0)
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * carried.max()  # sums of a few hundred roundings


def test_tangent_is_the_difference_of_the_forces(pressed):
    found, state = pressed
    contact, assembly = found.system.contact, found.system.assembly
    u = assembly.nodal(state.y)
    before = contact.evaluate(0.0, u).copy()
    blocks, open_ = contact.stiffness.copy(), contact.gap > -1e-9
    direction = np.random.default_rng(0).standard_normal(len(u))
    step = 1e-12
    image = contact.tangent_times(blocks, direction)
    after = contact.evaluate(0.0, u + step * direction)
    assert not open_.all()
    # Points at the edge of the contact may open: they carry a millionth of the force; gaps round to 1e-18 m over 1e-12.
    np.testing.assert_allclose((after - before) / step, image, atol=1e-4 * np.abs(image).max())


def test_equilibrium_carries_the_load(pressed):
    found, state = pressed
    assert state.residuals[-1] < 1e-6
    assert 4.0 * found.system.contact.resultants()[0, 2] == pytest.approx(300.0, rel=1e-5)  # ten times the residual
    energies = found.system.energies(state.y, np.zeros_like(state.y))
    work = 0.5 * float(state.y @ found.system.load)
    # Hertz stores 0.4 Q delta where a linear spring stores 0.5; a structure between the two.
    assert 0.75 < (energies["elastic"] + energies["contact"]) / work < 1.0


def test_overlap_deeper_than_an_element_is_refused():
    found = model(300.0, 1.0, **MESH)
    contact, assembly = found.system.contact, found.system.assembly
    lifted = contact.pairs[0].surface.copy()
    lifted[3] += 2e-3
    pair = contact.pairs[0]
    deep = NodalContact(
        [Pair(pair.name, pair.points, lifted, pair.facets, pair.first_node)], assembly.nodes, contact.law, contact.params
    )
    with pytest.raises(MeshError, match="ball on groove.*overlap by .* more than an element"):
        ElasticSystem(assembly, deep, 1e11, found.system.load)


def test_a_body_that_nothing_holds_is_named_with_the_support_that_would():
    found = model(300.0, 1.0, **MESH)
    bodies = found.system.assembly.bodies
    loose = Body("ball 3", bodies[1].operator, np.zeros_like(bodies[1].held))
    system = ElasticSystem(Assembly([loose]), None, 1e11, np.zeros(3 * len(loose.points)))
    with pytest.raises(ConvergenceError, match="ball 3.*translation.*hold it by the cage, by fixed nodes, or by a bed"):
        system.settle(np.zeros(system.size))


def test_without_an_equilibrium_the_last_good_state_and_the_residuals_are_kept(monkeypatch):
    monkeypatch.setattr("raceway.core.elastic.statics.NEWTON_LIMIT", 1)
    found = model(300.0, 1.0, **MESH)
    start = guess(found, float(HERTZ.approach(300.0)))
    with pytest.raises(ConvergenceError, match="Last good state: 0 % of the load") as caught:
        found.system.settle(start)
    np.testing.assert_array_equal(caught.value.state["y"], start)
    assert caught.value.state["residuals"] and np.isfinite(caught.value.state["residuals"]).all()


def test_a_plane_has_one_normal():
    gap, normal, bend = np.empty(1), np.empty((1, 3)), np.empty((1, 3, 3))
    surface = plane(np.array([0.0, 0.0, 1e-3]), np.array([0.0, 0.0, 2.0]))[None]
    gaps(np.array([[5e-3, 0.0, 1.5e-3]]), np.zeros(1, dtype=np.int64), surface, gap, normal, bend)
    assert gap[0] == pytest.approx(0.5e-3, rel=1e-12)  # rounding
    np.testing.assert_array_equal(normal, [[0.0, 0.0, 1.0]])
    assert not bend.any()
