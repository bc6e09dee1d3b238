"""``raceway study article``: files, resumption, failures and bad input, on small grids."""

import csv
import json
import re

import attrs
import pytest
from article_study import curves, row, study
from raceway_article import rows
from raceway_article import study as driver
from raceway_article.design import ARTICLE, FRICTIONS, ROTATING, Setting, article_tables, design, shaft_tilt_stiffness
from raceway_article.figures import Picture, drawings
from raceway_article.page import page

from checks.validation.command_line import EXAMPLES, SMALL_ARTICLE, invoke
from checks.validation.figures import assert_readable
from raceway import ConvergenceError
from raceway.core.periodic.branches import chosen
from raceway.extend import FAILED, Attractor, default_registry, read_toml


@pytest.fixture
def quick(monkeypatch):
    """Leave out what other tests compute: static pressures, and all but two tilt stiffnesses and one trend."""
    monkeypatch.setattr(driver, "_static_pressures", lambda *_: [])
    monkeypatch.setattr(driver, "STIFFNESSES", (1e3, 1e6))
    monkeypatch.setattr(driver, "TRENDS", dict(list(driver.TRENDS.items())[-1:]))


@pytest.mark.parametrize("case", driver.TRENDS)
def test_quasi_static_trends_are_those_of_an_independent_solver(case):
    """To its printed digits, in the article's model: no gyroscopic moments, no growth of the rings."""
    trend = driver.trend(case, driver.secants(case, default_registry()))
    assert trend.holds, trend


