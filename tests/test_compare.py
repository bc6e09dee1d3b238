"""`raceway compare`: axes, kinds that are swapped, failed points, and words that say what the numbers say."""

import json
import math

import attrs
import numpy as np
import pytest

from raceway import Comparison, ConvergenceError, SceneError, compare, scene_from_dict
from raceway.extend import points, tables_at
from raceway.pipeline.uncertainty import combined, of_ratio
from raceway.points import compare as study
from raceway.points.axes import MOST_POINTS, parse_axes
from raceway.points.effects import Row, percent
from raceway.testing import default_registry, run

SCENE = {
    "title": "test",
    "bearing": {"preset": "B7206C"},
    "rotor": {"mass": 2.0},
    "load": {"axial": 1000.0},
    "excitation": {
        "kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 300.0, "unbalance": 6.39e-4,
        "load_share": 0.5,
    },
    "integrator": {"turns": 2, "steps_per_turn": 120},
}  # fmt: skip


def test_lists_and_ranges():
    axes = parse_axes(
        ["a.b=1,2.5,x,true", "load.radial=[0, 0],[1,2]", "s.rpm=10980:15000:5", "q.x=0.5:1:3", "t.w=3:9:1", 'k.n="1:2",z']
    )
    assert [axis.values for axis in axes] == [
        (1, 2.5, "x", True), ([0, 0], [1, 2]), (10980, 11985, 12990, 13995, 15000), (0.5, 0.75, 1.0), (3,), ("1:2", "z"),
    ]  # fmt: skip
    assert all(isinstance(v, int) for v in axes[2].values)
    assert next(points(axes[:1])) == {"a.b": 1}
    assert [list(p.values()) for p in points(parse_axes(["a.b=1,2", "a.c=3,4"]))] == [[1, 3], [1, 4], [2, 3], [2, 4]]


@pytest.mark.parametrize(("vary", "word"), [
    (["load.axial="], "no values"), (["load.axial"], "form"), (["=1,2"], "form"),
    (["load.axial=1,,2"], "empty entry"), (["load.axial=1,1.0"], "duplicated"),
    (["load.axial=1:2:0"], "at least 1"), (["load.axial=1:2:2.5"], "whole number"),
    (["load.axial=1:x:3"], "finite number"), (["load.axial=1:nan:3"], "finite number"),
    (["load.axial=1:2"], "not a range"), (["load.axial=1:2:3,4"], "mixes"),
    (["load.axial=1,2", "load.axial=3,4"], "varied twice"), (["bearing.preset=a,b", "bearing=c,d"], "overlaps"),
    ([f"load.axial=1:2:{MOST_POINTS}", "rotor.mass=1,2"], "fewer values"), ([], "nothing is varied"),
])  # fmt: skip
def test_bad_axes_name_the_axis_and_the_rule(vary, word):
    with pytest.raises(SceneError, match=word) as caught:
        parse_axes(vary)
    assert all(m.path for m in caught.value.mistakes)


@pytest.mark.parametrize(("vary", "word"), [
    ("load.axail=1,2", "did you mean 'axial'"), ("supports.tilt=locked,fre", "did you mean 'free'"),
    ("excitation.kind=bidirectional,unidirectionel", "did you mean 'unidirectional'"),
    ("kinematics.ball_inertia=false,no", "true or false"),
])  # fmt: skip
def test_mistakes_in_the_scene_are_found_before_anything_runs(vary, word, monkeypatch):
    monkeypatch.setattr(study, "run", lambda *_: pytest.fail("it ran"))
    with pytest.raises(SceneError, match=word):
        compare(SCENE, [vary])


def test_swapping_a_kind_leaves_out_what_the_other_does_not_know():
    tables = {**SCENE, "excitation": {**SCENE["excitation"], "whirl": "backward"}}
    notes: list[str] = []
    swapped = tables_at(tables, {"excitation.kind": "unidirectional"}, default_registry(), notes)
    assert "whirl" not in swapped["excitation"] and tables["excitation"]["whirl"] == "backward"
    assert swapped["excitation"] == {**SCENE["excitation"], "kind": "unidirectional"}
    assert len(notes) == 1 and "excitation.whirl = backward" in notes[0]
    kept = tables_at(tables, {"excitation.kind": "bidirectional"}, default_registry())
    assert kept["excitation"]["whirl"] == "backward"
    typo = {**SCENE, "excitation": {**SCENE["excitation"], "wirl": "backward"}}
    with pytest.raises(SceneError, match="wirl"):
        compare(typo, ["excitation.kind=unidirectional,bidirectional"])


