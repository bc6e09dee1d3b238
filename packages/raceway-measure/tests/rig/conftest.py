"""One rig and its bearing under 2000 N, shared by the tests: linear enough to be solved in a few runs."""

import pytest
from raceway_rotor.rig_table import Rig
from raceway_rotor.shaft import balance, bearing, rotor

from checks.validation.command_line import EXAMPLES
from checks.validation.records import SPEED
from raceway import load_scene
from raceway.testing import default_registry


@pytest.fixture(scope="session")
def rig():
    return Rig()


@pytest.fixture(scope="session")
def scene():
    return load_scene(EXAMPLES / "test_rig.toml")


@pytest.fixture(scope="session")
def held(scene):
    return bearing(scene, 2000.0, default_registry())


@pytest.fixture(scope="session")
def state(rig, held):
    return balance(rotor(rig, SPEED), held)
