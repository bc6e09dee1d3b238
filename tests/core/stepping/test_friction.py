"""Coulomb friction at points, and of a block on a plane against closed forms."""

import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import ConvergenceError
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.extend import Schedule, drift, integrate
from tests.core.validation.block import POISSON, YOUNG, Block

Newmark = built_in("integrator", "newmark")

WEIGHT, MU = 2.0, 0.3
METHODS = [
    pytest.param(Newmark(), marks=pytest.mark.slow, id="newmark"),
    pytest.param(built_in("integrator", "central_difference")(), id="central_difference"),
]


def points(count: int = 40, seed: int = 1):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(count, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    friction = CoulombFriction(0.2, rng.uniform(1e12, 3e12, count), symmetric=False)
    return rng, normal, friction


def test_points_stick_below_the_limit_and_slip_on_it():
    rng, normal, friction = points()
    shift = 1e-5 * rng.normal(size=(40, 3))
    pressure = np.full(40, 5e7)
    found, _ = friction.evaluate(shift, normal, pressure, np.full(40, -1e13))
    tangential = shift - (shift * normal).sum(axis=1, keepdims=True) * normal
    trial = friction.stick[:, None] * tangential
    size = np.linalg.norm(trial, axis=1)
    assert (friction.slipping == (size > 1e7)).all()
    assert 0 < friction.slipping.sum() < 40
    wanted = np.where((size > 1e7)[:, None], 1e7 * trial / size[:, None], trial)
    assert np.abs(found + wanted).max() < 1e-12 * 1e7
    assert np.abs((found * normal).sum(axis=1)).max() < 1e-9 * 1e7


def test_tangent_is_the_derivative():
    """Central differences; the pressure follows the shift along the normal."""
    rng, normal, friction = points()
    shift, stiffness, h = 1e-5 * rng.normal(size=(40, 3)), 1e13, 1e-11

    def at(s: np.ndarray):
        opened = (s * normal).sum(axis=1)
        return friction.evaluate(s, normal, 5e7 - stiffness * opened * 1e-3, np.full(40, -stiffness * 1e-3))

    _, tangent = at(shift)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = h
        wanted = -(at(shift + step)[0] - at(shift - step)[0]) / (2.0 * h)
        # (h / shift)^2 = 1e-12 of truncation, 1e-16 * 1e7 / (1e-11 * 1e12) = 1e-10 of rounding.
        assert np.abs(tangent[:, :, axis] - wanted).max() < 1e-7 * np.abs(tangent).max()
    friction.symmetric = True
    _, symmetric = at(shift)
    assert np.abs(symmetric - np.swapaxes(symmetric, 1, 2)).max() < 1e-12 * np.abs(symmetric).max()


def test_history_is_committed_only_when_told_and_an_open_point_carries_nothing():
    _, normal, friction = points()
    shift = np.full((40, 3), 1e-6)

    def at(place, pressure=1e9):
        return friction.evaluate(place, normal, np.full(40, pressure), np.zeros(40))[0]

    first = at(shift).copy()
    assert (at(0.0 * shift) == 0.0).all()
    at(shift)
    friction.commit()
    assert np.abs(at(shift) - first).max() < 1e-12 * np.abs(first).max()
    assert at(2 * shift) == pytest.approx(2 * first, rel=1e-12)
    assert (at(shift, 0.0) == 0.0).all()


def test_closed_cycles_lose_four_times_the_amplitude():
    """Sliding to and fro between -A and A: mu p * 4 A a cycle less the springs' part, 4 mu p * (mu p / k)."""
    friction = CoulombFriction(0.2, np.array([1e12]))
    amplitude, limit = 1e-4, 0.2 * 1e7
    normal, pressure = np.array([[0.0, 0.0, 1.0]]), np.array([1e7])
    path = amplitude * np.sin(np.linspace(0.0, 6.0 * np.pi, 6001))
    lost = []
    for x in path:
        friction.evaluate(np.array([[x, 0.0, 0.0]]), normal, pressure, np.zeros(1))
        friction.commit()
        lost.append(friction.dissipated[0])
    cycle = lost[5500] - lost[3500]
    assert cycle == pytest.approx(limit * 4.0 * (amplitude - limit / 1e12), rel=1e-3)


def test_block_sticks_below_the_limit():
    """Pulled with 0.3 mu N and let go: it moves by F / (k A), rocks, shears, and comes back."""

    def pull(t: float) -> float:
        return 0.3 * MU * WEIGHT * np.sin(np.pi * min(t / 4e-3, 1.0)) ** 2

    block = Block(WEIGHT, MU, pull, stick=1e11)
    start = block.at_rest()
    record = integrate(Newmark(), block, start, Schedule(4e-5, 125, 1))
    x, force = record.displacement[:, 0] - block.motion(block.begin(start)).q[0], 0.3 * MU * WEIGHT
    sticking, rocking = force / (1e11 * block.area.sum()), force * 1e-3**2 / (1e12 * 3e-3 * 4e-3**3 / 12.0)
    modulus = YOUNG / (2.0 * (1.0 + POISSON))
    shear = force * 2e-3 / (3.0 * modulus * 12e-6)  # mean over the height, the pull spread over the mass
    # Bending and the vibration that the pull leaves are some 1 %.
    assert x.max() == pytest.approx(sticking + rocking + shear, rel=0.02)
    assert np.abs(x[record.time > 4e-3]).max() < 0.03 * sticking
    assert record.energies["friction"][-1] == 0.0


def test_block_slips_above_the_limit():
    """Pulled with 2 mu N it gathers speed at mu N / m."""
    block = Block(WEIGHT, MU, lambda t: 2.0 * MU * WEIGHT)
    time = 3e-4
    record = integrate(Newmark(), block, block.at_rest(), Schedule(time / 75, 75, 1))
    gained = MU * WEIGHT / block.mass
    # Sticking springs load up first: a delay of some microseconds.
    assert record.velocity[-1, 0] == pytest.approx(gained * time, rel=0.01)
    assert record.displacement[-1, 0] == pytest.approx(0.5 * gained * time**2, rel=0.02)
    assert drift(record.energies) < 1e-6  # Newton's tolerance: the mean forces of a step do the work that it conserves


@pytest.mark.parametrize("method", METHODS)
def test_block_slides_and_stops_as_in_closed_form(method):
    speed = 1.0
    block = Block(WEIGHT, MU)
    deceleration = MU * WEIGHT / block.mass
    time, distance = speed / deceleration, 0.5 * speed**2 / deceleration
    steps = 200 if method.implicit else int(1.4 * time / (0.8 * block.stable_step()))
    record = integrate(method, block, block.at_rest(speed), Schedule(1.4 * time / steps, steps, 1))
    x, v, t = record.displacement[:, 0], record.velocity[:, 0], record.time
    sliding = t < 0.9 * time
    assert np.abs(v[sliding] - (speed - deceleration * t[sliding])).max() < 0.01 * speed
    assert np.abs(x[t > 1.1 * time] - distance).max() < 0.01 * distance  # it stays where it stopped
    assert record.energies["friction"][-1] == pytest.approx(0.5 * block.mass * speed**2, rel=0.01)
    assert drift(record.energies) < 1e-4


@pytest.mark.parametrize("method", METHODS)
def test_two_halves_of_a_block_s_motion_are_the_whole(method):
    dt = 0.5 * Block(WEIGHT, MU).stable_step()

    def run(start, first, steps):
        block = Block(WEIGHT, MU, lambda t: 3.0 * MU * WEIGHT * np.sin(3e4 * t))
        begin = block.at_rest() if start is None else start
        return integrate(method, block, begin, Schedule(dt, steps, 1, first=first))

    whole = run(None, 0, 80)
    half = run(None, 0, 40)
    rest = run(half.final, 40, 40)
    assert (np.concatenate([half.displacement, rest.displacement]) == whole.displacement).all()
    assert rest.energies["friction"][-1] == whole.energies["friction"][-1] > 0.0


def test_a_step_that_finds_no_balance_leaves_state_and_history():
    block = Block(WEIGHT, MU)
    start = block.at_rest(1.0)
    block.solve = lambda *_: np.full(block.size, 1e-9)  # type: ignore[method-assign]
    with pytest.raises(ConvergenceError, match="did not converge after 0 of 10 steps") as caught:
        integrate(Newmark(), block, start, Schedule(1e-6, 10, 1))
    state = caught.value.state
    assert (state["u"] == start.full_state["u"]).all()
    assert len(state["residuals"]) == 40
    assert np.isfinite(state["residuals"]).all()
