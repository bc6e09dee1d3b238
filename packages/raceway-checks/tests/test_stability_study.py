"""`raceway stability`: expectations, guards against hangs and crashes, the numbers of a few cases, the command.

All quick cases are run by packages/raceway-checks/tests/evidence/test_stability.py at night; here those of seconds, and deliberate faults.
"""

import json
import math

import attrs
import numpy as np
import pytest
from raceway_checks.stability import motions, scenes, systems
from raceway_checks.stability.catalogue import BASE, SCENES, Case, catalogue, law_changes, laws_with, transient
from raceway_checks.stability.scenes import displacement_under_axial_load, energy_slope
from raceway_checks.stability.study import AS_EXPECTED, FAILED, Limit, Rows, case_rows, measured, stability
from raceway_checks.stability.systems import Bench

from checks.validation.command_line import ARTICLE, EXAMPLES, invoke
from raceway import ConvergenceError, SceneError
from raceway.extend import Ring, default_registry, registry_with, solve_equilibrium, written

REGISTRY = default_registry()
CUBIC, DAMPED = (EXAMPLES.parent / "tests" / f"{name}.py" for name in ("cubic_law", "hunt_crossley"))
CASES = catalogue(REGISTRY)


def case(function, **arguments):
    return Case(function, f"checks.validation.stability_cases:{function}", arguments, arguments)


def rows_named(name, cases=CASES, registry=REGISTRY, **wanted):
    """Rows of the catalogue's cases with a name and a setting."""
    found = [one for one in cases if one.name == name and wanted.items() <= one.setting.items()]
    assert found, (name, wanted)
    return [row for one in found for row in case_rows(one, registry)]


def test_the_catalogue_has():
    words = (
        "penalty", "around the limit, linear", "around the limit, small motions", "safe limit", "undamped steps", "impact",
        "loose", "lift-off", "radial load 50 x", "axial load 1 N", "100 kN", "speed 1 r/min", "200 000 r/min", "3 balls",
        "60 balls", "conformity 0.501", "conformity 0.60", "clearance", "interference", "0.4999", "rubber", "ceramic balls",
        "friction 0.3", "friction 1.0", "rotor of 1 g", "rotor of 10 t", "slender elements", "deep initial penetration",
        "two balls on the line", "chatter",
    )  # fmt: skip
    assert not [word for word in words if not any(word in one.name for one in CASES)]
    assert len({name for name, *_ in SCENES}) == len(SCENES)


def test_every_law_and_transient_integrator_takes_part_and_a_third_partys_in_the_quick_set_too():
    assert {*laws_with(REGISTRY, "resultant"), "unilateral"} <= {one.setting.get("law") for one in CASES}
    for name in ("steps around the limit, linear", "orbit at the safe limit", "undamped steps", "impact"):
        assert {one.setting["integrator"] for one in CASES if one.name == name and one.quick} == set(transient(REGISTRY))
    assert not {"periodic", "quasi_static"} & set(transient(REGISTRY))
    foreign = [one for one in catalogue(registry_with([CUBIC])) if one.setting.get("law") == "cubic"]
    quick = {one.name for one in foreign if one.quick}
    assert {"impact", "chatter", "undamped steps", "orbit at the safe limit", "base", "axial load 100 kN"} <= quick
    assert len(quick) < len({one.name for one in foreign})


@pytest.mark.parametrize(("limit", "good", "bad"), [
    (Limit.equal(2.0, 0.01), (2.019, 1.981), (2.021, 1.979)), (Limit.equal(-2.0, 0.01), (-2.019,), (-2.021, 2.0)),
    (Limit.at_most(1.0), (1.0,), (1.1, math.nan, (0.5, math.nan))),
    (Limit.at_least(1.0), (1.0, (1.0, 0.3)), (0.9, math.inf)),
])  # fmt: skip
def test_expectations_judge(limit, good, bad):
    rows = Rows("c")
    assert {rows.check("q", value, "", limit).verdict for value in good} == {AS_EXPECTED}
    assert {rows.check("q", value, "", limit).verdict for value in bad} == {FAILED}