def test_an_axis_that_one_kind_does_not_know_is_refused():
    with pytest.raises(SceneError, match=r"excitation\.whirl"):
        compare(SCENE, ["excitation.whirl=forward,backward", "excitation.kind=unidirectional,bidirectional"])


@pytest.fixture(scope="module")
def small() -> Comparison:
    return compare(SCENE, ["excitation.kind=unidirectional,bidirectional", "supports.tilt=locked,free"])


def test_rows_are_plain_runs_in_order_and_only_the_axes_differ(small):
    found = [(row.point["excitation.kind"], row.point["supports.tilt"]) for row in small.rows]
    assert found == [(k, t) for k in ("unidirectional", "bidirectional") for t in ("locked", "free")]
    scenes = []
    for row in small.rows:
        scene = json.loads(json.dumps(row.result["scene"]))
        assert scene["excitation"].pop("kind") == row.point["excitation.kind"]
        assert scene["supports"].pop("tilt") == row.point["supports.tilt"]
        scene["excitation"].pop("whirl", None)
        scene["excitation"].pop("direction_deg", None)
        scenes.append(scene)
    assert all(scene == scenes[0] for scene in scenes)
    alone = run(scene_from_dict(tables_at(SCENE, small.rows[3].point, default_registry())))
    assert alone.identification.equivalent_stiffness == small.rows[3].value("equivalent_stiffness")


def test_effects_and_words_say_what_the_rows_say(small):
    k = np.array([row.value("equivalent_stiffness") for row in small.rows]).reshape(2, 2)
    tilt = 0.5 * math.log(k[0, 1] * k[1, 1] / (k[0, 0] * k[1, 0]))
    effect = next(e for e in small.effects if e["quantity"] == "equivalent_stiffness" and e["term"] == ("supports.tilt",))
    assert effect["log_change"] == pytest.approx(tilt, rel=1e-12)  # rounding
    assert effect["difference"] == pytest.approx(k[:, 1].mean() - k[:, 0].mean(), rel=1e-12)
    text = "\n".join(small.words)
    assert f"supports.tilt from locked to free changes it by {percent(tilt)}" in text
    assert f"{k.min() / 1e6:.2f} and {k.max() / 1e6:.2f} N/µm" in text
    assert "with supports.tilt = locked" in text and all(percent(change) in text for change in np.log(k[1] / k[0]))
    found = small.rows[0].result["identification"]
    force = found["mass_used_kg"] * (2 * math.pi * found["frequency_hz"]) ** 2
    assert f"m = {found['mass_used_kg']:.3f} kg: {force / 1e6:.2f} to" in text


def test_json_table_and_picture(small, tmp_path):
    answer = json.loads(json.dumps(small.to_dict(), allow_nan=False))
    assert [axis["key"] for axis in answer["axes"]] == ["excitation.kind", "supports.tilt"]
    assert len(answer["rows"]) == 4 and answer["rows"][0]["result"]["schema"] == 2
    heads = ["kind", "tilt", "K N/µm", "|Z| N/µm", "K within", "C N s/m", "error %"]
    assert [list(row) for row in small.table()] == [heads] * 4
    (path,) = small.picture(tmp_path)
    assert path.read_bytes()[:4] == b"\x89PNG"


def test_damping_is_a_column_and_is_not_told_where_it_is_not_resolved():
    """c = tau k: C grows with tau at the same K; a dry bearing has none, and a band has two ends."""
    tables = {**SCENE, "integrator": {"turns": 12, "steps_per_turn": 120}}
    found = compare(tables, ["contact.time_constant=1e-5,2e-5"])
    one, two = (row.damping for row in found.rows)
    assert two / one == pytest.approx(2.0, rel=1e-3)
    assert [row["C N s/m"] for row in found.table()] == [f"{value:.4g}" for value in (one, two)]
    assert found.to_xarray().equivalent_damping.values == pytest.approx([one, two], rel=1e-12)
    dry, band = compare(tables, ["contact.damping=0,band"]).rows
    assert dry.damping is None and dry.damping_words == "not resolved"
    assert dry.result["identification"]["equivalent_damping"] is not None
    # Both ends in proportion to the time constants, 0.25e-5 and 2.5e-5 s.
    assert float(band.damping_words.split(" to ")[1]) / band.damping == pytest.approx(10.0, rel=1e-2)


