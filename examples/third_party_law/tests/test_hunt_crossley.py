"""The public conformance suite, and what is this law's own."""

import numpy as np
import pytest
from raceway_hunt_crossley import HuntCrossley

from raceway.testing import ContactLawSuite, drive


class TestConstantDissipation(ContactLawSuite):
    plugin = HuntCrossley(dissipation=2.0)


class TestRestitution(ContactLawSuite):
    plugin = HuntCrossley(restitution=0.7)


class TestConservativeAndSharp(ContactLawSuite):
    plugin = HuntCrossley(dissipation=0.0, transition=0.0)


def test_above_the_transition_it_is_hertz_at_rest():
    law = drive(HuntCrossley(transition=1e-7), 8)
    force, _, d_rate, _ = law(-2e-6)
    hertz = law.params[:, 0] * 2e-6**1.5
    assert np.allclose(force, hertz, rtol=1e-14)
    assert np.allclose(d_rate, -0.1 * hertz, rtol=1e-14)


def test_the_speed_of_first_touch_is_remembered_until_the_contact_opens():
    law = drive(HuntCrossley(restitution=0.5), 1)
    *_, state = law(-1e-7, -0.2)
    assert state[0, 0] == 0.2
    *_, state = law(-5e-6, 0.1, state)
    assert state[0, 0] == 0.2
    *_, state = law(1e-9, 0.1, state)
    assert state[0, 0] == 0.0


@pytest.mark.parametrize("restitution", [0.5, 0.7, 0.9, 0.98])
def test_an_impact_gives_the_restitution_back(restitution):
    """A free mass against one contact, by small steps of a symplectic method.

    The formula of c is exact at restitution 1 and approximate below: 0.470, 0.683, 0.894 and 0.979 come out.
    """
    law = drive(HuntCrossley(restitution=restitution, transition=0.0), 1)
    mass, x, v, dt = 0.1, -1e-9, 0.3, 2e-8
    state = law.rest()
    for _ in range(200_000):
        force, _, _, state = law(-x, -v, state, dt)
        v -= dt * force[0] / mass
        x += dt * v
        if x < 0.0 and v < 0.0:
            break
    assert -v / 0.3 == pytest.approx(restitution, abs=0.03)


def test_options_without_effect_are_named():
    assert set(HuntCrossley(dissipation=1.0, restitution=0.5).unused_options()) == {"dissipation"}
    assert set(HuntCrossley(slowest=1.0).unused_options()) == {"slowest"}
    assert HuntCrossley(dissipation=1.0).unused_options() == {}
