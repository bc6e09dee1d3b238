"""Compliance of a mesh under a contact, split into what depends on its cells and what the body is; weights of nodes inside."""

import numpy as np
import pytest

from checks.validation.reference import elastic
from raceway.core.contact.hertz import ball_compliance, normal_displacement
from raceway.core.fem.elastic.resultant import LoadedBody, footprint, interpolation_at
from raceway.core.fem.elastic.surface import Facets
from raceway.core.fem.mesh.part_meshes import ball_mesh
from raceway.extend import HexOperator

STEEL = YOUNG, POISSON, _ = 212e9, 0.29, 7810.0
#: Thickness of a clamped block, four times as wide as thick, and radius of a ball [m].
THICK, RADIUS = 3e-3, 4.7625e-3
DOWN = np.array([0.0, 0.0, -1.0])


def half_space(radius: float) -> float:
    """Mean displacement of a half-space under 1 - (r / a)^2, weighted with it, under a unit force [m/N].

    In wave numbers the pressure is 8 J2(k a) / (k a)^2 and the half-space 2 (1 - nu^2) / (E k), so it is (1 - nu^2) / (pi E a)
    times 64 times the integral of J2(x)^2 / x^4 = 3 sqrt(pi) / (8 Gamma(5/2)^2 Gamma(9/2)) (Weber and Schafheitlin).
    """
    from scipy.special import gamma

    integral = 3.0 * np.sqrt(np.pi) / (8.0 * gamma(2.5) ** 2 * gamma(4.5))
    return float(64.0 * integral * (1.0 - POISSON**2) / (np.pi * YOUNG * radius))


def clamped_base(radius: float) -> float:
    """What a rigid base at ``THICK`` takes from that [m/N].

    A layer that is bonded to its base has L(k h) times the half-space's compliance at a wave number k, with x = k h and
    q = 3 - 4 nu: L = (2 q sinh 2x - 4 x) / (2 q cosh 2x + 4 x^2 + 1 + q^2).  It ends in confined compression and in 1.
    Vorovich, Alexandrov and Babeshko, Non-classical mixed problems of elasticity (1974): the bonded layer.
    """
    from scipy.integrate import quad
    from scipy.special import jv

    q = 3.0 - 4.0 * POISSON

    def taken(x: float) -> float:
        layer = (2.0 * q * np.sinh(2.0 * x) - 4.0 * x) / (2.0 * q * np.cosh(2.0 * x) + 4.0 * x * x + 1.0 + q * q)
        spread = 8.0 * jv(2, x * radius / THICK) / (x * radius / THICK) ** 2
        return float((layer - 1.0) * spread**2)

    return float((1.0 - POISSON**2) / (np.pi * YOUNG * THICK) * quad(taken, 1e-6, 20.0)[0])


def block(layers: int, wide: tuple[float, float]):
    """A clamped block's surface compliance [m/N] and its separation, with so many cells through its thickness."""
    side = 4.0 * THICK
    points, cells = elastic.block((side, side, THICK), (4 * layers, 4 * layers, layers))
    top = cells[np.isclose(points[cells[:, 4:], 2].min(axis=1), THICK)][:, 4:]
    held = np.repeat(np.isclose(points[:, 2:], 0.0), 3, axis=1)
    stiffness = HexOperator(points, cells, *STEEL, "incompatible").stiffness()
    body = LoadedBody(points, cells, stiffness, held, None, STEEL)
    pole = np.array([0.5 * side, 0.5 * side, THICK])
    contact = footprint(Facets(points, top), pole, DOWN, np.array([1.0, 0.0, 0.0]), pole, wide)
    surface = float(contact.weights @ body.along(contact, DOWN)[contact.nodes])
    return surface, body.separated(contact, pole, DOWN, wide, THICK)


