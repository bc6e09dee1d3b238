"""Whole condensed bearings: published answers, what a result tells, what is refused."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from raceway import SceneError, make_plan, scene_from_dict
from raceway.core.fem import calibration
from raceway.pipeline.uncertainty import elastic_change
from raceway.testing import b7206c, calibration_error, run, settled

ROTATING = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "unbalance", "unbalance": 6.39e-4, "load_share": 0.5}


def tables(**changes):
    given = {"load": {"radial": [500.0, 0.0]}, "bodies": {"kind": "condensed"}, "kinematics": {"ball_inertia": False}}
    return b7206c(**given | changes)


def at_rest(**changes):
    return settled(tables(**changes))


@pytest.mark.parametrize(("supports", "displacement", "diagonal"), [
    ({"tilt": "locked"}, {0: 28.691, 1: 1.957}, (65.00, 254.8, 255.5)),
    ({"tilt": "free"}, {0: 26.921, 1: 13.676, 4: 1544.7}, (65.60, 267.5, 253.8)),
])  # fmt: skip
def test_whole_bearing(supports, displacement, diagonal):
    """An independent program's answers (um, urad, N/um): 1 %."""
    found = at_rest(supports=supports)[1]
    for index, value in displacement.items():
        assert 1e6 * found.displacement[index] == pytest.approx(value, rel=0.01)
    for index, value in enumerate(diagonal):
        assert 1e-6 * found.stiffness[index, index] == pytest.approx(value, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("tilt", ["locked", "free"])
def test_resultants_on_beds_are_near_pressures_at_surface_points(tilt):
    """0.4 %, of which three points along a semi-axis take a half."""
    both = {"tilt": tilt, "inner_seat": 1e10, "outer_seat": 1e10}
    ours = at_rest(load={"axial": 1000.0}, supports=both)[1]
    theirs = at_rest(
        load={"axial": 1000.0}, supports=both, contact={"kind": "unilateral", "discretisation": "nodal"},
        mesh={"kind": "structured", "nodes_per_semi_axis": 3, "element_size": 1.2e-3},
    )[1]  # fmt: skip
    assert np.diag(ours.stiffness)[:3] == pytest.approx(np.diag(theirs.stiffness)[:3], rel=0.004)
    assert ours.displacement[0] == pytest.approx(theirs.displacement[0], rel=0.004)


@pytest.mark.parametrize(("size", "along"), [(1e-3, 2), pytest.param(0.7e-3, 3, marks=pytest.mark.slow)])
def test_the_mesh_error_bounds_what_a_finer_mesh_changes(size, along):
    """Above it, and not by more than ten times: half the size leaves half to a quarter of the error, twice the size has two to four
    times as much."""
    case, found = at_rest(mesh={"kind": "structured", "element_size": size, "nodes_per_semi_axis": along})
    _, fine = at_rest(mesh={"kind": "structured", "element_size": 0.5 * size, "nodes_per_semi_axis": 2 * along})
    free = case.system.free > 0.0
    change = np.abs(np.diag(fine.stiffness)[free] / np.diag(found.stiffness)[free] - 1.0).max()
    assert change < case.bearing.mesh_error(case, found)[0] < 10.0 * change


def test_the_error_of_a_calibration_is_that_of_both_contacts_over_what_a_ball_gives():
    case, found = settled(b7206c())
    load = found.contact_force[0]
    give = (case.inner.approach(load) + case.outer.approach(load)) / (1.5 * load)  # both tangents of Hertz
    for known in ((1e-10, 0.0), (0.0, 3e-10)):
        races = [SimpleNamespace(error=lambda load, error=error: error + 0.0 * load) for error in known]
        rings = SimpleNamespace(calibrations=races, at=lambda angle: (0.0, 0.0), ball_opposite=0.0)
        assert calibration_error(rings, case, found)[0] == pytest.approx(sum(known) / give, rel=1e-9)


def test_a_result_tells_what_elasticity_does_and_how_sure_it_is():
    result = run(
        scene_from_dict(tables(excitation=ROTATING, rotor={"mass": 2.0}, integrator={"kind": "quasi_static", "turns": 1}))
    )
    content = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    model, error = content["model"], content["error"]
    rigid = run(scene_from_dict(tables(bodies={"kind": "rigid"}))).to_dict()["equilibrium"]
    assert model["rigid_rings"]["stiffness"] == pytest.approx(np.array(rigid["stiffness"]), rel=1e-9, abs=1e-3)
    assert model["rigid_rings"]["displacement"]["x"] == pytest.approx(rigid["displacement"]["x"], rel=1e-9)
    # Thin rings on rigid seats: stiffer by 5 and 8 % (physics.md, section 10).
    assert model["elasticity"][0][0] == pytest.approx(0.055, abs=0.01)
    assert model["elasticity"][1][1] == pytest.approx(0.08, abs=0.01)
    assert model["elasticity"][0][2] is None
    # Without a mesh: changes are met within 10 % of themselves, and stated 10 % above that; kxx is smaller by its contact angle.
    estimate = elastic_change(*settled(tables(bodies={"kind": "rigid"})))
    assert model["elasticity"][1][1] < estimate["kyy"] < 1.2 * model["elasticity"][1][1]
    assert model["elasticity"][0][0] < estimate["kxx"] < estimate["kyy"]
    assert 3.0 < model["mesh"]["nodes_per_semi_axis"] < 5.0
    assert error["mesh"] == model["mesh"]["change_from_coarser"]
    assert 0.0 < error["mesh"] < 5e-3
    inertia = model["inertia"]
    first = {"inner_supported": 133e3, "outer_supported": 157e3, "inner_free": 10.5e3, "outer_free": 3.7e3}
    for name, hertz in first.items():
        assert inertia[f"{name}_hz"] == pytest.approx(hertz, rel=0.1)
        assert inertia[f"{name}_error"] == pytest.approx((200.0 / inertia[f"{name}_hz"]) ** 2)
    assert 3000.0 < inertia["ball_along_grooves_hz"] < 5000.0
    assert error["bodies"] == pytest.approx(error["mesh"] + error["contact"])
    # Mesh and calibration change sizes, no phases: damping is not drowned in their error.
    found = content["identification"]
    assert found["phase_lag_error_deg"] < 0.1 * np.degrees(error["mesh"])


@pytest.mark.parametrize(("changes", "word"), [
    ({"bearing.bore": 0.0385}, "cuts the inner raceway"), ({"bearing.width": 0.004}, "does not hold the groove"),
    ({"supports.outer_seat": 0}, "must be greater than 0"), ({"supports.inner_seat": -1e11}, "must be greater than 0"),
    ({"supports.outer_seat": "[1e11,2e11]"}, "bodies.kind = 'elastic'"),
    ({"supports.outer_seat": 500}, "500 N/mm3 is 5e11"), ({"mesh.kind": "structured", "mesh.element_size": 1e-5}, "GiB"),
    ({"contact.damping": 50000}, "N s/m"),
])  # fmt: skip
def test_what_cannot_be_condensed_ends_with_one_message(changes, word, tmp_path):
    words = [part for key, value in changes.items() for part in ("--set", f"{key}={value}")]
    done = invoke("run", EXAMPLES / "b7206_condensed.toml", "--out", tmp_path, *words)
    assert done.exit_code == 2
    assert word in " ".join(done.output.split())
    assert done.output.count("error:") == 1


def test_a_bearing_without_dimensions_is_refused_by_name():
    own = {"ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": 12, "contact_angle_deg": 15.0}
    own |= {"conformity_inner": 0.522, "conformity_outer": 0.522}
    with pytest.raises(SceneError) as caught:
        make_plan(scene_from_dict({**tables(), "bearing": own}))
    assert {m.path for m in caught.value.mistakes} == {"bearing.bore", "bearing.outer_diameter", "bearing.width"}


@pytest.mark.slow
@pytest.mark.parametrize(("speed_rpm", "told"), [(6000.0, False), (30000.0, True)])
def test_rings_that_lag_by_more_than_the_stated_error_are_told(speed_rpm, told):
    """On beds of 1e10 N/m3 the inner ring's first frequency is 2.1 kHz: (w / w1)^2 is 0.2 % and 5.5 %, the stated error 0.1 %."""
    soft = {"outer_seat": 1e10, "inner_seat": 1e10}
    force = {"kind": "bidirectional", "speed_rpm": speed_rpm, "amplitude": "constant", "force": 20.0}
    given = {"bodies": {"kind": "condensed"}, "supports": soft, "rotor": {"mass": 2.0}, "integrator": {"kind": "periodic"}}
    result = run(scene_from_dict(b7206c(**given, excitation=force)))
    lag = result.to_dict()["model"]["inertia"]["inner_supported_error"]
    assert lag == pytest.approx((speed_rpm / 60.0 / 2140.0) ** 2, rel=0.05) and result.error["total"] < 2e-3
    assert any("inner ring is quasi-static" in text for text in result.warnings) is told


def test_limit_takes_away_an_error_of_order_two_and_gives_the_tangent():
    """Of c = c0 + t log(Q / Q0) with errors 1 / n^2: secants become exact, the tangent d(c Q) / dQ is c0 + t."""
    nodes = np.array(calibration.POINTS)[:, None]
    values = -1e-9 + 2e-11 * np.log(calibration.LOADS) + 3e-9 / nodes**2
    found = calibration._limit(np.array([values, values + 1e-10]), 0.26, 200.0)
    assert found.compliance == pytest.approx([-0.98e-9, -0.88e-9], rel=1e-12)
    assert found.trend == pytest.approx(2e-11, rel=1e-9)
    assert found.uncertainty == pytest.approx(3e-9 / calibration.POINTS[1] ** 2, rel=1e-9)
    # At the typical load the tangent is right and the secant off by the trend.
    assert found.error(np.array([200.0])) == pytest.approx(found.uncertainty + found.trend)


def test_the_calibration_holds_for_both_signs_of_the_angle():
    """Both lands of this preset are alike."""
    bodies = at_rest()[0].bearing.compliances
    assert bodies.direct(0, np.array([-0.3])) - bodies.direct(0, np.array([0.3])) == pytest.approx(0.0, abs=0.01e-9)


def test_a_point_is_the_same_alone_and_among_others_where_nothing_calibrates_its_contacts(monkeypatch):
    """A ball's own compliance follows the load of its point: by the least load of a block kyy was 0.4 % off."""
    monkeypatch.setattr("raceway.plugins.bodies.condensed_bearing.calibrated", lambda *_: None)
    monkeypatch.setattr("raceway.plugins.bodies.condensed_bearing.BODIES_BY_SECTION", {})
    scene = {"bearing": {"preset": "B7206C"}, "bodies": {"kind": "condensed"}, "load": {"axial": 1000.0}}
    function = rw.function(scene, ["load.axial"], ["kyy"])
    alone, among = (function(np.array(loads))["kyy"] for loads in ([400.0], [4.0, 400.0, 4000.0]))
    assert among[1] == pytest.approx(alone[0], rel=1e-12)  # the same arithmetic