def test_an_unexpected_refusal_fails_and_an_expected_one_does_not():
    def refuse():
        raise ConvergenceError("no load acts")

    rows = Rows("c")
    row = rows.check("q", refuse, "", Limit.at_most(1.0))
    assert row.verdict == FAILED and "unexpectedly: no load acts" in row.note and row.observed is None
    assert rows.refused("no load", "", refuse).verdict == AS_EXPECTED
    assert rows.refused("another message", "", refuse).verdict == FAILED
    assert rows.refused("no load", "", lambda: 1.0).note == "it was computed instead"
    told, missed = (rows.warned("edge", "", words).verdict for words in (["beyond the edge"], []))
    assert (told, missed) == (AS_EXPECTED, FAILED)


def extreme_rows(judge, **changes):
    arguments = {"tables": BASE, "changes": {"integrator.turns": 1, **changes}, "judge": judge}
    return case_rows(Case("c", "scenes:extreme", {}, arguments), REGISTRY)


def test_a_comparison_that_is_refused_fails_its_case(monkeypatch):
    def refuse(scene, registry):
        raise ConvergenceError("no motion was found")

    monkeypatch.setattr(systems, "run", refuse)
    for judge, kind in (("orbit", "periodic"), ("slow", "quasi_static"), ("any", "periodic")):
        *_, row = extreme_rows(judge)
        assert row.verdict == FAILED and "unexpectedly: no motion was found" in row.note
        assert row.setting["integrator"] == kind


def test_a_motion_whose_energy_nobody_balances_fails():
    # While a force grows, energy is not balanced.
    _, *moved = extreme_rows("finer", **{"integrator.start": "ramp"})
    balanced = [row for row in moved if "energy" in row.quantity]
    assert balanced and all(row.verdict == FAILED and "not a number" in row.note for row in balanced)
    # A user's scene that `periodic` cannot take is held against its energy instead, and says so.
    _, *moved = extreme_rows("any", **{"contact.friction": 0.1})
    assert moved and all(row.verdict == AS_EXPECTED and "no steady motion to compare" in row.note for row in moved)


def test_a_motion_that_keeps_its_energy_and_has_another_stiffness_fails(monkeypatch):
    """A truth of another load is 3 % away; the balance of energy does not see that."""
    monkeypatch.setitem(scenes._JUDGES, "finer", {**scenes._JUDGES["finer"], "load.axial": 1100.0})
    _, *moved = extreme_rows("finer", **{"integrator.start": "static"})
    assert {row.verdict for row in moved if "energy" in row.quantity} == {AS_EXPECTED}
    assert {row.verdict for row in moved if "|Z|" in row.quantity} == {FAILED}
    assert all("states an error of" in row.note for row in moved if row.verdict == FAILED)


def test_the_slope_of_the_stored_energy_is_the_load_that_a_sum_over_balls_misses():
    """At 100 kN a compliance that varies with the contact angle pushes balls along the groove with 3 % of the load."""
    found = {}
    for load in (1e5, 1.001e5):
        model = Bench(BASE, {"bodies.kind": "condensed", "load.axial": load, "excitation": None}, REGISTRY).model()
        found[load] = solve_equilibrium(model)
        # A difference over a thousandth of the penetration errs by the square of that.
        assert energy_slope(model, found[load]) == pytest.approx(load, rel=1e-5)
    # The state decides, not the load that the model was given.
    assert energy_slope(model, found[1e5]) == pytest.approx(1e5, rel=1e-5)
    balls = found[1e5]
    along = balls.contact_force[:12] * np.sin(balls.angle_inner)
    assert along.sum() / 1e5 - 1.0 > 0.02


@pytest.mark.slow
def test_a_traceback_a_hang_and_a_crash_cost_one_case_each():
    (row,) = case_rows(case("answer"), REGISTRY)
    assert row.verdict == FAILED and row.note.startswith("KeyError in stability_cases.py")
    cases = [case("hang"), case("die"), case("answer", value="near"), case("answer", value="far")]
    with written(None) as store:
        hung, died, *answered = measured(cases, 2, REGISTRY, store, patience=6.0)[0]
    assert "it hangs" in hung.note and "EXIT(7)" in died.note and hung.verdict == died.verdict == FAILED
    assert [row.verdict for row in answered] == [AS_EXPECTED, FAILED]


