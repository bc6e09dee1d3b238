"""Time integrators: order and stated error.

Integrators start suddenly (orders) or on their orbit (stiffness); of the error stated there are single scenes here, all in
the report ``error``.
"""

from __future__ import annotations

import pytest

from checks.validation.error_estimate import FACTOR, worst
from checks.validation.identified_stiffness import CASES, INTEGRATORS, LIMIT, SOME, compared
from checks.validation.orders import MARGIN, contact_errors, independent, linear_errors, order

#: Of a slope against 2: the coarsest steps are off by up to a tenth, which leaves as much of the terms of fourth order.
ORDER = {"near": 2.0, "within": MARGIN / 2.0}
STATED = {"at_least": 1.0 / FACTOR, "at_most": FACTOR, "basis": "own other method"}


def furthest(orders: list[float]) -> float:
    """From 2."""
    return max(orders, key=lambda value: abs(value - 2.0))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_order_on_a_linear_oscillator(claim, integrator):
    found = furthest([order(*linear_errors(integrator, ratio)) for ratio in (0.0, 0.2)])
    source = "response of m, c, k from rest; damping ratios 0 and 0.2, 60 to 960 steps per turn"
    claim(f"order on a linear oscillator, {integrator}", found, **ORDER, basis="closed form", source=source)


def test_order_on_hertz_contacts_against_independent_code(claim):
    wanted = [(tilt, coarsest, independent(tilt, 60)) for tilt, coarsest in (("locked", 360), ("free", 720))]
    source = "DOP853 on the reference's own equations; sudden load, no damping, tilt locked and free"
    for integrator in INTEGRATORS:
        orders = [order(*contact_errors(integrator, tilt, False, 0.0, motion, steps)) for tilt, steps, motion in wanted]
        quantity = f"order on Hertz contacts, {integrator}"
        claim(quantity, furthest(orders), **ORDER, basis="own other method", source=source)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_order_on_damped_hertz_contacts(claim, integrator):
    """Heavily damped, so that the balls' own rates matter, which the independent equations do not have."""
    found = furthest([order(*contact_errors(integrator, "locked", inertia, 500.0, None, 360)) for inertia in (False, True)])
    source = "order 2 of the method; the same with 16 times the finest steps; with and without centrifugal force"
    claim(f"order on contacts damped by 500 N s/m, {integrator}", found, **ORDER, basis="closed form", source=source)


def test_stiffness_equals_that_of_independent_periodic_motion(claim):
    found = compared(SOME)
    first = found[0]
    assert (first.case, first.integrator) == (("locked", 400.0, 15000.0, True), "newmark")
    claim(
        "K of a B7206C, 400 N, 15000 r/min, tilt locked, newmark",
        first.k / 1e6,
        near=first.wanted / 1e6,
        within=LIMIT,
        unit="N/um",
        basis="own other method",
        source="shooting with DOP853 on the reference's own equations; within the method's (w h)^2 / 6",
    )
    for integrator in INTEGRATORS:
        largest = max(one.error for one in found if one.integrator == integrator)
        source = f"shooting with DOP853 on the reference's own equations, {len(SOME)} of {len(CASES)} scenes; (w h)^2 / 6"
        quantity = f"largest relative error of K, {integrator}"
        claim(quantity, largest, at_most=LIMIT, basis="own other method", source=source)
    ratio = worst([(one.stated_error / one.wanted, one.error) for one in found])
    source = f"the same {len(SOME)} scenes by three integrators; a factor of 3 is less than a halving of the steps changes"
    claim("stated over true error of K, furthest from 1", ratio, **STATED, source=source)
