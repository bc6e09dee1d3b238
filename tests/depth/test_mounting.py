"""Preload and held displacements are set at standstill without growth; the references are solved here, with scipy.

A DB pair under a turning force with locked tilts stays in its middle plane by symmetry: each row carries half the force at the
axial displacement that was built in.
"""

import attrs
import numpy as np
import pytest

import raceway as rw
from checks.validation.reference.mounted import FORCE, approach, axial, row, secant
from raceway import ConvergenceError, run, scene_from_dict
from raceway.extend import equilibrium_table, layout
from raceway.testing import b7206c, solve_equilibrium

#: Of K, kxx and kyy: 0.1 % is asked for; what differs is the time step of newmark and the 1x line of the orbit.
TOLERANCE = 1e-3


def pair(kind="rigid", preload=300.0, **more):
    bearing = {"arrangement": "DB", "preload": preload, "preload_kind": kind}
    return b7206c(**{"bearing": bearing, "load": {"axial": 0.0}, **more})


def turning(rpm):
    return {"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": FORCE}


@pytest.mark.parametrize(
    ("rpm", "told"), [(6000.0, None), (12000.0, 298.8), (15000.0, 272.1), (20000.0, 235.3), (30000.0, 199.6)]
)
def test_offset_of_a_pair_stays_at_every_speed(rpm, told):
    """Also against an independent program's K [N/um], to its printed digits (0.1 %)."""
    result = run(pair(excitation=turning(rpm), integrator={"turns": 4}))
    found, running = result.identification, row(rpm)
    x = approach(row(), 300.0)
    expected = secant(running, None, 2, found.mass_used, found.speed, x)
    assert found.equivalent_stiffness == pytest.approx(expected, rel=TOLERANCE)
    assert told is None or 1e-6 * found.equivalent_stiffness == pytest.approx(told, rel=TOLERANCE)
    preload = result.to_dict()["equilibrium"]["preload"]
    assert preload["mounted_n"] == 300.0
    assert preload["running_n"] == pytest.approx(axial(running, x), rel=TOLERANCE)


@pytest.mark.parametrize(("growth", "told"), [(5e-6, (103.7, 494.2, 930.0)), (2e-6, None), (-2e-6, None)])
def test_growth_loads_a_pair(built, growth, told):
    """kxx, kyy [N/um] and the preload [N]: a larger inner raceway stiffens a pair whose offset stays."""
    now = solve_equilibrium(built(**pair(kinematics={"radial_expansion": growth})))
    grown, x = row(growth=growth), approach(row(), 300.0)
    tangent = 2.0 * np.diag(grown(np.array([x, 0.0, 0.0, 0.0, 0.0]))[1])
    assert now.stiffness[0, 0] == pytest.approx(tangent[0], rel=TOLERANCE)
    assert now.stiffness[1, 1] == pytest.approx(tangent[1], rel=TOLERANCE)
    assert (now.stiffness[1, 1] > solve_equilibrium(built(**pair())).stiffness[1, 1]) == (growth > 0.0)
    if told is not None:
        found = run(pair(kinematics={"radial_expansion": growth})).to_dict()["equilibrium"]
        values = 1e-6 * found["stiffness"][0][0], 1e-6 * found["stiffness"][1][1], found["preload"]["running_n"]
        assert values == pytest.approx(told, rel=TOLERANCE)


@pytest.mark.parametrize(("rpm", "growth"), [(30000.0, 0.0), (15000.0, 0.0), (0.0, 2e-6), (15000.0, 2e-6)])
def test_a_held_displacement_is_that_of_the_mounted_bearing(rpm, growth):
    kinematics = {"spin_speed_rpm": rpm, "radial_expansion": growth}
    tables = b7206c(load={"axial": 400.0}, supports={"axial": "displacement"}, kinematics=kinematics)
    found = run(tables).to_dict()["equilibrium"]
    running, x = row(rpm, growth), approach(row(), 400.0)
    force, tangent, _ = running(np.array([x, 0.0, 0.0, 0.0, 0.0]))
    assert found["displacement"]["x"] == pytest.approx(x, rel=TOLERANCE)
    assert found["stiffness"][1][1] == pytest.approx(tangent[1, 1], rel=TOLERANCE)
    assert found["held_axial"]["mounted_n"] == 400.0
    assert found["held_axial"]["running_n"] == pytest.approx(force[0], rel=TOLERANCE)
    if (rpm, growth) == (30000.0, 0.0):  # an independent program's
        assert (1e6 * x, 1e-6 * tangent[1, 1]) == pytest.approx((18.0, 114.5), rel=3e-3)


