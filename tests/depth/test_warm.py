"""Growth of grooves and balls by speed, fits and temperatures, against elasticity solved here and an independent ring."""

from math import radians

import numpy as np
import pytest

import raceway as rw
from checks.validation.reference.ring import Ring
from checks.validation.reference.row_set import RowSet, press, warmed
from raceway import ConvergenceError, SceneError, build_model, make_plan, scene_from_dict
from raceway.extend import equilibrium_table, resolve
from raceway.testing import ball_growth, run, solve_equilibrium

DISTANCE = 16e-3
STEEL = 12.5e-6
ALUMINIUM = {"young": 70e9, "poisson": 0.33, "density": 2700.0, "thermal_expansion": 23e-6}
TEMPERATURES = {"inner_temperature": 14.0, "outer_temperature": 5.0, "ball_temperature": 11.0}


def lame(inside: float, outside: float, pressures: tuple[float, float], radius: float, body) -> float:
    """Radial displacement [m] of a plane-stress annulus under pressures inside and outside [Pa], at a radius.  Timoshenko &
    Goodier, Theory of Elasticity, 3rd ed., section 28."""
    a, b, (p, q) = inside, outside, pressures
    first = (p * a**2 - q * b**2) / (b**2 - a**2)
    second = (p - q) * a**2 * b**2 / (b**2 - a**2)
    return ((1.0 - body.poisson) * first * radius + (1.0 + body.poisson) * second / radius) / body.young


def fits_by_hand(scene) -> tuple[float, float]:
    """Growth of inner and outer raceway [m]: the pressure at which both surfaces of a fit meet; 0 where they do not.  The
    axis of a solid shaft is a hole of 1 nm here, a housing without a diameter 1 km wide."""
    b, warm = scene.bearing, scene.mounting
    race, bore, rings = 0.5 * (b.pitch_diameter - b.ball_diameter), 0.5 * (b.bore or 0.0), b.rings
    core, shaft, housing = max(0.5 * warm.shaft_bore, 1e-9), warm.shaft_material or rings, warm.housing_material or rings
    steel = rings.thermal_expansion or 0.0
    tight = 0.5 * warm.shaft_interference + bore * warm.inner_temperature * ((shaft.thermal_expansion or 0.0) - steel)
    unit = lame(bore, race, (1.0, 0.0), bore, rings) - lame(core, bore, (0.0, 1.0), bore, shaft)
    inner = lame(bore, race, (max(tight, 0.0) / unit, 0.0), race, rings)
    race = 0.5 * (b.pitch_diameter + b.ball_diameter)
    seat, wide = 0.5 * (b.outer_diameter or 0.0), 0.5 * (warm.housing_diameter or 1e3)
    tight = 0.5 * warm.housing_interference - seat * warm.outer_temperature * ((housing.thermal_expansion or 0.0) - steel)
    unit = lame(seat, wide, (1.0, 0.0), seat, housing) - lame(race, seat, (0.0, 1.0), seat, rings)
    return inner, lame(race, seat, (0.0, max(tight, 0.0) / unit), race, rings)


def scene(word="DB", preload=300.0, kinematics=None, bearing=None, **mounting):
    given = {"preset": "B7206C", "arrangement": word, "row_distance": DISTANCE, "preload": preload, **(bearing or {})}
    given = {key: value for key, value in given.items() if value is not None}
    tables = {"title": "warm", "bearing": given, "kinematics": {"ball_inertia": False, **(kinematics or {})}}
    return scene_from_dict({**tables, "mounting": mounting})


def settled(one):
    model = build_model(one)
    return model, solve_equilibrium(model)


def ring():
    return Ring(9.525e-3, 46e-3, 12, radians(15.0), 0.522, 0.522)


@pytest.mark.parametrize("word", ["DB", "DF", "TBT"])
def test_preload_of_a_warm_set(word):
    """Circles, grooves, balls and the distances of the rows grow, each at its temperature."""
    one = scene(word, **TEMPERATURES)
    model, now = settled(one)
    sides, places = zip(*one.bearing.rows, strict=True)
    strains = tuple(STEEL * TEMPERATURES[f"{name}_temperature"] for name in ("inner", "outer", "ball"))
    mounted = {1.0: press(ring(), 300.0 / sides.count(1.0)), -1.0: press(ring(), 300.0)}
    rings = [warmed(ring(), strains, side, place) for side, place in one.bearing.rows]
    expected = RowSet(rings, list(sides), list(places), [mounted[side] for side in sides])
    q = expected.solve_equilibrium(np.zeros(3))
    assert now.displacement == pytest.approx(q, rel=1e-6, abs=1e-12)
    assert equilibrium_table(model, now)["preload"]["rows_n"] == pytest.approx(expected.rows(q), rel=1e-6)
    assert equilibrium_table(model, now)["preload"]["mounted_n"] == 300.0


