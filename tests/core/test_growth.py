"""Growth of the inner raceway: finite elements and the closed form of the turning disc, and what it does to the balls."""

import attrs
import numpy as np
import pytest
from numpy.polynomial import Legendre
from scipy.integrate import solve_bvp

from raceway import SceneError, make_plan, scene_from_dict
from raceway.core.columns import with_values
from raceway.core.fem.mesh.ring_section import RingSection
from raceway.extend import layout, resolve
from raceway.testing import groove_depth
from tests.core.validation.rotating_ring import growth_by_elements


def radial_growth(scene):
    return resolve(scene).running.radial_growth(scene.bearing)


@pytest.mark.parametrize("change", [{}, {"bore": 33e-3}, {"width": 14e-3}], ids=["B7206C", "thin wall", "narrow"])
def test_growth_of_a_turning_ring_is_that_of_finite_elements(tables, change):
    """Axisymmetric elements of 0.5 mm on the exact section, 0.1 % themselves; a plane-stress annulus is 4.5 to 6 % above."""
    scene = scene_from_dict(tables(bearing=change, kinematics={"ring_growth": True, "spin_speed_rpm": 30000.0}))
    assert radial_growth(scene) == pytest.approx(growth_by_elements(scene), rel=0.01)


def growth_by_strains(section, young, poisson):
    """Ritz' method with the strains of each polynomial at each place: the readable reference."""
    x, r, weight = section.x, section.r, section.r * section.area
    middle, high, wide = 0.5 * (r.max() + r.min()), 0.5 * np.ptp(r), 0.5 * np.ptp(x)
    lame, shear = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson))
    strains, work, there, none = [], [], [], np.zeros_like(r)  # radial, hoop, axial, shear
    for axial in (False, True):
        for i, j in [(n, m) for n in range(9) for m in range(9 - n)][axial:]:
            p, q = Legendre.basis(i, (middle - high, middle + high)), Legendre.basis(j, (-wide, wide))
            by_r, by_x = p.deriv()(r) * q(x) if i else none, p(r) * q.deriv()(x) if j else none
            strains.append((none, none, by_x, by_r) if axial else (by_r, p(r) * q(x) / r, none, by_x))
            work.append(0.0 if axial else (p(r) * q(x) * r) @ weight)
            there.append(0.0 if axial else p(section.contact[1]) * q(section.contact[0]))
    strains = np.array(strains)
    stress = 2.0 * shear * strains * [[1.0], [1.0], [1.0], [0.5]]
    stress[:, :3] += lame * strains[:, :3].sum(axis=1, keepdims=True)
    stiffness = np.einsum("ikn,jkn,n->ij", strains, stress, weight, optimize=True)
    return np.linalg.solve(stiffness, work) @ there


def test_growth_of_sections_that_are_integrated_at_once(tables):
    """Rounding of 89 unknowns."""
    angle, bore, poisson = np.array([8.0, 25.0, 40.0]), np.array([28e-3, 30e-3, 33e-3]), np.array([0.2, 0.3, 0.35])
    bearing = scene_from_dict(tables()).bearing
    several = RingSection.of(with_values(bearing, contact_angle_deg=angle, bore=bore), 2e-3).growth(206e9, poisson)
    alone = [
        RingSection.of(with_values(bearing, contact_angle_deg=a, bore=b), 2e-3) for a, b in zip(angle, bore, strict=True)
    ]
    reference = [growth_by_strains(one, 206e9, nu) for one, nu in zip(alone, poisson, strict=True)]
    assert several == pytest.approx(reference, rel=1e-12)
    for one in alone:  # on the ball, on the side of the groove that its thrust loads
        assert one.contact[0] < 0.0
        assert np.hypot(one.contact[0], one.contact[1] - 0.5 * bearing.pitch_diameter) == pytest.approx(
            0.5 * bearing.ball_diameter
        )
    assert alone[0].growth(206e9, 0.2) == pytest.approx(reference[0], rel=1e-12)


