"""Rigid rings against independent solvers.

The other solver's numbers are printed with three or four digits: half a unit of the last is at most 0.5 % or 0.05 %.
"""

from contextlib import suppress
from itertools import product

import numpy as np
import pytest
from raceway_article.design import SOLVER_SPEEDS
from raceway_article.trends import TRENDS

from checks.validation.ball_pass import passing_hz, passing_scene, static_amplitude
from checks.validation.equilibria import EXTREME_RESIDUAL, RESIDUAL, families, part, random_scenes, solve
from checks.validation.expected_values import TABLE, axial_row, secant
from checks.validation.gyroscopic import SHARES, axial_displacement, harris_ball
from checks.validation.scenes import random_tables
from checks.validation.tangent import DIFFERENCES, SYMMETRY, asymmetry, cases, deviation
from raceway import RacewayError
from raceway.core.ring.energy import friction_energy
from raceway.extend import phasors
from raceway.testing import b7206c, model_of, settled, simulate, solve_equilibrium

SOLVER = "another rigid-ring solver (checks/validation/expected_values.py)"
TURNING = "another rigid-ring solver (packages/raceway-article/raceway_article/trends.py)"
#: Printed digits, largest relative error of rounding.
ROUNDING = {3: 0.005, 4: 0.0005}
CONVEX = "the potential of loaded rings is convex: there is an equilibrium"


def test_axial_load(claim):
    errors = np.abs([axial_row(axial) / np.array(expected) - 1.0 for axial, expected in TABLE.items()]).max(axis=0)
    for name, columns, digits in (
        ("axial displacement", [0], 4),
        ("contact angle", [1], 4),
        ("ball load", [2], 4),
        ("peak pressure of both races", [3, 4], 4),
        ("axial stiffness", [5], 3),
        ("radial stiffness, tilt locked", [6], 4),
        ("radial stiffness, tilt free", [7], 3),
    ):
        quantity = f"B7206C, 400, 1200, 2000 N axial: {name}: largest relative error"
        error, source = errors[columns].max(), f"{SOLVER}, {digits} digits"
        claim(quantity, error, at_most=ROUNDING[digits], basis="other program", source=source)


def test_secant_stiffness_over_speed(claim):
    """Locked or free tilt, three axial loads, with and without centrifugal force."""
    first, trend = [], []
    for (tilt, axial, inertia), (k, ratios) in TRENDS.items():
        curve = np.array([secant(axial, tilt, speed, inertia) for speed in SOLVER_SPEEDS])
        first.append(abs(curve[0] / k / 1e6 - 1.0))
        trend.append(np.abs(curve[1:] / curve[0] - ratios).max())
    where = f"under the rig's force, {len(TRENDS)} combinations of tilt, axial load, centrifugal force"
    quantity = f"radial stiffness at 10 980 r/min {where}: largest relative error"
    claim(quantity, max(first), at_most=ROUNDING[4], basis="other program", source=f"{TURNING}, 4 digits")
    quantity = f"radial stiffness at 12 000 to 15 000 r/min over that at 10 980 {where}: largest error"
    claim(quantity, max(trend), at_most=0.0005, basis="other program", source=f"{TURNING}, 3 decimals")


def random_solved(count):
    """Random scenes of both laws and their equilibria, without those whose loaded balls leave a motion free."""
    rng, found = np.random.default_rng(11), []
    for number in range(2 * count):
        with suppress(RacewayError):
            found.append(settled(random_tables(rng, "penalty" if number % 4 == 3 else "hertz")))
        if len(found) == count:
            break
    return found


def test_tangent(claim):
    """Named scenes with loose balls, clearance, tilts, 100 000 r/min, and random ones."""
    scenes = [*map(settled, cases().values()), *random_solved(200)]
    assert len(scenes) == 211
    where = "5x5 stiffness of 11 chosen and 200 random scenes"
    largest = max(asymmetry(now.stiffness, model.system.arm) for model, now in scenes)
    source = "forces have a potential; the balls between the races are solved to 1e-11 of their forces"
    claim(f"{where}: asymmetry", largest, at_most=SYMMETRY, basis="closed form", source=source)
    largest = max(deviation(model, now.displacement, now.ball) for model, now in scenes)
    quantity = f"{where}: difference from central differences of the force"
    source = "of fourth order: rounding of forces over steps of 0.1 nm"
    claim(quantity, largest, at_most=DIFFERENCES, basis="own other method", source=source)


