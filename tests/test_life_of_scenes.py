"""Life as a quantity of scenes: of one point, of columns, of sets, along a motion; bad input."""

import json

import numpy as np
import pytest

import raceway as rw
from checks.validation.scenes import built_in
from raceway import SceneError
from raceway.core.quantities.ratings import at_places, equivalent_loads, life_factor, reliability_factor, system_life
from raceway.extend import layout, open_store
from raceway.points.dataset import write_csv
from raceway.scene.lubricant import Lubricant

Life = built_in("quantity", "life")

DGB7 = {"preset": "DGB7-MASTA", "tilt_arm": "pitch"}
CASE_5 = {"bearing": DGB7, "load": {"radial": [1000.0, 0.0], "axial": 1000.0}, "supports": {"tilt": "free"}}
#: Slow: the loads of case 5.
SLOW = {"kinematics": {"spin_speed_rpm": 1.0}}
B7206 = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "kinematics": {"spin_speed_rpm": 12000.0}}
NAMES = (
    "l10r_million_revolutions", "l10r_hours", "l10mr_million_revolutions", "l10mr_hours", "equivalent_load_n", "static_safety",
    "rating_n",
)  # fmt: skip


def life(tables, **life_options):
    quantities = {"quantities": {"life": life_options}} if life_options else {}
    return rw.run({**tables, **quantities}).to_dict()["life"]


def test_a_run_states_the_published_life():
    found = life({**CASE_5, **SLOW})
    assert found["l10r_million_revolutions"] == pytest.approx(1630.5367, rel=1e-4)
    assert found["l10r_hours"] == pytest.approx(1630.5367e6 / 60.0, rel=1e-4)
    assert found["equivalent_load_n"] == pytest.approx(23400.0 * 1630.5367 ** (-1 / 3), rel=1e-4)
    assert (found["rating_n"], found["rating_from"], found["rows"][0]["static_rating_from"]) == (
        23400.0, "catalogue", "geometry",
    )  # fmt: skip
    assert found["loads"] == "constant"


def test_without_a_speed_there_are_no_hours_and_without_a_viscosity_no_modified_life():
    found = life(CASE_5)
    assert found["l10r_hours"] is None and found["l10r_million_revolutions"] > 0.0
    assert found["l10mr_million_revolutions"] is found["l10mr_hours"] is None
    assert found["not_modified"] == "no oil: [lubricant] or quantities.life.viscosity_ratio"
    json.dumps(found, allow_nan=False)


def test_the_static_safety_is_that_of_the_largest_pressure():
    """(4200 MPa / p_max)^3 of steel where C0 is by the geometry.  The standard's steel has 207 GPa, this one 210, and p^3
    goes with E^2; grooves are curved as at the nominal angle, 0.4 % in load."""
    result = rw.run(CASE_5)
    pressure = result.to_dict()["equilibrium"]["largest_pressure_pa"]
    expected = (4200e6 / pressure) ** 3 * (210.0 / 207.0) ** 2
    assert result.quantities["static_safety"] == pytest.approx(expected, rel=6e-3)
    rated = [rw.run({**CASE_5, "bearing": {**DGB7, "static_rating": rating}}) for rating in (1e4, 2e4)]
    safety = [each.quantities["static_safety"] for each in rated]
    assert safety[1] == pytest.approx(2.0 * safety[0], rel=1e-12)


def test_the_modified_life_is_the_standards():
    found = life(B7206, viscosity_ratio=1.5, contamination=0.3, reliability=0.99)
    row = found["rows"][0]
    factor = life_factor(1.5, 0.3 * row["fatigue_load_limit_n"] / row["equivalent_load_n"])
    assert row["life_factor"] == pytest.approx(factor, rel=1e-12)
    expected = reliability_factor(0.99) * factor * found["l10r_million_revolutions"]
    assert found["l10mr_million_revolutions"] == pytest.approx(expected, rel=1e-12)
    assert found["l10mr_hours"] == pytest.approx(expected * 1e6 / (60.0 * 12000.0), rel=1e-12)
    assert found["not_modified"] == "" and found["contamination"] == 0.3
    remark = next(remark for name, _, remark in Life.rows(found) if name.startswith("modified"))
    assert remark.endswith(f"reached by 99 %; kappa 1.5, a_ISO {factor:.3g}, e_C 0.3")