def test_rows_grow_apart_by_the_planes_of_their_groove_centres():
    """Of a row at X the inner plane moves by a T_i X, the outer by a T_o (X - s A sin(alpha)); the balls' plane lies between them.

    The latter, taken for both, is off by a (T_i - T_o) (f_i - 1/2) D sin(alpha): 2.7e-3 of a row's force where outer rings that are
    10 K warmer have loosened this set.
    """
    one = scene("DB", inner_temperature=30.0)
    (side, place), b = one.bearing.rows[0], one.bearing
    between = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter * np.sin(b.contact_angle)
    inner, outer = (1.0 + STEEL * 30.0) * place, place - side * between
    assert resolve(one).running.grooves[0].axial == pytest.approx(side * (inner - outer) - between, rel=1e-9)


def test_one_temperature_changes_next_to_nothing():
    """Everything keeps its shape; of the offset that was built in 4e-4 are missing, and 1.5 times that of the force."""
    same = dict.fromkeys(TEMPERATURES, 30.0)
    (_, cold), (model, warm) = settled(scene()), settled(scene(**same))
    assert equilibrium_table(model, warm)["preload"]["running_n"] == pytest.approx(300.0, rel=1e-3)
    np.testing.assert_allclose(np.diag(warm.stiffness)[:3], np.diag(cold.stiffness)[:3], rtol=1e-3)


def test_a_longer_shaft_loosens_rows_back_to_back_and_presses_rows_face_to_face():
    def running(word, distance):
        model, now = settled(scene(word, bearing={"row_distance": distance}, inner_temperature=6.0))
        return equilibrium_table(model, now)["preload"]["running_n"]

    assert running("DB", 40e-3) < running("DB", 16e-3) < running("DF", 16e-3) < running("DF", 40e-3)


def test_a_held_displacement_and_condensed_bodies_warm_up_alike():
    """Growth is built into the same constants for both kinds of bodies: the preload rises by the same part, to some percent."""
    found = []
    for kind in ("rigid", "condensed"):
        tables = {**scene(**TEMPERATURES).to_dict(), "bodies": {"kind": kind}}
        model, now = settled(scene_from_dict(tables))
        found.append(equilibrium_table(model, now)["preload"]["running_n"])
    assert found[0] > 310.0 and found[1] == pytest.approx(found[0], rel=0.05)


@pytest.mark.parametrize("hole", [0.0, 12e-3])
@pytest.mark.parametrize("seats", [
    {}, {"housing_diameter": 90e-3}, {"shaft_material": ALUMINIUM, "housing_material": ALUMINIUM},
    {"shaft_material": ALUMINIUM, "housing_material": "AlMgSi", "housing_diameter": 90e-3, **TEMPERATURES},
    {"shaft_material": {"young": "110 GPa", "thermal_expansion": 11e-6}, "inner_temperature": 9.0},
])  # fmt: skip
def test_fits_against_two_annuli(hole, seats):
    """Of one material or two, cold or warm: only the tight part of a warm fit presses."""
    one = scene("single", None, shaft_interference=10e-6, shaft_bore=hole, housing_interference=26e-6, **seats)
    running, b = resolve(one).running, one.bearing
    # 1e-9: by hand a solid shaft has a hole of 1 nm, and a housing ends at 1 km.
    assert (running.inner_fit(b), running.outer_fit(b)) == pytest.approx(fits_by_hand(one), rel=1e-9)


def test_a_warm_housing_of_aluminium_lets_the_ring_go_and_a_cold_one_grips_it():
    def fits(**mounting):
        one = resolve(scene("single", None, housing_material="AlMgSi", **mounting)).running
        return one.outer_fit(one.bearing), one.interference_at_standstill(one.bearing, "housing")

    # 62 mm, 20 K, 10.5e-6 1/K: 13 um, more than the fit has.
    assert fits(housing_interference=10e-6, outer_temperature=20.0) == (0.0, pytest.approx(10e-6 - 62e-3 * 20.0 * 10.5e-6))
    assert fits(outer_temperature=-20.0)[0] < 0.0
    assert fits() == (0.0, 0.0)


