"""Time integrators: order.

They start suddenly; stated errors and K are in the report ``error``.
"""

import pytest

from checks.validation.identified_stiffness import INTEGRATORS
from checks.validation.orders import MARGIN, contact_errors, independent, linear_errors, order

#: Of a slope against 2: the coarsest steps are off by up to a tenth, which leaves as much of the terms of fourth order.
ORDER = {"near": 2.0, "within": MARGIN / 2.0}


def furthest(orders: list[float]) -> float:
    """From 2."""
    return max(orders, key=lambda value: abs(value - 2.0))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_order_on_a_linear_oscillator(claim, integrator):
    found = furthest([order(*linear_errors(integrator, ratio)) for ratio in (0.0, 0.2)])
    source = "response of m, c, k from rest; damping ratios 0 and 0.2, 60 to 960 steps per turn"
    claim(f"order on a linear oscillator, {integrator}", found, **ORDER, basis="closed form", source=source)


@pytest.mark.slow
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
