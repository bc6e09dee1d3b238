"""Friction at surface points: Cattaneo and Mindlin, tangents, history, energy; inertia of balls."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import raceway as rw
from checks.validation.reference.mindlin import Mindlin
from raceway import make_plan, scene_from_dict
from raceway.core.fem.patches.balls import Gyroscopic
from raceway.core.fem.patches.friction import Friction, Traction
from raceway.core.fem.patches.pressure import Contact, SlipState
from raceway.core.fem.patches.system import SlipHistory
from raceway.extend import Increment
from tests.core.patches.test_bearing import RESULTANT, at_rest, off_tangent, tables
from tests.core.validation.single import single

MU, LOAD = 0.1, 300.0


@cache
def pressed():
    """A contact under 300 N, 4 points per semi-axis, and Mindlin's numbers for it."""
    case = single(4, LOAD, shear=True)
    approach, answer = case.at_load(LOAD)
    a, b = (float(axis) for axis in case.ellipse.semi_axes(LOAD))
    return case, approach, answer, Mindlin(a, b, 212e9, 0.29, MU * float(answer.load.sum()))


def pulled(friction: Friction, to: float, slip: np.ndarray) -> Traction:
    _, _, answer, _ = pressed()
    return friction.pull(answer.nodes, answer.load, to, slip)


def at_force(pull: float) -> tuple[float, Traction]:
    """Displacement from rest at which the tractions add up to a force."""
    case, _, _, mindlin = pressed()
    friction = Friction(case.patch, MU)
    low, high = 0.0, 4.0 * float(mindlin.displacement(0.999 * mindlin.limit))
    for _ in range(36):
        middle = 0.5 * (low + high)
        found = pulled(friction, middle, np.zeros(case.patch.rows * case.patch.columns))
        low, high = (middle, high) if found.force < pull else (low, middle)
    return middle, found


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75, 0.9])
def test_a_pulled_contact_slips_in_an_annulus(share):
    """Mindlin's displacement to 2 % (finite bodies give 0.2 to 0.3 nm/N less than half-spaces, 2 % of it, and 4 points some
    percent more where few of them stick); the area that sticks to two rows of points around an ellipse of 8 points."""
    _, _, answer, mindlin = pressed()
    moved, found = at_force(share * mindlin.limit)
    assert moved == pytest.approx(float(mindlin.displacement(share * mindlin.limit)), rel=0.02)
    sticking = found.sliding == 0
    assert sticking.sum() / len(answer.nodes) == pytest.approx(mindlin.stick_share(share * mindlin.limit), abs=0.1)
    # The points with the largest pressures stick.
    assert answer.load[sticking].min() > 0.8 * np.median(answer.load[~sticking])


def test_a_contact_that_is_pulled_further_slides_with_mu_times_its_load():
    case, _, _, mindlin = pressed()
    found = pulled(Friction(case.patch, MU), 2e-6, np.zeros(case.patch.rows * case.patch.columns))
    assert found.force == pytest.approx(mindlin.limit, rel=1e-12)
    assert found.by_place == 0.0
    assert (found.sliding == 1).all()


def test_a_swing_takes_the_energy_of_mindlins_loop():
    """6 %: the discrete annulus is half a row too wide or narrow; 1.4 % with 8 points (docs/nodal_contact.md)."""
    case, _, _, mindlin = pressed()
    force = 0.75 * mindlin.limit
    end, first = at_force(force)
    friction, slip, lost, pull = Friction(case.patch, MU), first.slip, 0.0, first.force
    for place in np.concatenate([np.linspace(end, -end, 40)[1:], np.linspace(-end, end, 40)[1:]]):
        found = pulled(friction, place, slip)
        slip, lost, pull = found.slip, lost + found.lost, found.force
        assert found.lost >= 0.0
    assert pull == pytest.approx(force, rel=1e-9)  # Masing: the loop closes
    assert lost == pytest.approx(mindlin.loop(force), rel=0.06)


