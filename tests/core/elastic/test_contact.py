"""Contacts at nodes against a readable reference and Hertz, their tangent against differences; where points lie on facets."""

import numpy as np
import pytest

from checks.validation.groove import GROOVE, HERTZ, RADIUS, ROLLING, guess, model, solve
from checks.validation.reference.contact import contact_forces, groove_gap
from raceway.core.fem.elastic.contact import forces_and_tangents, groove, surface_gaps
from raceway.core.fem.elastic.surface import Facets, surface_points
from tests.core.validation.impact import plane

MIDDLE = np.array([0.0, 0.0, -(RADIUS + ROLLING)])
SURFACE = groove(MIDDLE, ROLLING + GROOVE, GROOVE)


@pytest.fixture(scope="module")
def pressed():
    """The quarter groove in equilibrium under 300 N; elements are few and coarse: these tests are about equations, not Hertz."""
    found = model(300.0, 2.0, growth=2.2, coarse=1.6e-3)
    state = found.system.solve_equilibrium(guess(found, float(HERTZ.approach(300.0))))
    found.system.static_internal(state.y)
    return found, state


def evaluate(place, surface=SURFACE):
    """Gaps, normals and the normals' derivatives at places (n, 3)."""
    count = len(place)
    found = np.empty(count), np.empty((count, 3)), np.empty((count, 3, 3))
    surface_gaps(np.ascontiguousarray(place), np.zeros(count, dtype=np.int64), surface[None], *found)
    return found


def places(seed):
    return np.array([0.0, 0.0, -RADIUS]) + 1e-3 * np.random.default_rng(seed).uniform(-1.0, 1.0, (20, 3))


def test_gap_of_a_groove_is_the_references_and_its_derivatives_are_differences():
    where = places(1)
    gap, normal, bend = evaluate(where)
    for i in range(20):
        expected, direction = groove_gap(where[i], MIDDLE, ROLLING + GROOVE, GROOVE)
        assert gap[i] == pytest.approx(expected, abs=1e-15)  # rounding of lengths of 23 mm
        np.testing.assert_allclose(normal[i], direction, atol=1e-12)
    step = 1e-7
    for axis in range(3):
        more, less = (evaluate(where + sign * step * np.eye(3)[axis]) for sign in (1.0, -1.0))
        # Central differences of a surface of 1/mm curvature: (step/mm)^2 = 1e-8 of the values, and rounding over the step.
        np.testing.assert_allclose(normal[:, axis], (more[0] - less[0]) / (2 * step), atol=1e-7)
        np.testing.assert_allclose(bend[:, :, axis], (more[1] - less[1]) / (2 * step), atol=2e-6 * np.abs(bend).max())
    gap, normal, bend = evaluate(
        np.array([[5e-3, 0.0, 1.5e-3]]), plane(np.array([0.0, 0.0, 1e-3]), np.array([0.0, 0.0, 2.0]))
    )
    assert gap[0] == pytest.approx(0.5e-3, rel=1e-12)  # rounding
    assert normal.tolist() == [[0.0, 0.0, 1.0]] and not bend.any()


def test_forces_of_a_soft_law_have_exact_tangents():
    """So soft that what the groove's curvature adds is a tenth; central differences as above."""
    where, soft = places(3), 1e9

    def forces(place):
        gap, normal, bend = evaluate(place)
        force, stiffness, damping = np.empty((20, 3)), np.empty((20, 3, 3)), np.empty((20, 3, 3))
        pressure, slope, none = soft * (1e-3 - gap), np.full(20, -soft), np.zeros(20)
        forces_and_tangents(np.ones(20), pressure, slope, none, normal, bend, force, stiffness, damping)
        return force, stiffness, np.abs(pressure[:, None, None] * bend).max()

    _, stiffness, curved = forces(where)
    assert curved > 0.1 * soft
    for axis, step in enumerate(1e-7 * np.eye(3)):
        found = -(forces(where + step)[0] - forces(where - step)[0]) / 2e-7
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
    # Of a linear law.
    assert contact.energy() == pytest.approx(0.5 * contact.area @ pressure**2 / found.penalty, rel=1e-5)
    # No momentum is lost: sums of a few hundred roundings.
    assert np.abs(inner.reshape(-1, 3).sum(axis=0)).max() < 1e-12 * np.abs(inner.reshape(-1, 3)).sum(axis=0).max()


