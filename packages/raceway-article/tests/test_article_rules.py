"""Rules and verdicts of the article's claims on invented numbers: every verdict can be reached."""

import numpy as np
import pytest
from article_study import curves, static
from raceway_article import courses
from raceway_article.claims import region_of, verdict_of, verdicts
from raceway_article.courses import power_exponent
from raceway_article.rules import FAILED, HOLDS, NOT, PARTLY, UNTESTED, Finding

W = np.linspace(0.0, 1.0, 9)
SMALL = np.full(9, 1e-9)
NONE = np.zeros(9, dtype=bool)


def _verdicts(k, deviation=0.001, **words):
    return {one.number: one for one in verdicts(curves(k, **words), static(deviation))}


def _as_the_article_says(setting, load, w):
    """k that makes all of claims 3, 4 and 6 true: hardening by a square, more of it with axial load."""
    if setting.direction == "unidirectional":
        return 1e8 * (load / 400.0) ** 0.3 * (1.0 - 0.1 * w)
    return 1e8 * (load / 400.0) ** 0.3 * (1.0 + 0.9 * load / 2000.0 * w * w)


def test_all_claims_that_can_hold_do_where_the_numbers_are_the_articles():
    found = _verdicts(_as_the_article_says)
    numbers = ("3a", "3b", "4", "4b", "6a", "6b", "6c", "6", "4 |Z|", "4b |Z|", "6a |Z|", "6b |Z|", "6c |Z|", "6 |Z|")
    assert {number: found[number].kind for number in numbers} == dict.fromkeys(numbers, HOLDS)
    # A square in w* is no square in the speed itself.
    assert found["4a"].kind == NOT and "intervals from" in found["4a"].computed
    assert not any(one.failed or one.region for one in found.values())


def test_the_reverse_of_every_claim_does_not_hold():
    found = _verdicts(
        lambda s, load, w: 1e8 * (load / 400.0) ** -0.3 * (1.0 - 0.2 * w) ** (1 if s.direction == "bidirectional" else -1),
        0.05,
    )
    for number in ("3a", "3b", "4", "4a", "4b", "5a", "5b", "5d", "6a", "6b", "6c", "6"):
        assert found[number].kind == NOT, number


@pytest.mark.parametrize("deviation", [0.001, 0.05])
def test_what_the_article_has_lost_cannot_be_tested_whatever_is_computed(deviation):
    found = _verdicts(_as_the_article_says, deviation)
    for number in ("1a", "1b", "2"):
        assert found[number].kind == UNTESTED and not found[number].region, number
    assert f"{deviation:.2%}" in found["1a"].computed and f"{deviation:.2%}" in found["1b"].computed


def test_a_straight_line_is_not_quadratic():
    found = _verdicts(lambda setting, load, w: 1e8 * (1.0 + 0.3 * w))
    assert [found[number].kind for number in ("4", "4a", "4b", "6b")] == [NOT, NOT, NOT, HOLDS]
    assert "p = 1.00 to 1.00" in found["4a"].computed and "p = 1.00 to 1.00" in found["4b"].computed


def test_a_law_in_the_square_of_the_speed_is_quadratic_in_the_speed_alone():
    def k(setting, load, w):
        return 1e8 * (1.0 + (10980.0 + 4020.0 * w) ** 2 / 15000.0**2)

    found = _verdicts(k, friction=0.0)
    assert [found[number].kind for number in ("4", "4a", "4b")] == [HOLDS, HOLDS, NOT]


def test_a_fall_is_no_rise_by_the_same_percentage():
    found = _verdicts(lambda s, load, w: 1e8 * float(np.interp(w, [0.0, 0.25, 1.0], [1.0, 0.92, 0.66])))
    assert found["5b"].kind == NOT and "-34.0 %" in found["5b"].computed


