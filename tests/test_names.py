"""One name, one meaning: kyy with the tilts held, kyy_tilts_follow with tilts that follow; the largest load is that of both races."""

import json
from typing import Any

import numpy as np
import pytest
import xarray
from scipy.signal import resample

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.stores import as_list
from raceway.extend import open_store, select
from raceway.points.dataset import write_netcdf

FREE: dict[str, Any] = {
    "title": "names", "bearing": {"preset": "B7206C"}, "load": {"axial": 400.0, "radial": [60.0, 0.0]}, "supports": {"tilt": "free"},
    "kinematics": {"spin_speed_rpm": 12000.0}, "tolerances": {"load": {"axial": "±1 %"}},
}  # fmt: skip
#: At spindle speed the balls' centrifugal force is the outer race's.
FAST: dict[str, Any] = {
    "title": "fast", "bearing": {"preset": "B7206C"}, "load": {"axial": 100.0},
    "kinematics": {"spin_speed_rpm": 30000.0, "gyroscopic": "none", "ring_growth": False},
}  # fmt: skip
EXCITED = {"kind": "bidirectional", "speed_rpm": 3000.0, "unbalance": 1e-5}
#: What every study must call by these names.
NAMES = ("kxx", "kyy", "kyy_tilts_follow", "x", "largest_ball_load")


@pytest.fixture(scope="module")
def free():
    return rw.run(FREE)


@pytest.fixture(scope="module")
def fast():
    return rw.run(FAST)


def meant(result: rw.Result) -> dict[str, float]:
    """The numbers by their definitions, from displacement, 5x5 matrix and contact forces alone."""
    k = result.stiffness
    follow = np.linalg.inv(np.linalg.inv(k[np.ix_([1, 3, 4], [1, 3, 4])])[:1, :1])  # inverse of the compliance to a force
    loads = result.equilibrium.contact_force
    return dict(zip(NAMES, (k[0, 0], k[1, 1], float(follow[0, 0]), result.displacement[0], loads.max()), strict=True))


def test_every_study_gives_one_name_one_number(free):
    expected = meant(free) | free.quantities
    assert expected["kyy"] > 5.0 * expected["kyy_tilts_follow"], "two numbers that nobody should take for each other"
    content = free.to_dict()
    told = {
        "tolerances": {name: one["value"] for name, one in content["tolerances"]["quantities"].items()},
        "sensitivities": rw.sensitivities(FREE, ["load.axial"]).values,
        "band": rw.band(FREE, count=2).nominal,
        "result": {
            "kyy": content["equilibrium"]["stiffness"][1][1],
            "kyy_tilts_follow": content["equilibrium"]["kyy_tilts_follow_n_per_m"],
            "largest_ball_load": content["equilibrium"]["largest_ball_load_n"],
        },
        "sweep": {"kyy_tilts_follow": float(rw.sweep(FREE, {"load.axial": [400.0]})["kyy_tilts_follow"].values[0])},
    }
    for where, values in told.items():
        for name, value in values.items():
            assert value == pytest.approx(expected[name], rel=1e-12), (where, name)
    assert {*NAMES} <= set(told["sensitivities"]) <= set(told["tolerances"]) <= set(told["band"])
    assert "l10r_million_revolutions" in told["band"]


def test_with_locked_tilts_there_is_no_kyy_whose_tilts_follow():
    found = rw.sensitivities({**FREE, "supports": {"tilt": "locked"}}, ["load.axial"])
    assert "kyy_tilts_follow" not in found.values and "kyy_tilts_follow" not in found["load.axial"].derivatives


@pytest.mark.parametrize(
    "tilt, key, step", [("free", "load.axial", 0.04), (2e3, "load.axial", 0.04), (2e3, "supports.tilt", 0.2)]
)
def test_derivatives_by_name_are_those_of_whole_runs(tilt, key, step):
    """Central differences of equilibria: their error falls with the square of the step, 1e-4 of the number: 1e-8."""
    scene = {**FREE, "supports": {"tilt": tilt}}
    found = rw.sensitivities(scene, [key])[key].derivatives
    ends = []
    for sign in (-1.0, 1.0):
        table, _, name = key.partition(".")
        moved = rw.run({**scene, table: {**scene[table], name: scene[table][name] + sign * step}})
        k, shaft = moved.stiffness, moved.model.scene.supports.tilt
        k = k + np.diag([0.0, 0.0, 0.0, *(2 * [0.0 if shaft == "free" else shaft])])
        ends.append({"kyy": k[1, 1], "kyy_tilts_follow": 1.0 / np.linalg.inv(k[np.ix_([1, 3, 4], [1, 3, 4])])[0, 0],
                     "largest_ball_load": moved.equilibrium.contact_force.max()})  # fmt: skip
    for name in ends[0]:
        quotient = (ends[1][name] - ends[0][name]) / (2.0 * step)
        assert found[name] == pytest.approx(quotient, rel=2e-5, abs=1e-12 * abs(ends[0][name])), name