def test_growth_of_a_turning_disc(tables):
    """Without a width: against plane stress by collocation: r^2 u'' + r u' - u + (1 - nu^2) rho w^2 r^3 / E = 0, free bore and land."""
    given = scene_from_dict(tables(kinematics={"ring_growth": True, "spin_speed_rpm": 30000.0}))
    scene = attrs.evolve(given, bearing=attrs.evolve(given.bearing, width=None))
    b, w = scene.bearing, resolve(scene).spin_speed
    young, nu, rho = b.rings.young, b.rings.poisson, b.rings.density
    inner = b.bore / 2.0
    outer = (b.pitch_diameter - b.ball_diameter) / 2.0 + groove_depth(b)
    scale = rho * w**2 * outer**3 / young

    def slope(s, y):
        return np.vstack([y[1], y[0] / s**2 - y[1] / s - (1 - nu**2) * s])

    def ends(a, c):
        return np.array([a[1] + nu * a[0] / (inner / outer), c[1] + nu * c[0]])

    s = np.linspace(inner / outer, 1.0, 50)
    found = solve_bvp(slope, ends, s, np.ones((2, 50)), tol=1e-9)
    assert radial_growth(scene) == pytest.approx(found.sol(1.0)[0] * scale, rel=1e-6)
    assert 1e-7 < radial_growth(scene) < 1e-5


def test_growth_is_added_to_expansion_and_goes_with_the_square_of_the_speed(tables):
    def growth(**kinematics):
        return radial_growth(scene_from_dict(tables(kinematics=kinematics)))

    still = growth(ring_growth=True)
    assert still == 0.0 and growth(spin_speed_rpm=9000.0) == 0.0
    slow, fast = (growth(ring_growth=True, spin_speed_rpm=rpm) for rpm in (9000.0, 18000.0))
    assert fast == pytest.approx(4.0 * slow, rel=1e-12)
    both = growth(ring_growth=True, spin_speed_rpm=9000.0, radial_expansion=3e-6)
    assert both == pytest.approx(slow + 3e-6, rel=1e-12)


def test_expansion_shifts_the_radial_rest_distance(built):
    plain, grown = built(), built(kinematics={"radial_expansion": 2e-6})
    shift = grown.system.scalars - plain.system.scalars
    assert shift[layout.REST_RADIAL] == pytest.approx(2e-6, rel=1e-9)
    assert np.count_nonzero(shift) == 1


def test_an_expanded_ring_loads_its_balls(built):
    """Held axially: loads rise.  Under a given force: the ring sits less deep, at a smaller contact angle, loads rise."""

    def state(**tables):
        model = built(**tables)
        q, _, _ = model.system.solve_equilibrium(model.guess)
        axial, radial = model.system.centre_vectors(q)[0][0]
        return q, model.system.evaluate(q).contact_force[0], np.arctan2(axial, radial)

    (q, load, angle), (q_g, load_g, angle_g) = state(), state(kinematics={"radial_expansion": 3e-6})
    assert q_g[0] < q[0] and angle_g < angle and load_g > load
    # The axial balance: Z Q sin(angle) = F.
    assert 12 * load_g * np.sin(angle_g) == pytest.approx(1000.0, rel=1e-9)
    model = built()
    held = q.copy()
    grown = built(kinematics={"radial_expansion": 3e-6})
    assert grown.system.evaluate(held).contact_force.min() > model.system.evaluate(held).contact_force.max()


def test_growth_needs_the_bore(tables):
    given = {k: v for k, v in scene_from_dict(tables()).to_dict()["bearing"].items() if k not in ("bore", "preset")}
    scene = scene_from_dict({"bearing": given, "load": {"axial": 100.0}, "kinematics": {"ring_growth": True}})
    with pytest.raises(SceneError, match=r"kinematics\.ring_growth.*needs the bearing's `bore`"):
        make_plan(scene)