OIL = {"oil": "VG 32", "temperature_c": 60.0}


def test_the_oil_gives_the_viscosity_ratio():
    """nu_1 of 46 mm at 12 000 r/min: 4500 / sqrt(12000 * 46) mm2/s."""
    found = life({**B7206, "lubricant": OIL})
    viscosity = Lubricant(**OIL).kinematic_viscosity
    ratio = found["rows"][0]["viscosity_ratio"]
    assert ratio == pytest.approx(viscosity / (1e-6 * 4500.0 / np.sqrt(12000.0 * 46.0)), rel=1e-12)
    assert found["l10mr_million_revolutions"] > found["l10r_million_revolutions"]
    # The oil of a film is the bearing's; a key goes before either.
    film = life({**B7206, "contact": {"kind": "film", **OIL}})
    assert film["rows"][0]["viscosity_ratio"] == ratio
    assert life({**B7206, "lubricant": OIL}, viscosity_ratio=0.2)["rows"][0]["viscosity_ratio"] == 0.2
    assert life({**CASE_5, "lubricant": OIL})["not_modified"].startswith("no speed")
    # At 1 r/min this oil parts no surfaces.
    slow = rw.run({**CASE_5, **SLOW, "lubricant": OIL})
    assert any("the viscosity ratio is" in text for text in slow.warnings)
    answers = rw.function({**B7206, "lubricant": OIL}, ["lubricant.temperature_c"], ["l10mr_hours"])([60.0, 90.0])
    assert answers["l10mr_hours"][0] == pytest.approx(found["l10mr_hours"], rel=1e-9)
    assert answers["l10mr_hours"][1] < answers["l10mr_hours"][0]


