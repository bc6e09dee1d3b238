"""The table and the trends that an independent solver gave for the B7206C (physics.md section 7), all rows."""

from __future__ import annotations

import pytest

from raceway.studies.article.expected import SPEEDS, TRENDS
from validation.expected_values import TABLE, axial_row, secant


@pytest.mark.parametrize("axial", TABLE)
def test_axial_load(axial):
    # 0.5 %: the expected numbers are printed with three to four digits.
    assert axial_row(axial) == pytest.approx(TABLE[axial], rel=0.005)


@pytest.mark.parametrize(("case", "expected"), TRENDS.items(), ids=lambda part: str(part))
def test_secant_stiffness_over_speed(case, expected):
    tilt, axial, inertia = case
    first, ratios = expected
    curve = [secant(axial, tilt, speed, inertia) for speed in SPEEDS]
    assert curve[0] / 1e6 == pytest.approx(first, rel=0.005)
    assert [k / curve[0] for k in curve[1:]] == pytest.approx(ratios, abs=0.002)


def test_same_numbers_through_run():
    """The public path: a scene with an excitation and integrator quasi_static gives the mean of the static ones."""
    from raceway import scene_from_dict
    from raceway.pipeline.run import run
    from validation.scenes import rotating

    result = run(scene_from_dict(rotating(1000.0, "locked", 12000.0, False, "quasi_static"))).to_dict()
    found = result["identification"]["equivalent_stiffness"]
    # The load turns past all azimuths: between balls and towards a ball differ by less than 0.1 % here.
    assert found == pytest.approx(secant(1000.0, "locked", 12000.0, False), rel=1e-3)
