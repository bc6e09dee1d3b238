"""Static equilibria against scipy's and closed forms, the consistent tangent, and what is refused."""

import numpy as np
import pytest

from checks.validation.equilibria import RESIDUAL, loose, random_scenes, solve
from checks.validation.reference.ring import Ring
from checks.validation.reference.statics import equilibrium
from checks.validation.scenes import imbalance, static
from checks.validation.tangent import cases
from raceway import ConvergenceError
from raceway.extend import layout, resolve
from raceway.testing import Model, model_of, settled, solve_equilibrium


def twin(model: Model) -> Ring:
    """The reference's bearing for a model's scene, from the scene's own numbers."""
    b, scene = model.scene.bearing, model.scene
    spin = resolve(scene).spin_speed if scene.kinematics.ball_inertia else 0.0
    return Ring(
        b.ball_diameter, b.pitch_diameter, b.ball_count, b.contact_angle, b.conformity_inner, b.conformity_outer,
        spin_speed=spin, first_azimuth=np.radians(b.first_ball_azimuth_deg),
    )  # fmt: skip


@pytest.mark.parametrize("law", ["hertz", "penalty"])
def test_scenes_at_random_are_solved_to_the_tolerance(law):
    """The potential of loaded rings is convex: there is an equilibrium.  A tenth of those of evidence/test_rigid.py."""
    tally = solve(random_scenes(law, 2026, 50))
    assert not tally.unsolved and max(tally.residuals) < RESIDUAL


@pytest.mark.parametrize("tilt", ["locked", "free"])
@pytest.mark.parametrize("inertia", [False, True])
@pytest.mark.parametrize("axial", [400.0, 2000.0])
def test_equals_scipy(tilt, inertia, axial):
    model, now = settled(static(axial, tilt, 600.0, 15e3, inertia))
    system, ring = model.system, twin(model)
    wanted = equilibrium(ring, system.load, system.free, np.array([3e-5, 0.0, 0.0, 0.0, 0.0]))
    scale = np.array([1.0, 1.0, 1.0, ring.arm, ring.arm])
    # 1e-8 of the displacement: scipy stops at 1e-10 of the forces, the softest direction amplifies by some 10.
    assert np.abs((now.displacement - wanted) * scale).max() <= 1e-8 * np.abs(wanted * scale).max()
    force, tangent, load = ring(now.displacement)
    assert load == pytest.approx(now.contact_force[:12], rel=1e-7, abs=1e-7)
    assert force[system.free > 0] == pytest.approx(system.load[system.free > 0], abs=1e-6)
    assert np.abs((tangent - now.stiffness) * scale / scale[:, None]).max() <= 1e-6 * np.abs(now.stiffness).max()


def test_random_scenes_are_equilibria_of_the_reference():
    """Independent forces balance at the program's displacement, for scenes over the whole range."""
    worst, checked = 0.0, 0
    for tables in random_scenes("hertz", 5, 40):
        model, now = settled(tables)
        ring, system = twin(model), model.system
        weight = np.array([1.0, 1.0, 1.0, 1.0 / ring.arm, 1.0 / ring.arm])
        # The reference counts from the first touch, a deep-groove bearing from the middle of its clearance.
        touch = [model.geometry.seat - model.geometry.rest[0], 0.0, 0.0, 0.0, 0.0]
        force, _, load = ring(now.displacement - touch)
        rest = (force + system.stiffness @ now.displacement - system.load) * weight * system.free
        worst = max(worst, np.abs(rest).max() / (load.sum() + np.abs(system.load * weight).sum()))
        checked += 1
    assert checked == 40
    # 1e-7: the reference's load factors come from quadrature to 1e-11 and its balls from Newton to 1e-11 of F_c.
    assert worst < 1e-7


def test_one_ball_equals_scipy():
    """Each ball's place between the races, with centrifugal force, against scipy's root finder."""
    model, now = settled(static(400.0, "locked", 700.0, 15e3, True))
    system, ring = model.system, twin(model)
    assert ring.centrifugal == pytest.approx(system.table[0, layout.CENTRIFUGAL], rel=1e-12)
    for k, e in enumerate(ring.centres(now.displacement)):
        assert system.table[k, [layout.COSINE, layout.SINE]] == pytest.approx([ring.J[k, 1, 1], ring.J[k, 1, 2]], abs=1e-12)
        assert now.ball[k] == pytest.approx(ring.one_ball(e), abs=1e-11)


def test_guess_does_not_matter():
    """The potential is convex: from anywhere the same minimum."""
    model, now = settled(static(400.0, "free", 600.0, 15e3, True))
    rng = np.random.default_rng(3)
    for _ in range(20):
        start = rng.normal(size=5) * np.array([2e-4, 2e-4, 2e-4, 5e-3, 5e-3])
        q, ball, _ = model.system.solve_equilibrium(start)
        assert q == pytest.approx(now.displacement, rel=1e-7, abs=1e-12)
        assert imbalance(model, q, ball) < 1e-10