def test_screen_and_result_agree_and_a_fit_takes_both_names(tmp_path, free):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[bearing]\npreset = "B7206C"\n[load]\naxial = 400.0\nradial = [60.0, 0.0]\n[supports]\ntilt = "free"\n'
        "[kinematics]\nspin_speed_rpm = 12000.0\n[tolerances]\nload.axial = '±1 %'\n"
    )
    text = " ".join(invoke("run", scene, "--out", tmp_path).stdout.split())
    expected = meant(free)
    assert f"tangent kyy {1e-6 * expected['kyy']:.3g} N/µm" in text and "Answer at 12000 r/min, tilt free" in text
    assert f"kyy tilts follow {1e-6 * expected['kyy_tilts_follow']:.3g} N/µm" in text
    below = text[text.index("Tolerances") :]
    for name in ("kyy", "kyy_tilts_follow"):
        low, high = below.split(f" {name.replace('_', ' ')} ")[1].split(" N/µm")[0].split(" to ")
        assert float(low) < 1e-6 * expected[name] < float(high)


def test_a_fit_of_the_printed_numbers_gives_the_scene_back(free):
    """Data of a run at the scene's own angle, fitted from another one: the angle returns."""
    value = {name: number for name, number in meant(free).items() if name != "kxx"}
    heads = {"kyy": "kyy [N/m]", "kyy_tilts_follow": "kyy tilts follow [N/m]", "x": "x [m]"}
    heads["largest_ball_load"] = "largest_ball_load [N]"
    data = {heads[name]: [number, number] for name, number in value.items()}
    start = {
        **{k: v for k, v in FREE.items() if k != "tolerances"},
        "bearing": {"preset": "B7206C", "contact_angle_deg": 16.0},
    }
    found = rw.fit(data, start, ["bearing.contact_angle_deg"])
    assert found["bearing.contact_angle_deg"] == pytest.approx(15.0, rel=1e-6)
    assert any("kyy is taken as radial, tilts and other motions held" in text for text in found.warnings)
    assert any("largest_ball_load" in text and "outer race" in text for text in found.warnings)


def test_a_fit_with_locked_tilts_refuses_the_name_of_tilts_that_follow():
    scene = {**FREE, "supports": {"tilt": "locked"}}
    with pytest.raises(rw.SceneError, match="kyy_tilts_follow needs free or sprung tilts, and supports.tilt = 'locked'"):
        rw.fit({"kyy_tilts_follow [N/um]": [16.0, 16.1]}, scene, ["bearing.contact_angle_deg"])


def test_exported_coefficients_are_called_by_how_the_tilts_are():
    scene = {key: FREE[key] for key in ("bearing", "load", "supports")} | {"title": "export"}
    swept = rw.sweep(scene, {"kinematics.spin_speed_rpm": "0:12000:5"})
    table = rw.export_ross(swept)
    assert set(table.to_xarray().data_vars) >= {"kyy_tilts_follow", "kxx_tilts_follow"} and "kyy" not in table.to_xarray()
    assert table.names["kyy_tilts_follow"] == "kxx" and len(table.content["kxx"]) == 5
    text = rw.export_coefficients(swept, kind="csv").text
    assert "kyy_tilts_follow [N/m]" in text and ",kyy [N/m]" not in text and "K y y [N/m]" in text
    assert any("kyy_tilts_follow, with them free" in note for note in table.notes)
    locked = rw.export_ross(rw.sweep({**scene, "supports": {"tilt": "locked"}}, {"kinematics.spin_speed_rpm": "0:12000:5"}))
    assert "kyy" in locked.to_xarray() and "kyy_tilts_follow" not in locked.to_xarray()