@pytest.mark.parametrize("load", [0.0, 150.0, -250.0])
def test_a_spring_keeps_its_force(load):
    """The second row carries the spring's force, the first one the load with it, each as a single row would."""
    kinematics = {"spin_speed_rpm": 20000.0, "radial_expansion": 2e-6}
    result = run(pair("spring", kinematics=kinematics, load={"axial": load}))
    found = result.to_dict()["equilibrium"]
    assert found["preload"]["rows_n"] == pytest.approx([300.0 + load, 300.0], rel=1e-8)
    assert found["preload"]["running_n"] == found["preload"]["mounted_n"] == 300.0
    running, tangent = row(20000.0, 2e-6), np.zeros(5)
    first = approach(running, 300.0 + load)
    for x in (first, approach(running, 300.0)):
        tangent = tangent + np.diag(running(np.array([x, 0.0, 0.0, 0.0, 0.0]))[1])
    assert found["displacement"]["x"] == pytest.approx(first - approach(row(), 300.0), rel=TOLERANCE)
    assert found["stiffness"][1][1] == pytest.approx(tangent[1], rel=TOLERANCE)


@pytest.mark.parametrize("bodies", ["rigid", "condensed"])
def test_a_held_displacement_of_a_sprung_pair_is_that_under_the_axial_load(built, bodies):
    """Mounted, too, the second row keeps the spring's force: the first one carries load and preload; at rest nothing changes."""
    more = {"load": {"axial": 400.0}, "bodies": {"kind": bodies}}
    held, free = (built(**pair("spring", supports={"axial": axial}, **more)) for axial in ("displacement", "force"))
    now, loaded = solve_equilibrium(held), solve_equilibrium(free)
    # The spring's force is met to 1e-9, and the force of 400 N by as much of the stiffness.
    assert now.displacement == pytest.approx(loaded.displacement, rel=1e-8, abs=1e-16)
    assert equilibrium_table(held, now)["held_axial"]["running_n"] == pytest.approx(400.0, rel=1e-8)
    assert equilibrium_table(held, now)["preload"]["rows_n"] == pytest.approx([700.0, 300.0], rel=1e-8)
    if bodies == "rigid":
        assert now.displacement[0] == pytest.approx(approach(row(), 700.0) - approach(row(), 300.0), rel=TOLERANCE)
    running = built(**pair("spring", supports={"axial": "displacement"}, kinematics=ALL, **more))
    assert running.guess[0] == pytest.approx(now.displacement[0], rel=1e-8)
    assert equilibrium_table(running, solve_equilibrium(running))["preload"]["rows_n"][1] == pytest.approx(300.0, rel=1e-8)


@pytest.mark.parametrize("bodies", ["rigid", "condensed"])
@pytest.mark.parametrize(("first", "last"), [(500.0, 30000.0), (15000.0, 6000.0)])
def test_a_sprung_row_follows_a_changing_speed(built, bodies, first, last):
    """Between the speeds that it is placed at, too, the second row carries the spring's force; 1e-4 of it is what a spline leaves."""
    excitation = {"kind": "run_up", "first_speed_rpm": first, "speed_rpm": last, "duration_s": 0.5, "unbalance": 3.2e-4}
    identifier, integrator = {"kind": "order_tracking", "window_turns": 6.0}, {"steps_per_turn": 120}
    common = {"load": {"axial": 100.0}, "rotor": {"mass": 2.0}, "identifier": identifier, "integrator": integrator}
    changed = {"bodies": {"kind": bodies}, "kinematics": {"ring_growth": True}}
    model = built(**pair("spring", excitation=excitation, **common, **changed))
    now = solve_equilibrium(model)
    for share in (0.0, 0.28, 0.53, 0.97, 1.0):
        system = model.system.at_speed(0.5 * share)
        q, ball, _ = system.solve_equilibrium(now.displacement)
        moved = attrs.evolve(now, displacement=q, ball=ball)
        rows = equilibrium_table(attrs.evolve(model, system=system), moved)["preload"]["rows_n"]
        assert rows == pytest.approx([400.0, 300.0], rel=1e-4)