def test_held_axial_displacement():
    tables = static(1000.0, "locked", 500.0)
    alone = settled(static(1000.0, "locked"))[1]
    tables["supports"]["axial"] = "displacement"
    model, now = settled(tables)
    assert now.displacement[0] == pytest.approx(alone.displacement[0], rel=1e-9)
    assert model.system.evaluate(now.displacement).force[1] == pytest.approx(500.0, rel=1e-9)


def test_turning_the_bearing_turns_the_answer():
    """Load and first ball turned by the same angle: the same displacement, turned."""
    model, now = settled(static(400.0, "free", 600.0, 15e3, True))
    tables = static(400.0, "free", 0.0, 15e3, True)
    tables["bearing"]["first_ball_azimuth_deg"] = 40.0
    c, s = np.cos(np.radians(40.0)), np.sin(np.radians(40.0))
    tables["load"]["radial"] = [600.0 * c, 600.0 * s]
    turned = settled(tables)[1].displacement
    turn = np.array([[c, -s], [s, c]])
    assert turned[1:3] == pytest.approx(turn @ now.displacement[1:3], rel=1e-8, abs=1e-15)
    assert turned[3:] == pytest.approx(turn @ now.displacement[3:], rel=1e-8, abs=1e-13)


def test_pure_radial_load_on_an_angular_contact_bearing():
    """It stands at x = -B sin(alpha): the balls carry in the radial plane."""
    model, now = settled(static(0.0, "free", 500.0))
    assert now.displacement[0] == pytest.approx(-model.geometry.rest[0], rel=1e-6)


def test_one_loaded_ball_leaves_a_motion_free():
    tables = static(0.0, "locked", 10.0)
    tables["bearing"]["ball_diameter"], tables["bearing"]["ball_count"] = 9.525e-3, 3
    with pytest.raises(ConvergenceError, match="no stiffness against z") as caught:
        settled(tables)
    assert loose(model_of(tables), caught.value.state["q"])


def test_load_along_a_free_motion_is_named():
    tables = static(1000.0, "locked")
    tables["bearing"]["ball_count"] = 2
    tables["load"]["radial"] = [0.0, 50.0]
    with pytest.raises(ConvergenceError, match="no stiffness against the load along z"):
        settled(tables)


def test_no_load_is_refused():
    with pytest.raises(ConvergenceError, match="no load acts"):
        solve_equilibrium(model_of(static(0.0, "locked")))


@pytest.mark.parametrize("axial", [50.0, 400.0, 1000.0, 4000.0])
@pytest.mark.parametrize("preset", ["B7206C", "7206A"])
def test_the_axial_approach_is_that_of_the_equilibrium(built, preset, axial):
    """Balls without inertia, tilt locked.  Hamrock and Brewe's fits are within 5 % in stiffness; here they are within 1 %."""
    model = built(bearing={"preset": preset}, load={"axial": axial}, kinematics={"ball_inertia": False})
    equilibrium = solve_equilibrium(model)
    approach, load = model.problem.axial_approach
    assert approach == pytest.approx(equilibrium.displacement[0], rel=0.02)
    assert load == pytest.approx(equilibrium.contact_force.mean(), rel=0.005)


CASES = cases()


def test_positive_definite_where_held():
    model, now = settled(CASES["radial load, tilt free, 15 000 r/min"])
    weight = np.array([1.0, 1.0, 1.0, 1.0 / model.system.arm, 1.0 / model.system.arm])
    assert np.linalg.eigvalsh(weight[:, None] * 0.5 * (now.stiffness + now.stiffness.T) * weight)[0] > 0.0


@pytest.mark.parametrize("inertia", [False, True])
def test_damping_tangent_is_the_derivative_by_velocity(inertia):
    """With the balls' rates held, C is the derivative of the force by the ring's velocity."""
    changed = {"kinematics": {"ball_inertia": inertia, "spin_speed_rpm": 15e3}, "contact": {"damping": 200.0}}
    model, now = settled(CASES["radial load, tilt free, 15 000 r/min"] | changed)
    assert model.system.scalars[layout.DAMPING] == 200.0
    found = model.system.evaluate(now.displacement, ball=now.ball).damping
    columns = []
    for i in range(5):
        v = np.zeros(5)
        v[i] = 1e-6 / (model.system.arm if i > 2 else 1.0)
        ahead, behind = (model.system.evaluate(now.displacement, sign * v, ball=now.ball).force for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * v[i]))
    # 1e-6: differences of forces of 1e-4 N in 100 N.
    assert np.abs(np.column_stack(columns) - found).max() <= 1e-6 * np.abs(found).max()


def test_two_balls_in_line_with_the_load_share_it(built):
    """Tangent of the axial direction equals the closed form of equally loaded balls in series."""
    model = built(load={"axial": 1000.0})

    now = solve_equilibrium(model)
    z, load, angle = 12, now.contact_force[0], now.angle_inner[0]
    soft = [2.0 / 3.0 / (ellipse.factor ** (2.0 / 3.0) * load ** (1.0 / 3.0)) for ellipse in (model.inner, model.outer)]
    length = np.hypot(model.geometry.rest[0] + now.displacement[0], model.geometry.rest[1])
    closed = z * (np.sin(angle) ** 2 / sum(soft) + load / length * np.cos(angle) ** 2)
    assert now.stiffness[0, 0] == pytest.approx(closed, rel=1e-9)
