"""Friction of balls against printed numbers, limits, quadratures over the contact ellipse, and the power and torque that others state."""

import attrs
import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.special import ellipe

from raceway.core.quantities.losses import exponential, logarithm, mean_slip
from raceway.core.quantities.rolling_friction import MEASURED, losses, spin_shape
from tests.core.validation import rolling_friction as published


@pytest.mark.parametrize("load", [50.0, 500.0])
def test_rolling_loss_is_that_of_its_source(load):
    """Biboulet, Houpert, eq. 27 and 38: 64 b^3 p^5 / (E'^3 eta) 13.7 / (k M^(7/3)), where 6.6 / M of the way to isoviscous contacts is short."""
    ball, speed = published.contacts((load, load)), 0.1
    oil = attrs.evolve(published.OIL, temperature_viscosity=1e-30)
    a, b, e, along = ball.semi_major[0, 0, 0], ball.semi_minor[0, 0, 0], ball.modulus, ball.along[0, 0, 0]
    peak = 1.5 * load / (np.pi * a * b)
    m = (b * e / (np.pi * peak * along)) ** 0.25 * (b / a) * load / (e * along**2) * (e * along / (0.06 * speed)) ** 0.75
    power = 64.0 * b**3 * peak**5 / (e**3 * 0.03) * 13.7 / ((b / a) * m ** (7.0 / 3.0))
    assert speed * published.hydrodynamic_force(ball, oil, np.full((1, 2, 1), speed))[0, 0, 0] == pytest.approx(
        power, rel=0.05
    )


def test_torque_of_a_spin_down_is_measured_so():
    """Of three balls in a thrust bearing, mixed films at the slowest: within the factors that the band knows of it."""
    known = MEASURED[0]
    ratios = [measured / computed for _, measured, computed in published.spin_down()]
    assert known.least == pytest.approx(min(ratios), abs=0.01) and known.largest == pytest.approx(max(ratios), abs=0.01)


def test_heat_of_the_inlet_takes_a_part_of_the_rolling_resistance():
    speed = np.full((1, 2, 1), 20.0)
    hot, cold = (
        published.hydrodynamic_force(published.contacts(), attrs.evolve(published.OIL, temperature_viscosity=b), speed)
        for b in (0.04, 1e-30)
    )
    assert hot / cold == pytest.approx(1.0 / (1.0 + 0.29 * (0.03 * 0.04 * 20.0**2 / 0.14) ** 0.78), rel=1e-12)


def test_hysteresis_is_that_of_a_loss_of_two_percent():
    for load in (1.0, 100.0):
        assert 0.02 < published.hysteresis_loss(load) < 0.026


@pytest.mark.parametrize(("spin", "curvature"), [(1.0, 0.0), (0.0, 1.0), (0.2, 1.0), (0.5, 1.0), (0.8, 1.0), (1.0, 1.0)])
def test_the_mean_slip_is_the_least_over_the_place_of_rolling(spin, curvature):
    t = np.linspace(-1.0, 1.0, 20001)

    def mean(c):
        return np.trapezoid(0.75 * (1.0 - t * t) * np.abs(spin * t + curvature * (t * t - c)), t)

    least = minimize_scalar(mean, bounds=(-0.5, 0.5), method="bounded").fun
    assert mean_slip(spin, curvature) == pytest.approx(least, rel=1e-4)


def test_slip_has_the_published_limits():
    """Houpert: 3/8 mu Q a of spin and 0.0806 mu Q a^2 / R of the contact's curvature, whose slip is y^2 / (2 R)."""
    assert mean_slip(1.0, 0.0) == 0.375
    assert f"{0.5 * mean_slip(0.0, 1.0):.4f}" == "0.0806"
    k = np.array([1.0, 1.5, 4.0, 9.0, 30.0])
    assert spin_shape(k) == pytest.approx(ellipe(1.0 - 1.0 / k**2), abs=4e-5)


