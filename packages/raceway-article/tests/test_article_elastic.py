"""``raceway study article --bodies elastic``: files, resumption, refused options, failures, and numbers of single runs, on tiny meshes."""

import copy
import csv
import json
import re
import tomllib

import attrs
import pytest
from article_study import elastic_study
from raceway_article import elastic, elastic_design, elastic_page, elastic_rows
from raceway_article.elastic_design import SCENE, ElasticDesign, design
from raceway_article.elastic_page import drawings, page
from raceway_article.remaining_time import RemainingTime

import raceway as rw
from checks.validation.command_line import EXAMPLES, invoke
from raceway import ConvergenceError, SceneError
from raceway.extend import read_toml
from raceway.testing import default_registry

#: Three balls under a penalty so soft that every load case has an equilibrium: every path, no accuracy.
CHANGES = {
    "bearing.ball_count": 3, "bodies.formulation": "one_point", "mesh.element_size": 3.2e-3, "mesh.nodes_per_semi_axis": 1,
    "mesh.azimuth_cells": 24, "mesh.growth": 3.0, "mesh.patch": 0.5, "mesh.ball_load": 3e3, "contact.stiffness": 3e13,
    "rotor.mass": 0.5, "excitation.unbalance": 6.39e-5,
}  # fmt: skip
WORDS = ("study", "article", "--bodies", "elastic", *(w for k, v in CHANGES.items() for w in ("--set", f"{k}={v}")))


def tables(**more):
    found = read_toml(SCENE)
    for key, value in {**CHANGES, **more}.items():
        table, name = key.split(".")
        found[table] = {**found[table], name: value}
    return found


@pytest.fixture
def short(monkeypatch):
    """One load case, one excitation, a dozen steps: seconds."""
    monkeypatch.setattr(ElasticDesign, "load_cases", property(lambda _: [(1000.0, 500.0)]))
    monkeypatch.setattr(elastic_design, "CLAIMED", elastic_design.CLAIMED[:1])
    for module in (elastic, elastic_design):
        monkeypatch.setattr(module, "STEPS", 12)


def test_the_scene_is_the_article_s_mesh_of_the_examples():
    with (EXAMPLES / "b7206_article_mesh.toml").open("rb") as file:
        example = tomllib.load(file)
    found = read_toml(SCENE)
    assert all(found[name] == example[name] for name in ("bearing", "mesh", "contact", "bodies"))
    article = read_toml(SCENE.with_name("article.toml"))
    assert found["excitation"] == article["excitation"] and found["rotor"] == article["rotor"]