@pytest.mark.slow
def test_small_study_writes_everything_and_goes_on_where_it_stopped(tmp_path, quick, monkeypatch):
    done = []
    real = driver.rows_of_curve

    def stop(points, registry):
        if len(done) == 30:
            raise KeyboardInterrupt
        done.append(1)
        return real(points, registry)

    stop.__qualname__ = real.__qualname__  # a part of the key of finished work
    monkeypatch.setattr(driver, "rows_of_curve", stop)
    words = ("study", "article", *SMALL_ARTICLE, "--out", tmp_path)
    found = invoke(*words)
    assert found.exit_code == 130
    assert "the same command continues" in found.stderr
    monkeypatch.setattr(driver, "rows_of_curve", real)
    found = invoke(*words, "--json")
    assert found.exit_code == 0
    content = json.loads(found.stdout)
    assert content["cost"]["reused"] >= len(done)
    assert content == json.loads((tmp_path / "article.json").read_text(encoding="utf-8"))
    assert {path.name for path in tmp_path.iterdir()} == {
        "article.json", "points.sqlite", ".lock", "curves.csv", "verdicts.csv", "quasi-static.csv", "static.csv", "rig.csv",
        "tilt-stiffness.csv", "friction.csv",
    }  # fmt: skip
    with (tmp_path / "curves.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    # The mixed pairs at the first and the last load: the scene has 1000 N.
    assert len(table) == len(content["rows"]) == 12 * 9 + 12 * 6
    assert all(row["status"] == "completed" and float(row["k"]) > 0.0 for row in table)
    verdicts = {one["number"]: one for one in content["verdicts"]}
    assert verdicts["1a"]["kind"] == "cannot be tested"
    # Three speeds have no exponent with an interval: where K rises, nothing is said.
    assert verdicts["4"]["kind"] == "does not hold" and verdicts["4"]["failed"].startswith("tilt free")
    assert verdicts["6b"]["verdict"] == "holds only for tilt free" and verdicts["6a"]["kind"] == "holds"
    assert all(one["holds"] for one in content["quasi_static"])
    # |Z| lies below K by the inertia of the mass: 2 kg and the ring's.
    row = next(one for one in content["rows"] if one["tilt"] == "locked" and one["speed_rpm"] == 15000.0)
    assert row["k"] - row["abs_z"] == pytest.approx(2.06 * 1570.8**2, rel=0.01)  # the ring's mass to 1 %


def test_a_run_that_fails_is_shown_as_failed(tmp_path, quick, monkeypatch):
    def fail(*_, **__):
        raise ConvergenceError("no motion was found")

    monkeypatch.setattr(rows, "run", fail)
    monkeypatch.setattr(rows, "_looped", lambda points, _: [None] * len(points))
    monkeypatch.setattr(rows, "attractor_from_rest", lambda _, speed, turns: Attractor(speed, FAILED, turns, why="nothing"))
    found = invoke("study", "article", *SMALL_ARTICLE, "--out", tmp_path)
    assert found.exit_code == 1
    assert "every run failed" in found.stderr and "no motion was found" in found.stderr
    verdicts = json.loads((tmp_path / "article.json").read_text(encoding="utf-8"))["verdicts"]
    assert {one["kind"] for one in verdicts} == {"failed", "cannot be tested"}


@pytest.fixture
def made_page(monkeypatch):
    """The page of invented numbers; its figures are drawn by ``test_figures``."""
    monkeypatch.setattr("raceway.answers.page.svg", lambda figure: b"<svg/>")
    monkeypatch.setattr(Picture, "figure", lambda self: None)

    def make(k, bodies=("rigid", "condensed"), **options) -> str:
        found = study(curves(k, bodies, **options))
        pictures = drawings(found.curves, found.scan)
        return page(found.to_dict(), found.curves.design.scene_load, found.scan, pictures, found.command).html()

    return make


def test_page_of_invented_numbers_has_every_figure_and_every_verdict(made_page):
    text = made_page(lambda s, load, w: 1e5 * load * (1.0 + 0.2 * w * (s.tilt == "free")))
    images = re.findall(r'<img alt="([^"]+)"', text)
    assert len(images) == 70 and all(len(words) > 40 for words in images)
    for words in (  # K rises by a fifth over the speed at every load, which it is proportional to
        "k* (k = K) over w* from 0 to 1, tilt free: rotating, m e w²: 1 to 1.2; unidirectional, constant: 1 to 1.2",
        "K [10⁶ N/m] over w*, tilt free, with ball inertia: 400 N: 40 to 48; 1000 N: 100 to 120",
        "Map of k* over w* and axial load, tilt free: 1.000 to 1.200",
        "over the tilt stiffness, from next to free to next to locked: 400 N: 1.1 to 0.78",
    ):
        assert any(words in image for image in images), words
    assert len(re.findall(r"<td[^>]*>200</td>", text)) == 18  # N/µm at the rig's speeds and loads
    for number in ("1a", "1b", "2", "3a", "3b", "4", "5a", "5b", "5c", "5d", "5e", "6a", "6b", "6c", "6"):
        assert f'<th scope="row">{number}</th>' in text or f'<th scope="row" class="number">{number}</th>' in text
    assert not re.search(r"\bnan\b", re.sub(r'src="[^"]+"', "", text))


@pytest.mark.slow
def test_the_page_says_friction_first_or_that_there_is_none(made_page):
    def k(setting, load, w):
        return 1e8 * (1.0 + {"none": 0.076, "standing": -0.055, "orbiting": 0.027}[setting.friction] * w)

    text = made_page(k)
    assert "Friction, 0.03 in the article, comes first" in text
    assert text.index("comes first") < text.index("Under the rotating force") < text.index("Rule")
    for words in ("+7.60\u202f% without friction", "−5.50\u202f% friction on balls that stand", "+2.70\u202f%"):
        assert words in text, words
    assert text.index("what sticks changes all the time") < text.index("how each was decided")
    text = made_page(lambda s, load, w: 1e8 * (1.0 + w), ("rigid",), friction=0.0)
    assert "All runs are without friction" in text and "Every verdict is without it" in text


def test_friction_is_run_through_time_at_every_other_speed_and_load():
    made = design(article_tables())
    standing, orbiting = (Setting(**ROTATING, tilt="free", inertia=True, bodies="rigid", friction=f) for f in FRICTIONS[1:])
    assert made.friction == 0.03 and standing in made.settings() and orbiting in made.settings()
    assert made.loads_of(standing) == (400.0, 800.0, 1200.0, 1600.0, 2000.0)
    assert made.relative(made.speeds_of(standing)) == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    tables = made.point(orbiting, 400.0, 15000.0, default_registry())
    assert tables["contact"]["friction"] == 0.03 and tables["kinematics"]["orbiting"] is True
    assert tables["integrator"]["kind"] == "newmark" and tables["integrator"]["start"] == "ramp"
    for tilt, held in {"locked": "locked", "free": "free", "shaft": made.shaft}.items():
        tables = made.point(Setting("unidirectional", "constant", tilt, False, "rigid"), 400.0, 15000.0, default_registry())
        assert (tables["supports"]["tilt"], tables["kinematics"]["ball_inertia"]) == (held, False)
    scan = next(item.task[2] for item in driver._items(made, default_registry()) if item.name.startswith("tilt stiffness"))
    assert [tables["excitation"]["speed_rpm"] for tables in scan[:2]] == [
        made.speeds[0],
        made.speeds[-1],
    ]  # k* is last over first
    none = design(article_tables(), friction=0.0)
    assert all(setting.friction == "none" for setting in none.settings())
    assert len(design(article_tables(), bodies=("condensed",)).frictions) == 1


def test_friction_on_balls_that_stand_reverses_the_trend_at_a_heavy_load_with_tilt_free():
    made = design(article_tables())
    for friction, sense in (("none", 1.0), ("standing", -1.0), ("orbiting", 1.0)):
        setting = Setting(**ROTATING, tilt="free", inertia=True, bodies="rigid", friction=friction)
        first, last = driver.rows_of_curve(
            [made.point(setting, 2000.0, speed, default_registry()) for speed in (10980.0, 15000.0)], default_registry()
        )
        # The changes are 2.7 to 7.6 %; runs with friction are known to half a percent.
        assert sense * (last["k"] / first["k"] - 1.0) > 0.02, friction


def test_motions_far_from_linear_are_continued_from_the_next_speed_not_searched_for(monkeypatch):
    """800 N, tilt free: the same motions as without a neighbour, with one search for all of them instead of one each."""
    searched, made, registry = [], design(article_tables()), default_registry()
    monkeypatch.setattr("raceway.core.periodic.branches.chosen", lambda *given: searched.append(1) or chosen(*given))
    setting = Setting("unidirectional", "constant", "free", True, "rigid")
    points = [made.point(setting, 800.0, speed, registry) for speed in made.speeds[3:5]]
    first, last = driver.rows_of_curve(points, registry)
    assert len(searched) == 1 and first["status"] == last["status"] == "completed"
    (alone,) = driver.rows_of_curve(points[:1], registry)
    # Both orbits are known to a relative error of 1e-7.
    assert len(searched) == 2 and first["k"] == pytest.approx(alone["k"], rel=1e-7)


def test_the_orbit_that_another_start_with_friction_is_on_is_searched_for_once(monkeypatch):
    """1000 N, tilt free: found without friction, it is what the runs with friction compare their start with."""
    searched, made, registry = [], design(article_tables()), default_registry()
    monkeypatch.setattr("raceway.core.periodic.branches.chosen", lambda *given: searched.append(1) or chosen(*given))
    settings = [Setting("unidirectional", "constant", "free", True, "rigid", friction) for friction in FRICTIONS]
    points = [made.point(setting, 1000.0, 15000.0, registry) for setting in settings]
    rows = driver.rows_of_curve(points, registry)
    assert len(searched) == 1 and [row["found"] for row in rows] == ["from rest", None, None]
    (alone,) = driver.rows_of_curve(points[1:2], registry)
    # The orbit is known to 1e-7 both times, and the start on it to that.
    assert len(searched) == 2 and rows[1]["k"] == pytest.approx(alone["k"], rel=1e-9)
    assert rows[1]["error"] == pytest.approx(alone["error"], abs=1e-7)


@pytest.mark.slow
def test_page_says_what_failed(made_page):
    text = made_page(lambda s, load, w: None if s.tilt == "locked" else (1e8,) if w == 1.0 else 1e8)
    assert "no motion was found" in text and "the steady motion is unstable" in text
    assert '<span class="tone failed">failed</span>' in text


def test_runs_of_scan_and_rig_that_fail_are_listed_and_leave_an_empty_cell(tmp_path):
    found = study(curves(lambda s, load, w: 1e8 * (1.0 + w)))
    # k* = 1.1 - 0.02 n at the nth stiffness is 1 at the fifth.
    assert found.to_dict()["tilt_stiffness"][0]["turning_point"] == pytest.approx(driver.STIFFNESSES[5])
    found.scan[400.0][1] = row(15000.0, 400.0, None, "failed", "no motion, says the scan")
    found = attrs.evolve(found, rig=(*found.rig[1:], {**found.rig[0], **row(11000.0, 400.0, None, "refused", "not so")}))
    assert [one["reason"] for one in found.failed] == ["not so", "no motion, says the scan"]
    found.save(tmp_path)
    with (tmp_path / "tilt-stiffness.csv").open(encoding="utf-8") as file:
        assert [line["k_ratio"] == "" for line in csv.DictReader(file)] == [True] + [False] * 50
    for path in tmp_path.glob("*.csv"):
        assert "nan" not in path.read_text(encoding="utf-8"), path.name


def test_the_scene_that_comes_along_is_the_examples():
    """Only the title and the integrator differ: the study solves for the steady orbit."""
    own, example = read_toml(ARTICLE), read_toml(EXAMPLES / "b7206.toml")
    assert own.pop("integrator") == {"kind": "periodic"}
    assert example.pop("integrator") == {"kind": "auto"}
    assert own.pop("title") != example.pop("title")
    assert own == example


def test_shaft_of_a_known_beam():
    # 2 E I / L with I = pi d^4 / 64: 2 * 212e9 * 3.9761e-8 / 0.175, by hand.
    assert shaft_tilt_stiffness() == pytest.approx(9.6335e4, rel=1e-4)
    assert shaft_tilt_stiffness(diameter=0.060) == pytest.approx(16.0 * shaft_tilt_stiffness())


@pytest.mark.parametrize(("words", "told"), [
    (("--speeds", "15000,10980"), "`--speeds`"), (("--speeds", "10980:15000"), "`--speeds`"),
    (("--axial", "400,800"), "at least three"), (("--axial", "0,400,800"), "above 0"),
    (("--axial", "a,b,c"), "above 0"), (("--shaft", "-1"), "`--shaft`"), (("--friction", "-1"), "`--friction`"),
    (("--set", "bearing.prest=1"), "preset"), (("--plugin", "missing.py"), "missing.py"),
    (("no-such.toml",), "no such file"), (("--bodies", "soft"), "soft"),
])  # fmt: skip
def test_bad_input_is_told_before_anything_is_run(tmp_path, monkeypatch, words, told):
    monkeypatch.setattr(driver, "work_through", lambda *_: pytest.fail("something was run"))
    found = invoke("study", "article", *words, "--out", tmp_path)
    assert found.exit_code == 2
    assert told in found.stderr


def test_a_scene_without_unbalance_is_refused(tmp_path):
    text = (EXAMPLES / "b7206.toml").read_text(encoding="utf-8")
    scene = tmp_path / "static.toml"
    scene.write_text(re.sub(r"\[excitation\].*?(?=\n\[)", "", text, flags=re.DOTALL), encoding="utf-8")
    found = invoke("study", "article", scene, "--out", tmp_path / "out")
    assert found.exit_code == 2 and "`excitation.unbalance`" in found.stderr


@pytest.mark.slow
def test_its_pictures_are_readable():
    """An unstable motion a hundred times as stiff as the rest."""

    def k(setting, load, w):
        return (1e10,) if setting.tilt == "free" and w > 0.9 else 1e8 * (1.0 + 0.1 * w)

    found = study(curves(k))
    assert_readable([panel.figure() for panel in drawings(found.curves, found.scan)])