@pytest.mark.parametrize("bodies", ["rigid", "condensed"])
def test_a_pair_that_has_lost_its_preload_says_what_took_it(bodies):
    """A DB pair at rest under 300 N: 2 um leave 120.7 N, 5 um nothing."""
    shrunk = pair(bodies={"kind": bodies}, kinematics={"radial_expansion": -5e-6})
    lost = r"no stiffness against x.*preload of 300 N is lost.*shrunk by 5 µm \(kinematics\.radial_expansion = -5e-06 m\)"
    with pytest.raises(ConvergenceError, match=lost):
        run(shrunk)
    run({**shrunk, "load": {"axial": 50.0}})  # one row carries it


def test_a_spring_that_the_load_overcomes_is_told():
    """On deep grooves nothing stops a ring that leaves its first row."""
    tables = pair("spring", load={"axial": -350.0}, kinematics={"spin_speed_rpm": 20000.0})
    assert any("loses axial contact" in one for one in run(tables).warnings)


def test_a_search_that_ends_without_the_springs_force_is_refused(monkeypatch):
    monkeypatch.setattr("raceway.bodies.mounting._LIMIT", 1)
    with pytest.raises(ConvergenceError, match=r"no position of the second row.*spring of `bearing.preload` = 300 N"):
        run(pair("spring", kinematics={"spin_speed_rpm": 20000.0}))


GROWN = {"radial_expansion": 3e-6}
TURNING = {"spin_speed_rpm": 20000.0}
#: Spinning and grown balls and rings: everything that the mounting state leaves out.
ALL = {**TURNING, **GROWN, "gyroscopic": "outer_race", "ring_growth": True}


@pytest.mark.parametrize(
    ("bodies", "kinematics"),
    [(bodies, one) for bodies in ("rigid", "condensed") for one in (TURNING, GROWN, ALL)]
    + [pytest.param("patches", ALL, marks=pytest.mark.slow)],
)
def test_every_kind_of_bodies_is_mounted_at_standstill(built, bodies, kinematics):
    """The rows' offset and the held displacement are those of the scene that neither turns nor grows."""
    tables = {"bodies": {"kind": "rigid" if bodies == "rigid" else "condensed"}}
    if bodies == "patches":
        tables["contact"] = {"kind": "unilateral", "discretisation": "nodal"}
        tables["mesh"] = {"kind": "structured", "nodes_per_semi_axis": 2, "ball_load": 100.0}
    # Points follow the running contacts: other places of the same points, which the approach feels by less than 1e-3.
    same = 1e-3 if bodies == "patches" else 1e-7
    still, running = (built(**pair(**tables, kinematics=one)) for one in ({}, kinematics))
    assert running.system.table[:, layout.SHIFT] == pytest.approx(still.system.table[:, layout.SHIFT], rel=same)
    now = solve_equilibrium(still)
    assert equilibrium_table(still, now)["preload"]["rows_n"] == pytest.approx([300.0, 300.0], rel=1e-7)
    held = {"supports": {"axial": "displacement"}, "load": {"axial": 400.0}, **tables}
    still, running = (built(**held, kinematics=one) for one in ({}, kinematics))
    assert running.guess[0] == pytest.approx(still.guess[0], rel=same)


def test_the_kind_of_no_preload_is_told_to_do_nothing():
    scene = scene_from_dict(b7206c(bearing={"preload_kind": "spring"}))
    assert any("preload_kind" in one for one in rw.check(scene).warnings)
    found = run(scene).to_dict()["equilibrium"]
    assert found["preload"] is None and found["held_axial"] is None
