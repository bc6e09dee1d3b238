"""The band of an answer over tolerances: indices of a published function, a linear answer by hand, and bad input."""

import json

import attrs
import numpy as np
import pytest

import raceway as rw
from checks.validation.command_line import invoke
from raceway import SceneError, scene_from_dict
from raceway.extend import default_registry, stated_columns, tolerances_of
from raceway.pipeline.first_order import limits
from raceway.points.sensitivities import design, indices
from raceway.testing import b7206c, band_of_samples

LOADED = b7206c(load={"axial": 500.0})


def test_indices_of_ishigamis_function_are_the_closed_form():
    """Ishigami, Homma (1990): a = 7, b = 0.1 on [-pi, pi]^3."""
    a, b = 7.0, 0.1
    x = np.pi * (2.0 * design(4096, 3, seed=3) - 1.0)
    y = np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0])
    found = indices(y[None], 3)
    v1, v2, v13 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    whole = v1 + v2 + v13
    assert np.abs(found.first[0] - np.array([v1, v2, 0.0]) / whole).max() < 0.02
    assert np.abs(found.total[0] - np.array([v1 + v13, v2, v13]) / whole).max() < 0.02
    made = band_of_samples("T", (), {"y": 0.0}, {}, [{"y": value} for value in y], 3)
    assert (made.first["y"], made.total["y"]) == (found.first[0].tolist(), found.total[0].tolist())
    shares = [(y[: 2 * 4096] < end).mean() for end in (made.low["y"], made.high["y"])]  # of what is drawn at random
    assert shares == pytest.approx([0.025, 0.975], abs=1e-3)


def test_limits_of_a_sum_of_even_numbers_are_the_closed_forms():
    assert limits([]) == (0.0, 0.0)
    assert limits([(-1.0, 3.0)]) == pytest.approx((1.0 - 1.9, 1.0 + 1.9), abs=1e-3)
    q = 2.0 * (1.0 - np.sqrt(0.05))  # of a triangle
    assert limits([(-1.0, 1.0), (-1.0, 1.0)]) == pytest.approx((-q, q), abs=1e-3)
    many = limits([(-1.0, 1.0)] * 30)[1]
    assert many == pytest.approx(1.96 * np.sqrt(30.0 / 3.0), rel=5e-3)  # tends to the normal distribution


def test_a_result_has_the_band_of_its_tolerances_to_first_order():
    """Against samples: even numbers, an answer that is nearly straight in them."""
    moving = {
        "rotor": {"mass": 2.0},
        "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4},
        "integrator": {"kind": "periodic"},
    }
    own = LOADED | moving | {"tolerances": {"load.axial": "±1 %", "bearing.contact_angle_deg": "+0.1 deg -0.05 deg"}}
    found, samples = rw.run(own).tolerances["quantities"], rw.band(own, count=256)
    # Numbers of plug-ins have no first-order band.
    stated = set(stated_columns(scene_from_dict(own), default_registry()))
    assert set(found) == set(samples.nominal) - stated and "K" in found
    for name, one in found.items():
        width = samples.high[name] - samples.low[name]
        assert one["value"] == pytest.approx(samples.nominal[name], rel=1e-6)
        assert (one["low"], one["high"]) == pytest.approx((samples.low[name], samples.high[name]), abs=0.02 * width)
        assert list(one["shares"].values()) == pytest.approx(samples.first[name], abs=0.02)


def test_results_say_where_no_band_is_known():
    assert rw.run(LOADED).to_dict()["tolerances"] is None
    wide = LOADED | {"tolerances": {"load.axial": "±10 %", "contact.friction": "+0.1 -0"}}
    found = rw.run(wide).to_dict()["tolerances"]
    assert [one["key"] for one in found["left_out"]] == ["contact.friction"] and found["quantities"]["kxx"]["low"] > 0.0


def test_the_scenes_own_table_is_read_and_checked():
    own = LOADED | {"tolerances": {"load.axial": "±10 %", "bearing": {"contact_angle_deg": "+1 deg -0.5 deg"}}}
    ranges = {one.key.path: (one.low, one.high) for one in rw.band(own, count=2).tolerances}
    assert ranges["load.axial"] == pytest.approx((450.0, 550.0))
    assert ranges["bearing.contact_angle_deg"] == pytest.approx((14.5, 16.0))
    assert rw.run(own).stiffness[0, 0] == rw.run(LOADED).stiffness[0, 0]
    wrong = rw.check(LOADED | {"tolerances": {"load.axail": "±10 %"}})
    assert [one.path for one in wrong.mistakes] == ["tolerances.load.axail"] and "load.axial" in wrong.mistakes[0].message


