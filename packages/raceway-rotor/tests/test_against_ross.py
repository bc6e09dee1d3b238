"""Our beam against ROSS on the test rig's rotor: natural frequencies and the response to unbalance."""

import pytest

from checks.validation.rotor_in_ross import compared

pytestmark = pytest.mark.ross


@pytest.fixture(scope="module")
def found():
    return compared()


def test_natural_frequencies_are_those_of_ross(found):
    # Same theory (Timoshenko, Cowper's shear coefficient, rotary inertia, gyroscopic moments), another program.
    assert found.frequencies.shape == (3, 2)
    assert found.difference(found.frequencies) <= 1e-3


def test_response_to_unbalance_is_that_of_ross(found):
    assert found.responses.shape == (6, 2)
    assert found.difference(found.responses) <= 1e-3