def test_a_seat_without_fit_and_warmth_has_no_effect_and_says_so():
    """An interference of 0 is a fit of equal diameters: warmth makes one of it."""
    for seat, temperature in (("shaft", "inner_temperature"), ("housing", "outer_temperature")):
        words = f"`mounting.{seat}_material` has no effect"
        cold, warm = ({f"{seat}_material": "AlMgSi", temperature: kelvin} for kelvin in (0.0, 5.0))
        assert any(words in one for one in rw.check(scene(**cold)).warnings)
        assert not any(words in one for one in rw.check(scene(**warm)).warnings)


def test_a_shaft_of_another_material_loosens_otherwise_at_speed():
    """Between a shaft without mass and one of steel: the ring's own growth and its difference from the shaft's."""

    def lost(**material):
        mounting = {"shaft_interference": 50e-6, **({"shaft_material": material} if material else {})}
        one = scene("single", None, kinematics={"ring_growth": True, "spin_speed_rpm": 20000.0}, **mounting)
        return 50e-6 - resolve(one).running.interference(one.bearing)

    steel, light = lost(), lost(young=212e9, density=1e-6)
    a, w = 15e-3, 20000.0 * np.pi / 30.0
    core = 2.0 * 7810.0 * w**2 * a**3 * (1.0 - 0.29) / (4.0 * 212e9)
    assert light - steel == pytest.approx(core, rel=2e-2)  # the preset's steel has 208 GPa and 0.3
    assert lost(**ALUMINIUM) == pytest.approx(steel, rel=0.02)  # density over modulus is that of steel to 5 %


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"bearing": {"balls": {"young": 310e9}}, "ball_temperature": 40.0}, "bearing.balls.thermal_expansion`: is required: 40 K .* 310 GPa"),
        ({"bearing": {"rings": {"young": 190e9}}, "outer_temperature": -5.0}, "bearing.rings.thermal_expansion`: is required: -5 K"),
        ({"shaft_material": {"young": 70e9}, "inner_temperature": 9.0}, "mounting.shaft_material.thermal_expansion`: is required"),
        ({"housing_material": "AlMgSl"}, "mounting.housing_material.material` = 'AlMgSl': no such material .did you mean 'AlMgSi'"),
        ({"shaft_material": 70e9}, "mounting.shaft_material` = 7.* must be a table"),
        ({"shaft_material": {"young": -1.0}}, "mounting.shaft_material.young` = -1.0: must be greater than 0"),
        ({"inner_temperature": -300.0}, "mounting.inner_temperature` = -300.0: must be from -293.15"),
        (
            {"kinematics": {"ring_growth": True, "spin_speed_rpm": 9000.0}, "shaft_material": {"young": 70e9}},
            "mounting.shaft_material.density`: is required by kinematics.ring_growth",
        ),
    ],
)  # fmt: skip
def test_numbers_that_materials_lack_are_asked_for(tables, words):
    with pytest.raises(SceneError, match=words):
        make_plan(scene(**tables))


def test_balls_given_by_numbers_run_as_those_of_the_name():
    """Hybrid balls in a warm pair; steel's expansion would make four times the axial stiffness."""
    warm = dict.fromkeys(TEMPERATURES, 40.0)
    numbers = {"young": 310e9, "poisson": 0.27, "density": 3240.0, "thermal_expansion": 3.2e-6}
    (_, given), (_, named) = (settled(scene(bearing={"balls": balls}, **warm)) for balls in (numbers, {"material": "Si3N4"}))
    np.testing.assert_allclose(given.stiffness, named.stiffness, rtol=1e-12)
    wrong = settled(scene(bearing={"balls": {**numbers, "thermal_expansion": STEEL}}, **warm))[1]
    assert wrong.stiffness[0, 0] > 4.0 * named.stiffness[0, 0]


def test_cold_bodies_of_any_modulus_need_no_expansion():
    one = scene(bearing={"balls": {"young": 310e9}}, inner_temperature=3.0)
    assert make_plan(one) is not None and one.bearing.balls.thermal_expansion is None
    assert one.bearing.rings.thermal_expansion == STEEL