FITTED = LOADED | {"mounting": {"shaft_interference": 4e-6, "housing_interference": 20e-6}}


@pytest.mark.parametrize(
    ("name", "bore", "outer"), [("P4", 5.0, 7.0), ("ABEC 7", 5.0, 7.0), ("P5", 6.0, 9.0), ("P0", 10.0, 13.0)]
)
def test_a_class_by_name_is_what_its_table_makes_of_the_fits(name, bore, outer):
    """ISO 492 for a bore of 30 mm, the last of its row, and an outside diameter of 62 mm: rings may be smaller, never larger."""
    ranges = {one.key.path: (one.low, one.high) for one in tolerances_of(scene_from_dict(FITTED), {"class": name})}
    assert ranges == {
        "mounting.shaft_interference": pytest.approx((4e-6, (4.0 + bore) * 1e-6)),
        "mounting.housing_interference": pytest.approx(((20.0 - outer) * 1e-6, 20e-6)),
    }


def test_a_tighter_class_makes_a_narrower_band():
    fitted = LOADED | {"mounting": {"shaft_interference": 4e-6}}
    wide, narrow = (rw.band(fitted, {"class": name}, count=32) for name in ("Normal", "P4"))
    assert wide.high["kxx"] - wide.low["kxx"] == pytest.approx(
        (10.0 / 5.0) * (narrow.high["kxx"] - narrow.low["kxx"]), rel=0.2
    )  # deviations of 10 and 5 µm; stiffness is no line of the fit


def test_balls_of_a_grade_differ_by_the_variation_of_their_lot():
    (one,) = tolerances_of(scene_from_dict(LOADED), ["balls=G5"])
    assert one.key.path == "bearing.ball_diameter" and one.high - one.low == pytest.approx(0.25e-6)


BAD = [
    ({"class": "P4"}, "changes nothing here"), ({"class": "P3"}, "must be one of Normal"),
    ({"balls": "5"}, "must be one of G3"), (["class=P4", "class=P5"], "changes nothing here"),
    ({}, "none is given"), (["load.axial"], "KEY=TEXT"), ({"load.axial": "10"}, "must be text such as"),
    ({"load.axial": "±0 N"}, "empty"), ({"load.axial": "±1 m"}, "must be text such as"),
    ({"bearing.ball_count": "±1"}, "no continuous key"), ({"bearing.conformity_inner": "±0.1"}, "reaches 0.422"),
    (["load.axial=±1 N", "load.axial=±2 N"], "two tolerances"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "words"), BAD)
def test_what_is_no_tolerance_is_refused_in_one_sentence(given, words):
    with pytest.raises(SceneError, match=words):
        tolerances_of(scene_from_dict(LOADED), given)


def test_samples_without_an_answer_are_counted_and_no_indices_told():
    """Large balls fit the pitch circle, and so do balls a smaller one; some samples have large balls on a small circle."""
    band = rw.band(LOADED, {"bearing.ball_diameter": "+2.2 mm -0.1 mm", "bearing.pitch_diameter": "+0.1 mm -2 mm"}, count=16)
    assert 0 < band.lost < band.samples == 64
    assert "do not fit" in band.why and band.total == {} and band.low["kxx"] < band.high["kxx"]


