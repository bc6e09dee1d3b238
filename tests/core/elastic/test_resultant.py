"""Whole contacts on a mesh: Hertz's law in series with what it replaces, tangents, energy, momentum, and where it ends."""

import numpy as np
import pytest

from raceway import ConvergenceError
from raceway.core.fem.elastic.contact import PlaceLaw, groove
from raceway.core.fem.elastic.resultant import Footprint, ResultantContact, Touch
from raceway.extend import contact_modulus, ellipse, three_halves
from tests.core.patches.test_contact import hardening
from tests.core.validation.impact import plane

#: A ball of 9.5 mm on a groove of a ring, about; loads of some hundred newtons make it approach by some micrometres.
HERTZ = ellipse(480.0, 0.93, contact_modulus(212e9, 0.29, 212e9, 0.29))
#: A third, a half of the law's own compliance at 300 N, and nothing.
OWN = float(HERTZ.approach(300.0)) / (1.5 * 300.0)
LOCAL = np.array([OWN / 3.0, OWN / 2.0, 0.0])
LOADS = np.array([300.0, 120.0, 700.0])
#: Groove of three touches: its tube is the distance that a ball's centre may go, about a circle of 20 mm.
GROOVE = groove(np.zeros(3), 20e-3, 0.2e-3)


def one(nodes: list[int], rng: np.random.Generator) -> Footprint:
    """A footprint whose shares reproduce a translation, as all do; each component has some of the others."""
    share = rng.uniform(-0.3, 0.3, (3, len(nodes), 3))
    share[:, -1] += np.eye(3) - share.sum(axis=1)
    weights = rng.uniform(0.1, 1.0, len(nodes))
    return Footprint(np.array(nodes), weights / weights.sum(), share)


def contact(local: np.ndarray = LOCAL, damping: float = 0.0, surface: np.ndarray = GROOVE) -> ResultantContact:
    """A ball of three nodes (0 to 2) and a race of nine (3 to 11) for all touches: 12 nodes."""
    rng = np.random.default_rng(5)
    touches = []
    for k, m in enumerate(local):
        turn = 2.0 * np.pi * k / 3.0
        centre = np.array([0.05e-3, 20e-3 * np.cos(turn), 20e-3 * np.sin(turn)])
        race = one([3 + 3 * k, 4 + 3 * k, 5 + 3 * k], rng)
        touches.append(Touch(f"ball {k}, inner race", one([0, 1, 2], rng), race, centre, surface, float(m), 0.0, 1e-3))
    params = np.tile([HERTZ.factor, 0.0], (len(local), 1))
    return ResultantContact(touches, 12, PlaceLaw(three_halves, params, 0, damping))


def gaps_at(loads: np.ndarray, local: np.ndarray = LOCAL) -> np.ndarray:
    """Gaps at which contacts carry these loads [m]: -(delta_Hertz(Q) - m Q), for the mesh gives m Q by itself."""
    return -(HERTZ.approach(loads) - local * loads)


def pressed(gap: np.ndarray, local: np.ndarray = LOCAL, law: PlaceLaw | None = None, rate: float = 0.0) -> ResultantContact:
    made = contact(local)
    made.gap, made.law = gap, made.law if law is None else law.kernel
    made.params = made.params if law is None else law.params
    made.press(gap, np.full(len(gap), rate), 0.0)
    return made


def test_a_contact_carries_what_hertz_less_the_meshes_compliance_carries():
    made = pressed(gaps_at(LOADS))
    np.testing.assert_allclose(made.pressure, LOADS, rtol=1e-10)  # 1e-12 of the gap, over what is left of the compliance
    # What is left of the gap is the law's own, Hertz's approach.
    np.testing.assert_allclose(-made.gap, HERTZ.approach(LOADS), rtol=1e-10)
    # Without anything to take off, the law is Hertz's.
    np.testing.assert_allclose(pressed(gaps_at(LOADS, 0.0 * LOCAL), 0.0 * LOCAL).pressure, LOADS, rtol=1e-14)


