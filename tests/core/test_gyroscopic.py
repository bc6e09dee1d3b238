"""Gyroscopic moments: of the balls by tangents, size and random equilibria; of ring and rotor by a linear model."""

import attrs
import numpy as np
import pytest

from raceway import SceneError, make_plan, run, scene_from_dict
from raceway.core.ring.kernels.rigid_inertial import rigid_tangential
from raceway.extend import System, solve_equilibrium
from raceway.extend import layout as ring
from raceway.testing import b7206c, ring_inertia

#: Sizes of displacements [m, rad] over which contact forces change by some percent.
STEP = np.array([1e-6, 1e-6, 1e-6, 3e-5, 3e-5])


def fast(built, hypothesis="shared", **tables):
    """B7206C at 30 000 r/min under 400 N axial, 112 N radial, tilts free."""
    loads = {"axial": 400.0, "radial": [100.0, 50.0]}
    kinematics = {"gyroscopic": hypothesis, "spin_speed_rpm": 30000.0, **tables.pop("kinematics", {})}
    return built(**{"load": loads, "supports": {"tilt": "free"}, "kinematics": kinematics, **tables})


def tangent_error(system: System, q: np.ndarray, ball: np.ndarray) -> float | None:
    """Largest deviation of the tangent from fourth-order differences, over its largest entry, tilts times the arm."""
    now, found, change = system.evaluate(q, ball=ball), np.zeros((5, 5)), 0.0
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])
    weight = weight[:, None] * weight
    size = np.abs(now.stiffness * weight).max()
    for j in range(5):
        e = np.zeros(5)
        e[j] = 3e-4 * STEP[j]
        near, far = ([system.evaluate(q + s * k * e, ball=ball) for s in (1, -1)] for k in (1, 2))
        found[:, j] = (8.0 * (near[0].force - near[1].force) - (far[0].force - far[1].force)) / (12.0 * e[j])
        change = max(change, *(np.abs((one.stiffness - now.stiffness) * weight).max() / size for one in far))
    # Where a contact begins to slide inside the differences there is no derivative.
    return None if change > 2e-3 else float(np.abs((found - now.stiffness) * weight).max() / size)


@pytest.mark.parametrize("pair", [{}, {"arrangement": "DB", "preload": 200.0}])
@pytest.mark.parametrize("friction", [0.0, 0.03, 0.5])
@pytest.mark.parametrize("hypothesis", ["none", "outer_race", "shared", "traction"])
def test_the_tangent_is_the_derivative(built, hypothesis, friction, pair):
    """1e-6: what differences of fourth order leave of forces that are solved to 1e-10."""
    model = fast(built, hypothesis, contact={"friction": friction}, bearing={"preset": "B7206C", **pair})
    q, ball, _ = model.system.solve_equilibrium(model.guess)
    rng = np.random.default_rng(7)
    errors = [tangent_error(model.system, q + rng.normal(size=5) * STEP, ball) for _ in range(8)]
    smooth = [error for error in errors if error is not None]
    assert len(smooth) >= 5 and max(smooth) < 1e-6


@pytest.mark.parametrize("off", [1e-16, 1e-10])
def test_forces_do_not_depend_on_the_first_guess(built, off):
    """Balls that settle one after the other leave rounding, and nothing of the first order in their last steps of 1e-16 m."""
    system, rng = fast(built).system, np.random.default_rng(3)
    q, ball, _ = system.solve_equilibrium(np.array([2e-5, 0.0, 0.0, 0.0, 0.0]))
    known = system.evaluate(q, ball=ball)
    for _ in range(20):
        guess = known.ball.copy()
        guess[:, :2] += off * rng.normal(size=guess[:, :2].shape)
        change = system.evaluate(q, ball=guess).force - known.force
        assert np.abs(change[:3]).max() < 2e-14 * known.contact_force.sum()


@pytest.mark.parametrize("contact", [{}, {"kind": "film", "oil": "VG 32", "temperature_c": 40.0}])
def test_without_moment_it_is_the_inertial_kernel(built, contact):
    model = fast(built, "none", contact=contact)
    solve_equilibrium(model)  # a film's thickness is built in
    plain = model.system
    tangential = attrs.evolve(plain, kernel=rigid_tangential, base_kernel=plain.kernel)
    q, ball, _ = plain.solve_equilibrium(model.guess)
    rng = np.random.default_rng(3)
    for _ in range(5):
        there = q + rng.normal(size=5) * STEP
        a, b = plain.evaluate(there), tangential.evaluate(there)
        # Both solve their balls to a relative step of 1e-8 or better, with one correction of second order.
        np.testing.assert_allclose(b.force, a.force, rtol=1e-9, atol=1e-9 * np.abs(a.force).max())
        np.testing.assert_allclose(b.stiffness, a.stiffness, atol=1e-7 * np.abs(a.stiffness).max())
        np.testing.assert_allclose(b.contact_force, a.contact_force, atol=1e-8 * a.contact_force.max())