def test_rows_of_a_set_add_up():
    pair = {**B7206, "bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}}
    found, pulled = life(pair), life({**pair, "load": {"axial": -1000.0}})
    for each, worst in ((found, 0), (pulled, 1)):
        safeties = [row["static_safety"] for row in each["rows"]]
        assert each["static_safety"] == min(safeties) == safeties[worst]
    rings = [[ring["l10_million_revolutions"] for ring in row["rings"]] for row in found["rows"]]
    assert found["l10r_million_revolutions"] == pytest.approx(float(system_life(np.array(rings), axis=(0, 1))), rel=1e-12)
    assert found["rating_n"] == pytest.approx(2.0**0.7 * 23000.0, rel=1e-12)
    # The axial load takes from the preload of the second row.
    first, second = (row["l10r_million_revolutions"] for row in found["rows"])
    assert first < 0.3 * second


def test_columns_have_the_lives_of_runs():
    loads, moduli = np.array([300.0, 1000.0, 3000.0]), np.array([210e9, 208e9, 212e9])
    function = rw.function(B7206, ["load.axial", "bearing.rings.young"], NAMES)
    answers = function(loads, moduli)
    for k, (force, young) in enumerate(zip(loads, moduli, strict=True)):
        bearing = {"preset": "B7206C", "rings": {"young": young}}
        result = rw.run({**B7206, "bearing": bearing, "load": {"axial": force}})
        for name in NAMES:
            assert answers[name][k] == pytest.approx(result.quantities[name], rel=1e-9, nan_ok=True)


def test_keys_of_the_rating_and_of_the_life_are_columns():
    base = {
        **B7206,
        "bearing": {"preset": "B7206C", "dynamic_rating": 1e4},
        "quantities": {"life": {"viscosity_ratio": 1.0}},
    }
    keys = ["bearing.dynamic_rating", "quantities.life.viscosity_ratio", "quantities.life.reliability"]
    answers = rw.function(base, keys, NAMES)([23e3, 46e3, 23e3], [1.5, 1.5, 0.3], [0.9, 0.9, 0.99])
    lives = answers["l10r_million_revolutions"]
    np.testing.assert_allclose(lives / lives[0], [1.0, 8.0, 1.0], rtol=1e-12)
    third = life({**B7206, "bearing": {"preset": "B7206C", "dynamic_rating": 23e3}}, viscosity_ratio=0.3, reliability=0.99)
    assert answers["l10mr_hours"][2] == pytest.approx(third["l10mr_hours"], rel=1e-9)


def test_sweeps_and_bands_have_them():
    """P of one row goes with the axial load to a power near 1, its contact angle growing a little."""
    swept = rw.sweep(B7206, {"load.axial": [500.0, 1000.0]})["l10r_hours"].values
    assert swept[1] == pytest.approx(life(B7206)["l10r_hours"], rel=1e-9) and 5.0 < swept[0] / swept[1] < 8.0
    found = rw.band({**B7206, "tolerances": {"load.axial": "±10 %"}}, count=64)
    assert 1.05 < found.high["equivalent_load_n"] / found.nominal["equivalent_load_n"] < 1.1
    assert found.low["l10r_hours"] < found.nominal["l10r_hours"] < found.high["l10r_hours"]


@pytest.mark.parametrize("status", ["computed", "run"])
def test_rows_of_a_sweep_say_that_a_life_has_no_limit(tmp_path, status):
    """At a standstill it has no hours; of compiled loops and of runs, which contacts that rub need."""
    scene = B7206 if status == "computed" else {**B7206, "contact": {"friction": 0.05}}
    rw.sweep(scene, {"kinematics.spin_speed_rpm": [0.0, 6000.0]}, store=tmp_path / "s")
    with open_store(tmp_path / "s") as store:
        still, turning = store.rows()
        write_csv(store, tmp_path / "s.csv")
    assert "l10r_hours" not in still["values"] and still["reason"].endswith(": no limit") and "l10r_hours" in still["reason"]
    assert still["status"] == turning["status"] == status
    assert turning["values"]["l10r_hours"] > 0.0 and turning["reason"] == ""
    assert still["reason"] in (tmp_path / "s.csv").read_text()


ROTATING = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 6000.0, "amplitude": "constant", "force": 900.0},
}  # fmt: skip


def test_a_rotating_force_exchanges_the_exponents_of_the_rings():
    """Beside the axial load alone the motion is one pattern of loads that turns with the inner ring."""
    result = rw.run(ROTATING)
    found = result.to_dict()["life"]
    loads = result.simulation.record.contact_force[-1].reshape(2, 12)
    assert np.ptp(loads[0]) > 300.0 and found["loads"] == "over a turn of the motion"
    inner, outer = (ring["equivalent_load_n"] for ring in found["rows"][0]["rings"])
    assert inner == pytest.approx((loads[0] ** (10 / 3)).mean() ** 0.3, rel=2e-3)
    assert outer == pytest.approx((loads[1] ** 3).mean() ** (1 / 3), rel=2e-3)
    # The most loaded moment counts: C0 permits what a ball carries at rest times its safety there.
    still = rw.run({name: ROTATING[name] for name in ("bearing", "load")} | {"kinematics": {"spin_speed_rpm": 6000.0}})
    permitted = still.quantities["static_safety"] * still.equilibrium.contact_force[:12].max()
    assert found["static_safety"] == pytest.approx(permitted / loads[0].max(), rel=1e-3)
    standing = equivalent_loads(loads)
    assert abs(inner / standing[0] - 1.0) > 5e-3  # the exponents matter here


def test_a_turn_that_changes_nothing_has_the_static_life():
    tables = {**ROTATING, "excitation": {**ROTATING["excitation"], "force": 1e-3}}
    static = {"bearing": ROTATING["bearing"], "load": ROTATING["load"], "kinematics": {"spin_speed_rpm": 6000.0}}
    for name in ("l10r_million_revolutions", "static_safety"):
        assert rw.run(tables).quantities[name] == pytest.approx(rw.run(static).quantities[name], rel=1e-4)


