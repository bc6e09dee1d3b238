"""Every scene in examples/ runs to a finite, sensible result; those with a mesh alone are meshed in tests/core/mesh."""

import json
from functools import cache
from pathlib import Path

import attrs
import pytest

from checks.validation.command_line import invoke
from checks.validation.scenes import built_in
from raceway import SceneError, load_scene, make_plan
from raceway.testing import run
from tests.test_screens import assert_one_screen

FOLDER = Path(__file__).resolve().parents[1] / "examples"
#: Scenes for `raceway view --mesh`: too large to run here.
MESHES = {"b7206_article_mesh"}
#: Scenes that take tens of seconds: planned here; a smaller one of their kind runs in tests/core/test_elastic_scene.py.
LONG = {"b7206_elastic"}
#: Scenes without an excitation.
STATIC = {"b7206_elastic_coarse", "set_tbt"}
RUNNING = [path for path in sorted(FOLDER.glob("*.toml")) if path.stem not in MESHES | LONG]


@cache
def ran(name):
    """What an example answers."""
    return run(load_scene(FOLDER / f"{name}.toml"))


#: The patches with fewer points run below.
@pytest.mark.parametrize(
    "path", [pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (path.stem == "b7206_patches")) for path in RUNNING]
)
def test_example_runs_and_fits_one_screen(path):
    result = ran(path.stem).to_dict()
    assert_one_screen(ran(path.stem))
    json.dumps(result, allow_nan=False)
    assert result["stability"]["status"] == "completed"
    found = result["identification"]
    if path.stem in STATIC:
        assert found is None
        assert min(result["equilibrium"]["stiffness"][i][i] for i in range(3)) > 1e7
        return
    assert found["equivalent_stiffness"] > 1e6
    # Estimates of the parts of the error; a run-up changes its speed while it is looked at, and what the calibration of condensed
    # contacts leaves is the spread of their compliance over the load, 1 %.
    limit = 0.05 if found["series"] else 0.01 + (result["error"]["bodies"] or 0.0)
    assert result["error"]["total"] < limit and (result["error"]["bodies"] or 0.0) < 0.015


@pytest.mark.parametrize("name", sorted(LONG))
def test_a_long_example_can_run_in_tens_of_seconds(name):
    plan = make_plan(load_scene(FOLDER / f"{name}.toml"))
    assert plan.dofs > 40_000
    assert plan.predicted_work_s < 60.0


def test_the_elastic_examples_answer_what_condensed_bodies_do():
    """The coarse one here; the finer one has the same contacts and a row in the evidence.

    3.2 mm elements are good to 1 %, and contacts of elastic bodies are matched at depth, without the calibration at surface points
    of condensed ones: 0.8 % of kyy there.
    """
    coarse = load_scene(FOLDER / "b7206_elastic_coarse.toml")
    condensed = attrs.evolve(coarse, bodies=built_in("bodies", "condensed")(), mesh=None)
    elastic, other = ran("b7206_elastic_coarse").to_dict(), run(condensed).to_dict()
    for i in range(3):
        assert elastic["equilibrium"]["stiffness"][i][i] == pytest.approx(other["equilibrium"]["stiffness"][i][i], rel=0.018)
    assert elastic["warnings"] == []
    scenes = [load_scene(FOLDER / f"{name}.toml") for name in ("b7206_elastic", "b7206_elastic_coarse")]
    assert {(one.contact.kind, one.contact.discretisation) for one in scenes} == {("hertz", "resultant")}


def test_a_coarse_mesh_leads_with_its_warning(tmp_path):
    changes = ("mesh.nodes_per_semi_axis=2", "bodies.hourglass=0.01", "integrator.steps_per_turn=12", "integrator.turns=1")
    words = [word for change in changes for word in ("--set", change)]
    found = invoke("run", FOLDER / "b7206_patches.toml", *words, "--out", tmp_path)
    assert found.exit_code == 0, found.output
    warnings = [line for line in found.stdout.splitlines() if line.startswith("warning: ")]
    assert warnings[0].startswith("warning: only 2.") and len(warnings) > 1
    first, *others = json.loads((tmp_path / "result.json").read_text())["warnings"]
    assert first.startswith("only 2.") and any("bodies.hourglass" in text for text in others)


@pytest.mark.parametrize("name", sorted(MESHES))
def test_running_a_mesh_example_is_refused_where_the_memory_will_not_do(name, monkeypatch):
    monkeypatch.setattr("raceway.plugins.bodies.elastic.allowed_bytes", lambda: 2.0**31)
    with pytest.raises(SceneError, match="matrices would take about .* GiB, above 1.6 GiB"):
        run(load_scene(FOLDER / f"{name}.toml"))