def test_springs_of_the_shaft_cost_newton_no_iterations(built):
    """They are linear: Newton's method knows them exactly, and one step settles them however stiff they are."""
    free, held = (fast(built, supports={"tilt": tilt}) for tilt in ("free", 1e5))
    assert held.system.stiffness[3, 3] == 1e5 > 3.0 * held.system.evaluate(held.guess).stiffness[3, 3]
    spent, more = (model.system.solve_equilibrium(model.guess)[2] for model in (free, held))
    assert more <= spent + 2


@pytest.mark.parametrize("hypothesis", ["outer_race", "shared"])
def test_the_inner_race_carries_no_more_than_its_load_can(built, hypothesis):
    """Where the inner contact opens its share goes over to the outer race without a jump."""
    model = fast(built, hypothesis, supports={"tilt": "locked"}, load={"axial": 400.0})
    system = model.system
    q, _, _ = system.solve_equilibrium(model.guess)
    along = np.linspace(0.0, 1.0, 4001)
    forces = np.array([system.evaluate(q * [1 - 4.0 * s, 1, 1, 1, 1]).force[0] for s in along])
    steps = np.abs(np.diff(forces))
    assert forces[-1] < 1e-3 * forces[0]
    assert steps.max() < 5.0 * steps[:100].max()


def test_balls_that_the_inner_race_does_not_press_are_held_by_the_outer_one(built):
    """Under a radial load above the axial one, with more clearance than balls on the far side can close."""
    system = built(
        load={"axial": 50.0, "radial": [400.0, 0.0]}, kinematics={"gyroscopic": "shared", "spin_speed_rpm": 30000.0}
    ).system
    q, ball, _ = system.solve_equilibrium(np.array([2e-5, 0.0, 0.0, 0.0, 0.0]))
    inner, outer = system.evaluate(q, ball=ball).contact_force.reshape(2, -1)
    free = inner == 0.0
    assert 0 < free.sum() < len(free)
    np.testing.assert_allclose(outer[free], system.table[free, ring.CENTRIFUGAL], rtol=1e-8)


def test_the_effect_is_tens_of_percent_at_high_speed_and_light_load(built):
    """40 000 r/min, 100 N (physics.md, section 3): against 1 % at 12 000 r/min and 1000 N."""

    def displacement(hypothesis, rpm, axial):
        tables = {"load": {"axial": axial}, "kinematics": {"spin_speed_rpm": rpm, "gyroscopic": hypothesis}}
        model = built(**tables)
        q, ball, _ = model.system.solve_equilibrium(model.guess)
        return q[0], model.system.evaluate(q, ball=ball).stiffness[0, 0]

    x, k = displacement("none", 40000.0, 100.0)
    for hypothesis in ("outer_race", "shared"):
        x_g, k_g = displacement(hypothesis, 40000.0, 100.0)
        assert 0.05 < max(abs(x_g / x - 1.0), abs(k_g / k - 1.0)) < 1.0
    x, k = displacement("none", 12000.0, 1000.0)
    x_g, k_g = displacement("shared", 12000.0, 1000.0)
    assert abs(x_g / x - 1.0) < 0.02 and abs(k_g / k - 1.0) < 0.03


def test_equilibria_of_random_scenes(built):
    """Bearings, ball counts, tilts, loads up to F_r = F_a, up to 40 000 r/min: every one is found and balances."""
    rng = np.random.default_rng(2024)
    for _ in range(70):
        axial = float(rng.uniform(50.0, 2000.0))
        size, angle = float(rng.uniform(0.0, axial)), rng.uniform(0.0, 2.0 * np.pi)
        model = built(
            bearing={"preset": ["B7206C", "7206A-NSK"][rng.integers(2)], "ball_count": int(rng.integers(5, 13))},
            load={"axial": axial, "radial": [float(size * np.cos(angle)), float(size * np.sin(angle))]},
            supports={"tilt": ["locked", "free", 3e4][rng.integers(3)]},
            kinematics={"gyroscopic": ["outer_race", "shared"][rng.integers(2)], "spin_speed_rpm": rng.uniform(1e3, 4e4)},
        )
        system = model.system
        q, ball, _ = system.solve_equilibrium(model.guess)
        rest = (system.evaluate(q, ball=ball).force + system.stiffness @ q - system.load) * system.free
        rest[3:] /= system.arm
        assert np.abs(rest).max() < 1e-8 * axial


