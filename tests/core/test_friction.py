"""Friction torque as results, functions and screens state it; Palmgren's rule by hand; warnings and mistakes."""

import numpy as np
import pytest

import raceway as rw
from checks.validation.scenes import built_in
from raceway import RacewayError
from raceway.core.quantities.rolling_friction import measured_factors
from raceway.testing import run

Friction, Sliding = built_in("quantity", "friction"), built_in("quantity", "sliding")

OIL = {"oil": "VG 32", "temperature_c": 60.0}
TABLES = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0, "radial": [200.0, 0.0]},
    "kinematics": {"spin_speed_rpm": 6000.0, "gyroscopic": "none", "ring_growth": False}, "lubricant": OIL,
}  # fmt: skip


def scene(**tables):
    return rw.Scene.from_dict({name: table for name, table in {**TABLES, **tables}.items() if table is not None})


def friction(**tables):
    result = run(scene(**tables))
    return result.to_dict()["friction"], result.warnings


def palmgren(**tables):
    return friction(**tables)[0]["palmgren_nm"]


def test_parts_rows_and_places_sum_up():
    table, _ = friction(quantities={"friction": {"seal_torque": 0.02, "cage_torque": 0.01, "measured_band": 1.0}})
    speed = 6000.0 * np.pi / 30.0
    assert set(table["parts"]) == {"rolling", "elastic_rolling", "sliding", "drag", "seals"}
    assert min(table["parts"].values()) > 0.0
    assert sum(table["parts"].values()) == pytest.approx(table["torque_nm"], rel=1e-12)
    assert table["power_w"] == pytest.approx(speed * table["torque_nm"], rel=1e-12)
    assert sum(table["heat_w"].values()) == pytest.approx(table["power_w"], rel=1e-12)
    assert table["parts"]["seals"] == pytest.approx(0.03)
    assert table["rows"][0]["torque_nm"] == pytest.approx(table["torque_nm"] - 0.03)
    bands = {"rolling": 0.4, "elastic_rolling": 0.5, "sliding": 0.3, "drag": 0.7}
    spread = np.sqrt(sum((band * table["parts"][name]) ** 2 for name, band in bands.items()))
    assert table["band"]["high"] - table["torque_nm"] == pytest.approx(spread, rel=1e-12)
    # Palmgren's rule of an oil bath: 13.1 mPa s are 15.0 mm2/s, 1e-7 3.3 (15.0 6000)^(2/3) 46^3 N mm; 4.7e-4 0.9 1000 / tan(15 deg) 46.
    nu = table["viscosity_pa_s"] / 870.0 * 1e6
    load = 4.7e-4 * (0.9 * 1000.0 / np.tan(np.radians(15.0)) - 0.1 * 200.0) * 46.0
    assert table["palmgren_nm"]["oil_bath"] == pytest.approx(
        1e-3 * (1e-7 * 3.3 * (nu * 6000.0) ** (2 / 3) * 46.0**3 + load), rel=1e-6
    )
    rule = {supply: 1e3 * torque - load for supply, torque in table["palmgren_nm"].items()}
    assert [rule["oil_and_air"], rule["oil_jet"]] == pytest.approx(
        [0.5 * rule["oil_bath"], 2.0 * rule["oil_bath"]], rel=1e-9
    )
    assert 0.3 < table["torque_nm"] / table["palmgren_nm"]["oil_bath"] < 1.5


def test_rows_of_a_pair_have_torques_of_their_own():
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "preload_kind": "rigid", "row_distance": 0.016}
    table, _ = friction(bearing=pair, load={"axial": 200.0})
    first, second = (row["torque_nm"] for row in table["rows"])
    assert first + second == pytest.approx(table["torque_nm"], rel=1e-12) and first != pytest.approx(second, rel=1e-3)
    # Palmgren's M1 is linear in loads: rows in tandem, which share them, have that of one bearing.  M = M0 + M1, half of M0 in oil and air.
    tandem = {"preset": "B7206C", "arrangement": "DT", "row_distance": 0.016}
    one, two = (2.0 * rule["oil_and_air"] - rule["oil_bath"] for rule in (palmgren(), palmgren(bearing=tandem)))
    assert two == pytest.approx(one, rel=1e-9)
    slow = palmgren(kinematics={"spin_speed_rpm": 1.0})  # M0 = 160e-7 f0 d_m^3, printed to 1 %
    assert 2.0 * (slow["oil_bath"] - slow["oil_and_air"]) == pytest.approx(1e-3 * 160e-7 * 3.3 * 46.0**3, rel=0.01)


