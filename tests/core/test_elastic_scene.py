"""Elastic bodies from a scene: a tiny bearing runs through plan, statics, every integrator, and is refused where it cannot."""

import copy
import io
import json

import numpy as np
import pytest

import raceway as rw
from raceway import RacewayError, SceneError, build_model, make_plan, scene_from_dict
from raceway.core.fem.elastic.iterative_solver import LinearSolver
from raceway.core.fem.elastic.ring import from_orbit
from raceway.extend import steady_orbit
from raceway.testing import Allowance, run, solve_equilibrium

#: Three balls on some two thousand hexahedra: every path, no accuracy.
TINY = {
    "title": "tiny",
    "bearing": {"preset": "B7206C", "ball_count": 3},
    "bodies": {"kind": "elastic", "formulation": "one_point"},
    "mesh": {
        "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 12, "growth": 3.0,
        "patch": 0.5, "ball_load": 3e4,
    },
    "load": {"axial": 2500.0},
    "rotor": {"mass": 0.5},
    "contact": {"kind": "penalty", "discretisation": "nodal", "stiffness": 3e14},
}  # fmt: skip
#: 15 000 r/min: a turn of 4 ms.  QUICK: a turn of 6 us, some 430 explicit steps; balls without centrifugal force.
EXCITED = {"excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "amplitude": "constant", "force": 300.0}}
QUIET = {"ball_inertia": False, "ring_growth": False}
QUICK = {"excitation": {**EXCITED["excitation"], "speed_rpm": 1e7}, "kinematics": QUIET}


def scene(**tables):
    merged = copy.deepcopy(TINY)
    for name, table in tables.items():
        merged[name] = {**merged.get(name, {}), **table} if isinstance(table, dict) else table
    return scene_from_dict(merged)


def built(**tables):
    return build_model(scene(**tables))


@pytest.fixture(scope="module")
def static():
    seen = []
    result = run(scene(), on_progress=lambda what, done, total: seen.append(what))
    return result, seen


def test_a_static_scene_balances_and_tells_what_it_found(static):
    result, seen = static
    found = result.to_dict()
    json.dumps(found, allow_nan=False)
    balls, model = found["equilibrium"]["balls"], found["model"]
    # Newton's residual is 1e-7 of the forces.
    assert model["reaction_n"]["x"] == pytest.approx(-2500.0, rel=1e-5)
    assert model["unbalanced_n"] < 1e-2
    carried = sum(b["load_inner_n"] * np.sin(np.radians(b["contact_angle_inner_deg"])) for b in balls)
    assert carried == pytest.approx(2500.0, rel=0.01)  # the angle is that of the ball's centre, not of the resultant
    # Three balls alike, on a mesh that repeats itself three times.
    assert np.ptp([b["load_inner_n"] for b in balls]) < 1e-3 * balls[0]["load_inner_n"]
    for key in ("peak_pressure_points_inner_pa", "peak_pressure_nodal_inner_pa", "approach_inner_m"):
        assert balls[0][key] > 0.0
    assert 0.0 < model["penetration_share"] < 1.0
    assert model["mesh"]["hourglass_coefficient"] == 0.05
    assert 0.0 < model["hourglass_energy_ratio"] < 1.0
    assert model["energies_j"]["elastic"] > 0.0
    assert abs(model["cage_force_n"]) < 1e-2
    # Newton's method: 6 iterations; half steps would take 20 to 1e-6.
    assert 1 <= sum("equilibrium, residual" in text for text in seen) <= 12
    stiffness = result.equilibrium.stiffness
    assert (stiffness == stiffness.T).all() and (np.linalg.eigvalsh(stiffness) > 0.0).all()


def test_the_screen_names_all_peak_pressures_and_tells_how_good_the_balance_is(static, caplog):
    from rich.console import Console

    console = Console(width=200, record=True, file=io.StringIO())
    with caplog.at_level("INFO", "raceway"):  # all rows, as with -v
        console.print(static[0].screen())
    text = console.export_text()
    ball = max(static[0].to_dict()["equilibrium"]["balls"], key=lambda one: one["load_inner_n"])
    for key, word in (("points_inner", "points"), ("nodal_inner", "nodal"), ("inner", "by Hertz")):
        assert f"{1e-6 * ball[f'peak_pressure_{key}_pa']:.0f} MPa {word}" in text
    for row in ("penetration share", "unbalanced force", "energies", "hourglass"):
        assert row in text


def test_an_hourglass_coefficient_without_hourglass_modes_is_told():
    (told,) = rw.check(scene(bodies={"formulation": "incompatible", "hourglass": 0.01})).warnings
    assert "`bodies.hourglass` has no effect" in told and "only 'one_point'" in told


def test_a_bed_under_the_outer_ring_yields_under_the_load(static):
    bed = run(scene(supports={"outer_seat": 1e12})).to_dict()
    held = static[0].to_dict()
    assert bed["model"]["reaction_n"]["x"] == pytest.approx(-2500.0, rel=1e-5)  # Newton's residual, as above
    # The ring slides by the load over the bed's stiffness on the whole cylinder at least (62 mm by 16 mm), and widens besides.
    slide = 2500.0 / (1e12 * np.pi * 0.062 * 0.016)
    assert bed["equilibrium"]["displacement"]["x"] > held["equilibrium"]["displacement"]["x"] + slide


def test_a_ring_that_rides_along_with_its_shaft_feels_nothing_of_its_seat():
    """To the rounding of sums whose terms are as large as what the bed does where the ring stays behind."""
    assembly = built(supports={"inner_seat": 1e12, "tilt": "free"}).bearing.bearing.system.assembly
    for q in 1e-6 * np.eye(5):
        along, behind = (np.concatenate([q, part * (assembly.carried @ q)[assembly.free]]) for part in (1.0, 0.0))
        rides, stays = (np.abs(assembly.internal(y, assembly.nodal(y))).max() for y in (along, behind))
        assert rides < 1e-6 * stays


def test_the_shaft_s_tilt_stiffness_is_no_part_of_the_bearing_s():
    """Under an axial load the ring does not tilt, however stiff the shaft: 1e-3 for the linear solves."""
    free, held = (run(scene(supports={"tilt": tilt})).equilibrium.stiffness for tilt in ("free", 1e5))
    assert np.diag(held) == pytest.approx(np.diag(free), rel=1e-3)


def test_dashpots_over_the_ellipse_at_the_reference_load_are_the_scene_s():
    model = built(contact={"damping": 500.0})
    bearing = model.bearing.bearing
    a, b = model.inner.semi_axes(bearing.setup.reference_load)
    assert bearing.system.contact.damping * np.pi * a * b == pytest.approx(500.0, rel=1e-12)


def test_the_matrix_of_a_step_is_that_of_its_forces():
    model = built(**EXCITED, rotor={"damping": 300.0}, supports={"tilt": "locked"})
    solve_equilibrium(model)
    system = model.bearing.bearing.system
    y = np.random.default_rng(2).standard_normal(system.size) * system.assembly.unknown
    m, damped = system.assembly.frame_size, np.zeros(system.size)
    damped[:m] = system.assembly.frame_damping @ y[:m]
    for parts, wanted in (((0.0, 1.0, 0.0), damped), ((0.0, 0.0, 1.0), system.mass_times(y))):
        unreduced = LinearSolver(system.assembly, system.contact, model.bearing.bearing.setup.modulus)
        found = unreduced.image(*parts)(y)
        np.testing.assert_allclose(found, wanted * system.assembly.unknown, rtol=1e-12, atol=1e-12 * np.abs(wanted).max())


def test_a_motion_on_an_orbit_starts_as_it_goes_on():
    """In a circle nearly: three balls are no full ring, and contacts are not linear; 20 % of radius, speed and acceleration."""
    model = built(**EXCITED, supports={"tilt": "locked"})
    equilibrium, w = solve_equilibrium(model), 15000.0 * np.pi / 30.0
    start = from_orbit(model.system, steady_orbit(model.system.surrogate, 2.0 * np.pi / w, equilibrium.displacement))
    y, z = start.q[1:3] - equilibrium.displacement[1:3]
    radius = np.hypot(y, z)
    assert start.v[1:3] == pytest.approx([-w * z, w * y], abs=0.2 * w * radius)
    assert start.a[1:3] == pytest.approx([-(w**2) * y, -(w**2) * z], abs=0.2 * w**2 * radius)


@pytest.mark.parametrize("kind", ["newmark", pytest.param("generalized_alpha", marks=pytest.mark.slow)])
def test_implicit_steps_run_from_the_scene(kind):
    found = run(scene(**EXCITED, integrator={"kind": kind, "turns": 1, "steps_per_turn": 8, "tolerance": 1e-5})).to_dict()
    json.dumps(found, allow_nan=False)
    assert found["identification"]["equivalent_stiffness"] > 1e7
    # Eight steps per turn: the balance is that of the trapezoidal rule, some percent.
    assert found["stability"]["energy_drift"] < 0.05
    assert set(found["stability"]["energies_j"]) >= {"elastic", "kinetic", "contact", "friction", "hourglass", "external"}
    assert found["error"]["total"] is None


def test_a_step_above_the_stable_limit_is_refused_with_the_limit():
    steps = {"kind": "central_difference", "turns": 1, "start": "static", "steps_per_turn": 100}
    with pytest.raises(RacewayError, match="above the stable limit of 'central_difference', 2.* s. Use at least"):
        run(scene(**QUICK, integrator=steps))


def test_a_held_axial_displacement_is_that_of_the_axial_load_alone(static):
    alone = static[0].to_dict()["equilibrium"]
    found = run(scene(load={"axial": 2500.0, "radial": [500.0, 0.0]}, supports={"axial": "displacement"})).to_dict()
    held = found["equilibrium"]["displacement"]
    assert held["x"] == pytest.approx(alone["displacement"]["x"], rel=1e-6)  # Newton's tolerance
    assert held["y"] > 0.0
    # What the ground does not carry of a radial load is the cage's: two of the three balls lean on it.
    model = found["model"]
    assert model["unbalanced_n"] < 2.0 * model["cage_force_n"] + 1e-2
    # The ground carries what the held ring presses, not the load.
    assert abs(model["reaction_n"]["x"] + 2500.0) > 1.0


@pytest.mark.parametrize("kinematics", [{"spin_speed_rpm": 40000.0}, {"radial_expansion": 1e-6}])
def test_a_held_axial_displacement_is_that_of_the_mounted_bearing(static, kinematics):
    """What presses the turning or grown bearing comes after it: the same place, another force."""
    alone = static[0].to_dict()["equilibrium"]
    found = run(scene(kinematics=kinematics, supports={"axial": "displacement"})).to_dict()["equilibrium"]
    assert found["displacement"]["x"] == pytest.approx(alone["displacement"]["x"], rel=1e-6)
    assert found["held_axial"]["mounted_n"] == 2500.0
    assert found["held_axial"]["running_n"] > 2525.0


def test_a_larger_inner_raceway_moves_less_for_the_same_load(static):
    before = static[0].to_dict()
    found = run(scene(kinematics={"radial_expansion": 1e-6})).to_dict()
    moved = found["equilibrium"]["displacement"]["x"] - before["equilibrium"]["displacement"]["x"]
    rigid = [one["model"]["rigid_rings"]["displacement"]["x"] for one in (found, before)]
    # Geometry decides, -cot(contact angle) to first order; the stiffness of contact and mesh enters with a tenth of that,
    # and this mesh is far from Hertz.
    assert moved == pytest.approx(rigid[0] - rigid[1], rel=0.1)
    assert moved < -1e-6


def test_the_plan_tells_size_and_cost_and_builds_nothing():
    plan = make_plan(scene())
    assert plan.dofs > 5_000
    assert 0.5 < plan.predicted_work_s < 60.0  # on the machine that the plan's constants are of
    assert any("every node" in part.why for part in plan.kept)
    assert any(part.part == "travel of the balls" for part in plan.left_out)


REFUSED = [
    ({"mesh": {"nodes_per_semi_axis": 0}}, "mesh.nodes_per_semi_axis", "pressures at surface points need cells"),
    ({"contact": {"discretisation": "resultant", "friction": 0.1}}, "contact.friction", "use 'nodal'"),
    ({"kinematics": {"orbiting": True, "spin_speed_rpm": 1e4}}, "kinematics.orbiting", "azimuth"),
    ({"kinematics": {"gyroscopic": "shared", "spin_speed_rpm": 1e4}}, "kinematics.gyroscopic", "do not rotate"),
    ({"bearing": {"tilt_arm": "pitch"}}, "bearing.tilt_arm", "shape of elastic rings"),
    ({"bearing": {"arrangement": "DB"}}, "bearing.arrangement", "one row of balls"),
    ({**EXCITED, "integrator": {"kind": "periodic"}}, "integrator.kind", "has no driver `stepped`"),
    ({"mesh": {"element_size": 2e-5}}, "mesh.element_size", "larger elements"),
]


@pytest.mark.parametrize(("change", "path", "why"), REFUSED, ids=[path for _, path, _ in REFUSED])
def test_what_elastic_bodies_cannot_do_is_refused_with_the_way_out(change, path, why):
    with pytest.raises(SceneError) as caught:
        make_plan(scene(**change))
    found = {m.path: m.message for m in caught.value.mistakes}
    assert why in found[path]


def test_memory_that_will_not_do_is_refused_with_both_numbers(monkeypatch):
    """A limit of the process counts as memory, less what it has taken."""
    make_plan(scene())
    monkeypatch.setattr("resource.getrlimit", lambda kind: (2**24, 2**24))
    with pytest.raises(SceneError, match="GiB, above -[.0-9]* GiB"):
        make_plan(scene())


def test_friction_at_rest_is_left_out_and_told(static):
    rubbing = scene(contact={"friction": 0.03})
    assert any(part.part == "friction" and "frictionless" in part.why for part in make_plan(rubbing).left_out)
    found = run(rubbing).to_dict()
    assert any("frictionless" in text for text in found["warnings"])
    # Nothing else differs but the springs of the cage, which rest on nothing that carries.
    x = static[0].to_dict()["equilibrium"]["displacement"]["x"]
    assert found["equilibrium"]["displacement"]["x"] == pytest.approx(x, rel=1e-6)
    moving = scene(contact={"friction": 0.03}, **EXCITED)
    assert any(part.part == "friction" for part in make_plan(moving).kept)


def test_no_run_on_a_mesh_of_unknown_size_is_stopped_for_its_time():
    files = {"kind": "file", "ball": "b.vtu", "inner_ring": "i.vtu", "outer_ring": "o.vtu"}
    plan = make_plan(scene_from_dict({**TINY, "mesh": files}))
    assert plan.at_least and plan.mesh is None
    assert Allowance.of(plan, 20.0).patience == float("inf")
    assert Allowance.of(make_plan(scene()), 20.0).patience == 20.0


def test_surfaces_that_overlap_by_more_than_an_element_are_refused():
    with pytest.raises(RacewayError, match="inner race: the surfaces overlap by 1.4.* µm before loading"):
        run(scene(kinematics={"radial_expansion": 1.5e-3}))


def test_a_motion_that_nothing_holds_is_named_before_anything_is_iterated():
    seen = []
    with pytest.raises(RacewayError, match="no stiffness against z with tilt_y"):
        run(scene(bearing={"ball_count": 2}, supports={"tilt": "free"}), on_progress=lambda *told: seen.append(told[0]))
    assert not any("residual" in text for text in seen)


def test_no_load_is_refused_by_name():
    with pytest.raises(RacewayError, match="no load acts"):
        run(scene(load={"axial": 0.0}))
