"""Sets of rows: names, equal and different rows against independent rings, preloads of every kind, bad input."""

from math import radians

import attrs
import numpy as np
import pytest

from checks.validation.reference.ring import Ring
from checks.validation.reference.row_set import RowSet, press, press_together
from raceway import ConvergenceError, SceneError, build_model, make_plan, scene_from_dict
from raceway.extend import default_registry, equilibrium_table, make_basis, resolve, running_pairs, scene_schema
from raceway.testing import ring_inertia, solve_equilibrium

DISTANCE = 16e-3
#: Equilibria are solved to 1e-11; the references' Hertz factors, by quadrature and root finding, agree to 1e-9.
SAME = 1e-8


def scene(arrangement="TBT", preload=200.0, bearing=None, **tables):
    given = {"preset": "B7206E", "arrangement": arrangement, "row_distance": DISTANCE, "preload": preload, **(bearing or {})}
    given = {key: value for key, value in given.items() if value is not None}
    kinematics = {"ball_inertia": False, "gyroscopic": "none", "ring_growth": False, **tables.pop("kinematics", {})}
    return scene_from_dict({"title": "set", "bearing": given, "kinematics": kinematics, **tables})


def built(*args, **more):
    model = build_model(scene(*args, **more))
    return model, solve_equilibrium(model)


def ring(angle=25.0, balls=12, spin_rpm=0.0, first=0.0, diameter=9.525e-3):
    return Ring(
        diameter, 46e-3, balls, radians(angle), 0.522, 0.522, spin_speed=spin_rpm * np.pi / 30.0,
        first_azimuth=radians(first),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("word", "signs"),
    [("TBT", "++-"), ("DBD", "++-"), ("QBC", "++--"), ("DBB", "++--"), ("DTBT", "++--"), ("QBT", "+++-"), ("PT", "+++++")],
)
def test_names_say_how_rows_face(word, signs):
    rows = scene(word, None).bearing.rows
    assert [side for side, _ in rows] == [1.0 if sign == "+" else -1.0 for sign in signs]
    middle = 0.5 * (len(signs) - 1)
    assert [place for _, place in rows] == pytest.approx([(k - middle) * DISTANCE for k in range(len(signs))])


#: Rows of the names in makers' words: so many in tandem against so many, "B" back to back, "F" face to face, "T" all in tandem.
MAKERS = {
    "DB": (1, 1, "B"), "DF": (1, 1, "F"), "DT": (2, 0, "T"), "DBD": (2, 1, "B"), "TBT": (2, 1, "B"), "DFD": (2, 1, "F"), "TFT": (2, 1, "F"),
    "DTD": (3, 0, "T"), "TT": (3, 0, "T"), "DBB": (2, 2, "B"), "QBC": (2, 2, "B"), "DTBT": (2, 2, "B"), "DFF": (2, 2, "F"), "QFC": (2, 2, "F"),
    "DTFT": (2, 2, "F"), "QBT": (3, 1, "B"), "QFT": (3, 1, "F"), "QT": (4, 0, "T"), "PBC": (3, 2, "B"), "PFC": (3, 2, "F"), "PBT": (4, 1, "B"),
    "PFT": (4, 1, "F"), "PT": (5, 0, "T"),
}  # fmt: skip


@pytest.mark.parametrize(
    "word", scene_schema(default_registry())["properties"]["bearing"]["properties"]["arrangement"]["anyOf"][0]["enum"][1:]
)
def test_every_name_is_the_makers(word):
    """Back to back pressure lines meet the axis far apart: rows seated by a motion towards +x stand on the side of -x."""
    along, against, how = MAKERS[word]
    rows = scene(word, None).bearing.rows
    ahead, behind = ([place for side, place in rows if side == sign] for sign in (1.0, -1.0))
    assert (len(ahead), len(behind)) == (along, against)
    if behind:
        assert (max(ahead) < min(behind)) if how == "B" else (min(ahead) > max(behind))


def test_rows_face_to_face_stand_the_other_way_round():
    back, face = (scene(word, None).bearing.rows for word in ("TBT", "TFT"))
    assert [side for side, _ in back] == [side for side, _ in face]
    assert [place for _, place in back] == pytest.approx([-place for _, place in face])
    assert scene("++-", None).bearing.rows == back