def test_the_tangent_is_the_derivative_while_some_points_slide():
    """Inside a step that changes no set of points."""
    case, approach, _, mindlin = pressed()
    contact = Contact(case.patch, None, MU)
    place = case.place(approach)
    slip = np.full(
        case.patch.rows * case.patch.columns, contact.along(place) - float(mindlin.displacement(0.6 * mindlin.limit))
    )
    turn, step = 1e-6, 1e-12

    def answer(moved: np.ndarray, turned: float) -> np.ndarray:
        found = contact.press(place + moved, np.zeros(2), SlipState(turned, slip))
        return np.append(found.force, found.couple)

    now = contact.press(place, np.zeros(2), SlipState(turn, slip))
    assert now.traction_state is not None
    assert 0 < (now.traction_state.sliding == 0).sum() < len(now.nodes)
    for k, way in enumerate(np.eye(2)):
        found = (answer(step * way, turn) - answer(-step * way, turn)) / (2.0 * step)
        assert found[:2] == pytest.approx(-now.stiffness[:, k], abs=1e-4 * np.abs(now.stiffness).max())
        assert found[2] == pytest.approx(now.couple_by_place[k], rel=1e-4, abs=1e-4 * np.abs(now.couple_by_place).max())
    found = (answer(np.zeros(2), turn + 1e-10) - answer(np.zeros(2), turn - 1e-10)) / 2e-10
    assert found[:2] == pytest.approx(-now.by_turn, rel=1e-4, abs=1e-4 * np.abs(now.by_turn).max())
    assert found[2] == pytest.approx(now.couple_by_turn, rel=1e-4)


ROTATING = {
    "load": {"axial": 1000.0, "radial": [0.0, 0.0]}, "mesh": {"nodes_per_semi_axis": 2},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 200.0},
    "rotor": {"mass": 2.0},
}  # fmt: skip


def test_a_bearing_with_friction_has_exact_tangents_and_a_history():
    case, found = at_rest(contact={"friction": 0.05}, supports={"tilt": "free"}, mesh={"nodes_per_semi_axis": 2})
    system = case.system
    rest = system.evaluate(found.displacement, ball=found.ball)
    # Balls have rolled into place: no traction.  Places are known to some 1e-12 m, a contact that sticks has 70 N/um.
    assert max(abs(one.traction_state.force) for one in system.pressures()) < 1e-3
    moved = found.displacement + np.array([2e-7, 3e-7, 1e-7, 5e-5, -3e-5])
    now = system.evaluate(moved, ball=found.ball)
    sliding = [(one.traction_state.sliding != 0).mean() for one in system.pressures()]
    assert 0.0 < np.mean(sliding) < 1.0
    assert off_tangent(system, moved, found.ball) < 1e-3
    # A trial leaves no trace; an accepted state does: on the way back the points pull the other way.
    again = system.evaluate(found.displacement, ball=found.ball)
    assert again.force == pytest.approx(rest.force, abs=1e-2)
    back = system.evaluate(found.displacement, ball=now.ball, step=Increment(memory=now.memory))
    assert np.abs(back.force - rest.force)[:3].max() > 1.0
    assert SlipHistory.of(now.memory, 12).lost.sum() > 0.0


@pytest.mark.slow
def test_points_that_get_more_neighbours_keep_their_memory():
    """A ring that moves further than its patches reach: the same force as on patches that were wide from the beginning."""
    light = {"axial": 300.0, "radial": [0.0, 0.0]}
    case, found = at_rest(contact={"friction": 0.05}, mesh={"nodes_per_semi_axis": 2}, load=light)
    system, far, near = case.system, 2.5 * found.displacement, 1.02 * found.displacement
    first = system.evaluate(near, ball=found.ball)
    narrow = system.pool.patches[0]
    there = system.evaluate(far, ball=first.ball, step=Increment(memory=first.memory))
    assert system.pool.patches[0].rows * system.pool.patches[0].columns > narrow.rows * narrow.columns
    again = system.evaluate(near, ball=found.ball)
    wide = system.evaluate(far, ball=again.ball, step=Increment(memory=again.memory))
    # Rows lie elsewhere on the wider patches: some percent with 2 points along a semi-axis.
    assert there.force[0] == pytest.approx(wide.force[0], rel=0.02)
    assert SlipHistory.of(there.memory, 12).lost.sum() == pytest.approx(SlipHistory.of(wide.memory, 12).lost.sum(), rel=0.1)


def test_what_a_plan_says_of_friction_and_inertia():
    found = scene_from_dict(tables(**ROTATING, contact={"friction": 0.05, "stick_stiffness": 1e8}))
    kept = {part.part for part in make_plan(found).kept}
    assert {"friction", "inertia of the balls in their meridian planes"} <= kept
    slow = scene_from_dict(tables(**ROTATING, integrator={"kind": "quasi_static"}))
    assert "inertia of the balls in their meridian planes" in {part.part for part in make_plan(slow).left_out}
    rubbing, smooth = (plan.predicted_work_s / plan.predicted_steps for plan in map(make_plan, (found, slow)))
    assert rubbing > smooth
    assert any("stick_stiffness" in one and "compliance of rings and balls" in one for one in rw.check(found).warnings)


