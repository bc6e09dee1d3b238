"""A series of equilibria against single ones."""

import pytest

from checks.validation.expected_values import secant


def test_same_numbers_through_run():
    """The public path: a scene with an excitation and integrator quasi_static gives the mean of the static ones."""
    from checks.validation.scenes import rotating
    from raceway import scene_from_dict
    from raceway.testing import run

    result = run(scene_from_dict(rotating(1000.0, "locked", 12000.0, False, "quasi_static"))).to_dict()
    found = result["identification"]["equivalent_stiffness"]
    # The load turns past all azimuths: between balls and towards a ball differ by less than 0.1 % here.
    assert found == pytest.approx(secant(1000.0, "locked", 12000.0, False), rel=1e-3)
