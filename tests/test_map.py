"""raceway study map: definitions on made-up curves, numbers on tiny grids, rows that are kept, the command."""

from __future__ import annotations

import json

import pytest

from raceway import SceneError, run
from raceway.scene.file import read_toml
from raceway.studies.map import study as study_module
from raceway.studies.map.curves import SATURATED, curves, trend, words
from raceway.studies.map.design import ANGLE, AXIAL, METHODS, SPEED, TILT, design
from raceway.studies.map.point import small_signal
from raceway.studies.map.study import study_map
from raceway.testing import default_registry
from validation.command_line import EXAMPLES, invoke, raceway

REGISTRY = default_registry()
TABLES = read_toml(EXAMPLES.parent / "raceway" / "data" / "map.toml")
TINY = (f"{AXIAL}=400,2000", f"{SPEED}=10980,15000", f"{ANGLE}=15")


def rows(law, speeds=(1e3, 1e4, 2e4, 4e4, 6e4)):
    """Rows of one curve with a given k(speed)."""
    common = {
        "status": "completed", "reason": "", "small_signal": 1.0, "lost": 0, "unseats": False, "reach_inner": 0.5,
        "reach_outer": 0.5,
    }  # fmt: skip
    return [{"point": {ANGLE: 15.0, TILT: "free", AXIAL: 100.0, SPEED: s}, "stiffness": law(s), **common} for s in speeds]


def test_a_power_law_has_its_exponent_and_does_not_saturate():
    made = rows(lambda speed: 3.0 * speed**1.7)
    (curve,) = curves(made)
    assert [row["exponent"] for row in made[1:]] == pytest.approx([1.7] * 4, rel=1e-12)
    assert made[-1]["change"] == pytest.approx(60.0**1.7 - 1.0)
    assert curve["trend"] == "hardens" and curve["saturates_at_rpm"] is None


def test_saturation_is_the_first_speed_with_less_than_its_share_of_the_largest_exponent():
    # Exponent 2 up to 20 000, a little less than the share of it to 40 000, then 1.4.
    law = {1e3: 1.0, 1e4: 1e2, 2e4: 4e2, 4e4: 4e2 * 2.0 ** (2.0 * (SATURATED - 0.01))}
    law[6e4] = law[4e4] * 1.5**1.4
    (curve,) = curves(rows(law.get))
    assert curve["saturates_at_rpm"] == 4e4
    assert curve["steepest_exponent"] == pytest.approx(2.0) and curve["last_exponent"] == pytest.approx(1.4)


def test_words_name_no_load_that_behaves_otherwise():
    made = []
    for load, rises in ((50.0, True), (100.0, True), (400.0, False), (2000.0, True)):
        some = rows(lambda speed, rises=rises: speed if rises else 1.0 / speed)
        made += [{**row, "point": {**row["point"], AXIAL: load}} for row in some]
    (said,) = words(curves(made), made)
    assert "hardens at 50 to 100 N and 2000 N; softens at 400 N" in said
    (said,) = words(curves(made[:10]), made[:10])
    assert said.endswith("k at the highest speed is 60 times that at the lowest.")


def test_signs_failures_and_boundaries():
    made = rows({1e3: 5.0, 1e4: 4.0, 2e4: None, 4e4: 4.0, 6e4: 9.0}.get)
    made[2] = {"point": made[2]["point"], "status": "failed", "reason": "no equilibrium"}
    made[3]["lost"], made[4]["reach_inner"] = 3, 1.01
    (curve,) = curves(made)
    assert curve["trend"] == "softens, then hardens" and curve["failed"] == 1
    assert made[2]["change"] is None and made[2]["exponent"] is None and made[3]["exponent"] is None
    assert (curve["contact_lost_from_rpm"], curve["edge_from_rpm"], curve["unseats_from_rpm"]) == (4e4, 6e4, None)
    assert trend([0.001, -0.001]) == "level" and trend([]) == "no numbers"
    assert "3 times" in trend([1.0, -1.0, 1.0, -1.0])


def test_the_trend_of_an_independent_solver():
    # physics: fixed balls with centrifugal force, half the rig's unbalance towards ball 0, no ring growth; the printed
    # ratios have three digits, the printed stiffness three or four: half a digit is 0.3 % of the smallest.
    tables = {**TABLES, "kinematics": {"ball_inertia": True}}
    found = study_map(design(tables, TINY, "quasi_static", REGISTRY), registry=REGISTRY)
    end = {(curve["tilt"], curve["axial"]): curve for curve in found.curves}
    for key, first, last in (
        (("locked", 400), 163.0e6, 0.668), (("locked", 2000), 285.8e6, 0.993), (("free", 400), 24.32e6, 1.356), (("free", 2000), 48.37e6, 1.063),
    ):  # fmt: skip
        assert end[key]["first_stiffness"] == pytest.approx(first, rel=3e-3)
        assert 1.0 + end[key]["last_change"] == pytest.approx(last, abs=1e-3)
    assert end["locked", 400]["trend"] == "softens" and end["free", 400]["trend"] == "hardens"


def test_both_methods_agree_where_no_mass_is_carried():
    # The ring's own 61 g adds m w^2 r to what the contacts carry: 0.07 % of 235 N/um at 15 000 r/min.
    vary = (f"{AXIAL}=1000", f"{SPEED}=10980,15000", f"{ANGLE}=15", f"{TILT}=locked")
    slow, fast = (
        study_map(design(TABLES, vary, method, REGISTRY), registry=REGISTRY).curves[0]
        for method in ("periodic", "quasi_static")
    )
    assert slow["first_stiffness"] == pytest.approx(fast["first_stiffness"], rel=2e-3)
    assert slow["last_change"] == pytest.approx(fast["last_change"], abs=2e-3)


