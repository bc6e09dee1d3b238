"""Time integrators: agreement, restart, failure, those of third parties, states of another shape; order: evidence/test_integrators.py."""

from typing import ClassVar

import attrs
import numpy as np
import pytest
from raceway_checks.stability.catalogue import BASE

from checks.validation import orders
from checks.validation.command_line import EXAMPLES
from checks.validation.scenes import built_in, rotating
from raceway import PluginError, SceneError, StabilityError, build_model, hookimpl, make_plan, scene_from_dict
from raceway.core.signatures import Outer
from raceway.core.time.compiled import outer_force
from raceway.extend import Drivers, Increment, OneStep, Schedule, SteppedBearing, at_rest, integrate
from raceway.testing import Registry, model_of, settled, simulate, solve_equilibrium

Newmark = built_in("integrator", "newmark")

INTEGRATORS = orders.INTEGRATORS


def test_generalized_alpha_without_dissipation_and_newmark_agree():
    """rho = 1 halves the same average-acceleration idea: both are second order, undamped, and close for small steps."""
    tables = rotating(1000.0, "locked", 12000.0, False, "generalized_alpha")
    tables["integrator"] |= {"rho_infinity": 1.0, "steps_per_turn": 2880, "turns": 1, "start": "static"}
    first = model_of(tables)
    tables["integrator"] = {"kind": "newmark", "steps_per_turn": 2880, "turns": 1, "start": "static"}
    second = model_of(tables)
    one, two = (simulate(m, solve_equilibrium(m)).whole.displacement for m in (first, second))
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


@pytest.mark.parametrize("integrator", ["newmark", "generalized_alpha"])
def test_forces_of_a_smooth_motion_are_asked_for_once_a_step(integrator):
    """The tangent and the extrapolation of what it leaves foretell them within a step's tolerance; the rest are first steps."""
    model = model_of(rotating(1000.0, "locked", 12000.0, True, integrator))
    record = simulate(model, solve_equilibrium(model)).whole
    assert 1.0 <= record.counts["evaluations"] / record.counts["steps"] <= 1.1


def test_stable_limit_is_where_central_differences_blow_up():
    """On the linear oscillator: bounded just below 2 / w0, without bound just above."""
    system, w0, _ = orders.oscillator(0.0)
    method = scene_from_dict(rotating(1.0, "locked", 12000.0, False, "central_difference")).integrator.method
    held = np.array([-system.scalars[0], 1e-6, 0.0, 0.0, 0.0])
    start = at_rest(system, held, system.evaluate(held).ball, True)
    none, unit = np.zeros((5, 5)), system.mass * w0  # dashpots c = 2 z m w0 of a contact
    assert system.critical_time_step(none) == pytest.approx(2.0 / w0, rel=1e-12)
    for z in (0.05, 1.0):
        wanted = 2.0 / w0 * (np.sqrt(1.0 + 4.0 * z * z) - 2.0 * z)
        assert system.damped_time_step(none, 2.0 * z * unit) == pytest.approx(wanted, rel=1e-12)
    calm = integrate(method, system, start, Schedule(1.98 / w0, 500, 1))
    assert np.abs(calm.displacement[:, 1]).max() < 1e-3
    with pytest.raises(StabilityError, match="grew without bound"):
        integrate(method, system, start, Schedule(2.02 / w0, 500, 1))


def test_equilibria_metres_away_are_told_as_motions_without_bound():
    """Of a ring that a soft spring alone holds: K u = F is solved in one iteration, at 11 m."""
    system, w0, _ = orders.oscillator(0.0)
    pulled = attrs.evolve(system, load=np.array([0.0, -22.0 * w0**2, 0.0, 0.0, 0.0]))
    held = np.array([-system.scalars[0], 0.0, 0.0, 0.0, 0.0])
    start = at_rest(system, held, system.evaluate(held).ball, True)
    method = built_in("integrator", "quasi_static")()
    with pytest.raises(StabilityError, match="grew without bound"):
        integrate(method, SteppedBearing(pulled), start, Schedule(1e-5, 10, 1))


def test_progress_and_stop():
    model = model_of(rotating(1000.0, "locked", 12000.0, False, "newmark"))
    seen = []

    def stop(done: int, total: int) -> None:
        seen.append((done, total))
        raise KeyboardInterrupt

    start = at_rest(model.system, solve_equilibrium(model).displacement, np.zeros((12, 2)), True)
    with pytest.raises(KeyboardInterrupt):
        integrate(model.scene.integrator.method, model.system, start, Schedule(1e-6, 60_000, 1, 60), stop)
    assert seen == [(20_000, 60_000)]


def test_the_ramp_grows_from_nothing_to_all_of_the_force_smoothly(built):
    """10 s^3 - 15 s^4 + 6 s^5, whose slope and curvature are zero at both ends."""
    excitation = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 100.0}
    system, ramp, out = built(excitation=excitation, rotor={"mass": 2.0}).system, 0.02, np.empty(5)
    for s in (0.0, 0.1, 0.25, 0.5, 0.9, 1.0, 1.5):
        outer_force(Outer(system.force, system.force_params, ramp), s * ramp, out)
        share = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5 if s < 1.0 else 1.0
        assert np.linalg.norm(out) == pytest.approx(100.0 * share, rel=1e-12, abs=1e-12)


