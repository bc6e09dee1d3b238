"""Pressure of whole contacts: of a foundation from its own force, of Hertz's law Hertz's; what the law is off by."""

import numpy as np
import pytest

from raceway import scene_from_dict
from raceway.bodies.pressure import approach_at
from raceway.testing import run

STIFFNESS = 1e15


def result(load=1000.0, **contact):
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": load}, "contact": contact}
    return run(scene_from_dict(scene))


@pytest.mark.parametrize("race", [0, 1])
def test_a_penalty_tells_its_own_peak_pressure(race):
    """k delta in the middle of the overlap ellipse, which carries Q = p0 pi a b / 2."""
    found = result(kind="penalty", stiffness=STIFFNESS)
    word = ("inner", "outer")[race]
    for k, ball in enumerate(found.to_dict()["equilibrium"]["balls"]):
        approach = -found.equilibrium.gap[12 * race + k]
        assert ball[f"peak_pressure_{word}_pa"] == pytest.approx(STIFFNESS * approach, rel=1e-9)
        a, b, load = ball[f"semi_major_{word}_m"], ball[f"semi_minor_{word}_m"], ball[f"load_{word}_n"]
        assert 0.5 * STIFFNESS * approach * np.pi * a * b == pytest.approx(load, rel=1e-9)


def test_hertz_keeps_hertz_and_open_contacts_have_none():
    found = result(kind="hertz")
    loads = np.array([0.0, 10.0, 250.0])
    for kind in ("hertz", "penalty"):
        model = result(kind=kind).model
        pressure, a, b = model.bearing.contact_ellipse(model, 0, loads)
        assert pressure[0] == a[0] == b[0] == 0.0 and (np.diff(pressure) > 0.0).all()
        assert approach_at(model.system, model.geometry.ball_diameter, 0, loads)[0] == 0.0
    ball = found.to_dict()["equilibrium"]["balls"][0]
    load = ball["load_inner_n"]
    assert ball["peak_pressure_inner_pa"] == pytest.approx(float(found.model.inner.peak_pressure(load)), rel=1e-12)


def test_the_error_of_a_law_is_that_of_its_stiffness_too():
    """Q = c delta^2 that equals Hertz's approach at a load has the slope 2 Q / delta there, Hertz's being 1.5 Q / delta."""
    load = result(kind="hertz").to_dict()["equilibrium"]["balls"][0]["load_inner_n"]
    found = result(kind="penalty", calibrate_at=load).error
    # The outer contact carries the same load; its approach is as exact as the calibration.
    assert found["contact"] == pytest.approx(1.0 / 3.0, rel=1e-3)
    assert "stiffness (3.3e-01)" in found["how"]["contact"]
    assert result(kind="hertz").error["contact"] is None