def test_a_failed_point_is_kept_and_the_effects_hold_for_the_rest(monkeypatch):
    def failing(scene, registry):
        if scene.supports.tilt == "free" and scene.excitation.speed_rpm == 13000:
            raise ConvergenceError("no luck")
        return run(scene, registry)

    monkeypatch.setattr(study, "run", failing)
    found = compare(SCENE, ["supports.tilt=locked,free", "excitation.speed_rpm=12000,13000"])
    assert found.rows[3].result == {"status": "failed", "reason": "no luck"}
    assert len(found.rows) == 4 and found.held == {"excitation.speed_rpm": 12000}
    assert [e["term"] for e in found.effects] == [("supports.tilt",)] * 2
    assert any("no luck" in word for word in found.words)
    assert found.table()[3]["K N/µm"] == "failed"
    json.dumps(found.to_dict(), allow_nan=False)


def test_a_refused_combination_is_kept_with_its_reason():
    # 16 balls of 9.525 mm do not fit the pitch circle of 46 mm, 16 balls of 8 mm do.
    found = compare(SCENE, ["bearing.ball_count=12,16", "bearing.ball_diameter=9.525e-3,8e-3"])
    assert [row.result.get("status") for row in found.rows] == [None, None, "refused", None]
    assert "do not fit" in found.rows[2].result["reason"]
    assert found.held == {"bearing.ball_diameter": 8e-3}


def test_static_scenes_are_compared_by_tangents_and_displacement(tmp_path):
    static = {name: table for name, table in SCENE.items() if name != "excitation"}
    found = compare(static, ["load.axial=400,1200", "contact.kind=hertz,penalty"])
    first, last = (row.result["equilibrium"] for row in (found.rows[0], found.rows[2]))
    by_load = next(e for e in found.effects if e["quantity"] == "kxx" and e["term"] == ("load.axial",))
    hertz = math.log(last["stiffness"][0][0] / first["stiffness"][0][0])
    assert {e["quantity"] for e in found.effects} == {"kxx", "kyy", "x"} and by_load["log_change"] > 0.5 * hertz > 0.0
    assert found.words[0].startswith("penalty against hertz: kxx +") and " from 400 to 1200 N" in found.words[0]
    assert found.words[1].startswith("kxx lies between") and "load.axial from 400 to 1200 changes it by +" in found.words[1]
    assert list(found.table()[0]) == ["axial", "kind", "kxx N/µm", "kyy N/µm", "x µm", "kxx within"]
    data = found.to_xarray()
    assert data.kyy.values[0, 0] == first["stiffness"][1][1] and data.x.attrs["units"] == "m"
    (path,) = found.picture(tmp_path)
    assert path.read_bytes()[:4] == b"\x89PNG" and found.plot("x").get_ylabel().startswith("x")
    # Pulled off, x is negative: it has no effects, and is compared all the same.
    pulled = compare({**static, "load": {"axial": 1e-3, "radial": [200.0, 0.0]}}, ["load.radial=[200, 0],[400, 0]"])
    assert {e["quantity"] for e in pulled.effects} == {"kxx", "kyy"} and (pulled.to_xarray().x.values < 0.0).all()


def test_one_value_has_no_effects():
    one = compare(SCENE, ["load.axial=400"])
    assert one.effects == [] and any("one value" in word for word in one.words)


def _synthetic(k_of) -> Comparison:
    """Rows with a made-up K over speed, tilt and amplitude law."""
    kinds = ["excitation.kind=unidirectional,bidirectional", "excitation.amplitude=constant,unbalance"]
    axes = parse_axes([*kinds, "excitation.speed_rpm=10000:14000:3", "supports.tilt=locked,free"])
    rows = []
    for point in points(axes):
        k = k_of(point)
        frequency = point["excitation.speed_rpm"] / 60
        z = k - 2.0 * (2 * math.pi * frequency) ** 2
        found = {
            "equivalent_stiffness": k, "dynamic_stiffness": {"real": z, "imag": 0.0, "abs": abs(z)}, "mass_used_kg": 2.0,
            "frequency_hz": frequency, "equivalent_damping": 0.0, "phase_lag_deg": 0.0, "force_amplitude_n": 1.0,
            "residual": 0.0,
        }  # fmt: skip
        rows.append(Row(point, {"identification": found, "error": {"total": 1e-6}}))
    return Comparison("made up", axes, tuple(rows))


