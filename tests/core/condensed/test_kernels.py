"""Kernels of condensed bodies with chosen compliances: zero is rigid, tangents are exact, loops keep their energy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from raceway import ConvergenceError
from raceway.core.fem.structural import ElasticBodies, RingCompliance, elastic_system
from raceway.core.ring.kernels import STORED
from raceway.core.signatures import Balls, Constants, Contacts, Response
from raceway.extend import Schedule, System, energy_balance, from_orbit, integrate, layout, static_orbit, steady_orbit
from raceway.testing import b7206c, model_of

ANGLES = np.linspace(-0.7, 0.7, 13)
#: Of the inner ring, the outer ring, a ball on itself and from its other contact [m/N]: docs/physics.md, condensed bodies.
INNER, OUTER, BALL, OPPOSITE = -0.62e-9, -0.64e-9, -0.304e-9, 0.167e-9
#: Between groove centres on elastic beds of 500 N/mm3, none to six balls further: axial by axial, axial by radial, radial by
#: radial force [m/N]; a little skewed, as rings of another section have it.
BED = 1e-9 * np.array([
    [5.5, -0.6, 5.3], [2.9, -0.25, 0.71], [1.07, -0.09, -0.77], [0.47, -0.02, -0.4], [0.16, 0.0, -0.12], [0.03, 0.0, -0.06],
    [0.0, 0.0, -0.05],
])  # fmt: skip


def ring(own: float, slope: float = 0.0, balls: int = 12, between: np.ndarray | None = None) -> RingCompliance:
    """A ring whose own compliance [m/N] changes by ``slope`` [m/N/rad] and as much again by its square.

    between : (7, 3) compliances between groove centres; the first one is added to the ring's own.
    """
    values = own + slope * (ANGLES - 0.3) + slope * (ANGLES - 0.3) ** 2
    table = np.zeros((len(ANGLES), len(ANGLES), balls))
    if between is not None:
        sine, cosine = np.sin(ANGLES), np.cos(ANGLES)
        for k in range(balls):
            axial, cross, radial = between[min(k, balls - k)]
            table[:, :, k] = axial * np.outer(sine, sine) + radial * np.outer(cosine, cosine)
            table[:, :, k] += cross * (np.outer(sine, cosine) + np.outer(cosine, sine))
        values = values + np.diagonal(table[:, :, 0])
    return RingCompliance(ANGLES, values, table, 1, np.array([1e-3]), 1e-3)


def elastic(
    system: System, factor: float = 1.0, slope: float = 0.0, bed: bool = False, inner: float = INNER, outer: float = OUTER,
    rows: int = 1,
) -> System:  # fmt: skip
    """A rigid system with chosen compliances, all times ``factor``; with ``bed`` both rings of each row couple their balls."""
    balls = system.ball_count // rows
    rings = [ring(factor * own, factor * slope, balls, factor * BED * part if bed else None)
             for own, part in ((inner, 1.3), (outer, 1.0))]  # fmt: skip
    bodies = ElasticBodies(rings[0], rings[1], factor * BALL, factor * OPPOSITE)
    return elastic_system(system, bodies, np.full(system.ball_count, 0.32) if bed else None)


ROTATING = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "unbalance", "unbalance": 6.39e-4, "load_share": 0.5}
#: What ball and contacts can be, each another kernel or branch.
SCENES = {
    "weightless": {"kinematics": {"ball_inertia": False}}, "inertial": {}, "penalty": {"contact": {"kind": "penalty"}},
    "damped": {"contact": {"damping": 50.0}}, "gyroscopic": {"kinematics": {"gyroscopic": "outer_race"}},
    "shared": {"kinematics": {"gyroscopic": "shared"}}, "stick": {"contact": {"friction": 0.03}},
    "slip": {"contact": {"friction": 0.0005}}, "light": {"load": {"axial": 60.0, "radial": [50.0, 0.0]}},
}  # fmt: skip


def model(tilt="free", load=None, **more):
    load = {"axial": 800.0, "radial": [300.0, 100.0], **(load or {})}
    rotor = {"mass": 2.0, "transverse_inertia": 1e-3}
    return model_of(b7206c(load=load, supports={"tilt": tilt}, rotor=rotor, excitation=ROTATING, **more))


def rest_of(soft, guess):
    """Displacements, balls and forces at rest."""
    q, ball, _ = soft.solve_equilibrium(guess)
    return q, ball, soft.evaluate(q, ball=ball)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("bed", [False, True])
def test_without_compliances_it_is_the_rigid_bearing(name, bed):
    """To 1e-12: the same kernel finds the same forces, and only rounding is added."""
    rigid = model(**SCENES[name])
    q, _, now = rest_of(rigid.system, rigid.guess)
    soft = elastic(rigid.system, factor=0.0, bed=bed)
    mine, place, then = rest_of(soft, rigid.guess)
    scale = np.array([1.0, 1.0, 1.0, soft.arm, soft.arm])
    # Both are solved to 1e-11 of the forces.
    assert np.abs((mine - q) * scale).max() < 1e-10 * np.abs(q * scale).max()
    weight = np.outer(1.0 / scale, 1.0 / scale)
    assert np.abs((then.stiffness - now.stiffness) * weight).max() < 1e-9 * np.abs(now.stiffness * weight).max()
    assert np.abs(soft.structural_approach(place)).max() == 0.0


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("bed", [False, True])
def test_tangents_are_the_derivatives(name, bed):
    """Central differences with their own error: 1e-8 of the largest entry; with slip, 1e-6 where a contact turns over."""
    rigid = model(**SCENES[name])
    soft = elastic(rigid.system, slope=1.3e-9, bed=bed)
    q, ball, _ = soft.solve_equilibrium(rigid.guess)
    random = np.random.default_rng(3)
    q = q * (1.0 + 0.03 * random.standard_normal(5))
    v = np.array([1e-3, 1e-2, 1e-2, 0.1, 0.1]) * random.standard_normal(5) if name == "damped" else np.zeros(5)
    now = soft.evaluate(q, v, ball=ball)
    scale = np.array([1.0, 1.0, 1.0, soft.arm, soft.arm])
    found = np.empty((5, 5))
    for j in range(5):
        step = np.zeros(5)
        step[j] = 1e-10 / scale[j]
        ahead, behind = (soft.evaluate(q + s * step, v, ball=ball).force for s in (1.0, -1.0))
        found[:, j] = (ahead - behind) / (2.0 * step[j])
    weight = np.outer(1.0 / scale, 1.0 / scale)
    largest = np.abs(now.stiffness * weight).max()
    # Under dashpots the kernels leave out how the lines of contact turn: 1e-5 here, with rigid bodies too.
    limit = 5e-5 if name == "damped" else 1e-6 if name == "slip" else 1e-8
    assert np.abs((found - now.stiffness) * weight).max() < limit * largest
    if name in ("weightless", "inertial", "penalty", "damped", "light"):
        assert np.abs((now.stiffness - now.stiffness.T) * weight).max() < 1e-12 * largest


@pytest.mark.parametrize("slope", [0.0, 1.3e-9])
def test_compliances_follow_the_angle_between_the_table_s_knots(slope):
    """Law and structure in series, w = C Q: contact by contact, against scipy's cubic spline without slope at its ends."""
    rigid = model()
    soft = elastic(rigid.system, slope=slope)
    q, ball, now = rest_of(soft, rigid.guess)
    force, z = now.contact_force, soft.ball_count
    angle, change = np.arctan2(*soft.centre_vectors(q)[0].T), slope * (ANGLES - 0.3) * (ANGLES + 0.7)
    assert np.ptp(angle) > 0.02
    own = [CubicSpline(ANGLES, ring + BALL + change, bc_type=((1, 0.0), (1, 0.0)))(angle) for ring in (INNER, OUTER)]
    other = OPPOSITE * np.r_[force[z:], force[:z]]
    assert soft.structural_approach(ball) == pytest.approx(np.concatenate(own) * force + other, rel=1e-9)