@pytest.mark.slow
def test_the_command_goes_on_where_it_stopped_and_tells_the_numbers_of_single_runs(tmp_path, short, monkeypatch):
    done, real = [], elastic.row_of

    def stop(*given):
        if len(done) == 4:
            raise KeyboardInterrupt
        done.append(1)
        return real(*given)

    monkeypatch.setattr(elastic, "row_of", stop)
    words = (*WORDS, "--turns", "1", "--no-pictures", "--out", tmp_path)
    found = invoke(*words)
    assert found.exit_code == 130
    assert found.stderr.count("the same command continues") == 1
    assert (tmp_path / "points.sqlite").is_file()
    monkeypatch.setattr(elastic, "row_of", real)
    found = invoke(*words, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert content["cost"]["reused"] == 4 and content["failed"] == 0
    assert content == json.loads((tmp_path / "article-elastic.json").read_text(encoding="utf-8"))
    assert {path.name for path in tmp_path.iterdir()} == {
        "article-elastic.json", "article-elastic.csv", "points.sqlite", ".lock"
    }  # fmt: skip
    with (tmp_path / "article-elastic.csv").open(encoding="utf-8") as file:
        table = csv.DictReader(file)
        assert [row["bodies"] for row in table] == ["condensed", "rigid", "elastic"] * 2
        names = table.fieldnames
        assert not [name for name in names if any(other.startswith(f"{name}.") for other in names)]
    rows = {(row["phase"], row["bodies"]): row for row in content["rows"]}
    assert rows["static", "elastic"]["cost"]["elements"] == 3120
    assert all(row["cost"]["cpu_s"] > 0.0 and row["cost"]["peak_memory_bytes"] > 1e7 for row in rows.values())
    assert rows["motion", "elastic"]["energy_balance"] < 1e-3  # the limit; it does not depend on the mesh
    # The same scenes by themselves: to the last digit, as nothing of the study is part of a run.
    made = design(tables(), turns=1)
    for run in made.runs():
        if run.phase == "static" or run.bodies == "elastic":
            alone = rw.run(made.point(run, default_registry())).to_dict()
            row = rows[run.phase, run.bodies]
            assert [ball["load_inner_n"] for ball in row["balls"]] == [
                ball["load_inner_n"] for ball in alone["equilibrium"]["balls"]
            ]
            assert row["displacement"] == alone["equilibrium"]["displacement"]
            assert row["kyy_n_per_m"] == alone["equilibrium"]["stiffness"][1][1]
            if run.phase == "motion":
                assert row["identified"]["k"] == alone["identification"]["equivalent_stiffness"]
                assert row["identified"]["c"] == alone["identification"]["equivalent_damping"]
                assert row["energy_balance"] == alone["stability"]["energy_drift"]
    elastic_row, condensed = rows["static", "elastic"], rows["static", "condensed"]
    assert elastic_row["from_condensed"]["x"] == elastic_row["displacement"]["x"] / condensed["displacement"]["x"] - 1.0
    assert condensed["from_condensed"] is None and rows["static", "rigid"]["from_hertz"]["inner"] is None


def test_settings_of_a_motion_are_the_same_for_all_bodies_and_rest_has_no_friction():
    made = design(read_toml(SCENE))
    points = {run: made.point(run, default_registry()) for run in made.runs()}
    assert len(points) == 18
    for run, point in points.items():
        assert point["bodies"]["kind"] == run.bodies
        assert point["contact"].get("friction", 0.0) == (0.0 if run.phase == "static" else 0.03)
        assert ("excitation" in point) == (run.phase == "motion")
    moving = [point for run, point in points.items() if run.phase == "motion"]
    for name in ("integrator", "identifier", "supports", "rotor", "load", "kinematics"):
        assert all(point[name] == moving[0][name] for point in moving)
    assert moving[0]["integrator"]["turns"] == 2 and moving[0]["integrator"]["steps_per_turn"] == 40
    assert {(point["excitation"]["kind"], point["excitation"]["amplitude"]) for point in moving} == {
        ("unidirectional", "constant"), ("bidirectional", "unbalance")
    }  # fmt: skip


def test_explicit_steps_of_the_scene_are_a_fourth_way_under_the_same_settings():
    steps = {"integrator": {"kind": "central_difference", "least_step": 3e-9}}
    made = design(read_toml(SCENE) | steps, turns=1)
    explicit = [run for run in made.runs() if run.explicit]
    assert [run.excitation for run in explicit] == list(elastic_design.CLAIMED) and len(made.runs()) == 20
    for run in explicit:
        point, implicit = (made.point(each, default_registry()) for each in (run, attrs.evolve(run, explicit=False)))
        assert point.pop("integrator") == {"kind": "central_difference", "least_step": 3e-9, "turns": 1}
        assert implicit.pop("integrator")["kind"] == "newmark"
        assert point == implicit


def test_the_picture_of_cost_has_every_way_and_its_difference():
    def row(bodies, integrator, k, cpu):
        numbers = {"identified": {"k": k, "c": 0.0, "abs_z": k}, "identification": {"speed_rpm": 12e3}}
        reference = None if bodies == "condensed" else {"z": abs(k / 2e8 - 1.0)}
        return {"phase": "motion", "case": "unidirectional constant force", "status": "completed", "bodies": bodies,
                "integrator": integrator, "cost": {"cpu_s": cpu}, "from_condensed": reference, "error": {"total": 1e-5}, **numbers}  # fmt: skip

    rows = [row("condensed", "newmark", 2e8, 1.0), row("elastic", "newmark", 2.02e8, 60.0), row("elastic", "central_difference", 2.03e8, 3600.0)]  # fmt: skip
    picture = next(each for each in drawings({"rows": rows}) if each.name == "article-elastic-cost")
    words = picture.panels[0].alternative
    assert "condensed 1.0e-05 in 1 s" in words and "elastic 1.0e-02 in 60 s" in words
    assert "elastic, explicit 1.5e-02 in 3.6e+03 s" in words


@pytest.mark.parametrize(("bodies", "words"), [
    ("elastic", ("--speeds", "11000,12000,13000")), ("elastic", ("--axial", "400,1000,2000")),
    ("elastic", ("--shaft", "1e4")), ("elastic", ("--processes", "2")), ("rigid", ("--turns", "2")),
])  # fmt: skip
def test_an_option_without_effect_is_refused(bodies, words, tmp_path):
    found = invoke("study", "article", "--bodies", bodies, *words, "--out", tmp_path)
    assert found.exit_code == 2
    told = " ".join(found.stderr.split())
    assert f"`{words[0]}`" in told and f"has no effect with --bodies {bodies}" in told and told.count("`--") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("change", "path"), [
    (("excitation", "unbalance", None), "excitation.unbalance"),
    (("contact", "discretisation", "resultant"), "contact.discretisation"), (("load", "axial", 0.0), "load.axial"),
    (("mesh", None, None), "mesh"),
])  # fmt: skip
def test_a_scene_that_the_study_cannot_use_is_refused(change, path):
    found = copy.deepcopy(read_toml(SCENE))
    table, name, value = change
    if name is None:
        del found[table]
    else:
        found[table][name] = value
    with pytest.raises(SceneError, match=re.escape(f"`{path}`")):
        design(found)
    with pytest.raises(SceneError, match="--friction"):
        design(read_toml(SCENE), friction=-0.1)