def test_its_stiffness_is_the_difference_of_its_forces():
    gap, step = gaps_at(LOADS), 1e-11
    stiffness = pressed(gap).d_gap
    difference = (pressed(gap + step).pressure - pressed(gap - step).pressure) / (2.0 * step)
    # Central differences of Q = K delta^1.5 over 1e-11 of 1e-5 m: 1e-12; forces to 1e-12 of the gap over the step: 1e-6.
    np.testing.assert_allclose(stiffness, difference, rtol=5e-6)
    # So is its derivative by the rate, of a law that damps; both follow the mesh's compliance.
    law = PlaceLaw(hardening, np.tile([2e7, 1e-5, 0.1], (3, 1)))
    still, slower, faster = (pressed(gap, law=law, rate=rate) for rate in (0.0, -1e-4, 1e-4))
    np.testing.assert_allclose(still.d_rate, (faster.pressure - slower.pressure) / 2e-4, rtol=1e-6)
    # Stiffer than Hertz by the compliance that the mesh has already.
    hertz = 1.0 / (HERTZ.approach(LOADS) / (1.5 * LOADS))
    np.testing.assert_allclose(-1.0 / stiffness, 1.0 / hertz - LOCAL, rtol=1e-9)


def test_open_contacts_carry_nothing():
    made = pressed(np.array([1e-6, 0.0, 5e-3]))
    assert not made.pressure.any() and not made.d_gap.any()
    one_closed = gaps_at(LOADS)
    one_closed[1:] = 1e-7, 3e-3
    np.testing.assert_array_equal(pressed(one_closed).pressure[1:], 0.0)


def test_energy_is_the_integral_of_the_force_over_the_gap():
    deepest = gaps_at(LOADS)
    # At gaps s^2 times the deepest one the force is a power series in s, exact to rounding with 40 points.
    x, w = np.polynomial.legendre.leggauss(40)
    s, w = 0.5 * (x + 1.0), 0.5 * w
    work = sum(a * 2.0 * b * (pressed(b * b * deepest).pressure @ -deepest) for a, b in zip(w, s, strict=True))
    assert pressed(deepest).energy() == pytest.approx(work, rel=1e-9)
    # By parts: what Hertz's law stores, less what the meshes do in its place.
    closed = 0.4 * LOADS @ HERTZ.approach(LOADS) - 0.5 * LOCAL @ LOADS**2
    assert work == pytest.approx(float(closed), rel=1e-9)  # forces to 1e-12 of the gap over what is left of the compliance


def test_a_law_stiffer_than_the_mesh_is_refused_with_the_contact():
    made = contact(np.array([0.0, 3.0 * OWN, 0.0]))
    made.press(gaps_at(np.array([300.0, 300.0, 300.0]), 0.0 * LOCAL), np.zeros(3), 0.0)
    with pytest.raises(
        ConvergenceError, match=r"ball 1, inner race: under .* N the contact is stiffer than the mesh .* nm/N"
    ):
        made.refuse()


def test_beyond_the_law_the_force_goes_on_along_its_tangent():
    """Iterations may pass there; the second contact has half of the law's compliance at 300 N, and none at eight times that."""
    made = contact()
    deep = gaps_at(np.array([300.0, 300.0, 300.0])) - [0.0, 20e-6, 0.0]
    forces = []
    for more in (0.0, 1e-9, 2e-9):
        made.press(deep - [0.0, more, 0.0], np.zeros(3), 0.0)
        forces.append(made.pressure[1])
        slope = made.d_gap[1]
    assert forces[1] - forces[0] == pytest.approx(-1e-9 * slope, rel=1e-6)  # rounding of some 1e3 N over 1 N
    assert forces[2] - forces[1] == pytest.approx(-1e-9 * slope, rel=1e-6)
    with pytest.raises(ConvergenceError, match="ball 1, inner race"):
        made.commit()
    np.testing.assert_allclose(made.pressure[[0, 2]], 300.0, rtol=1e-9)  # the others carry what their own laws say: as above


