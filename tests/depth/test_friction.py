"""Coulomb friction: stick, slip and hysteresis of a driven contact, energy, convergence, preload untouched."""

import attrs
import numpy as np
import pytest

from raceway import run
from raceway.extend import energy_balance, layout
from raceway.testing import b7206c, model_of, simulate, solve_equilibrium


def rubbing(friction=0.03, turns=3, **tables):
    base = {
        "contact": {"friction": friction, **tables.pop("contact", {})},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
        "integrator": {"turns": turns, "steps_per_turn": 120, **tables.pop("integrator", {})}, "rotor": {"mass": 2.0},
    }  # fmt: skip
    return b7206c(**base, **tables)


class Contact:
    """Reference: one contact with a spring of stiffness k that slides at mu times the normal force."""

    def __init__(self, k: float, mu: float) -> None:
        self.k, self.mu, self.slip, self.lost = k, mu, 0.0, 0.0

    def move(self, u: float, normal: float) -> float:
        force = self.k * (u - self.slip)
        if abs(force) > self.mu * normal:
            force = np.sign(force) * self.mu * normal
            slip = u - force / self.k
            self.lost += force * (slip - self.slip)
            self.slip = slip
        return force


def driven(built, friction, stick=2e7):
    """A bearing pressed down by a held axial displacement, whose inner ring is moved axially back and forth."""
    model = built(
        contact={"friction": friction, "stick_stiffness": stick}, load={"axial": 500.0}, bearing={"preset": "7206A-NSK"}
    )
    system = model.system
    q, ball, _ = system.solve_equilibrium(model.guess)
    states = []
    for s in np.sin(np.linspace(0.0, 4.0 * np.pi, 161)):
        there = q + np.array([4e-6 * s, 0.0, 0.0, 0.0, 0.0])
        now = system.evaluate(there, ball=ball)
        vectors, _ = system.centre_vectors(there)
        states.append((now, ball, vectors))
        ball = now.ball
    return system, states


@pytest.mark.parametrize("friction", [0.001, 0.003, 5.0])
def test_every_contact_follows_the_return_mapping(built, friction):
    """Slips of all contacts in two cycles against the reference, fed with the kernel's own paths and normal forces."""
    system, states = driven(built, friction)
    z = system.ball_count
    li, lo = system.scalars[2], system.scalars[3]
    inner, outer = Contact(1.0, 1.0), Contact(1.0, 1.0)
    inner.k = outer.k = system.scalars[layout.STICK]
    inner.mu = outer.mu = friction
    inner.slip, outer.slip = states[0][1][0, 2:]
    slid = 0
    for now, _, vectors in states:
        x, p = vectors[0] - now.ball[0, :2], now.ball[0, :2]
        for contact, vector, reach, normal, column in (
            (inner, x, li, now.contact_force[0], 2),
            (outer, p, lo, now.contact_force[z], 3),
        ):
            # Of the spring's force k u the share reach / length acts on the ball; the bound holds for that.
            before = contact.slip
            contact.move(reach * np.arctan2(*vector), normal * np.hypot(*vector) / reach)
            slid += abs(contact.slip - before) > 1e-13
            assert now.ball[0, column] == pytest.approx(contact.slip, abs=1e-14)
    assert inner.lost >= 0.0 and outer.lost >= 0.0
    assert (slid > 0) == (friction < 5.0), f"{slid} sliding steps"


def test_balls_balance_with_their_tangential_forces(built):
    """f_i n_i + h_i t_i = f_o n_o + h_o t_o with h rebuilt from the slips."""
    system, states = driven(built, 0.003)
    z, k = system.ball_count, system.scalars[layout.STICK]
    for now, _, vectors in states[::7]:
        total = np.zeros((z, 2))
        for sign, x, reach, column, force in (
            (1.0, vectors - now.ball[:, :2], system.scalars[2], 2, now.contact_force[:z]),
            (-1.0, now.ball[:, :2], system.scalars[3], 3, now.contact_force[z:]),
        ):
            length = np.hypot(*x.T)
            n = x / length[:, None]
            t = np.column_stack([n[:, 1], -n[:, 0]])
            h = k * (reach * np.arctan2(*x.T) - now.ball[:, column]) * reach / length
            assert (np.abs(h) <= 0.003 * force * (1.0 + 1e-6)).all()
            total += sign * (force[:, None] * n + h[:, None] * t)
        assert np.abs(total).max() < 1e-6 * now.contact_force.max()


