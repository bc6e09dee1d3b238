"""The steady orbit by collocation against the periodic motion by shooting; multipliers in closed form."""

import numpy as np
import pytest

from checks.validation.reference.ring import Ring
from checks.validation.reference.shooting import periodic, swinging
from checks.validation.scenes import rig_force, rotating
from raceway.core.periodic.floquet import Floquet, floquet_of
from raceway.extend import at_time, differentiation, from_orbit, steady_orbit
from raceway.pipeline.simulate import start_of_motion
from raceway.testing import model_of, solve_equilibrium


def test_differentiation_is_exact_for_harmonics():
    times = np.arange(33) * 0.5 / 33
    w = 2.0 * np.pi / 0.5
    signal = np.cos(3.0 * w * times) + np.sin(16.0 * w * times)
    wanted = -3.0 * w * np.sin(3.0 * w * times) + 16.0 * w * np.cos(16.0 * w * times)
    assert differentiation(33, 0.5) @ signal == pytest.approx(wanted, abs=1e-10 * np.abs(wanted).max())


def test_interpolation_reproduces_harmonics():
    times = np.arange(9) * 0.1
    signal = (2.0 + np.cos(2.0 * np.pi * times / 0.9))[:, None]
    assert at_time(signal, 0.9, -0.123)[0] == pytest.approx(2.0 + np.cos(2.0 * np.pi * 0.123 / 0.9), rel=1e-13)


@pytest.mark.parametrize("kind", ["bidirectional", "unidirectional"])
def test_equals_shooting(kind):
    """Weightless balls, 400 N under 505 N at 12 000 r/min: the same motion at all times."""
    tables = rotating(400.0, "locked", 12000.0, False, "newmark")
    tables["excitation"]["kind"] = kind
    tables["contact"]["damping"] = 0.0
    model = model_of(tables)
    w, system = 12000.0 * np.pi / 30.0, model.system
    orbit = steady_orbit(system, 2.0 * np.pi / w, solve_equilibrium(model).displacement)
    ring = Ring(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522)
    if kind == "unidirectional":
        force = swinging(rig_force(12000.0), w)
    else:
        force = system.outer_force
    _, motion, multipliers = periodic(
        ring, system.mass, system.load, force, system.free, orbit.period,
        orbit.displacement[0], orbit.velocity[0], samples=65,
    )  # fmt: skip
    size = np.ptp(motion[:, 1])
    # 65 samples resolve the smooth part of the motion; where balls unload, the spectrum falls off algebraically.
    assert np.abs(motion - orbit.displacement)[:, :3].max() <= 1e-4 * size
    assert np.abs(multipliers) == pytest.approx(1.0, abs=1e-5)  # no damping: the flow keeps volumes


def test_without_inertia_it_is_a_series_of_equilibria():
    model = model_of(rotating(1000.0, "free", 12000.0, True, "newmark"))
    system = model.system
    orbit = steady_orbit(system, 5e-3, solve_equilibrium(model).displacement, samples=9, inertial=False)
    for q, force in zip(orbit.displacement, orbit.force, strict=True):
        rest = system.evaluate(q).force - system.load - force
        assert np.abs(rest * [1, 1, 1, 1 / system.arm, 1 / system.arm]).max() < 1e-5  # N, of 1500 N


def test_a_transient_starts_with_the_orbit_s_acceleration():
    """From the balance of forces, of which damping and the rotor's gyroscopic moment are the larger part here."""
    tables = rotating(1000.0, "free", 12000.0, False, "newmark")
    tables["rotor"] |= {"damping": 2e4, "polar_inertia": 1e-2, "transverse_inertia": 1e-3}
    model = model_of(tables)
    system = model.system
    orbit = steady_orbit(system, 5e-3, solve_equilibrium(model).displacement)
    start = from_orbit(system, orbit, 1e-6)
    weight = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
    size = np.abs(orbit.acceleration * weight).max()
    damped = np.linalg.solve(system.mass, system.damping @ start.v)
    assert np.abs(damped * weight).max() > 0.5 * size
    # 65 samples resolve the motion to 1e-4, its second derivative to some times that.
    assert np.abs((start.a - orbit.acceleration[0]) * weight).max() < 1e-2 * size