def _k(point, tilt=1.0, law=1.0):
    """Locked falls by 2 % over the speed; free rises by 1 %, by 20 % under the unbalance law; direction does nothing."""
    s = (point["excitation.speed_rpm"] - 10000) / 4000
    if point["supports.tilt"] == "locked" and tilt:
        return 2e8 * 0.98**s
    return 4e7 * (1.2 if point["excitation.amplitude"] == "unbalance" and law else 1.01) ** s


def test_the_error_of_k_is_that_of_z_over_its_own_size():
    row = with_error(_synthetic(_k), 0.5).rows[0]
    z, k = (row.value(name) for name in ("dynamic_stiffness", "equivalent_stiffness"))
    assert z < 0.99 * k and row.error_of("dynamic_stiffness") == 0.5
    assert row.error_of("equivalent_stiffness") == pytest.approx(0.5 * z / k, rel=1e-14)


def test_a_motion_that_is_larger_at_other_frequencies_is_no_basis():
    row = _synthetic(_k).rows[0]
    loud = attrs.evolve(row, result={**row.result, "identification": {**row.result["identification"], "residual": 1.5}})
    assert row.doubt is None and "larger at other frequencies" in loud.doubt


def test_the_words_rank_the_effects_and_tell_the_course_where_an_axis_changes_it():
    made = _synthetic(_k)
    ranking, text = made.words[1], "\n".join(made.words)
    assert ranking.startswith("K lies between 40.00 and 200.00 N/µm. On average, strongest first: supports.tilt from locked")
    assert ranking.index("supports.tilt") < ranking.index("excitation.amplitude")
    assert "K hardly depends on excitation.kind (+0.00 %)" in text
    assert "falls in 4 of 4 settings (-2.0 %)" in text and "rises in 4 of 4 settings (+1.0 % to +20.0 %)" in text


def _made(axes, k_of) -> Comparison:
    """Of any axes; K [N/m] of a point."""
    axes, rows, found = parse_axes(axes), [], _synthetic(lambda point: 0.0).rows[0].result["identification"]
    for point in points(axes):
        k = k_of(point)
        told = {**found, "equivalent_stiffness": k, "dynamic_stiffness": {"real": k, "imag": 0.0, "abs": k}}
        rows.append(Row(point, {"identification": told, "error": {"total": 1e-6}}))
    return Comparison("made up", axes, tuple(rows))


def test_the_first_sentence_says_what_the_table_says_where_speed_is_varied_with_another_axis():
    """A penalty that is a quarter stiffer at every speed is an axis that moves K, though not what speed does to it."""
    axes = ["excitation.speed_rpm=10000:14000:3", "contact.kind=hertz,penalty"]
    stiffer = {"hertz": 1e8, "penalty": 1.25e8}
    made = _made(axes, lambda point: stiffer[point["contact.kind"]] * 0.8 ** (point["excitation.speed_rpm"] / 14000.0))
    first = made.short_words[1]
    assert "contact.kind from hertz to penalty changes it by +25.0 %" in first and "none of the other axes" not in first


def test_the_first_sentence_tells_differences_in_the_order_of_the_axis():
    axes = ["excitation.speed_rpm=10000:14000:3", "contact.kind=hertz,penalty"]
    falling = {10000: 1.2e8, 12000: 1.15e8, 14000: 1.1e8}
    made = _made(axes, lambda p: falling[p["excitation.speed_rpm"]] if p["contact.kind"] == "penalty" else 1e8)
    assert made.words[0].startswith("penalty against hertz: K +20 to +10 % from 10000 to 14000")


@pytest.mark.parametrize(
    ("axes", "k_of", "said"),
    [
        (["load.axial=1000,400,2000,1000.5"], lambda p: 6e4 * p["load.axial"], "changes it by +0.05 % (+0.03 N/µm; to 400 by -60.0 %)"),
        (["contact.kind=hertz,film,penalty"], lambda p: 8e7 if p["contact.kind"] == "film" else 6e7, "by +0.00 % (+0.00 N/µm; to film by +33.3 %)"),
        (
            ["contact.kind=hertz,film,penalty", "supports.tilt=locked,free"],
            lambda p: 6e7 + (p["contact.kind"] == "film") * (2e7 if p["supports.tilt"] == "free" else -2e7),
            "to film by -33.3 % to +33.3 %)",
        ),
        (["load.axial=1000,400,2000", "supports.tilt=locked,free"], lambda p: 6e4 * p["load.axial"] * (0.9 if p["supports.tilt"] == "free" else 1.0),
         "by +100.0 % (+57.00 N/µm; to 400 by -60.0 %); supports.tilt from locked to free changes it by -10.0 %"),
    ],
)  # fmt: skip
def test_what_lies_between_the_ends_of_an_axis_is_told_where_it_is_beyond_them(axes, k_of, said):
    made = _made(axes, k_of)
    k = [1e-6 * k_of(row.point) for row in made.rows]
    ranking = next(words for words in made.words if " lies between " in words)
    assert ranking.startswith(f"K lies between {min(k):.2f} and {max(k):.2f} N/µm. On average")
    assert said in ranking and "of the variation" not in ranking
    assert not any("hardly depends on " + axes[0].partition("=")[0] in words for words in made.words)