def test_hysteresis_loop_of_an_axial_drive(built):
    """Work of the ring over the second, closed cycle equals what the contacts lose; none without sliding.  Axially every
    ball does the same.  0.2 %: trapezoids over 80 steps of a cycle."""
    for friction, slides in ((0.001, True), (0.003, True), (0.5, False)):
        system, states = driven(built, friction)
        cycle = states[80:]
        x = np.array([4e-6 * s for s in np.sin(np.linspace(0.0, 4.0 * np.pi, 161))])[80:]
        force = np.array([now.force[0] for now, _, _ in cycle])
        work = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))
        slip = np.array([now.ball[:, 2:] for now, _, _ in cycle])
        vectors = np.array([v for _, _, v in cycle])
        balls = np.array([now.ball[:, :2] for now, _, _ in cycle])
        inner = system.scalars[2] * np.arctan2(*np.moveaxis(vectors - balls, 2, 0))
        outer = system.scalars[3] * np.arctan2(*np.moveaxis(balls, 2, 0))
        pull = system.scalars[layout.STICK] * (np.stack([inner, outer], axis=2) - slip)
        lost = float((0.5 * (pull[1:] + pull[:-1]) * np.diff(slip, axis=0)).sum())
        size = float(np.ptp(force) * np.ptp(x))
        if slides:
            assert lost > 1e-4 * size
            assert work == pytest.approx(lost, rel=0.02)
        else:
            assert abs(work) < 1e-6 * size and lost < 1e-12 * size


def test_closed_form_of_a_sticking_cycle_and_of_a_sliding_one():
    """The reference itself: 4 F (a - F/k) an elastic-ideally-plastic loop of amplitude a and limit F; 0 below F/k."""
    k, mu, normal, a = 2e7, 0.03, 100.0, 1e-6
    contact = Contact(k, mu)
    path = a * np.sin(np.linspace(0.0, 2.0 * np.pi, 4001))
    for _ in range(2):
        before = contact.lost
        for u in path:
            contact.move(u, normal)
    limit = mu * normal
    assert contact.lost - before == pytest.approx(4.0 * limit * (a - limit / k), rel=1e-6)
    small = Contact(k, mu)
    for u in 0.14 * path:
        small.move(u, normal)
    assert small.lost == 0.0


def test_energy_balances_with_friction():
    """Kinetic + stored + lost - work stays within 1e-3 at 360 steps a turn; losses are of first order in the step."""
    drifts = []
    for steps in (180, 360, 720):
        model = model_of(rubbing(0.03, turns=2, integrator={"steps_per_turn": steps}))
        drifts.append(energy_balance(model.system, simulate(model, solve_equilibrium(model)).whole).drift)
    assert drifts[1] < 1e-3 and drifts[2] < 0.7 * drifts[0]


def test_friction_makes_damping_and_is_reported():
    result = run(rubbing(0.03, turns=6)).to_dict()
    found, stability = result["identification"], result["stability"]
    assert found["equivalent_damping"] > 1000.0
    assert stability["friction_energy_j"] > 0.0 and stability["energy_drift"] < 1e-3
    assert any("friction is on" in warning for warning in result["warnings"])
    # In a steady orbit friction loses the force's work, pi F x sin(lag) a turn and direction; 10 %: not yet steady.
    work = (
        2.0 * np.pi * found["force_amplitude_n"] * found["forward_amplitude_m"] * np.sin(np.radians(found["phase_lag_deg"]))
    )
    assert stability["friction_energy_j"] == pytest.approx(6 * work, rel=0.1)
    without = run(rubbing(0.0)).to_dict()
    assert without["stability"]["friction_energy_j"] is None


