"""Cylindrical rollers against the load zone of Sjovall and Harris and the laminae of ISO/TS 16281, evaluated here without the program.

Each contact follows Palmgren, delta = 3.84e-5 Q^0.9 / L^0.8 in mm and N; both contacts of a roller make 2 delta.  With the
ring's displacement d_r and the clearance P_d, eps = (1 - P_d / (2 d_r)) / 2 and Q(psi) = Q_max [1 - (1 - cos psi) / (2 eps)]^(10/9)
(Harris, Rolling Bearing Analysis, 4th ed., 2001, chapter 7; Sjovall, The load distribution within ball and roller bearings
under given external radial and axial load, 1933).
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import raceway as rw
from checks.validation.scenes import built_in
from raceway import SceneError, build_model, make_plan, scene_from_dict
from raceway.core.ring.kernels.rollers import ten_ninths
from raceway.extend import solve_equilibrium

Line = built_in("contact_law", "line")
CylindricalRollers = built_in("bodies", "cylindrical_rollers")

N = 10.0 / 9.0
LENGTH, FORCE = 9e-3, 4000.0
#: Straight rollers with Palmgren's constant, as the textbooks have them.
TABLES = {
    name: table for name, table in CylindricalRollers.example_scene().items() if name not in ("excitation", "integrator")
} | {
    "bodies": {"kind": "cylindrical_rollers", "roller_length": LENGTH, "crown": 0.0},
    "contact": {"kind": "line", "constant": "palmgren"}, "load": {"radial": [FORCE, 0.0]},
}  # fmt: skip
#: Many thin rollers, whose sum is near the integral.
MANY = {"ball_count": 100, "ball_diameter": 4e-3, "pitch_diameter": 0.2, "bore": 0.15}


def found(clearance=0.0, growth=0.0, force=FORCE, bearing=None, **tables):
    """Model and equilibrium; ``growth`` [m] of the inner raceway makes a clearance of ``clearance - 2 growth``."""
    changed = {**TABLES, "bearing": {**TABLES["bearing"], "radial_clearance": clearance, **(bearing or {})}, **tables}
    changed["kinematics"] = {"ball_inertia": False, "radial_expansion": growth, **tables.get("kinematics", {})}
    model = build_model(scene_from_dict({**changed, "load": {"radial": [force, 0.0]}}))
    return model, solve_equilibrium(model)


def series(length=LENGTH):
    """K of Q = K delta^(10/9) [N/m^(10/9)] of both contacts of a roller."""
    per_load = 2.0 * 3.84e-5 / (1e3 * length) ** 0.8  # mm / N^0.9
    return (1e3 / per_load) ** N


def loads(shift, clearance, azimuth, length=LENGTH):
    return series(length) * np.maximum(shift * np.cos(azimuth) - 0.5 * clearance, 0.0) ** N


@pytest.mark.parametrize(("clearance", "growth"), [(0.0, 0.0), (20e-6, 0.0), (60e-6, 0.0), (0.0, 5e-6), (0.0, 15e-6)])
def test_loads_of_the_rollers_are_the_discrete_sum(clearance, growth):
    model, equilibrium = found(clearance, growth)
    gap, azimuth = clearance - 2.0 * growth, model.azimuth
    shift = brentq(lambda d: loads(d, gap, azimuth) @ np.cos(azimuth) - FORCE, 0.0, 1e-3, xtol=1e-18, rtol=1e-15)
    expected = loads(shift, gap, azimuth)
    # Both are solved to rounding: 1e-11 of the forces here.
    assert equilibrium.displacement[1] == pytest.approx(shift, rel=1e-9)
    for race in np.split(equilibrium.contact_force, 2):
        assert np.abs(race - expected).max() < 1e-9 * FORCE
    assert (equilibrium.contact_force[:13] > 0.0).sum() == (expected > 0.0).sum()


@pytest.mark.parametrize(("clearance", "growth"), [(0.0, 0.0), (10e-6, 0.0), (0.0, 2e-6), (0.0, 10e-6)])
def test_the_load_zone_is_sjovalls(clearance, growth):
    model, equilibrium = found(clearance, growth, bearing=MANY)
    gap, shift = clearance - 2.0 * growth, equilibrium.displacement[1]
    eps = 0.5 * (1.0 - gap / (2.0 * shift))
    inner = equilibrium.contact_force[:100]
    zone = np.maximum(1.0 - (1.0 - np.cos(model.azimuth)) / (2.0 * eps), 0.0) ** N
    assert np.abs(inner / inner.max() - zone).max() < 1e-9
    # A sum over a period with a kink of power n at the zone's edge: (2 pi / Z)^(n + 1) = 3e-3.
    edge = np.pi if eps >= 1.0 else np.arccos(1.0 - 2.0 * eps)
    zone = quad(lambda psi: max(1.0 - (1.0 - np.cos(psi)) / (2.0 * eps), 0.0) ** N * np.cos(psi), 0.0, edge)[0] / np.pi
    assert 100 * inner.max() * zone == pytest.approx(FORCE, rel=3e-3)


@pytest.mark.parametrize("clearance", [0.0, 20e-6])
def test_the_stiffness_is_the_slope_of_the_force(clearance):
    _, middle = found(clearance)
    step = 1e-3 * FORCE
    low, high = (found(clearance, force=FORCE + sign * step)[1].displacement[1] for sign in (-1.0, 1.0))
    # The curvature of the force leaves 1e-6 of a difference over 1e-3.
    assert middle.stiffness[1, 1] == pytest.approx(2.0 * step / (high - low), rel=1e-5)
    # No axial stiffness; laminae resist tilts, which a force in their middle does not cause.
    assert np.abs(middle.stiffness[0]).max() == 0.0 and np.diag(middle.stiffness)[3:].min() > 0.0
    assert np.abs(middle.stiffness[1:3, 3:]).max() < 1e-12 * middle.stiffness[1, 1]


def test_centrifugal_forces_load_the_outer_races_alone():
    speed = 15000.0
    model, equilibrium = found(20e-6, kinematics={"ball_inertia": True, "spin_speed_rpm": speed})
    mass = 7810.0 * 0.25 * np.pi * 9e-3**2 * LENGTH
    cage = 0.5 * speed * np.pi / 30.0 * (1.0 - 9.0 / 46.5)
    inner, outer = np.split(equilibrium.contact_force, 2)
    assert outer - inner == pytest.approx(np.full(13, mass * 0.5 * 46.5e-3 * cage**2), rel=1e-9)
    assert inner @ np.cos(model.azimuth) == pytest.approx(FORCE, rel=1e-9)
    ring = 7810.0 * np.pi * (18.75e-3**2 - 15e-3**2) * 16e-3  # between its bore and where rollers run
    assert model.system.mass[1, 1] == pytest.approx(ring, rel=1e-9)


def test_pressures_are_hertz_line_contacts():
    model, _ = found()
    (pressure,), (along,), (across,) = model.bearing.contact_ellipse(model, 0, np.array([1000.0]))
    radius, modulus = 1.0 / (2.0 / 9e-3 + 2.0 / 37.5e-3), 212e9 / (2.0 * (1.0 - 0.29**2))
    assert pressure == pytest.approx(np.sqrt(1000.0 * modulus / (np.pi * radius * LENGTH)), rel=1e-12)
    assert pressure * np.pi * across * along == pytest.approx(1000.0, rel=1e-12)


@pytest.mark.parametrize(("table", "keys", "path"), [
    ("supports", {"axial": "force"}, "supports.axial"), ("contact", {"kind": "hertz"}, "contact.kind"),
    ("contact", {"kind": "line", "friction": 0.1}, "contact.friction"),
    ("kinematics", {"gyroscopic": "shared"}, "kinematics.gyroscopic"),
    ("load", {"axial": 100.0, "radial": [FORCE, 0.0]}, "load.axial"),
])  # fmt: skip
def test_what_rollers_cannot_do_is_refused_by_its_key(table, keys, path):
    with pytest.raises(SceneError, match=f"`{path}`"):
        make_plan(scene_from_dict({**TABLES, table: keys}))


def of_standard(shift, misalignment, clearance, azimuth, laminae=30, crown=0.00035, length=LENGTH, diameter=9e-3):
    """Radial force [N] along y and moment [N m] of ISO/TS 16281: q = c_s delta^(10/9), delta_jk = delta_j - x_k tan(psi_j) -
    2 P(x_k).  In mm and N: c_s = 35948 L^(8/9) / n, P(x) = 0.00035 D ln[1 / (1 - (2 x / L)^2)]."""
    x = ((np.arange(laminae) + 0.5) / laminae - 0.5) * 1e3 * length
    profile = -crown * 1e3 * diameter * np.log(1.0 - (2.0 * x / (1e3 * length)) ** 2)
    cosine = np.cos(azimuth)[:, None]
    approach = 1e3 * (shift * cosine - 0.5 * clearance) - x * misalignment * cosine - 2.0 * profile
    load = 35948.0 * (1e3 * length) ** (8.0 / 9.0) / laminae * np.maximum(approach, 0.0) ** N
    return (load * cosine).sum(), (load * x * cosine).sum() * 1e-3


@pytest.mark.parametrize("misalignment", [0.0, 3e-4, -1e-3])
@pytest.mark.parametrize("laminae", [30, 41])
def test_laminae_are_those_of_the_standard(misalignment, laminae):
    """Force and moment at a displacement and a tilt; the tilt is about z, which raises the contact by x times itself along y."""
    bodies = {"kind": "cylindrical_rollers", "roller_length": LENGTH, "laminae": laminae}
    scene = scene_from_dict({**TABLES, "bodies": bodies, "contact": {"kind": "line"}, "kinematics": {"ball_inertia": False}})
    model = build_model(scene)
    state = model.system.evaluate(np.array([0.0, 20e-6, 0.0, 0.0, misalignment]))
    force, moment = of_standard(20e-6, -misalignment, 10e-6, model.azimuth, laminae)
    assert state.force[1] == pytest.approx(force, rel=1e-9)
    assert state.force[4] == pytest.approx(moment, rel=1e-9, abs=1e-9)
    assert state.stiffness == pytest.approx(state.stiffness.T, rel=1e-9, abs=1e-6 * np.abs(state.stiffness).max())


@rw.jit(rw.LAW)
def soft_start(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Q = k delta^2, as a third party may have it."""
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        force[i], d_gap[i], d_rate[i] = params[i, 0] * approach**2, -2.0 * params[i, 0] * approach, 0.0