@pytest.mark.parametrize("orbiting", [False, True])
def test_friction_starts_on_the_orbit_without_it_where_nothing_sticks(orbiting):
    """By the kernel of balls without slips, whose places stand before the slips of those with friction."""
    tables = rotating(1000.0, "free", 12000.0, True, "newmark")
    tables["contact"] = {"friction": 0.03}
    tables["kinematics"] = {"orbiting": orbiting, "gyroscopic": "none"}
    model = model_of(tables)
    still = model.system.at_standstill()
    assert still.conservative and still.ball_columns == 2 and not model.system.conservative
    orbit = steady_orbit(still, 5e-3, solve_equilibrium(model).displacement)
    start = from_orbit(model.system, orbit, 1e-9)
    now, plain = model.system.evaluate(start.q, start.v, ball=start.ball), still.evaluate(start.q, start.v)
    assert np.abs(now.force - plain.force).max() < 1e-9 * np.abs(plain.force).max()
    assert np.abs(start.ball[:, :2] - plain.ball).max() < 1e-9 * np.abs(plain.ball).max()
    # A nanosecond before, places and slips were the same but for what they move meanwhile.
    assert np.abs(start.ball_before - start.ball).max() < 1e-6 * np.abs(start.ball).max()


@pytest.mark.parametrize("rpm", [1.0, 10.0, 100.0, 150.0])
def test_a_slow_motion_starts_on_its_orbit(built, rpm):
    """No mesh holds vibrations that are 4e3 to 6e5 times as fast as the force; the orbit is then that of Fourier collocation,
    whose secant is the tangent: the force is 3.5e-6 N and more."""
    excitation = {"kind": "bidirectional", "speed_rpm": rpm, "unbalance": 3.2e-4}
    model = built(load={"axial": 1000.0}, excitation=excitation, integrator={"kind": "newmark"})
    now = solve_equilibrium(model)
    start = start_of_motion(model, now)
    assert start.kind == "orbit" and start.repeats and not start.warnings
    found = np.abs(np.fft.rfft(start.orbit.displacement[:, 1])[1]) * 2.0 / len(start.orbit.displacement)
    # Places of 1e-14 m stand in rounded sums of gaps of 1e-5 m.
    assert model.scene.excitation.amplitude_n / found == pytest.approx(now.stiffness[1, 1], rel=1e-5)


@pytest.mark.parametrize(
    "largest, verdict",
    [(0.5, "stable"), (1.0 - 1e-5, "stable"), (1.0 - 1e-8, "neutral"), (1.0 + 1e-8, "neutral"),
     (1.0 + 1e-5, "unstable"), (1.1, "unstable"), (1.19, "unstable"), (3.0, "unstable")],
)  # fmt: skip
def test_what_grows_is_called_unstable(largest, verdict):
    """A part in 1e5 a turn is a factor e in some minutes at 12 000 r/min: a real ring does not stay there."""
    for turn in (1.0, -1.0, np.exp(0.7j)):
        multipliers = np.array([largest * turn, 1.0 / largest * turn.conjugate() if largest > 1 else 0.1])
        found = Floquet(multipliers.astype(complex), multipliers.astype(complex))
        assert found.verdict == verdict
        assert bool(found.leaves_by) == (verdict == "unstable")


def test_what_dies_within_a_span_has_the_multiplier_zero(recwarn):
    over = np.diag([0.0, 0.5, -0.9])
    assert floquet_of(over, np.pi / 6.0).multipliers == pytest.approx([0.9**12, 0.5**12, 0.0])
    assert floquet_of(0.0 * over, np.pi / 6.0).verdict == "stable"
    assert not recwarn.list
