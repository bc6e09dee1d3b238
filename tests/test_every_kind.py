"""A foreign plug-in of every kind is reached from the command line; what it does wrong is told by its name."""

import json
import os
from pathlib import Path

import attrs
import pytest

from checks.validation.command_line import MINIMAL, install, invoke, raceway
from checks.validation.scenes import built_in
from raceway import PluginError, load_scene, run
from raceway.extend import Registry
from raceway.testing import SUITES
from tests.test_docs import FILES

ROOT = Path(__file__).parents[1]
#: The plug-ins of docs/plugins.md and examples/plugins by kind.
OWN = {
    "contact_law": "power_law.py", "excitation": "pulse.py", "integrator": "damped.py", "identifier": "three_harmonics.py",
    "mesher": "one_cell.py", "format": "json_mesh.py", "quantity": "pressure_ratio.py", "executor": "backwards.py",
    "bodies": "radial_balls.py", "study": "hardening.py",
}  # fmt: skip

REPORT = '''
from pathlib import Path

import attrs

from raceway import RacewayError, hookimpl


@attrs.frozen
class {cls}:
    """A report of a test."""

    name = "{name}"
    suffixes = (".txt",)
    of_results = True

    def write(self, folder, result):
        {body}


@hookimpl
def raceway_formats():
    return [{cls}]
'''


@pytest.fixture
def files(tmp_path):
    """``--plugin FILE`` for plug-ins of the page, by kind."""

    def given(*kinds):
        words = []
        for kind in kinds:
            path = tmp_path / OWN[kind]
            path.write_text(FILES[OWN[kind]], encoding="utf-8")
            words += ["--plugin", path]
        return words

    return given


def report(folder, name, body, cls="Own"):
    path = folder / f"{name}_{cls}.py"
    path.write_text(REPORT.format(name=name, cls=cls, body=body), encoding="utf-8")
    return path


def test_the_kinds_are_all_here():
    assert set(OWN) == set(SUITES)