@pytest.mark.parametrize(("word", "rows"), [("DB", 1), ("TBT", 2), ("QBT", 3)])
def test_rows_that_were_ground_share_their_offset(word, rows):
    """n rows against one, each ground for P0: F^(2/3) (1 + n^(-2/3)) = 2 P0^(2/3) at a constant angle, met to 1 % at 20 N."""
    model, now = built(word, 20.0, {"preload_of": "row"})
    found = equilibrium_table(model, now)["preload"]
    assert found["mounted_n"] / 20.0 == pytest.approx((2.0 / (1.0 + rows ** (-2.0 / 3.0))) ** 1.5, rel=0.01)
    offset = press(ring(), 20.0)
    expected = RowSet([ring() for _ in range(rows + 1)], [1.0] * rows + [-1.0], [0.0] * (rows + 1), [offset] * (rows + 1))
    assert found["rows_n"] == pytest.approx(expected.rows(expected.solve_equilibrium(np.zeros(3))), rel=SAME)


def test_rows_that_were_ground_for_preloads_of_their_own():
    """Offsets of 100 and 300 N: each row by itself under its own, put together."""
    model, now = built("DB", 200.0, {"preload_of": "row", "row": [{"preload": 100.0}, {"preload": 300.0}]})
    expected = RowSet([ring(), ring()], [1.0, -1.0], [0.0, 0.0], [press(ring(), 100.0), press(ring(), 300.0)])
    rows = equilibrium_table(model, now)["preload"]["rows_n"]
    assert rows == pytest.approx(expected.rows(expected.solve_equilibrium(np.zeros(3))), rel=SAME)
    assert 100.0 < rows[0] < 300.0


def test_inner_rings_of_a_set_tilt_about_its_middle():
    """Huygens and Steiner: each ring's own moment of inertia, and its mass on the arm of its place."""
    (mass, tilt, polar), two = (ring_inertia(scene(word, None).bearing) for word in ("single", "DB"))
    assert two == pytest.approx((2.0 * mass, 2.0 * (tilt + mass * (0.5 * DISTANCE) ** 2), 2.0 * polar), rel=1e-12)


def test_twice_a_pair_is_twice_as_stiff():
    """Of equal rows in tandem back to back: the offset stays that of a pair."""
    (_, pair), (_, four) = (built(word, 200.0, {"preload_of": "row"}) for word in ("DB", "QBC"))
    np.testing.assert_allclose(np.diag(four.stiffness)[:3], 2.0 * np.diag(pair.stiffness)[:3], rtol=SAME)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_rows_in_tandem_share_a_load(count):
    """The deflection is that of one row under its share, which Hertz's contacts make n^(-2/3) at a constant angle."""
    word = {2: "DT", 3: "TT", 4: "QT"}[count]
    deflections = [built(kind, None, load={"axial": 50.0})[1].displacement[0] for kind in ("single", word)]
    assert deflections[1] == pytest.approx(press(ring(), 50.0 / count), rel=SAME)
    assert deflections[1] / deflections[0] == pytest.approx(count ** (-2.0 / 3.0), rel=0.02)


@pytest.mark.parametrize("rpm", [0.0, 15000.0])
def test_rows_of_different_bearings(rpm):
    """Angle, ball count, ball diameter and azimuth of a row are its own: force and tangent at a general motion."""
    own = [{}, {"contact_angle_deg": 15.0, "first_ball_azimuth_deg": 7.0}, {"ball_count": 10, "ball_diameter": 10e-3}]
    kinematics = {"ball_inertia": rpm > 0.0, "spin_speed_rpm": rpm}
    model, now = built("TBT", 200.0, {"row": own}, kinematics=kinematics, load={"axial": 60.0, "radial": [50.0, 20.0]})
    still = [ring(), ring(15.0, first=7.0), ring(balls=10, diameter=10e-3)]
    first, last = press_together(still[:2], 200.0), press(still[2], 200.0)
    rings = [ring(spin_rpm=rpm), ring(15.0, spin_rpm=rpm, first=7.0), ring(balls=10, diameter=10e-3, spin_rpm=rpm)]
    expected = RowSet(rings, [1.0, 1.0, -1.0], [-DISTANCE, 0.0, DISTANCE], [first, first, last])
    q = expected.solve_equilibrium(np.array([60.0, 50.0, 20.0]))
    assert now.displacement == pytest.approx(q, rel=1e-6, abs=1e-13)
    off = now.displacement + np.array([1e-7, -3e-7, 5e-7, 2e-5, -1e-5])
    here, (force, tangent) = model.system.evaluate(off), expected(off)
    scale = np.array([1.0, 1.0, 1.0, 1.0 / 0.023, 1.0 / 0.023])
    np.testing.assert_allclose(here.force * scale, force * scale, atol=1e-6 * np.abs(force * scale).max())
    scaled = tangent * scale[:, None] * scale
    np.testing.assert_allclose(here.stiffness * scale[:, None] * scale, scaled, atol=1e-5 * np.abs(scaled).max())
    assert equilibrium_table(model, now)["preload"]["rows_n"] == pytest.approx(expected.rows(q), rel=1e-5)


