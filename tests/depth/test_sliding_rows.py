"""Rows on a spring: stiffness and damping with these rows following against slopes of whole runs and a condensation in numpy,
with them held as in a motion, and the preload in three states: before mounting, mounted, running."""

import numpy as np
import pytest

import raceway as rw
from checks.validation.reference.mounted import approach, axial, row
from raceway import ConvergenceError
from raceway.extend import layout
from raceway.pipeline.run_parts import mounting_rows
from raceway.testing import b7206c

#: Asked for: a stiffness against slopes of whole runs.  Differences of fourth order leave 1e-8, the spring's force 1e-9.
SLOPE = 1e-6
MIXED = {"row": [{"preset": "B7206E"}, {"preset": "B7206E"}, {"preset": "B7206C"}]}
FREE = {"tilt": "free"}


def sprung(arrangement="DB", preload=300.0, bearing=None, **tables):
    given = {"preset": "B7206C", "arrangement": arrangement, "preload": preload, "preload_kind": "spring", **(bearing or {})}
    return {"bearing": given, **tables}


def slopes(tables, unknown, force=3.0, moment=0.01):
    """(n, n) stiffness from runs under loads that differ by ``force`` and ``moment``, of fourth order."""
    base = np.array([tables["load"]["axial"], *tables["load"].get("radial", (0.0, 0.0)), 0.0, 0.0])
    receptance = np.zeros((len(unknown), len(unknown)))
    for column, k in enumerate(unknown):
        step = force if k < 3 else moment
        for weight, part in ((1.0, -2), (-8.0, -1), (8.0, 1), (-1.0, 2)):
            load = base + part * step * np.eye(5)[k]
            given = {"axial": load[0], "radial": load[1:3].tolist(), "moment": load[3:].tolist()}
            moved = rw.run({**tables, "load": given if max(unknown) > 2 else {**given, "moment": [0.0, 0.0]}}).displacement
            receptance[:, column] += weight * moved[unknown] / (12.0 * step)
    return np.linalg.inv(receptance)


@pytest.mark.parametrize("rpm", [0.0, 12000.0])
@pytest.mark.parametrize("arrangement", ["DB", "DF", "TBT"])
def test_the_axial_stiffness_is_the_slope_of_whole_runs(arrangement, rpm):
    tables = sprung(arrangement, load={"axial": 0.0}, kinematics={"spin_speed_rpm": rpm})
    result = rw.run(tables)
    assert result.stiffness[0, 0] == pytest.approx(slopes(tables, [0])[0, 0], rel=SLOPE)
    held = np.array(result.to_dict()["equilibrium"]["stiffness_rows_held"])
    assert held[0, 0] > 1.6 * result.stiffness[0, 0]
    np.testing.assert_allclose(held[1:, 1:], result.stiffness[1:, 1:], rtol=1e-12, atol=1e-6 * held[3, 3])  # by symmetry


@pytest.mark.parametrize(
    ("tables", "unknown"),
    [
        (sprung("DB", load={"axial": 80.0, "radial": [150.0, 60.0]}), [0, 1, 2]),
        (sprung("DB", load={"axial": 0.0, "radial": [150.0, 60.0]}, supports=FREE), [0, 1, 2, 3, 4]),
        (sprung("TBT", load={"axial": 50.0, "radial": [200.0, 0.0]}, supports=FREE, kinematics={"spin_speed_rpm": 12000.0}), [0, 1, 2, 3, 4]),
        (sprung("TBT", bearing={**MIXED, "second_preload": 400.0, "spring_travel": 1e-4}, load={"axial": 50.0, "radial": [150.0, 60.0]}), [0, 1, 2]),
    ],
    ids=["radial load", "tilts free", "TBT at speed", "unequal rows"],
)  # fmt: skip
def test_every_entry_is_a_slope_of_whole_runs(tables, unknown):
    result = rw.run(tables)
    found, expected = result.stiffness[np.ix_(unknown, unknown)], slopes(tables, unknown)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(found / scale, expected / scale, atol=SLOPE)
    held = result.equilibrium.stiffness_rows_held
    assert abs(held[1, 1] / result.stiffness[1, 1] - 1.0) > 1e-4  # a radial load couples y to the sliding rows