def test_a_fit_is_a_radial_expansion():
    """Inner raceways out, outer ones in: a set cannot tell them apart."""
    one = scene(shaft_interference=4e-6, housing_interference=2e-6)
    growth = resolve(one).running.inner_fit(one.bearing) - resolve(one).running.outer_fit(one.bearing)
    assert growth > 2e-6
    (_, fitted), (_, given) = settled(one), settled(scene(kinematics={"radial_expansion": growth}))
    np.testing.assert_allclose(fitted.stiffness, given.stiffness, rtol=1e-10)


def test_speed_loosens_a_fit():
    """As much as a solid shaft grows less than the ring's bore: annuli under their own centrifugal force, by finite differences."""
    one = scene(kinematics={"ring_growth": True, "spin_speed_rpm": 30000.0}, shaft_interference=20e-6)
    b = one.bearing
    steel, w = b.rings, resolve(one).spin_speed
    outside = 0.5 * (b.pitch_diameter - b.ball_diameter) + 0.2 * b.ball_diameter

    def bore_growth(inside, outside, at):
        r = np.linspace(inside, outside, 1001)
        h, n = r[1] - r[0], len(r)
        matrix, right = np.zeros((n, n)), -(1.0 - steel.poisson**2) * steel.density * w**2 / steel.young * r * h**2
        k = np.arange(1, n - 1)
        matrix[k, k - 1], matrix[k, k + 1] = 1.0 - 0.5 * h / r[k], 1.0 + 0.5 * h / r[k]
        matrix[k, k] = -2.0 - (h / r[k]) ** 2
        matrix[0, :3], matrix[-1, -3:] = [-1.5, 2.0, -0.5], [0.5, -2.0, 1.5]
        matrix[0, 0] += steel.poisson * h / r[0]
        matrix[-1, -1] += steel.poisson * h / r[-1]
        right[[0, -1]] = 0.0
        return float(np.linalg.solve(matrix, right)[at])

    lost = 2.0 * (bore_growth(0.5 * b.bore, outside, 0) - bore_growth(1e-5, 0.5 * b.bore, -1))
    assert resolve(one).running.interference(b) == pytest.approx(20e-6 - lost, rel=1e-3)


@pytest.mark.parametrize("fit", [20e-6, 2e-6, 0.3e-6])
def test_a_changing_speed_takes_its_part_of_a_fit(fit):
    """Constants of a moment of a run-up are those of a steady run at its speed: of a fit that lasts, that is lost later (3.6 um at
    30 000 r/min), and that is lost already (0.58 um at 12 000 r/min)."""
    excitation = {"kind": "run_up", "first_speed_rpm": 5000.0, "speed_rpm": 30000.0, "duration_s": 0.5, "unbalance": 1e-4}
    tables = scene(kinematics={"ring_growth": True}, shaft_interference=fit).to_dict()
    tables |= {"excitation": excitation, "identifier": {"kind": "order_tracking"}, "rotor": {"mass": 2.0}}
    model = build_model(scene_from_dict(tables))
    steady = scene(kinematics={"ring_growth": True, "spin_speed_rpm": 12000.0}, shaft_interference=fit)
    found = model.system.spin.constants(model.system, 12000.0 * np.pi / 30.0)
    expected = build_model(steady).system
    np.testing.assert_allclose(found.scalars[:5], expected.scalars[:5], rtol=1e-12)


def test_growth_of_a_ball():
    """A sphere under its centrifugal force, by Ritz's method: displacements in powers of r and z up to the third."""
    b = scene().bearing
    nu, rho, radius = b.balls.poisson, b.balls.density, 0.5 * b.ball_diameter
    u = ball_growth(b, 1000.0)
    g = b.ball_diameter * np.cos(b.contact_angle) / b.pitch_diameter
    w = 1000.0 * (0.5 * b.pitch_diameter / b.ball_diameter * (1.0 - g**2) - 0.5 * (1.0 - g))
    # Unit sphere, E = rho w^2 = 1; u_s = s (a + b s^2 + c z^2), u_z = z (d + e s^2 + f z^2) are the solution's own terms.
    x, wx = np.polynomial.legendre.leggauss(12)
    rr, wr = 0.5 * (x + 1.0), 0.5 * wx
    r, c = np.meshgrid(rr, x, indexing="ij")
    s, z, weight = r * np.sqrt(1.0 - c**2), r * c, np.outer(wr, wx) * r**2
    zero, one = np.zeros_like(s), np.ones_like(s)
    # Strains (ss, tt, zz, sz) of each term.
    strains = [
        (one, one, zero, zero), (3 * s**2, s**2, zero, zero), (z**2, z**2, zero, 2 * s * z),
        (zero, zero, one, zero), (zero, zero, s**2, 2 * s * z), (zero, zero, 3 * z**2, zero),
    ]  # fmt: skip
    along = [s, s**3, s * z**2, zero, zero, zero]
    lam, mu = nu / ((1 + nu) * (1 - 2 * nu)), 0.5 / (1 + nu)
    stiff, load = np.zeros((6, 6)), np.zeros(6)
    for i, (a1, a2, a3, a4) in enumerate(strains):
        load[i] = (weight * s * along[i]).sum()
        for j, (b1, b2, b3, b4) in enumerate(strains):
            density = lam * (a1 + a2 + a3) * (b1 + b2 + b3) + 2 * mu * (a1 * b1 + a2 * b2 + a3 * b3) + mu * a4 * b4
            stiff[i, j] = (weight * density).sum()
    found = np.linalg.solve(stiff, load)
    assert u == pytest.approx((found[0] + found[1]) * rho * w**2 * radius**3 / b.balls.young, rel=1e-9)