TURNING = {
    "rotor": {"mass": 2.0, "damping": 200.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4}, "supports": {"tilt": 1e4},
}  # fmt: skip
TWO_WAYS = [
    ({}, {"bearing.ball_diameter": "+2.2 mm -0.1 mm", "bearing.pitch_diameter": "+0.1 mm -2 mm"}),  # some balls do not fit
    ({"mounting": {"shaft_interference": 4e-6}}, {"class": "P4", "load.radial[0]": "+50 N -0 N"}),
    (TURNING, {"load.axial": "±20 %", "supports.tilt": "±10 %", "excitation.speed_rpm": "±5 %"}),
    # Some have no C that is resolved.
    pytest.param(TURNING | {"rotor": {"mass": 2.0, "damping": 1e-6}}, {"rotor.damping": "+200 -0"}, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("tables", "tolerances"), TWO_WAYS)
def test_compiled_loops_give_what_samples_one_by_one_give(tables, tolerances, monkeypatch):
    looped = rw.band(LOADED | tables, tolerances, count=4)
    monkeypatch.setattr("raceway.points.band._loop_rows", lambda scene, paths, numbers, nominal: [{}] * len(numbers))
    single = rw.band(LOADED | tables, tolerances, count=4)
    assert (looped.samples, looped.lost, looped.why) == (single.samples, single.lost, single.why)
    for name in ("nominal", "low", "high", "first", "total"):
        a, b = (getattr(one, name) for one in (looped, single))
        assert list(a) == list(b)
        for key, number in a.items():
            # Of a K that moves by 1e-11 of itself, the last scene's, shares of variance are those of rounding.
            assert number == pytest.approx(b[key], rel=1e-6, abs=1e-5 if name in ("first", "total") else 0.0), (name, key)


@pytest.mark.parametrize("count", [3, 1])
def test_counts_are_powers_of_two(count):
    with pytest.raises(SceneError, match="power of 2"):
        rw.band(LOADED, {"load.axial": "±1 %"}, count=count)


CLASSES = [
    ({"mounting": {"shaft_interference": 4e-6}}, ["class=P4", "class=P5"], "two tolerances"),
    ({"mounting": {"shaft_interference": 4e-6}}, ["class=P4", "mounting.shaft_interference=±1 µm"], "two tolerances"),
    ({"mounting": {"housing_interference": 4e-6}}, ["class=P4"], "leaves outer rings loose"),
    (
        {"bearing": {"preset": "B7206C", "bore": 2e-3}, "mounting": {"shaft_interference": 1e-6}},
        ["class=P4"],
        "2.5 to 80 mm",
    ),
]


@pytest.mark.parametrize(("tables", "given", "words"), CLASSES)
def test_what_a_class_cannot_say_is_refused(tables, given, words):
    with pytest.raises(SceneError, match=words):
        tolerances_of(scene_from_dict(LOADED | tables), given)


def test_people_read_newtons_per_micrometre_and_files_hold_the_histogram(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "scene.toml"
    file.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n[tolerances]\n"load.axial" = "±10 %"\n')
    told = invoke("band", str(file), "--samples", "16", "--processes", "0")
    (folder,) = (tmp_path / "raceway-out").iterdir()
    assert folder.name.endswith("-band")  # beside that of a run of the scene
    content = json.loads((folder / "band.json").read_text())["quantities"]["kxx"]
    row = next(line for line in told.output.splitlines() if line.startswith("kxx [N/µm]"))
    shown = [1e-6 * content[name] for name in ("value", "low", "high")]
    assert [float(number) for number in row.split()[2:5]] == pytest.approx(shown, rel=1e-4)
    edges, counts = content["histogram"]["edges"], content["histogram"]["counts"]
    assert sum(counts) == 32 and edges[0] < content["low"] < content["high"] < edges[-1]
    assert (folder / "band.png").stat().st_size > 0


def test_the_command_goes_on_with_what_is_kept(tmp_path):
    """Of samples that need runs of their own: contacts rub."""
    file = tmp_path / "scene.toml"
    file.write_text(
        '[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n[contact]\nfriction = 0.05\n[tolerances]\n"load.axial" = "±10 %"\n'
    )
    words = ["band", str(file), "--out", str(tmp_path), "--samples", "2", "--processes", "0", "--no-pictures"]
    first = invoke(*words)
    assert first.exit_code == 0, first.output
    kept = (tmp_path / "points.sqlite").read_bytes()
    told = (tmp_path / "band.json").read_text()
    assert invoke(*words).exit_code == 0
    assert (tmp_path / "points.sqlite").read_bytes() == kept and (tmp_path / "band.json").read_text() == told


def test_a_nominal_answer_outside_its_band_and_rough_indices_are_told():
    band = rw.band({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, {"load.axial": "±5 %"}, count=16)
    assert not [text for text in band.remarks if "outside" in text]
    elsewhere = attrs.evolve(band, nominal={name: 10.0 * value for name, value in band.nominal.items()})
    assert any("lies outside the band" in text and "kxx" in text for text in elsewhere.remarks)
    rough = attrs.evolve(band, total={"kxx": [1.2]})
    assert any("--samples" in text for text in rough.remarks)
