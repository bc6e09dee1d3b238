"""Scenes with [heat]: their steady temperatures, limits, runaway, and the same in runs and functions."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

import raceway as rw
from checks.validation.scenes import built_in
from raceway.extend import open_store
from tests.core.validation import warm as published

Temperatures = built_in("quantity", "heat")


@cache
def usual():
    """The answer of the pair as it is."""
    return rw.run(published.warm_pair())


def test_infinite_conductances_give_the_isothermal_bearing():
    assert published.isothermal_difference() < 1e-9


def test_energy_is_balanced_and_temperatures_are_those_computed_with():
    assert published.energy_imbalance() < 1e-9
    result = usual()
    heat = result.to_dict()["heat"]
    mounting = result.model.problem.mounting
    for node, key in (("inner", "inner"), ("outer", "outer"), ("balls", "ball")):
        assert_allclose(getattr(mounting, f"{key}_temperature"), heat["temperatures_k"][node] - 293.15, atol=1e-5)
    level = heat["temperatures_k"]
    surfaces = 0.25 * (level["inner"] + 2.0 * level["balls"] + level["outer"])
    assert_allclose(result.model.problem.lubricant.temperature_c, surfaces - 273.15, atol=1e-5)


def test_at_rest_hot_surroundings_are_told():
    scene = published.warm_pair({"ambient_c": 500.0})
    del scene["kinematics"]
    with pytest.raises(rw.ConvergenceError, match="oil and surroundings give it at rest.*heat.ambient_c"):
        rw.run(scene)


def test_rollers_without_friction_have_no_heat():
    scene = rw.load_scene("examples/cylindrical_rollers.toml").to_dict()
    more = {"lubricant": {"oil": "VG 46"}, "heat": {"oil_inlet_c": 40.0, "oil_flow": 8e-6}}
    scene["bearing"]["outer_diameter"] = 0.062
    assert "friction of rollers" in str(rw.check({**scene, **more}).mistakes)


def test_seals_heat_both_rings():
    """In halves; what leaves each ring is half of its contacts' heat and half of the seals'."""
    result = rw.run(published.warm_pair(quantities={"friction": {"seal_torque": 0.1}})).to_dict()
    links, lost = result["heat"]["links_w"], result["friction"]["heat_w"]
    assert lost["seals"] > 0.5 * lost["inner"]
    for ring, seat in (("inner", "inner_shaft"), ("outer", "outer_housing")):
        leaving = links[f"{ring}_balls"] + links[f"{ring}_oil"] + links[seat]
        assert_allclose(leaving, 0.5 * (lost[ring] + lost["seals"]), rtol=1e-9)


def test_at_rest_there_is_no_heat():
    heat = rw.run(published.warm_pair({"ambient_c": 40.0}, kinematics={"spin_speed_rpm": 0.0})).to_dict()["heat"]
    assert heat["heat_w"] == published.heat_at_rest() == 0.0
    assert_allclose(list(heat["temperatures_k"].values()), 313.15, rtol=1e-12)


def test_functions_and_sweeps_are_what_runs_give():
    names = [
        "temperature_inner_k", "temperature_oil_k", "heat_w", "heat_to_housing_w", "torque_nm", "l10r_hours",
        "kyy_tilts_follow",
    ]  # fmt: skip
    scene, speeds = published.warm_pair(supports={"tilt": "free"}), np.array([2000.0, 20_000.0])
    columns = rw.function(scene, ["kinematics.spin_speed_rpm"], names)(speeds)
    swept = rw.sweep(scene, {"kinematics.spin_speed_rpm": speeds})
    assert (columns["status"] == rw.PointStatus.COMPUTED).all() and (swept["status"] == "computed").all()
    for k, speed in enumerate(speeds):
        result = rw.run(published.warm_pair(supports={"tilt": "free"}, kinematics={"spin_speed_rpm": float(speed)}))
        stated = result.quantities | {"kyy_tilts_follow": result.to_dict()["equilibrium"]["kyy_tilts_follow_n_per_m"]}
        for name in names:
            assert_allclose([columns[name][k], swept[name].values[k]], stated[name], rtol=1e-9)


def test_bands_move_with_the_temperatures():
    """To first order by derivatives in which temperatures follow, and by samples; a key that is no column has none."""
    numbers, tolerances = ("temperature_inner_k", "torque_nm", "l10r_hours", "kyy"), {"heat.oil_flow": "+-3 %"}
    sampled = rw.band(published.warm_pair(), tolerances, count=64)
    first = rw.run(published.warm_pair(tolerances={**tolerances, "bearing.width": "+-1 %"})).to_dict()["tolerances"]
    assert [left_out["key"] for left_out in first["left_out"]] == ["bearing.width"] and sampled.lost == 0
    for name in numbers:
        low, high = sampled.low[name], sampled.high[name]
        assert low < sampled.nominal[name] < high
        assert_allclose([first["quantities"][name][end] for end in ("low", "high")], [low, high], atol=0.1 * (high - low))


def test_more_oil_and_less_speed_are_colder():
    scene, names = published.warm_pair({"ambient_c": 40.0}), ["temperature_inner_k", "temperature_oil_k"]
    f = rw.function(scene, ["heat.oil_flow", "kinematics.spin_speed_rpm"], names)
    flow, speed = np.meshgrid([2e-6, 8e-6, 32e-6], [4000.0, 10_000.0, 16_000.0])
    for level in (f(flow, speed)[name] for name in f.outputs):
        assert (np.diff(level, axis=1) < 0.0).all() and (np.diff(level, axis=0) > 0.0).all()
    flooded = rw.run(published.warm_pair({"oil_flow": 4e-5}))  # jets were measured from n d_m = 1.3 million on
    assert any("n d_m = 0.55 is outside 1.3 to 3.35 million" in words for words in flooded.warnings)


def test_the_band_holds_the_answer():
    table = usual().to_dict()["heat"]
    for node, kelvin in table["temperatures_k"].items():
        low, high = table["band"]["temperatures_k"][node]
        assert low < kelvin < high
    low, high = table["band"]["inner_less_outer_k"]
    assert low < table["temperatures_k"]["inner"] - table["temperatures_k"]["outer"] < high
    bands = dict.fromkeys(("rolling_band", "elastic_band", "traction_band", "drag_band"), 0.0) | {"measured_band": 1.0}
    narrow = rw.run(published.warm_pair({"conductance_band": 0.0}, quantities={"friction": bands})).to_dict()
    rows = {name: (value, remark) for name, value, remark in Temperatures.rows(table)}
    assert rows["running preload"][0].endswith(" N") and rows["running preload"][1] == "within the bands"
    for name in ("kxx", "kyy"):
        low, high = (1e-6 * end for end in table["band"][f"{name}_n_per_m"])
        assert rows[name][0] == f"{low:.4g} to {high:.4g} N/µm"
    assert_allclose(table["band"]["conductances"], [1.0 / 1.5, 1.5])  # heat.conductance_band is 0.5
    assert_allclose(narrow["heat"]["band"]["running_preload_n"], narrow["equilibrium"]["preload"]["running_n"], rtol=1e-6)


@pytest.mark.parametrize(("heat", "lubricant", "words"), [
    ({"oil_inlet_c": 25.0}, {"viscosity": 0.02}, "does not fall with temperature"),
    (
        {"oil_inlet_c": 5.0, "ambient_c": -40.0},
        {"oil": "VG 32"},
        "surroundings are too cold (heat.oil_inlet_c, heat.ambient_c)",
    ),
])  # fmt: skip
def test_oil_beyond_its_data_is_told_with_the_cause(heat, lubricant, words):
    scene = published.warm_pair(heat, kinematics={"spin_speed_rpm": 100.0}) | {"lubricant": lubricant}
    assert any(words in warning for warning in rw.run(scene).warnings)


def test_stiffness_and_life_have_the_band_of_the_heat():
    """Of a 7014C pair, whose upper end runs away: its stiffness may be any above, its life any below."""
    tables = {"bearing": {"preset": "7014C"}, "kinematics": {"spin_speed_rpm": 9000.0}}
    for scene, runs_away in ((published.warm_pair(), False), (published.warm_pair(**tables), True)):
        document = rw.run(scene).to_dict()
        band, equilibrium = document["heat"]["band"], document["equilibrium"]
        at = {"heat_w": document["heat"]["heat_w"], "kyy_n_per_m": equilibrium["stiffness"][1][1]}
        at["l10r_hours"] = document["life"]["l10r_hours"]
        for name, value in at.items():
            low, high = band[name]
            lost = high if name != "l10r_hours" else low
            assert (lost is None) == runs_away
            assert (low is None or low < value) and (high is None or value < high)


def test_tolerances_without_derivatives_have_no_interval():
    band = rw.run(published.warm_pair(bearing={"preload_kind": "spring"}, tolerances={"bearing.width": "+-1 %"})).to_dict()[
        "tolerances"
    ]
    assert band["quantities"] == {} and "every tolerance is left out" in band["why"]


@pytest.mark.parametrize("kind", ["rigid", pytest.param("spring", marks=pytest.mark.slow)])
def test_runaway_advises_by_the_preload(kind):
    """Of a pair whose heat can not leave; a sprung one is not told to take springs."""
    closed = dict.fromkeys(("shaft_ambient", "housing_ambient"), 1e-9) | {"oil_flow": 1e-14}
    with pytest.raises(
        rw.ConvergenceError, match="the friction heat exceeds the heat removed|steady temperatures exceed 400 °C"
    ) as failure:
        rw.run(published.warm_pair(closed, bearing={"preload_kind": kind}))
    assert ("use a spring" in str(failure.value)) == (kind == "rigid")


@pytest.mark.slow
def test_a_fold_and_the_hottest_temperature_are_told_apart():
    """Hardly cooled rings on a spring reach 400 °C by and by; a rigid pair loses its steady state long before."""
    poor = dict.fromkeys(("housing_ambient", "shaft_ambient"), 0.2) | {"oil_flow": "0.1 cm3/min"}
    poor |= dict.fromkeys(("inner_oil", "outer_oil", "balls_oil"), 0.05)
    spring = {"preset": "7014C", "preload_kind": "spring"}
    hot = published.warm_pair(poor, bearing=spring, kinematics={"spin_speed_rpm": 20_000.0})
    for scene, words in ((published.runaway_pair(300.0), "a fold"), (hot, "exceed 400 °C")):
        with pytest.raises(rw.ConvergenceError, match=words):
            rw.run(scene)


def test_a_temperature_beside_heat_has_no_effect_and_says_so():
    given, plain = rw.run(published.warm_pair(lubricant={"temperature_c": 80.0})), usual()
    assert given.stiffness.tolist() == plain.stiffness.tolist()
    assert any("`lubricant.temperature_c` has no effect: [heat] computes it" in text for text in given.warnings)
    assert not any("has no effect" in text for text in plain.warnings)
    assert [one.path for one in rw.check(published.warm_pair({"oil_inlet_c": 150.0})).mistakes] == ["heat.oil_inlet_c"]


def test_points_warn_of_oil_beyond_its_data_as_runs_do(tmp_path):
    speeds = [10_000.0, 100.0]
    scene = published.warm_pair({"oil_inlet_c": 5.0, "ambient_c": -40.0})
    run = rw.run({**scene, "kinematics": {"spin_speed_rpm": speeds[1]}})
    key = "kinematics.spin_speed_rpm"
    within, beyond = rw.function(scene, [key], ["kyy"])(speeds)["reason"]
    assert within == "" and beyond in run.warnings
    rw.sweep(scene, {key: speeds}, store=tmp_path / "s")
    with open_store(tmp_path / "s") as store:
        assert [(row["status"], row["reason"], row["warnings"]) for row in store.rows()] == [
            ("computed", "", []), ("computed", "", [beyond]),
        ]  # fmt: skip


def test_a_motion_says_that_the_heat_gives_its_k_no_band():
    moving = {"excitation": {"kind": "bidirectional", "speed_rpm": 12_000.0, "unbalance": 1e-4}, "load": {"axial": 500.0}}
    still = published.warm_pair(bearing={"arrangement": "single", "preload": 0.0}, **moving)
    assert "at one set of temperatures" in rw.run(still).to_dict()["heat"]["band"]["not_computed"]
    assert "not_computed" not in usual().to_dict()["heat"]["band"]


@pytest.mark.slow
def test_oil_by_the_flow_warns_beyond_the_speeds_of_its_measurements():
    for rpm, warned in ((20_000.0, True), (30_000.0, False)):
        turning = {"bearing": {"preload_kind": "spring"}, "kinematics": {"spin_speed_rpm": rpm}}
        run = rw.run(published.warm_pair({"oil_flow": 3e-5}, **turning))
        assert any("Parker 1984" in text for text in run.warnings) == warned


def test_an_inner_ring_that_oil_wets_is_colder():
    """Between the balls of a B7206C are 1 - 12 9.525 / (46 pi) = 0.2091 of the pitch circle."""
    gaps, all_over = (rw.run(published.warm_pair({"inner_wetting": share})).to_dict()["heat"] for share in ("auto", 1.0))
    same = rw.run(published.warm_pair({"inner_wetting": 1.0 - 12.0 * 9.525 / (46.0 * np.pi)})).to_dict()["heat"]
    assert same["temperatures_k"] == pytest.approx(gaps["temperatures_k"], rel=1e-9)
    assert all_over["temperatures_k"]["inner"] < gaps["temperatures_k"]["inner"] - 2.0


def test_a_spring_keeps_its_preload_and_is_colder():
    rigid, sprung = (rw.run(published.warm_pair(bearing={"preload_kind": kind})).to_dict() for kind in ("rigid", "spring"))
    assert rigid["equilibrium"]["preload"]["running_n"] > 1.2 * 300.0
    assert_allclose(sprung["equilibrium"]["preload"]["running_n"], 300.0, rtol=1e-6)
    assert sprung["heat"]["temperatures_k"]["inner"] < rigid["heat"]["temperatures_k"]["inner"]


@pytest.mark.parametrize(("heat", "key", "words"), [
    ({"oil_flow": 0.0}, "heat.oil_flow", "greater than 1e-18"),
    ({"oil_flow": "-1 m3/s"}, "heat.oil_flow", "greater than 1e-18"),
    ({"inner_oil": 0.0}, "heat.inner_oil", "greater than 1e-12"),
    ({"inner_oil": 1e300}, "heat.inner_oil", "less than 100000, or 'auto', 'infinite'"),
    ({"inner_wetting": 0.0}, "heat.inner_wetting", "from 0.001 to 1"),
    ({"housing_ambient": -1.0}, "heat.housing_ambient", "greater than 1e-12"),
    ({"inner_oil": "endless"}, "heat.inner_oil", "'infinite'"),
])  # fmt: skip
def test_impossible_numbers_are_refused(heat, key, words):
    with pytest.raises(rw.SceneError, match=words) as fault:
        rw.run(published.warm_pair(heat))
    assert [mistake.path for mistake in fault.value.mistakes] == [key]


@pytest.mark.parametrize(
    ("tables", "key"),
    [({"mounting": {"inner_temperature": 20.0}}, "mounting.inner_temperature"), ({"lubricant": None}, "heat")],
)
def test_what_contradicts_or_lacks_is_named(tables, key):
    scene = published.warm_pair()
    for name, table in tables.items():
        scene[name] = table
    with pytest.raises(rw.SceneError) as fault:
        rw.run({name: table for name, table in scene.items() if table is not None})
    assert key in [mistake.path for mistake in fault.value.mistakes]


def test_temperatures_are_no_inputs_and_models_want_them():
    with pytest.raises(rw.SceneError, match="computed by"):
        rw.function(published.warm_pair(), ["mounting.inner_temperature"], ["kyy"])
    with pytest.raises(rw.SceneError, match="mounting"):
        rw.build_model(rw.Scene.from_dict(published.warm_pair()))


@pytest.mark.slow
@pytest.mark.parametrize("preload", [100.0, 500.0])
def test_a_rigid_pair_runs_away_where_a_hand_calculation_says(preload):
    """Within 2 %: the hand takes the contact angle, and the part of the heat at either race, as constants."""
    rpm = published.runaway_speed(preload)
    assert_allclose(rpm, published.runaway_by_hand(preload), rtol=0.02)
    columns = rw.function(published.runaway_pair(preload), ["kinematics.spin_speed_rpm"], ["kyy"])([0.9 * rpm, 1.1 * rpm])
    assert columns["status"].tolist() == [rw.PointStatus.COMPUTED, rw.PointStatus.FAILED]
    assert "no steady temperature" in columns["reason"][1]


def test_a_bearing_that_its_own_heat_closes_is_an_answer():
    """A pair of 7014C in steel at 16 000 r/min: the grooves leave its balls no room."""
    scene = published.warm_pair(
        {"oil_inlet_c": 25.0, "oil_flow": "300 cm3/min"}, bearing={"preset": "7014C"},
        kinematics={"spin_speed_rpm": 16_000.0, "ring_growth": True}, mounting={"shaft_interference": 5e-6},
    )  # fmt: skip
    with pytest.raises(
        rw.ConvergenceError, match="the bearing cannot run at its steady temperatures, inner at .* close the bearing"
    ) as fault:
        rw.run(scene)
    assert "mounting." not in str(fault.value) and "heat.oil_flow" in str(fault.value)


#: A third of the table, of each bearing some.
@pytest.mark.parametrize(
    ("bore", "rpm", "flow", "watt"),
    [pytest.param(*row, marks=[pytest.mark.slow] * (k % 3 > 0)) for k, row in enumerate(published.HEATS)],
)
def test_measured_heat_is_within_the_band_and_the_factors_that_it_stands_on(bore, rpm, flow, watt):
    """Factors have two decimals."""
    _, low, high = published.heat_and_band(bore, rpm, flow)
    assert low < watt < high
    least, most = published.heat_by_factors(bore, rpm, flow)
    assert least < 1.01 * watt and most > 0.99 * watt


def test_each_measured_bearing_is_within_the_band_of_the_others():
    assert published.outside_the_others() == []


@pytest.mark.parametrize(("rpm", "inner", "outer"), [(rpm, inner, outer) for rpm, _, inner, outer in published.MEASURED])
def test_rings_of_the_measured_bearing_are_within_20_kelvin_and_differ_within_the_band(rpm, inner, outer):
    level, (low, high) = published.rings_and_band(rpm)
    assert low < inner - outer < high
    assert abs(level["inner"] - inner) < 20.0 and abs(level["outer"] - outer) < 10.0


def test_rings_of_the_measured_bearing_in_cold_surroundings():
    scene, names = published.jet_bearing(35, 72e3, 760.0, 20.0), ["temperature_inner_k", "temperature_outer_k"]
    f = rw.function(scene, ["kinematics.spin_speed_rpm"], names)
    level = f([rpm for rpm, *_ in published.MEASURED])
    differences = level["temperature_inner_k"] - level["temperature_outer_k"]
    assert differences[0] > 0.0 and (np.diff(differences) > 0.0).all()
    assert (abs(differences[1:] / [18.0, 23.0, 25.0] - 1.0) < 0.3).all()