def test_friction_is_an_axis_that_a_verdict_names():
    def k(setting, load, w):
        return 1e8 * (load / 400.0) ** 0.3 * (1.0 + (0.3 if setting.friction != "standing" else -0.3) * w * w)

    found = _verdicts(k)["6b"]
    assert found.kind == PARTLY and found.region == "without friction or friction on balls that orbit"
    assert "Friction on balls that stand: tilt locked: 0.700" in found.computed
    # With friction a change within what its runs are known to is none.
    level = _verdicts(lambda s, load, w: 1e8 * (load / 400.0) ** 0.3 * (1.0 + 0.006 * w))["6b"]
    assert level.region == "without friction"


def test_exponents_and_their_intervals():
    x = np.linspace(0.1, 1.0, 9)
    none = np.zeros(9)
    for p in (1.0, 2.0, 3.7):
        for constant in (False, True):
            found = power_exponent(x, 4.0 * constant + 0.3 * x**p, none, constant)
            assert abs(found.value - p) <= 0.011 and found.high - found.low < 0.05, "the grid's step"
            assert found.roughly_quadratic is (p == 2.0)
    noisy = power_exponent(x, 0.3 * x**2, np.full(9, 0.1), False)
    assert noisy.low < 1.0 < noisy.high and not noisy.roughly_quadratic
    assert power_exponent(x[:3], x[:3], none[:3], True) is None
    gap = np.where(np.arange(9) == 4, np.nan, x**2)
    assert power_exponent(x, gap, none, False).roughly_quadratic


def test_a_claim_that_holds_in_a_region_names_it_and_mentions_nothing_else():
    def k(setting, load, w):
        rises = setting.tilt == "free" and load < 1500.0
        return 1e8 * (1.0 + (0.1 * w + 0.2 * w * w) * (1.0 if rises else -1.0))

    found = _verdicts(k, bodies=("rigid", "condensed"))
    assert found["4"].kind == PARTLY
    assert found["4"].region == "tilt free, 400 to 1000 N"


@pytest.mark.parametrize("lost", ["failed", "unstable"])
def test_a_failed_run_is_shown_as_failed_and_never_counts_as_holding(lost):
    def k(setting, load, w):
        value = _as_the_article_says(setting, load, w)
        if setting.tilt == "locked" and setting.inertia and load == 400.0 and w == 1.0:
            return None if lost == "failed" else (value,)
        return value

    found = _verdicts(k)
    for number in ("3a", "4", "6b"):
        assert found[number].kind == PARTLY, number
        assert found[number].failed.startswith("without friction, tilt locked, with ball inertia"), number
        assert "15000 r/min" in found[number].failed
    assert "400 N" in found["4"].failed


def test_a_claim_without_a_single_number_has_failed():
    found = _verdicts(lambda *_: None, None)
    for number in ("3a", "3b", "4", "4a", "4b", "5a", "5b", "5c", "5d", "5e", "6a", "6b", "6c", "6", "6 |Z|"):
        assert found[number].kind == FAILED, number
        assert found[number].failed.startswith("everywhere"), number
    assert found["1a"].kind == FAILED and "no equilibrium" in found["1a"].failed


@pytest.mark.parametrize(("number", "k"), {
    "5a": lambda load, w: np.interp(w, [0.0, 0.25, 0.75, 1.0], [1.0, 1.08, 1.1, 1.1 * 1.34]),
    "5b": lambda load, w: np.interp(w, [0.0, 0.25, 1.0], [1.0, 1.08, 1.34]),
    "5c": lambda load, w: 1.0 + (load - 400.0) / 1600.0 * np.interp(w, [0.0, 0.25, 0.75, 1.0], [0.08, 0.08, 0.34, 0.34]),
    "5d": lambda load, w: (load / 400.0) * (1.0 + (load - 400.0) / 1600.0 * np.interp(w, [0.0, 0.25, 1.0], [0.0, 0.08, 0.34])),
}.items())  # fmt: skip
def test_each_reading_of_claim_5_can_hold(number, k):
    found = _verdicts(lambda setting, load, w: 1e8 * float(k(load, w)))
    assert found[number].kind == HOLDS


