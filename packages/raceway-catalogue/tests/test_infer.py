"""Balls and grooves from printed numbers: known bearings, standards, what is refused."""

import json

import attrs
import numpy as np
import pytest
from raceway_catalogue.catalogue import section_drawing
from raceway_catalogue.infer import infer_texts, lines_by_size
from raceway_catalogue.inferred import infer_printed
from raceway_catalogue.printed import PairStiffness, Printed, Rating, printed_by, table_in_text
from raceway_catalogue.rating_conventions import CONFORMITY, pair_stiffness

import raceway as rw
from checks.validation.command_line import invoke
from checks.validation.figures import assert_readable
from raceway import SceneError
from raceway.core.quantities.ratings import groove_curvatures, hertz_load_factor, static_load_factor
from raceway.extend import BallBearing, BallRow, contact_modulus

#: 7206C: 12 balls of 9.525 mm on 46 mm, 15 deg.
Z, D, PITCH, ANGLE = 12, 9.525e-3, 46e-3, np.radians(15.0)
HEAD = "name,bore_mm,outer_diameter_mm,width_mm,contact_angle_deg,dynamic_rating_n,static_rating_n"


@pytest.fixture(scope="module")
def series():
    """The printed sizes of the series 70, 72, 79, inferred with one conformity."""
    return {one.names[0]: infer_printed(one, conformity=CONFORMITY) for one in lines_by_size(printed_by("nsk"))}


def test_the_ratings_of_7206c_are_the_printed_ones():
    """Makers print 23.0 and 14.7 kN, rounded to half a percent."""
    row = BallRow(Z, D, PITCH, ANGLE)
    assert row.dynamic_rating() == pytest.approx(23.0e3, rel=4e-3)
    assert row.static_rating() == pytest.approx(14.7e3, rel=4e-3)


def test_the_table_of_f0_is_the_load_at_4200_mpa():
    """ISO 76's table is rounded to 0.1: 0.7 % of 14."""
    for g in (0.12, 0.2, 0.3, 0.4):
        exact = BallRow(1, 1e-3, 1e-3 / g, 0.0, 0.52, 0.53).static_rating_of_grooves()
        assert exact == pytest.approx(static_load_factor(g), rel=7e-3)


def test_below_a_tenth_f0_goes_on_with_the_inner_race():
    assert static_load_factor(0.0999999) == pytest.approx(static_load_factor(0.1), rel=1e-5)
    # One maker prints 16.7 for 7922C, of 26 balls of 11.906 mm on 130 mm.
    assert static_load_factor(11.90625 * np.cos(ANGLE) / 130.0) == pytest.approx(16.7, abs=0.05)


def test_wider_grooves_carry_less():
    ratings = [float(BallRow(Z, D, PITCH, ANGLE, f, f).dynamic_rating()) for f in (0.515, 0.52, 0.53)]
    assert ratings[0] > ratings[1] > ratings[2]
    # f_c goes with (2 f / (2 f - 1))^0.41 where both grooves are alike (ISO/TR 1281-1).
    assert ratings[2] / ratings[1] == pytest.approx((1.06 / 0.06 / (1.04 / 0.04)) ** 0.41, rel=1e-9)


def test_the_closed_form_of_a_pair_is_what_a_run_gives():
    """One is interpolated Hertz and bisection, the other the compiled equilibrium: 1e-6 apart."""
    tables = {"bearing": {"preset": "7206C-NSK", "arrangement": "DB", "preload": 400.0}}
    b = rw.Scene.from_dict(tables).bearing
    row = BallRow(b.ball_count, b.ball_diameter, b.pitch_diameter, b.contact_angle, b.conformity_inner, b.conformity_outer)
    expected = pair_stiffness(row, 400.0, b.rings.young, b.rings.poisson)
    assert np.diag(rw.run(tables).stiffness)[:2] == pytest.approx(expected, rel=1e-6)


def test_the_load_factor_is_that_of_the_core():
    modulus = contact_modulus(208e9, 0.3, 208e9, 0.3)
    shape = BallBearing(D, PITCH, Z, ANGLE, 0.522, 0.53)
    g = shape.gamma
    for race, (f, exact) in enumerate(zip((0.522, 0.53), shape.ellipses(modulus), strict=True)):
        assert hertz_load_factor(*groove_curvatures(D, g, f, race == 0), modulus) == pytest.approx(exact.factor, rel=1e-6)


def test_one_printed_angle_gives_the_same_balls(series):
    balls = {name: found for found in series.values() for name in found.printed.names}
    for one in printed_by("nsk")[::9]:
        alone, whole = infer_printed(one, "NSK"), balls[one.names[0]]
        assert alone.ball_count.value == whole.ball_count.value, one.names
        assert alone.ball_diameter.value == whole.ball_diameter.value, one.names