def test_static_preload_is_untouched(built):
    """The balls have rolled into place: same equilibrium, stiffer against what comes then."""
    for tables in ({}, {"load": {"axial": 800.0, "radial": [200.0, 0.0]}, "supports": {"tilt": "free"}}):
        plain, rubbed = built(**tables), built(contact={"friction": 0.3}, **tables)
        q, _, _ = plain.system.solve_equilibrium(plain.guess)
        q_f, ball, _ = rubbed.system.solve_equilibrium(rubbed.guess)
        np.testing.assert_allclose(q_f, q, rtol=1e-9, atol=1e-15)
        now = rubbed.system.evaluate(q_f, ball=ball)
        scale = np.array([1.0, 1.0, 1.0, 1.0 / plain.system.arm, 1.0 / plain.system.arm])
        assert np.abs((now.force - rubbed.system.load) * rubbed.system.free * scale).max() < 1e-6
        stiffer = (now.stiffness - plain.system.evaluate(q).stiffness) * scale[:, None] * scale
        assert np.linalg.eigvalsh(0.5 * (stiffer + stiffer.T)).min() > -1e-6 * np.abs(now.stiffness[0, 0])


def test_with_sticking_contacts_the_tangent_is_symmetric(built):
    """A contact that sticks has a potential, tilts included."""
    model = built(contact={"friction": 1.0}, supports={"tilt": "free"}, load={"axial": 800.0, "radial": [150.0, 60.0]})
    system = model.system
    q, ball, _ = system.solve_equilibrium(model.guess)
    k = system.evaluate(q + [2e-7, 1e-7, -2e-7, 3e-6, 2e-6], ball=ball).stiffness
    scale = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])
    k = k * scale[:, None] * scale
    assert np.abs(k - k.T).max() < 1e-9 * np.abs(k).max()


def test_no_friction_is_the_limit_of_little_friction(built):
    plain = run(rubbing(0.0)).identification.equivalent_stiffness
    little = run(rubbing(1e-6)).identification.equivalent_stiffness
    assert little == pytest.approx(plain, rel=1e-5)


def test_stick_stiffness_by_default_is_the_ellipses_along_the_groove(built):
    """A part of the normal stiffness, mean of both races at the axial ball load; see tests/core/test_contact.py."""
    model = built(contact={"friction": 0.03})
    q, _, _ = attrs.evolve(model.system).solve_equilibrium(model.guess)
    load = model.system.evaluate(q).contact_force[0]
    races = (model.inner, model.outer)
    stick = np.mean([e.stick_ratio(0.29)[0] * 1.5 * e.factor ** (2 / 3) * load ** (1 / 3) for e in races])
    assert model.system.scalars[layout.STICK] == pytest.approx(stick, rel=0.01)  # the load is estimated to some percent
    assert model.system.scalars[layout.FRICTION] == 0.03


def test_balls_without_mass_rub_as_slow_ones_do():
    """Centrifugal forces of 1e-2 r/min are 1e-12 N; what is rubbed begins at the balls' own places, with mass or without."""
    scene = {
        "load": {"axial": 400.0, "radial": [300.0, 0.0]}, "contact": {"friction": 0.05},
        "excitation": {"kind": "bidirectional", "speed_rpm": 3000.0, "unbalance": 1e-4},
        "integrator": {"kind": "newmark", "turns": 3, "steps_per_turn": 120},
    }  # fmt: skip
    light, slow = (
        run(b7206c(**scene, kinematics=own)).identification.dynamic_stiffness
        for own in ({"ball_inertia": False}, {"spin_speed_rpm": 1e-2})
    )
    assert light == pytest.approx(slow, rel=1e-8)