def condensed(first, second, w):
    """K and C (3, 3) of a DB pair from those of two single rows over x, y, z, the second one turned round and sliding along x."""
    turn = np.diag([-1.0, 1.0, 1.0])
    z1, z2 = (k + 1j * w * c for k, c in (first, second))
    z2 = turn @ z2 @ turn
    whole = np.zeros((4, 4), dtype=complex)  # x, y, z of the inner rings, x of the second outer ring
    whole[:3, :3], whole[:3, 3], whole[3, :3], whole[3, 3] = z1 + z2, -z2[:, 0], -z2[0], z2[0, 0]
    met = whole[:3, :3] - np.outer(whole[:3, 3], whole[3, :3]) / whole[3, 3]
    return met.real, met.imag / w


def test_stiffness_and_damping_are_those_of_single_rows_condensed():
    """Each row of a pair carries the spring and half the radial load, as a bearing by itself."""
    common = {"contact": {"time_constant": 2.5e-6}, "kinematics": {"spin_speed_rpm": 15000.0}}
    pair = rw.run(sprung(load={"axial": 0.0, "radial": [200.0, 0.0]}, **common))
    single = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0, "radial": [100.0, 0.0]}, **common})
    own = single.stiffness[:3, :3], single.damping[:3, :3]
    stiffness, damping = condensed(own, own, 1e-3)
    np.testing.assert_allclose(pair.stiffness[:3, :3], stiffness, rtol=1e-7, atol=1e-7 * stiffness.max())
    np.testing.assert_allclose(pair.damping[:3, :3], damping, rtol=1e-6, atol=1e-6 * damping.max())
    held = pair.to_dict()["equilibrium"]["damping_rows_held"]
    assert held[0][0] == pytest.approx(2.0 * own[1][0, 0], rel=1e-6)


@pytest.mark.parametrize("bodies", ["condensed", pytest.param("patches", marks=pytest.mark.slow)])
def test_elastic_bodies_follow_alike(bodies):
    """Axially a pair on a spring is its first row: meshes and contacts are the same, to what an equilibrium is solved to."""
    tables = {"bodies": {"kind": "condensed"}}
    if bodies == "patches":
        tables["contact"] = {"kind": "unilateral", "discretisation": "nodal"}
        tables["mesh"] = {"kind": "structured", "nodes_per_semi_axis": 2, "ball_load": 100.0}
    pair = rw.run(sprung(load={"axial": 0.0}, **tables))
    single = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}, **tables})
    assert pair.stiffness[0, 0] == pytest.approx(single.stiffness[0, 0], rel=1e-6)
    report = pair.to_dict()["model"]
    assert report["elasticity"][0][0] == pytest.approx(single.to_dict()["model"]["elasticity"][0][0], rel=1e-4)
    assert bodies == "patches" or report["mesh"]["change_from_coarser"] < 0.05


def motion(identifier, **integrator):
    excitation = {"kind": "unidirectional", "speed_rpm": 9000.0, "amplitude": "constant", "force": 0.05}
    load = {"axial": 0.0, "radial": [250.0, 0.0]}
    return sprung(load=load, excitation=excitation, rotor={"mass": 2.0}, identifier={"kind": identifier}, **integrator)


def test_a_motion_holds_the_rows_and_so_does_the_identifier_tangent():
    """Small motions under a radial load: both hold the rows, where the static stiffness lets them follow."""
    tangent, orbit = rw.run(motion("tangent")), rw.run(motion("fft_1x", integrator={"kind": "periodic"}))
    assert tangent.equivalent_stiffness == pytest.approx(orbit.equivalent_stiffness, rel=1e-6)
    held, follows = tangent.equilibrium.stiffness_rows_held, tangent.stiffness
    assert tangent.equivalent_stiffness == pytest.approx(held[1, 1] - held[1, 0] ** 2 / held[0, 0], rel=1e-3)
    assert tangent.equivalent_stiffness > (1.0 + 1e-3) * (follows[1, 1] - follows[1, 0] ** 2 / follows[0, 0])