@pytest.mark.slow
def test_a_run_that_fails_is_a_row_with_its_reason_and_what_the_machine_refused_is_tried_again(tmp_path, monkeypatch):
    monkeypatch.setattr(ElasticDesign, "load_cases", property(lambda _: [(1000.0, 500.0), (2000.0, 0.0)]))
    monkeypatch.setattr(elastic_design, "CLAIMED", ())
    real, wrong, tried = elastic_rows.run, [MemoryError(), ConvergenceError("no equilibrium")], []

    def fail(scene, *given):
        if scene.bodies.name == "elastic":
            tried.append(scene.title)
            if wrong:
                raise wrong.pop(0)
        return real(scene, *given)

    monkeypatch.setattr(elastic_rows, "run", fail)
    found = invoke(*WORDS, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    content = json.loads((tmp_path / "article-elastic.json").read_text(encoding="utf-8"), parse_constant=pytest.fail)
    rows = [row for row in content["rows"] if row["bodies"] == "elastic"]
    assert [row["status"] for row in rows] == ["refused", "failed"] and content["failed"] == 2
    assert "memory of this machine" in rows[0]["reason"] and rows[1]["reason"] == "no equilibrium"
    text = (tmp_path / "article-elastic.html").read_text(encoding="utf-8")
    assert "no equilibrium" in text and "no equilibrium" in " ".join(found.stdout.split())
    assert len(tried) == 2
    found = invoke(*WORDS, "--out", tmp_path, "--json")
    content = json.loads(found.stdout)
    assert len(tried) == 3 and content["cost"]["reused"] == 5
    assert [row["status"] for row in content["rows"] if row["bodies"] == "elastic"] == ["completed", "failed"]


def test_the_page_of_invented_numbers_opens_without_a_network(monkeypatch):
    monkeypatch.setattr("raceway.answers.page.svg", lambda figure: b"<svg/>")
    content = elastic_study().to_dict()
    text = page(content, drawings(content), None, "raceway study article --bodies elastic").html()
    images = re.findall(r'<img alt="([^"]+)"', text)
    assert len(images) == 2 + 4 + 3 + 2 and all(len(words) > 40 for words in images)
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    for words in ("Peak pressures", "In motion", "Cost", "What differs", "+2.00\u202f%", "bidirectional unbalance force"):
        assert words in text


def test_the_page_gives_no_shear_stress_that_the_mesh_does_not_resolve():
    content = elastic_study().to_dict()
    shear_and_depth_beside_hertz = r">410\.0<.*?>400\.0<.*?>61\.0<.*?>60\.0<"
    assert re.search(shear_and_depth_beside_hertz, page(content, [], None, "").html(), re.DOTALL)
    for row in content["rows"]:
        for side in row.get("below_contact") or []:
            side["resolved"] = False
    text = page(content, [], None, "").html()
    assert "410.0" not in text and "not resolved" in text


def test_deviations_are_those_of_rows_made_by_hand():
    """Pressures of elastic bodies are 2 % above Hertz's, of the ball with the least load 3 %; K 1 % above that of condensed bodies."""
    study = elastic_study()
    row, other = (study.row("static", "1000 N axial + 500 N radial", kind) for kind in ("elastic", "condensed"))
    hertz = elastic_rows.pressures_of(row["balls"], "inner")
    assert hertz["most_loaded"] == pytest.approx(0.02) and hertz["largest"] == pytest.approx(0.03)
    assert hertz["ball"] == 0 and hertz["loaded_balls"] == 3  # of four, one of which carries nothing
    off = elastic_rows.difference_at_rest(row, other)
    assert off["x"] == pytest.approx(-0.01) and off["kyy"] == pytest.approx(0.004) and off["y"] is not None
    assert off["ball_loads"] == pytest.approx(0.005)
    axial = [study.row("static", "400 N axial", kind) for kind in ("elastic", "condensed")]
    assert elastic_rows.difference_at_rest(*axial)["y"] is None
    moving = [study.row("motion", "bidirectional unbalance force", kind) for kind in ("elastic", "condensed")]
    off = elastic_rows.difference_in_motion(*moving)
    assert off["k"] == pytest.approx(0.01) and off["c"] == pytest.approx(0.5)
    z = moving[1]["identification"]["dynamic_stiffness"]["abs"]
    lines = elastic_page.tables(study.to_dict()).values()  # "400 N axial", "unidirectional constant force"
    shown = [[*next(line for line in part if line["bodies"] == "elastic").values()] for part in lines]
    assert shown[0][2:] == ["9.9000", "0.0000", "251.00", "+0.50\u202f%", "−1.00\u202f%", "–", "+0.40\u202f%"]
    assert shown[1][2:6] == ["202.00", "150", "198.84", "+1.00\u202f%"]
    assert off["wc"] == pytest.approx(12000.0 * 3.14159265 / 30.0 * 50.0 / z)  # w 50 N s/m over |Z|


def test_a_missing_reference_leaves_differences_out():
    made = design(read_toml(SCENE))
    content = elastic_study([run for run in made.runs() if run.bodies == "condensed"]).to_dict()
    assert {row["bodies"]: row.get("from_condensed", "none") for row in content["rows"]} == {
        "condensed": "none", "rigid": None, "elastic": None
    }  # fmt: skip
    assert content["failed"] == 6
    assert page(content, [], None, "").html()


def test_progress_tells_the_run_and_when_all_of_them_end(monkeypatch):
    now, told = [0.0], []
    monkeypatch.setattr("raceway_article.remaining_time.time.monotonic", lambda: now[0])
    kinds = {1: "static", 3: "static", 4: "motion"}
    progress = RemainingTime({1: 120.0, 3: 120.0, 4: 480.0}, kinds, lambda *given: told.append(given))
    progress.begin(1, "elastic at rest", "400 N axial")
    assert told[-1][0] == "run 1 of 3: 12 min left, elastic at rest: 400 N axial"
    now[0] = 60.0
    progress("factoring ball, 26000 elements", 3, 10)
    words, done, total = told[-1]
    assert words == "run 1 of 3: 11 min left, elastic at rest: factoring ball, 26000 elements 3 of 10"
    assert (done, total) == (60, 720)
    # The next one of its kind will take no longer than it did.
    progress.begin(3, "elastic at rest", "1000 N axial")
    assert told[-1][1:] == (60, 600) and "9 min" in told[-1][0]
    now[0] = 80.0
    progress.begin(4, "elastic in motion", "bidirectional unbalance force")
    progress("newmark, 80 steps", 8, 80)
    assert told[-1][1:] == (80, 560) and "8 min" in told[-1][0]
    assert len(told[-1][0]) <= 76  # 80 columns less what stands before
    # Longer than its plan: what is left is not known.
    now[0] = 80.0 + 481.0
    progress("newmark, 80 steps", 70, 80)
    assert told[-1][0].startswith("run 3 of 3: end unknown, elastic in motion") and told[-1][1:] == (560, 560)
