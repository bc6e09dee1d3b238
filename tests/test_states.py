"""States of another shape are refused before a compiled kernel, which looks at none, writes beyond them.

Deliberate faults: without the checks in ``System.evaluate``, ``System.settle``, ``advance`` and ``SteppedBearing.begin`` each
case below is computed, with numbers from beyond the arrays, or ends the process.
"""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from raceway import PluginError, build_model, make_plan, scene_from_dict
from raceway.core.ring.increment import Increment
from raceway.core.ring.start import at_rest
from raceway.core.ring.stepped import SteppedBearing
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Schedule
from raceway.integrators.newmark import Newmark
from raceway.studies.stability.systems import BASE
from raceway.testing import settle

SIX = np.zeros((6, 2))
NARROW = np.zeros((12, 1))


@pytest.fixture(scope="module")
def bearing():
    scene = scene_from_dict(BASE)
    model = build_model(scene, make_plan(scene))
    return model.system, settle(model)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"ball": SIX}, r"`ball` has the shape \(6, 2\); that of this system is \(12, 2\): a row for each ball"),
        ({"ball": NARROW}, r"`ball` has the shape \(12, 1\)"),
        ({"ball_rate": SIX}, r"`ball_rate` has the shape \(6, 2\)"),
        (
            {"step": Increment(memory=np.zeros((12, 1)))},
            r"`memory` has the shape \(12, 1\); that of this system is \(24, 0\)",
        ),
        ({"v": np.zeros(3)}, r"`v` has the shape \(3,\)"),
    ],
)
def test_evaluate_refuses_states_of_another_shape(bearing, arguments, words):
    system, still = bearing
    with pytest.raises(PluginError, match=words):
        system.evaluate(still.displacement, **arguments)


def test_an_equilibrium_refuses_balls_of_another_bearing(bearing):
    system, still = bearing
    with pytest.raises(PluginError, match=r"settle\(\): `ball` has the shape \(6, 2\)"):
        system.settle(still.displacement, SIX)


@pytest.mark.parametrize("name", ["ball", "ball_before"])
def test_a_start_of_another_bearing_is_refused_by_both_loops(bearing, name):
    system, still = bearing
    start = attrs.evolve(at_rest(system, still.displacement, still.ball, False), **{name: SIX})
    words = rf"the motion that an integration starts from: `{name}` has the shape \(6, 2\)"
    with pytest.raises(PluginError, match=words):
        integrate(Newmark(), system, start, Schedule(1e-6, 10, 1))
    with pytest.raises(PluginError, match=words):
        SteppedBearing(system).begin(start)