@pytest.mark.parametrize("inputs", [{"lubricant.temperature_c": [40.0, 80.0]}, {"load.axial": [300.0, 900.0]}])
def test_a_function_has_the_numbers_of_runs(inputs):
    ((key, values),) = inputs.items()
    outputs = [number.name for number in Friction.numbers]
    computed = rw.function(scene(), list(inputs), outputs)(**{key: np.array(values)})
    for k, value in enumerate(values):
        table, name = key.split(".")
        stated = run(scene(**{table: {**TABLES[table], name: value}})).quantities
        for output in outputs:
            assert float(np.asarray(computed[output])[k]) == pytest.approx(stated[output], rel=1e-8, abs=1e-15)


def test_ellipses_of_a_law_of_its_own_are_those_of_its_runs():
    """Of a foundation they do not grow with the cube root of the load: points of a function are runs."""
    own = scene(contact={"kind": "penalty"})
    computed = rw.function(own, ["load.axial"], ["torque_nm"])
    assert computed.why_slow
    assert float(computed(1000.0)["torque_nm"]) == pytest.approx(run(own).quantities["torque_nm"], rel=1e-12)


def test_measured_bearings_widen_the_band_of_what_is_computed():
    """Not of seals, which are given; of rows the widest: each factor of the band is over the torque without seals."""
    table, _ = friction(quantities={"friction": {"seal_torque": 0.02}})
    low, high = measured_factors(46e-3, 6000.0 * np.pi / 30.0)
    computed = table["torque_nm"] - 0.02
    assert table["band"]["high"] == pytest.approx(0.02 + high * computed, rel=1e-12) and low < 1.0 < 2.0 < high
    assert table["band"]["low"] == pytest.approx(0.02 + low * computed, rel=1e-12)
    given, _ = friction(quantities={"friction": {"measured_band": 4.0}})
    assert given["band"]["high"] == pytest.approx(4.0 * given["torque_nm"], rel=1e-12)


def test_gyroscopic_moments_are_those_of_the_balls_material():
    """In proportion to its density, under the same loads."""
    slow = {"spin_speed_rpm": 6000.0, "ball_inertia": False}
    bearings = ({"preset": "B7206C", "balls": {"density": density}} for density in (3200.0, 7800.0))
    ratios = [friction(bearing=bearing, kinematics=slow)[0]["gyroscopic_over_traction"] for bearing in bearings]
    assert ratios[0] / ratios[1] == pytest.approx(3200.0 / 7800.0, rel=1e-9)


def test_values_of_the_screen_are_short():
    table, _ = friction(quantities={"friction": {"seal_torque": 0.02}})
    rows = Friction.rows(table)
    assert all(len(value) < 20 for _, value, _ in rows)
    low, high = (6000.0 * np.pi / 30.0 * table["band"][end] for end in ("low", "high"))
    assert rows[2][2].startswith(f"{low:.3g} to {high:.3g}, ")
    assert [remark for name, _, remark in rows if name == "torque by source"][0].count(",") == 4


def test_at_rest_nothing_is_lost():
    table, _ = friction(kinematics={"spin_speed_rpm": 0.0})
    assert table["power_w"] == table["parts"]["drag"] == table["parts"]["rolling"] == 0.0


FAST = {"kinematics": {"spin_speed_rpm": 13200.0, "gyroscopic": "none", "ring_growth": False}}


def sliding(**tables):
    """What a run states of it, and its warning."""
    result = run(scene(**{**FAST, **tables}))
    return result.to_dict()["sliding"], [text for text in result.warnings if "balls slide" in text]


