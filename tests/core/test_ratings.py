"""Load ratings of scenes' bearings: keys, catalogue, geometry."""

import numpy as np
import pytest
from raceway_catalogue.printed import printed_by

import raceway as rw
from raceway import SceneError, scene_from_dict
from raceway.core.columns import with_values
from raceway.scene.ratings import load_ratings

BARE = {
    "ball_diameter": 0.0119, "pitch_diameter": 0.09, "ball_count": 20, "conformity_inner": 0.52, "conformity_outer": 0.52,
    "contact_angle_deg": 15.0,
}  # fmt: skip


def bearing(**keys):
    return scene_from_dict({"bearing": keys}).bearing


def test_the_catalogue_holds_what_is_printed():
    printed = {one.names[0]: one.ratings[0] for one in printed_by("nsk")}
    for name, rating in printed.items():
        assert rw.catalogue(name)[0].ratings == {"dynamic_rating": rating.dynamic, "static_rating": rating.static}
    assert "dynamic_rating" not in rw.catalogue("7014C")[0].table


def test_a_bearing_of_the_catalogue_has_the_printed_ratings():
    found = load_ratings(bearing(preset="7014C"))
    assert (found.dynamic, found.static) == (47000.0, 43000.0)
    assert found.dynamic_from == found.static_from == "catalogue"


def test_keys_go_before_the_catalogue():
    found = load_ratings(bearing(preset="7014C", dynamic_rating="51 kN"))
    assert (found.dynamic, found.dynamic_from, found.static_from) == (51e3, "key", "catalogue")


def test_other_bearings_are_rated_by_their_geometry():
    """NSK prints 47.0 and 43.0 kN for these balls."""
    found = load_ratings(bearing(**BARE))
    assert (found.dynamic, found.static) == (pytest.approx(47e3, rel=5e-3), pytest.approx(43e3, rel=5e-3))
    assert found.dynamic_from == found.static_from == "geometry"
    # A preset without printed ratings, and one whose static rating no document prints.
    assert load_ratings(bearing(preset="ACB21-HARRIS-MINDEL")).dynamic_from == "geometry"
    found = load_ratings(bearing(preset="DGB7-MASTA"))
    assert (found.dynamic, found.dynamic_from, found.static_from) == (23400.0, "catalogue", "geometry")


def test_other_balls_change_a_printed_rating_by_the_formula():
    found = load_ratings(bearing(preset="7014C", ball_count=19))
    assert found.dynamic == pytest.approx(47e3 * (19 / 20) ** (2 / 3), rel=1e-12)
    assert found.static == pytest.approx(43e3 * 19 / 20, rel=1e-12)
    column = with_values(bearing(preset="7014C"), conformity_inner=np.array([0.522, 0.53]))
    each = [load_ratings(bearing(preset="7014C", conformity_inner=f)).dynamic for f in (0.522, 0.53)]
    np.testing.assert_allclose(load_ratings(column).dynamic, each, rtol=1e-14)
    assert each[0] == pytest.approx(47e3, rel=1e-12) and each[1] < each[0]


def test_a_clearance_alone_is_a_nominal_angle_of_zero():
    assert load_ratings(bearing(preset="DGB7-MASTA", radial_clearance=3e-5)).row.angle == 0.0


def test_ceramic_balls_lower_the_static_rating_only():
    ceramic = bearing(preset="7014C", balls={"material": "Si3N4"})
    steel, hybrid = load_ratings(bearing(preset="7014C")), load_ratings(ceramic)
    shares = [(1.0 - part.poisson**2) / part.young for part in (ceramic.rings, ceramic.balls)]
    assert hybrid.modulus == pytest.approx(1.0 / sum(shares), rel=1e-12)
    assert hybrid.dynamic == steel.dynamic == 47000.0
    assert hybrid.static == pytest.approx(steel.static * (steel.modulus / hybrid.modulus) ** 2, rel=1e-12)


def test_rows_of_other_bearings_have_their_own_ratings():
    rows = [{"preset": "7014C"}, {"preset": "7014A5", "static_rating": 4e4}, {"preset": "7014C", "ball_diameter": 0.0115}]
    pair = bearing(arrangement="++-", row=rows, row_distance=0.02)
    first, second, third = (load_ratings(row) for row in pair.of_rows)
    assert (first.dynamic, second.dynamic) == (47e3, 44.5e3)
    assert (second.static, second.static_from) == (4e4, "key")
    assert third.dynamic == pytest.approx(47e3 * (0.0115 / 0.0119) ** 1.8, rel=0.02)
    # A rating of the set belongs to its balls.
    pair = bearing(preset="7014C", dynamic_rating=5e4, arrangement="DB", row=[{}, {"ball_diameter": 0.0115}])
    assert [load_ratings(row).dynamic_from for row in pair.of_rows] == ["key", "catalogue"]


def test_steep_bearings_need_a_rating():
    steep = {**BARE, "contact_angle_deg": 60.0}
    assert load_ratings(bearing(**steep)).missing.startswith("bearing.dynamic_rating is missing")
    assert load_ratings(bearing(**steep, dynamic_rating=1e5)).missing == load_ratings(bearing(**BARE)).missing == ""


@pytest.mark.parametrize("key", ["dynamic_rating", "static_rating"])
@pytest.mark.parametrize(
    ("value", "words"), [(0.0, "must be greater than 0"), (-3.0, "must be greater than 0"), ("3 mm", "a number in N")]
)
def test_ratings_that_are_none_are_refused(key, value, words):
    with pytest.raises(SceneError, match=words) as caught:
        bearing(preset="7014C", **{key: value})
    assert [mistake.path for mistake in caught.value.mistakes] == [f"bearing.{key}"]