def ball(count: int, angle: float):
    """A floating ball, (n, 3) displacements along a unit force at an angle to its axis [rad], and what is replaced there."""
    lines = np.linspace(-1.0, 1.0, count + 1)
    mesh = ball_mesh(RADIUS, lines, lines, lines, np.linspace(0.0, 1.0, count // 2 + 1))
    operator = HexOperator(mesh.points, mesh.cells, *STEEL, "incompatible")
    mass = operator.lumped_mass()
    held = np.zeros((len(mesh.points), 3), dtype=bool)
    body = LoadedBody(mesh.points, mesh.cells, operator.stiffness(), held, mass, STEEL)
    outward, along = np.array([np.sin(angle), 0.0, np.cos(angle)]), np.array([np.cos(angle), 0.0, -np.sin(angle)])
    wide = 0.5 * RADIUS, 0.5 * RADIUS
    facets = Facets(mesh.points, mesh.facet_nodes("surface"))
    contact = footprint(facets, RADIUS * outward, -outward, along, np.zeros(3), wide)
    return body, contact, -outward, mass


#: Structural compliance of the ball under a contact ellipse of the article's size [m/N].
SPHERE = ball_compliance(RADIUS, YOUNG, POISSON, 0.9e-3, 0.1e-3)[0]


def test_the_half_spaces_displacement_is_boussinesqs():
    surface = normal_displacement(np.array([0.0]), np.array([4e-3]), YOUNG, POISSON)
    below = normal_displacement(np.array([3e-3]), np.array([4e-3, 0.0]), YOUNG, POISSON)
    # On the surface; below and beside, 5 mm away; straight below: all to rounding.
    factor = (1.0 + POISSON) / (2.0 * np.pi * YOUNG)
    assert surface[0, 0] == pytest.approx((1.0 - POISSON**2) / (np.pi * YOUNG * 4e-3), rel=1e-13)
    assert below[0, 0] == pytest.approx(factor * (9.0 / 125.0 + 2.0 * (1.0 - POISSON) / 5.0) / 1e-3, rel=1e-13)
    assert below[0, 1] == pytest.approx(factor * (3.0 - 2.0 * POISSON) / 3e-3, rel=1e-13)


def test_coarse_and_fine_blocks_have_one_structural_compliance():
    wide = 0.2 * THICK, 0.4 * THICK
    (coarse, first), (fine, second) = (block(layers, wide) for layers in (2, 6))
    # Cells of a little more than the ellipse's width give way by a fifth less than cells of a third of that.
    assert coarse < 0.85 * fine
    # The rigid base takes away what lies below it, on any mesh.
    assert first.structural < 0.0
    # Over the depths the fields differ by a sixth of it on the coarse mesh, 5 % on the fine one: the means by far less.
    assert first.structural == pytest.approx(second.structural, rel=0.03)
    assert second.spread < 0.5 * first.spread < 0.1 * abs(first.structural)
    for surface, found in ((coarse, first), (fine, second)):
        assert found.local + found.structural == pytest.approx(surface, rel=1e-12)  # how it is split, to rounding
    assert first.local < 0.9 * second.local


def test_a_fine_block_gives_way_as_the_layer_does():
    radius = 0.5 * THICK
    surface, found = block(6, (radius, radius))
    half, base = half_space(radius), clamped_base(radius)
    # Three cells across the radius give way by 3 % less than the layer.
    assert surface == pytest.approx(half + base, rel=0.04)
    # At the surface the base takes 0.58 nm/N away, at half to nine tenths of the depth, where it is looked for, 0.70: an eighth
    # of a nanometre a newton, 1 % of what a contact gives at 300 N.
    assert found.structural == pytest.approx(base, rel=0.25)
    assert abs(found.structural - base) < 0.13e-9
    # That less the mesh's own 3 % is what the local part is off by.
    assert found.local == pytest.approx(half, rel=0.05)


def test_the_depths_do_not_see_how_the_force_is_spread():
    narrow, wide = (block(4, (share * THICK, share * THICK))[1] for share in (0.25, 0.6))
    assert narrow.local > 1.5 * wide.local
    # What the base takes away falls off within the thickness; under the wider disc it is a mean over up to 0.6 of that: 11 % less.
    assert narrow.structural == pytest.approx(wide.structural, rel=0.15)


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_what_is_replaced_in_a_ball_is_surface_less_exact_and_the_half_spaces(angle):
    body, contact, normal, mass = ball(6, angle)
    along = body.along(contact, normal)
    replaced = body.replaced(contact, normal, SPHERE)
    assert replaced == pytest.approx(float(contact.weights @ along[contact.nodes]) - SPHERE, rel=1e-12)  # rounding
    # Twelve cells across the ball: the elements give way by 2 % less than the sphere.
    assert replaced == pytest.approx(half_space(0.5 * RADIUS), rel=0.05)
    # Displacements are those from the mean of its masses, where the springs that hold it carry nothing: rounding.
    assert abs(mass @ along) < 1e-9 * mass.sum() * np.abs(along).max()


def test_the_springs_that_hold_a_ball_are_too_soft_to_count(monkeypatch):
    body, contact, normal, _ = ball(4, 0.0)
    before = body.replaced(contact, normal, 0.0)
    monkeypatch.setattr("raceway.core.fem.elastic.resultant._SLOW", 0.025)
    softer, contact, normal, _ = ball(4, 0.0)
    # Springs of a twentieth of the ball's own frequency: of the order of (1/20)^2 of the displacement.
    assert softer.replaced(contact, normal, 0.0) == pytest.approx(before, rel=2.5e-3)


SIZE = np.array([0.03, 0.02, 0.01])


@pytest.fixture(scope="module")
def distorted():
    """A block of 120 cells whose inner nodes are moved by up to a tenth of a cell: no cell is a parallelepiped."""
    points, cells = elastic.block(tuple(SIZE), (6, 5, 4))
    inside = np.all((points > 1e-9) & (points < SIZE - 1e-9), axis=1)
    shift = 0.1 * SIZE / (6, 5, 4) * np.random.default_rng(3).uniform(-1.0, 1.0, points.shape)
    return points + inside[:, None] * shift, cells


def places(count: int) -> np.ndarray:
    return SIZE * np.random.default_rng(4).uniform(0.0, 1.0, (count, 3))


def test_linear_functions_are_interpolated_exactly(distorted):
    points, cells = distorted
    where = places(200)
    nodes, weights = interpolation_at(points, cells, where)
    assert nodes.shape == weights.shape == (200, 8)
    # Newton's method ends at rounding of the coordinates, and the shape functions sum to one.
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-13)
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, points[nodes]), where, atol=1e-13 * SIZE.max())
    # Inside of the cell that holds the point no weight is negative; the nodes are those of one cell.
    assert weights.min() > -1e-9
    assert set(map(tuple, nodes.tolist())) <= set(map(tuple, cells.tolist()))
    nodes, weights = interpolation_at(points, cells, points)
    own = np.where(nodes == np.arange(len(points))[:, None], weights, 0.0).sum(axis=1)
    np.testing.assert_allclose(own, 1.0, atol=1e-12)  # Newton's method ends at rounding
    # Fewer cells than are tried are enough: trilinear shape functions, to rounding.
    one, cells = elastic.block((1.0, 1.0, 1.0), (1, 1, 1))
    nodes, weights = interpolation_at(one, cells, np.array([[0.25, 0.5, 0.75]]))
    assert weights[0][(one[nodes[0]] == 1.0).all(axis=1)] == pytest.approx([0.25 * 0.5 * 0.75], rel=1e-12)


def test_a_point_slightly_outside_is_extrapolated_from_the_nearest_cell(distorted):
    points, cells = distorted
    where = places(40)
    where[:, 2] = SIZE[2] * 1.02  # a twelfth of a cell above the top
    nodes, weights = interpolation_at(points, cells, where)
    np.testing.assert_allclose(np.einsum("nk,nka->na", weights, points[nodes]), where, atol=1e-13 * SIZE.max())
    assert weights.min() < -0.05
    assert (points[nodes][:, :, 2].max(axis=1) == SIZE[2]).all()  # a cell of the top layer