@pytest.mark.slow
def test_gyroscopic_moments_turn_contacts_as_they_do_with_resultants():
    """Angles of contact at 40 000 r/min to 0.3 degrees (2 points along a semi-axis; the moments move them by degrees); tangents exact."""
    spinning = {"kinematics": {"gyroscopic": "shared", "spin_speed_rpm": 40000.0}, "supports": {"tilt": "free"}}
    spinning["load"] = {"axial": 300.0, "radial": [0.0, 0.0]}
    case, found = at_rest(**spinning, mesh={"nodes_per_semi_axis": 2})
    other = at_rest(**spinning, contact=RESULTANT)[1]
    angles = np.degrees([[one.angle_inner.mean(), one.angle_outer.mean()] for one in (found, other)])
    assert angles[0] == pytest.approx(angles[1], abs=0.3)
    moved = found.displacement + np.array([2e-7, 3e-7, 1e-7, 5e-5, -3e-5])
    assert off_tangent(case.system, moved, found.ball) < 1e-3


@pytest.mark.parametrize(("load", "traction"), [(500.0, 0.0), (5.0, 0.0), (500.0, 0.3), (50.0, 0.3)])
def test_the_moment_of_a_ball_has_exact_derivatives(load, traction):
    """Of central differences of 1e-9 m in 2e-4 m, 1e-6; at the smaller load the inner contact holds no more than that load."""
    turned = Gyroscopic(1.0, 0.2, (1.0, 1.0), 9.525e-3, 4.97e-3, traction)
    places = 2e-4 * np.array([-np.sin(0.3), -np.cos(0.3), np.sin(0.25), np.cos(0.25)])
    contact = 1e6 * np.array([[0.2, 0.1], [0.1, 0.9]])

    def of(moved):
        apart = [load * np.array([np.sin(a), np.cos(a)]) for a in (0.3, 0.25)]
        pressed = [force - contact @ change for force, change in zip(apart, (moved - places).reshape(2, 2), strict=True)]
        states = [SimpleNamespace(force=f, traction_state=None, stiffness=contact, along=np.zeros((2, 2))) for f in pressed]
        return turned.of(moved[:2], moved[2:], states)

    now, step = of(places), 1e-9 * np.eye(4)
    assert (abs(now.couple) == pytest.approx(4.97e-3 * load, rel=1e-12)) == (load == 5.0)
    assert traction == 0.0 or abs(now.couple) < 4.97e-3 * traction * load
    found = -np.column_stack([(of(places + one).force - of(places - one).force) / 2e-9 for one in step])
    assert np.abs(found - now.stiffness).max() < 1e-6 * np.abs(now.stiffness).max()


def test_balls_are_accelerated_by_their_contacts():
    """m a = F_inner + F_outer + F_c at velocities that change evenly, with both formulas of the backward difference."""
    case, rest = at_rest(**ROTATING)
    system, dt, mass = case.system, 1e-5, case.system.ball_mass
    acceleration = np.tile([20.0, -30.0], (12, 1))
    gain, rate = 1.5 / dt, -1.5 / dt * rest.ball[:, :2]  # a velocity of zero at the rest's place
    for known, first in ((1, 1.0), (2, 1.5)):
        memory = np.zeros((24, 5))
        memory[:, 1] = known
        memory[:, 2], memory[:, 3] = (-dt * k * acceleration.T.reshape(-1) for k in (1.0, 2.0))
        now = system.evaluate(
            rest.displacement, ball=rest.ball, ball_rate=rate, v=np.zeros(5), step=Increment(dt, gain, memory)
        )
        force = np.array([one.force for one in system.pressures()])
        balance = force[:12] + force[12:] + np.column_stack([np.zeros(12), system.table[:, 2]])
        velocity = gain * now.ball[:, :2] + rate
        # The place changes by far less than a micrometre, its velocity with it: part of the acceleration.
        assert balance == pytest.approx(mass * (acceleration + first * velocity / dt), abs=1e-6)
        assert np.abs(balance).max() > 0.01  # the contacts give way, or it were mass * 30
        assert now.memory[0, 1] == 2.0