def test_growing_balls_press_a_set():
    kinematics = {"spin_speed_rpm": 40000.0, "ring_growth": False}
    (slow, a), (fast, b) = (settled(scene(kinematics={**kinematics, "ball_growth": on})) for on in (False, True))
    grown, kept = (equilibrium_table(*one)["preload"]["running_n"] for one in ((fast, b), (slow, a)))
    assert grown > kept == pytest.approx(300.0, rel=1e-8)


@pytest.mark.parametrize(
    ("mounting", "kinematics", "words"),
    [
        ({"inner_temperature": 80.0}, {}, r"mounting.inner_temperature` = 80.*close the bearing: its grooves leave .* µm too little room"),
        ({"ball_temperature": 400.0}, {}, "mounting.ball_temperature` = 400.*close the bearing"),
        ({"outer_temperature": 700.0}, {}, "mounting.outer_temperature` = 700.*open the bearing: balls would touch at"),
        # The fit does this, not the warm housing beside it.
        ({"shaft_interference": 80e-6, "outer_temperature": 5.0}, {}, "mounting.shaft_interference` = 8e-05.*close the bearing"),
        ({"shaft_interference": 80e-6}, {}, "mounting.shaft_interference` = 8e-05.*close the bearing"),
        ({"shaft_interference": 1e-6, "shaft_bore": 40e-3}, {}, "mounting.shaft_bore` = 0.04: must be smaller than the bearing's bore"),
        ({"housing_interference": 1e-6, "housing_diameter": 50e-3}, {}, "mounting.housing_diameter` = 0.05: must be larger than"),
    ],
)  # fmt: skip
def test_growth_that_leaves_no_bearing_is_refused(mounting, kinematics, words):
    with pytest.raises(SceneError, match=words):
        make_plan(scene(kinematics=kinematics, **mounting))


def test_fits_need_dimensions():
    own = {
        "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": 12, "conformity_inner": 0.522,
        "conformity_outer": 0.522,
    }  # fmt: skip
    one = scene("single", None, bearing={"preset": None, "row_distance": None, **own}, shaft_interference=1e-6)
    with pytest.raises(SceneError, match="mounting.shaft_interference` = 1e-06: needs the bearing's `bore`"):
        make_plan(one)


def test_a_set_that_lost_its_preload_says_what_took_it():
    """A hot housing takes the offset of two rows back to back; what nothing holds is told with the reason."""
    with pytest.raises(ConvergenceError, match=r"preload of 300 N is lost.*mounting.outer_temperature = 30 K"):
        run(scene(outer_temperature=30.0))


@pytest.mark.parametrize(("bodies", "words"), [
    ({"bodies": {"kind": "elastic"}, "mesh": {"kind": "structured"}}, "give kinematics.radial_expansion instead"),
    ({"bodies": {"kind": "condensed"}, "contact": {"discretisation": "nodal"}}, "changes the surfaces of the points"),
])  # fmt: skip
def test_bodies_of_fixed_shape_refuse_temperatures(bodies, words):
    tables = {**scene("single", None, inner_temperature=3.0).to_dict(), "load": {"axial": 100.0}, **bodies}
    with pytest.raises(SceneError, match=words):
        make_plan(scene_from_dict(tables))


def test_temperatures_may_have_a_unit():
    assert scene(inner_temperature="12.5 K").mounting.inner_temperature == 12.5
    with pytest.raises(SceneError, match="inner_temperature"):
        scene(inner_temperature="12.5 m")
