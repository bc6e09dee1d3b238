"""Agreement, restart and failure of the time integrators; their order: evidence/test_integrators.py."""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from raceway import StabilityError, scene_from_dict
from raceway.core.ring.address import by_address
from raceway.core.ring.start import at_rest
from raceway.core.schemes.compiled import outer_force
from raceway.core.schemes.drivers import integrate
from raceway.core.signatures import Outer
from raceway.core.stepping.record import Schedule
from raceway.testing import model_of, settle, simulate
from validation import orders
from validation.scenes import rotating

INTEGRATORS = orders.INTEGRATORS


def test_generalized_alpha_without_dissipation_and_newmark_agree():
    """rho = 1 halves the same average-acceleration idea: both are second order, undamped, and close for small steps."""
    tables = rotating(1000.0, "locked", 12000.0, False, "generalized_alpha")
    tables["integrator"] |= {"rho_infinity": 1.0, "steps_per_turn": 2880, "turns": 1, "start": "static"}
    first = model_of(tables)
    tables["integrator"] = {"kind": "newmark", "steps_per_turn": 2880, "turns": 1, "start": "static"}
    second = model_of(tables)
    one, two = (simulate(m, settle(m)).whole.displacement for m in (first, second))
    assert np.abs(one - two).max() <= 2e-3 * np.abs(two[:, 1:]).max()  # each is off by about 1e-3 at this step


def test_generalized_alpha_removes_what_is_too_fast_for_the_step():
    """A stiff mode far above the step's reach dies out with rho = 0.5 and rings on with newmark."""
    left = {}
    for integrator in ("newmark", "generalized_alpha"):
        system, w0, _ = orders.oscillator(0.0)
        tables = rotating(1.0, "locked", 12000.0, False, integrator)
        if integrator == "generalized_alpha":
            tables["integrator"]["rho_infinity"] = 0.5
        method = scene_from_dict(tables).integrator.method
        system = attrs.evolve(system, force_params=system.force_params * 0.0)
        held = np.array([-system.scalars[0], 1e-6, 0.0, 0.0, 0.0])
        start = at_rest(system, held, system.evaluate(held).ball, False)
        record = integrate(method, system, start, Schedule(20.0 / w0, 200, 1))
        left[integrator] = np.abs(record.displacement[-20:, 1]).max() / 1e-6
    assert left["newmark"] == pytest.approx(1.0, abs=0.01)
    assert left["generalized_alpha"] < 1e-6


@pytest.mark.parametrize("integrator", [*INTEGRATORS, "quasi_static"])
def test_restart_equals_going_on(integrator):
    """Two halves joined by the first's final motion are the whole, but for the clock's rounding and the steps' tolerance."""
    model = model_of(rotating(1000.0, "locked", 12000.0, True, integrator))
    now = settle(model)
    method, steps = model.scene.integrator.method, 360
    period = model.excitation.period_s
    start = at_rest(model.system, now.displacement, now.ball, False)
    whole = integrate(method, model.system, start, Schedule(period / steps, steps, 2))
    half = integrate(method, model.system, start, Schedule(period / steps, steps, 1))
    rest = integrate(method, model.system, half.final, Schedule(period / steps, steps, 1))
    assert half.displacement == pytest.approx(whole.displacement[:steps], abs=1e-18)
    # 1e-8: the tolerance of a step's iteration; quasi_static starts its second half without an extrapolation.
    size = np.abs(whole.displacement[:, 1]).max()
    assert np.abs(rest.displacement - whole.displacement[steps:])[:, :3].max() <= 1e-8 * size


def test_same_answer_twice():
    model = model_of(rotating(400.0, "free", 15000.0, True, "newmark"))
    now = settle(model)
    assert (simulate(model, now).whole.displacement == simulate(model, now).whole.displacement).all()


def test_step_above_the_stable_limit_is_refused():
    tables = rotating(1000.0, "locked", 12000.0, False, "central_difference")
    tables["integrator"]["steps_per_turn"] = 12
    model = model_of(tables)
    with pytest.raises(StabilityError, match="above the stable limit"):
        simulate(model, settle(model))


def test_stable_limit_is_where_central_differences_blow_up():
    """On the linear oscillator: bounded just below 2 / w0, without bound just above."""
    system, w0, _ = orders.oscillator(0.0)
    method = scene_from_dict(rotating(1.0, "locked", 12000.0, False, "central_difference")).integrator.method
    held = np.array([-system.scalars[0], 1e-6, 0.0, 0.0, 0.0])
    start = at_rest(system, held, system.evaluate(held).ball, True)
    assert system.critical_time_step(np.zeros((5, 5))) == pytest.approx(2.0 / w0, rel=1e-12)
    calm = integrate(method, system, start, Schedule(1.98 / w0, 500, 1))
    assert np.abs(calm.displacement[:, 1]).max() < 1e-3
    with pytest.raises(StabilityError, match="grew without bound"):
        integrate(method, system, start, Schedule(2.02 / w0, 500, 1))


def test_progress_and_stop():
    model = model_of(rotating(1000.0, "locked", 12000.0, False, "newmark"))
    seen = []

    def stop(done: int, total: int) -> None:
        seen.append((done, total))
        raise KeyboardInterrupt

    start = at_rest(model.system, settle(model).displacement, np.zeros((12, 2)), True)
    with pytest.raises(KeyboardInterrupt):
        integrate(model.scene.integrator.method, model.system, start, Schedule(1e-6, 60_000, 1, 60), stop)
    assert seen == [(20_000, 60_000)]


def test_the_ramp_grows_from_nothing_to_all_of_the_force_smoothly(built):
    """10 s^3 - 15 s^4 + 6 s^5, whose slope and curvature are zero at both ends."""
    excitation = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 100.0}
    system, ramp, out = by_address(built(excitation=excitation, rotor={"mass": 2.0}).system), 0.02, np.empty(5)
    for s in (0.0, 0.1, 0.25, 0.5, 0.9, 1.0, 1.5):
        outer_force(Outer(system.force, system.force_params, ramp), s * ramp, out)
        share = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5 if s < 1.0 else 1.0
        assert np.linalg.norm(out) == pytest.approx(100.0 * share, rel=1e-12, abs=1e-12)