def test_about_takes_a_quarter_and_no_more():
    assert courses.is_about(0.0601, 0.08) and courses.is_about(0.0999, 0.08)
    assert not courses.is_about(0.0599, 0.08) and not courses.is_about(0.1001, 0.08)


def test_courses():
    for expected, values in {
        "rises": 1.0 + W, "falls": 2.0 - W, "level": 1.0 + 0.004 * W, "not monotonic": 1.0 + 0.1 * np.sin(6.0 * W)
    }.items():  # fmt: skip
        assert courses.course(values, SMALL, NONE) == expected
    # A dent within the runs' own errors is none.
    dent = 1.0 + W + np.where(np.arange(9) == 4, -0.2, 0.0)
    assert courses.course(dent, SMALL, NONE) == "not monotonic" and courses.course(dent, np.full(9, 0.1), NONE) == "rises"


def test_an_unstable_motion_at_an_end_leaves_no_judgement_and_one_between_is_bridged():
    values = 1.0 + W
    between, end = values.copy(), values.copy()
    between[3], end[-1] = np.nan, np.nan
    assert courses.course(between, SMALL, NONE) == "rises"
    assert courses.course(end, SMALL, NONE) is None
    assert courses.change_within(W, end, NONE, 0.75, 1.0) is None
    assert courses.load_effect(W, np.stack([values, end]), np.stack([NONE, NONE]), 0.75, 1.0) is None


def test_nothing_is_judged_over_a_failed_run():
    values, failed = 1.0 + W**2, np.arange(9) == 4
    values[failed] = np.nan
    surface, lost = np.stack([values, 2.0 * values]), np.stack([NONE, failed])
    assert courses.course(values, SMALL, failed) is None
    assert courses.change_within(W, values, failed, 0.0, 0.25) is None
    assert courses.load_effect(W, surface, lost, 0.0, 0.25) is None
    assert courses.influence_grows(surface, lost) is None
    assert courses.rises_with_load(np.stack([surface[0], surface[1], 3.0 * values]), np.full((3, 9), 1e-9),
                                 np.stack([NONE, failed, NONE]))[3:6] == [True, None, True]  # fmt: skip


@pytest.mark.parametrize("lost", ["failed", "unstable"])
def test_a_run_missing_between_the_ends(lost):
    """At w* = 0.5 everywhere: failed runs fail every place, unstable motions are bridged."""
    found = _verdicts(
        lambda s, load, w: _as_the_article_says(s, load, w) if w != 0.5 else None if lost == "failed" else (1e8,)
    )
    for number in ("3a", "3b", "4", "5a", "5b", "5c", "5d", "5e", "6b", "6c"):
        assert (found[number].kind == FAILED) is (lost == "failed"), number
        assert found[number].failed.startswith("everywhere") is (lost == "failed"), number
    # At that speed K over the axial load has no number at all; at the others it has all of them.
    assert found["6a"].kind == PARTLY and found["6a"].failed.startswith("12990 r/min")
    assert found["6"].kind == FAILED


def test_regions_in_words():
    def findings(chosen):
        return [
            Finding({"tilt": tilt, "inertia": inertia, "load": load}, chosen(tilt, inertia, load))
            for tilt in ("locked", "shaft", "free") for inertia in (True, False) for load in (400.0, 600.0, 800.0)
        ]  # fmt: skip

    assert region_of(findings(lambda *_: True), True) == "everywhere"
    assert region_of(findings(lambda *_: False), True) == "nowhere"
    assert region_of(findings(lambda tilt, *_: tilt != "free"), True) == "tilt locked or against the shaft"
    assert region_of(findings(lambda t, inertia, load: inertia), True) == "with ball inertia"
    assert region_of(findings(lambda t, i, load: load != 600.0), True) == "400 and 800 N"
    mixed = region_of(findings(lambda tilt, i, load: tilt == "free" or (tilt == "shaft" and load < 700.0)), True)
    assert mixed == "tilt against the shaft, 400 to 600 N; tilt free"


def test_a_verdict_of_nothing_has_failed():
    assert verdict_of("0", "claim", "rule", "text", []).kind == FAILED