def test_a_force_at_another_frequency_meets_all_points_of_the_inner_ring():
    result = rw.run({**ROTATING, "kinematics": {"spin_speed_rpm": 6500.0}})
    loads = result.simulation.record.contact_force[-1].reshape(2, 12)
    inner = result.to_dict()["life"]["rows"][0]["rings"][0]["equivalent_load_n"]
    assert inner == pytest.approx((loads[0] ** 3).mean() ** (1 / 3), rel=2e-3)


@pytest.mark.parametrize("radial", [0.0, 400.0])
def test_columns_have_the_lives_of_motions(radial):
    tables = {**ROTATING, "load": {"axial": 1000.0, "radial": [radial, 0.0]}}
    names = ["l10r_million_revolutions", "l10r_hours", "static_safety"]
    answers = rw.function(tables, ["load.axial", "excitation.speed_rpm"], names)([800.0, 1000.0], [5000.0, 6000.0])
    result = rw.run(tables)
    for name in names:
        assert answers[name][1] == pytest.approx(result.quantities[name], rel=1e-5)


def test_balls_that_orbit_pass_the_same_pattern(monkeypatch):
    """Its places are interpolated between balls: 2 % of the life.  They travel at the cage speed that the forces know."""
    travels, places = [], at_places
    monkeypatch.setattr(
        "raceway.plugins.quantities.life.at_places", lambda turn, travel: (travels.append(travel), places(turn, travel))[1]
    )
    orbiting = rw.run({**ROTATING, "kinematics": {"orbiting": True}})
    fixed = rw.run(ROTATING).quantities["l10r_million_revolutions"]
    assert orbiting.quantities["l10r_million_revolutions"] == pytest.approx(fixed, rel=0.03)
    moments = travels[0].shape[-1]
    pitches_per_s = orbiting.model.system.scalars[layout.CAGE] * 12 / (2.0 * np.pi)
    assert travels[0][0] == pytest.approx(pitches_per_s * 60.0 / 6000.0 * np.arange(moments) / moments, rel=1e-12)


@pytest.mark.parametrize(("key", "value", "words"), [
    ("contamination", 1.2, "from 0 to 1"), ("contamination", -0.1, "from 0 to 1"),
    ("reliability", 0.89, "from 0.9 to 0.9995"), ("reliability", 0.9999, "from 0.9 to 0.9995"),
    ("viscosity_ratio", 0.0, "greater than 0"),
])  # fmt: skip
def test_options_out_of_range_are_refused(key, value, words):
    with pytest.raises(SceneError, match=words) as caught:
        rw.scene_from_dict({**B7206, "quantities": {"life": {key: value}}})
    assert [mistake.path for mistake in caught.value.mistakes] == [f"quantities.life.{key}"]


def test_what_the_standard_does_not_hold_for_is_told():
    heavy = rw.run({**B7206, "load": {"axial": 20000.0}, "quantities": {"life": {"viscosity_ratio": 0.05}}})
    sentences = [text for text in heavy.warnings if text.startswith("life: ")]
    assert len(sentences) == 2 and "ISO 281 holds up to 0.5" in sentences[0] and "begins at 0.1" in sentences[1]
    assert heavy.to_dict()["life"]["l10mr_hours"] is None


def test_a_steep_bearing_without_a_rating_has_no_life_and_a_function_says_why():
    steep = {
        "ball_diameter": 0.0119, "pitch_diameter": 0.09, "ball_count": 20, "conformity_inner": 0.52, "conformity_outer": 0.52,
        "contact_angle_deg": 60.0,
    }  # fmt: skip
    tables = {"bearing": steep, "load": {"axial": 1000.0}}
    assert "life" not in rw.run(tables).to_dict()
    with pytest.raises(SceneError, match=r"bearing\.dynamic_rating is missing"):
        rw.function(tables, ["load.axial"], ["l10r_hours"])
    tables["bearing"] = {**steep, "dynamic_rating": 60e3}
    assert rw.run(tables).quantities["equivalent_load_n"] == pytest.approx(1000.0, rel=0.02)  # a thrust bearing