def test_the_traction_that_balls_need_is_that_of_moment_and_drag():
    """M = J w_R w_c sin(beta) with Jones' axis, tan(beta) = sin(a_o) / (cos(a_o) + g); F_c = m d_m / 2 w_c^2; both rows of a set are judged."""
    result = run(scene(load={"axial": 100.0}, lubricant=None, **FAST))
    stated, ball = result.to_dict()["sliding"], result.to_dict()["equilibrium"]["balls"][0]
    inner, outer = (np.radians(ball[f"contact_angle_{race}_deg"]) for race in ("inner", "outer"))
    g, w = 9.525 / 46.0, 13200.0 * np.pi / 30.0
    mass, cage = 7810.0 * np.pi / 6.0 * 9.525e-3**3, 0.5 * w * (1.0 - g * np.cos(0.5 * (inner + outer)))
    axis = np.arctan2(np.sin(outer), np.cos(outer) + g)
    over = (np.cos(outer) + np.tan(axis) * np.sin(outer)) / (1.0 + g * np.cos(outer))
    spin = w / (g * np.cos(axis) * (over + (np.cos(inner) + np.tan(axis) * np.sin(inner)) / (1.0 - g * np.cos(inner))))
    moment = 0.1 * mass * 9.525e-3**2 * spin * cage * np.sin(axis)
    both = ball["load_inner_n"] + ball["load_outer_n"]
    assert stated["traction_needed"] == pytest.approx(2.0 * moment / 9.525e-3 / both, rel=1e-9)
    assert stated["axial_over_centrifugal"] == pytest.approx(100.0 / (12 * mass * 23e-3 * cage**2), rel=1e-9)
    pair = {"preset": "B7206C", "arrangement": "DB", "preload_kind": "spring", "preload": 100.0}
    of_rows, _ = sliding(bearing=pair, load={"axial": 0.0}, lubricant=None)
    assert of_rows["axial_over_centrifugal"] == pytest.approx(stated["axial_over_centrifugal"], rel=1e-6)


def test_balls_slide_where_contacts_offer_less_traction_than_they_need():
    """By the oil's coefficient, by the scene's, or by that of oiled steel balls; drag adds to what they need, a radial load unloads."""
    assert not sliding()[1] and sliding(lubricant={**OIL, "traction_limit": 0.004})[1]
    dry, told = sliding(lubricant=None)
    assert dry["traction_offered"] == 0.06 and "ASLE 1959" in dry["source"] and not told
    rough, told = sliding(lubricant=None, contact={"friction": 0.001})
    assert rough["source"] == "contact.friction" and told
    light, told = sliding(load={"axial": 10.0})
    assert told and light["traction_needed"] > 0.06 > sliding(load={"axial": 10.0}, lubricant=None)[0]["traction_needed"]
    assert sliding(load={"axial": 100.0, "radial": [300.0, 0.0]})[0]["traction_needed"] is None
    rest = run(scene(kinematics={"spin_speed_rpm": 0.0})).to_dict()["sliding"]
    assert rest["axial_over_centrifugal"] is None and Sliding.rows(rest) == [] and Sliding.rows(dry)


def test_without_oil_it_is_left_out_and_asked_for_it_names_the_keys():
    dry = {name: table for name, table in TABLES.items() if name != "lubricant"}
    result = run(rw.Scene.from_dict({**dry, "quantities": {"friction": {"seal_torque": 0.02}}}))
    table = result.to_dict()
    assert "friction" not in table and "needs an oil" in table["not_computed"]["friction"]
    assert "life" not in table["not_computed"]
    assert any(warning.startswith("[quantities.friction] has no effect") for warning in result.warnings)
    assert not any("no effect" in warning for warning in run(rw.Scene.from_dict(dry)).warnings)
    with pytest.raises(RacewayError) as caught:
        rw.function(rw.Scene.from_dict(dry), ["load.axial"], ["torque_nm"])
    assert "[lubricant] with `oil` and `temperature_c`" in str(caught.value)


@pytest.mark.parametrize(("tables", "words"), [
    ({"lubricant": {**OIL, "oil_fraction": -0.1}}, "must be from 0 to 1"),
    ({"lubricant": {**OIL, "traction_limit": 0.4}}, "must be from 0 to 0.3"),
    ({"lubricant": {**OIL, "temperature_c": 180.0}}, "outside the oil's data"),
    ({"quantities": {"friction": {"seal_torque": -1.0}}}, "must be at least 0"),
    ({"quantities": {"friction": {"drag_band": 2.0}}}, "must be from 0 to 1"),
])  # fmt: skip
def test_mistakes_are_told(tables, words):
    with pytest.raises(rw.SceneError) as caught:
        scene(**tables)
    assert words in str(caught.value)