def test_the_largest_load_and_pressure_are_those_of_both_races_with_their_race(fast, tmp_path):
    """B7206C, 100 N, 30 000 r/min: 20.7 N and 643 MPa on the inner race, 147.6 N and 1030 MPa on the outer one."""
    inner, outer = fast.equilibrium.contact_force.reshape(2, -1).max(axis=1)
    assert inner == pytest.approx(20.7, abs=0.05) and outer == pytest.approx(147.6, abs=0.05)
    table = fast.to_dict()["equilibrium"]
    assert (table["largest_ball_load_n"], table["largest_ball_load_race"]) == (outer, "outer")
    assert 1e-6 * table["largest_pressure_pa"] == pytest.approx(1030.0, abs=0.5)
    assert table["largest_pressure_race"] == "outer"
    assert (table["largest_ball_load_inner_n"], table["largest_ball_load_outer_n"]) == (inner, outer)
    data = rw.sweep(FAST, {"load.axial": [100.0]}).isel({"load.axial": 0})
    assert float(data.peak_ball_load) == float(data.peak_ball_load_outer) == pytest.approx(outer, rel=1e-9)
    assert float(data.peak_ball_load_inner) == pytest.approx(inner, rel=1e-9)
    assert float(data.p0) == float(data.p0_outer) == pytest.approx(table["largest_pressure_pa"], rel=1e-9)
    assert float(data.p0_outer) > float(data.p0_inner)
    assert "147.58 N" in repr(fast) and "outer race, static" in repr(fast)
    assert (
        rw.sensitivities(FAST, ["load.axial"]).definitions["largest_ball_load"] == "static, outer race; the larger of both"
    )


def test_load_and_pressure_may_be_largest_on_different_races(free):
    """At 12 000 r/min the outer race carries more, and the inner one, whose ellipse is smaller, has the larger pressure."""
    table = free.to_dict()["equilibrium"]
    assert (table["largest_ball_load_race"], table["largest_pressure_race"]) == ("outer", "inner")
    balls = table["balls"]
    assert table["largest_pressure_pa"] == max(ball["peak_pressure_inner_pa"] for ball in balls)


def test_equal_loads_are_those_of_both_races():
    still = rw.run({**FAST, "kinematics": {}}).to_dict()["equilibrium"]
    assert still["largest_ball_load_race"] == "both"


def test_the_motions_peaks_are_those_of_both_races():
    found = rw.run({**FAST, "excitation": {**EXCITED, "phase_lag_deg": 0.4}, "integrator": {"kind": "periodic"}})
    motion, loads = found.to_dict()["motion"], found.simulation.record.contact_force
    z = loads.shape[1] // 2
    assert motion["peak_ball_load_race"] == "outer" and motion["peak_ball_load_n"] == motion["peak_ball_load_outer_n"]
    # The force is largest 0.4 of a step after a sample, which misses the peak by 2e-7 and 3e-8 of it; a parabola by 4e-11.
    for name, part in (("inner", loads[:, :z]), ("outer", loads[:, z:])):
        assert motion[f"peak_ball_load_{name}_n"] == pytest.approx(resample(part, 64 * len(part)).max(), rel=1e-9)
    assert motion["peak_pressure_pa"] == max(motion["peak_pressure_inner_pa"], motion["peak_pressure_outer_pa"])


def test_a_boolean_axis_stays_boolean(tmp_path):
    axes = {"kinematics.ball_inertia": [False, True], "load.axial": [100.0, 200.0]}
    data = rw.sweep(FAST, axes, store=tmp_path / "swept")
    assert data["kinematics.ball_inertia"].dtype == bool
    heavy = data.sel({"kinematics.ball_inertia": True})
    assert (heavy.peak_ball_load.values > data.sel({"kinematics.ball_inertia": False}).peak_ball_load.values).all()
    assert select(data, {"kinematics.ball_inertia": True}).fixed == {"kinematics.ball_inertia": True}
    # A list of booleans would be a mask in xarray's sel: no point may fall away.
    assert [select(each, {}).dataset.sizes["kinematics.ball_inertia"] for each in (data, as_list(data))] == [2, 2]
    with open_store(tmp_path / "swept") as store:
        kept = xarray.load_dataset(write_netcdf(store), engine="h5netcdf")
    assert kept["kinematics.ball_inertia"].dtype == bool and kept["kinematics.ball_inertia"].values.tolist() == [False, True]
    compared = rw.compare({**FAST, "excitation": EXCITED}, {"kinematics.ball_inertia": [False, True]})
    assert compared.to_xarray()["kinematics.ball_inertia"].dtype == bool


def test_labels_of_axes_are_short_names(tmp_path):
    data = rw.sweep(FAST, {"load.axial": [100.0, 200.0]})
    assert data["load.axial"].attrs["long_name"] == "load.axial"
    assert "preloads the bearing" in data["load.axial"].attrs["description"]
    pytest.importorskip("matplotlib")
    import matplotlib

    matplotlib.use("Agg")
    (line,) = data.peak_ball_load.plot()
    assert (line.axes.get_xlabel(), line.axes.get_ylabel()) == ("load.axial [N]", "peak ball load [N]")
    line.axes.figure.clear()
    assert json.dumps(data.peak_ball_load.attrs["description"]) == '"largest load of a ball, of both races"'