@pytest.mark.parametrize("name", ["steps around the limit, linear", "steps around the limit, small motions of the bearing"])
def test_explicit_steps_hold_up_to_the_predicted_limit(name):
    rows = rows_named(name, integrator="central_difference")
    assert all(row.verdict == AS_EXPECTED for row in rows)
    limits = [row.observed / row.predicted for row in rows if row.quantity.startswith("stable limit")]
    # The motions are linear and bisected to 1e-3.
    assert limits and all(abs(limit - 1.0) < 2e-3 for limit in limits)


def test_the_safe_limit_holds_on_large_orbits():
    rows = rows_named("orbit at the safe limit", integrator="central_difference", law="hertz")
    assert any(row.setting["contacts open"] for row in rows)
    # Half the orbit's size, the catalogue's bound: errors of 30 steps per turn are percents, near parametric resonances of opening
    # contacts a quarter (docs/stability.md); an unstable motion is off by many times the orbit.
    assert all(row.verdict == AS_EXPECTED for row in rows)


@pytest.mark.parametrize("integrator", ["central_difference", "newmark"])
def test_energy_of_symplectic_steps_has_no_trend(integrator):
    cases = [one for one in CASES if one.name == "undamped steps" and one.quick and one.setting["integrator"] == integrator]
    assert len(cases) == 2 * len(laws_with(REGISTRY, "resultant"))
    for one in cases:
        (row,) = case_rows(attrs.evolve(one, arguments={**one.arguments, "steps": 20_000}), REGISTRY)
        # The catalogue holds a million steps to the same bounds.
        assert row.verdict == AS_EXPECTED, row


def test_a_trend_is_that_part_of_the_motion_s_energy(monkeypatch):
    """Deliberate fault: velocities that grow by 1e-4 over the run.  Half of a small motion's energy is kinetic."""
    exact = motions.integrate

    def growing(*given):
        record = exact(*given)
        return attrs.evolve(record, velocity=record.velocity * np.linspace(1.0, 1.0 + 1e-4, len(record.time))[:, None])

    monkeypatch.setattr(motions, "integrate", growing)
    wanted = {"integrator": "newmark", "law": "hertz"}
    one = next(
        one for one in CASES if one.name == "undamped steps" and one.setting == wanted and one.arguments["amplitude"] < 1.0
    )
    (row,) = case_rows(attrs.evolve(one, arguments={**one.arguments, "steps": 20_000}), REGISTRY)
    assert row.observed == pytest.approx(1e-4, rel=0.05) and row.verdict == FAILED


@pytest.mark.slow
def test_newmark_chatters_and_generalized_alpha_or_finer_steps_do_not():
    rows = rows_named("chatter", law="hertz")
    assert all(row.verdict == AS_EXPECTED for row in rows)
    coarse = [row for row in rows if row.setting["integrator"] == "newmark" and row.setting["step/period"] == 1.0]
    assert coarse and all(row.observed > 1.0 and "open in 5" in row.note for row in coarse)  # open about every other step
    cured = [row for row in rows if row.setting["integrator"] == "generalized_alpha"]
    assert cured and all(row.observed < 1e-6 for row in cured)


@pytest.mark.parametrize(
    "name",
    [
        "no load", "two balls on the line of the load", "elements without a volume", "rubber on ceramic, elements",
        "slender elements, tension",
    ],
)  # fmt: skip
def test_hard_cases_end_as_expected(name):
    assert all(row.verdict == AS_EXPECTED for row in rows_named(name))