def on_rollers(q, model, push, exponent):
    """(5,) force [N, N m] of rollers that lie where Q_o(p) = Q_i(d - p) + F_c, roller by roller by bisection."""
    bearing, factor = model.scene.bearing, model.system.law_params[0, 0]
    x = ((np.arange(30) + 0.5) / 30 - 0.5) * LENGTH
    drop = -0.00035 * bearing.ball_diameter * np.log(1.0 - (2.0 * x / LENGTH) ** 2)
    total = np.zeros(5)
    for c, s in zip(np.cos(model.azimuth), np.sin(model.azimuth), strict=True):
        d, u = q[1] * c + q[2] * s - 0.5 * bearing.radial_clearance, q[3] * s - q[4] * c

        def load(approach, lean=0.5 * u * x):
            return factor * np.maximum(approach - lean - drop, 0.0) ** exponent / 30

        place = brentq(lambda p, d=d: (load(d - p) - load(p)).sum() + push, -1e-4, 1e-4, xtol=1e-19, rtol=1e-15)
        force, moment = load(d - place).sum(), (x * load(d - place)).sum()
        total += [0.0, force * c, force * s, -moment * s, moment * c]
    return total


@pytest.mark.parametrize("exponent", [10.0 / 9.0, 2.0])
@pytest.mark.parametrize("count", [7, 12, 13])
def test_every_roller_finds_its_place(exponent, count):
    """The law's own force and another one, by its pointer; rollers in whole blocks of lanes and in rests."""
    moving = {"ball_inertia": True, "spin_speed_rpm": 9000.0}
    bearing, bodies = {"ball_count": count}, {"kind": "cylindrical_rollers", "roller_length": LENGTH}
    model, equilibrium = found(10e-6, bearing=bearing, kinematics=moving, bodies=bodies, contact={"kind": "line"})
    inner, outer = np.split(equilibrium.contact_force, 2)
    push = (outer - inner).mean()  # the same at all rollers, see above
    if exponent == 2.0:
        model.system.law, model.system.law_params = soft_start, np.full_like(model.system.law_params, 1e14)
    q, scale = np.array([0.0, 15e-6, -4e-6, 1e-4, 3e-4]), np.array([1.0, 1.0, 1.0, 0.01, 0.01])
    state, expected = model.system.evaluate(q), on_rollers(q, model, push, exponent)
    assert state.force == pytest.approx(expected, rel=1e-11, abs=1e-11 * expected[1])
    again = model.system.evaluate(q, ball=state.ball)
    assert np.abs(again.stiffness - state.stiffness).max() <= 1e-9 * state.stiffness[1, 1]
    for i in range(1, 5):
        step = 1e-10 * np.eye(5)[i] / scale[i]
        slope = (on_rollers(q + step, model, push, exponent) - on_rollers(q - step, model, push, exponent)) / (2 * step[i])
        # Laminae that open within the step: a share of 1e-5 of the slope.
        away = np.abs(slope - state.stiffness[:, i])[1:] / scale[1:] / scale[i]
        assert away.max() < 2e-5 * state.stiffness[1, 1]