def test_spin_with_curvature_over_the_whole_ellipse():
    """Quadrature in two dimensions of Coulomb friction along the slip; the strip's formula is within 4 % at k = 3, 1 % at 8."""
    x, weight = np.polynomial.legendre.leggauss(400)
    radius, angle = np.sqrt(0.5 * (x + 1.0)), 2.0 * np.pi * np.arange(400) / 400
    y, z = (np.outer(radius, f(angle)) for f in (np.cos, np.sin))
    pressure = 1.5 * np.sqrt(1.0 - radius**2)[:, None] * weight[:, None] / (2.0 * 400)
    for k, spin, curvature in ((8.0, 1.0, 0.3), (8.0, 0.4, 1.0), (3.0, 1.0, 0.5), (3.0, 0.3, 1.0)):

        def mean(c, k=k, spin=spin, curvature=curvature):
            along = spin * y + curvature * (y**2 - c)
            return float((pressure * np.hypot(along, spin * z / k)).sum())

        least = minimize_scalar(mean, bounds=(-0.5, 0.5), method="bounded").fun
        shaped = float(spin * spin_shape(np.array(k)))
        assert mean_slip(shaped, curvature) == pytest.approx(least, rel=0.01 if k > 5.0 else 0.04)


def test_balls_roll_at_both_races_and_one_contact_does_not_spin():
    for outer in (True, False):
        ball = published.contacts((60.0, 300.0) if outer else (300.0, 310.0), (0.5, 0.3))
        rates = published.ball_rates(ball, outer_race=True)
        g = 9.525e-3 / 46e-3 * np.cos(ball.angle[0, :, 0])
        # Speeds of the surfaces from rates: (w - w_c) d_m (1 - g) / 2 and w_c d_m (1 + g) / 2.
        cage = rates.cage[0, 0, 0]
        expected = [(1.0 - cage) * 23e-3 * (1.0 - g[0]), cage * 23e-3 * (1.0 + g[1])]
        assert rates.entraining[0, :, 0] == pytest.approx(expected, rel=1e-12)
        assert rates.spin[0, 1, 0] == pytest.approx(0.0, abs=1e-14) and rates.spin[0, 0, 0] > 0.1
    # At equal angles without centrifugal force the ball's spin goes where it costs less.
    free = published.ball_rates(published.contacts((300.0, 300.0), (0.5, 0.5))).spin[0, :, 0]
    assert 0.0 < free.min() < free.max()


def test_traction_follows_eyring_up_to_its_limit():
    ball, speed = published.contacts(), np.full((1, 2, 1), 5.0)
    thin = attrs.evolve(published.OIL, pressure_viscosity=1e-12, traction_limit=1.0)
    slow, fast = (published.traction_coefficient(ball, thin, np.full((1, 2, 1), v), speed) for v in (1e-6, 2e-6))
    assert fast == pytest.approx(2.0 * slow, rel=1e-6)  # Newton's fluid below the Eyring stress
    assert published.traction_coefficient(ball, published.OIL, np.full((1, 2, 1), 0.5), speed) == pytest.approx(0.05)
    assert published.traction_coefficient(ball, published.OIL, np.zeros((1, 2, 1)), speed) == pytest.approx(0.0)


def test_drag_is_that_of_a_sphere():
    assert published.drag_over_sphere() == pytest.approx(1.0, rel=1e-9)


def test_limits_of_the_torque():
    still, speed = np.zeros(1), np.array([1000.0])
    ball = published.contacts()
    at_rest = losses(ball.compiled(), published.OIL, still)
    assert at_rest.contact_power.sum() == at_rest.drag_power[0] == at_rest.seal_power[0] == 0.0
    assert published.rolling_without_oil() < 1e-12
    half = attrs.evolve(ball, load=np.array([[[0.0], [200.0]]]), angle=np.array([[[np.nan], [0.26]]]))
    opened = losses(half.compiled(), published.OIL, speed)
    assert opened.contacts[0, 0, 0] == 0.0 and opened.contacts[0, 1, 0] > 0.0
    total = losses(ball.compiled(), published.OIL, speed, seals=0.01)
    assert total.torque[0] * 1000.0 == pytest.approx(
        total.contact_power.sum() + total.drag_power[0] + total.seal_power[0], rel=1e-12
    )


