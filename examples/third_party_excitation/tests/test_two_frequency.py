"""The public conformance suite, and what is this force's own."""

import pytest
from raceway_two_frequency import TwoFrequency

from raceway.testing import ExcitationSuite, samples


class TestMisalignment(ExcitationSuite):
    plugin = TwoFrequency(speed_rpm=9000.0, force=200.0, second_force=150.0)


class TestEveryExample(ExcitationSuite):
    plugin = TwoFrequency


def test_the_forces_add_up():
    force = samples(TwoFrequency(speed_rpm=6000.0, force=2.0, second_force=1.0, second_whirl="backward"), [0.0, 0.0025])
    # A quarter turn later the first force points to +z, the second, twice as fast, to -y.
    assert force[0] == pytest.approx([0.0, 3.0, 0.0, 0.0, 0.0])
    assert force[1] == pytest.approx([0.0, -1.0, 2.0, 0.0, 0.0])


@pytest.mark.parametrize(("multiple", "divisor", "turns"), [(2, 1, 1), (1, 2, 2), (3, 2, 2), (2, 4, 2), (4, 2, 1)])
def test_the_period(multiple, divisor, turns):
    excitation = TwoFrequency(speed_rpm=6000.0, force=1.0, second_force=1.0, multiple=multiple, divisor=divisor)
    assert excitation.period_s == pytest.approx(turns * 0.01)


def test_the_same_frequency_twice_is_refused():
    with pytest.raises(ValueError, match="add the forces up"):
        TwoFrequency(speed_rpm=6000.0, force=1.0, multiple=1, divisor=1)


def test_options_of_a_second_force_that_is_not_there_are_named():
    assert set(TwoFrequency(speed_rpm=6000.0, force=1.0, multiple=3).unused_options()) == {"multiple"}