def test_a_moment_tilts_the_ring_on_its_rollers():
    load = {"radial": [4000.0, 0.0], "moment": [0.0, 1.0]}
    result = rw.run({"bearing": {"preset": "NU206"}, "supports": {"tilt": "free"}, "load": load})
    clearance = result.model.scene.bearing.radial_clearance
    shift, tilt = result.equilibrium.displacement[1], result.equilibrium.displacement[4]
    numbers = {"length": result.model.scene.bodies.roller_length}
    force, moment = of_standard(shift, -tilt, clearance, result.model.azimuth, **numbers)
    assert (force, moment) == (pytest.approx(4000.0, rel=1e-6), pytest.approx(1.0, rel=1e-6))
    assert tilt > 0.0


def test_the_two_constants_differ_by_three_percent_in_displacement():
    iso, palmgren = Line().coefficient, Line(constant="palmgren").coefficient
    assert iso / palmgren == pytest.approx(1.034, abs=1e-3)


@pytest.mark.slow
def test_energy_of_laminae_balances_along_a_motion():
    """The residual is Newmark's and that of kinks where laminae open: 1.0e-3 with 90 steps per turn, 2.9e-4 with 360."""
    bodies = {"kind": "cylindrical_rollers", "roller_length": LENGTH}
    integrator = {"kind": "newmark", "turns": 2, "steps_per_turn": 360}
    tables = CylindricalRollers.example_scene() | {"bodies": bodies, "integrator": integrator}
    assert rw.run(tables).stability["energy_drift"] < 4e-4