def test_groove_centres_move_as_the_loads_of_all_balls_push_them():
    """On beds d = -M F - M_o F_c with the matrices that the kernels never form, F from angles and contact forces."""
    rigid = model()
    soft = elastic(rigid.system, bed=True)
    q, ball, now = rest_of(soft, rigid.guess)
    force, z = now.contact_force, soft.ball_count
    reach = soft.centre_vectors(q, ball=ball)[0] - ball[:, :2]
    # A contact's own compliance is constant beyond its groove's motion here: no part of the force leans.
    push = force[:z, None] * reach / np.linalg.norm(reach, axis=1)[:, None]
    outer = push + np.column_stack([np.zeros(z), soft.table[:, 2]])
    lag = np.abs(np.arange(z)[:, None] - np.arange(z))
    block = BED[np.minimum(lag, z - lag)][:, :, [0, 1, 1, 2]].reshape(z, z, 2, 2)
    # A ring's own compliance that is the same in all directions moves its groove, too.
    moved = -np.einsum("kjab,jb->ka", block, 1.3 * push + outer) - INNER * push - OUTER * outer
    assert np.abs(moved).max() > 2e-6
    assert soft.groove_displacement(ball) == pytest.approx(moved, rel=1e-7, abs=1e-13)


@pytest.mark.parametrize("name", ["weightless", "inertial"])
def test_stored_energy_is_the_work_of_the_force(name):
    """On beds the energy of bodies and contacts between two states is the integral of the force: Gauss' rule, to 1e-9."""
    rigid = model(**SCENES[name])
    soft = elastic(rigid.system, slope=1.3e-9, bed=True)
    q, ball, _ = soft.solve_equilibrium(rigid.guess)
    ahead = q * np.array([1.02, 1.1, 0.9, 1.05, 0.95])

    def energy(place):
        work, rest = soft._work(), ball.copy()
        contacts = Contacts(soft.law, soft.law_params, soft.law_state, soft.law_state.copy(), 0.0)
        response = Response(np.empty(5), np.empty((0, 0)), np.empty((0, 0)), work)
        balls = Balls(rest, 0.0, np.zeros_like(ball))
        soft.kernel(0.0, place, np.zeros(5), balls, contacts, Constants(soft.scalars, soft.table), response)
        factor = np.repeat([rigid.inner.factor, rigid.outer.factor], soft.ball_count)
        hertz = 0.4 * factor * np.maximum(-work[0], 0.0) ** 2.5
        return hertz.sum() + work[STORED].sum() - (soft.table[:, layout.CENTRIFUGAL] * rest[:, 1]).sum()

    x, w = np.polynomial.legendre.leggauss(8)
    work = sum(
        0.5 * part * soft.evaluate(q + 0.5 * (1.0 + at) * (ahead - q), ball=ball).force @ (ahead - q)
        for at, part in zip(x, w, strict=True)
    )
    assert energy(ahead) - energy(q) == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("kind", ["newmark", "generalized_alpha", "central_difference", "quasi_static"])