def test_what_rattling_misses_its_result_tells():
    """Balls at 1 N under 50 N meet the races ever differently: |Z| of twelve turns hangs on the step, its stated error is larger."""
    rows = rows_named("axial load 1 N under 50 N rotating: rattling", law="penalty")
    missed = [row for row in rows if row.verdict == FAILED]
    assert all(row.quantity.startswith("|Z|") for row in missed)
    for row in missed:
        assert abs(row.observed / row.predicted - 1.0) < float(row.note.rsplit(" ", 1)[1])


#: Cases whose expectations depend on the law, with one that decides them; others by night.
FOREIGN = {
    "60 balls": "cubic", "rubber balls in ceramic rings": "", "chatter": "", "impact": "hunt_crossley",
    "steps around the limit, small motions of the bearing": "film",
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "law"),
    [
        pytest.param(name, law, marks=() if law == quick else pytest.mark.slow)
        for name, quick in FOREIGN.items()
        for law in ("cubic", "film", "hunt_crossley")
    ],
)
def test_expectations_of_any_law_follow_from_its_own_force(name, law):
    registry = registry_with([CUBIC, DAMPED])
    rows = rows_named(name, catalogue(registry), registry, law=law)
    assert not [row for row in rows if row.verdict != AS_EXPECTED]


def small_motions(**contact):
    changes = {"contact.kind": "hunt_crossley", **{f"contact.{key}": value for key, value in contact.items()}}
    arguments = {"tables": BASE, "integrator": "central_difference", "changes": changes}
    return case_rows(Case("c", "motions:small_motions", {}, arguments), registry_with([DAMPED]))


def test_the_stable_limit_knows_what_the_law_damps(monkeypatch):
    """Dissipation of 5 s/m: the law's slope by the rate takes a seventh of the limit without it."""
    rows = small_motions(dissipation=5.0)
    assert {row.verdict for row in rows} == {AS_EXPECTED}
    assert rows[-1].predicted < 0.9 * small_motions(dissipation=0.0)[-1].predicted
    # Deliberate fault: the limit of the springs alone.
    monkeypatch.setattr(Ring, "damped_time_step", lambda self, tangent, damping: self.critical_time_step(tangent))
    assert rows[-1].quantity.startswith("stable limit")
    assert small_motions(dissipation=5.0)[-1].verdict == FAILED


def test_a_film_that_stands_off_is_part_of_the_displacement_by_the_laws_own_force(monkeypatch):
    model = Bench(BASE, {**law_changes("film", REGISTRY), "kinematics.ball_inertia": False}, REGISTRY).model()
    own, found = displacement_under_axial_load(model), solve_equilibrium(model).displacement[0]
    # Angles and loads that the films are built at meet to 1e-9 and better.
    assert own == pytest.approx(found, rel=1e-6)
    # Deliberate fault: surfaces that touch.
    monkeypatch.setattr(scenes, "reach_of", lambda law, pairs: np.zeros(len(pairs.load)))
    assert abs(displacement_under_axial_load(model) / found - 1.0) > 0.1


def test_the_axial_displacement_by_a_laws_own_force():
    """Of the cubic law in closed form: delta = (Q / 2e17)^(1/3) at both races."""
    model = Bench(BASE, {"contact.kind": "cubic", "kinematics.ball_inertia": False}, registry_with([CUBIC])).model()
    axial, radial = np.add(model.geometry.rest, (displacement_under_axial_load(model), 0.0))
    approach = np.hypot(axial, radial) - model.geometry.centre_distance
    load = 2e17 * (0.5 * approach) ** 3
    assert 12 * load * axial / np.hypot(axial, radial) == pytest.approx(1000.0, rel=1e-9)


