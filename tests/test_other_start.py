"""With friction an answer depends on the start of the motion: the stated error covers what another start gives."""

from itertools import combinations
from types import SimpleNamespace

import attrs
import pytest

from raceway import ConvergenceError, make_plan, run, scene_from_dict
from raceway.pipeline.error import window_misses_transient
from raceway.pipeline.transient_error import Clean
from raceway.testing import simulate


def rubbing(start="ramp", friction=0.3, kind="newmark", **tables):
    """B7206C, 1000 N and a rig's unbalance, tilt free: contacts that stick carry a share of the force."""
    return {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 1000.0},
        "supports": {"tilt": "free"},
        "rotor": {"mass": 2.0, "transverse_inertia": 1e-3},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3.2e-4},
        "contact": {"damping": 10.0, "friction": friction},
        "integrator": {"kind": kind, "start": start, "turns": 20, "steps_per_turn": 180},
        **tables,
    }


def solved(*words, **tables):
    return run(rubbing(*words, **tables))


@pytest.mark.parametrize(("kind", "friction"), [("newmark", 0.3), ("newmark", 0.03), ("quasi_static", 0.3)])
def test_the_stated_errors_cover_what_another_start_gives(kind, friction):
    """At 0.3 the ramp's turns repeat to 1e-9 and its step is good to 1e-6; the orbit's K is 1 % higher."""
    found = {start: solved(start, friction, kind) for start in ("orbit", "ramp", "static")}
    z = {start: one.identification.dynamic_stiffness for start, one in found.items()}
    error = {start: one.error["total"] * abs(z[start]) for start, one in found.items()}
    assert max(abs(z[a] - z[b]) for a, b in combinations(z, 2)) > 1e-3 * abs(z["ramp"])
    for a, b in combinations(z, 2):
        assert abs(z[a] - z[b]) <= 1.01 * (error[a] + error[b]), (a, b)
    # Not the free vibration of the other run, which is its own error.
    assert found["ramp"].error["total"] < 0.05
    for one in found.values():
        assert "the motion depends on its start" in one.error["how"]["transient"]
        assert any("depends on the start of the motion" in text for text in one.warnings)


def test_without_another_start_no_error_is_stated(monkeypatch):
    def none(*_, **__):
        raise ConvergenceError("no step is found")

    monkeypatch.setattr("raceway.pipeline.transient_error.simulate", none)
    found = solved()
    assert found.error["transient"] is None and found.error["total"] is None
    assert any(
        "the dependence of the answer on the start of the motion, and so its error, is unknown" in text
        for text in found.warnings
    )
    assert any("no step is found" in text for text in found.warnings)


def test_the_next_start_stands_in_for_one_that_fails(monkeypatch):
    tried = []

    def some(model, *args, **words):
        tried.append(model.problem.integrator.start)
        if tried[-1] == "orbit":
            raise ConvergenceError("no step is found")
        return simulate(model, *args, **words)

    monkeypatch.setattr("raceway.pipeline.transient_error.simulate", some)
    assert solved().error["total"] > 1e-3 and tried == ["orbit", "static"]


def test_a_force_that_grows_by_itself_is_compared_with_the_orbit():
    tables = rubbing("orbit")
    tables["excitation"] |= {"ramp_turns": 10.0}
    found = run(tables)
    assert found.simulation.start.kind == "ramp" and "and 'orbit'" in found.error["how"]["transient"]
    assert found.error["total"] > 1e-3


def test_the_plan_tells_the_run_from_another_start_and_its_time():
    def planned(turns, **contact):
        tables = rubbing()
        tables["integrator"] |= {"turns": turns}
        tables["contact"] |= contact
        return make_plan(scene_from_dict({**tables, "kinematics": {"gyroscopic": "outer_race"}}))

    part = "run from another start"
    assert part in [one.part for one in planned(20).kept]
    assert part in [one.part for one in planned(20, friction=0.0).left_out]
    # Gyroscopic moments ask for the same kernels; 100 turns more, without what is the same for all.
    each = [planned(120, friction=mu).predicted_work_s - planned(20, friction=mu).predicted_work_s for mu in (0.3, 0.0)]
    assert each[0] > 1.2 * each[1]


def test_fits_over_speeds_do_not_ask_for_another_start():
    tables = rubbing(identifier={"kind": "impedance_fit", "speeds_rpm": [9000.0, 12000.0]})
    assert "run from another start" in [one.part for one in make_plan(scene_from_dict(tables)).left_out]


def test_a_window_whose_halves_differ_by_more_than_it_sees_is_not_believed():
    """Under a free vibration within two lines of 1x the response beats, and one window sees a mean of it."""
    scene = scene_from_dict(rubbing())

    def unresolved(halves, orbit=None, repeats=True, friction=0.3):
        scene_of = attrs.evolve(scene, contact=attrs.evolve(scene.contact, friction=friction))
        simulation = SimpleNamespace(start=SimpleNamespace(orbit=orbit, repeats=repeats))
        return window_misses_transient(SimpleNamespace(problem=scene_of), simulation, Clean(1.0, 0j, "", halves), 1.0)

    assert unresolved(4.0) and unresolved(None) and not unresolved(2.0)
    assert unresolved(4.0, orbit=object()), "with friction the orbit of the start is none"
    assert not unresolved(4.0, orbit=object(), friction=0.0), "it began on its steady orbit"
    assert unresolved(0.0, orbit=object(), repeats=False, friction=0.0), "an unstable one"


@pytest.mark.parametrize(
    "tables", [{}, {"excitation": None}, {"friction": 0.0}, {"kind": "central_difference", "friction": 0.0}]
)
def test_each_derived_quantity_says_what_decides_it(tables):
    said = {name: table for name, table in rubbing(**tables).items() if table is not None}
    problem = make_plan(scene_from_dict(said)).problem
    for name, quantity in problem.derived().items():
        assert quantity["value"] is not None and len(quantity["why"]) > 10, name
    assert problem.why("turns") == "integrator.turns" and problem.why("tilts") == "supports.tilt lets the ring tilt"