@pytest.mark.parametrize("bed", [False, True])
def test_every_loop_runs_and_keeps_its_energy(kind, bed):
    """The drift of the rigid bearing's motion, which belongs to the integrator, may double; equilibria follow the orbit."""
    case = model(tilt="locked", integrator={"kind": kind})
    method, period = case.scene.integrator.method, case.excitation.period_s
    steps = 1440 if kind == "central_difference" else 360
    schedule = Schedule(period / steps, steps, 2)
    drift = []
    for system in (case.system, elastic(case.system, slope=1.3e-9, bed=bed)):
        q, ball, _ = system.solve_equilibrium(case.guess)
        orbit = steady_orbit(system, period, q, inertial=method.inertial)
        start = from_orbit(system, orbit, schedule.dt) if method.inertial else static_orbit(system, q, ball, False)
        record = integrate(method, system, start, schedule, None)
        assert record.ball.shape[2] == system.ball_columns
        if method.inertial:
            drift.append(energy_balance(system, record).drift)
        # The orbit is the exact periodic motion; 360 steps a turn leave 1e-4 of it.
        turn = np.abs(record.displacement[-1, 1:3] - orbit.displacement[0, 1:3]).max()
        assert turn < 1e-3 * np.abs(orbit.displacement[:, 1:3]).max()
    if drift:
        assert drift[1] < 2.0 * drift[0] + 1e-9


def test_structural_approach_has_a_rate():
    """With strong dashpots the elastic ring takes a part of the speed: only with its rate errors fall by 4 a halved step.  3
    allows for the third order that is left at these steps."""
    case = model(tilt="locked", contact={"damping": 2000.0}, integrator={"kind": "newmark"})
    soft = elastic(case.system, outer=5e-9)
    period = case.excitation.period_s
    q, _, _ = soft.solve_equilibrium(case.guess)
    orbit = steady_orbit(soft, period, q)
    method, ends = case.scene.integrator.method, []
    for steps in (180, 360, 720):
        schedule = Schedule(period / steps, steps, 1)
        ends.append(integrate(method, soft, from_orbit(soft, orbit, schedule.dt), schedule, None).displacement[-1, 1:3])
    assert np.abs(ends[0] - ends[1]).max() > 3.0 * np.abs(ends[1] - ends[2]).max()
    assert np.abs(ends[2] - orbit.displacement[0, 1:3]).max() < 1e-4 * np.abs(orbit.displacement[:, 1:3]).max()


def test_a_contact_that_bodies_outdo_is_a_failure_and_no_number():
    rigid = model()
    with pytest.raises(ConvergenceError):
        elastic(rigid.system, factor=30.0).solve_equilibrium(rigid.guess)


def test_a_pair_couples_only_balls_of_one_row():
    case = model(bearing={"arrangement": "DB", "preload": 300.0})
    z = case.geometry.ball_count
    soft = elastic(case.system, slope=1.3e-9, bed=True, rows=2)
    both, outer = soft.between_balls()
    assert both.shape == outer.shape == (4 * z, 4 * z)
    assert not both[: 2 * z, 2 * z :].any() and both[: 2 * z, : 2 * z] == pytest.approx(both[2 * z :, 2 * z :])
    q, ball, now = rest_of(soft, case.guess)
    step = np.array([1.0, -0.6, 0.8, 40.0, 30.0]) * 1e-10
    ahead, behind = (soft.evaluate(q + sign * step, ball=ball).force for sign in (1.0, -1.0))
    assert 0.5 * (ahead - behind) == pytest.approx(now.stiffness @ step, rel=1e-6)
