"""Closed formulas for plans and first guesses, against the equilibrium that they stand for."""

from __future__ import annotations

import pytest

from raceway.planning.closed_form import axial_approach, series_factor
from raceway.testing import settle


@pytest.mark.parametrize("axial", [50.0, 400.0, 1000.0, 4000.0])
@pytest.mark.parametrize("preset", ["B7206C", "7206A"])
def test_the_axial_approach_is_that_of_the_equilibrium(built, preset, axial):
    """Balls without inertia, tilt locked.  Hamrock and Brewe's fits are within 5 % in stiffness; here they are within 1 %."""
    model = built(bearing={"preset": preset}, load={"axial": axial}, kinematics={"ball_inertia": False})
    equilibrium = settle(model)
    approach, load = axial_approach(model.scene)
    assert approach == pytest.approx(equilibrium.displacement[0], rel=0.02)
    assert load == pytest.approx(equilibrium.contact_force.mean(), rel=0.005)


def test_the_series_factor_is_that_of_two_hertz_contacts(built):
    model = built()
    exact = (model.inner.factor ** (-2.0 / 3.0) + model.outer.factor ** (-2.0 / 3.0)) ** -1.5
    assert series_factor(model.scene) == pytest.approx(exact, rel=0.02)