def _with_intervals(made, parts_of):
    """The same rows with the interval of K that parts give, relative."""
    rows = []
    for row in made.rows:
        k, causes = row.value("equivalent_stiffness"), {}
        for name, (low, high) in parts_of(row.point).items():
            causes[name] = {"low": low, "high": high, "how": "", "of": []}
        low, high = combined(causes)
        entry = {"low": (1.0 + low) * k, "high": (1.0 + high) * k, "relative": [low, high], "parts": causes}
        rows.append(attrs.evolve(row, result={**row.result, "uncertainty": {"equivalent_stiffness": entry}}))
    return attrs.evolve(made, rows=tuple(rows))


@pytest.mark.parametrize(("data", "numerical", "said"), [
    ((-0.1, 0.2), 1e-6, "both (K within -10 to +20 %); difference within +- 0.00014 %"),
    ((0.0, 0.0), 1e-4, "neither (K within +- 0.01 %); difference within +- 0.014 %"),
    ((-0.008, 0.006), 1e-6, "both at 2 of 3 points (K within -0.8 to +0.6 %); difference within +- 0.00014 %"),
])  # fmt: skip
def test_the_first_sentence_sets_the_difference_of_two_models_against_their_intervals(data, numerical, said):
    """By 0.25, 0.5 and 1 %, where an interval of both is wide, narrow, or between these; on the picture stands the same."""
    axes = ["excitation.kind=unidirectional,bidirectional", "excitation.speed_rpm=9000:15000:3"]
    percents = {9000: 0.25, 12000: 0.5, 15000: 1.0}
    made = _made(
        axes, lambda p: 1e8 * (1.0 + 0.01 * percents[p["excitation.speed_rpm"]] * (p["excitation.kind"] == "bidirectional"))
    )
    found = _with_intervals(made, lambda _: {"numerical": (-numerical, numerical), "data": data})
    start = "bidirectional against unidirectional: K +0.25 to +1 % from 9000 to 15000, within the uncertainty of"
    assert found.words[0] == f"{start} {said} by causes of one alone; of common ones (geometry, hypotheses) not estimated."
    title = found.draw().get_suptitle().replace("\n", " ")
    own, apart = said.partition(" (")[2].rstrip(".").split("); ")
    assert f"shaded: {own}, {apart} by causes of one alone; of common ones (geometry, hypotheses) not estimated" in title


def test_a_cause_that_changes_both_alike_leaves_their_ratio_and_one_that_does_not_is_in_its_interval():
    """Elastic rings in one model only; errors of two solutions; inferred numbers of one bearing and of two."""
    cause = {"how": "", "of": []}
    rigid = {"parts": {"numerical": {"low": -3e-3, "high": 3e-3, **cause}, "data": {"low": -0.1, "high": 0.2, **cause},
                       "bodies": {"low": 0.0, "high": 0.08, **cause}}}  # fmt: skip
    other = {"numerical": {"low": -4e-3, "high": 4e-3, **cause}}
    elastic = {"parts": {**rigid["parts"], **other, "bodies": {"low": 0.0, "high": 0.0, **cause}}}
    assert of_ratio(rigid, {"parts": {**rigid["parts"], **other}}, True) == pytest.approx((-5e-3, 5e-3))
    low, high = of_ratio(rigid, elastic, True)
    assert low == pytest.approx(-math.hypot(0.08, 5e-3)) and high == pytest.approx(5e-3)
    low, high = of_ratio(rigid, rigid, False)  # the first may be stiffer while the second is softer
    assert low == pytest.approx(-math.hypot(0.1, 0.2, 3e-3 * math.sqrt(2.0))) and high == pytest.approx(-low)
    unknown = {"parts": {**rigid["parts"], "data": {"low": None, "high": None, **cause}}}
    assert of_ratio(rigid, unknown, False) == pytest.approx((-3e-3 * math.sqrt(2.0), 3e-3 * math.sqrt(2.0)))