def test_a_run_uses_law_excitation_integrator_identifier_and_report(files, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    install(site, "lines", FILES["one_line.py"])
    words = [
        "contact.kind=power", "excitation.kind=pulse", "excitation.peak=200.0", "integrator.kind=damped", "integrator.turns=2",
        "identifier.kind=three_harmonics",
    ]  # fmt: skip
    scene = tmp_path / "scene.toml"
    scene.write_text('[bearing]\npreset = "B7206C"\n[load]\naxial = 1e3\n[excitation]\nkind = "pulse"\nspeed_rpm = 12000\n')
    changes = [word for change in words for word in ("--set", change)]
    kinds = ("contact_law", "excitation", "integrator", "identifier")
    out, path = tmp_path / "out", os.pathsep.join([str(site), str(ROOT)])
    found = raceway("run", scene, *changes, *files(*kinds), "--report", "one_line", "--out", out, PYTHONPATH=path)
    assert found.returncode == 0, found.stderr
    result = json.loads((out / "result.json").read_text())
    used = {p["kind"]: p["distribution"] for p in result["environment"]["plugins"]}
    assert {kind: used[kind] for kind in kinds} == {kind: OWN[kind] for kind in kinds}
    told = (out / "stiffness.txt").read_text()
    assert float(told.split()[0]) == pytest.approx(result["identification"]["equivalent_stiffness"], rel=1e-5)
    assert f"written: {out / 'stiffness.txt'}" in found.stdout


def test_meshes_are_made_written_and_read_by_foreign_plugins(files, tmp_path):
    made, again = tmp_path / "made", tmp_path / "again"
    plugins = files("mesher", "format")
    words = ("--set", "mesh.kind=one_cell", "--format", "json_mesh")
    found = invoke("view", "--mesh", MINIMAL, *plugins, *words, "--out", made, "--json")
    assert found.exit_code == 0, found.stderr
    assert json.loads(found.stdout)["files"] == [str(made / "inner_ring.mesh.json")]
    words = ("--set", "mesh.kind=file", "--set", f"mesh.inner_ring={made / 'inner_ring.mesh.json'}", "--format", "json_mesh")
    found = invoke("view", "--mesh", MINIMAL, *plugins, *words, "--out", again)
    assert found.exit_code == 0, found.stderr
    first, second = (json.loads((folder / "inner_ring.mesh.json").read_text()) for folder in (made, again))
    assert sorted(first["points"]) == sorted(second["points"])  # the mesher renumbers


def test_a_run_has_foreign_bodies(files, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[bearing]\npreset = "B7206C"\n[bodies]\nkind = "radial_balls"\n[supports]\naxial = "displacement"\n'
        "[load]\nradial = [1500.0, 100.0]\n[kinematics]\nball_inertia = false\n"
        '[excitation]\nkind = "bidirectional"\nspeed_rpm = 9000\nunbalance = 1e-4\n[integrator]\nturns = 2\n'
    )
    found = invoke("run", scene, *files("bodies"), "--out", tmp_path / "out")
    assert found.exit_code == 0, found.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    used = {p["kind"]: p["distribution"] for p in result["environment"]["plugins"]}
    assert used["bodies"] == OWN["bodies"] and result["scene"]["bodies"]["kind"] == "radial_balls"


def test_a_sweep_uses_a_foreign_executor(files, tmp_path):
    words = ("--executor", "backwards", "--workers", 2, "--grid", "load.axial=900,1000", "--set", "identifier.kind=tangent")
    found = invoke("sweep", MINIMAL, *files("executor"), *words, "--out", tmp_path / "store", "--json")
    assert found.exit_code == 0, found.stderr
    assert json.loads(found.stdout)["states"]["done"] == 2


@pytest.mark.parametrize(
    ("body", "words"),
    [("raise ValueError('no ink')", "write() raises ValueError: no ink"), ("raise RacewayError('no ink')", "no ink"),
     ("return None", "write() raises TypeError"), ("raise SystemExit(3)", "write() raises SystemExit: 3")],
)  # fmt: skip
def test_a_report_that_raises_is_named_after_the_result_is_saved(tmp_path, body, words):
    bad = report(tmp_path, "bad", body)
    good = report(tmp_path, "good", "p = Path(folder) / 'good.txt'; p.write_text('good'); return [p]", "Good")
    out = tmp_path / "out"
    names = ("--plugin", bad, "--plugin", good, "--report", "bad", "--report", "good")
    found = invoke("run", MINIMAL, "--set", "identifier.kind=tangent", *names, "--out", out)
    assert found.exit_code == 2 and found.stderr.count("error: ") == 1, found.stdout + found.stderr
    told = " ".join(found.stderr.split())
    assert f"format 'bad' of {bad.name}: {words}" in told and "The result is saved" in told
    assert json.loads((out / "result.json").read_text())["title"] and (out / "good.txt").read_text() == "good"
    assert "tangent kxx" in found.stdout


def fails(fault):
    def duty(*_given):
        raise fault

    return duty


@pytest.mark.parametrize(("duty", "answer", "words"), [
    ("faults", lambda *_: None, "faults() returned NoneType; it must be list"),
    ("traits", fails(SystemExit(3)), "traits() raises SystemExit: 3"),
    ("stable_step", lambda *_: "short", "stable_step() returned str; it must be float or None"),
    ("cost", fails(ValueError("no idea")), "cost() raises ValueError: no idea"),
    ("build", lambda *_: 7, "build() returned int; it must be a raceway.extend.BuiltBearing"),
    ("build", fails(KeyError("x")), "build() raises KeyError: 'x'"),
])  # fmt: skip
def test_a_broken_duty_of_bodies_names_the_kind(duty, answer, words):
    own = attrs.frozen(type("Own", (built_in("bodies", "rigid"),), {"name": "own", duty: answer}))
    scene = load_scene(MINIMAL, ["integrator.kind=central_difference"])
    with pytest.raises(PluginError) as caught:
        run(attrs.evolve(scene, bodies=own()))
    assert str(caught.value).startswith(f"bodies 'own': {words}")


def test_two_formats_of_one_ending_are_refused_by_name(tmp_path):
    registry = Registry(third_party=False)
    assert registry.format_of("ring.VTU").name == "vtu"
    code = FILES[OWN["format"]]
    for name, ending in (("one", ".mesh.json"), ("two", ".mesh.json"), ("three", ".json")):
        path = tmp_path / f"{name}.py"
        path.write_text(code.replace("json_mesh", name).replace(".mesh.json", ending), encoding="utf-8")
        registry.load_file(path)
    assert registry.format_of("a.json").name == "three"
    with pytest.raises(PluginError, match=r"format 'one' of one.py and format 'two' of two.py both claim the ending"):
        registry.format_of("a.mesh.json")
    with pytest.raises(PluginError, match=r"no format has the ending '.stl'; there are .inp, .json, .mesh.json, .msh, .vtu"):
        registry.format_of("a.stl")