@pytest.mark.parametrize(("law", "expected"), [("hertz", FAILED), ("cubic", AS_EXPECTED)])
def test_only_a_law_stiffer_than_hertz_may_be_refused_by_elastic_bodies(law, expected, monkeypatch):
    build = Bench.model

    def refuse(bench):
        if bench.changes["bodies.kind"] == "condensed":
            raise SceneError.at("contact.kind", law, "is stiffer than elastic bodies allow")
        return build(bench)

    exact = scenes._force_and_slope

    def rounded(*pair):
        """Powers of other processors differ in the last digits."""
        force, slope = exact(*pair)
        return force, (1.0 + 1e-14) * slope

    monkeypatch.setattr(Bench, "model", refuse)
    monkeypatch.setattr(scenes, "_force_and_slope", rounded)
    changes = {"contact.kind": law, "load.axial": 1e5, "bodies.kind": "condensed"}
    arguments = {"tables": BASE, "changes": changes, "may_be_too_stiff": True}
    (row,) = case_rows(Case("c", "scenes:extreme", {}, arguments), registry_with([CUBIC]))
    assert row.verdict == expected


def test_the_command_writes_its_report_and_reuses_finished_cases(tmp_path):
    words = ("stability", "--only", "clearance 20 um", "--processes", 0, "--out", tmp_path, "--json")
    first = invoke(*words)
    assert first.exit_code == 0
    content = json.loads(first.stdout)
    keys = {"case", "setting", "expected", "predicted", "observed", "energy_drift", "verdict"}
    assert all(keys <= set(row) for row in content["rows"]) and content["failed"] == content["reused"] == 0
    assert json.loads((tmp_path / "stability.json").read_text())["rows"] == content["rows"]
    assert "## clearance 20 um" in (tmp_path / "stability.md").read_text()
    again = json.loads(invoke(*words).stdout)
    assert again["reused"] == again["cases"] and again["rows"] == content["rows"]


def test_a_scene_of_the_user_is_put_through_the_cases_that_suit_any(tmp_path):
    found = invoke("stability", ARTICLE, "--only", "small motions", "--processes", 0, "--out", tmp_path)
    assert found.exit_code == 0 and "B7206C" in found.stdout and "step/limit" in found.stdout
    names = {one.name for one in catalogue(REGISTRY, {"bearing": {"preset": "B7206C"}})}
    assert "undamped steps" in names and "no load" not in names


def test_quick_cases_are_the_default_and_the_screen_says_what_is_left_out(tmp_path, monkeypatch):
    cases = (case("answer", value="near"), attrs.evolve(case("answer", value="far"), name="long", quick=False))
    monkeypatch.setattr("raceway_checks.stability.study.catalogue", lambda *_: cases)
    words = ("stability", "--processes", 0, "--out", tmp_path)
    quick = invoke(*words)
    assert quick.exit_code == 0 and "left out: 1 cases" in quick.stdout
    assert invoke(*words, "--only", "answer").exit_code == 0
    # A case that fails is exit code 1, and is named.
    found = invoke(*words, "--all")
    assert found.exit_code == 1 and "failed: long, value far, one, equal within 0.1, 1, 2" in found.stdout
    assert "left out" not in found.stdout
    content = json.loads((tmp_path / "stability.json").read_text())
    assert (content["failed"], content["cases"]) == (1, 2)
    page = (tmp_path / "stability.md").read_text()
    assert page.index("## Failed") < page.index("## answer")


def test_an_interruption_keeps_finished_cases(tmp_path, monkeypatch):
    cases = tuple(attrs.evolve(case("answer", value="near"), name=f"answer {k}", setting={"k": k}) for k in range(4))
    monkeypatch.setattr("raceway_checks.stability.study.catalogue", lambda *_: cases)

    def stop(what, done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stability(only="answer", processes=0, kept=tmp_path, progress=stop)
    assert stability(only="answer", processes=0, kept=tmp_path).reused == 2


@pytest.mark.parametrize(("words", "message"), [
    (("--only", "chater"), "no case is called so"), (("--set", "load.axial=1"), "no scene is given"),
    ((ARTICLE, "--set", "load.axal=1"), "load.axal"), (("nowhere.toml",), "no such file"),
])  # fmt: skip
def test_bad_input(words, message, tmp_path):
    found = invoke("stability", *words, "--processes", 0, "--out", tmp_path)
    assert found.exit_code == 2 and message in found.output


def test_surface_points_are_refused():
    with pytest.raises(SceneError, match="whole contacts"):
        catalogue(REGISTRY, {"contact": {"discretisation": "nodal"}})