BODIES = {
    "rigid": {},
    "condensed": {"bodies": {"kind": "condensed"}},
    "nodal": {
        "bodies": {"kind": "condensed"},
        "contact": {"kind": "hertz", "discretisation": "nodal"},
        "mesh": {"kind": "structured", "nodes_per_semi_axis": 2},
    },
    "elastic": {
        "bodies": {"kind": "elastic"},
        "mesh": {"kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 0, "azimuth_cells": 12},
    },
}


#: With a driver for systems that are stepped from Python, and no other.
(ENTRY,) = Registry(third_party=False).load_file(EXAMPLES / "plugins" / "trapezoidal.py")
Trapezoidal = ENTRY.plugin


class ByNumbers(Trapezoidal):
    """By the numbers of a scheme of the core: Hilber, Hughes and Taylor's method."""

    name = "by_numbers"
    dissipative = True

    @property
    def scheme(self):
        alpha = 0.1
        return OneStep(0.0, alpha, 0.25 * (1.0 + alpha) ** 2, 0.5 + alpha, 1e-11)


class Compiled(Trapezoidal):
    """For compiled rings only."""

    name = "compiled"

    @property
    def scheme(self):
        return Drivers(compiled=OneStep().compiled)


class Continuing(Compiled):
    """Leaves the last moment of its motion for that of a similar scene."""

    name = "continuing"
    given: ClassVar[list] = []

    @property
    def scheme(self):
        def steps(system, start, schedule, on_chunk=None):
            self.given.append(start.near)
            record = OneStep().compiled(system, start, schedule, on_chunk)
            return attrs.evolve(record, solution=record.final)

        return Drivers(compiled=steps)


class ThirdParty:
    @hookimpl
    def raceway_integrators(self):
        return [Trapezoidal, ByNumbers, Compiled, Continuing]


def registry():
    found = Registry(third_party=False)
    found.add(ThirdParty())
    return found


def scene(bodies, integrator):
    parts = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "rotor": {"mass": 0.5}}
    force = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 20.0}
    steps = {"kind": integrator, "turns": 1, "start": "static"}
    return scene_from_dict({**parts, "excitation": force, "integrator": steps, **BODIES[bodies]}, registry())


@pytest.mark.parametrize("integrator", ["trapezoidal", "by_numbers"])
@pytest.mark.parametrize(
    "bodies", [pytest.param(one, marks=[pytest.mark.slow] * (one in ("nodal", "elastic"))) for one in BODIES]
)
def test_a_foreign_integrator_has_its_order_on_every_kind_of_bodies(bodies, integrator):
    """A force that grows over 0.1 ms: the error falls with the square of the step, from 10 to 20 and 40 steps."""
    chosen = scene(bodies, integrator)
    model = build_model(chosen)
    still = solve_equilibrium(model)
    start = model.bearing.at_rest(model.system, still.displacement, still.ball, True)
    time = 1e-4
    ends = []
    for steps in (10, 20, 40):
        schedule = Schedule(time / steps, steps, 1, 1, time)
        record = integrate(chosen.integrator.method, model.system, start, schedule)
        ends.append(record.displacement[-1, 1:3] - still.displacement[1:3])
    first, second = np.linalg.norm(ends[0] - ends[1]), np.linalg.norm(ends[1] - ends[2])
    rate = np.log2(first / second)
    assert rate > 1.8


@pytest.mark.parametrize("bodies", ["nodal", "elastic"])
def test_a_method_without_the_driver_is_refused_by_the_plan(bodies):
    with pytest.raises(SceneError, match=r"`integrator.kind` = 'compiled': has no driver `stepped`"):
        make_plan(scene(bodies, "compiled"))
    make_plan(scene("condensed", "compiled"))


def test_a_foreign_integrator_is_given_what_it_solved_for_a_similar_scene():
    """Of whatever kind; the search for orbits, which goes before a start on one, knows solutions of its own only."""
    Continuing.given.clear()
    for start in ("static", "orbit"):
        chosen = scene("rigid", "continuing")
        model = build_model(attrs.evolve(chosen, integrator=attrs.evolve(chosen.integrator, start=start)))
        still = solve_equilibrium(model)
        first = simulate(model, still)
        simulate(model, still, near=first)
        before, given = Continuing.given[-2:]
        assert before is None and given is first.whole.solution


SIX = np.zeros((6, 2))


@pytest.fixture(scope="module")
def bearing():
    model, still = settled(BASE)
    return model.system, still


@pytest.mark.parametrize(("arguments", "words"), [
    ({"ball": SIX}, r"`ball` has the shape \(6, 2\); that of this system is \(12, 2\): a row for each ball"),
    ({"ball": np.zeros((12, 1))}, r"`ball` has the shape \(12, 1\)"),
    ({"ball_rate": SIX}, r"`ball_rate` has the shape \(6, 2\)"),
    ({"step": Increment(memory=np.zeros((12, 1)))}, r"`memory` has the shape \(12, 1\); that of this system is \(24, 0\)"),
    ({"v": np.zeros(3)}, r"`v` has the shape \(3,\)"),
])  # fmt: skip
def test_evaluate_refuses_states_of_another_shape(bearing, arguments, words):
    system, still = bearing
    with pytest.raises(PluginError, match=words):
        system.evaluate(still.displacement, **arguments)


def test_an_equilibrium_refuses_balls_of_another_bearing(bearing):
    system, still = bearing
    with pytest.raises(PluginError, match=r"solve_equilibrium\(\): `ball` has the shape \(6, 2\)"):
        system.solve_equilibrium(still.displacement, SIX)


@pytest.mark.parametrize("name", ["ball", "ball_before"])
def test_a_start_of_another_bearing_is_refused_by_both_loops(bearing, name):
    system, still = bearing
    start = attrs.evolve(at_rest(system, still.displacement, still.ball, False), **{name: SIX})
    words = rf"the motion that an integration starts from: `{name}` has the shape \(6, 2\)"
    with pytest.raises(PluginError, match=words):
        integrate(Newmark(), system, start, Schedule(1e-6, 10, 1))
    with pytest.raises(PluginError, match=words):
        SteppedBearing(system).begin(start)
