"""Chung & Ooi (2011), benchmark tests 1 and 3: elastic normal impacts of spheres; inputs published, outputs exact Hertz.

Frame: the approach along the line of centres; two equal spheres count as one of half the mass at the relative speed.
Tolerances: 1e-5 for the closed formulas (six printed digits); 1e-3 for each transient integrator at 100 steps a contact, of
which the largest sample takes up to 1e-4 (it is not interpolated) and second-order methods a few 1e-4.
"""

import numpy as np
import pytest
from raceway_checks.verify.reference import reference_cases
from raceway_checks.verify.study import impact_of, peak_and_duration, transient_integrators

from raceway.extend import default_registry, impact_system, integrate, layout

INTEGRATORS = [entry.name for entry in transient_integrators(default_registry())]


def test_the_built_in_transient_integrators_are_among_them():
    assert {"newmark", "generalized_alpha", "central_difference"} <= set(INTEGRATORS)
    assert "quasi_static" not in INTEGRATORS


@pytest.mark.parametrize("name", ["newmark", "generalized_alpha", "central_difference"])
@pytest.mark.parametrize("case", ("chung-ooi-1-glass", "chung-ooi-3-alumina"))
def test_order_two_through_touch_and_release(case, name):
    """The contact time converges with the square of the step: a slope within 0.1 of 2 over three halvings."""
    method, impact = default_registry().find("integrator", name).plugin(), impact_of(reference_cases()[case].inputs)
    steps = np.array([50, 100, 200, 400])
    errors = [abs(peak_and_duration(method, impact, n, 0.5)[1] / impact.contact_time - 1.0) for n in steps]
    slope = np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("name", ["newmark", "generalized_alpha", "central_difference"])
def test_an_impact_on_a_penalty(name):
    """Q = c d^2: energy gives d_max = (3 m v^2 / (2 c))^(1/3).  Tolerance as for Hertz; the frequency is about the same."""
    from raceway.extend import Motion, Schedule, square

    mass, speed, factor = 0.01, 2.0, 1e12
    deepest = (1.5 * mass * speed**2 / factor) ** (1 / 3)
    system = impact_system(mass, square, np.array([factor]))
    dt = 2.8 * deepest / speed / 100  # Hertz's contact lasts 2.94 d_max / v, this one a little less
    balls, first = np.zeros((1, 2)), np.array([1.0, 0, 0, 0, 0])
    start = Motion(-2.5 * dt * speed * first, speed * first, np.zeros(5), balls, balls.copy())
    record = integrate(default_registry().find("integrator", name).plugin(), system, start, Schedule(dt, 120, 1))
    assert record.contact_force.max() == pytest.approx(factor * deepest**2, rel=1e-3)
    assert record.velocity[-1, 0] == pytest.approx(-speed, rel=1e-3)


def test_a_dashpot_takes_energy_and_the_tangents_are_consistent():
    from raceway.extend import three_halves

    system = impact_system(1.0, three_halves, np.array([1e10]))
    system.scalars[layout.DAMPING] = 50.0
    first, step = np.array([1.0, 0, 0, 0, 0]), 1e-11
    q, v = 3e-6 * first, 0.02 * first
    now = system.evaluate(q, v)
    moved = [system.evaluate(q + s * step * first, v).force[0] for s in (1.0, -1.0)]
    assert now.stiffness[0, 0] == pytest.approx((moved[0] - moved[1]) / (2 * step), rel=1e-6)
    assert now.damping[0, 0] == pytest.approx(50.0, rel=1e-12)
    assert now.force[0] == pytest.approx(1e10 * 3e-6**1.5 + 50.0 * 0.02, rel=1e-12)
    assert now.gap[1] > 0.0
    assert now.contact_force[1] == 0.0


def test_a_mass_pressed_on_a_contact_settles_where_hertz_says():
    from raceway.extend import three_halves

    system = impact_system(1.0, three_halves, np.array([1e10]), load=500.0, clearance=2e-6)
    q, _, _ = system.solve_equilibrium(np.zeros(5))
    assert q[0] - 2e-6 == pytest.approx((500.0 / 1e10) ** (2 / 3), rel=1e-9)