def test_no_line_crosses_a_point_that_failed():
    made = _synthetic(_k)
    rows = [
        attrs.evolve(row, result={"status": "failed", "reason": "no luck"}) if ONE.items() <= row.point.items() else row
        for row in made.rows
    ]
    lines = attrs.evolve(made, rows=tuple(rows)).plot().get_lines()
    broken = [line for line in lines if np.isnan(np.asarray(line.get_ydata(), dtype=float)).any()]
    assert len(broken) == 1 and np.isnan(broken[0].get_ydata()[1])


def with_error(made, error, **point):
    """The same, the rows at these places of the axes with another error."""
    rows = [
        attrs.evolve(row, result={**row.result, "error": {"total": error}}) if point.items() <= row.point.items() else row
        for row in made.rows
    ]
    return attrs.evolve(made, rows=tuple(rows))


ONE = {"excitation.kind": "unidirectional", "excitation.amplitude": "constant"}
ONE |= {"excitation.speed_rpm": 12000, "supports.tilt": "free"}


def test_a_doubtful_row_between_the_ends_is_left_out_of_the_course():
    found = with_error(_synthetic(_k), 1.2, **ONE)
    text = "\n".join(found.words)
    assert "doubtful runs between the ends left out: 1" in text and "1 of 24 runs" in text
    assert "the estimated error of K is as large as its value" in text
    assert all(t["trend"] != "not monotonic" for t in found.trends)


def test_one_inexact_corner_hides_no_large_effect():
    found = with_error(_synthetic(_k), 0.03, **{**ONE, "excitation.speed_rpm": 10000})
    assert not found.held and all(row.doubt is None for row in found.rows)
    by_term = {e["term"]: e for e in found.effects if e["quantity"] == "equivalent_stiffness"}
    assert by_term["supports.tilt",]["resolved"] and not by_term["excitation.kind",]["resolved"]
    text = "\n".join(found.words)
    assert "supports.tilt from locked to free changes it by -78.8 %" in text
    # 2 / 16 of -ln(1 - 0.03 |Z| / K), K = 40 and |Z| = 37.8 N/µm at the corner; |Z| itself a little more.
    assert "the runs' own errors move them by at most 0.38 %" in text
    assert "K hardly depends on excitation.kind" in text  # 0 +- 0.36 % is surely below 0.5 %


def test_a_small_effect_within_the_errors_is_not_told_as_one():
    axes = parse_axes(["excitation.kind=unidirectional,bidirectional", "supports.tilt=locked,free"])
    made = _synthetic(lambda point: 0.0)
    stiffness = [2.342e8, 0.355e8, 2.339e8, 0.361e8]
    rows = []
    for point, k in zip(points(axes), stiffness, strict=True):
        found = {**made.rows[0].result["identification"], "equivalent_stiffness": k}
        found["dynamic_stiffness"] = {"real": k, "imag": 0.0, "abs": k}
        rows.append(Row(point, {"identification": found, "error": {"total": 0.021 if k == 0.355e8 else 1e-6}}))
    text = "\n".join(Comparison("made up", axes, tuple(rows)).words)
    assert "K lies between 35.50 and 234.20 N/µm. On average supports.tilt from locked to free changes it by -84.7 %" in text
    assert (
        "within the runs' errors of 1.1 % and so not resolved: excitation.kind (+0.78 %; with supports.tilt = locked -0.13 %)"
        in text
    )
    assert "K: no interaction is resolved from the runs' errors (the largest would be +0.91 %)" in text
    assert "with free by" not in text and "no axis moves it" not in text


def test_finished_runs_are_kept_and_used_again(tmp_path, monkeypatch):
    vary, store = ["excitation.speed_rpm=12000:13000:3"], tmp_path
    whole = compare(SCENE, vary)

    def stop(_what, done, _total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        compare(SCENE, vary, progress=stop, kept=store)
    real, ran = study.run, []
    monkeypatch.setattr(study, "run", lambda scene, registry: ran.append(1) or real(scene, registry))
    found = compare(SCENE, vary, kept=store)
    assert len(ran) == 1

    def numbers(comparison):
        return [row.result["identification"] for row in comparison.rows]

    assert numbers(found) == numbers(whole) and found.words == whole.words