def sharpest(time: np.ndarray, signal: np.ndarray, near: float, width: float) -> float:
    """The frequency [Hz] within ``near * (1 +- width)`` at which a sine takes most out of a signal (n,).  Golden-section
    search around the best of a grid a quarter of a spectral line apart."""
    span = time[-1] - time[0]
    straight = signal - np.polyval(np.polyfit(time, signal, 1), time)

    def power(frequency: float) -> float:
        return float(abs(phasors(time, straight[:, None], [frequency])[0, 0]))

    low, high = near * (1.0 - width), near * (1.0 + width)
    grid = np.linspace(low, high, max(int(4.0 * span * (high - low)) + 2, 9))
    best = int(np.argmax([power(f) for f in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    for _ in range(60):
        a, b = high - golden * (high - low), low + golden * (high - low)
        if power(a) > power(b):
            high = b
        else:
            low = a
    return 0.5 * (low + high)


def test_ball_pass(claim):
    frequency, amplitude = [], []
    for balls, tilt in product((4, 7, 12), ("locked", "free")):
        tables = passing_scene(bearing={"ball_count": balls}, supports={"tilt": tilt})
        model = model_of(tables)
        record, expected, static = (
            simulate(model, solve_equilibrium(model)).whole, passing_hz(model), static_amplitude(tables),
        )  # fmt: skip
        for direction in (0, 1):
            motion = record.displacement[:, direction : direction + 1]
            found = sharpest(record.time, motion[:, 0], expected, 0.03)
            frequency.append(abs(found / expected - 1.0))
            harmonics = phasors(record.time, motion, [expected, 2.0 * expected, 3.0 * expected])
            amplitude.append(abs(abs(harmonics[0, 0]) / static[direction] - 1.0))
    where = "4, 7 and 12 balls, 300 N axial, 600 N radial, tilt locked and free"
    quantity = f"ball-pass frequency, {where}: largest relative error"
    source = "Z/2 (1 - D cos(alpha) / d_m) f; a seventeenth of the width of a line over 12 turns or less"
    claim(quantity, max(frequency), at_most=1e-3, basis="closed form", source=source)
    quantity = f"ball-pass amplitude, {where}: largest relative error"
    source = "equilibria at 16 positions of the balls; 1 %: lines of 12 turns leak into each other"
    claim(quantity, max(amplitude), at_most=0.01, basis="own other method", source=source)


def test_gyroscopic_moments(claim):
    source = "Harris' two balances of each ball, solved by MINPACK to 1e-7"
    loads, angles = [], []
    for hypothesis in SHARES:
        spin = {"gyroscopic": hypothesis, "spin_speed_rpm": 30000.0}
        model = model_of(b7206c(load={"axial": 400.0, "radial": [100.0, 50.0]}, supports={"tilt": "free"}, kinematics=spin))
        q, ball, _ = model.system.solve_equilibrium(model.guess)
        now, z = model.system.evaluate(q, ball=ball), model.system.ball_count
        for k, e in enumerate(model.system.centre_vectors(q)[0]):
            qi, qo, ai, ao, *_ = harris_ball(model, e, hypothesis, ball[k, :2] + 2e-7)
            loads.append(np.abs(now.contact_force[[k, z + k]] / [qi, qo] - 1.0).max())
            place = now.ball[k, :2]
            angles.append(np.abs([np.arctan2(*(e - place)) - ai, np.arctan2(*place) - ao]).max())
    where = "gyroscopic moments, 30 000 r/min, 400 N axial, 112 N radial"
    claim(f"{where}: ball loads: largest relative error", max(loads), at_most=1e-7, basis="own other method", source=source)
    quantity = f"{where}: contact angles: largest error"
    claim(quantity, max(angles), at_most=1e-8, unit="rad", basis="own other method", source=source)


@pytest.mark.parametrize("hypothesis", SHARES)
def test_axial_displacement_with_gyroscopic_moments(claim, hypothesis):
    model = model_of(b7206c(load={"axial": 100.0}, kinematics={"gyroscopic": hypothesis, "spin_speed_rpm": 40000.0}))
    q, ball, _ = model.system.solve_equilibrium(model.guess)
    expected = axial_displacement(model, hypothesis, ball[0, :2] + 2e-7, (q[0] - 5e-6, q[0] + 5e-6))
    quantity = f"axial displacement at 40 000 r/min under 100 N, moments {hypothesis} (without moments -13.6 um)"
    source = "Harris' two balances of each ball and MINPACK, 1e-7"
    claim(quantity, 1e6 * q[0], near=1e6 * expected, within=1e-6, unit="um", basis="own other method", source=source)


def rubbing(friction, tilt, integrator, steps):
    return b7206c(
        contact={"friction": friction}, rotor={"mass": 2.0}, supports={"tilt": tilt},
        excitation={"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
        integrator={"kind": integrator, "turns": 3, "steps_per_turn": steps},
    )  # fmt: skip


def test_friction_never_gives_energy_back(claim):
    back = []
    for friction, tilt in product((0.003, 0.03, 0.3, 1.0), ("locked", "free")):
        for integrator in ("newmark", "generalized_alpha", "central_difference", "quasi_static"):
            steps = 360 if integrator == "central_difference" else 120
            model = model_of(rubbing(friction, tilt, integrator, steps))
            whole = simulate(model, solve_equilibrium(model)).whole
            energy = friction_energy(model.system, whole)
            assert whole.schedule.stride == 1 and energy.stored.min() >= 0.0
            back.append(-np.diff(energy.lost).min() + 0.0)
    quantity = "friction 0.003 to 1, four integrators: energy that a step gives back, most of all steps"
    source = "a contact slides along its force only; rounding of some uJ stored"
    claim(quantity, max(back), at_most=1e-15, unit="J", basis="closed form", source=source)


@pytest.fixture(scope="module")
def at_random():
    """Tallies of random scenes, and which."""
    tallies = [solve(random_scenes(law, seed, 500)) for law, seed in (("hertz", 2026), ("penalty", 2027))]
    return tallies, f"{sum(tally.count for tally in tallies)} random scenes, 1 N to 100 kN, to 100 000 r/min, 3 to 60 balls"


@pytest.mark.slow
def test_random_scenes(claim, at_random):
    tallies, where = at_random
    unsolved = [words for tally in tallies for words in tally.unsolved]
    assert not unsolved, unsolved[:5]
    claim(f"{where}: unsolved", len(unsolved), at_most=0, basis="closed form", source=CONVEX)
    largest = max(max(tally.residuals) for tally in tallies)
    source = "a hundred times the solver's tolerance"
    claim(f"{where}: residual over the sum of forces", largest, at_most=RESIDUAL, basis="closed form", source=source)


@pytest.mark.night
def test_time_of_random_scenes(claim, at_random):
    tallies, where = at_random
    median = 1e3 * max(float(np.median(tally.seconds)) for tally in tallies)
    source = "a study of 10 000 points within a minute of one core"
    claim(f"{where}: median time of an equilibrium", median, at_most=5.0, unit="ms", basis="regression", source=source)


@pytest.mark.slow
def test_extreme_scenes(claim):
    """One in thirty of each family, drawn by a fixed seed; refusals of free motions are checked by rank."""
    found = [
        (f"{name}, {law}", solve(part(scenes, 1.0 / 30.0, 7), EXTREME_RESIDUAL))
        for law in ("hertz", "penalty")
        for name, scenes in families(law).items()
    ]
    unsolved = [f"{name}: {words}" for name, tally in found for words in tally.unsolved]
    assert not unsolved, unsolved[:5]
    where = (
        f"{sum(tally.count for _, tally in found)} of 29 160 extreme scenes (1 mN to 1 MN, conformity 0.501 to 0.9, 1 kN m)"
    )
    claim(f"{where}: neither solved nor a motion left free", len(unsolved), at_most=0, basis="closed form", source=CONVEX)
    largest = max(max(tally.residuals) for _, tally in found)
    source = "rounding of 20 kN of centrifugal force beside 1 mN of load"
    claim(f"{where}: residual over the sum of forces", largest, at_most=EXTREME_RESIDUAL, basis="closed form", source=source)