def displaced(scale: float = 1.0) -> np.ndarray:
    """Displacements (36,) of 12 nodes that press the balls against the tube, each node by a little more or less."""
    rng = np.random.default_rng(6)
    return scale * np.tile([0.154e-3, 0.0, 0.0], 12) * (np.arange(36) < 9) + 1e-7 * rng.standard_normal(36)


def test_tangent_is_the_difference_of_the_forces_and_symmetric():
    made, u = contact(), displaced()
    made.evaluate(0.0, u)
    assert (made.pressure > 0.0).all()
    blocks = made.stiffness.copy()
    direction, step = np.random.default_rng(7).standard_normal(36), 1e-10
    image = made.tangent(blocks) @ direction
    more, less = (made.evaluate(0.0, u + sign * step * direction).copy() for sign in (1.0, -1.0))
    # 1e-10 m of some 1e-6 m: (1e-4)^2 of the values; the law's tolerance of 1e-12 of the gap, over the step: 1e-8.
    np.testing.assert_allclose((more - less) / (2.0 * step), image, atol=1e-6 * np.abs(image).max())
    whole = made.tangent(blocks).toarray()
    assert np.abs(whole - whole.T).max() < 1e-12 * np.abs(whole).max()  # rounding of sums


def test_what_the_balls_get_the_races_give():
    made = contact()
    force = made.evaluate(0.0, displaced()).reshape(-1, 3)
    carried = np.linalg.norm(made.resultants(), axis=1)
    assert carried.min() > 10.0
    # Shares of all footprints sum to one: what is left is rounding.
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * carried.sum()
    np.testing.assert_allclose(-force[:3].sum(axis=0), made.resultants().sum(axis=0), atol=1e-12 * carried.sum())


def test_a_damper_sees_the_rate_of_the_gap():
    u, v = displaced(), np.zeros(36)
    v[:9:3] = 1e-3  # the ball's nodes along x: into the tube
    calm, damped = contact(), contact(damping=50.0)
    calm.evaluate(0.0, u)
    damped.evaluate(1e-6, u, v)
    rate = np.einsum("ia,ia->i", (damped.move @ v).reshape(-1, 3), damped.normal)
    assert (rate < 0.0).all()
    np.testing.assert_allclose(damped.pressure - calm.pressure, -50.0 * rate, rtol=1e-9)  # sums of forces, rounding
    np.testing.assert_allclose(
        damped.rate_stiffness, 50.0 * damped.normal[:, :, None] * damped.normal[:, None, :], rtol=1e-12
    )


def test_the_bound_of_the_explicit_step_is_below_the_exact_one():
    made = contact()
    made.evaluate(0.0, displaced())
    mass = np.linspace(1e-3, 2e-3, 12)
    whole = made.tangent(made.stiffness).toarray()
    root = 1.0 / np.sqrt(np.repeat(mass, 3))
    exact = 2.0 / np.sqrt(np.linalg.eigvalsh(root[:, None] * whole * root).max())
    bound = made.stable_step(mass)
    # Of the few motions of the contacts, curvature that softens counted as stiffness: hardly below, never above.
    assert 0.95 * exact < bound <= exact * (1.0 + 1e-9)
    assert not made.stiffened()
    made.evaluate(0.0, displaced(1.005))
    assert made.stiffened()


def test_a_pair_is_known_by_its_bodies_and_its_overlap():
    made = contact(surface=plane(np.array([0.0499e-3, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0])))
    made.evaluate(0.0, np.zeros(36))
    assert made.nodes_of(1) == (0, 6)
    name, depth, size = made.overlap(1)
    assert name == "ball 1, inner race" and size == 1e-3
    assert depth == pytest.approx(1e-7, rel=1e-9)  # the surfaces', not the law's own