def test_small_signals_are_the_limit_of_small_forces():
    for tilt in ("locked", "free"):
        tables = {**TABLES, "integrator": METHODS["quasi_static"], "supports": {"tilt": tilt}}
        tables["excitation"] = {**TABLES["excitation"], "amplitude": "constant", "force": 0.1}
        found = run(tables)
        # 0.1 N moves 2e-4 to 2e-6 of the approach; what remains is of that order squared and the tolerance of the orbit.
        assert small_signal(found) == pytest.approx(found.identification.equivalent_stiffness, rel=1e-4)


def test_contact_loss_and_the_grooves_edge_are_found():
    vary = (f"{AXIAL}=50,10000", f"{SPEED}=1000,60000", f"{ANGLE}=15")
    found = study_map(design(TABLES, vary, "quasi_static", REGISTRY), registry=REGISTRY)
    curve = {(one["tilt"], one["axial"]): one for one in found.curves}
    assert curve["locked", 50]["contact_lost_from_rpm"] == 60000 and curve["locked", 10000]["contact_lost_from_rpm"] is None
    assert curve["free", 10000]["edge_from_rpm"] == 60000 and curve["locked", 10000]["edge_from_rpm"] is None
    edge = [row for row in found.rows if row["reach_inner"] > 1.0]
    tables = {**TABLES, "integrator": METHODS["quasi_static"], "load": {"axial": 10000.0}, "supports": {"tilt": "free"}}
    tables["excitation"] = {**TABLES["excitation"], "speed_rpm": 60000.0}
    # The run itself warns at the same point.
    assert edge and any("beyond the groove's edge" in text for text in run(tables).warnings)


def test_finished_points_are_kept_and_used_again(tmp_path, monkeypatch):
    planned, kept = design(TABLES, TINY, "quasi_static", REGISTRY), tmp_path / "rows.jsonl"
    real, count = study_module.point_row, 0

    def stop_after_three(scene, registry):
        nonlocal count
        count += 1
        if count > 3:
            raise KeyboardInterrupt
        return real(scene, registry)

    monkeypatch.setattr(study_module, "point_row", stop_after_three)
    with pytest.raises(KeyboardInterrupt):
        study_map(planned, kept=kept, registry=REGISTRY)
    assert len(kept.read_text().split()) > 0
    monkeypatch.setattr(
        study_module, "point_row", lambda scene, registry: (lambda row: {**row, "new": True})(real(scene, registry))
    )
    found = study_map(planned, kept=kept, registry=REGISTRY)
    assert [row.get("new", False) for row in found.rows] == [False] * 3 + [True] * 5


def test_processes_give_the_same_numbers(monkeypatch):
    planned = design(TABLES, (*TINY, f"{TILT}=locked,free"), "quasi_static", REGISTRY)
    alone = study_map(planned, 0, registry=REGISTRY)
    monkeypatch.setattr(study_module, "_WORTH", 1)
    assert study_map(planned, 2, registry=REGISTRY).rows == alone.rows


def test_points_that_fail_are_shown_with_their_reason(tmp_path):
    words = ("--set", "excitation.amplitude=constant", "--set", "excitation.force=3e6")  # thousands of its load ratings
    found = invoke("study", "map", *words, *(w for v in TINY for w in ("--vary", v)), "--out", tmp_path, "--json")
    content = json.loads(found.stdout)
    assert found.exit_code == 1 and "no point of the map gave a number" in content["errors"][0]["message"]
    assert all(row["status"] == "failed" and row["reason"] for row in content["rows"])
    assert content["rows"][0]["reason"] in (tmp_path / "map.html").read_text(encoding="utf-8").replace("&#x27;", "'")


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        (f"{SPEED}=10980", "two speeds"),
        (f"{AXIAL}=0,100", "greater than 0"),
        ("bearing.ball_count=10,12", "no axis of the map"),
        (f"{TILT}=locked,fre", "free"),
        (f"{ANGLE}=15,fifteen", "numbers"),
        (f"{ANGLE}=15,89", "75"),
    ],
)
def test_what_cannot_be_an_axis_is_refused_before_anything_is_run(vary, words):
    with pytest.raises(SceneError, match=words):
        design(TABLES, (vary,), "quasi_static", REGISTRY)


def test_a_scene_without_excitation_is_refused(tmp_path):
    scene = tmp_path / "still.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n')
    found = invoke("study", "map", scene, "--out", tmp_path)
    assert found.exit_code == 2 and "excitation" in found.output


def test_the_command_writes_tables_and_a_page(tmp_path):
    found = raceway("study", "map", *(w for v in TINY for w in ("--vary", v)), "--out", tmp_path, COLUMNS=100)
    assert found.returncode == 0, found.stderr
    assert found.stderr == ""
    assert "15 deg, tilt locked: softens at 400 N; level at 2000 N" in " ".join(found.stdout.split())
    lines = (tmp_path / "map.csv").read_text().splitlines()
    assert len(lines) == 1 + 8 and "stiffness [N/m]" in lines[0] and "load.axial [N]" in lines[0]
    content = json.loads((tmp_path / "map.json").read_text())
    assert len(content["rows"]) == 8 and content["definitions"]["exponent"].startswith("d ln k")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "map.json", "map.csv", "map.html", "map-change.png", "map-exponent.png", "map-curves.png", "map-rows.jsonl",
    }  # fmt: skip