def test_a_gyroscopic_moment_adds_slip_across_until_the_ball_slips_sideways():
    ball, speed = published.contacts(angle=(0.5, 0.4)), np.array([1000.0])
    plain = losses(ball.compiled(), published.OIL, speed).sliding
    part = losses(attrs.evolve(ball, inertia=1e-8).compiled(), published.OIL, speed)
    assert part.sliding / plain == pytest.approx(1.0 / np.sqrt(1.0 - part.gyroscopic[0, 0] ** 2), rel=1e-12)
    heavy = losses(attrs.evolve(ball, inertia=1e-4).compiled(), published.OIL, speed)
    assert 0.0 < part.gyroscopic[0, 0] < 1.0 < heavy.gyroscopic[0, 0]


@pytest.mark.parametrize("outer_race", [False, True])
@pytest.mark.parametrize("sizes", ["shared", "columns"])
def test_the_compiled_loop_sums_the_terms(sizes, outer_race):
    """Two rows of seven balls at 200 points, some contacts open, viscosities of each point: 1e-12 of the terms in arrays."""
    rng, n, z = np.random.default_rng(3), 200, 14
    points = n if sizes == "columns" else 1
    load = 10.0 ** rng.uniform(-1.0, 3.5, (n, 2, z))
    load[rng.random((n, 2, z)) < 0.05] = 0.0
    load[:, 1] = np.maximum(load[:, 1], 1.0)
    diameter, conformity = rng.uniform(8e-3, 12e-3, (points, 1, z)), rng.uniform(0.51, 0.56, (points, 2, z))
    axes = np.cbrt(np.where(load > 0.0, load, 1.0)) * 10.0 ** rng.uniform(-5.0, -4.0, (points, 1, z))
    balls = published.LoadedContacts(
        load, np.where(load > 0.0, rng.uniform(0.0, 0.9, (n, 2, z)), np.nan), axes * rng.uniform(1.0, 9.0, (points, 2, z)), axes,
        diameter, rng.uniform(4.0, 7.0, (points, 1, z)) * diameter, conformity, 2.2e11, 1e-9,
    )  # fmt: skip
    oil = attrs.evolve(published.OIL, viscosity=10.0 ** rng.uniform(-2.5, -0.5, n))
    speed, row = 10.0 ** rng.uniform(0.0, 3.5, n), np.repeat([0, 1], 7)
    columns = attrs.evolve(oil, viscosity=oil.viscosity[:, None, None])
    compiled, terms = (
        losses(balls.compiled(row), oil, speed, 0.0, outer_race), published.torques(balls, columns, speed, outer_race),
    )  # fmt: skip
    for k in (0, 1):
        for name, term in terms.items():
            of_row = term[..., row == k]
            expected = of_row.max(axis=-1) if name == "gyroscopic" else of_row.sum(axis=-1)
            assert getattr(compiled, name)[..., k] == pytest.approx(expected, rel=1e-12), name


def test_the_compiled_loop_has_the_printed_moment():
    """``RollingResistance0`` of D-BRAIN's tests; it states pi and lengths to other digits than 1.3e-5."""
    assert published.inlet_moment() == pytest.approx(published.INLET_MOMENT, rel=2e-5)


def test_exponential_and_logarithm_are_exact():
    x = np.random.default_rng(1).uniform(-700.0, 700.0, 2000)
    y = np.concatenate([np.exp(x), 1.0 + 1e-3 * x])
    assert np.array([exponential(v) for v in x]) == pytest.approx(np.exp(x), rel=1e-15)
    assert np.array([logarithm(v) for v in np.abs(y)]) == pytest.approx(np.log(np.abs(y)), rel=1e-15, abs=1e-18)
    assert exponential(-1e9) < 4e-308 and exponential(1e9) > 8e307 and logarithm(0.0) < -709.0