def test_balls_of_whole_millimetres_are_found_where_no_inch_size_fits():
    """16 balls of 11 mm on 80 mm, 25 deg: ratings by the standards, rounded to three digits as makers print."""
    row = BallRow(16, 11e-3, 80e-3, np.radians(25.0))
    c, c0 = (float(f"{float(x):.3g}") for x in (row.dynamic_rating(), row.static_rating()))
    found = rw.infer("60 mm", "100 mm", {25: (c, c0)}, maker="NSK")
    assert (found.ball_count.value, found.ball_diameter.value) == (16, pytest.approx(11e-3))
    assert "11 mm" in found.ball_diameter.reason


def test_grooves_that_a_maker_grinds_tell_balls_apart():
    """S 619/5 of GMN: nine balls would fit its ratings in grooves of 0.537 D, which GMN has nowhere; it prints eight."""
    (one,) = (one for one in lines_by_size(printed_by("gmn")) if one.names[0] == "S 619/5 C TA")
    found = infer_printed(one)
    assert found.ball_count.value == one.internals.ball_count == 8
    assert found.other is not None and found.other["share"] < 0.01


def test_a_conformity_is_fitted_to_printed_stiffnesses():
    table = {"bearing": {"preset": "7014C", "conformity_inner": 0.53, "conformity_outer": 0.53, "arrangement": "DB"}}
    pairs = []
    for preload in (145.0, 740.0):
        table["bearing"]["preload"] = preload
        pairs.append((15.0, preload, rw.run(table).stiffness[0, 0]))
    found = rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN")}, pairs=pairs, maker="NSK")
    # The fit interpolates on a grid of 0.0005 and rounds to four digits.
    assert found.conformity_inner.value == pytest.approx(0.53, abs=1e-4)
    # The scatter is what a stiffness that is printed 0.8 % too high changes: the median error of the series 70.
    stiffer = [(angle, preload, 1.008 * k) for angle, preload, k in pairs]
    other = rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN")}, pairs=stiffer, maker="NSK")
    moved = found.conformity_inner.value - other.conformity_inner.value
    assert moved / found.conformity_inner.value == pytest.approx(found.conformity_inner.scatter, rel=0.15)  # of four digits


def test_groove_and_angle_are_fitted_to_printed_stiffnesses_of_both_directions():
    """A pair of 14.4 deg in grooves of 0.516 D, as it would be printed; and what NTN prints of 7008UC is met by its preset."""
    made = {"preset": "7014C", "contact_angle_deg": 14.4, "conformity_inner": 0.516, "conformity_outer": 0.516}
    k = rw.run({"bearing": {**made, "arrangement": "DB", "preload": 290.0}}).stiffness
    found = rw.infer(
        "70 mm", "110 mm", {15: ("47 kN", "43 kN")}, pairs=[(15, 290.0, k[0, 0], k[1, 1])], maker="NSK", width="20 mm"
    )
    # Grids of 0.25 deg and 0.001 of the conformity, interpolated.
    assert found.bearing()["contact_angle_deg"] == pytest.approx(14.4, abs=0.02)
    assert found.conformity_inner.value == pytest.approx(0.516, abs=2e-4)
    again = rw.run({"bearing": {**found.bearing(), "arrangement": "DB", "preload": 290.0}}).stiffness
    assert np.diag(again)[:2] == pytest.approx(np.diag(k)[:2], rel=2e-3)
    (one,) = (one for one in printed_by("ntn") if one.names == ("7008UC",))
    (pair,) = one.pairs
    k = rw.run({"bearing": {"preset": "7008UCG/GNP42", "arrangement": "DB", "preload": pair.preload}}).stiffness
    assert (k[0, 0], k[1, 1]) == (pytest.approx(pair.stiffness, rel=0.01), pytest.approx(pair.radial, rel=0.03))


def test_the_bearing_of_an_answer_runs():
    found = rw.infer("30 mm", "62 mm", {15: (23.0e3, 14.7e3), 25: (22.1e3, 14.1e3)}, width="16 mm")
    assert (found.ball_count.value, found.pitch_diameter.value) == (12, 46e-3)
    assert found.ball_diameter.value == pytest.approx(9.525e-3)
    ours = rw.run({"bearing": found.bearing(25), "load": {"axial": 400.0}}).stiffness
    preset = rw.run({"bearing": {"preset": "7206A5"}, "load": {"axial": 400.0}}).stiffness
    assert np.allclose(ours, preset, rtol=1e-12, atol=1e-3)
    json.dumps(found.to_dict())
    assert found.other is None or found.other["share"] < 0.01