def test_tangent_is_the_difference_of_the_forces(pressed):
    found, state = pressed
    contact, assembly = found.system.contact, found.system.assembly
    u = assembly.nodal(state.y)
    before = contact.evaluate(0.0, u).copy()
    blocks, open_ = contact.stiffness.copy(), contact.gap > -1e-9
    direction = np.random.default_rng(0).standard_normal(len(u))
    step = 1e-12
    image = contact.tangent(blocks) @ direction
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


def test_peak_pressure_is_hertzs():
    found = solve(300.0, 2.0, growth=1.8, coarse=1e-3)
    expected = float(HERTZ.peak_pressure(300.0))
    # Two elements across a semi-axis: the nodal pressure is the mean over half of it, which Hertz's own is 7 % below p0.
    assert found.peak_points == pytest.approx(expected, rel=0.05)
    assert found.peak_nodes == pytest.approx(expected, rel=0.10)
    # Finite bodies and the mesh: the approach is a few percent below Hertz's, by the load-independent -0.9 to -0.5 nm/N.
    assert 0.90 < found.approach / float(HERTZ.approach(300.0)) < 0.99
    assert found.penalty_share < 0.02  # ten times stiffer than a row of elements, two rows to the semi-axis


@pytest.mark.parametrize("above", [0.05, 0.3, 0.8])
def test_a_point_above_a_ridge_lies_on_the_ridge(above):
    """Two facets of 1 by 1 that fall off by 1 : 2 to both sides of the line x = 0, z = 0."""
    points = np.array([[x, y, -0.5 * abs(x)] for x in (-1.0, 0.0, 1.0) for y in (0.0, 1.0)])
    facets = Facets(points, np.array([[0, 2, 3, 1], [2, 4, 5, 3]]))
    facet, weights, _ = facets.locate(np.array([[0.01, 0.4, above], [-0.01, 0.7, above]]))
    found = np.einsum("nk,nka->na", weights, points[facets.quads[facet]])
    # The foot of the point on both planes lies beyond the ridge, whose nearest point it is: exact to rounding.
    np.testing.assert_allclose(found, [[0.0, 0.4, 0.0], [0.0, 0.7, 0.0]], atol=1e-12)


def uneven():
    """Nodes and facets of a unit square in the plane z = 0, divided 4 by 4 with inner nodes moved by up to a fifth of a facet."""
    line = np.linspace(0.0, 1.0, 5)
    x, y = np.meshgrid(line, line, indexing="ij")
    inside = (x > 0.0) & (x < 1.0) & (y > 0.0) & (y < 1.0)
    move = 0.05 * np.random.default_rng(1).uniform(-1.0, 1.0, (2, 5, 5)) * inside
    number = np.arange(25).reshape(5, 5)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.stack([x + move[0], y + move[1], 0.0 * x], axis=-1).reshape(-1, 3), quads


def test_a_point_on_uneven_facets_is_found():
    """Three steps of Newton's method leave 1e-6 of a facet that is no parallelogram."""
    facets = Facets(*uneven())
    where = np.column_stack([np.random.default_rng(2).uniform(0.01, 0.99, (100, 2)), np.zeros(100)])
    facet, weights, outside = facets.locate(where)
    assert outside.max() == 0.0
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, facets.points[facets.quads[facet]]), where, atol=2.5e-7)


def test_points_of_uneven_facets_have_their_areas():
    """Gauss' rule is exact for the area and the centre of a plane facet: of all together, those of the square."""
    found = surface_points(*uneven())
    assert found.area.sum() == pytest.approx(1.0, rel=1e-12)
    assert (found.area[:, None] * found.place).sum(axis=0) == pytest.approx([0.5, 0.5, 0.0], rel=1e-12)