def test_the_stable_step_is_that_of_the_motion():
    """Rows that are held are the stiffer ones; at 60 deg a pair is stiffest axially."""
    tables = sprung(bearing={"contact_angle_deg": 60.0}, load={"axial": 0.0}, rotor={"mass": 0.1})
    excitation = {"kind": "bidirectional", "speed_rpm": 9000.0, "amplitude": "constant", "force": 1.0}
    result = rw.run(
        {**tables, "excitation": excitation, "integrator": {"kind": "central_difference", "turns": 2, "start": "static"}}
    )
    mass = result.model.mass_used
    stiffest = result.equilibrium.stiffness_rows_held[0, 0]
    assert stiffest > 1.5 * np.diag(result.stiffness)[:3].max()
    assert result.stability["critical_time_step_s"] == pytest.approx(2.0 * np.sqrt(mass / stiffest), rel=1e-3)


@pytest.mark.parametrize(("key", "step"), [("load.axial", 5.0), ("bearing.preload", 5.0)])
def test_gradients_are_those_of_whole_runs(key, step):
    tables = sprung(load={"axial": 50.0, "radial": [150.0, 0.0]}, kinematics={"spin_speed_rpm": 12000.0})
    table, name = key.split(".")
    near = {k: rw.run({**tables, table: {**tables[table], name: tables[table][name] + k * step}}) for k in (-2, -1, 1, 2)}
    statics = rw.run(tables).gradient(key).statics
    for word, chosen in (("displacement", [0, 1]), ("stiffness", ([0, 0, 1], [0, 1, 1]))):
        values = {k: getattr(one, word)[chosen] for k, one in near.items()}
        expected = (values[-2] - 8.0 * values[-1] + 8.0 * values[1] - values[2]) / (12.0 * step)
        np.testing.assert_allclose(getattr(statics, word)[chosen], expected, rtol=1e-4)


def test_two_preloads_with_a_spring_are_reported_as_the_rows_carry_them():
    found = rw.run(sprung("TBT", bearing={"second_preload": 600.0}, load={"axial": 0.0})).to_dict()["equilibrium"]["preload"]
    assert (found["before_mounting_n"], found["second_before_mounting_n"]) == (300.0, 600.0)
    assert found["rows_n"] == pytest.approx([300.0, 300.0, 600.0], rel=1e-8)
    assert found["mounted_n"] == found["running_n"] == 600.0
    under = rw.run(sprung("TBT", bearing={"second_preload": 600.0}, load={"axial": -300.0})).to_dict()["equilibrium"]
    assert under["preload"]["rows_n"] == pytest.approx([150.0, 150.0, 600.0], rel=1e-8)
    assert abs(under["displacement"]["x"]) < 1e-12  # that is the load which both preloads are set under


def test_a_rigid_set_under_two_preloads_settles_between_them():
    tables = sprung("DB", bearing={"second_preload": 600.0, "preload_kind": "rigid"}, load={"axial": 0.0})
    found = rw.run(tables).to_dict()["equilibrium"]["preload"]
    assert 300.0 < found["mounted_n"] < 600.0
    assert found["mounted_n"] == pytest.approx(found["running_n"], rel=1e-9)
    assert found["rows_n"] == pytest.approx(2 * [found["mounted_n"]], rel=1e-9)


#: On the shaft: raceway and bore of the B7206C in mm; the raceway grows by Lame's formula, a solid shaft of the same steel.
TIGHT, RACE, BORE = 8e-6, 46e-3 - 9.525e-3, 30e-3


