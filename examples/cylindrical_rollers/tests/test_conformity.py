"""The public conformance suites."""

from raceway_cylindrical_rollers import CylindricalRollers, Palmgren

from raceway.testing import BodiesSuite, ContactLawSuite


class TestRollers(BodiesSuite):
    plugin = CylindricalRollers


class TestPalmgren(ContactLawSuite):
    plugin = Palmgren
