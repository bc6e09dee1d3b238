"""A rigid bearing that is stepped from Python moves as in the compiled loops."""

from typing import Any

import attrs
import numpy as np
import pytest

from checks.validation.scenes import rotating
from raceway.extend import Schedule, SteppedBearing, at_rest, integrate, static_orbit
from raceway.testing import default_registry, settled

#: Those that march in time.
METHODS = [entry.plugin for entry in default_registry().of_kind("integrator") if not entry.plugin.steady]


def case(integrator: str, **changes: Any):
    """Method, system, start and schedule: 40 steps of a bearing that rings after a sudden force."""
    tables = rotating(600.0, "free", 12000.0, changes.pop("inertia", True), integrator)
    tables["integrator"]["steps_per_turn"] = 2880 if integrator == "central_difference" else 360
    model, now = settled(tables | {table: tables.get(table, {}) | keys for table, keys in changes.items()})
    method, dt = model.scene.integrator.method, model.excitation.period_s / tables["integrator"]["steps_per_turn"]
    begin = at_rest if method.inertial else static_orbit
    return method, model.system, begin(model.system, now.displacement, now.ball, False), Schedule(dt, 40, 1, ramp=20 * dt)


CHANGES = [
    {}, {"inertia": False},
    {"contact": {"damping": 300.0, "friction": 0.05}, "kinematics": {"orbiting": True}},
    {"rotor": {"mass": 2.0, "polar_inertia": 8e-3, "damping": 200.0}, "supports": {"tilt": 2000.0}},
]  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=["inertial", "weightless", "friction orbiting", "gyroscopic"])
@pytest.mark.parametrize("kind", [m.name for m in METHODS])
def test_records_equal_the_compiled_loops(kind, changes):
    method, system, start, schedule = case(kind, **changes)
    wanted = integrate(method, system, start, schedule)
    found = integrate(method, SteppedBearing(system), start, schedule)
    assert (found.time == wanted.time).all()
    for name in ("displacement", "velocity", "force", "gap", "contact_force", "ball"):
        a, b = getattr(wanted, name), getattr(found, name)
        assert a.shape == b.shape
        # Same equations; iterations end at 1e-9 of the forces (newmark) and 1e-11 (equilibria), most far below.
        assert np.abs(a - b).max() <= 1e-9 * np.abs(a).max(), name
    for name in ("max_penetration_m", "peak_contact_force_n"):
        assert found.counts[name] == pytest.approx(wanted.counts[name], rel=1e-9)


@pytest.mark.parametrize("kind", [m.name for m in METHODS])
def test_two_halves_are_the_whole(kind):  # tolerance: a share of the largest force so far, unknown to a restart
    method, system, start, schedule = case(kind, contact={"damping": 300.0, "friction": 0.05})
    half = attrs.evolve(schedule, steps_per_turn=20)
    for loops in (system, SteppedBearing(system)):
        whole, first = (integrate(method, loops, start, one) for one in (schedule, half))
        second = integrate(method, loops, first.final, attrs.evolve(half, first=20))
        for name in ("time", "displacement", "force", "ball", "contact_force", "velocity")[
            : 5 if loops is system and not method.inertial else 6
        ]:
            a, b = np.concatenate([getattr(first, name), getattr(second, name)]), getattr(whole, name)
            assert np.abs(a - b).max() <= (1e-8 if method.implicit else 0.0) * np.abs(b).max(), name