def test_the_preload_has_three_states():
    """Before mounting, mounted (fit), running (speed and growth besides): three equilibria, with one offset of the rows."""
    kinematics = {"spin_speed_rpm": 20000.0, "radial_expansion": 1e-6}
    tables = {"load": {"axial": 0.0}, "mounting": {"shaft_interference": TIGHT}, "kinematics": kinematics}
    bearing = {"arrangement": "DB", "preload": 300.0}
    found = rw.run(b7206c(bearing=bearing, **tables)).to_dict()["equilibrium"]["preload"]
    x, fit = approach(row(), 300.0), 0.5 * TIGHT * BORE / RACE
    assert found["before_mounting_n"] == 300.0
    assert found["mounted_n"] == pytest.approx(axial(row(growth=fit), x), rel=1e-6)
    assert found["running_n"] == pytest.approx(axial(row(20000.0, fit + 1e-6), x), rel=1e-6)
    assert 300.0 < found["mounted_n"] < found["running_n"]
    ground = rw.run(b7206c(bearing={**bearing, "preload_of": "row"}, **tables)).to_dict()["equilibrium"]["preload"]
    assert ground["before_mounting_n"] == pytest.approx(300.0, rel=1e-9)  # two equal rows share what each was ground for
    assert ground["mounted_n"] == pytest.approx(found["mounted_n"], rel=1e-9)
    warm = rw.run(b7206c(bearing=bearing, load={"axial": 0.0}, mounting={"inner_temperature": 10.0})).to_dict()[
        "equilibrium"
    ]
    assert warm["preload"]["mounted_n"] == 300.0 < warm["preload"]["running_n"]  # warm is running, not mounted


def test_a_held_displacement_has_the_same_three_states():
    tables = {"load": {"axial": 500.0}, "supports": {"axial": "displacement"}, "mounting": {"shaft_interference": TIGHT}}
    held = rw.run(b7206c(**tables, kinematics={"spin_speed_rpm": 20000.0})).to_dict()["equilibrium"]["held_axial"]
    x, fit = approach(row(), 500.0), 0.5 * TIGHT * BORE / RACE
    assert held["before_mounting_n"] == 500.0
    assert held["mounted_n"] == pytest.approx(axial(row(growth=fit), x), rel=1e-6)
    assert held["running_n"] == pytest.approx(axial(row(20000.0, fit), x), rel=1e-6)
    on_spring = b7206c(bearing={"arrangement": "DB", "preload": 300.0, "preload_kind": "spring"}, **tables)
    still = rw.run(on_spring).to_dict()["equilibrium"]
    assert still["held_axial"]["mounted_n"] == pytest.approx(still["held_axial"]["running_n"], rel=1e-8)
    assert still["preload"]["rows_n"][1] == pytest.approx(300.0, rel=1e-8)


def test_the_screen_names_the_three_states():
    found = rw.run(sprung("TBT", bearing={"second_preload": 600.0}, load={"axial": 0.0})).to_dict()
    text = " ".join(" ".join(row) for row in mounting_rows(found["equilibrium"]))
    assert "preload 600 N running; 300 and 600 N before, 600 mounted" in text


def test_the_travel_of_a_spring_counts_from_where_the_preload_sets_the_rows(built):
    """Not from where an oil film's first equilibrium has put them, which is nearly where its last one does."""
    film = {"kind": "film", "oil": "VG 32", "temperature_c": 40.0}
    tables = sprung(load={"axial": 0.0}, contact=film, kinematics={"spin_speed_rpm": 15000.0})
    model = built(**tables)
    slid = abs(model.system.table[-1, layout.SHIFT] - built(**sprung(load={"axial": 0.0})).system.table[-1, layout.SHIFT])
    tables["bearing"]["spring_travel"] = 1.01 * slid
    built(**tables)
    tables["bearing"]["spring_travel"] = 0.99 * slid
    with pytest.raises(ConvergenceError, match=r"from where the preload sets them before mounting"):
        built(**tables)