def test_a_deep_groove_bearing_is_inferred_at_an_angle_of_zero():
    found = rw.infer("25 mm", "52 mm", {0: ("14 kN", "7.85 kN", 13.9)}, width="15 mm")
    table = found.bearing()
    assert (found.ball_count.value, table["contact_angle_deg"]) == (9, 0.0)
    assert table["radial_clearance"] == pytest.approx(12.5e-6)
    preset = rw.catalogue("6205")[0].table
    assert {key: table[key] for key in preset if key not in ("rings", "balls")} == pytest.approx(
        {key: value for key, value in preset.items() if key not in ("rings", "balls")}
    )
    with pytest.raises(SceneError, match="by its own grooves"):
        rw.infer("25 mm", "52 mm", {0: ("15.2 kN", "8.9 kN")}, maker="GMN")


GOOD = Printed(0.07, 0.11, (Rating(15.0, 47e3, 43e3), Rating(25.0, 44.5e3, 41e3)))
REFUSED = {
    "no integer": ({"ratings": (Rating(15.0, 47e3, 30e3),)}, "no whole number of balls"),
    "two angles": ({"ratings": (Rating(15.0, 47e3, 43e3), Rating(25.0, 55e3, 41e3))}, "contradicts 47000 N at 15 deg"),
    "twice": ({"ratings": (Rating(15.0, 47e3, 43e3),) * 2}, "listed twice"),
}


@pytest.mark.parametrize(("changes", "words"), REFUSED.values(), ids=REFUSED)
def test_ratings_of_no_bearing_are_one_message(changes, words):
    with pytest.raises(SceneError) as caught:
        infer_printed(attrs.evolve(GOOD, **changes), "NSK")
    assert len(caught.value.mistakes) == 1 and words in str(caught.value)


NO_INPUT = {
    "dimension": (("70", "110 mm", {15: ("47 kN", "43 kN")}), "write a unit"),
    "unit": (("70 mm", "110 mm", {15: ("47 m", "43 kN")}), "N, kN or lbf"),
    "text": (("wide", "110 mm", {15: ("47 kN", "43 kN")}), "bore"),
    "nan": ((float("nan"), "110 mm", {15: ("47 kN", "43 kN")}), "finite"),
    "switched": (("70 mm", "110 mm", {15: ("47 kN", "1 N")}), "contradicts the dynamic rating"),
    "angle": (("70 mm", "110 mm", {80: ("47 kN", "43 kN")}), "45 deg"),
    "none": (("70 mm", "110 mm", {}), "needs the load ratings"),
}


@pytest.mark.parametrize(("arguments", "words"), NO_INPUT.values(), ids=NO_INPUT)
def test_numbers_that_no_bearing_has_are_told(arguments, words):
    with pytest.raises(SceneError, match=words):
        rw.infer(*arguments)


def test_a_stiffness_that_no_groove_gives_contradicts_the_ratings():
    with pytest.raises(SceneError, match="Is it the axial stiffness of a pair") as caught:
        rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN")}, pairs=[(15, "145 N", "20 N/um")], maker="NSK")
    assert "67.2 N/µm" in str(caught.value)
    with pytest.raises(SceneError, match="Is it the radial stiffness"):
        rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN")}, pairs=[(15, "145 N", "68 N/um", "900 N/um")], maker="NSK")


def test_an_unknown_maker_is_refused():
    with pytest.raises(SceneError, match="one of NSK, NMB, GMN"):
        infer_printed(GOOD, "ACME")


TABLES = {
    "head": ("name,bore\n7014C,70\n", "unknown column"), "empty": (HEAD + "\n", "has no line"),
    "words": (HEAD + "\n7014C,wide,110,20,15,47000,43000\n", "line 2"), "short": (HEAD + "\n7014C,70,110\n", "line 2"),
    "contradiction": (HEAD + "\n7014C,70,110,20,15,18.5,0.02\n", "line 2: 7014C: static rating"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "words"), TABLES.values(), ids=TABLES)
def test_a_wrong_table_is_told_with_its_line(text, words):
    with pytest.raises(SceneError, match=words):
        table_in_text(text, "mine.csv")


def test_a_table_is_read_in_si_units_and_words_of_the_command_as_numbers():
    more = "static_factor,ball_count,ball_diameter_mm,pitch_diameter_mm,preload_1_n,stiffness_1_n_per_um,radial_stiffness_1_n_per_um"
    (line,) = table_in_text(f"{HEAD},{more}\na,70,110,20,15,47e3,43e3,13.9,20,11.9,90,145,51,335", "all.csv").lines
    assert (line.bore, line.outer_diameter, line.width) == pytest.approx((0.07, 0.11, 0.02))
    assert line.ratings == (Rating(15.0, 47e3, 43e3, 13.9),) and line.pairs == (PairStiffness(15.0, 145.0, 51e6, 335e6),)
    assert attrs.astuple(line.internals) == pytest.approx((20, 0.0119, 0.09))
    words = {"width": "20 mm", "ratings": ["15:47 kN:43 kN"], "maker": "NSK", "conformity": 0.53}
    found = infer_texts(bore="70 mm", outer_diameter="110 mm", **words)
    assert (found.printed.width, found.conformity_inner.value) == pytest.approx((0.02, 0.53))