def test_columns_are_the_runs_to_rounding():
    load, kinematics = {"radial": [2000.0, 0.0], "moment": [0.0, 0.5]}, {"spin_speed_rpm": 6000.0}
    scene = {"bearing": {"preset": "NU206"}, "supports": {"tilt": "free"}, "load": load, "kinematics": kinematics}
    keys = ("load.radial[0]", "bearing.radial_clearance", "kinematics.spin_speed_rpm", "bearing.ball_diameter")
    columns = np.linspace((500.0, 5e-6, 0.0, 8.9e-3), (9000.0, 60e-6, 15e3, 9e-3), 5).T
    many = rw.function(scene, keys, ["kyy", "displacement", "ball_load", "p0_inner", "p0_outer"])(*columns)
    assert not many["status"].any()  # all by the compiled loop
    for k, point in enumerate(columns.T):
        result = rw.run(rw.evolve(scene, dict(zip(keys, map(float, point), strict=True))))
        assert many["kyy"][k] == pytest.approx(result.stiffness[1, 1], rel=1e-9)
        assert many["displacement"][k] == pytest.approx(result.equilibrium.displacement, rel=1e-9, abs=1e-14)
        assert many["ball_load"][k].ravel() == pytest.approx(result.equilibrium.contact_force, rel=1e-7, abs=1e-7)
        pressure = [
            result.model.bearing.contact_ellipse(result.model, race, q)[0].max()
            for race, q in enumerate(many["ball_load"][k])
        ]
        assert (many["p0_inner"][k], many["p0_outer"][k]) == pytest.approx(tuple(pressure), rel=1e-12)