def test_moments_without_centrifugal_force_are_refused():
    tables = b7206c(kinematics={"gyroscopic": "shared", "ball_inertia": False, "spin_speed_rpm": 9000.0})
    with pytest.raises(SceneError, match=r"kinematics\.gyroscopic.*ball_inertia"):
        make_plan(scene_from_dict(tables))


def test_moments_of_a_bearing_that_does_not_turn_are_left_out(built):
    plan = built(kinematics={"gyroscopic": "shared"}).plan
    assert plan.balls == "weightless"
    assert any(part.part == "gyroscopic moments of the balls" and "no spin speed" in part.why for part in plan.left_out)


def test_the_scalar_of_the_moment(built):
    """J times inner ring's speed times cage speed, J = m D^2 / 10."""
    model = fast(built)
    g, w = model.geometry, model.problem.spin_speed
    mass = 7810.0 * np.pi / 6.0 * g.ball_diameter**3
    expected = (
        mass * g.ball_diameter**2 / 10.0 * w * 0.5 * w * (1.0 - g.ball_diameter * np.cos(np.radians(15)) / g.pitch_diameter)
    )
    assert model.system.scalars[ring.GYROSCOPIC] == pytest.approx(expected, rel=1e-12)


#: Half the rig's disc [kg m2]: polar inertia about twice the transverse one.
POLAR, TRANSVERSE = 8.05e-3, 4.1e-3
SPEED_RPM = 12000.0


def linear(stiffness: np.ndarray, model, polar: float, whirl: float) -> complex:
    """Z [N/m] of a force that turns with ``whirl`` times the speed, on the tangent of the equilibrium.

    The axis of a ring tilted by (theta_y, theta_z) points along (1, theta_z, -theta_y).  Its angular momentum is
    I_p W (1, theta_z, -theta_y) + I_t (0, theta_y', theta_z'), whose rate is the moment on the ring: +I_p W theta_z' about y
    and -I_p W theta_y' about z.
    """
    w = SPEED_RPM * np.pi / 30.0
    moments = np.zeros((5, 5))
    moments[3, 4], moments[4, 3] = polar * w, -polar * w
    dynamic = stiffness - w**2 * model.system.mass + 1j * w * moments
    force = np.array([0.0, 1.0, -1j * whirl, 0.0, 0.0])
    return 1.0 / np.linalg.solve(dynamic, force)[1]


@pytest.mark.parametrize("polar", [0.0, POLAR])
@pytest.mark.parametrize("whirl", ["forward", "backward"])
def test_what_spins_stiffens_forward_whirl_and_softens_backward_whirl(whirl, polar):
    """The inner ring alone, 1.9e-5 kg m2, and with a disc."""
    force = {"kind": "bidirectional", "speed_rpm": SPEED_RPM, "amplitude": "constant", "force": 0.1, "whirl": whirl}
    rotor = {"polar_inertia": polar, "transverse_inertia": TRANSVERSE if polar else 0.0}
    free = {"supports": {"tilt": "free"}, "contact": {"damping": 0.0}, "integrator": {"kind": "periodic"}}
    result = run(b7206c(load={"axial": 400.0}, rotor=rotor, excitation=force, **free))
    # A hollow cylinder of the bore and a land at 0.2 D, without its groove: 0.5 m (r_i^2 + r_a^2), 10 % more than the ring.
    bore, land = 15e-3, 0.5 * (46e-3 - 9.525e-3) + 0.2 * 9.525e-3
    cylinder = 0.5 * 7810.0 * np.pi * 16e-3 * (land**4 - bore**4)
    ring = ring_inertia(result.model.scene.bearing)[2]
    assert 0.8 * cylinder < ring < cylinder
    expected = linear(result.equilibrium.stiffness, result.model, polar + ring, 1.0 if whirl == "forward" else -1.0)
    # 0.1 N of 400 N: what is not linear in the force is of second order, 1e-6, and amplified by the moments' cancelling.
    assert result.identification.dynamic_stiffness == pytest.approx(expected, rel=1e-4)