def test_the_command_infers_one_bearing_and_a_table(tmp_path):
    one = ["catalogue", "--infer", "--bore", "70 mm", "--outer-diameter", "110 mm", "--rating", "15:47 kN:43 kN"]
    found = json.loads(invoke(*one, "--json").stdout)
    assert found["bearing"]["ball_count"] == 20 and found["numbers"]["ball_count"]["reason"]
    assert "axial stiffness uncertain by about 4 %" in invoke(*one).stdout
    file = tmp_path / "mine.csv"
    lines = ["7014C,70,110,20,15,47000,43000", "7014A5,70,110,20,25,44500,41000", "wrong,70,112,20,15,47000,23000"]
    file.write_text("\n".join([HEAD, *lines, "contradiction,70,114,20,15,18.5,0.02", ""]))
    table = json.loads(invoke("catalogue", "--infer", str(file), "--json").stdout)
    assert [row.get("ball_count") for row in table["rows"]] == [None, 20, None]
    assert "line 5: contradiction: static rating" in table["rows"][0]["refused"]
    assert "no whole number" in table["rows"][2]["refused"]
    assert "refused" in invoke("catalogue", "--infer", str(file)).stdout


@pytest.mark.parametrize("words", [
    ["catalogue", "--infer"], ["catalogue", "--infer", "none.csv"],
    ["catalogue", "--infer", "--bore", "70 mm", "--outer-diameter", "110 mm", "--rating", "15:47 kN"],
    ["catalogue", "--infer", "nsk", "--bore", "70 mm"], ["catalogue", "7014B"],
    ["catalogue", "70*", "--picture", "all.png"], ["catalogue", "7014C", "--picture", "one.bmp"],
])  # fmt: skip
def test_mistakes_on_the_command_line_are_one_message(words):
    found = invoke(*words)
    assert found.exit_code == 2
    assert found.stderr.startswith("error: ") and "Traceback" not in found.stderr


def test_the_catalogue_lists_shows_and_draws(tmp_path):
    assert len(json.loads(invoke("catalogue", "79*", "--json").stdout)["bearings"]) == 72
    picture = tmp_path / "7014C.png"
    found = json.loads(invoke("catalogue", "7014C", "--picture", str(picture), "--json").stdout)
    assert found["files"] == [str(picture)] and picture.read_bytes()[:4] == b"\x89PNG"
    assert found["ball_pass"]["bpfo"] == pytest.approx(20 * 0.5 * (1 - 11.90625 / 90 * np.cos(ANGLE)))
    assert "geometry inferred" in invoke("catalogue", "7014C").stdout
    assert "Si3N4" in invoke("catalogue", "--materials").stdout


def test_the_section_is_in_proportion():
    from matplotlib.patches import Circle
    from raceway_catalogue.catalogue import ring_outline

    bearing = rw.Scene.from_dict({"bearing": {"preset": "7014C"}}).bearing
    inner, outer = (ring_outline(bearing, race) for race in (True, False))
    assert np.ptp(inner[:, 0]) == pytest.approx(0.02) and np.ptp(outer[:, 0]) == pytest.approx(0.02)
    assert inner[:, 1].min() == pytest.approx(0.035) and outer[:, 1].max() == pytest.approx(0.055)
    # Neither ring cuts the ball, and both grooves come close to it: they touch it at the contact angle.
    for ring in (inner, outer):
        gap = np.hypot(ring[2:-2, 0], ring[2:-2, 1] - 0.045) - 0.5 * bearing.ball_diameter
        assert -1e-9 < gap.min() < 1e-5
    shapes = [shape for axes in section_drawing("7014C", bearing).axes for shape in axes.patches]
    balls = np.array([(*shape.center, 2.0 * shape.radius) for shape in shapes if isinstance(shape, Circle)])
    assert balls == pytest.approx(np.array([[0.0, r, 1e3 * bearing.ball_diameter] for r in (45.0, -45.0, 45.0)]))


def test_its_drawings_are_readable():
    bearings = {name: rw.scene_from_dict({"bearing": {"preset": name}}).bearing for name in ("7000C", "7014A", "7930A5")}
    assert_readable([section_drawing(name, bearing) for name, bearing in bearings.items()])
