"""The plan's predicted time: the work of whole runs within a factor of two of what was measured, and the machine's own speed."""

import pytest

from checks.validation.command_line import ARTICLE
from checks.validation.plan_time import LEAST, MOST, SCENE, SCENES
from raceway import load_scene, make_plan
from raceway.planning.parts import slowness

#: Processor times [s] of whole runs on the reference machine, as report cost measures them: what a test can
#: hold a prediction against without a clock.  All but start-up, 1.2 s, is what the predictions tell apart.
MEASURED_S = {
    "rigid, friction, 60 turns": 2.04, "rigid, 300 turns": 3.0, "rigid, 300 turns of 2880 steps": 5.45,
    "rigid, central_difference, 300 turns": 3.28, "rigid, periodic, internal resonance": 4.59, "rigid, run-up": 2.98,
    "condensed": 2.96, "condensed, 100 turns": 2.90, "condensed, pressures at points": 5.37,
}  # fmt: skip


@pytest.mark.parametrize("name", MEASURED_S)
def test_the_predicted_work_is_within_a_factor_of_two_of_the_measured_one(name):
    work = make_plan(load_scene(SCENE, SCENES[name])).predicted_work_s
    assert LEAST <= work / MEASURED_S[name] <= MOST


def test_every_step_costs():
    """300 turns of 2880 steps instead of 360: 2.45 s more for 756 000 steps of 3.2 us; the records are the same."""
    few, many = (make_plan(load_scene(SCENE, SCENES[f"rigid, 300 turns{steps}"])) for steps in ("", " of 2880 steps"))
    each = (many.predicted_work_s - few.predicted_work_s) / (many.predicted_steps - few.predicted_steps)
    assert 1.6e-6 < each < 6.5e-6


def test_the_time_is_the_work_at_the_machine_s_own_speed(monkeypatch):
    slowness.cache_clear()
    monkeypatch.setattr("raceway.planning.parts.timed", lambda: 3.0)
    plan = make_plan(load_scene(ARTICLE))
    slowness.cache_clear()
    assert plan.predicted_wall_s == pytest.approx(3.0 * plan.predicted_work_s)
