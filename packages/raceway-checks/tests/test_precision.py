"""`raceway precision`: the design, rows that survive, references with a bound, fronts, orders; and the estimates of errors."""

import json
import math
from typing import Any

import attrs
import numpy as np
import pytest
from matplotlib.text import Text
from raceway_checks.precision import study as module
from raceway_checks.precision.answer import THRESHOLDS
from raceway_checks.precision.picture import draw
from raceway_checks.precision.settings import find_reference, make_design
from raceway_checks.precision.timing import measured
from rich.console import Console

from checks.validation.command_line import ARTICLE, invoke
from checks.validation.figures import assert_readable
from raceway import RacewayError, SceneError, precision, scene_from_dict
from raceway.extend import Store, read_toml, row_key, written
from raceway.pipeline.transient_error import hann_line
from raceway.testing import b7206c, default_registry, run

TABLES = read_toml(ARTICLE)
FEW = {**TABLES, "integrator": {"kind": "newmark", "turns": 4}}
LADDER = ["integrator.kind=newmark,central_difference", "integrator.steps_per_turn=45,90,180"]


@pytest.fixture(scope="module")
def ladder():
    return precision(FEW, LADDER, repeats=1)


def test_the_default_design_has_each_axis_and_says_what_it_leaves_out():
    design = make_design(TABLES, [], 30.0, default_registry())
    keys = {key for setting in design.settings for key in setting.values}
    assert {"integrator.kind", "integrator.steps_per_turn", "integrator.turns", "integrator.start"} <= keys
    assert {"contact.kind", "identifier.kind"} <= keys
    assert all(why for _, _, why in design.left_out)
    # Two laws and two discretisations, four starts of three integrators and so on would be thousands.
    assert len(design.settings) < 80
    predicted = sorted(setting.predicted_s for setting in design.settings)
    cheap = make_design(TABLES, [], predicted[len(predicted) // 2], default_registry())
    assert len(cheap.settings) < len(design.settings)
    assert any("above the limit" in why for _, _, why in cheap.left_out)


def test_errors_fall_with_the_order_of_the_methods_and_in_the_order_of_theory(ladder):
    rows = ladder.judged
    assert [row["status"] for row in rows] == ["completed"] * 6
    found = [row["order"] for row in rows if row["order"] is not None]
    # Both methods are of second order; 0.1 is left for the terms of fourth order at 45 steps per turn.
    assert len(found) == 4 and all(order == pytest.approx(2.0, abs=0.1) for order in found)
    assert all(row["expected_order"] == 2 for row in rows)
    # w^2 becomes (2 / dt tan)^2 with dt^2 / 6 against (2 / dt sin)^2 with dt^2 / 12: twice the error.
    for newmark, explicit in zip(rows[:3], rows[3:], strict=True):
        assert newmark["error"] / explicit["error"] == pytest.approx(2.0, rel=0.05)


def test_the_reference_is_more_accurate_than_the_rows_and_says_how(ladder):
    content = ladder.to_dict()
    assert content["reference"]["error"] < 0.1 * min(row["error"] for row in content["rows"])
    assert "extrapolated" in content["reference"]["how"] or "steady orbit" in content["reference"]["how"]
    assert not any(row["at_bound"] for row in content["rows"])
    # The rows' own estimates are those that the evidence holds within a factor of three.
    for row in content["rows"]:
        assert row["error"] / 3.0 <= row["own_error"] <= 3.0 * row["error"]


def test_the_front_falls_and_the_cheapest_are_on_it(ladder):
    content = ladder.to_dict()
    front = [content["rows"][place] for place in content["front"]]
    times, errors = [row["time_s"] for row in front], [row["error"] for row in front]
    assert times == sorted(times) and errors == sorted(errors, reverse=True)
    assert [float(name) for name in content["cheapest"]] == list(THRESHOLDS)
    assert all(place in content["front"] for place in content["cheapest"].values())
    doubtful = {name: attrs.evolve(reference, bounds=reference.values) for name, reference in ladder.references.items()}
    assert not any(attrs.evolve(ladder, references=doubtful).cheapest(next(iter(doubtful))).values())


def shown(renderable):
    """Lines of a screen."""
    console = Console(width=80)
    with console.capture() as captured:
        console.print(renderable, crop=False)
    return [line.rstrip() for line in captured.get().splitlines()]


def test_json_and_screen_are_what_the_design_promises(ladder, tmp_path):
    files = {path.name: path for path in ladder.save(tmp_path, pictures=True)}
    content = json.loads(files["precision.json"].read_text())
    assert {"value", "error", "how"} <= set(content["reference"])
    wanted = {"setting", "value", "error", "wall_s", "cpu_s", "compile_s", "steps", "status", "reason", "order", "cost"}
    assert all(wanted <= set(row) for row in content["rows"])
    assert {"z_real", "z_imag", "axial_displacement", "peak_ball_load", "p0"} <= set(content["rows"][0]["quantities"])
    screen = " ".join(shown(ladder.screen(["precision.json"])))
    assert "bound" in ladder.words[0] and all(text in screen for text in (*ladder.words, "written: precision.json"))
    page = files["precision.md"].read_text()
    assert "central_difference" in page and "| order |" in page
    assert files["precision.png"].stat().st_size > 10_000


@pytest.mark.slow
def test_model_error_and_numerical_error_are_told_apart():
    found = precision(FEW, ["contact.kind=hertz,penalty"], repeats=1)
    base, other = found.models
    assert base["base"] and other["model"] == {"contact.kind": "penalty"}
    hertz, penalty = (row["value"] for row in found.judged)
    # The difference of the references is that of the runs, to their own errors of 1e-6.
    assert other["difference"] == pytest.approx(abs(penalty - hertz) / hertz, rel=1e-3)
    assert all(row["error"] < 1e-5 for row in found.judged), "each row is held against its own model"
    assert found.front(found.base) == [0]


def test_what_is_refused_or_fails_stays_in_the_table_with_its_reason():
    steps = "integrator.steps_per_turn=16,180"
    found = precision(
        FEW, ["integrator.kind=central_difference", steps, "contact.discretisation=resultant,nodal"], repeats=1
    )
    states = [(row["status"], bool(row["reason"])) for row in found.judged]
    assert states == [("failed", True), ("refused", True), ("completed", False), ("refused", True)]
    assert "stable limit" in found.judged[0]["reason"]


def test_finished_rows_survive_a_stop_and_are_reused(tmp_path):
    seen, steps = [], LADDER[1:]

    def stop(what, done, total):
        seen.append(what)
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        precision(FEW, steps, repeats=1, kept=tmp_path, progress=stop)
    with written(tmp_path) as store:
        assert store.counts()["done"] == 2
    found = precision(FEW, steps, repeats=1, kept=tmp_path)
    assert [row["reused"] for row in found.judged] == [True, True, False]
    again = precision(FEW, steps, repeats=1, kept=tmp_path)
    assert all(row["reused"] for row in again.judged)
    assert again.to_dict()["reference"] == found.to_dict()["reference"]


def full(*_):
    raise RacewayError("database or disk is full")


@pytest.mark.slow
def test_a_disk_that_takes_no_more_rows_does_not_stop_the_study(tmp_path, monkeypatch):
    monkeypatch.setattr(Store, "put", full)
    with pytest.warns(UserWarning, match="database or disk is full"):
        found = precision(FEW, ["integrator.steps_per_turn=90"], repeats=1, kept=tmp_path)
    assert found.judged[0]["error"] is not None


def test_a_run_that_compiled_is_not_among_the_repeats(monkeypatch):
    from raceway.core.jit import clock

    done = []

    def compiling(scene, registry):
        done.append(1)
        clock["compile_s"] += 100.0 if len(done) == 1 else 0.0
        return run(scene, registry)

    monkeypatch.setattr("raceway.pipeline.run.run", compiling)
    cost = measured(scene_from_dict(FEW), default_registry(), 2)["cost"]
    assert len(done) == 3 and cost["repeats"] == 2 and cost["compile_s"] >= 100.0
    assert 0.0 < cost["cpu_s"] == cost["time_s"] < 50.0


def test_the_key_of_a_row_follows_the_scene_and_the_files_it_names(tmp_path):
    registry = default_registry()

    def key(**tables):
        return row_key(scene_from_dict({**TABLES, **tables}, registry), registry)

    assert key() == key() and key() != key(load={"axial": 999.0})
    assert row_key(scene_from_dict(TABLES), registry, 1) != row_key(scene_from_dict(TABLES), registry, 2)
    file = tmp_path / "force.csv"
    keys = []
    for force in (100.0, 200.0):
        lines = [f"{k / 1000:.4f},{force * math.cos(k):.4f},{force * math.sin(k):.4f}" for k in range(50)]
        file.write_text("\n".join(["t,Fy,Fz", *lines]) + "\n")
        keys.append(key(excitation={"kind": "measured", "file": str(file), "speed_rpm": 12000.0}))
    assert keys[0] != keys[1]


@pytest.mark.parametrize(("words", "code", "said"), [
    (["--vary", "integrator.stepz=1,2"], 2, "stepz"), (["--vary", "nothing"], 2, "nothing"),
    (["--reference", "integrator.stepz=3"], 2, "stepz"), (["--limit", "0"], 2, "limit"),
    (["--repeats", "0"], 2, "repeats"),
])  # fmt: skip
def test_mistakes_are_found_before_anything_runs(words, code, said, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "measured_once", lambda *_: pytest.fail("it ran"))
    found = invoke("precision", ARTICLE, *words, "--out", tmp_path)
    assert found.exit_code == code and said in found.output


def test_a_reference_that_is_no_better_than_the_rows_is_refused_after_the_rows_are_shown(tmp_path):
    words = ["--vary", "integrator.steps_per_turn=45,90", "--set", "integrator.turns=4", "--repeats", "1"]
    found = invoke("precision", ARTICLE, *words, "--reference", "integrator.steps_per_turn=30", "--out", tmp_path)
    assert found.exit_code == 2
    assert "--reference" in found.output and "not more accurate than the rows" in found.output
    assert (tmp_path / "precision.json").is_file()


def test_no_converging_row_is_a_numerical_failure_with_the_reason(tmp_path):
    words = ["--vary", "integrator.steps_per_turn=8,16", "--set", "integrator.kind=central_difference", "--repeats", "1"]
    words += ["--set", "integrator.turns=4"]
    found = invoke("precision", ARTICLE, *words, "--out", tmp_path)
    assert found.exit_code == 1 and "no setting converged" in found.output and "stable limit" in found.output
    rows = json.loads((tmp_path / "precision.json").read_text())["rows"]
    assert [row["status"] for row in rows] == ["failed", "failed"]


def test_a_static_scene_has_models_only():
    static = {name: table for name, table in TABLES.items() if name != "excitation"}
    found = precision(static, ["contact.kind=hertz,penalty"], repeats=1)
    assert [row["error"] for row in found.judged] == [0.0, 0.0]
    assert found.models[1]["difference"] > 0.0


def test_the_error_of_a_contact_law_is_its_distance_from_hertz():
    """A penalty that is scaled at one load: its stiffness goes with 2 Q^(1/2) instead of 3/2 Q^(1/3), which is farther off than the approach."""
    static = {name: table for name, table in TABLES.items() if name != "excitation"}
    scene = {**static, "load": {"axial": 1000.0}, "kinematics": {"ball_inertia": False}}
    exact = run(scene_from_dict(scene)).error
    assert exact["contact"] is None and "half-spaces" in exact["how"]["contact"]
    result = run(scene_from_dict({**scene, "contact": {"kind": "penalty", "calibrate_at": 100.0}}))
    load = result.equilibrium.contact_force[0]
    # Both races carry the same load: rounding of the equilibrium.
    assert result.error["contact"] == pytest.approx(4.0 / 3.0 * (load / 100.0) ** (1.0 / 2.0 - 1.0 / 3.0) - 1.0, rel=1e-6)
    assert "exact Hertz" in result.error["how"]["contact"]
    assert result.error["total"] is None


def test_what_a_calibrated_law_leaves_is_an_error_of_its_own_and_counts():
    tables = {**TABLES, "bodies": {"kind": "condensed"}, "identifier": {"kind": "tangent"}}
    error = run(scene_from_dict(tables)).error
    assert 1e-3 < error["contact"] < 2e-2 and "surface points" in error["how"]["contact"]
    # The equilibrium's own residual, mesh and calibration: nothing else is uncertain.
    assert error["total"] == pytest.approx(error["mesh"] + error["contact"], rel=1e-3)


def test_other_laws_on_condensed_bodies_are_not_measured():
    tables = {**TABLES, "bodies": {"kind": "condensed"}, "identifier": {"kind": "tangent"}, "contact": {"kind": "penalty"}}
    error = run(scene_from_dict(tables)).error
    assert error["contact"] is None and "nodal" in error["how"]["contact"]


def test_hanns_line_of_a_periodic_signal_is_exact_and_leaks_less_of_another():
    t = np.arange(1, 1441) / 1440.0 * 4.0  # four turns of 1 Hz
    periodic = 3.0 + 2.0 * np.cos(2.0 * np.pi * t - 0.3) + 0.5 * np.cos(4.0 * np.pi * t)
    exact = 2.0 * np.exp(-0.3j)
    # Rounding of 1440 terms.
    assert abs(hann_line(t, periodic[:, None], 1.0)[0] - exact) < 1e-12
    free = periodic + np.cos(2.0 * np.pi * 5.37 * t)
    plain = 2.0 * (np.exp(-2j * np.pi * t) * free).mean()
    assert abs(hann_line(t, free[:, None], 1.0)[0] - exact) < 0.05 * abs(plain - exact)


def test_an_axis_that_leaves_no_setting_says_why():
    with pytest.raises(SceneError, match="above the limit"):
        make_design(TABLES, ["integrator.turns=1000,2000"], 0.1, default_registry())


EXACT = 2.3e8
MOVING = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 100.0}
#: A vibration of so many periods a turn; w^2 becomes (2 / dt tan(w dt / 2))^2 and (2 / dt sin(w dt / 2))^2.
ORDER = 60.0
ERRORS = {"newmark": (1.0 / 6.0, 17.0 / 720.0), "central_difference": (-1.0 / 12.0, 1.0 / 360.0)}


@attrs.frozen
class KnownErrors:
    """Stands for the runner: steps of x = w dt leave the errors c2 x^2 + c4 x^4 of theory."""

    registry: Any = attrs.field(factory=default_registry)

    def at(self, setting: Any, values: dict[str, Any]) -> dict[str, Any] | None:
        kind = values.get("integrator.kind", setting.scene.integrator.kind)
        if kind == "periodic":
            return None
        x = 2.0 * np.pi * ORDER / values["integrator.steps_per_turn"]
        second, fourth = ERRORS.get(kind, (0.0, 1e-4))
        z = EXACT * (1.0 + second * x**2 + fourth * x**4)
        return {"quantities": {"z_real": z, "z_imag": 0.0}, "own_error": None, "transient_error": 0.0}


def reference(kind: str, steps: int) -> Any:
    integrator = {"kind": kind, "turns": 4}
    tables = b7206c(excitation=MOVING, integrator=integrator)
    design = make_design(tables, [f"integrator.steps_per_turn={steps}"], 1e9, default_registry())
    return find_reference(list(design.settings), KnownErrors(), None)


@pytest.mark.parametrize("steps", [45, 90])
@pytest.mark.parametrize("kind", ["newmark", "quasi_static"])
def test_the_bound_holds_the_error_and_is_of_its_size(kind, steps):
    found = reference(kind, steps)
    true = abs(found.values["z_real"] / EXACT - 1.0)
    assert true <= found.bound
    # The bound is a change of the last refinement, or a distance of two methods: it has no reason to be far above the error.
    assert found.bound <= max(40.0 * true, 1e-9)


def test_its_picture_is_readable():
    rows = [
        {"setting": {"integrator.steps_per_turn": n}, "family": f"order {p}", "error": n ** -float(p), "time_s": 1e-5 * n, "base": p < 4}
        for p in (1, 2, 4) for n in (10, 100, 10000)
    ]  # fmt: skip
    whole = {"title": "made up", "rows": rows, "front": [0, 3, 5]}
    assert_readable([draw({**whole, "reference": {"error": bound}}) for bound in (1e-6, None)])


def test_labels_of_precision_lie_on_no_other_and_name_the_other_models():
    rows = [
        {"setting": {"integrator.steps_per_turn": n}, "family": f"order {p}", "error": n ** -2.0, "time_s": 1e-5 * n * (1.0 + 1e-3 * p), "base": True}
        for p in (1, 2, 3) for n in (10, 20, 40, 10000)
    ]  # fmt: skip
    rows.append({"setting": {"bodies.kind": "condensed"}, "family": "models", "error": 1e-3, "time_s": 1e-3, "base": False})
    figure = draw({"title": "made up", "rows": rows, "front": [0], "reference": {"error": None}})
    figure.draw_without_rendering()
    (panel,) = figure.axes
    assert sorted(text.get_text() for text in panel.texts) == sorted(
        ["10", "20", "40", "10000"] * 3 + ["bodies.kind = condensed"]
    )
    boxes = [Text.get_window_extent(text) for text in panel.texts]  # of an annotation: with its line
    assert not any(a.overlaps(b) for k, a in enumerate(boxes) for b in boxes[:k])