def test_a_row_that_repeats_its_bearing_changes_no_digit():
    plain = built("TBT", 200.0, load={"radial": [80.0, 0.0]})[1]
    told = {"ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "bore": 30e-3, "outer_diameter": 62e-3, "width": 16e-3}
    places = [{"direction": sign, "position": (k - 1) * DISTANCE} for k, sign in enumerate("++-")]
    for rows in ([{}, told, {}], places):
        word = "TBT" if rows[0] == {} else None
        found = built(word, 200.0, {"row": rows}, load={"radial": [80.0, 0.0]})[1]
        assert found.stiffness.tolist() == plain.stiffness.tolist()


def test_two_bearings_on_a_shaft():
    """Far apart and different: each row as a bearing by itself, the shaft's tilt held; the first row's preset is the set's."""
    rows = [{"direction": "+", "position": -0.1, "preset": "B7206C"}, {"direction": "-", "position": 0.1, "preset": "7206A"}]
    one = scene_from_dict({"bearing": {"row": rows, "preload": 250.0}, "kinematics": {"ball_inertia": False}})
    assert one.bearing.preset == "B7206C"
    model = build_model(one)
    now = solve_equilibrium(model)
    alone = [built("single", None, {"preset": preset}, load={"axial": 250.0})[1].stiffness for preset in ("B7206C", "7206A")]
    np.testing.assert_allclose(np.diag(now.stiffness)[:3], sum(np.diag(k)[:3] for k in alone), rtol=SAME)


def test_peak_pressures_and_edges_are_those_of_each_row():
    """A row with other balls has its own ellipses: pressures of a set are those of its rows as single bearings."""
    model, now = built("DB", 300.0, {"row": [{}, {"ball_diameter": 8e-3}]})
    z = model.system.ball_count
    found = model.bearing.contact_ellipse(model, 0, now.contact_force[:z])[0]
    same, pressures = np.array([100.0]), []  # of no particular balls: of the row in which they press hardest
    for row, own in enumerate(({}, {"ball_diameter": 8e-3})):
        alone, at = built("single", None, own, load={"axial": 300.0})
        expected = alone.bearing.contact_ellipse(alone, 0, at.contact_force[:12])[0]
        np.testing.assert_allclose(found[row * 12 : row * 12 + 12], expected, rtol=SAME)
        pressures.append(alone.bearing.contact_ellipse(alone, 0, same)[0])
    assert model.bearing.contact_ellipse(model, 0, same)[0] == pytest.approx(max(pressures), rel=SAME)


def test_both_forces_given():
    """Under their difference as an axial load both directions carry their own."""
    model, now = built("QBT", 300.0, {"second_preload": 120.0}, load={"axial": 180.0})
    rows = equilibrium_table(model, now)["preload"]["rows_n"]
    assert (sum(rows[:3]), rows[3]) == pytest.approx((300.0, 120.0), rel=SAME)
    assert abs(now.displacement[0]) < 1e-13


@pytest.mark.parametrize("own", [None, [{}, {"contact_angle_deg": 15.0}, {}]])
def test_rows_on_a_spring_share_its_force(own):
    """Two rows on the spring: together its force, under any load; the first one carries the rest."""
    bearing = {"preload_kind": "spring", **({} if own is None else {"row": own})}
    kinematics = {"ball_inertia": True, "spin_speed_rpm": 20000.0, "radial_expansion": 2e-6}
    model, now = built("+--", 300.0, bearing, load={"axial": 90.0}, kinematics=kinematics)
    rows = equilibrium_table(model, now)["preload"]["rows_n"]
    assert (rows[0], rows[1] + rows[2]) == pytest.approx((390.0, 300.0), rel=SAME)


def test_a_spring_has_its_travel():
    """It has a stop on either side: a load that parts the rows slides the ring one way, one that presses them together the other."""
    more = {"preload_kind": "spring", "spring_travel": 1e-6}
    for axial in (500.0, -200.0):
        with pytest.raises(ConvergenceError, match=r"would slide .* beyond `bearing.spring_travel` = 1e-06 m.*more travel"):
            built("DB", 300.0, more, load={"axial": axial})
    assert built("DB", 300.0, {**more, "spring_travel": 50e-6}, load={"axial": 500.0})[1].displacement[0] > 0.0


@pytest.mark.parametrize("rpm", [0.0, 20000.0])
def test_preload_of_a_running_set(rpm):
    """Offsets are ground at standstill; centrifugal forces then press the rows together."""
    model, now = built("TBT", 200.0, kinematics={"ball_inertia": True, "spin_speed_rpm": rpm})
    shifts = [press(ring(), 100.0)] * 2 + [press(ring(), 200.0)]
    expected = RowSet([ring(spin_rpm=rpm) for _ in range(3)], [1.0, 1.0, -1.0], [-DISTANCE, 0.0, DISTANCE], shifts)
    assert equilibrium_table(model, now)["preload"]["running_n"] == pytest.approx(
        expected.rows(expected.solve_equilibrium(np.zeros(3)))[2], rel=1e-6
    )


@pytest.mark.parametrize(
    ("word", "told"), [("DB", (2.95, 2.95)), ("TBT", (5.91, 2.95)), ("QBC", (5.91, 5.91)), ("QBT", (8.87, 2.95))]
)
def test_lift_off(word, told):
    """Against an independent program's digits (1 %), the reference (1e-8) and the constant angle: n 2^1.5, less than 5 % below."""
    model, now = built(word, 200.0, {"preload_of": "row"}, load={"axial": 60.0, "radial": [50.0, 20.0]})
    loads = equilibrium_table(model, now)["preload"]["lift_off_axial_n"]
    sides, places = zip(*model.scene.bearing.rows, strict=True)
    offset = press(ring(), 200.0)
    expected = RowSet([ring() for _ in sides], list(sides), list(places), [offset] * len(sides))
    for load, sense, ratio in zip(loads, (1.0, -1.0), told, strict=True):
        assert sense * load / 200.0 == pytest.approx(ratio, rel=0.01)
        assert load == pytest.approx(expected.lift_off(sense), rel=1e-7)
        assert 1.0 < sense * load / 200.0 / (sides.count(sense) * 2.0**1.5) < 1.05


@pytest.mark.parametrize(("kind", "rpm"), [("rigid", 0.0), ("rigid", 12000.0), ("condensed", 12000.0)])
def test_a_row_carries_nothing_at_its_lift_off(kind, rpm):
    """A run under the load: the row has left; under a little less it has not."""
    bearing = {"row": [{}, {}, {"contact_angle_deg": 15.0}]} if kind == "rigid" else {"preset": "B7206C"}
    more = {"bodies": {"kind": kind}, "kinematics": {"ball_inertia": rpm > 0.0, "spin_speed_rpm": rpm}}
    preload = equilibrium_table(*built("TBT", 200.0, bearing, **more))["preload"]
    for load, row in zip(preload["lift_off_axial_n"], preload["lift_off_row"], strict=True):
        loaded = [built("TBT", 200.0, bearing, load={"axial": part * load}, **more) for part in (1.0, 0.99)]
        left, there = (equilibrium_table(*each)["preload"]["rows_n"][row - 1] for each in loaded)
        # At lift-off a force goes with the 1.5th power of a displacement that is solved to 1e-11 of all forces.
        assert left < 1e-4 * 200.0 < 1e-3 * abs(load) and left < 0.1 * there


def test_lift_off_of_a_sprung_set():
    """Rows on a spring never leave; the others do under the spring's force."""
    preload = equilibrium_table(*built("TBT", 200.0, {"preload_kind": "spring"}, load={"axial": 90.0}))["preload"]
    assert preload["lift_off_axial_n"] == [None, pytest.approx(-200.0, rel=1e-6)] and preload["lift_off_row"] == [None, 1]


@pytest.mark.parametrize(("bearing", "words"), [
    ({"arrangement": "DBX"}, r"must be one of 'single', 'DB'.*\+\+-"),
    ({"arrangement": "DBT"}, "is ambiguous: three rows in NTN's catalogue and four in NSK's: write 'TBT'"),
    ({"arrangement": ""}, "must be one of"),
    ({"arrangement": "TT"}, "needs rows that brace each other.*the 3 rows of 'TT' face one way only.*load.axial"),
    ({"arrangement": "--"}, "needs rows that brace each other"),
    ({"row": [{}, {}]}, r"`row` has 2 tables, but arrangement = 'TBT' is 3 rows"),
    ({"arrangement": "single", "row": [{}]}, r"`row\[0\]` has no `direction`"),
    ({"row": [{}, {}, {"direction": "left"}]}, r"bearing.row\[2\].direction` = 'left'.*must be one of '\+', '-'"),
    ({"row": [{}, {"angle": 3}, {}]}, r"bearing.row\[1\].angle` = 3: unknown key"),
    ({"row": [{}, {"preset": "nothing"}, {}]}, r"bearing.row\[1\].preset` = 'nothing': no such preset"),
    ({"row": [{}, {"ball_count": 99}, {}]}, r"`row\[1\]`: `ball_count` = 99 .* do not fit"),
    ({"row": [{}, {"preload": 10.0}, {}]}, r"`row\[1\].preload` .* set preload_of = 'row'"),
    ({"row": [{}, {"position": DISTANCE}, {}]}, "two rows at the same place"),
    ({"row": "TBT"}, "must be a list of tables, not a string"),
    ({"second_preload": 10.0, "preload_of": "row"}, "set preload_of = 'set'"),
    ({"preload": 0.0, "second_preload": 10.0}, "needs a `preload`"),
    ({"preload_kind": "spring", "preload_of": "row"}, "with preload_kind = 'spring' use 'set'"),
    ({"preload_kind": "spring", "spring_travel": 0.0}, "a spring without travel is no spring.*preload_kind = 'rigid'"),
])  # fmt: skip
def test_bad_sets_are_refused(bearing, words):
    with pytest.raises(SceneError, match=words):
        scene("TBT", bearing=bearing)


@pytest.mark.parametrize(("tables", "words"), [
    ({"kinematics": {"orbiting": True, "spin_speed_rpm": 1e4}}, "balls travel at different speeds"),
    ({"kinematics": {"ball_inertia": True, "gyroscopic": "shared", "spin_speed_rpm": 1e4}}, "moments are computed"),
    ({"contact": {"friction": 0.1}}, "friction is computed for balls of one kind"),
    ({"bodies": {"kind": "condensed"}}, "one ring section for all rows"),
    ({"bodies": {"kind": "elastic"}, "mesh": {"kind": "structured"}}, "elastic bodies are one row of balls"),
])  # fmt: skip
def test_what_different_rows_cannot_have_is_refused(tables, words):
    one = scene("DB", 200.0, {"row": [{}, {"contact_angle_deg": 15.0}]}, **tables)
    with pytest.raises(SceneError, match=words):
        make_plan(one)


def test_a_set_goes_through_a_file(tmp_path):
    one = scene("TBT", 200.0, {"row": [{}, {"position": "1 mm", "preset": "B7206C"}, {}]})
    assert one.bearing.rows[1] == (1.0, 1e-3) and one.bearing.of_rows[1].contact_angle_deg == 15.0
    assert attrs.evolve(scene_from_dict(one.to_dict()), given=None, source={}) == attrs.evolve(one, given=None, source={})


def test_an_open_contact_is_about_to_carry_a_tenth_of_the_largest_load_of_its_own_row():
    """As laws of running contacts take it; one ball of either row is loaded.  Of balls that orbit each carries the mean of all."""
    problem, orbiting = (resolve(scene("DB", kinematics={"spin_speed_rpm": 9000.0, "orbiting": on})) for on in (False, True))
    force = np.zeros((2, 2, problem.bearing.ball_count))
    force[:, :, 0] = 10.0, 100.0
    angles = np.full((2, force[0].size), radians(25.0))
    load, mean = (
        running_pairs(p, make_basis(p), force.ravel(), tuple(angles)).load.reshape(force.shape) for p in (problem, orbiting)
    )
    assert load == pytest.approx(np.maximum(force, 0.1 * force.max(axis=2, keepdims=True)))
    assert mean == pytest.approx(np.broadcast_to(force.mean(axis=2, keepdims=True), force.shape))