@pytest.mark.parametrize(("share", "refused"), [(0.98, False), (1.02, True)])
def test_rollers_are_refused_where_a_contact_is_half_as_wide_as_they_are(share, refused):
    """b = [4 Q R / (pi L E*)]^(1/2) of Hertz, wider at the outer race."""
    d, pitch, modulus = 9e-3, 46.5e-3, 212e9 / (2.0 * (1.0 - 0.29**2))
    radius = 1.0 / (2.0 / d - 2.0 / (pitch + d))
    load = 0.25 * np.pi * LENGTH * modulus * (share * d / 4.0) ** 2 / radius
    bearing = {**TABLES["bearing"], "radial_clearance": 0.0}
    f = rw.function({**TABLES, "bearing": bearing, "kinematics": {"ball_inertia": False}}, ["load.radial[0]"], ["ball_load"])
    force = load / f(FORCE)["ball_load"].max() * FORCE  # all loads grow alike where there is no clearance
    assert (f.looped({"load.radial[0]": np.array([force])})["status"][0] == rw.PointStatus.FAILED) == refused


@pytest.mark.parametrize("name", ["NU206", "N 206 ECP", "NJ1010", "NU 222/C3"])
def test_rollers_come_by_number_with_their_tables(name):
    result = rw.run({"bearing": {"preset": name}, "load": {"radial": [2000.0, 0.0]}})
    scene, geometry = result.model.scene, result.to_dict()["geometry"]
    assert (scene.bodies.name, scene.contact.kind, scene.supports.axial) == ("cylindrical_rollers", "line", "displacement")
    assert {"ball_count", "bodies.roller_length", "radial_clearance"} <= set(geometry["inferred"])
    assert {"ball_diameter", "pitch_diameter", "dynamic_rating"} <= set(geometry["printed"])
    assert result.stiffness[1, 1] > 1e8 and "l10r_hours" not in result.quantities


def test_numbers_of_rollers_meet_what_is_printed():
    """C0 gives the length, so that C is a check; raceway diameters F and E give rollers of whole and half mm."""
    presets = rw.catalogue("NU*")
    assert len(presets) == 44
    for preset in presets:
        assert abs(preset.printed["dynamic_rating_error"]) <= 0.01
        halves = 2e3 * preset.table["ball_diameter"]
        assert halves == pytest.approx(round(halves), abs=1e-6)
        fill = preset.table["ball_count"] * preset.table["ball_diameter"] / (np.pi * preset.table["pitch_diameter"])
        assert 0.76 < fill < 0.87
    (nu206,) = rw.catalogue("NU206")
    assert (nu206.table["ball_count"], nu206.table["ball_diameter"]) == (13, 9e-3)
    assert nu206.table["radial_clearance"] == pytest.approx(32.5e-6)


def test_another_kind_of_bodies_is_not_overruled():
    scene = rw.scene_from_dict({"bearing": {"preset": "NU206"}, "bodies": {"kind": "rigid"}, "load": {"axial": 100.0}})
    assert scene.bodies.name == "rigid"


def test_no_number_stays_none_through_the_force_of_line_contacts():
    gap, out = np.array([-1e-6, np.nan, np.inf, 1e-6, 0.0]), np.zeros((3, 5))
    ten_ninths(gap, np.zeros(5), np.full((5, 1), 2.0), np.zeros((5, 0)), np.zeros((5, 0)), 0.0, *out)
    assert out[0, 0] == pytest.approx(2.0 * 1e-6 ** (10.0 / 9.0), rel=1e-14)
    assert np.isnan(out[0, 1]) and not out[0, 2:].any()
